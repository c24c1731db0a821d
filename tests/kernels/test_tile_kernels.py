"""Kernels on tiles of a map against plain NumPy twins, compiled and as Python."""

import numpy as np
import pytest

from gfmd_numba import kernels
from gfmd_numba.solvers.tiles import newton
from support.kernel_twins import both

DOWN, ACROSS, SIDE = 3, 4, 8
NY, NX, PADDED = DOWN * SIDE, ACROSS * SIDE, ACROSS * SIDE + 6
MARKS = np.array([1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 1], dtype=bool)
TILES = np.flatnonzero(MARKS)
PLACES = np.where(MARKS, np.cumsum(MARKS) - 1, TILES.size)


def cut(image):
    """All tiles of a map, in their order."""
    return image[:, :NX].reshape(DOWN, SIDE, ACROSS, SIDE).swapaxes(1, 2).reshape(-1, SIDE, SIDE)


def joined(values):
    """Map `[y, x]` of values on the listed tiles, zero elsewhere."""
    every = np.zeros((DOWN * ACROSS, SIDE, SIDE), dtype=values.dtype)
    every[TILES] = values[:-1]
    return every.reshape(DOWN, ACROSS, SIDE, SIDE).swapaxes(1, 2).reshape(NY, NX)


def random_values(rng):
    values = rng.normal(size=(TILES.size + 1, SIDE, SIDE))
    values[-1] = 0.0
    return values


def surroundings():
    around = np.empty((TILES.size, 9), dtype=np.int64)
    kernels.surround(TILES, PLACES, DOWN, ACROSS, (False, False), around)
    return around


def test_marked_tiles_are_listed_with_their_places():
    tiles, places = newton.listed(MARKS)
    np.testing.assert_array_equal(tiles, TILES)
    np.testing.assert_array_equal(places, PLACES)


@pytest.mark.parametrize("kernel", both(kernels.surround))
@pytest.mark.parametrize("ends", [(False, False), (True, False), (False, True), (True, True)])
def test_neighbours_of_a_tile_lie_around_it_on_the_torus_or_beyond_an_end(kernel, ends):
    around = np.empty((TILES.size, 9), dtype=np.int64)
    kernel(TILES, PLACES, DOWN, ACROSS, ends, around)
    places = PLACES.reshape(DOWN, ACROSS)
    for axis, end in enumerate(ends):
        edge = [(0, 0), (0, 0)]
        edge[axis] = (1, 1)
        places = np.pad(places, edge, constant_values=TILES.size) if end else np.pad(places, edge, mode="wrap")
    for tile, found in zip(TILES, around, strict=True):
        y, x = divmod(tile, ACROSS)
        np.testing.assert_array_equal(found.reshape(3, 3), places[y : y + 3, x : x + 3])


def sharing(weights, per_tile):
    """Matrices `[coarse node, node]` that share values along y and along x among the coarse nodes of a torus."""
    before = (weights.shape[1] - per_tile - 1) // 2

    def along(tiles):
        matrix = np.zeros((per_tile * tiles, SIDE * tiles))
        for t in range(tiles):
            for a in range(weights.shape[1]):
                matrix[(per_tile * t - before + a) % (per_tile * tiles), SIDE * t : SIDE * (t + 1)] += weights[:, a]
        return matrix

    return along(DOWN), along(ACROSS)


@pytest.mark.parametrize(("per_tile", "wide"), [(2, 5), (1, 6)])
@pytest.mark.parametrize("kernel", both(kernels.spread))
def test_values_are_shared_among_coarse_nodes(kernel, per_tile, wide, rng):
    down, across = per_tile * DOWN, per_tile * ACROSS
    values, weights, coarse = random_values(rng), rng.random((SIDE, wide)), rng.random((down, across + 3))
    rows, columns = sharing(weights, per_tile)
    kernel(values, TILES, ACROSS, per_tile, weights, coarse, down, across)
    np.testing.assert_allclose(coarse[:, :across], rows @ joined(values) @ columns.T, atol=1e-12)


@pytest.mark.parametrize(("per_tile", "wide"), [(2, 5), (1, 6)])
@pytest.mark.parametrize("kernel", both(kernels.gather_back))
def test_values_are_read_back_as_they_were_shared(kernel, per_tile, wide, rng):
    down, across = per_tile * DOWN, per_tile * ACROSS
    values, weights, coarse = random_values(rng), rng.random((SIDE, wide)), rng.random((down, across + 3))
    rows, columns = sharing(weights, per_tile)
    expected = cut(joined(values) + rows.T @ coarse[:, :across] @ columns)[TILES]
    kernel(coarse, TILES, ACROSS, per_tile, weights, down, across, values)
    np.testing.assert_allclose(values[:-1], expected, atol=1e-12)


