"""What `gfmd solve` gives for maps with friction and a law of the gap, against the conditions of contact by NumPy."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.elasticity.body import ElasticBody
from support.map_contact_conditions import tractions

FRICTION = 0.3


@pytest.mark.parametrize("work", [1e-6, -1e-6])
@pytest.mark.parametrize("nodes", [pytest.param(4, marks=pytest.mark.long), 7])
def test_tiny_and_odd_maps_obey_the_conditions_of_contact_on_every_step(work, nodes):
    heights = 1e-3 * np.random.default_rng(nodes).normal(size=(nodes, nodes))
    scene = {
        "dimension": 2,
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5},
        "interface": {
            "hard_wall": {},
            "friction": {"coefficient": FRICTION},
            "exponential": {"work_of_adhesion": work, "range": 2e-3},
        },
        "loading": {"reduced_pressure": 0.3},
    }
    path = [{"sliding": 5e-4, "sliding_y": -2e-4}, {"reduced_pressure": 0.1}]
    found = gfmd_numba.solve({"scene": scene, "path": path}, heights)
    stiffness = ElasticBody(0.3, 0.5).response(heights.shape)
    assert (found["status"] == 0).all()
    for _, step in found.groupby("step", squeeze=False):
        step = step.squeeze("step")
        sideways = np.array([step["tangential_displacement"], step["tangential_displacement_y"]])
        load = float(step["pressure"].mean())
        shear, pressure = tractions(stiffness, sideways, step["displacement"].values, load)
        gap = step["gap"].values
        wall = pressure + work / 2e-3 * np.exp(-gap / 2e-3)
        touching, slack = gap <= 0.0, 1e-7 * wall.max()
        assert load == pytest.approx(float(step["mean_pressure"]), rel=1e-12)
        assert gap.min() == 0.0
        assert wall[touching].min() >= -slack
        assert abs(wall[~touching]).max(initial=0.0) <= slack
        assert (np.hypot(*shear) <= FRICTION * np.where(touching, wall, 0.0) + slack).all()
        np.testing.assert_allclose(shear[0], step["tangential_traction"], atol=slack)
        np.testing.assert_allclose(shear[1], step["tangential_traction_y"], atol=slack)
