"""Kernels of contacts on a sum of decays against plain NumPy twins, compiled and as Python."""

import numpy as np
import pytest

from gfmd_numba import kernels
from gfmd_numba.kernels.exponential_sums import (
    POWERS,
    begin_behind_widest_gap,
    candidates,
    distances_around,
    far_powers,
    join_deepest,
)
from support.kernel_twins import both


def periodic_sum(bases, weights, white, mean, n):
    """Matrix of the sum over all images, by adding up images until none is felt."""
    d = (np.arange(n)[:, np.newaxis] - np.arange(n)) % n
    images = np.arange(100)  # the slowest base to the power of 100 n is 1e-130
    ahead = sum(
        w * np.array([(b ** (k + images * n)).sum() for k in range(n)]) for b, w in zip(bases, weights, strict=True)
    )
    behind = np.concatenate(([0.0], ahead[:0:-1]))
    behind[0] = ahead[0] - weights.sum()  # the node itself counts once
    return (ahead + behind)[d] - weights.sum() * np.eye(n) + white * np.eye(n) + mean


@pytest.mark.parametrize("n", [150, 151])
@pytest.mark.parametrize("product", both(kernels.decay_product))
@pytest.mark.parametrize("chosen", ["few", "all", "one"])
def test_a_product_with_decays_is_that_with_their_matrix_and_all_images(product, chosen, n, rng):
    rates = np.sort(np.concatenate((np.geomspace(0.02, 2.0, 8), np.geomspace(0.03, 1.0, 8))))
    bases = np.exp(-rates) * np.where(np.arange(16) % 3 == 0, -1.0, 1.0)
    weights = rng.normal(size=16)
    nodes = {"few": np.array([90, 91, 93, 99, 5, 80]), "all": np.arange(n), "one": np.array([3])}[chosen]
    source, found = rng.normal(size=(2, nodes.size))
    distances, rows = np.empty((2, nodes.size), dtype=np.int64)
    distances_around(nodes, nodes.size, n, distances)
    powers = np.concatenate([bases ** (np.arange(POWERS)[:, np.newaxis] * POWERS**digit) for digit in range(2)])
    near = np.concatenate((powers[:POWERS], np.full((n // POWERS + 1, 16), np.nan)))
    assert far_powers(powers, near, distances, nodes.size, POWERS, rows) <= len(near)
    np.testing.assert_allclose(near[rows], bases ** distances[:, np.newaxis], rtol=1e-12)
    fine = kernels.DecaySum(powers, near, np.stack((weights, 1.0 / (1.0 - bases**n))), 1.5, 0.25)
    product(rows, nodes.size, fine, source, found)
    matrix = periodic_sum(bases, weights, 1.5, 0.25, n)[np.ix_(nodes, nodes)]
    np.testing.assert_allclose(found, matrix @ source, atol=1e-5 * abs(weights).sum())


@pytest.mark.parametrize("sum_squares", both(kernels.power))
def test_a_power_is_the_sum_of_squares_without_the_mean(sum_squares, rng):
    spectrum, symbol = rng.normal(size=9) + 1j * rng.normal(size=9), rng.normal(size=9)
    assert sum_squares(spectrum, symbol) == pytest.approx((abs(spectrum * symbol)[1:] ** 2).sum(), rel=1e-13)


@pytest.mark.parametrize("solve", both(kernels.least_squares))
def test_least_squares_are_those_of_lapack(solve, rng):
    matrix, right, found = rng.normal(size=(20, 5)), rng.normal(size=20), np.empty(5)
    expected = np.linalg.lstsq(matrix, right, rcond=None)[0]
    solve(matrix.copy(), right.copy(), found)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize("begin", both(begin_behind_widest_gap))
def test_lists_begin_behind_the_widest_gap(begin):
    nodes = np.empty(5, dtype=np.int64)
    begin(np.array([1, 2, 3, 9, 11]), 5, 13, nodes)
    assert nodes.tolist() == [9, 11, 1, 2, 3]


@pytest.mark.parametrize("free_mean", [True, False])
@pytest.mark.parametrize("find", both(candidates))
def test_candidates_are_open_by_less_than_the_mean_misfit(find, free_mean, rng):
    n = 40
    p, (wall, sp) = np.where(rng.random(n) < 0.3, 1.0, 0.0), rng.normal(size=(2, n))
    nodes, spare = np.empty((2, n), dtype=np.int64)
    count, approach = find(p, sp, wall, n, free_mean, 0.7, nodes, spare)
    gap = wall + sp
    expected = gap[p > 0].mean() if free_mean else 0.0
    widest = expected + 0.7 * abs(gap[p > 0] - expected).mean()
    assert approach == pytest.approx(expected)
    assert sorted(nodes[:count]) == np.flatnonzero((p > 0) | (gap <= widest)).tolist()
    assert find(p, sp, wall, n, free_mean, 0.0, nodes, spare)[0] == np.count_nonzero(p)


@pytest.mark.parametrize("join", both(join_deepest))
def test_the_deepest_of_each_stretch_of_overlap_joins(join):
    gap = np.array([-1.0, -3.0, -2.0, -9.0, 1.0, -0.2, -0.1])
    touches = np.array([False, False, False, True, False, False, False])
    assert join(gap, touches, np.array([4, 5, 6, 7, 8, 9, 11]), 7, 0.0) == 4
    assert np.flatnonzero(touches).tolist() == [1, 2, 3, 5, 6]  # the last node is not next to the one before


@pytest.mark.parametrize("free_mean", [True, False])
@pytest.mark.parametrize("touch", both(kernels.touching_displacement))
def test_a_touching_displacement_overlaps_nowhere(touch, free_mean, rng):
    p, sp, wall, u = np.array([1.0, 0, 0, 2, 0, 0]), *rng.normal(size=(3, 6))
    touch(p, sp, wall, 6, free_mean, u)
    approach = (wall + sp)[p > 0].mean() if free_mean else 0.0
    np.testing.assert_allclose(u, wall - np.where(p > 0, 0.0, np.maximum(wall + sp - approach, 0.0)), atol=1e-15)


def test_the_approach_of_many_nodes_keeps_its_digits(rng):
    n = 200_000
    p, u = np.ones(n), np.empty(n)
    wall = rng.uniform(0.0, 1e-2, n)
    sp = 0.012345 - wall
    p[-1], sp[-1] = 0.0, sp[-1] + 1e-3  # an open node: by as much as its wall and displacement say
    kernels.touching_displacement(p, sp, wall, n, True, u)
    assert wall[-1] - u[-1] == pytest.approx(1e-3, abs=1e-17)
    _, approach = candidates(p, sp, wall, n, True, 0.0, *np.empty((2, n), dtype=np.int64))
    assert approach == pytest.approx(0.012345, abs=1e-17)


@pytest.mark.parametrize("refine", both(kernels.refined_pressure))
def test_a_refined_pressure_lies_between_contact_nodes_and_carries_the_load(refine):
    fine, p = np.zeros(8), np.empty(8)
    refine(np.array([0.0, 2.0, 4.0, 0.0]), 4, 3.0, True, 8, fine, p)
    expected = np.array([0, 1, 2, 3, 4, 2, 0, 0])  # halfway to an open node still touches
    np.testing.assert_allclose(p, expected * 24.0 / expected.sum())
    refine(np.array([0.0, 2.0, 0.0, 0.0]), 4, 3.0, True, 8, np.full(8, 9.0), p)
    assert p.mean() == pytest.approx(3.0)  # a flattening pressure above all the others does not count
