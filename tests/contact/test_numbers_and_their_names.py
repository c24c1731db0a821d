"""Numbers are printed and stored under names they deserve: no area-load coefficient of tension, counts as counts."""

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.analysis import secant_stiffness
from gfmd_numba.cli import main
from gfmd_numba.contact.observables import OBSERVABLES

pytestmark = pytest.mark.usefixtures("undrawn")

COEFFICIENTS = [name for name in OBSERVABLES if name.startswith("kappa")]


@pytest.fixture(scope="module")
def adhesive(tmp_path_factory):
    """A scene of an adhesive wave on a slab, pressed and then drawn back until it is under tension."""
    folder, nodes = tmp_path_factory.mktemp("adhesive"), 128
    np.save(folder / "wave.npy", 0.01 * np.cos(2 * np.pi * np.arange(nodes) / nodes))
    scene = {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.5},
        "roughness": {"method": "measured", "file": "wave.npy"},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 2e-4, "range": 1e-2}},
        "loading": {"displacement": 0.03},
    }
    path = folder / "wave.yaml"
    path.write_text(yaml.safe_dump({"scene": scene, "path": [{"displacement": 0.0}, {"displacement": 0.01}]}))
    return path


def test_tension_has_no_area_load_coefficient(adhesive):
    found = gfmd_numba.solve(adhesive)
    assert (found["status"] == 0).all()
    pressed = found["mean_pressure"].values > 0
    assert pressed.tolist() == [True, False, True]
    assert (found["contact_area_fraction"] > 0).all()
    for name in COEFFICIENTS:
        np.testing.assert_array_equal(np.isfinite(found[name].values), pressed, err_msg=name)
        assert "mean pressure" in found[name].comment


def test_a_coefficient_that_is_not_there_is_printed_as_a_dash(adhesive):
    done = CliRunner().invoke(main, ["solve", str(adhesive), "-o", str(adhesive.parent / "out.nc")])
    assert done.exit_code == 0, done.output
    steps = [words for words in map(str.split, done.stdout.splitlines()) if words and words[0].isdigit()]
    assert ["-" in words for words in steps[-3:]] == [False, True, False]
    assert "nan" not in done.output


def test_surfaces_behind_a_stiffness_are_counted(adhesive):
    counted = secant_stiffness(gfmd_numba.solve(adhesive))["n_realisations"]
    assert np.issubdtype(counted.dtype, np.integer)
    assert counted.values.tolist() == [1, 1]


def test_gradients_of_rough_bodies_are_said_to_be_of_all_heights(adhesive):
    scene = yaml.safe_load(adhesive.read_text())["scene"]
    rough = scene.pop("roughness") | {"file": str(adhesive.parent / "wave.npy")}
    scene |= {"body": scene["body"] | {"roughness": rough}, "interface": {"hard_wall": {}}}
    found = gfmd_numba.solve({"scene": scene})
    for name in ("rms_gradient", "rms_gradient_contact", "nayak"):
        assert "of the sum of the heights" in found[name].long_name
    assert not any("of the punch" in variable.attrs.get("long_name", "") for variable in found.data_vars.values())


def test_transforms_are_those_of_the_grid():
    assert (
        OBSERVABLES["n_transforms"].long_name == "fast Fourier transforms of the whole grid"
    )  # of nx nodes, or of nx^2
