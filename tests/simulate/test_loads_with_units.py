"""Load curves of measured surfaces in engineering units, from a file or from an array, are one and the same."""

import numpy as np
import pytest
import xarray as xr
import yaml
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.cli import main
from gfmd_numba.scene import InputError

SCENE = {
    "length": "0.2 mm",
    "body": {"youngs_modulus": "70 GPa", "poissons_ratio": 0.33},
    "interface": {"hard_wall": {}},
    "loading": {"pressure": "10 MPa"},
}
LOADS = ["10 MPa", "100 MPa", "1 GPa"]


@pytest.fixture(params=[1, pytest.param(2, marks=pytest.mark.long)], ids=["profile", "map"])
def heights(request):
    """Heights in m."""
    surface = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05, "points": 64, "cut_on": 1 / 16, "roll_off": 1 / 2}
    return 2e-4 * gfmd_numba.make_surface({"surface": surface, "dimension": request.param})["height"].values


@pytest.mark.usefixtures("undrawn")
def test_a_file_and_an_array_give_the_same_curve_in_one_command_and_one_call(heights, tmp_path):
    np.save(tmp_path / "steel.npy", 1e6 * heights)
    scene = SCENE | {"roughness": {"method": "measured", "file": "steel.npy", "units": {"z": "um"}}}
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(scene))
    line = ["curve", str(tmp_path / "scene.yaml"), "--loads", "10MPa:1GPa:3", "-o", str(tmp_path / "curve.nc")]
    done = CliRunner().invoke(main, line)
    assert done.exit_code == 0, done.output
    found = gfmd_numba.load_curve(SCENE | {"roughness": {"units": {"z": "m"}}}, LOADS, heights=heights)
    with xr.open_dataset(tmp_path / "curve.nc") as written:
        np.testing.assert_allclose(written["prescribed_load"], [1e7, 1e8, 1e9], rtol=1e-12)
        assert written["prescribed_load"].units == "Pa"
        for name in ("contact_area_fraction", "mean_gap", "peak_pressure", "mean_pressure"):
            np.testing.assert_allclose(written[name], found[name], rtol=1e-6, err_msg=name)
        np.testing.assert_allclose(written["mean_pressure"], written["prescribed_load"], rtol=1e-9)


def test_units_of_the_loads_replace_the_loading_of_the_scene(heights):
    scene = SCENE | {"roughness": {"units": {"z": "m"}}}
    reduced = scene | {"loading": {"reduced_pressure": 0.01}}
    own, other = (gfmd_numba.load_curve(each, ["50 MPa"], heights=heights) for each in (scene, reduced))
    assert float(own["contact_area_fraction"][0]) == float(other["contact_area_fraction"][0])
    load, by = ("10 N/mm", 1 / 2e-4) if heights.ndim == 1 else ("2 N", 1 / 2e-4**2)
    found = gfmd_numba.load_curve(scene, [load], heights=heights)
    assert float(found["mean_pressure"][0]) == pytest.approx((1e4 if heights.ndim == 1 else 2.0) * by, rel=1e-9)


@pytest.mark.parametrize(
    ("loads", "said"),
    [
        (["50 MPa", "2 N"], r"loads\[1\]: you gave '2 N'; gfmd allows a pressure in Pa, kPa, MPa, GPa or the like"),
        (["5 MPa", "50 MPA"], r"loads\[1\]: you gave '50 MPA'; gfmd allows .*; did you mean 'MPa'\?"),
        (["1.0D6 Pa"], r"loads\[0\]: you gave '1.0D6 Pa'; gfmd allows .*; exponents have an e: 1.0e6"),
        (["a lot"], r"loads\[0\]: you gave 'a lot'"),
        ("50 MPa", r"loads: you gave '50 MPa'"),
        ([10, "50 MPa"], r"loads: you gave \[10, '50 MPa'\]; gfmd allows loads that all have a unit, or none"),
    ],
)
def test_loads_of_no_kind_are_refused(heights, loads, said):
    with pytest.raises(InputError, match=said):
        gfmd_numba.load_curve(SCENE | {"roughness": {"units": {"z": "m"}}}, loads, heights=heights)


@pytest.mark.parametrize(
    ("load", "hint"), [("50 MPA", r"did you mean 'MPa'\?"), ("1.0D6 Pa", "exponents have an e: 1.0e6")]
)
def test_a_unit_is_guessed_with_a_reduced_pressure_too(load, hint):
    scene = {"body": {"poissons_ratio": 0.3}, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.05}}
    with pytest.raises(InputError, match=rf"loads\[0\]: you gave '{load}'; gfmd allows .*; {hint}"):
        gfmd_numba.load_curve(scene, [load], heights=1e-3 * np.sin(np.arange(16) * np.pi / 8))


def test_loads_in_pascal_need_moduli():
    scene = {"body": {"poissons_ratio": 0.3}, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.05}}
    with pytest.raises(InputError, match="gfmd allows pressure with a youngs_modulus of every elastic body"):
        gfmd_numba.load_curve(scene, ["50 MPa"], heights=1e-3 * np.sin(np.arange(16) * np.pi / 8))


def test_a_mean_pressure_above_the_modulus_is_told():
    scene = {"body": {"poissons_ratio": 0.3}, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 20.0}}
    with pytest.warns(UserWarning, match=r"strains are no longer small on 100 % .* \(the largest are 1\.84 E\*"):
        gfmd_numba.solve(scene, 0.02 * np.sin(np.arange(64) * np.pi / 32))
