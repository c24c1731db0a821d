"""Kernels of a second bound against plain NumPy twins, compiled and as Python."""

import numpy as np
import pytest
from scipy.optimize import brentq

from gfmd_numba import kernels
from gfmd_numba.kernels.pressure_solvers import approach, bounded_step

N, HARDNESS = 40, 0.7


def both(kernel):
    """The compiled kernel and what it was compiled from, which are one and the same with NUMBA_DISABLE_JIT=1."""
    source = getattr(kernel, "py_func", kernel)
    return pytest.param(kernel, id=f"{kernel.__name__}-compiled"), pytest.param(source, id=f"{kernel.__name__}-python")


@pytest.fixture
def rng():
    return np.random.default_rng(1)


def pressures(rng, n=N):
    """Open, free and plastic nodes."""
    return np.clip(rng.uniform(-0.7, 1.4, n), 0.0, HARDNESS)


def shifted(p, total):
    """The nearest pressures between the bounds that add up to a total."""
    move = brentq(lambda s: np.clip(p + s, 0.0, HARDNESS).sum() - total, -1e5, 1e5, xtol=1e-15)
    return np.clip(p + move, 0.0, HARDNESS)


@pytest.mark.parametrize("kernel", both(kernels.bound))
@pytest.mark.parametrize("share", [1e-6, 0.1, 0.5, 0.95, 1.0 - 1e-9])
@pytest.mark.parametrize("size", [1e-6, 1.0, 1e4])
def test_bound_is_the_nearest_pressure_that_carries_the_load(kernel, share, size, rng):
    p = rng.normal(size=N) * size
    total = share * N * HARDNESS
    expected = shifted(p, total)
    kernel(p, np.ones(N, dtype=bool), total, HARDNESS, N)
    np.testing.assert_allclose(p, expected, atol=1e-11 * max(size, 1.0))
    assert p.sum() == pytest.approx(total, rel=1e-9)
    assert (p >= 0.0).all()
    assert (p <= HARDNESS).all()


@pytest.mark.parametrize("kernel", both(kernels.bound))
def test_bound_moves_nodes_at_their_bounds_only_where_the_others_cannot_carry_the_load(kernel, rng):
    p = pressures(rng)
    movable = (p > 0.0) & (p < HARDNESS)
    fixed = p[~movable].sum()
    given, total = p.copy(), fixed + 0.3 * HARDNESS * movable.sum()
    kernel(p, movable, total, HARDNESS, N)
    np.testing.assert_array_equal(p[~movable], given[~movable])
    assert p.sum() == pytest.approx(total)
    for total in (0.5 * fixed, fixed + 1.1 * HARDNESS * movable.sum()):
        p = given.copy()
        kernel(p, movable, total, HARDNESS, N)
        np.testing.assert_allclose(p, shifted(given, total), atol=1e-13)


@pytest.mark.parametrize("kernel", both(kernels.level))
def test_level_takes_the_mean_gap_of_free_nodes(kernel, rng):
    p, gap = pressures(rng), rng.normal(size=N)
    expected = gap - gap[(p > 0.0) & (p < HARDNESS)].mean()
    kernel(p, gap, HARDNESS, N)
    np.testing.assert_allclose(gap, expected, atol=1e-15)
    p[:] = np.where(np.arange(N) < 9, HARDNESS, 0.0)
    expected = gap - 0.5 * (gap[:9].max() + gap[9:].min())
    kernel(p, gap, HARDNESS, N)
    np.testing.assert_allclose(gap, expected, atol=1e-15)
    assert approach(p, gap, 0.0, 0, N) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("kernel", both(kernels.line_search))
def test_damp_goes_back_to_the_least_energy_only_from_beyond_twice_the_way(kernel, rng):
    root = rng.normal(size=(N, N))
    matrix, punch = root @ root.T / N, rng.normal(size=N)
    start = rng.uniform(size=N)
    slope = matrix @ start + punch
    best = slope @ slope / (slope @ matrix @ slope)

    def energy(p):
        return 0.5 * p @ matrix @ p + punch @ p

    for way, back in ((0.5, 0), (1.9, 0), (2.1, 1), (9.0, 1), (-1.0, 2)):
        p = start - way * best * slope
        far, gap = p.copy(), matrix @ p + punch
        last_p, last_gap = start.copy(), slope.copy()
        assert kernel(p, gap, last_p, last_gap, N) == back
        np.testing.assert_allclose(p, start - best * slope if back == 1 else far, rtol=1e-9)
        np.testing.assert_allclose(gap, matrix @ p + punch, atol=1e-9)
        np.testing.assert_array_equal(last_p, start if back == 2 else p)
        np.testing.assert_array_equal(last_gap, slope if back == 2 else gap)
        if way > 0.0:
            assert energy(p) < energy(start)


