"""Kernels of friction on maps against plain NumPy twins, compiled and as Python, and against those of profiles."""

import numpy as np
import pytest

from gfmd_numba import kernels
from support.kernel_twins import both

ROWS, N, PADDED = 3, 13, 16
ACTIVE = np.array([0, 2])
BOTH = np.concatenate([ACTIVE, ACTIVE + ROWS])


def state(rng):
    """Displacements, tractions and walls of nodes that are open, touch, pull, and have or have no anchor."""
    u1, u1_old, k1 = rng.normal(size=(3, 2 * ROWS, PADDED))
    u3, u3_old, k3 = rng.normal(size=(3, ROWS, PADDED))
    wall = u3 + np.where(rng.random(u3.shape) < 0.6, 0.0, 0.3)
    anchor = u1 + 0.2 * rng.normal(size=u1.shape)
    free = rng.random(u3.shape) < 0.3
    anchor[:ROWS][free] = anchor[ROWS:][free] = np.nan
    held = rng.random(u3.shape) < 0.3
    for some in (slice(ROWS), slice(ROWS, None)):
        u1[some] = np.where(held & ~free, anchor[some], u1[some])
    return u1, u1_old, anchor, k1, u3, u3_old, k3, wall, rng.normal(size=ROWS)


@pytest.mark.parametrize("kernel", both(kernels.couple_map))
def test_couple_map_is_a_hermitian_matrix_for_each_wave(kernel, rng):
    spectrum = rng.normal(size=(3 * ROWS, 8)) + 1j * rng.normal(size=(3 * ROWS, 8))
    xx, xy, yy, xz, yz, zz = elements = rng.normal(size=(6, 7))
    matrix = np.array([[xx + 0j, xy, 1j * xz], [xy, yy, 1j * yz], [-1j * xz, -1j * yz, zz]])
    expected = spectrum.copy()
    for i in ACTIVE:
        own = [i, ROWS + i, 2 * ROWS + i]
        expected[own, :7] = np.einsum("ijk,jk->ik", matrix, spectrum[own, :7])
    kernel(spectrum, *elements, ACTIVE, ROWS)
    np.testing.assert_allclose(spectrum, expected, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("friction", [0.0, 0.4, np.inf])
@pytest.mark.parametrize("kernel", both(kernels.coupled_map_step))
def test_coupled_map_step_is_its_plain_twin(kernel, friction, rng):
    u1, u1_old, anchor, k1, u3, u3_old, k3, wall, load = state(rng)
    memory, push = 0.8, 0.3
    pressure = load[:, np.newaxis] - k3
    touches = (u3 >= wall) & (pressure > 0.0) & (friction > 0.0)
    rests = np.where(np.isnan(anchor), u1, anchor)
    pulled = u1 - 0.5 * push * k1 - rests
    way = np.tile(np.hypot(pulled[:ROWS], pulled[ROWS:]), (2, 1))
    with np.errstate(invalid="ignore"):
        held = np.tile(0.5 * push * friction * pressure, (2, 1))
        left = np.where(way > held, 1.0 - held / way, 0.0)
    touches = np.tile(touches, (2, 1))
    new = np.where(touches, rests + left * pulled, u1 + memory * (u1 - u1_old) - push * k1)
    new_anchor = np.where(touches, rests, np.nan)
    new_normal = np.minimum(u3 + memory * (u3 - u3_old) + push * pressure, wall)
    expected = [each.copy() for each in (u1, u1_old, anchor, u3, u3_old)]
    for whole, changed, rows in zip(
        expected, (new, u1, new_anchor, new_normal, u3), (BOTH, BOTH, BOTH, ACTIVE, ACTIVE), strict=True
    ):
        whole[rows, :N] = changed[rows, :N]
    kernel(u1, u1_old, anchor, k1, u3, u3_old, k3, wall, load, friction, ACTIVE, N, memory, push)
    for found, asked in zip((u1, u1_old, anchor, u3, u3_old), expected, strict=True):
        np.testing.assert_allclose(found, asked, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("friction", [0.0, 0.4, np.inf])
@pytest.mark.parametrize("kernel", both(kernels.map_friction_violation))
def test_map_friction_violation_is_its_plain_twin(kernel, friction, rng):
    u1, _, anchor, k1, u3, _, k3, wall, load = state(rng)
    anchor = np.where(np.isnan(anchor), u1, anchor)
    worst = np.full(ROWS, 0.1)
    pressure = load[:, np.newaxis] - k3
    touches = (u3 >= wall) & (pressure > 0.0) & (friction > 0.0)
    traction, slid = (np.array([each[:ROWS], each[ROWS:]]) for each in (k1, u1 - anchor))
    size, way = np.hypot(*traction), np.hypot(*slid)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        bound = friction * pressure
        slips = np.hypot(*(traction + bound * slid / way))
        slips = np.maximum(size, pressure) if np.isinf(friction) else slips  # none may slip
        violation = np.where(way > 0.0, slips, np.maximum(size - bound, 0.0))
    violation = np.where(touches, violation, size)
    expected = worst.copy()
    expected[ACTIVE] = np.maximum(0.1, violation[ACTIVE, :N].max(axis=1))
    kernel(u1, anchor, k1, u3, k3, wall, load, friction, ACTIVE, N, worst)
    np.testing.assert_allclose(worst, expected, rtol=1e-13)


@pytest.mark.parametrize("kernel", both(kernels.map_friction_violation))
def test_a_map_that_is_not_finite_is_not_certified(kernel, rng):
    u1, _, anchor, k1, u3, _, k3, wall, load = state(rng)
    k1[ROWS + 2, 5] = np.inf
    worst = np.zeros(ROWS)
    kernel(u1, np.where(np.isnan(anchor), u1, anchor), k1, u3, k3, wall, load, 0.3, ACTIVE, N, worst)
    assert np.isnan(worst[2])
    assert np.isfinite(worst[0])


@pytest.mark.parametrize("direction", [0, 1])
def test_along_one_axis_a_map_steps_as_a_profile(direction, rng):
    u1, u1_old, anchor, k1, u3, u3_old, k3, wall, load = state(rng)
    along = slice(ROWS) if direction == 0 else slice(ROWS, None)
    across = slice(ROWS, None) if direction == 0 else slice(ROWS)
    for each in (u1, u1_old, k1):
        each[across] = 0.0
    anchor[across] = np.where(np.isnan(anchor[along]), np.nan, 0.0)
    profile = [each[along].copy() for each in (u1, u1_old, anchor, k1)] + [each.copy() for each in (u3, u3_old, k3)]
    kernels.coupled_map_step(u1, u1_old, anchor, k1, u3, u3_old, k3, wall, load, 0.4, ACTIVE, N, 0.8, 0.3)
    kernels.coupled_step(*profile, wall, load, 0.4, ACTIVE, N, 0.8, 0.3)
    np.testing.assert_allclose(u1[along], profile[0], rtol=1e-13, atol=1e-15)
    np.testing.assert_array_equal(u3, profile[4])
    assert not u1[across].any()
