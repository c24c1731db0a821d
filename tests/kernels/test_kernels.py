"""Every kernel against a plain NumPy twin, compiled and as Python."""

import numpy as np
import pytest

from gfmd_numba import kernels
from support.kernel_twins import both

ROWS, PADDED, N = 3, 16, 13
ACTIVE = np.array([0, 2])


def listed(p):
    """Nodes under pressure `[realisation, x]`, as `cg_free` lists them, and how many there are."""
    nodes, count = np.full((len(p), N), 99, dtype=np.uint32), np.zeros(len(p), dtype=np.int64)
    for i in range(len(p)):
        free = np.flatnonzero(p[i, :N] > 0.0)
        nodes[i, : free.size], count[i] = free, free.size
    return nodes, count


def only_active(new, old):
    expected = old.copy()
    expected[ACTIVE, :N] = new[ACTIVE, :N]
    return expected


@pytest.mark.parametrize("kernel", both(kernels.multiply))
def test_multiply_is_its_plain_twin(kernel, rng):
    spectrum = rng.normal(size=(ROWS, 8)) + 1j * rng.normal(size=(ROWS, 8))
    symbol = rng.normal(size=7)
    expected = spectrum.copy()
    expected[ACTIVE, :7] *= symbol
    kernel(spectrum, symbol, ACTIVE)
    np.testing.assert_allclose(spectrum, expected, rtol=1e-15)


@pytest.mark.parametrize("kernel", both(kernels.verlet_step))
def test_verlet_step_is_its_plain_twin(kernel, rng):
    u, u_old, ku = rng.normal(size=(3, ROWS, PADDED))
    punch = u + rng.normal(size=u.shape) * 0.1
    load, dt2, eta = rng.normal(size=ROWS), 0.3, 0.7
    force = load[:, None] - ku + eta * (u_old - u)
    new = np.minimum(2 * u - u_old + dt2 * force, punch)  # (6.55a)
    expected, expected_old = only_active(new, u), only_active(u, u_old)
    kernel(kernels.SurfaceState.of_normal(u, ku, punch, load), u_old[:, np.newaxis], ACTIVE, N, 1 - eta * dt2, dt2)
    np.testing.assert_allclose(u, expected, rtol=1e-13, atol=1e-13)
    np.testing.assert_array_equal(u_old, expected_old)
    assert (u[ACTIVE, :N] == punch[ACTIVE, :N]).any()
    assert (u[ACTIVE, :N] < punch[ACTIVE, :N]).any()


def fired(u, v, force, punch, dt, mixing, downhill, longest):
    """One row of a FIRE step, by vectors."""
    held = (u == punch) & (force >= 0)
    v, f = np.where(held, 0.0, v), np.where(held, 0.0, force)
    power, speed = f @ v, np.linalg.norm(v)
    if power > 0:
        v = (1 - mixing) * v + mixing * f / np.linalg.norm(f) * speed
        downhill += 1
        if downhill > 5:
            dt, mixing = min(1.1 * dt, longest), 0.99 * mixing
    else:
        v = 0 * v
        if speed > 0:
            dt, mixing, downhill = dt / 2, 0.1, 0
    v = v + dt * f
    return np.minimum(u + dt * v, punch), v, dt, mixing, downhill


@pytest.mark.parametrize("downhill", [0, 5])
@pytest.mark.parametrize("kernel", both(kernels.fire_step))
def test_fire_step_is_its_plain_twin(kernel, downhill, rng):
    u, ku = rng.normal(size=(2, ROWS, PADDED))
    load = rng.normal(size=ROWS)
    punch = u + np.maximum(rng.normal(size=u.shape), 0.0)
    v = np.array([1.0, 0.0, -1.0])[:, None] * (load[:, None] - ku)  # one row downhill, one uphill
    dt, mixing, steps = np.full(ROWS, 0.1), np.full(ROWS, 0.08), np.full(ROWS, downhill)
    before = u.copy(), v.copy(), dt.copy(), mixing.copy(), steps.copy()
    kernel(kernels.SurfaceState.of_normal(u, ku, punch, load), v, dt, mixing, steps, ACTIVE, N, 0.105)
    for i in range(ROWS):
        row = [a[i, :N] if a.ndim == 2 else a[i] for a in before]
        if i in ACTIVE:
            force = (load[:, None] - ku)[i, :N]
            row = fired(row[0], row[1], force, punch[i, :N], row[2], row[3], row[4], 0.105)
        np.testing.assert_allclose(u[i, :N], row[0], rtol=1e-12, atol=1e-14)
        np.testing.assert_allclose(v[i, :N], row[1], rtol=1e-12, atol=1e-14)
        np.testing.assert_allclose([dt[i], mixing[i], steps[i]], row[2:], rtol=1e-12)
    assert dt[2] == 0.05