@pytest.mark.parametrize("kernel", both(kernels.stop_at_first_bound))
def test_a_careful_step_ends_where_the_first_free_node_reaches_a_bound(kernel, rng):
    last = pressures(rng)
    contact = (last > 0.0) & (last < HARDNESS)
    p = np.where(contact, last + rng.normal(size=N), last)
    change = (p - last)[contact]
    room = np.where(change > 0.0, HARDNESS - last[contact], -last[contact]) / change
    expected = np.where(contact, last + room.min() * (p - last), last)
    first = np.flatnonzero(contact)[room.argmin()]
    free = contact.copy()
    assert kernel(p, last, free, HARDNESS, N) == 1
    np.testing.assert_allclose(p, expected, atol=1e-12)
    assert p[first] in (0.0, HARDNESS)
    np.testing.assert_array_equal(np.flatnonzero(contact & ~free), [first])
    inside = np.where(contact, 0.5 * (last + 0.3), last)
    assert kernel(inside.copy(), last, contact, HARDNESS, N) == 0


@pytest.mark.parametrize("kernel", both(kernels.wrong_gaps))
@pytest.mark.parametrize("free_mean", [True, False])
def test_wrong_gaps_are_overlaps_of_open_nodes_and_openings_of_plastic_ones(kernel, free_mean, rng):
    p, gap, t = pressures(rng), rng.normal(size=N), np.full(N, np.nan)
    free = (p > 0.0) & (p < HARDNESS)
    nodes = np.flatnonzero(free)
    expected = gap - (gap[free].mean() if free_mean else 0.0)
    wrong = ((p == 0.0) & (expected < -0.2)) | ((p == HARDNESS) & (expected > 0.2))
    square = kernel(kernels.Iterate(p, gap, t, t), nodes, nodes.size, N, 0.2, free_mean)
    np.testing.assert_allclose(gap, expected, atol=1e-15)
    np.testing.assert_allclose(t, np.where(wrong, expected, 0.0), atol=1e-15)
    assert square == pytest.approx((expected[wrong] ** 2).sum())
    assert wrong.any()


@pytest.mark.parametrize("kernel", both(kernels.revise_bounds))
@pytest.mark.parametrize("free_mean", [True, False])
@pytest.mark.parametrize("stiff", [1e-3, 1e3])
def test_revise_bounds_steps_against_wrong_gaps(kernel, free_mean, stiff, rng):
    """By so little that all nodes stay in between, or across both bounds: then all may move."""
    p, gap = pressures(rng), rng.normal(size=N)
    contact = (p > 0.0) & (p < HARDNESS)
    p[np.flatnonzero(contact)[:2]] = -0.1, 0.9  # what the linear problem left outside
    wrong = ~contact & (((p == 0.0) & (gap < 0.0)) | ((p == HARDNESS) & (gap > 0.0)))
    t = np.where(wrong, gap, 0.0)
    st = t / stiff
    across = free_mean and stiff > 1.0
    moved = np.where(contact, p, p - stiff * (gap if stiff > 1.0 else t))
    if free_mean:
        expected = np.where(contact | wrong | across, moved, p)
        some = contact | wrong | across
        rest = 0.3 * N - expected[~some].sum()
        expected[some] = shifted(expected[some], rest)
    else:
        expected = np.clip(moved, 0.0, HARDNESS)
    args = ((t**2).sum(), contact, N, 0.3, HARDNESS, free_mean)
    assert kernel(kernels.Iterate(p, gap, t, st), *args) == wrong.sum() + 2
    np.testing.assert_allclose(p, expected, atol=1e-12)
    np.testing.assert_array_equal(contact, (p > 0.0) & (p < HARDNESS))
    assert kernel(kernels.Iterate(p, gap, np.zeros(N), st), 0.0, *args[1:]) == 0


