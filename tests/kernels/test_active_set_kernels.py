"""Kernels of the active-set Newton method against plain NumPy twins, compiled and as Python."""

import numpy as np
import pytest

from gfmd_numba import kernels
from support.kernel_twins import both

N, PADDED = 13, 16
CONTACT = np.array([1, 1, 0, 0, 0, 0, 1, 0, 1, 1, 0, 0, 1, 0, 0, 0], dtype=bool)
NODES = np.array([6, 8, 9, 12, 0, 1])  # begin behind the widest gap, nodes 2 to 5


def listed(kernel, contact, n):
    nodes = np.full(n, -1)
    return nodes[: kernel(contact, n, nodes)].tolist()


@pytest.mark.parametrize("kernel", both(kernels.contact_nodes))
def test_contact_nodes_begin_behind_the_widest_gap(kernel):
    assert listed(kernel, CONTACT, N) == NODES.tolist()
    assert listed(kernel, np.roll(CONTACT[:N], -2), N) == [4, 6, 7, 10, 11, 12]  # the widest gap ends the period
    assert listed(kernel, np.arange(5) == 3, 5) == [3]
    assert listed(kernel, np.zeros(5, dtype=bool), 5) == []
    assert listed(kernel, np.ones(5, dtype=bool), 5) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("kernel", both(kernels.closing_displacement))
def test_closing_displacement_is_its_plain_twin(kernel, rng):
    gap, r = rng.normal(size=(2, PADDED))
    assert kernel(gap, NODES, r) == pytest.approx(-gap[NODES].sum(), abs=1e-13)
    np.testing.assert_array_equal(r[:6], -gap[NODES])


@pytest.mark.parametrize("kernel", both(kernels.newton_change))
@pytest.mark.parametrize("error_of", both(kernels.newton_error))
def test_the_sizes_of_a_change_of_pressure_and_its_error(error_of, kernel, rng):
    """A share of a uniform displacement is taken off; uphill, or where all is closed to rounding, there is no error."""
    z, p = rng.normal(size=(2, PADDED))
    uniform = rng.random(6)
    for share in (0.3, 0.0):
        change = z[:6] - share * uniform
        r = change + 0.1 * rng.normal(size=6)
        size = max(abs(change).max() / abs(p[NODES]).max(), abs(change).sum() / abs(p[NODES]).sum())
        for sign, rounding, error in ((1, 0.0, size), (-1, 0.0, 0.0), (1, 10.0, 0.0)):
            new = z.copy()
            found = kernel(sign * r, new, uniform if share else np.full(6, np.nan), share, p, NODES)
            largest = abs(change).max(), abs(p[NODES]).max(), abs(r).max()
            sizes = sign * r @ change, *largest, abs(change).sum(), abs(p[NODES]).sum()
            np.testing.assert_allclose(found, sizes, rtol=1e-13)
            assert error_of(found, rounding) == pytest.approx(error, rel=1e-13)
            np.testing.assert_allclose(new[:6], change, rtol=1e-13)


@pytest.mark.parametrize("work", both(kernels.work_done))
@pytest.mark.parametrize("kernel", both(kernels.newton_direction))
@pytest.mark.parametrize("curvature", both(kernels.curvature))
def test_a_newton_direction_is_conjugate_to_the_last(curvature, kernel, work, rng):
    """With beta from the work of z on the last displacement, that direction does none."""
    root = rng.normal(size=(6, 6))
    stiff, z, last = root @ root.T, *rng.normal(size=(2, 6))
    t, st = np.zeros((2, N))
    t[NODES], st[NODES] = last, stiff @ last
    assert work(z, st, NODES) == pytest.approx(z @ stiff @ last)
    assert curvature(t, st, NODES) == pytest.approx(last @ stiff @ last)
    kernel(z, -work(z, st, NODES) / curvature(t, st, NODES), NODES, t)
    assert curvature(t, st, NODES) == pytest.approx(0.0, abs=1e-9)
    assert not t[~CONTACT[:N]].any()


@pytest.mark.parametrize("kernel", both(kernels.newton_update))
def test_newton_update_is_its_plain_twin(kernel, rng):
    p, gap, t, st, r = rng.normal(size=(5, PADDED))
    t[:N][~CONTACT[:N]] = 0.0
    expected_p, expected_r = p[:N] + 0.3 * t[:N], r[:6] - 0.3 * st[NODES]
    assert kernel(kernels.Iterate(p, gap, t, st), 0.3, NODES, r) == pytest.approx(expected_r.sum())
    np.testing.assert_allclose(p[:N], expected_p, rtol=1e-13)
    np.testing.assert_allclose(r[:6], expected_r, atol=1e-13)