@pytest.mark.parametrize("kernel", both(kernels.fire_step))
def test_fire_goes_downhill_by_the_power_of_all_nodes(kernel):
    """Also with some nodes moving uphill, and one at rest on the wall."""
    u, ku, load = np.zeros((1, 3)), np.array([[-2.0, -1.0, -1.0]]), np.zeros(1)
    v, punch = np.array([[1.0, -0.1, 5.0]]), np.array([[9.0, 9.0, 0.0]])
    dt, mixing, steps = np.full(1, 0.1), np.full(1, 0.08), np.zeros(1, dtype=np.int64)
    row = fired(u[0], v[0], -ku[0], punch[0], 0.1, 0.08, 0, 0.2)
    kernel(kernels.SurfaceState.of_normal(u, ku, punch, load), v, dt, mixing, steps, np.array([0]), 3, 0.2)
    np.testing.assert_allclose(u[0], row[0], rtol=1e-12)
    np.testing.assert_allclose(v[0, :2], row[1][:2], rtol=1e-12)
    assert (v[0, 2], steps[0]) == (0.0, 1)


@pytest.mark.parametrize("kernel", both(kernels.wall_violation))
def test_wall_violation_is_its_plain_twin(kernel, rng):
    punch, ku = rng.normal(size=(2, ROWS, PADDED))
    u = punch - np.maximum(rng.normal(size=punch.shape), 0.0)
    load = rng.normal(size=ROWS)
    traction = (load[:, None] - ku)[:, :N]
    pressure = np.where((u == punch)[:, :N], np.maximum(traction, 0.0), 0.0)
    excess = traction - pressure
    worst, peak, imbalance = np.full((3, ROWS), -1.0)
    kernel(
        kernels.SurfaceState.of_normal(u, ku, punch, load), kernels.ContactLimits(), ACTIVE, N, worst, peak, imbalance
    )
    np.testing.assert_allclose(worst[ACTIVE], abs(excess).max(axis=1)[ACTIVE])
    np.testing.assert_allclose(peak[ACTIVE], pressure.max(axis=1)[ACTIVE])
    np.testing.assert_allclose(imbalance[ACTIVE], abs(excess.mean(axis=1))[ACTIVE], atol=1e-15)
    assert worst[1] == peak[1] == imbalance[1] == -1.0


@pytest.mark.parametrize("kernel", both(kernels.wall_violation))
@pytest.mark.parametrize("poison", [np.nan, np.inf])
@pytest.mark.parametrize("touches", [True, False])
def test_wall_violation_reports_what_is_not_finite(kernel, poison, touches):
    punch = np.zeros((ROWS, PADDED))
    u = punch - (0.0 if touches else 1.0)
    ku = np.zeros_like(u)
    ku[2, 3] = poison
    worst, peak, imbalance = np.zeros((3, ROWS))
    kernel(
        kernels.SurfaceState.of_normal(u, ku, punch, np.zeros(ROWS)),
        kernels.ContactLimits(),
        ACTIVE,
        N,
        worst,
        peak,
        imbalance,
    )
    assert worst[0] == 0.0
    assert np.isnan(worst[2])


@pytest.mark.parametrize("kernel", both(kernels.wall_pressure))
def test_wall_pressure_is_its_plain_twin(kernel, rng):
    punch, ku = rng.normal(size=(2, ROWS, PADDED))
    u = punch - np.maximum(rng.normal(size=punch.shape), 0.0)
    load = rng.normal(size=ROWS)
    expected = only_active(np.where(u == punch, np.maximum(load[:, None] - ku, 0.0), 0.0), ku)
    kernel(kernels.SurfaceState.of_normal(u, ku, punch, load), np.inf, ACTIVE, N)
    np.testing.assert_array_equal(ku, expected)


