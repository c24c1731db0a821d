"""Compiled loops over some square tiles of a map that the contact may reach, and between them and the whole map.

Values on m tiles are `[m + 1, TILE, TILE]`; the last tile holds zeros and stands for all tiles that are not listed.
Rows of a transform's memory may be longer than those of the map.
"""

import numpy as np

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.kernels.compilation import jit

TILE = 8  # nodes along each side


@jit
def surround(tiles: Indices, places: Indices, down: int, across: int, ends: tuple[bool, bool], around: Indices) -> None:
    """Places of the 3 x 3 tiles around each listed one `[m, 9]` on a map of down x across tiles.

    The map is periodic, or ends along y or x: no tile is beyond.
    """
    for k in range(tiles.size):
        y, x = tiles[k] // across, tiles[k] % across
        for j in range(3):
            for i in range(3):
                row, column = y + j - 1, x + i - 1
                beyond = (ends[0] and not 0 <= row < down) or (ends[1] and not 0 <= column < across)
                around[k, 3 * j + i] = tiles.size if beyond else places[row % down * across + column % across]


@jit
def list_loaded(values: Reals, starts: Indices, nodes: Indices, loads: Reals) -> None:
    """List the nodes of each tile that hold a value other than zero, one tile after another, and their values.

    Those of tile k are from `starts[k]` to `starts[k + 1]`; `starts` is `[m + 2]`, the lists have room for all.
    """
    flat = values.reshape(values.shape[0], TILE * TILE)
    count = 0
    for k in range(flat.shape[0]):
        starts[k] = count
        for j in range(flat.shape[1]):
            if flat[k, j] != 0.0:
                nodes[count], loads[count] = j, flat[k, j]
                count += 1
    starts[flat.shape[0]] = count