@pytest.mark.parametrize("kernel", both(bounded_step))
@pytest.mark.parametrize("free_mean", [True, False])
def test_bounded_step_follows_the_direction_on_free_nodes_and_the_gap_elsewhere(kernel, free_mean, rng):
    p, gap = pressures(rng), rng.normal(size=N)
    free = (p > 0.0) & (p < HARDNESS)
    t = np.where(free, rng.normal(size=N), 0.0)
    moved = p - 0.1 * np.where(free, t, gap)
    expected = shifted(moved, 0.3 * N) if free_mean else np.clip(moved, 0.0, HARDNESS)
    joined = (~free & (expected > 0.0) & (expected < HARDNESS)).any()
    assert joined
    assert kernel(kernels.Iterate(p, gap, t, t), 0.1, 0.3, HARDNESS, N, free_mean) == 0.0
    np.testing.assert_allclose(p, expected, atol=1e-13)
    p = np.where(free, 0.3, np.where(expected > 0.3, HARDNESS, 0.0))
    gap = np.where(p > 0.3, -9.0, 9.0)
    t = np.where(free, t - t[free].mean(), 0.0)
    assert kernel(kernels.Iterate(p, gap, t, t), 1e-3, p.mean(), HARDNESS, N, free_mean) == 1.0


@pytest.mark.parametrize("kernel", both(kernels.wall_violation))
def test_the_certificate_holds_both_bounds(kernel, rng):
    punch, ku = rng.normal(size=(2, 1, N))
    u = punch - np.round(rng.uniform(-1.0, 1.0, size=(1, N)))  # open, touching and penetrating nodes
    traction = 0.3 - ku[0]
    allowed = np.where(u[0] < punch[0], 0.0, np.where(u[0] > punch[0], HARDNESS, np.clip(traction, 0.0, HARDNESS)))
    worst, peak, imbalance = np.zeros((3, 1))
    state = kernels.SurfaceState.of_normal(u, ku, punch, np.array([0.3]))
    kernel(state, kernels.ContactLimits(HARDNESS), np.array([0]), N, worst, peak, imbalance)
    assert worst[0] == pytest.approx(abs(traction - allowed).max())
    assert peak[0] == HARDNESS
    assert imbalance[0] == pytest.approx(abs((traction - allowed).mean()))
    kernels.wall_pressure(state, HARDNESS, np.array([0]), N)
    np.testing.assert_array_equal(ku[0], allowed)


@pytest.mark.parametrize("kernel", both(kernels.close_gap))
def test_close_gap_lets_plastic_nodes_penetrate(kernel, rng):
    p, gap, punch, u = pressures(rng)[np.newaxis], *rng.normal(size=(3, 1, N))
    closed = np.where(p == 0.0, np.maximum(gap, 0.0), np.where(p == HARDNESS, np.minimum(gap, 0.0), 0.0))
    kernel(p, gap, punch, np.array([0]), N, u, HARDNESS)
    np.testing.assert_array_equal(u, punch - closed)


@pytest.mark.parametrize("kernel", both(kernels.cg_direction))
def test_cg_directions_move_free_nodes_alone(kernel, rng):
    p, gap = pressures(rng)[np.newaxis], rng.normal(size=(1, N))
    t, search = np.zeros((1, N)), np.zeros((3, 1))
    free = (p > 0.0) & (p < HARDNESS)
    nodes = np.flatnonzero(free[0]).astype(np.uint32)[np.newaxis]
    kernel(gap, t, nodes, np.array([nodes.size]), search, np.zeros(1), np.array([0]), True)
    np.testing.assert_array_equal(t, np.where(free, gap, 0.0))
    assert search[0, 0] == pytest.approx((gap[free] ** 2).sum())


@pytest.mark.parametrize("kernel", both(kernels.cg_update))
def test_cg_steps_as_far_as_the_free_nodes_ask(kernel, rng):
    p, gap, st = pressures(rng)[np.newaxis], *rng.normal(size=(2, 1, N))
    free = (p > 0.0) & (p < HARDNESS)
    t = np.where(free, st + 0.1 * gap, 0.0)
    by_hand = p[0].copy()
    best = (gap * t)[free].sum() / ((st - st[free].mean()) * t)[free].sum()
    row = kernels.Iterate(by_hand, gap[0], t[0], st[0])
    expected_keep = bounded_step(row, best, 0.3, HARDNESS, N, True)
    search, nodes = np.zeros((3, 1)), np.zeros((1, N), dtype=np.uint32)
    nodes[0, : free.sum()] = np.flatnonzero(free[0])
    iterate = kernels.Iterate(p, gap, t, st)
    kernel(iterate, nodes, np.array([free.sum()]), search, np.array([0.3]), np.array([0]), True, HARDNESS)
    assert search[1, 0] == pytest.approx(best)
    assert search[2, 0] == expected_keep
    np.testing.assert_allclose(p[0], by_hand, atol=1e-13)
