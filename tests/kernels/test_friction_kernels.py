"""Kernels of both displacements and of friction against plain NumPy twins."""

import numpy as np
import pytest

from gfmd_numba import kernels
from support.kernel_twins import both


@pytest.mark.parametrize("kernel", both(kernels.couple))
def test_couple_is_its_plain_twin(kernel):
    rng = np.random.default_rng(0)
    spectrum = rng.normal(size=(6, 9)) + 1j * rng.normal(size=(6, 9))
    k11, k13, k33 = rng.normal(size=(3, 7))
    expected = spectrum.copy()
    for i in (0, 2):
        expected[i, :7] = k11 * spectrum[i, :7] + 1j * k13 * spectrum[3 + i, :7]
        expected[3 + i, :7] = k33 * spectrum[3 + i, :7] - 1j * k13 * spectrum[i, :7]
    kernel(spectrum, k11, k13, k33, np.array([0, 2]), 3)
    np.testing.assert_allclose(spectrum, expected, rtol=1e-14)


@pytest.mark.parametrize("friction", [0.0, 0.3, np.inf])
@pytest.mark.parametrize("kernel", both(kernels.coupled_step))
def test_coupled_step_is_its_plain_twin(kernel, friction):
    rng = np.random.default_rng(1)
    u1, old1, k1, u3, old3, k3, anchor = rng.normal(size=(7, 3, 16))
    anchor[:, ::2] = np.nan
    wall, load = u3 + np.maximum(rng.normal(size=u3.shape), 0.0), rng.normal(size=3)
    memory, push, active, n = 0.8, 0.1, np.array([0, 2]), 13
    pressure = load[:, None] - k3
    touching = (u3 == wall) & (pressure > 0) & (friction > 0)
    held_at = np.where(np.isnan(anchor), u1, anchor)
    slid = u1 - push / 2 * k1 - held_at
    with np.errstate(invalid="ignore"):
        drawn = held_at + np.sign(slid) * np.maximum(abs(slid) - push / 2 * friction * pressure, 0.0)
    new1 = np.where(touching, drawn, u1 + memory * (u1 - old1) - push * k1)
    new3 = np.minimum(u3 + memory * (u3 - old3) + push * pressure, wall)
    expected = [a.copy() for a in (u1, old1, u3, old3, anchor)]
    new = (new1, u1.copy(), new3, u3.copy(), np.where(touching, held_at, np.nan))
    for target, value in zip(expected, new, strict=True):
        target[active, :n] = value[active, :n]
    kernel(u1, old1, anchor, k1, u3, old3, k3, wall, load, friction, active, n, memory, push)
    for computed, value in zip((u1, old1, u3, old3, anchor), expected, strict=True):
        np.testing.assert_allclose(computed, value, rtol=1e-13, atol=1e-14)
    assert touching[active, :n].any() == (friction > 0)


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("kernel", both(kernels.friction_violation))
def test_friction_violation_is_its_plain_twin(kernel, friction):
    rng = np.random.default_rng(2)
    u1, k1, u3, k3 = rng.normal(size=(4, 3, 16))
    anchor = u1 + rng.choice([0.0, 0.5, -0.5], size=u1.shape)
    wall, load = u3 + np.maximum(rng.normal(size=u3.shape), 0.0), rng.normal(size=3)
    worst, n = np.array([0.01, 0.01, 100.0]), 13
    limit = np.where(u3 == wall, friction * np.maximum(load[:, None] - k3, 0.0), 0.0)
    sliding = abs(-k1 - np.sign(u1 - anchor) * limit)
    violation = np.where(u1 == anchor, np.maximum(abs(k1) - limit, 0.0), sliding)
    expected = np.maximum(violation[:, :n].max(axis=1), worst)
    kernel(u1, anchor, k1, u3, k3, wall, load, friction, np.array([0, 2]), n, worst)
    np.testing.assert_allclose(worst, [expected[0], 0.01, 100.0])
    k1[2, 0] = np.nan
    kernel(u1, anchor, k1, u3, k3, wall, load, friction, np.array([0, 2]), n, worst)
    assert np.isnan(worst[2])


@pytest.mark.parametrize(
    ("slid", "touches", "k1", "k3", "friction", "violation"),
    [
        (0.0, False, -0.7, 0.2, 0.3, 0.7),  # free, and dragged
        (0.0, True, 0.7, 1.0, 0.3, 0.7),  # touching without pressure
        (0.0, True, 0.7, 1.2, 0.3, 0.7),  # in tension
        (0.0, True, 0.7, 0.2, 0.0, 0.7),  # frictionless
        (0.0, True, 0.2, 0.2, 0.3, 0.0),  # sticking: 0.3 (1 - 0.2) = 0.24 holds it
        (0.0, True, -0.7, 0.2, 0.3, 0.46),  # sticking more than friction can
        (0.5, True, -0.24, 0.2, 0.3, 0.0),  # sliding one way, held back
        (0.5, True, 0.1, 0.2, 0.3, 0.34),
        (-0.5, True, 0.24, 0.2, 0.3, 0.0),  # and the other way
        (-0.5, True, 0.1, 0.2, 0.3, 0.14),
        (0.0, True, 9.0, 0.2, np.inf, 0.0),  # stuck for good
        (0.5, True, 0.1, 0.2, np.inf, 0.8),  # it left its anchor, and must bear nothing
        (-0.5, True, 0.9, 0.2, np.inf, 0.9),
    ],
)
@pytest.mark.parametrize("kernel", both(kernels.friction_violation))
def test_friction_violation_at_one_node_is_what_friction_does_not_balance(
    kernel, slid, touches, k1, k3, friction, violation
):
    u1, u3, worst, one = np.array([[0.1]]), np.array([[0.4]]), np.zeros(1), np.ones(1)
    wall = u3 if touches else u3 + 1e-3
    anchor = np.array([[0.1 - slid]])
    kernel(u1, anchor, np.array([[k1]]), u3, np.array([[k3]]), wall, one, friction, np.array([0]), 1, worst)
    assert worst[0] == pytest.approx(violation, abs=1e-15)


@pytest.mark.parametrize("kernel", [kernels.friction_violation, kernels.map_friction_violation])
def test_a_violation_that_is_infinite_or_unknown_stays_so(kernel):
    """As where a punch leaves no room for an incompressible body, which friction does not change."""
    normal, sideways = np.zeros((2, 4)), np.zeros((4, 4))
    worst = np.array([np.inf, np.nan])
    kernel(sideways, sideways, sideways, normal, normal, normal + 1.0, np.ones(2), 0.3, np.arange(2), 4, worst)
    assert worst[0] == np.inf
    assert np.isnan(worst[1])
