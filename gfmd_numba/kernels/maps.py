"""Compiled passes over a whole map, and between it and some of its square tiles.

Values on m tiles are those of `tiles.py`. Rows of the transform's memory may be longer than those of the map.
"""

import numpy as np

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.tiles import TILE


@jit
def put_tiles(values: Reals, tiles: Indices, rows: Reals, nx: int) -> None:
    """Fill the first nx columns of the rows of a map with the values on the listed tiles, and zeros elsewhere."""
    across = nx // TILE
    rows[:] = 0.0
    for k in range(tiles.size):
        top, left = tiles[k] // across * TILE, tiles[k] % across * TILE
        for y in range(TILE):
            for x in range(TILE):
                rows[top + y, left + x] = values[k, y, x]


@jit
def take_tiles(rows: Reals, tiles: Indices, nx: int, values: Reals) -> None:
    """Fill the values on the listed tiles from the rows of a map of nx columns, which may be longer."""
    across = nx // TILE
    for k in range(tiles.size):
        top, left = tiles[k] // across * TILE, tiles[k] % across * TILE
        for y in range(TILE):
            for x in range(TILE):
                values[k, y, x] = rows[top + y, left + x]


@jit
def mark_loaded(rows: Reals, nx: int, marks: Flags) -> None:
    """Mark the tiles on which any value of a map is positive."""
    across = nx // TILE
    for y in range(rows.shape[0]):
        row = rows[y]
        for t in range(across):
            largest = 0.0
            for x in range(t * TILE, (t + 1) * TILE):
                largest = max(largest, row[x])
            if largest > 0.0:
                marks[y // TILE * across + t] = True


@jit
def mark_contact(contact: Flags, tiles: Indices, marks: Flags) -> None:
    """Mark the listed tiles that hold nodes in contact."""
    for k in range(tiles.size):
        for y in range(TILE):
            for x in range(TILE):
                if contact[k, y, x]:
                    marks[tiles[k]] = True


@jit
def move_tiles(old: Reals, places: Indices, tiles: Indices, new: Reals) -> None:
    """Fill new values on the listed tiles from the old ones, whose places are given."""
    for k in range(tiles.size):
        new[k] = old[places[tiles[k]]]


@jit
def level_of_contact(
    wall: Reals, displacement: Reals, contact: Flags, tiles: Indices, nx: int
) -> tuple[int, float, float]:
    """Number of nodes in contact, their mean gap up to the approach, and its root-mean-square about that."""
    across = nx // TILE
    count = 0
    total = 0.0
    first = 0.0
    squares = 0.0
    for k in range(tiles.size):
        top, left = tiles[k] // across * TILE, tiles[k] % across * TILE
        for y in range(TILE):
            for x in range(TILE):
                if contact[k, y, x]:
                    gap = wall[top + y, left + x] + displacement[top + y, left + x]
                    if count == 0:
                        first = gap
                    count += 1
                    total += gap - first
                    squares += (gap - first) ** 2
    if count == 0:
        return 0, 0.0, 0.0
    mean = total / count
    return count, first + mean, np.sqrt(max(squares / count - mean**2, 0.0))


@jit
def open_map(wall: Reals, displacement: Reals, approach: float, near: float, gap: Reals, marks: Flags) -> None:
    """Gap of a map `[y, x]`; mark the tiles where it is anywhere below `near`. Rows of `displacement` may be longer."""
    across = wall.shape[1] // TILE
    for y in range(wall.shape[0]):
        punch, pushed, opened = wall[y], displacement[y], gap[y]
        for x in range(punch.size):
            opened[x] = punch[x] + pushed[x] - approach
        for t in range(across):
            lowest = np.inf
            for x in range(t * TILE, (t + 1) * TILE):
                lowest = min(lowest, opened[x])
            if lowest < near:
                marks[y // TILE * across + t] = True


@jit
def close_map(wall: Reals, gap: Reals, contact: Flags, tiles: Indices, rows: Reals) -> None:
    """Make the gap the displacement that touches wherever there is contact or overlap, and copy it into `rows`."""
    nx = wall.shape[1]
    across = nx // TILE
    for y in range(wall.shape[0]):
        punch, opened, out = wall[y], gap[y], rows[y]
        for x in range(nx):
            u = punch[x] - max(opened[x], 0.0)
            opened[x] = u
            out[x] = u
    for k in range(tiles.size):
        top, left = tiles[k] // across * TILE, tiles[k] % across * TILE
        for y in range(TILE):
            for x in range(TILE):
                if contact[k, y, x]:
                    gap[top + y, left + x] = wall[top + y, left + x]
                    rows[top + y, left + x] = wall[top + y, left + x]


@jit
def pack_rows(rows: Reals, nx: int) -> None:
    """Move the first nx columns of all rows together, to the beginning of the memory of `rows`."""
    packed = rows.reshape(-1)
    for y in range(1, rows.shape[0]):
        row = rows[y]
        for x in range(nx):
            packed[y * nx + x] = row[x]


@jit
def refine_pressure(p: Reals, above: Indices, share_y: Reals, left: Indices, share_x: Reals, fine: Reals) -> None:
    """Interpolate a periodic map of pressures linearly onto the rows of a finer one, whose node y, x lies beyond node
    above[y], left[x] by a share of the distance to the next.

    Of nodes next to the contact, which interpolation would load too, those nearer to a contact node keep their load.
    """
    ny, nx = p.shape
    for y in range(above.size):
        first, second = p[above[y]], p[(above[y] + 1) % ny]
        down = share_y[y]
        for x in range(left.size):
            a, b, right = left[x], (left[x] + 1) % nx, share_x[x]
            w = (1.0 - down) * (1.0 - right), (1.0 - down) * right, down * (1.0 - right), down * right
            corners = first[a], first[b], second[a], second[b]
            inside = 0.0
            value = 0.0
            for c in range(4):
                if corners[c] > 0.0:
                    inside += w[c]
                    value += w[c] * corners[c]
            fine[y, x] = value if inside >= 0.5 else 0.0
