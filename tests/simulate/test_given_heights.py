"""Heights that a user gives as an array, or as a map in a file, are pressed like any other surface."""

import json

import numpy as np
import pytest
import xarray as xr
import yaml
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.cli import main
from gfmd_numba.scene import InputError, load_scene

pytestmark = pytest.mark.usefixtures("undrawn")

SCENE = {"body": {"poissons_ratio": 0.3}, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.05}}
PSD = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
EPS = {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}


@pytest.fixture(scope="module", params=[1, 2])
def pressed(request):
    """A random surface that is pressed, to be given again as heights."""
    return gfmd_numba.solve(SCENE | {"dimension": request.param, "roughness": PSD, "discretisation": EPS})


def assert_same(found, expected):
    np.testing.assert_array_equal(found["pressure"] > 0, expected["pressure"] > 0)
    assert float(found["kappa"]) == pytest.approx(float(expected["kappa"]), rel=1e-9)
    assert found.attrs["validity"] == ""


def test_a_numpy_array_is_pressed_in_units_of_the_period(pressed):
    assert_same(gfmd_numba.solve(SCENE, pressed["height"].values), pressed)


def test_an_xarray_array_brings_its_positions_and_units(pressed):
    height = 1e-4 * pressed["height"]
    height = height.assign_coords({dim: 1e-4 * height[dim] for dim in height.dims})
    for each in (height, *(height[dim] for dim in height.dims)):
        each.attrs["units"] = "m"
    found = gfmd_numba.solve(SCENE, height)
    assert_same(found, pressed)
    assert found["x"].units == "m"
    assert float(found["x"][1]) == pytest.approx(1e-4 / pressed.sizes["x"])


def test_heights_go_with_a_file_and_a_record(pressed, tmp_path):
    heights = pressed["height"].values
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(SCENE))
    record = load_scene(SCENE | {"roughness": {"method": "measured", "heights": heights}})[0]
    for found in (gfmd_numba.solve(tmp_path / "scene.yaml", heights), gfmd_numba.solve(record)):
        assert_same(found, pressed)


def test_heights_are_treated_as_their_roughness_says(pressed):
    tilted = pressed["height"].values + 0.02 * np.arange(pressed.sizes["x"]) / pressed.sizes["x"]
    found = gfmd_numba.solve(SCENE | {"roughness": {"detrend": "tilt", "periodic": "mirror"}}, tilted)
    assert found.sizes["x"] == 2 * pressed.sizes["x"]
    assert "tilt" in found.attrs["processing"]


def test_a_map_in_a_file_needs_no_dimension(tmp_path):
    map_ = gfmd_numba.solve(SCENE | {"dimension": 2, "roughness": PSD, "discretisation": EPS})
    np.save(tmp_path / "map.npy", map_["height"])
    scene = SCENE | {"roughness": {"method": "measured", "file": "map.npy"}}
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(scene))
    done = CliRunner().invoke(main, ["solve", str(tmp_path / "scene.yaml"), "-o", str(tmp_path / "out.nc")])
    assert done.exit_code == 0, done.output
    with xr.open_dataset(tmp_path / "out.nc") as found:
        assert_same(found, map_)
        assert found["kappa"].ndim == 0


def test_fields_and_statistics_of_given_heights_are_found(pressed):
    found = gfmd_numba.solve(SCENE, pressed["height"].values)
    if pressed["height"].ndim == 1:
        assert gfmd_numba.body_fields(found).sizes["z"] == 101
        assert "pressure_density" in gfmd_numba.contact_statistics(found) or gfmd_numba.contact_statistics(found)


@pytest.mark.parametrize(
    ("heights", "said"),
    [
        ([1, "a"], r"roughness.heights: you gave \[1, 'a'\]; gfmd allows a list of at least 4 numbers"),
        (np.zeros((4, 4, 4)), r"roughness.heights: you gave array\(.*; gfmd allows a list of at least 4 numbers"),
        (np.zeros(8), r"roughness.heights: you gave an array of 8 \(a flat surface"),
        (np.full(8, np.nan), r"roughness.heights: you gave an array of 8 \(1 of all heights missing"),
        (np.zeros(2), r"roughness.heights: you gave an array of 2 \(2 heights, not at least 4"),
        (
            np.random.default_rng(0).normal(size=(8, 16)),
            r"you gave an array of 8 x 16 .*; gfmd allows a map of as many points",
        ),
        (len, r"roughness.heights: you gave <built-in function len>"),
    ],
    ids=str,
)
def test_heights_that_are_no_surface_are_refused(heights, said):
    with pytest.raises(InputError, match=said):
        gfmd_numba.solve(SCENE, heights)


