"""Sliding past a quarter of the distance of two peaks is solved as small sliding, and the result says so."""

import numpy as np
import pytest

import gfmd_numba

N = 64
SCENE = {
    "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.2},
    "interface": {"hard_wall": {}, "friction": {"coefficient": 0.1}},
    "loading": {"reduced_pressure": 0.1},
}


def slide(distances, waves=4, **changes):
    """Drag a profile of waves, or a map of ridges across x, in L_x."""
    heights = 1e-3 / waves * np.cos(2.0 * np.pi * waves * np.arange(N) / N)
    scene = SCENE | changes
    if changes.get("dimension") == 2:
        heights = np.tile(heights, (N, 1))
    return gfmd_numba.solve({"scene": scene, "path": [{"sliding": s} for s in distances]}, heights).validity


@pytest.mark.parametrize("waves", [1, 4])
def test_a_wave_may_slide_a_quarter_of_its_length(waves):
    assert slide([0.24 / waves], waves) == ""
    with pytest.warns(UserWarning, match="past the body, 0.26 times the mean distance of the peaks"):
        slide([0.26 / waves], waves)


@pytest.mark.long
def test_the_farthest_step_of_a_path_counts_and_the_way_back_does_not():
    assert slide([0.05, -0.05] * 3) == ""
    with pytest.warns(UserWarning, match=r"has slid past the body, 0.32 times .*\(in step 1 of 2\)$"):
        slide([0.08, 0.0])


@pytest.mark.filterwarnings("ignore")
def test_maps_and_cohesive_laws_are_looked_at_too():
    apart = 0.25 * (2.0 / 1.5) ** 0.5  # of peaks along any direction, if the map were isotropic
    assert f"{0.1 / apart:.2g} times the mean distance" in slide([0.1], dimension=2)
    law = {"cohesive": {"work_of_adhesion": 1e-8, "normal_length": 1e-3, "tangential_length": 1e-3}}
    assert "0.32 times the mean distance" in slide([0.08], interface=law)


def test_the_share_of_that_distance_is_the_same_in_metres():
    scene = SCENE | {"length": "0.1 mm", "roughness": {"units": {"z": "m"}}}
    heights = 1e-4 * 0.25e-3 * np.cos(2.0 * np.pi * 4 * np.arange(N) / N)
    with pytest.warns(UserWarning, match="has slid past the body, 0.32 times"):
        found = gfmd_numba.solve({"scene": scene, "path": [{"sliding": "8 um"}]}, heights)
    moved = found["tangential_displacement"].isel(step=1)[found["gap"].isel(step=1).values == 0.0]
    assert float(found["slid_over_peaks"][1]) == pytest.approx(float(abs(8e-6 - moved).max()) / 25e-6, rel=1e-3)