@pytest.mark.parametrize("n", [13, 64, 200])
@pytest.mark.parametrize("hardness", [0.5, np.inf])
@pytest.mark.parametrize("kernel", both(kernels.cg_free))
def test_cg_free_lists_the_nodes_between_the_bounds_and_forgets_the_directions_of_others(kernel, hardness, n, rng):
    p = np.clip(rng.normal(size=(3, n + 8)), 0.0, hardness)
    p[0, :n], p[1, n // 3 :] = 0.4, 0.0  # one row is free everywhere, one in a part
    t = rng.normal(size=p.shape)
    nodes, count = np.zeros(p.shape, dtype=np.uint32), np.array([0, n, n])
    nodes[1:, :n] = np.arange(n)  # every direction of the last two rows is known
    free = (p > 0.0) & (p < hardness)
    expected = t.copy()
    expected[1:, :n] *= free[1:, :n]
    kernel(p, t, nodes, count, np.arange(3), n, hardness)
    for i in range(3):
        np.testing.assert_array_equal(nodes[i, : count[i]], np.flatnonzero(free[i, :n]))
    np.testing.assert_array_equal(t, expected)


@pytest.mark.parametrize("free_mean", [True, False])
@pytest.mark.parametrize("kernel", both(kernels.cg_gap))
def test_cg_gap_is_its_plain_twin(kernel, free_mean, rng):
    sp, punch, gap = rng.normal(size=(3, ROWS, PADDED))
    p = np.maximum(rng.normal(size=gap.shape), 0.0)
    opened = punch + sp
    for i in ACTIVE:
        touching = p[i, :N] > 0.0
        opened[i] -= opened[i, :N][touching].mean() if free_mean else 0.0
    expected = only_active(opened, gap)
    kernel(sp, punch, gap, *listed(p), ACTIVE, N, free_mean)
    np.testing.assert_allclose(gap, expected, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("free_mean", [True, False])
@pytest.mark.parametrize("kernel", both(kernels.cg_direction))
def test_cg_direction_is_its_plain_twin(kernel, free_mean, rng):
    gap, t = rng.normal(size=(2, ROWS, PADDED))
    p = np.maximum(rng.normal(size=gap.shape), 0.0)
    search = np.array([[2.0, 3.0, 0.0], [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    t[p == 0.0] = 0.0  # as the list before left it
    t[0] *= np.sign((gap * t)[0, :N].sum())  # downhill
    squares = np.where(p > 0.0, gap**2, 0.0)[:, :N].sum(axis=1)
    beta = [squares[0] / 2.0, 0.0, 0.0]  # the last row has no history
    new = np.zeros_like(t)
    for i in ACTIVE:
        touching = p[i] > 0.0
        mean = t[i, :N][touching[:N]].mean() if free_mean else 0.0
        new[i, touching] = (gap[i] + beta[i] * (t[i] - mean))[touching]
    expected = only_active(new, t)
    kernel(gap, t, *listed(p), search, np.zeros(ROWS), ACTIVE, free_mean)
    np.testing.assert_allclose(t, expected, rtol=1e-13)
    np.testing.assert_allclose(search[0], [squares[0], 3.0, squares[2]])


@pytest.mark.parametrize("kernel", both(kernels.cg_direction))
def test_cg_direction_never_leads_uphill(kernel):
    p, gap = np.ones((1, N)), np.zeros((1, N))
    gap[0, :2] = 1.0, -1.0
    t = -2.0 * gap
    kernel(gap, t, *listed(p), np.ones((3, 1)), np.full(1, 0.1), np.array([0]), True)
    np.testing.assert_array_equal(t, gap)


@pytest.mark.parametrize("kernel", both(kernels.cg_direction))
def test_cg_direction_stops_at_rounding(kernel):
    p, gap, t = np.ones((1, N)), np.full((1, N), 0.1), np.ones((1, N))
    kernel(gap, t, *listed(p), np.ones((3, 1)), np.full(1, 0.11), np.array([0]), True)
    assert not t[0, :N].any()


def updated(p, st, gap, t, load, step, keep, free_mean):
    """One row of Polonsky & Keer's update, by vectors."""
    touching = p > 0.0
    r = st - (st[touching].mean() if free_mean else 0.0)
    curvature = (r * t)[touching].sum()
    step = (gap * t)[touching].sum() / curvature if curvature > 0.0 else step
    p = np.where(touching, np.maximum(p - step * t, 0.0), p)
    overlap = (p == 0.0) & (gap < 0.0)
    p = np.where(overlap, -step * gap, p)
    return p * (load / p.mean() if free_mean else 1.0), step, 0.0 if overlap.any() else 1.0


@pytest.mark.parametrize("free_mean", [True, False])
@pytest.mark.parametrize("overlap", [True, False])
@pytest.mark.parametrize("kernel", both(kernels.cg_update))
def test_cg_update_is_its_plain_twin(kernel, overlap, free_mean, rng):
    gap, t, st = rng.normal(size=(3, ROWS, PADDED))
    st = t + 0.1 * st  # positive curvature
    gap = gap if overlap else abs(gap)
    p = np.maximum(rng.normal(size=gap.shape), 0.0)
    t[p == 0.0] = 0.0  # as the list before left it
    downhill = np.sign((gap * t)[:, :N].sum(axis=1, keepdims=True))
    st, t = downhill * st, downhill * t
    load, search = np.array([0.3, 0.4, 0.5]), np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0], [0.5, 0.5, 0.5]])
    _, step, keep = search
    expected, steps, keeps = p.copy(), step.copy(), keep.copy()
    for i in ACTIVE:
        row = updated(p[i, :N], st[i, :N], gap[i, :N], t[i, :N], load[i], step[i], keep[i], free_mean)
        expected[i, :N], steps[i], keeps[i] = row
    nodes, count = listed(p)
    kernel(kernels.Iterate(p, gap, t, st), nodes, count, search, load, ACTIVE, free_mean)
    np.testing.assert_allclose(p, expected, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(step, steps)
    np.testing.assert_array_equal(keep, keeps)
    for i in ACTIVE:
        assert sorted(nodes[i, : count[i]]) == np.flatnonzero(p[i, :N]).tolist()
        assert not t[i, :N][p[i, :N] == 0.0].any()
    assert (keep[ACTIVE] == 0.0).all() == overlap


@pytest.mark.parametrize("kernel", both(kernels.cg_update))
def test_cg_update_keeps_the_last_step_at_a_single_touching_node(kernel):
    p, st, gap, t = (np.zeros((1, N)) for _ in range(4))
    p[0, 3], st[0, 3], gap[0, 5] = 8.0, 1.0, -0.25  # one node touches, another overlaps
    search = np.array([[0.0], [2.0], [1.0]])
    kernel(kernels.Iterate(p, gap, t, st), *listed(p), search, np.ones(1), np.array([0]), True)
    assert search[1, 0] == 2.0
    np.testing.assert_allclose(p[0, [3, 5]], np.array([8.0, 0.5]) * N / 8.5)


@pytest.mark.parametrize("kernel", both(kernels.close_gap))
def test_close_gap_is_its_plain_twin(kernel, rng):
    gap, punch, u = rng.normal(size=(3, ROWS, PADDED))
    p = np.maximum(rng.normal(size=gap.shape), 0.0)
    expected = only_active(punch - np.where(p > 0.0, 0.0, np.maximum(gap, 0.0)), u)
    kernel(p, gap, punch, ACTIVE, N, u)
    np.testing.assert_array_equal(u, expected)


def factors(symbol, n, divide):
    """What waves are multiplied by."""
    with np.errstate(divide="ignore"):
        return np.where(symbol > 0.0, 1.0 / (n * symbol), 0.0) if divide else np.where(symbol < np.inf, symbol / n, 0.0)


@pytest.mark.parametrize("divide", [True, False])
@pytest.mark.parametrize("first", [0, 4, 8])
@pytest.mark.parametrize("put", both(kernels.put_columns))
@pytest.mark.parametrize("multiply", both(kernels.multiply_columns))
@pytest.mark.parametrize("take", both(kernels.take_columns))
def test_columns_of_a_map_are_taken_multiplied_and_put_back(take, multiply, put, first, divide, rng):
    """The last block is wider than what is left of the map."""
    waves = rng.normal(size=(3, 10)) + 1j * rng.normal(size=(3, 10))
    symbol = rng.uniform(0.5, 2.0, size=(6, 10))
    symbol[2, 5], symbol[1, 5] = 0.0, np.inf
    symbol[4:] = symbol[2:0:-1]  # of waves to and fro
    block, last = np.full((4, 6), 5.0 + 0.0j), min(first + 4, 10)
    columns, many = slice(first, last), last - first
    take(waves, 3, first, block)
    np.testing.assert_array_equal(block[:many, :3], waves[:, columns].T)
    assert not block[:, 3:].any()
    assert not block[many:].any()
    block[:] = full = rng.normal(size=(4, 6)) + 0.0j
    multiply(block, symbol, first, 60, divide)
    expected = full[:many] * factors(symbol, 60, divide)[:, columns].T
    np.testing.assert_allclose(block[:many], expected, rtol=1e-15)
    expected = waves.copy()
    expected[:2, columns] = block[:many, :2].T
    put(block, first, waves, 2)
    np.testing.assert_array_equal(waves, expected)


@pytest.mark.parametrize("divide", [True, False])
@pytest.mark.parametrize("kernel", both(kernels.multiply_map))
def test_a_map_of_waves_is_multiplied_by_a_symbol(kernel, divide, rng):
    waves, symbol = rng.normal(size=(3, 10)) + 0.0j, rng.uniform(0.5, 2.0, size=(3, 8))
    symbol[0, 0], symbol[1, 1] = 0.0, np.inf
    expected = waves.copy()
    expected[:, :8] *= factors(symbol, 5, divide)
    kernel(waves, symbol, 5, divide)
    np.testing.assert_allclose(waves, expected, rtol=1e-15)