@pytest.mark.parametrize("ends", [(False, False), (True, False), (False, True)])
@pytest.mark.parametrize("short", [0, 10])
@pytest.mark.parametrize("kernel", both(kernels.convolve_loaded))
def test_loaded_nodes_are_convolved_with_a_kernel_of_some_tiles(kernel, short, ends, rng):
    """Random nodes of the listed tiles against shifted maps, on a torus or an end."""
    values, product = random_values(rng) * (rng.random((TILES.size + 1, SIDE, SIDE)) < 0.3), np.empty((8, SIDE, SIDE))
    loaded = np.empty(len(values) + 1, dtype=np.int64), np.empty(values.size, dtype=np.int64), np.empty(values.size)
    kernels.list_loaded(values, *loaded)
    reach = 2 * SIDE - 1
    around = rng.normal(size=(2 * reach + 1, 2 * reach + 1))
    around += around[::-1, ::-1]
    if short:
        around = np.pad(around[short:-short, short:-short], short)
    kernel(loaded, TILES, PLACES, (DOWN, ACROSS), ends, around, reach - short, product)
    pad = [(2 * SIDE, 2 * SIDE)] * 2
    image, expected = joined(values), np.empty((TILES.size, SIDE, SIDE))
    for axis, end in enumerate(ends):
        wide = [(0, 0), (0, 0)]
        wide[axis] = pad[axis]
        image = np.pad(image, wide) if end else np.pad(image, wide, mode="wrap")
    for k, tile in enumerate(TILES):
        y, x = tile // ACROSS * SIDE, tile % ACROSS * SIDE
        near = image[y + SIDE : y + 4 * SIDE, x + SIDE : x + 4 * SIDE]  # the tile and those around it
        for j in range(SIDE):
            for i in range(SIDE):
                rows, columns = (reach - SIDE - n + np.arange(3 * SIDE) for n in (j, i))
                expected[k, j, i] = (near * around[np.ix_(rows, columns)]).sum()
    np.testing.assert_allclose(product[: TILES.size], expected, atol=1e-12)


@pytest.mark.parametrize("kernel", both(kernels.near_pressure))
def test_a_node_feels_its_neighbours_and_blocks_their_sums(kernel, rng):
    """Of the tiles from the second to the last but one, against shifted maps of a period."""
    some, stencil, blocks = (1, TILES.size - 1), rng.random((3, 3)), rng.integers(0, 4, TILES.size)
    stencil += stencil[::-1]
    stencil += stencil[:, ::-1]
    nodes = np.flatnonzero(rng.random((TILES.size, SIDE, SIDE)) < 0.5)
    u, isolated, p, sums = (
        np.zeros((TILES.size + 1, SIDE, SIDE)),
        rng.random(nodes.size),
        np.zeros(nodes.size),
        np.zeros(4),
    )
    u.flat[nodes] = rng.random(nodes.size)
    kernel(u, nodes, some, (surroundings(), blocks), stencil, isolated, p, sums)
    image = sum(stencil[1 + y, 1 + x] * np.roll(joined(u), (y, x), axis=(0, 1)) for y in (-1, 0, 1) for x in (-1, 0, 1))
    tile = nodes // SIDE**2
    inside = (tile >= some[0]) & (tile < some[1])
    np.testing.assert_allclose(p[inside], cut(image)[TILES].flat[nodes[inside]])
    assert not p[~inside].any()
    moved = (isolated * u.flat[nodes])[inside]
    np.testing.assert_allclose(sums, np.bincount(blocks[tile[inside]], moved, minlength=4))


@pytest.mark.parametrize("kernel", both(kernels.surrounded))
def test_a_tile_is_surrounded_by_the_nodes_next_to_it(kernel, rng):
    values, around, halo = random_values(rng), surroundings(), np.empty((SIDE + 2, SIDE + 2))
    image = np.pad(joined(values), 1, mode="wrap")
    for k, tile in enumerate(TILES):
        y, x = tile // ACROSS * SIDE, tile % ACROSS * SIDE
        kernel(values, k, around[k], halo)
        np.testing.assert_array_equal(halo, image[y : y + SIDE + 2, x : x + SIDE + 2])


@pytest.mark.parametrize("kernel", both(kernels.put_nodes))
def test_values_are_put_on_nodes(kernel, rng):
    nodes, image = rng.permutation(9)[:4], np.full(9, 7.0)
    kernel(np.arange(4.0), nodes, image)
    assert image[nodes].tolist() == [0, 1, 2, 3]
    assert image.sum() == 41.0


