"""Kernels of all displacements and of friction against plain NumPy twins, for one and two tangential components."""

import numpy as np
import pytest

from gfmd_numba import kernels
from support.kernel_twins import both

ROWS, N, PADDED = 3, 13, 16
ACTIVE = np.array([0, 2])
COMPONENTS = pytest.mark.parametrize("components", [1, 2])


def random_state(rng, components):
    """Displacements, tractions and walls of nodes that are open, touch, pull, and have or have no anchor."""
    u1, k1 = rng.normal(size=(2, components * ROWS, PADDED))
    u3, k3 = rng.normal(size=(2, ROWS, PADDED))
    wall = u3 + np.where(rng.random(u3.shape) < 0.6, 0.0, 0.3)
    draw = np.tile(rng.random(u3.shape), (components, 1))
    anchor = np.where(draw < 0.3, np.nan, np.where(draw < 0.6, u1, u1 + 0.2 * rng.normal(size=u1.shape)))
    return kernels.CoupledState(u1, anchor, k1, u3, k3, wall, rng.normal(size=ROWS))


def by_component(values):
    """Tangential rows as `[component, realisation, x]`."""
    return values.reshape(-1, ROWS, PADDED)


@COMPONENTS
@pytest.mark.parametrize("kernel", both(kernels.couple))
def test_couple_is_a_hermitian_matrix_for_each_wave(kernel, components, rng):
    every = components + 1
    spectrum = rng.normal(size=(every * ROWS, 8)) + 1j * rng.normal(size=(every * ROWS, 8))
    elements = rng.normal(size=(3 if components == 1 else 6, 7))
    if components == 1:
        k11, k13, k33 = elements
        matrix = np.array([[k11 + 0j, 1j * k13], [-1j * k13, k33]])
    else:
        xx, xy, yy, xz, yz, zz = elements
        matrix = np.array([[xx + 0j, xy, 1j * xz], [xy, yy, 1j * yz], [-1j * xz, -1j * yz, zz]])
    expected = spectrum.copy()
    for i in ACTIVE:
        expected[i::ROWS, :7] = np.einsum("ijk,jk->ik", matrix, spectrum[i::ROWS, :7])
    kernel(spectrum, elements, ACTIVE, ROWS)
    np.testing.assert_allclose(spectrum, expected, rtol=1e-13, atol=1e-13)


@COMPONENTS
@pytest.mark.parametrize("friction", [0.0, 0.4, np.inf])
@pytest.mark.parametrize("kernel", both(kernels.coupled_step))
def test_coupled_step_is_its_plain_twin(kernel, friction, components, rng):
    state, memory, push = random_state(rng, components), 0.8, 0.3
    last1, last3 = rng.normal(size=state.u1.shape), rng.normal(size=state.u3.shape)
    pressure = state.load[:, np.newaxis] - state.k3
    touches = (state.u3 >= state.wall) & (pressure > 0.0) & (friction > 0.0)
    u1, anchor, k1, old1 = (by_component(each) for each in (state.u1, state.anchor, state.k1, last1))
    rests = np.where(np.isnan(anchor), u1, anchor)
    pulled = u1 - 0.5 * push * k1 - rests
    way = np.sqrt((pulled**2).sum(axis=0))
    with np.errstate(invalid="ignore"):
        held = 0.5 * push * friction * pressure
        left = np.where(way > held, 1.0 - held / way, 0.0)
    new1 = np.where(touches, rests + left * pulled, u1 + memory * (u1 - old1) - push * k1)
    new3 = np.minimum(state.u3 + memory * (state.u3 - last3) + push * pressure, state.wall)
    changing = [state.u1, last1, state.anchor, state.u3, last3]
    expected = [by_component(each.copy()) for each in changing]
    new = (new1, u1.copy(), np.where(touches, rests, np.nan), by_component(new3), by_component(state.u3.copy()))
    for whole, changed in zip(expected, new, strict=True):
        whole[:, ACTIVE, :N] = changed[:, ACTIVE, :N]
    kernel(state, last1, last3, friction, ACTIVE, N, memory, push)
    for found, asked in zip(changing, expected, strict=True):
        np.testing.assert_allclose(by_component(found), asked, rtol=1e-13, atol=1e-13)
    assert touches[ACTIVE, :N].any() == (friction > 0.0)


@COMPONENTS
@pytest.mark.parametrize("friction", [0.0, 0.4, np.inf])
@pytest.mark.parametrize("kernel", both(kernels.friction_violation))
def test_friction_violation_is_its_plain_twin(kernel, friction, components, rng):
    state, worst = random_state(rng, components), np.array([0.1, 0.1, 100.0])
    state = state._replace(anchor=np.where(np.isnan(state.anchor), state.u1, state.anchor))
    pressure = state.load[:, np.newaxis] - state.k3
    touches = (state.u3 >= state.wall) & (pressure > 0.0) & (friction > 0.0)
    traction, slid = by_component(state.k1), by_component(state.u1 - state.anchor)
    size, way = (np.sqrt((each**2).sum(axis=0)) for each in (traction, slid))
    with np.errstate(invalid="ignore", divide="ignore"):
        bound = friction * pressure
        slips = np.sqrt(((traction + bound * slid / way) ** 2).sum(axis=0))
        slips = np.maximum(size, pressure) if np.isinf(friction) else slips  # none may slip
        violation = np.where(way > 0.0, slips, np.maximum(size - bound, 0.0))
    violation = np.where(touches, violation, size)
    expected = worst.copy()
    expected[ACTIVE] = np.maximum(worst, violation[:, :N].max(axis=1))[ACTIVE]
    kernel(state, friction, ACTIVE, N, worst)
    np.testing.assert_allclose(worst, expected, rtol=1e-13)
    assert expected[0] > 0.1
    assert expected[2] == 100.0


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
    state = kernels.CoupledState(u1, u1 - slid, np.array([[k1]]), u3, np.array([[k3]]), wall, one)
    kernel(state, friction, np.array([0]), 1, worst)
    assert worst[0] == pytest.approx(violation, abs=1e-15)


@COMPONENTS
@pytest.mark.parametrize("kernel", both(kernels.friction_violation))
def test_tractions_that_are_not_finite_are_not_certified(kernel, components, rng):
    state, worst = random_state(rng, components), np.zeros(ROWS)
    state.k1[-ROWS + 2, 5] = np.inf
    kernel(state, 0.3, ACTIVE, N, worst)
    assert np.isnan(worst[2])
    assert np.isfinite(worst[0])


@COMPONENTS
def test_a_violation_that_is_infinite_or_unknown_stays_so(components):
    """As where a punch leaves no room for an incompressible body, which friction does not change."""
    normal, sideways = np.zeros((2, 4)), np.zeros((2 * components, 4))
    worst = np.array([np.inf, np.nan])
    state = kernels.CoupledState(sideways, sideways, sideways, normal, normal, normal + 1.0, np.ones(2))
    kernels.friction_violation(state, 0.3, np.arange(2), 4, worst)
    assert worst[0] == np.inf
    assert np.isnan(worst[1])
