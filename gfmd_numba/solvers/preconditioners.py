"""The approximate inverse of a compliance on some nodes, by the dimension of the surface, and what goes with it."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.solvers.exponential_sums.exponential_sum import ProfileInverse
from gfmd_numba.solvers.tiles.near_field import FarField, NearField


class Preconditioner(NamedTuple):
    """How Newton's methods precondition on a grid.

    `of_contact` takes stiffness, compliance and shape of the normal displacement alone, `of_component` the compliance
    and shape of one component among others; `tangential` makes one compliance of the elements of the whole. Nodes may
    have to be `in_order` around the period. Under friction the linear problem takes at most so many `directions`. Where
    no slip `turns`, that of a guess that stands is linear, displacements of all directions are kept, and coarser grids
    tell the guess.
    """

    of_contact: Callable[[Reals, Reals, tuple[int, ...]], ProfileInverse | FarField]
    of_component: Callable[[Reals, tuple[int, ...]], ProfileInverse | NearField]
    tangential: Callable[[Reals], Reals]
    in_order: bool
    directions: int
    turns: bool


def as_stiffness(compliance: Reals) -> Reals:
    """Stiffness; a mean displacement that is rigid has none, and one nearly so would reach over the whole map."""
    stiffness = _reciprocal(compliance)
    stiffness.flat[0] = min(stiffness.flat[0], stiffness.flat[1])
    return stiffness


def _reciprocal(compliance: Reals) -> Reals:
    return np.divide(1.0, compliance, out=np.zeros_like(compliance), where=compliance > 0.0)


def _alike_both_ways(elements: Reals) -> Reals:
    """Compliance of a map whose two tangential components have the mean of their stiffnesses."""
    xx, xy, yy = elements[:3]
    trace = 0.5 * (xx + yy)
    return np.asarray(np.divide(xx * yy - xy**2, trace, out=np.zeros_like(trace), where=trace > 0.0))


PRECONDITIONERS = {  # by the dimension
    1: Preconditioner(
        lambda stiffness, compliance, shape: ProfileInverse(
            stiffness, compliance.astype(np.float64) * shape[0], *shape
        ),
        lambda compliance, shape: ProfileInverse(_reciprocal(compliance), compliance, *shape),
        lambda elements: elements[0],
        in_order=True,
        directions=100,
        turns=False,
    ),
    2: Preconditioner(
        lambda stiffness, compliance, shape: FarField(stiffness, shape),
        lambda compliance, shape: NearField(as_stiffness(compliance), shape),
        _alike_both_ways,
        in_order=False,
        directions=40,  # of maps fewer, as these are large
        turns=True,
    ),
}
