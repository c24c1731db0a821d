"""Kernels of all displacements and of friction against plain NumPy twins, for one and two tangential components."""

import numpy as np
import pytest

from gfmd_numba import kernels
from gfmd_numba.kernels.contact_conditions import tangential_violation
from support.kernel_twins import both

ROWS, N, PADDED = 3, 13, 16
ACTIVE = np.array([0, 2])
COMPONENTS = pytest.mark.parametrize("components", [1, 2])


def random_state(rng, components):
    """Displacements, tractions and walls of nodes that are open, touch, pull, and are at their anchors or not."""
    u, ku = rng.normal(size=(2, ROWS, components + 1, PADDED))
    wall = u[:, -1] + np.where(rng.random((ROWS, PADDED)) < 0.6, 0.0, 0.3)
    draw, along = rng.random((ROWS, 1, PADDED)), u[:, :-1]
    anchor = np.where(draw < 0.5, along, along + 0.2 * rng.normal(size=along.shape))
    return kernels.SurfaceState(u, ku, wall, rng.normal(size=ROWS), anchor)


@COMPONENTS
@pytest.mark.parametrize("kernel", both(kernels.couple))
def test_couple_is_a_hermitian_matrix_for_each_wave(kernel, components, rng):
    every = components + 1
    spectrum = rng.normal(size=(ROWS, every, 8)) + 1j * rng.normal(size=(ROWS, every, 8))
    elements = rng.normal(size=(3 if components == 1 else 6, 7))
    if components == 1:
        k11, k13, k33 = elements
        matrix = np.array([[k11 + 0j, 1j * k13], [-1j * k13, k33]])
    else:
        xx, xy, yy, xz, yz, zz = elements
        matrix = np.array([[xx + 0j, xy, 1j * xz], [xy, yy, 1j * yz], [-1j * xz, -1j * yz, zz]])
    expected = spectrum.copy()
    expected[ACTIVE, :, :7] = np.einsum("ijk,rjk->rik", matrix, spectrum[ACTIVE, :, :7])
    kernel(spectrum, elements, ACTIVE)
    np.testing.assert_allclose(spectrum, expected, rtol=1e-13, atol=1e-13)


@COMPONENTS
@pytest.mark.parametrize(("friction", "limit", "rise"), [(0.4, np.inf, 0.0), (0.4, 0.2, 0.1), (np.inf, np.inf, 0.0)])
@pytest.mark.parametrize("kernels_of_step", [(kernels.verlet_step, kernels.friction_step)])
@pytest.mark.parametrize("compiled", [True, False])
def test_a_step_with_friction_is_its_plain_twin(kernels_of_step, compiled, friction, limit, rise, components, rng):
    state, memory, push, last = random_state(rng, components), 0.8, 0.3, rng.normal(size=(ROWS, components + 1, PADDED))
    u, ku, wall, load, anchor = state
    pressure = load[:, np.newaxis] - ku[:, -1]
    touches = ((u[:, -1] >= wall) & (pressure > 0.0))[:, np.newaxis]
    pulled = u[:, :-1] - 0.5 * push * ku[:, :-1] - anchor
    way = np.sqrt((pulled**2).sum(axis=1))
    with np.errstate(invalid="ignore"):
        held = 0.5 * push * np.minimum(friction * pressure, limit + rise * pressure)
        left = np.where(way > held, 1.0 - held / way, 0.0)[:, np.newaxis]
    free = u + memory * (u - last) - push * ku
    new = np.concatenate((np.where(touches, anchor + left * pulled, free[:, :-1]), free[:, -1:]), axis=1)
    new[:, -1] = np.minimum(u[:, -1] + memory * (u[:, -1] - last[:, -1]) + push * pressure, wall)
    changing, expected = (u, last, anchor), []
    for old, changed in zip(
        changing, (new, u, np.where(touches | np.isfinite(friction), anchor, u[:, :-1])), strict=True
    ):
        whole = old.copy()
        whole[ACTIVE, :, :N] = changed[ACTIVE, :, :N]
        expected.append(whole)
    step, hold = (kernel if compiled else getattr(kernel, "py_func", kernel) for kernel in kernels_of_step)
    step(state, last, ACTIVE, N, memory, push)
    hold(state, last, kernels.ContactLimits(friction=friction, shear_strength=limit, shear_rise=rise), ACTIVE, N, push)
    for found, asked in zip(changing, expected, strict=True):
        np.testing.assert_allclose(found, asked, rtol=1e-13, atol=1e-13)
    assert touches[ACTIVE, :, :N].any()


@COMPONENTS
@pytest.mark.parametrize(
    ("friction", "limit", "rise"), [(0.0, np.inf, 0.0), (0.4, np.inf, 0.0), (0.4, 0.2, 0.1), (np.inf, np.inf, 0.0)]
)
@pytest.mark.parametrize("kernel", both(tangential_violation))
def test_the_violation_of_friction_is_its_plain_twin(kernel, friction, limit, rise, components, rng):
    state = random_state(rng, components)
    u, ku, wall, load, anchor = state
    pressure = load[:, np.newaxis] - ku[:, -1]
    touches = (u[:, -1] >= wall) & (pressure > 0.0) & (friction > 0.0)
    traction, slid = ku[:, :-1], u[:, :-1] - anchor
    size, way = (np.sqrt((each**2).sum(axis=1)) for each in (traction, slid))
    with np.errstate(invalid="ignore", divide="ignore"):
        bound = np.minimum(friction * pressure, limit + rise * pressure)
        slips = np.sqrt(((traction + bound[:, None] * slid / way[:, None]) ** 2).sum(axis=1))
        slips = np.maximum(size, pressure) if np.isinf(friction) else slips  # none may slip
        violation = np.where(way > 0.0, slips, np.maximum(size - bound, 0.0))
    violation = np.where(touches, violation, size)
    for i in range(ROWS):
        largest, total = kernel(
            state, kernels.ContactLimits(friction=friction, shear_strength=limit, shear_rise=rise), i, N
        )
        assert largest == pytest.approx(violation[i, :N].max(), rel=1e-13)
        assert total == pytest.approx(traction[i, :, :N].sum())


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
@pytest.mark.parametrize("kernel", both(tangential_violation))
def test_friction_violation_at_one_node_is_what_friction_does_not_balance(
    kernel, slid, touches, k1, k3, friction, violation
):
    u, ku = np.array([[[0.1], [0.4]]]), np.array([[[k1], [k3]]])
    wall = u[:, 1] if touches else u[:, 1] + 1e-3
    state = kernels.SurfaceState(u, ku, wall, np.ones(1), u[:, :1] - slid)
    assert kernel(state, kernels.ContactLimits(friction=friction), 0, 1)[0] == pytest.approx(violation, abs=1e-15)


@COMPONENTS
def test_tractions_that_are_not_finite_are_not_certified(components, rng):
    state, (worst, peak, imbalance) = random_state(rng, components), np.zeros((3, ROWS))
    state.restoring[2, 0, 5] = np.inf
    kernels.wall_violation(state, kernels.ContactLimits(friction=0.3), ACTIVE, N, worst, peak, imbalance)
    assert np.isnan(worst[2])
    assert np.isfinite(worst[0])
