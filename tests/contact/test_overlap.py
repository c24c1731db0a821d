"""Surfaces that a cohesive law alone lets far through each other are told."""

import warnings

import numpy as np
import pytest

import gfmd_numba

LAW = {"work_of_adhesion": 1e-4, "normal_length": 2e-3, "tangential_length": 8e-3}


def pressed(pressure, **interface):
    scene = {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "measured", "heights": 1e-3 * np.cos(2.0 * np.pi * np.arange(64) / 64)},
        "interface": {"cohesive": LAW} | interface,
        "loading": {"reduced_pressure": pressure},
    }
    return gfmd_numba.solve({"scene": scene})


def test_an_overlap_beyond_the_range_of_the_law_is_told():
    with pytest.warns(UserWarning, match=r"the surfaces overlap by up to [\d.]+ times normal_length"):
        found = pressed(200.0)
    assert float(found["gap"].min()) < -LAW["normal_length"]
    assert "overlap" in found.attrs["validity"]


@pytest.mark.parametrize(("pressure", "interface"), [(0.05, {}), (200.0, {"hard_wall": {}})])
def test_surfaces_that_hardly_overlap_are_solved_without_a_word(pressure, interface):
    with warnings.catch_warnings():
        warnings.filterwarnings("error", "the surfaces overlap")
        found = pressed(pressure, **interface)
    assert int(found["status"]) == 0
    assert float(found["gap"].min()) > -LAW["normal_length"]