@pytest.mark.parametrize("put", both(kernels.put_on_rows))
@pytest.mark.parametrize("take", both(kernels.take_from_rows))
@pytest.mark.parametrize("first", range(DOWN))
def test_tiles_on_some_rows_are_put_there_and_taken_back(first, take, put, rng):
    values, top, end = random_values(rng), first * SIDE, NY - (DOWN - 1 - first) // 2 * SIDE
    rows, found = np.full((end - top, PADDED), 7.0), np.full(values.shape, 7.0)
    put(values, TILES, NX, top, rows)
    np.testing.assert_array_equal(rows[:, :NX], joined(values)[top:end])
    assert not rows[:, NX:].any()
    take(found, TILES, NX, top, rows)
    there = np.isin(TILES // ACROSS, np.arange(first, end // SIDE))
    np.testing.assert_array_equal(found[:-1][there], values[:-1][there])
    assert (found[:-1][~there] == 7.0).all()
    assert (found[-1] == 7.0).all()


@pytest.mark.parametrize("kernel", both(kernels.subtract_far_pressure))
def test_what_a_block_shares_is_taken_off(kernel, rng):
    nodes = np.sort(rng.permutation(5 * SIDE**2)[:20])
    p, isolated, shared, blocks = rng.random(20), rng.random(20), rng.random(4), rng.integers(0, 4, 5)
    expected = p - isolated * shared[blocks[nodes // SIDE**2]]
    kernel(p, nodes, isolated, blocks, shared)
    np.testing.assert_allclose(p, expected)


@pytest.mark.parametrize("direction_of", both(kernels.block_direction))
@pytest.mark.parametrize("step", both(kernels.block_step))
def test_steps_between_blocks_solve_as_conjugate_gradients_do(direction_of, step, rng):
    """In as many steps as there are blocks, against a dense solve."""
    half = rng.random((5, 5))
    soft, stiff, load = half @ half.T + np.eye(5), rng.random(5), rng.random(5)
    (y, direction, unsmoothed), r, energy = np.zeros((3, 5)), load.copy(), 0.0
    for _ in range(5):
        energy = direction_of(r, soft @ r, energy, direction, unsmoothed)
        np.testing.assert_allclose(soft @ unsmoothed, direction, rtol=1e-8)
        step(y, r, energy, stiff, direction, unsmoothed)
    np.testing.assert_allclose(y, np.linalg.solve(np.linalg.inv(soft) + np.diag(stiff), load), rtol=1e-8)


@pytest.mark.parametrize("kernel", both(kernels.convolve_few))
def test_few_nodes_are_convolved_with_the_kernel_of_a_period(kernel, rng):
    symbol, load, product = rng.random((6, 9)), np.zeros((6, 9)), np.empty(7)
    symbol += np.roll(symbol[::-1], 1, axis=0)
    symbol += np.roll(symbol[:, ::-1], 1, axis=1)
    where = np.divmod(rng.permutation(54)[:7], 9)
    load[where] = rng.random(7)
    kernel(load[where], *where, np.fft.ifft2(symbol).real, product)
    np.testing.assert_allclose(product, np.fft.ifft2(np.fft.fft2(load) * symbol).real[where], atol=1e-14)


@pytest.mark.parametrize("kernel", both(kernels.put_tiles))
def test_tiles_are_put_on_a_map(kernel, rng):
    values, rows = random_values(rng), np.zeros((NY, PADDED))
    kernel(values, TILES, rows, NX)
    np.testing.assert_array_equal(rows[:, :NX], joined(values))


@pytest.mark.parametrize("kernel", both(kernels.take_tiles))
def test_tiles_are_taken_from_a_map(kernel, rng):
    values, rows = random_values(rng), rng.random((NY, PADDED))
    kernel(rows, TILES, NX, values)
    np.testing.assert_array_equal(values[:-1], cut(rows)[TILES])
    assert not values[-1].any()


@pytest.mark.parametrize("kernel", both(kernels.gaps_in_contact))
def test_gaps_in_contact_have_a_mean_and_a_variance(kernel, rng):
    wall, rows, contact = rng.random((NY, NX)), rng.random((NY, PADDED)), rng.random((TILES.size + 1, SIDE, SIDE)) < 0.3
    contact[-1] = False
    gaps = (wall + rows[:, :NX])[joined(contact)]
    np.testing.assert_allclose(kernel(wall, rows, TILES, contact), (gaps.size, gaps.mean(), gaps.var()))
    assert kernel(wall, rows, TILES, np.zeros_like(contact)) == (0, 0.0, 0.0)


@pytest.mark.parametrize("kernel", both(kernels.wrong_gaps_of_tiles))
def test_wrong_gaps_are_those_in_contact_and_overlaps_elsewhere(kernel, rng):
    gap = rng.normal(size=(TILES.size, SIDE, SIDE))
    contact = rng.random(gap.shape) < 0.5
    for signed in (gap, -gap):
        assert kernel(signed, contact) == (abs(signed[contact]).max(), -signed[~contact].min())
    assert kernel(abs(gap), np.zeros_like(contact)) == (0.0, 0.0)


@pytest.mark.parametrize("kernel", both(kernels.open_map))
def test_tiles_whose_gap_is_small_are_marked(kernel, rng):
    wall, rows, gap = rng.random((NY, NX)), rng.random((NY, PADDED)), np.empty((NY, NX))
    marks = np.zeros(MARKS.size, dtype=bool)
    kernel(wall, rows, 0.3, -0.2, gap, marks)
    np.testing.assert_array_equal(gap, wall + rows[:, :NX] - 0.3)
    np.testing.assert_array_equal(marks, (cut(gap) < -0.2).any(axis=(1, 2)))
    assert 0 < marks.sum() < marks.size


@pytest.mark.parametrize("kernel", both(kernels.close_map))
def test_the_displacement_touches_in_contact_and_overlap(kernel, rng):
    wall, gap, rows = rng.random((NY, NX)), rng.normal(size=(NY, NX)), np.empty((NY + 3, PADDED))
    contact = random_values(rng) > 0.5
    contact[-1] = False
    expected = np.where(joined(contact), wall, wall - np.maximum(gap, 0.0))
    added = np.where(joined(contact), gap, np.minimum(gap, 0.0))
    kernel(wall, gap, contact, TILES, rows)
    np.testing.assert_array_equal(gap, expected)
    np.testing.assert_array_equal(rows, np.pad(added, ((0, 3), (0, PADDED - NX))))


@pytest.mark.parametrize("kernel", both(kernels.restore_map))
def test_what_restores_a_displacement_is_less_by_the_pressure_that_caused_it(kernel, rng):
    pressure, rows = random_values(rng), rng.random((NY, PADDED))
    restoring = np.empty((NY, NX))
    kernel(pressure, TILES, rows, 0.3, restoring)
    np.testing.assert_allclose(restoring, rows[:, :NX] + 0.3 - joined(pressure), atol=1e-15)


@pytest.mark.parametrize("kernel", both(kernels.tractions_around))
def test_tractions_around_a_corner_are_those_beyond_it(kernel, rng):
    rows = rng.normal(size=(NY, PADDED))
    beyond = 0.2 - np.concatenate((rows[5:, :NX].ravel(), rows[:5, 7:NX].ravel()))
    assert kernel(rows, 5, 7, NX, 0.2) == pytest.approx((abs(beyond).max(), beyond.sum()))


@pytest.mark.parametrize("kernel", both(kernels.refine_pressure))
def test_a_pressure_is_interpolated_inside_its_contact(kernel):
    p, fine = np.array([[0.0, 4.0, 2.0]]), np.empty((2, 6 + 1))
    left, share = np.arange(6) // 2, np.arange(6) % 2 / 2.0
    kernel(p, np.zeros(2, dtype=np.int64), np.array([0.0, 0.5]), left, share, fine)
    np.testing.assert_array_equal(fine[:, :6], [[0.0, 2.0, 4.0, 3.0, 2.0, 1.0]] * 2)
    kernel(p, np.zeros(2, dtype=np.int64), np.array([0.0, 0.5]), left, 0.4 * share, fine)
    np.testing.assert_allclose(fine[:, :6], [[0.0, 0.0, 4.0, 3.6, 2.0, 1.6]] * 2)


@pytest.mark.parametrize("kernel", both(kernels.refine_map))
def test_a_map_is_interpolated_linearly(kernel):
    coarse, fine = np.array([[0.0, 4.0, 2.0], [1.0, 1.0, 1.0]]), np.empty((2, 6))
    left, share = np.arange(6) // 2, np.arange(6) % 2 / 2.0
    kernel(coarse, np.array([0, 1]), np.array([0.0, 0.25]), left, share, fine)
    np.testing.assert_allclose(fine, [[0.0, 2.0, 4.0, 3.0, 2.0, 1.0], [0.75, 1.25, 1.75, 1.5, 1.25, 1.0]])


@pytest.mark.parametrize("kernel", both(kernels.refine_tiles))
def test_tiles_take_what_the_whole_map_would(kernel, rng):
    p, fine, whole = rng.random((12, 16)) - 0.3, np.zeros((TILES.size + 1, SIDE, SIDE)), np.empty((NY, NX))
    places = [divmod(k, 2) for k in range(NX)]
    at, share = np.array([a for a, _ in places]), np.array([b / 2.0 for _, b in places])
    kernels.refine_pressure(p, at[:NY], share[:NY], at, share, whole)
    kernel(p, at[:NY], share[:NY], at, share, TILES, ACROSS, fine)
    np.testing.assert_array_equal(fine[:-1], cut(whole)[TILES])
