"""Ridges with friction: maps that are constant along one axis are profiles."""

import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from support.frictional_maps import follow, press

LAYERS = ElasticBody.layered((0.05, 0.2), (Material(1.0, 0.2), Material(0.1, 0.4)), None)


@pytest.mark.parametrize(
    ("body", "friction", "along"),
    [
        (ElasticBody(0.3, None), 1.0, "y"),
        (ElasticBody(0.2, 0.3), 0.3, "x"),
        pytest.param(ElasticBody(0.5, 0.3), 0.3, "y", marks=pytest.mark.long),
        pytest.param(LAYERS, 0.4, "y", marks=pytest.mark.long),
    ],
)
def test_ridges_are_profiles(body, friction, along):
    """Dragged along their profile and back; a ridge has the stiffness of a profile, and nothing moves along it."""
    n, across = 64, 6
    heights = self_affine.SelfAffineWaves(0.8, 2, 16).heights((n,), 3, range(1))
    punch = heights.max() - heights
    ridges = np.repeat(punch[:, np.newaxis], across, axis=1)
    ridges = ridges if along == "x" else ridges.swapaxes(1, 2)
    drags = (0.0,) if body.aspect_ratio is None else (0.0, 1e-3, 2e-2, 1.9e-2)
    ways = [(drag, 0.0) if along == "x" else (0.0, drag) for drag in drags]
    options = Options("frictional_newton", residual=1e-10)
    maps = follow([(ridges, 0.1, way) for way in ways], body, friction, options)
    before, slipped = None, 0
    for drag, (found, _) in zip(drags, maps, strict=True):
        start = None if before is None else following(before, punch, drag)
        law = Interactions(True, friction=friction)
        before = equilibrate(punch, body.response((n,)), 0.1, options, law, start, drag)
        assert before.status[0] == found.status[0] == Status.ok
        own, other = found.tangential.traction[0], found.tangential.slip[0]
        if along == "y":
            own, other = own[::-1].swapaxes(1, 2), other[::-1].swapaxes(1, 2)
        pressure = found.pressure[0] if along == "x" else found.pressure[0].T
        peak, tangential = before.pressure.max(), before.tangential
        np.testing.assert_allclose(pressure, np.tile(before.pressure, (across, 1)), atol=1e-8 * peak)
        np.testing.assert_allclose(own[0], np.tile(tangential.traction[0], (across, 1)), atol=1e-8 * peak)
        np.testing.assert_allclose(other[0], np.tile(tangential.slip[0], (across, 1)), atol=1e-8 * peak)
        np.testing.assert_array_equal(other[0] == 0.0, np.tile(tangential.slip[0], (across, 1)) == 0.0)
        assert abs(own[1]).max() < 1e-8 * peak
        slipped += np.count_nonzero(tangential.slip)
    assert slipped > 0


@pytest.mark.parametrize("friction", [0.2, np.inf])
def test_a_ridge_of_flat_punches_sticks_as_its_profile_does(friction):
    """The dynamics anchors their nodes at once, so that it has no history to differ by."""
    profile = np.full((1, 64), 10.0)
    profile[0, 20:30] = 0.0
    body, options, law = (
        ElasticBody(0.1, None),
        Options("verlet", residual=1e-10),
        Interactions(True, friction=friction),
    )
    one = equilibrate(profile, body.response((64,)), 0.01, options, law)
    two = press(np.repeat(profile[:, np.newaxis], 4, axis=1), body, 0.01, friction, options=options)
    assert one.status[0] == two.status[0] == Status.ok
    peak = one.pressure.max()
    np.testing.assert_allclose(two.pressure[0], np.tile(one.pressure, (4, 1)), atol=1e-8 * peak)
    traction = two.tangential.traction[0]
    np.testing.assert_allclose(traction[0], np.tile(one.tangential.traction[0], (4, 1)), atol=1e-8 * peak)
    assert abs(traction[1]).max() < 1e-12 * peak