@pytest.mark.parametrize("kernel", both(kernels.quotient))
def test_a_quotient_by_nothing_is_infinite(kernel):
    with np.errstate(divide="ignore"):
        assert (kernel(np.float64(3.0), np.float64(2.0)), kernel(np.float64(1.0), np.float64(0.0))) == (1.5, np.inf)


@pytest.mark.parametrize("kernel", both(kernels.add_displacement))
def test_a_step_opens_the_gap_by_its_displacement(kernel, rng):
    gap, st = rng.normal(size=(2, N))
    expected = gap + 0.3 * st
    kernel(gap, st, 0.3)
    np.testing.assert_allclose(gap, expected, rtol=1e-13)


@pytest.mark.parametrize("kernel", both(kernels.sum_from))
def test_gaps_are_added_up_from_the_first(kernel, rng):
    gap = rng.normal(size=N)
    assert kernel(gap, 0.3, NODES) == pytest.approx((gap[NODES] - 0.3).sum())


@pytest.mark.parametrize("approach", [0.3, 0.0])
@pytest.mark.parametrize("kernel", both(kernels.revise_contact))
def test_revise_contact_is_its_plain_twin(kernel, approach, rng):
    contact, p = CONTACT.copy(), np.where(CONTACT, 1.0 + rng.random(PADDED), 0.0)
    p[8] = -0.1
    gap = np.where(CONTACT, 0.3, 1.0)
    gap[[3, 4]] = approach - 1e-9, approach - 0.5
    opened = gap - approach
    changed, total = kernel(p, gap, contact, approach, 1e-6)
    leaves, joins = [8], [4]
    assert changed == 2
    assert contact.tolist() == [(CONTACT[j] or j in joins) and j not in leaves for j in range(PADDED)]
    assert p[8] == 0.0
    assert total == pytest.approx(p.sum())
    np.testing.assert_array_equal(gap, opened)


@pytest.mark.parametrize("alone", [False, True])
@pytest.mark.parametrize("signed", [False, True])
@pytest.mark.parametrize("solve", both(kernels.exponential_sum_solve))
@pytest.mark.parametrize("factor", both(kernels.exponential_sum_factor))
def test_decays_are_those_of_dense_algebra(factor, solve, signed, alone, rng):
    """Also decays that grow, and differences of decays, as long as the sum is positive definite."""
    n, count, terms = 40, 7, 3
    nodes = np.array([31, 33, 34, 35, 2, 9, 10])
    along = np.array([31, 33, 34, 35, 42, 49, 50])
    rates, weights = np.array([1.5, 0.3, -0.1 if signed else 0.02]), np.array([0.7, 2.0, -1e-3 if signed else 3.0])
    distance = abs(along[:, np.newaxis] - along)
    own = rng.random(count) if alone else np.empty(0)
    dense = (weights * np.exp(-rates * distance[..., np.newaxis])).sum(axis=-1) + 0.5 * np.eye(count)
    dense[np.diag_indices(count)] += own if alone else 0.0
    assert np.linalg.eigvalsh(dense).min() > 0.1
    factors = kernels.Factors(*np.full((2, count, terms), np.nan), np.empty(count), np.empty((terms, terms)))
    z, y = np.empty(count), rng.normal(size=count)
    decays = kernels.Decays(rates, np.exp(-np.outer(np.arange(2), rates)), weights, 0.5, 1e-3)
    factor(decays, factors, nodes, count, n, own)
    solve(y, count, weights, factors, z)
    np.testing.assert_allclose(z, np.linalg.solve(dense, y), rtol=1e-11)


@pytest.mark.parametrize("factor", both(kernels.exponential_sum_factor))
def test_pivots_are_lifted_to_the_floor(factor):
    decays = kernels.Decays(np.array([0.1]), np.empty((0, 1)), np.array([-1.0]), 0.5, 0.2)
    factors = kernels.Factors(*np.empty((2, 3, 1)), np.empty(3), np.empty((1, 1)))
    factor(decays, factors, np.arange(3), 3, 9, np.empty(0))
    assert factors.diagonal.min() == 0.2
