"""A campaign of maps dragged along both axes: its forces and losses against the fields of the same contacts."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.analysis.plots.path import plot_path

SCENE = {
    "dimension": 2,
    "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1},
    "interface": {"hard_wall": {}, "friction": {"coefficient": 0.3}},
    "loading": {"reduced_pressure": 0.05},
}
EPS = {"eps_c": 1 / 4, "eps_f": 1 / 4, "eps_t": 1 / 2}
PATH = [{"sliding": 0.02}, {"sliding_y": 0.03}, {"sliding_y": 0.06}]


@pytest.fixture(scope="module")
def dragged(tmp_path_factory):
    asked = {"name": "maps", "seed": 3, "realisations": 2, "scene": SCENE, "reference": EPS, "path": PATH}
    asked["grid"] = {"friction_coefficient": [0.3]}
    return gfmd_numba.run(asked, tmp_path_factory.mktemp("maps") / "out", workers=0)


@pytest.fixture(scope="module")
def fields():
    return gfmd_numba.solve({"scene": SCENE, "discretisation": EPS, "seed": 3, "realisation": 1, "path": PATH})


@pytest.mark.long
def test_forces_along_both_axes_are_means_of_the_tractions(dragged, fields):
    assert (dragged["status"] == 0).all()
    np.testing.assert_array_equal(dragged["step_sliding"][0], [0.0, 0.02, 0.02, 0.02])
    np.testing.assert_array_equal(dragged["step_sliding_y"][0], [0.0, 0.0, 0.03, 0.06])
    for axis in ("", "_y"):
        expected = fields[f"tangential_traction{axis}"].mean(("y", "x"))
        np.testing.assert_allclose(dragged[f"mean_tangential_traction{axis}"][0, 1], expected, atol=1e-12)


@pytest.mark.long
def test_a_sliding_map_loses_the_tractions_times_the_slip(dragged, fields):
    """In the last step all nodes slide along y, hardly turning any more."""
    assert dragged["stick_fraction"][0, 1, -1] == 0.0
    traction = np.hypot(fields["tangential_traction"], fields["tangential_traction_y"])
    expected = float((traction * fields["slip"])[-1].mean())
    assert float(dragged["energy_lost"][0, 1, -1]) == pytest.approx(expected, rel=0.05)


@pytest.mark.long
def test_the_picture_tells_the_axes_apart(dragged):
    labels = [(panel.get_xlabel(), panel.get_ylabel()) for panel in plot_path(dragged).axes]
    sliding = [" ".join(label) for label in labels if "Sliding" in label[0]]
    assert ["along $y$ (" in label for label in sliding] == [False, True]
    assert sliding[1].count("along $y$ (") == 2
