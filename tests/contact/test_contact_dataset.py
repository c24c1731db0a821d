"""The fields of a contact in the units of its file."""

import numpy as np
import pytest

from gfmd_numba.arrays.threads import shared_by
from gfmd_numba.contact.contact_dataset import Units, scaled
from gfmd_numba.scene.scene_file import load_scene


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("shape", [(), (3,), (600, 513)])
def test_values_are_scaled_one_by_one_whoever_shares_the_work(shape, threads):
    values = np.random.default_rng(1).normal(size=shape)
    with shared_by(threads):
        np.testing.assert_array_equal(scaled(np.asarray(values), 0.3), values * 0.3)


def test_counts_that_need_no_scale_stay_whole():
    assert scaled(np.array([1, 2]), 1.0).dtype.kind == "i"


@pytest.mark.parametrize(("length", "speed"), [({}, "s-1"), ({"length": 1e-3}, "m s-1")])
def test_without_a_length_speeds_count_periods(length, speed):
    body = {"poissons_ratio": 0.5, "relaxation": [{"modulus": 3.0, "time": 1.0}]}
    rough = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1}
    loading = {"reduced_pressure": 0.1, "speed": 1e-3}
    scene = {"body": body, "roughness": rough, "interface": {"hard_wall": {}}, "loading": loading} | length
    levels = {"eps_c": 0.5, "eps_f": 0.5, "eps_t": 0.5}
    assert Units.of(load_scene({"scene": scene, "discretisation": levels})[0].scene).names["speed"] == speed
