"""Friction of scene files and campaigns: which solver takes it, and a mean displacement that is rigid."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign

PSD = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
EPS = {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}


def scene(friction, loading, poissons_ratio=0.5):
    return {
        "body": {"poissons_ratio": poissons_ratio, "aspect_ratio": 0.5},
        "roughness": PSD,
        "interface": {"hard_wall": {}, "friction": {"coefficient": friction}},
        "loading": loading,
    }


def test_an_incompressible_slab_is_dragged_to_and_fro_by_a_displaced_punch():
    path = [{"sliding": 1e-3}, {"displacement": 1e-4}, {"sliding": 0.0}]
    file = {"scene": scene(0.3, {"displacement": 2e-4}), "discretisation": EPS, "path": path}
    found = gfmd_numba.solve(file)
    assert found.attrs["solver"] == "frictional_newton"
    assert (found["status"] == 0).all()
    height = float(np.ptp(found["height"].values[0] if found["height"].ndim > 1 else found["height"].values))
    assert (abs(found["displacement"].mean("x")) < 1e-9 * height).all()  # it keeps its volume
    pressure, shear = found["pressure"].values, found["tangential_traction"].values
    assert (abs(shear) <= 0.3 * pressure + 1e-7 * pressure.max()).all()
    for step, sign in ((1, 1.0), (2, 1.0), (3, -1.0)):
        np.testing.assert_allclose(shear[step], sign * 0.3 * pressure[step], atol=1e-7 * pressure.max())


@pytest.mark.parametrize("friction", [0.3, float("inf")])
@pytest.mark.parametrize("work", [0.0, 1e-6, -1e-6])
def test_auto_takes_newtons_method_for_any_coefficient_and_any_law_of_the_gap(friction, work):
    file = {"scene": scene(friction, {"reduced_pressure": 0.05}, 0.3), "discretisation": EPS}
    if work:
        file["scene"]["interface"]["exponential"] = {"work_of_adhesion": work, "range": 1e-3}
    found = gfmd_numba.solve(file)
    assert found.attrs["solver"] == "frictional_newton"
    assert int(found["status"]) == 0
    assert int(found["n_iterations"]) <= 100  # and no other after it


def test_an_infinite_coefficient_in_a_grid_is_allowed_with_newtons_method():
    campaign = {
        "name": "mu",
        "seed": 1,
        "realisations": 1,
        "scene": scene(0.3, {"reduced_pressure": 0.05}, 0.3),
        "reference": EPS,
        "grid": {"friction_coefficient": [0.1, float("inf")]},
    }
    for numerics in ({}, {"solver": "frictional_newton"}):
        load_campaign(campaign | {"numerics": numerics})