@jit
def convolve_loaded(
    loaded: tuple[Indices, Indices, Reals],
    tiles: Indices,
    places: Indices,
    tiles_each_way: tuple[int, int],
    ends: tuple[bool, bool],
    kernel: Reals,
    reach: int,
    product: Reals,
) -> None:
    """Fill the product on some tiles `[k, TILE, TILE]` with the convolution of what `list_loaded` has listed.

    The kernel `[2 r + 1, 2 r + 1]`, r = (D + 1) TILE - 1, is even, and zero beyond its `reach` <= r in nodes.
    """
    starts, nodes, loads = loaded
    down, across = tiles_each_way
    width = kernel.shape[1]
    distance = (width // 2 + 1) // TILE - 1
    around = 2 * distance + 1
    flat = kernel.reshape(-1)
    offsets, v = np.empty(around**2 * TILE**2, dtype=np.uint64), np.empty(around**2 * TILE**2)
    for k in range(tiles.size):
        y, x = tiles[k] // across, tiles[k] % across
        count = 0
        for j in range(-distance, distance + 1):
            row = y + j
            if row < 0 or row >= down:
                if ends[0]:
                    continue
                row %= down
            for i in range(-distance, distance + 1):
                column = x + i
                if column < 0 or column >= across:
                    if ends[1]:
                        continue
                    column %= across
                place = places[row * across + column]
                for s in range(starts[place], starts[place + 1]):
                    down_by, right_by = j * TILE + nodes[s] // TILE, i * TILE + nodes[s] % TILE
                    if -reach <= down_by < TILE + reach and -reach <= right_by < TILE + reach:
                        offsets[count] = np.uint64((width // 2 - down_by) * width + width // 2 - right_by)
                        v[count] = loads[s]
                        count += 1
        for line in range(TILE):
            s0 = s1 = s2 = s3 = s4 = s5 = s6 = s7 = 0.0  # a row of the tile, in registers
            for s in range(count):
                o, c = offsets[s] + np.uint64(line * width), v[s]  # without a sign, eight at once
                s0 += c * flat[o]
                s1 += c * flat[o + np.uint64(1)]
                s2 += c * flat[o + np.uint64(2)]
                s3 += c * flat[o + np.uint64(3)]
                s4 += c * flat[o + np.uint64(4)]
                s5 += c * flat[o + np.uint64(5)]
                s6 += c * flat[o + np.uint64(6)]
                s7 += c * flat[o + np.uint64(7)]
            out = product[k, line]
            out[0], out[1], out[2], out[3], out[4], out[5], out[6], out[7] = s0, s1, s2, s3, s4, s5, s6, s7


@jit
def spread(
    values: Reals,
    tiles: Indices,
    tiles_across: int,
    per_tile: int,
    weights: Reals,
    coarse: Reals,
    down: int,
    across: int,
) -> None:
    """Fill a periodic grid of down x across nodes with the values, each shared among nodes by `weights` `[TILE, w]`.

    As many of the w nodes lie before the tile as behind it, and one more begins the next. The map of the tiles, which
    has `tiles_across`, may be narrower than the grid, which has `per_tile` nodes of each. Rows of `coarse` may be
    longer than `across`.
    """
    wide = weights.shape[1]
    before = (wide - per_tile - 1) // 2
    half = np.empty((wide, TILE))
    coarse[:] = 0.0
    for k in range(tiles.size):
        up, left = tiles[k] // tiles_across * per_tile - before, tiles[k] % tiles_across * per_tile - before
        half[:] = 0.0
        for y in range(TILE):
            for b in range(wide):
                for x in range(TILE):  # a row of the tile, several at once
                    half[b, x] += weights[y, b] * values[k, y, x]
        for b in range(wide):
            row = coarse[(up + b) % down]
            for a in range(wide):
                total = 0.0
                for x in range(TILE):
                    total += weights[x, a] * half[b, x]
                row[(left + a) % across] += total


@jit
def gather_back(
    coarse: Reals,
    tiles: Indices,
    tiles_across: int,
    per_tile: int,
    weights: Reals,
    down: int,
    across: int,
    values: Reals,
) -> None:
    """Add to the values what the nodes of a coarser grid share with them: the transpose of `spread`."""
    wide = weights.shape[1]
    before = (wide - per_tile - 1) // 2
    half = np.zeros((wide, TILE))
    for k in range(tiles.size):
        up, left = tiles[k] // tiles_across * per_tile - before, tiles[k] % tiles_across * per_tile - before
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
def near_pressure(
    u: Reals,
    nodes: Indices,
    some: tuple[int, int],
    tiles: tuple[Indices, Indices],
    stencil: Reals,
    isolated: Reals,
    p: Reals,
    sums: Reals,
) -> None:
    """Pressure on the listed nodes of some tiles, from the first to the last but one, by a stencil `[3, 3]`.

    The stencil is even along y and x. The displacement `u` `[m + 1, TILE, TILE]` is zero on all other nodes. Add up in
    blocks the displacements times `isolated`, the pressures of a uniform displacement. Of each of the `tiles` are given
    those around it, as in `surround`, and its block.
    """
    around, blocks = tiles
    own, above, left, corner = stencil[1, 1], stencil[0, 1], stencil[1, 0], stencil[0, 0]
    wide = np.uint64(TILE + 2)  # without a sign, indices need no look at what is negative
    halo = np.empty((TILE + 2, TILE + 2))
    flat = halo.reshape(-1)
    k = np.searchsorted(nodes, TILE**2 * some[0])
    for t in range(some[0], some[1]):
        end, total = TILE**2 * (t + 1), 0.0
        if k < nodes.size and nodes[k] < end:
            surrounded(u, t, around[t], halo)
        while k < nodes.size and nodes[k] < end:
            y, x = np.uint64(nodes[k] // TILE % TILE), np.uint64(nodes[k] % TILE)
            a = y * wide + x  # the upper left one of nine
            b, c = a + wide, a + wide + wide
            i, j = np.uint64(1), np.uint64(2)
            corners = flat[a] + flat[a + j] + flat[c] + flat[c + j]
            sides = above * (flat[a + i] + flat[c + i]) + left * (flat[b] + flat[b + j])
            p[k] = own * flat[b + i] + sides + corner * corners
            total += isolated[k] * flat[b + i]
            k += 1
        sums[blocks[t]] += total


@jit
def surrounded(values: Reals, tile: int, around: Indices, halo: Reals) -> None:
    """Fill `[TILE + 2, TILE + 2]` with the values of a tile and of the nodes next to it, on the nine tiles `around`."""
    end = TILE - 1
    up, down, left, right = values[around[1]], values[around[7]], values[around[3]], values[around[5]]
    for x in range(TILE):
        halo[0, x + 1], halo[TILE + 1, x + 1] = up[end, x], down[0, x]
    for y in range(TILE):
        halo[y + 1, 0], halo[y + 1, TILE + 1] = left[y, end], right[y, 0]
        for x in range(TILE):
            halo[y + 1, x + 1] = values[tile, y, x]
    halo[0, 0], halo[0, TILE + 1] = values[around[0], end, end], values[around[2], end, 0]
    halo[TILE + 1, 0], halo[TILE + 1, TILE + 1] = values[around[6], 0, end], values[around[8], 0, 0]


@jit
def put_nodes(values: Reals, nodes: Indices, image: Reals) -> None:
    """Put values on the listed nodes."""
    for k in range(nodes.size):
        image[nodes[k]] = values[k]


@jit
def subtract_far_pressure(p: Reals, nodes: Indices, isolated: Reals, blocks: Indices, shared: Reals) -> None:
    """Subtract from pressures the displacement of their block, times the pressure of a uniform displacement."""
    for k in range(nodes.size):
        p[k] -= isolated[k] * shared[blocks[nodes[k] // TILE**2]]


@jit
def convolve_few(load: Reals, rows: Indices, columns: Indices, kernel: Reals, product: Reals) -> None:
    """Convolve loads on few nodes of a periodic map with its even kernel `[y, x]`, on these nodes."""
    for k in range(rows.size):
        total = 0.0
        for j in range(rows.size):
            total += kernel[abs(rows[k] - rows[j]), abs(columns[k] - columns[j])] * load[j]
        product[k] = total


@jit
def block_direction(r: Reals, z: Reals, last: float, direction: Reals, unsmoothed: Reals) -> float:
    """Make the direction z, smoothed of r, conjugate to the last one, and follow what it is smoothed of; energy r z."""
    energy = 0.0
    for k in range(r.size):
        energy += r[k] * z[k]
    share = energy / last if last > 0.0 else 0.0
    for k in range(r.size):
        direction[k] = z[k] + share * direction[k]
        unsmoothed[k] = r[k] + share * unsmoothed[k]
    return energy


@jit
def block_step(y: Reals, r: Reals, energy: float, stiff: Reals, direction: Reals, unsmoothed: Reals) -> None:
    """Line search along the direction of conjugate gradients between blocks."""
    curvature = 0.0
    for k in range(r.size):
        curvature += direction[k] * (unsmoothed[k] + stiff[k] * direction[k])
    step = energy / curvature
    for k in range(r.size):
        y[k] += step * direction[k]
        r[k] -= step * (unsmoothed[k] + stiff[k] * direction[k])


@jit
def put_tiles(values: Reals, tiles: Indices, rows: Reals, nx: int) -> None:
    """Put the values on the listed tiles into the rows of a map, which are longer than its nx columns or as long."""
    across = nx // TILE
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
def tiles_of_rows(tiles: Indices, nx: int, top: int, rows: int) -> tuple[int, int, int]:
    """Number of the first tile of some rows of a map, from `top` on; places of the first and last but one in a list."""
    first = top // TILE * (nx // TILE)
    after = first + rows // TILE * (nx // TILE)
    return first, int(np.searchsorted(tiles, first)), int(np.searchsorted(tiles, after))


@jit
def put_on_rows(values: Reals, tiles: Indices, nx: int, top: int, rows: Reals) -> None:
    """Fill some rows of a map, from `top` on, with the values on the listed tiles, and zeros elsewhere."""
    first, a, b = tiles_of_rows(tiles, nx, top, rows.shape[0])
    rows[:] = 0.0
    put_tiles(values[a:b], tiles[a:b] - first, rows, nx)


@jit
def take_from_rows(values: Reals, tiles: Indices, nx: int, top: int, rows: Reals) -> None:
    """Fill the values on those of the listed tiles that lie in some rows of a map, from `top` on."""
    first, a, b = tiles_of_rows(tiles, nx, top, rows.shape[0])
    take_tiles(rows, tiles[a:b] - first, nx, values[a:b])


@jit
def gaps_in_contact(wall: Reals, displacement: Reals, tiles: Indices, contact: Flags) -> tuple[int, float, float]:
    """Count the nodes in contact on the listed tiles of a map; mean and variance of their gaps."""
    across = wall.shape[1] // TILE
    count = 0
    first = total = squares = 0.0
    for k in range(tiles.size):
        top, left = tiles[k] // across * TILE, tiles[k] % across * TILE
        for y in range(TILE):
            for x in range(TILE):
                if contact[k, y, x]:
                    gap = wall[top + y, left + x] + displacement[top + y, left + x]
                    if count == 0:
                        first = gap
                    count += 1
                    total += gap - first  # as differences: a sum of gaps almost alike would lose digits
                    squares += (gap - first) ** 2
    mean = total / max(count, 1)
    return count, first + mean, max(squares / max(count, 1) - mean**2, 0.0)


@jit
def wrong_gaps_of_tiles(gap: Reals, contact: Flags) -> tuple[float, float]:
    """Largest size of a gap in contact, and largest overlap elsewhere."""
    open_by = overlap = 0.0
    for k in range(gap.shape[0]):
        for y in range(TILE):
            for x in range(TILE):
                if contact[k, y, x]:
                    open_by = max(open_by, abs(gap[k, y, x]))
                else:
                    overlap = max(overlap, -gap[k, y, x])
    return open_by, overlap


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
    """Turn the gap into the displacement that touches wherever there is contact or overlap; `rows` is the change du.

    `rows` may be more and longer than those of the map.
    """
    nx = wall.shape[1]
    across = nx // TILE
    rows[:] = 0.0
    for k in range(tiles.size):
        top, left = tiles[k] // across * TILE, tiles[k] % across * TILE
        for y in range(TILE):
            for x in range(TILE):
                if contact[k, y, x] and gap[top + y, left + x] > 0.0:
                    rows[top + y, left + x] = gap[top + y, left + x]
                    gap[top + y, left + x] = 0.0
    for y in range(wall.shape[0]):
        punch, opened, added = wall[y], gap[y], rows[y]
        for x in range(nx):
            added[x] += min(opened[x], 0.0)
            opened[x] = punch[x] - max(opened[x], 0.0)


@jit
def restore_map(pressure: Reals, tiles: Indices, rows: Reals, mean: float, restoring: Reals) -> None:
    """Fill the restoring tractions of a displacement `[y, x]`: `mean` everywhere, less the pressure on the tiles.

    `rows`, which may be longer, hold the restoring tractions of the change du by `close_map`.
    """
    ny, nx = restoring.shape
    across = nx // TILE
    for y in range(ny):
        for x in range(nx):
            restoring[y, x] = rows[y, x] + mean
    for k in range(tiles.size):
        top, left = tiles[k] // across * TILE, tiles[k] % across * TILE
        for y in range(TILE):
            for x in range(TILE):
                restoring[top + y, left + x] -= pressure[k, y, x]


@jit
def tractions_around(rows: Reals, ny: int, nx: int, width: int, traction: float) -> tuple[float, float]:
    """Largest size and sum of a traction less the values of all rows beyond ny x nx nodes, up to a width."""
    largest = 0.0
    total = 0.0
    for y in range(rows.shape[0]):
        row = rows[y]
        for x in range(nx if y < ny else 0, width):
            largest = max(largest, abs(traction - row[x]))
            total += traction - row[x]
    return largest, total


@jit
def refine_pressure(p: Reals, above: Indices, share_y: Reals, left: Indices, share_x: Reals, fine: Reals) -> None:
    """Interpolate a periodic map of pressures linearly onto the rows of a finer one, whose node y, x lies beyond node
    above[y], left[x] by a share of the distance to the next. Nodes nearer to one without load get none.
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


@jit
def refine_tiles(
    p: Reals, above: Indices, down: Reals, left: Indices, right: Reals, tiles: Indices, across: int, fine: Reals
) -> None:
    """Interpolate pressures as `refine_pressure` does, onto the listed tiles of a map of `across` tiles in a row."""
    for k in range(tiles.size):
        y, x = tiles[k] // across * TILE, tiles[k] % across * TILE
        rows, columns = slice(y, y + TILE), slice(x, x + TILE)
        refine_pressure(p, above[rows], down[rows], left[columns], right[columns], fine[k])


@jit
def refine_map(coarse: Reals, above: Indices, down: Reals, left: Indices, right: Reals, fine: Reals) -> None:
    """Interpolate a periodic map linearly onto the rows of a finer one, whose nodes lie as in `refine_pressure`."""
    ny, nx = coarse.shape
    row = np.empty(nx + 1)
    for y in range(above.size):
        first, second, share = coarse[above[y]], coarse[(above[y] + 1) % ny], down[y]
        for x in range(nx):
            row[x] = first[x] + share * (second[x] - first[x])
        row[nx] = row[0]
        for x in range(left.size):
            fine[y, x] = row[left[x]] + right[x] * (row[left[x] + 1] - row[left[x]])


@jit
def near_tractions(stencil: Reals, displacement: Reals, nodes: Indices, tractions: Reals) -> None:
    """Tractions on the nodes of some rows of a map that a stencil `[2 m + 1, 2 m + 1]` of near neighbours causes.

    The displacement `[row, x]` has m more rows before and after those, and goes on along x as a period.
    """
    reach = stencil.shape[0] // 2
    nx = displacement.shape[1]
    for k in range(nodes.size):
        y, x = nodes[k] // nx, nodes[k] % nx
        total = 0.0
        for dy in range(2 * reach + 1):
            for dx in range(2 * reach + 1):
                column = x + dx - reach  # wrapped by hand: divisions would take most of the time
                column += nx if column < 0 else (-nx if column >= nx else 0)
                total += stencil[dy, dx] * displacement[y + dy, column]
        tractions[k] = total