def test_heights_with_another_roughness_are_refused():
    with pytest.raises(InputError, match=r"roughness: you gave .*; gfmd allows nothing with heights"):
        gfmd_numba.solve(SCENE | {"roughness": PSD}, np.zeros(8))
    with pytest.raises(InputError, match=r"roughness.file: you gave nothing; gfmd needs a file or heights"):
        gfmd_numba.solve(SCENE | {"roughness": {"method": "measured"}})


def test_an_array_that_only_its_digest_tells_is_asked_for_again():
    record = load_scene(SCENE | {"roughness": {"method": "measured", "heights": np.arange(8.0)}})[0]
    again = type(record).model_validate_json(record.model_dump_json())
    assert again.scene.roughness.heights == record.scene.roughness.heights
    with pytest.raises(InputError, match="an array that was not kept: give it again"):
        gfmd_numba.solve(again)


def test_masked_heights_are_missing_ones(pressed):
    heights = pressed["height"].values
    hidden = np.zeros(heights.shape, dtype=bool)
    hidden.flat[3:6] = True
    masked = np.ma.array(np.where(hidden, 0.0, heights), mask=hidden)
    with pytest.raises(InputError, match="height nan at index"):
        gfmd_numba.solve(SCENE, masked)
    filled = gfmd_numba.solve(SCENE | {"roughness": {"fill": "interpolate"}}, masked)
    assert "filled 3 missing heights" in filled.attrs["processing"]


@pytest.mark.filterwarnings("ignore:nodes that touch stick out")  # heights are those of noise
def test_the_dimensions_of_a_map_count_by_their_names():
    heights = 1e-3 * np.random.default_rng(0).normal(size=(16, 16))
    straight = gfmd_numba.solve(SCENE, xr.DataArray(heights, dims=("y", "x")))
    turned = gfmd_numba.solve(SCENE, xr.DataArray(heights.T, dims=("x", "y")))
    xr.testing.assert_identical(turned["pressure"], straight["pressure"])


@pytest.mark.parametrize("knob", ["seed", "realisation"])
def test_nothing_is_drawn_where_no_surface_is_random(tmp_path, knob):
    np.save(tmp_path / "p.npy", 1e-3 * np.cos(2 * np.pi * np.arange(32) / 32))
    rough = {"method": "measured", "file": str(tmp_path / "p.npy")}
    scene = {"body": {"poissons_ratio": 0.3}, "roughness": rough, "interface": {"hard_wall": {}}}
    file = {"scene": scene | {"loading": {"reduced_pressure": 0.1}}, "path": [{"reduced_pressure": 0.2}]}
    said = f"^{knob}: you gave 3; gfmd allows nothing, as no surface of this file is random"
    with pytest.raises(InputError, match=said):
        gfmd_numba.solve(file | {knob: 3})
    del file["path"]
    with pytest.raises(InputError, match=said):
        gfmd_numba.load_curve(file | {knob: 3}, [0.1, 0.2])
    with pytest.raises(InputError, match=said):
        gfmd_numba.make_surface({"surface": rough, knob: 3})
    again = json.loads(gfmd_numba.solve(file).attrs["scene"])  # in which both are 0
    assert int(gfmd_numba.solve(again)["status"]) == 0


def test_a_random_body_under_a_measured_punch_is_drawn(tmp_path):
    np.save(tmp_path / "p.npy", 1e-3 * np.cos(2 * np.pi * np.arange(32) / 32))
    random = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01, "points": 32, "cut_on": 0.1, "roll_off": 0.5}
    scene = {
        "body": {"poissons_ratio": 0.3, "roughness": random},
        "roughness": {"method": "measured", "file": str(tmp_path / "p.npy")},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.1},
    }
    heights = [gfmd_numba.solve({"scene": scene, **knob})["body_height"].values for knob in ({}, {"seed": 3})]
    assert (heights[0] != heights[1]).any()
