"""Partial slip of Westergaard's wave: tangential tractions are differences of normal ones (Ciavarella, Jaeger)."""

import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from support.contact_conditions import sticking

HEIGHT, FRICTION = 0.01, 0.3
FULL = np.pi * HEIGHT  # mean pressure of full contact, in E*
LOAD = 0.2 * FULL


def pressure(x, load):
    """Pressure of a wave of half the height difference HEIGHT under a mean pressure (Johnson 1985, 13.2)."""
    share = max(load, 0.0) / FULL
    return 2.0 * FULL * np.cos(np.pi * x) * np.sqrt(np.maximum(share - np.sin(np.pi * x) ** 2, 0.0))


def half_width(load):
    return np.arcsin(np.sqrt(load / FULL)) / np.pi


def step(nx, friction, load, sliding, before, solver="frictional_newton"):
    """A slab of height 4, which is a half-space to all waves, but has a mean tangential displacement."""
    x = np.arange(nx) / nx - 0.5
    punch = HEIGHT * (1.0 - np.cos(2.0 * np.pi * x))[np.newaxis]
    start = None if before is None else following(before, punch, sliding)
    interface, body = Interactions(True, friction=friction), ElasticBody(0.5, 4.0).response((nx,))
    found = equilibrate(punch, body, load, Options(solver), interface, start, sliding)
    assert found.status[0] == Status.ok
    return x, found, None if start is None else sticking(found, start)


def checked(found, x, exact, stuck, width):
    """Error of the traction over its largest, where half the stick zone is `width` within a node."""
    assert stuck.sum() / 2 == pytest.approx(width * len(x), abs=1.0)
    assert found.n_transforms[0] < 300
    return abs(found.tangential.traction[0, 0] - exact).max() / (FRICTION * pressure(0.0, LOAD))


def slid_and_back(nx):
    """Largest error of the traction as the punch is dragged until it nearly slides, and back, and all Q/(mu P)."""
    _, before, _ = step(nx, FRICTION, LOAD, 0.0, None)
    stiffness = ElasticBody(0.5, 4.0).response((nx,)).elements[0][0]
    far = 1.02 * FRICTION * LOAD / stiffness  # the body as a whole gives way more than its surface
    shares, errors = [], []
    for sliding in far * np.linspace(0.03, 0.985, 15):
        x, before, stuck = step(nx, FRICTION, LOAD, sliding, before)
        shares.append(before.tangential.traction[0].mean() / (FRICTION * LOAD))
        left = LOAD * (1.0 - shares[-1])
        exact = FRICTION * (pressure(x, LOAD) - pressure(x, left))
        errors.append(checked(before, x, exact, stuck, half_width(left)))
    first = shares[-1]
    for back in far * np.linspace(0.1, 1.6, 10):
        x, before, stuck = step(nx, FRICTION, LOAD, sliding - back, before)
        shares.append(before.tangential.traction[0].mean() / (FRICTION * LOAD))
        left = LOAD * (1.0 - (first - shares[-1]) / 2.0)
        turned = exact - 2.0 * FRICTION * (pressure(x, LOAD) - pressure(x, left))
        errors.append(checked(before, x, turned, stuck, half_width(left)))
    return max(errors), shares


@pytest.mark.long
def test_partial_slip_and_its_reversal_have_their_closed_form():
    errors, shares = zip(*(slid_and_back(nx) for nx in (256, 2048)), strict=True)
    assert min(np.abs(shares[1])) < 0.05
    assert max(shares[1]) > 0.95
    assert min(shares[1]) < -0.5
    assert errors[1] < 0.013
    assert errors[1] < 0.4 * errors[0]  # order 1/2 or better: edges lie between nodes


def test_less_load_makes_a_sticking_contact_slip_from_its_edge():
    """Unloaded at a constant drag, the contact slips where it is lost; the dynamics finds the same."""
    nx, drag = 128, 0.3 * FRICTION * LOAD / ElasticBody(0.5, 4.0).response((128,)).elements[0][0]
    found = {}
    for solver in ("frictional_newton", "verlet"):
        before = None
        for load, sliding in ((LOAD, 0.0), (LOAD, drag), (0.6 * LOAD, drag), (0.35 * LOAD, drag)):
            _, before, stuck = step(nx, FRICTION, load, sliding, before, solver)
        found[solver] = before, stuck
    (newton, stuck), (damped, damped_stuck) = found.values()
    np.testing.assert_array_equal(newton.touching, damped.touching)
    np.testing.assert_array_equal(stuck, damped_stuck)
    assert 0 < stuck.sum() < newton.touching.sum()
    scale = newton.pressure.max()
    np.testing.assert_allclose(newton.tangential.traction, damped.tangential.traction, atol=1e-6 * scale)
    assert 8 * newton.n_transforms[0] < damped.n_transforms[0]


def test_a_punch_dragged_far_slides_everywhere_sticks_when_it_turns_and_slides_back():
    _, at_rest, _ = step(256, FRICTION, LOAD, 0.0, None)
    _, forth, stuck = step(256, FRICTION, LOAD, 1.0, at_rest)
    bound = FRICTION * forth.pressure[0]
    np.testing.assert_allclose(forth.tangential.traction[0, 0], bound, atol=1e-8 * bound.max())
    assert not stuck.any()
    _, turning, stuck = step(256, FRICTION, LOAD, 1.0 - 1e-4, forth)
    assert stuck.sum() > 0.5 * turning.touching.sum()
    _, back, stuck = step(256, FRICTION, LOAD, -1.0, turning)
    np.testing.assert_allclose(back.tangential.traction[0, 0], -bound, atol=1e-8 * bound.max())
    assert not stuck.any()
