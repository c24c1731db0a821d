"""A scene whose ensemble is scaled by theory has the surface of one that is scaled by itself, times a factor."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.scene import InputError

ROUGHNESS = {"method": "psd", "hurst": 0.8, "points": 64, "cut_on": 1 / 16, "roll_off": 0.5}


def scene(**given):
    return {
        "scene": {
            "body": {"poissons_ratio": 0.3},
            "roughness": ROUGHNESS | given,
            "interface": {"hard_wall": {}},
            "loading": {"reduced_pressure": 0.05},
        },
        "seed": 4,
    }


@pytest.mark.parametrize("asked", [{"rms_gradient": 0.02}, {"rms_height": 0.001}], ids=lambda given: next(iter(given)))
def test_a_scene_has_the_surface_of_its_file_times_a_factor(asked):
    each, ensemble = (gfmd_numba.solve(scene(**asked, scaling=name)) for name in ("each", "ensemble"))
    factor = float(ensemble["height"].std() / each["height"].std())
    np.testing.assert_allclose(ensemble["height"], factor * each["height"], atol=1e-12)
    assert abs(factor - 1.0) > 0.01
    assert int(ensemble["status"]) == 0
    surface = gfmd_numba.make_surface({"surface": ROUGHNESS | asked | {"scaling": "ensemble"}, "seed": 4})
    assert float(surface["height"].std()) == pytest.approx(float(ensemble["height"].std()), rel=1e-12)


def test_another_scaling_is_refused():
    with pytest.raises(
        InputError, match=r"scene\.roughness\.scaling: you gave 'theory'; gfmd allows one of 'each', 'ensemble'"
    ):
        gfmd_numba.solve(scene(rms_height=0.001, scaling="theory"))
