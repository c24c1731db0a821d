"""Compiled sums over grids, each half as fine as the one before: what a law does on each, and what tractions do."""

from typing import NamedTuple

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit

_SOFTENED = 0.5  # part of the stiffness of a body that a law may take off a coarser grid: there it means much less


class CoarserGrids(NamedTuple):
    """Grids of ever fewer nodes, the one that is solved on first: rows and columns of each, `shapes` `[grid, 2]`.

    Nodes of all but the first follow each other in one array, those of grid i from `first[i - 1]` on. Each row of a
    grid lies a `row_share` of the way from a `row` of the next coarser one to the row after it; rows of all grids
    follow each other, and so do columns.
    """

    shapes: Indices
    first: Indices
    row: Indices
    row_share: Reals
    column: Indices
    column_share: Reals


@jit
def to_coarser(fine: Reals, coarse: Reals, places: tuple[Indices, Reals, Indices, Reals]) -> None:
    """Fill a coarser grid with means around its nodes: the transpose of `to_finer`, but for a factor."""
    row, row_share, column, column_share = places
    (ny, nx), (my, mx) = fine.shape, coarse.shape
    lines, mean = np.zeros((2, nx)), my * mx / (ny * nx)
    coarse[:] = 0.0
    for y in range(ny + 1):
        if y == ny or (y > 0 and row[y] > row[y - 1]):
            at = row[y - 1]
            for x in range(nx):
                a, share, value = column[x], column_share[x], mean * lines[0, x]
                coarse[at, a] += (1.0 - share) * value
                coarse[at, a + 1 if a + 1 < mx else 0] += share * value
                lines[0, x], lines[1, x] = lines[1, x], 0.0
        if y < ny:
            share = row_share[y]
            for x in range(nx):
                lines[0, x] += (1.0 - share) * fine[y, x]
                lines[1, x] += share * fine[y, x]
    at = row[ny - 1] + 1 if row[ny - 1] + 1 < my else 0
    for x in range(nx):
        a, share, value = column[x], column_share[x], mean * lines[0, x]
        coarse[at, a] += (1.0 - share) * value
        coarse[at, a + 1 if a + 1 < mx else 0] += share * value


@jit
def to_finer(coarse: Reals, fine: Reals, places: tuple[Indices, Reals, Indices, Reals]) -> None:
    """Add to a finer grid what is linear between the nodes of a coarser one."""
    row, row_share, column, column_share = places
    (ny, nx), (my, mx) = fine.shape, coarse.shape
    line = np.empty(mx + 1)
    for y in range(ny):
        a, share = row[y], row_share[y]
        b = a + 1 if a + 1 < my else 0
        for x in range(mx):
            line[x] = (1.0 - share) * coarse[a, x] + share * coarse[b, x]
        line[mx] = line[0]
        for x in range(nx):
            a, share = column[x], column_share[x]
            fine[y, x] += (1.0 - share) * line[a] + share * line[a + 1]


@jit
def places(grids: CoarserGrids, i: int) -> tuple[Indices, Reals, Indices, Reals]:
    """Where the rows and columns of a grid lie on the next coarser one."""
    y, x = grids.shapes[:i, 0].sum(), grids.shapes[:i, 1].sum()
    below, right = y + grids.shapes[i, 0], x + grids.shapes[i, 1]
    return grids.row[y:below], grids.row_share[y:below], grids.column[x:right], grids.column_share[x:right]


@jit
def on_grid(grids: CoarserGrids, i: int, finest: Reals, coarser: Reals) -> Reals:
    """Values `[y, x]` on a grid, of those on the finest one and on all others."""
    ny, nx = grids.shapes[i, 0], grids.shapes[i, 1]
    if i == 0:
        return finest[: ny * nx].reshape(ny, nx)
    first = grids.first[i - 1]
    return coarser[first : first + ny * nx].reshape(ny, nx)


@jit
def parallel_compliance(
    grids: CoarserGrids, compliance: Reals, stiffness: Reals, weight: Reals, weights: Reals, room: Reals
) -> None:
    """Fill the compliance of each node on all grids, so that body and law are in parallel for the waves of each.

    `compliance` `[grid]` is that of the body alone for the waves that a grid still holds. Held nodes, of no `weight`,
    have the `stiffness` that coarser grids are to feel.
    """
    for j in range(stiffness.size):
        weight[j] = compliance[0] / (1.0 + max(compliance[0] * stiffness[j], 0.0)) if weight[j] > 0.0 else 0.0
    for i in range(1, len(compliance)):
        more, less = compliance[i], compliance[i - 1]
        mean, own = on_grid(grids, i, room, room), on_grid(grids, i, weights, weights)
        to_coarser(on_grid(grids, i - 1, stiffness, room), mean, places(grids, i - 1))
        for y in range(mean.shape[0]):
            for x in range(mean.shape[1]):
                own[y, x] = more / (1.0 + max(more * mean[y, x], -_SOFTENED)) - less / (
                    1.0 + max(less * mean[y, x], -_SOFTENED)
                )


@jit
def comply_in_parallel(
    grids: CoarserGrids, weight: Reals, weights: Reals, traction: Reals, displacement: Reals, room: Reals
) -> None:
    """Fill the displacement under a traction: the sum of what it does on all grids."""
    for i in range(1, len(grids.shapes)):
        to_coarser(on_grid(grids, i - 1, traction, room), on_grid(grids, i, room, room), places(grids, i - 1))
    for i in range(len(grids.shapes) - 1, 0, -1):
        own, found = on_grid(grids, i, weights, weights), on_grid(grids, i, room, room)
        for y in range(own.shape[0]):
            for x in range(own.shape[1]):
                found[y, x] *= own[y, x]
        if i + 1 < len(grids.shapes):
            to_finer(on_grid(grids, i + 1, room, room), found, places(grids, i))
    for j in range(traction.size):
        displacement[j] = weight[j] * traction[j]
    if len(grids.shapes) > 1:
        to_finer(on_grid(grids, 1, room, room), on_grid(grids, 0, displacement, room), places(grids, 0))
