"""Compiled loops over some square tiles of a map: values there, their convolution with a stencil, and coarser grids.

Values on m tiles are `[m + 1, TILE, TILE]`; the last tile holds zeros and stands for all tiles that are not listed.
"""

import numpy as np

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.kernels.compilation import jit

TILE = 8  # nodes along each side


@jit
def list_tiles(marks: Flags, tiles: Indices, places: Indices) -> int:
    """List the marked tiles, and write the place of each into `places`; their number stands there for the others."""
    count = 0
    for t in range(marks.size):
        if marks[t]:
            tiles[count] = t
            count += 1
    for t in range(marks.size):
        places[t] = count
    for k in range(count):
        places[tiles[k]] = k
    return count


@jit
def surround(tiles: Indices, places: Indices, down: int, across: int, around: Indices) -> None:
    """Places of the 3 x 3 tiles around each listed one `[m, 9]` on a periodic map of down x across tiles."""
    for k in range(tiles.size):
        y, x = tiles[k] // across, tiles[k] % across
        for j in range(3):
            for i in range(3):
                around[k, 3 * j + i] = places[(y + j - 1) % down * across + (x + i - 1) % across]


@jit
def tile_stencil(values: Reals, around: Indices, stencil: Reals, product: Reals) -> None:
    """Convolution of the values with a stencil `[2 reach + 1, 2 reach + 1]`, even along y, reach at most TILE."""
    reach = stencil.shape[0] // 2
    width = TILE + 2 * reach
    patch = np.zeros((width, width))
    loaded = np.zeros(width, dtype=np.bool_)
    folded = np.zeros(width)  # rows above and below a node have the same weights
    for k in range(around.shape[0]):
        for b in range(3):
            for a in range(3):
                tile = values[around[k, 3 * b + a]]
                up, left = reach + (b - 1) * TILE, reach + (a - 1) * TILE
                first, last = max(left, 0), min(left + TILE, width)
                for j in range(max(up, 0), min(up + TILE, width)):
                    for i in range(first, last):
                        patch[j, i] = tile[j - up, i - left]
        for j in range(width):
            largest = 0.0
            for i in range(width):
                largest += abs(patch[j, i])
            loaded[j] = largest != 0.0  # not-a-number too
        for y in range(TILE):
            s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = 0.0  # a row of the tile, in registers
            for j in range(reach + 1):
                above, below = y + reach - j, y + reach + j
                if not (loaded[above] or loaded[below]):
                    continue
                if j == 0:
                    row = patch[above]
                else:
                    for i in range(width):
                        folded[i] = patch[above, i] + patch[below, i]
                    row = folded
                weights = stencil[reach + j]
                for i in range(2 * reach + 1):
                    c = weights[i]
                    s0 += c * row[i]
                    s1 += c * row[i + 1]
                    s2 += c * row[i + 2]
                    s3 += c * row[i + 3]
                    s4 += c * row[i + 4]
                    s5 += c * row[i + 5]
                    s6 += c * row[i + 6]
                    s7 += c * row[i + 7]
            out = product[k, y]
            out[0], out[1], out[2], out[3], out[4], out[5], out[6], out[7] = s0, s1, s2, s3, s4, s5, s6, s7


@jit
def spread(values: Reals, tiles: Indices, weights: Reals, coarse: Reals, down: int, across: int) -> None:
    """Fill a periodic grid of down x across nodes with the values, each shared among nodes by `weights` `[TILE, w]`.

    The first of the w nodes is one before the tile's first. Rows of `coarse` may be longer than `across`.
    """
    wide = weights.shape[1]
    per_tile = wide - 3
    tiles_across = across // per_tile
    half = np.zeros((TILE, wide))
    coarse[:] = 0.0
    for k in range(tiles.size):
        up, left = tiles[k] // tiles_across * per_tile - 1, tiles[k] % tiles_across * per_tile - 1
        for y in range(TILE):
            for a in range(wide):
                half[y, a] = 0.0
            for x in range(TILE):
                v = values[k, y, x]
                for a in range(wide):
                    half[y, a] += v * weights[x, a]
        for b in range(wide):
            row = coarse[(up + b) % down]
            for a in range(wide):
                total = 0.0
                for y in range(TILE):
                    total += weights[y, b] * half[y, a]
                row[(left + a) % across] += total


@jit
def gather_back(coarse: Reals, tiles: Indices, weights: Reals, down: int, across: int, values: Reals) -> None:
    """Add to the values what the nodes of a coarser grid share with them: the transpose of `spread`."""
    wide = weights.shape[1]
    per_tile = wide - 3
    tiles_across = across // per_tile
    half = np.zeros((wide, TILE))
    for k in range(tiles.size):
        up, left = tiles[k] // tiles_across * per_tile - 1, tiles[k] % tiles_across * per_tile - 1
        for b in range(wide):
            row = coarse[(up + b) % down]
            for x in range(TILE):
                half[b, x] = 0.0
            for a in range(wide):
                v = row[(left + a) % across]
                for x in range(TILE):
                    half[b, x] += v * weights[x, a]
        for y in range(TILE):
            out = values[k, y]
            for b in range(wide):
                w = weights[y, b]
                for x in range(TILE):
                    out[x] += w * half[b, x]


@jit
def sum_tiles(weights: Reals, values: Reals, tiles: Indices, across: int, sums: Reals) -> None:
    """Weighted sums of the values over blocks of 2 x 2 tiles, on a map of `across` tiles in a row."""
    sums[:] = 0.0
    for k in range(tiles.size):
        total = 0.0
        for y in range(TILE):
            for x in range(TILE):
                total += weights[k, y, x] * values[k, y, x]
        sums[tiles[k] // across // 2, tiles[k] % across // 2] += total


@jit
def soften_tiles(pressure: Reals, weights: Reals, shared: Reals, tiles: Indices, across: int, contact: Flags) -> None:
    """Take the displacement that a block of 2 x 2 tiles shares, times the weights, off the pressure in contact."""
    for k in range(tiles.size):
        common = shared[tiles[k] // across // 2, tiles[k] % across // 2]
        for y in range(TILE):
            for x in range(TILE):
                p = pressure[k, y, x] - weights[k, y, x] * common
                pressure[k, y, x] = p if contact[k, y, x] else 0.0
