"""Partial slip on maps: a sphere-like asperity as Cattaneo and Mindlin have it, and a ridge dragged along itself."""

import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from support.map_contact_conditions import sticking

FRICTION, NEWTON = 0.3, Options("frictional_newton")
BODY = ElasticBody(0.5, 4.0)  # a half-space to all waves, but for its mean displacements
SPHERE, RADIUS = 128, 0.12  # nodes along x and y, Hertz's contact radius over L_x of a sphere of radius L_x
LOAD = 4.0 / 3.0 * RADIUS**3


def hertz(r, load):
    a = (0.75 * load) ** (1 / 3)
    return 2.0 / np.pi * np.sqrt(np.maximum(a**2 - r**2, 0.0))


@pytest.fixture(scope="module")
def dragged_spheres():
    """A sphere, then dragged in steps towards 30 degrees; frictionless pressures under what is left of the load."""
    x = (np.arange(SPHERE) - SPHERE // 2) / SPHERE
    r = np.hypot(x[:, np.newaxis], x)
    punch, stiffness = 0.5 * r[np.newaxis] ** 2, BODY.response((SPHERE, SPHERE))
    way = np.reshape([np.cos(np.pi / 6), np.sin(np.pi / 6)], (2, 1, 1))
    law = Interactions(True, friction=FRICTION)
    pressed = before = equilibrate(punch, stiffness, LOAD, NEWTON, law)
    far = 1.2 * FRICTION * LOAD / stiffness.elements[0, 0, 0]
    steps = []
    for share in (0.3, 0.9):
        drag = share * far * way
        before = equilibrate(punch, stiffness, LOAD, NEWTON, law, following(before, punch, drag), drag)
        assert before.status[0] == Status.ok
        along, across = (np.tensordot(turn, before.tangential.traction[0], 1) for turn in turns(way))
        left = LOAD - along.mean() / FRICTION
        frictionless = equilibrate(punch, stiffness.condensed(), left, Options("active_set_newton"))
        steps.append((before, along, across, left, frictionless.pressure[0]))
    return r, pressed, steps


def turns(way):
    x, y = way.ravel()
    return np.array([x, y]), np.array([-y, x])


def test_a_sphere_slips_in_a_ring_as_cattaneo_and_mindlin_say(dragged_spheres):
    """Its traction is mu times the difference of two pressures. They leave slip across the drag out of account.

    That costs up to 2 % of the traction along the drag here, and the traction across it, 7 %, altogether.
    """
    _, pressed, steps = dragged_spheres
    peak = FRICTION * pressed.pressure.max()
    shares = []
    for found, along, across, left, pressure in steps:
        shares.append(1.0 - left / LOAD)
        np.testing.assert_allclose(found.pressure, pressed.pressure, atol=1e-7 * pressed.pressure.max())
        assert abs(along - FRICTION * (pressed.pressure[0] - pressure)).max() < 0.02 * peak
        assert 0.01 * peak < abs(across).max() < 0.08 * peak
        assert abs(across.mean()) < 2e-3 * along.mean()
        radius = np.sqrt(sticking(found).sum() / np.pi) / SPHERE
        assert radius == pytest.approx(RADIUS * (left / LOAD) ** (1 / 3), abs=0.5 / SPHERE)
    assert shares[0] < 0.3
    assert shares[-1] > 0.6


def test_the_ring_has_the_closed_form_of_hertzian_contact(dragged_spheres):
    """To what the grid and the neighbours of a sphere make of Hertz's pressure."""
    r, pressed, steps = dragged_spheres
    scale = FRICTION * hertz(0.0, LOAD)
    of_pressure = np.sqrt(np.mean((pressed.pressure[0] - hertz(r, LOAD)) ** 2)) / hertz(0.0, LOAD)
    assert of_pressure < 0.005
    for _, along, _, left, _ in steps:
        exact = FRICTION * (hertz(r, LOAD) - hertz(r, left))
        assert np.sqrt(np.mean((along - exact) ** 2)) / scale < 0.008


HEIGHT = 0.01
FULL = np.pi * HEIGHT  # mean pressure of full contact, in E*
WAVE = 0.2 * FULL


def westergaard(x, load):
    """Pressure of a wave of half the height difference HEIGHT under a mean pressure (Johnson 1985, 13.2)."""
    return 2.0 * FULL * np.cos(np.pi * x) * np.sqrt(np.maximum(max(load, 0.0) / FULL - np.sin(np.pi * x) ** 2, 0.0))


def ridge_dragged_along_itself(nx):
    """Errors of stick width (nodes) and traction of Westergaard's wave over x, dragged along y and back.

    Where nothing changes over y, shear G |q| and pressure E* |q| / 2 have the same contact problem, so that the
    traction is again mu times a difference of pressures (as in the plane, Ciavarella, Jaeger).
    """
    x, law = np.arange(nx) / nx - 0.5, Interactions(True, friction=FRICTION)
    punch = np.tile(HEIGHT * (1.0 - np.cos(2.0 * np.pi * x)), (1, 8, 1))
    stiffness = BODY.response((8, nx))
    pressed = before = equilibrate(punch, stiffness, WAVE, NEWTON, law)
    far = FRICTION * WAVE / stiffness.elements[2, 0, 0]
    widths, errors, exact, first = [], [], 0.0, 0.0
    for drag in far * np.array([0.3, 0.7, 0.95, 0.6, 0.0]):
        start = following(before, punch, np.reshape([0.0, drag], (2, 1, 1)))
        before = equilibrate(punch, stiffness, WAVE, NEWTON, law, start, np.reshape([0.0, drag], (2, 1, 1)))
        assert before.status[0] == Status.ok
        along, across = before.tangential.traction[0, 1], before.tangential.traction[0, 0]
        share = along.mean() / (FRICTION * WAVE)
        if share > first:
            left, first = WAVE * (1.0 - share), share
            exact = forth = FRICTION * (westergaard(x, WAVE) - westergaard(x, left))
        else:
            left = WAVE * (1.0 - 0.5 * (first - share))
            exact = forth - 2.0 * FRICTION * (westergaard(x, WAVE) - westergaard(x, left))
        half_width = np.arcsin(np.sqrt(left / FULL)) / np.pi
        widths.append(sticking(before)[0].sum() / 2 - half_width * nx)
        errors.append(abs(along - exact).max() / (FRICTION * westergaard(0.0, WAVE)))
        assert abs(across).max() < 1e-8 * pressed.pressure.max()
        assert abs(along - along[0]).max() < 1e-8 * pressed.pressure.max()
    return widths, errors


@pytest.mark.long
def test_a_ridge_dragged_along_itself_slips_as_its_closed_form_says():
    coarse, fine = (ridge_dragged_along_itself(nx) for nx in (128, 512))
    assert max(np.abs(fine[0])) < 1.0
    assert max(fine[1]) < 0.015
    assert max(fine[1]) < 0.6 * max(coarse[1])  # order 1/2 or better: edges lie between nodes
