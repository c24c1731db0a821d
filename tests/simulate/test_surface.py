"""Surface files from YAML to dataset and picture, and what is said about those that make no sense."""

import numpy as np
import pytest
import xarray as xr
import yaml
from scipy.stats import norm

from gfmd_numba import InputError, make_surface
from gfmd_numba.roughness import model_surfaces, statistics
from gfmd_numba.roughness.spectra import KCorrelationSpectrum
from gfmd_numba.scene.surface_file import load_surface
from gfmd_numba.simulate.surface import surface_dataset
from support.command_line import gfmd
from support.faulty_files import complaint
from support.scenes import SURFACE

SELF_AFFINE = {"model": "self_affine", "hurst": 0.8, "roll_off": 20e-6, "cut_on": 1e-6}
K_CORRELATION = {"model": "k_correlation", "hurst": 0.7, "correlation_length": 4e-6}
EXPONENTIAL = {"model": "exponential", "hurst": 0.7, "correlation_length": 4e-6, "mound_separation": 10e-6}
ANISOTROPIC = {"model": "length_anisotropy", "hurst": 0.7, "correlation_length_x": 4e-6, "correlation_length_y": 1e-6}
SCALING = {
    "model": "scaling_anisotropy",
    "hurst_x": 0.9,
    "hurst_y": 0.4,
    "correlation_length_x": 4e-6,
    "correlation_length_y": 1e-6,
}
RECURSIVE = {"hurst": 0.8, "roll_off": 20e-6, "cut_on": 1e-6}
SURFACES = [
    *(({"method": "psd", **s}, d) for s in (SELF_AFFINE, K_CORRELATION) for d in (1, 2)),
    ({"method": "psd", **EXPONENTIAL}, 1),
    pytest.param({"method": "psd", **EXPONENTIAL}, 2, marks=pytest.mark.long),  # its spectrum takes seconds
    ({"method": "psd", **SELF_AFFINE, "plateau": False}, 1),
    *(({"method": "fourier_filter", **s}, d) for s in (K_CORRELATION, EXPONENTIAL) for d in (1, 2)),
    *(({"method": method, **s}, 2) for method in ("psd", "fourier_filter") for s in (ANISOTROPIC, SCALING)),
    *(
        ({"method": method, **RECURSIVE}, d)
        for method in ("midpoint_displacement", "successive_addition")
        for d in (1, 2)
    ),
]


@pytest.mark.parametrize(("surface", "dimension"), SURFACES, ids=str)
def test_every_method_and_model_makes_a_surface_of_the_scale_asked_for(surface, dimension):
    file = {"surface": surface | {"rms_height": 3e-7, "points": 256}, "length": 1e-4, "dimension": dimension}
    dataset = make_surface(file)
    assert dataset["height"].shape == (256,) * dimension
    assert dataset["height"].attrs["units"] == "m"
    assert float(dataset["rms_height"]) == pytest.approx(3e-7, rel=1e-9)
    assert dataset["x"].values[1] == pytest.approx(1e-4 / 256)
    assert {"y"} & set(dataset.coords) == ({"y"} if dimension == 2 else set())
    theory = dataset["spectral_density_theory"].values
    seen = theory > 1e-10 * theory.max()
    assert seen.sum() > 8
    ratio = np.log(dataset["spectral_density"].values[seen] / theory[seen]) * np.sqrt(dataset["waves"].values[seen])
    if "model" in surface and "anisotropy" not in surface["model"]:  # the scatter of rings is known
        assert abs(ratio).max() < 6.0
    assert np.isfinite([float(v) for v in dataset.data_vars.values() if not v.dims]).all()


def test_the_surface_is_the_generators_scaled_to_its_gradient():
    surface = {"method": "psd", **K_CORRELATION, "rms_gradient": 0.1, "points": 128}
    dataset = make_surface({"surface": surface, "length": 1e-4, "seed": 7, "realisation": 3})
    power = model_surfaces.psd_power(KCorrelationSpectrum(1, 0.7, 4e-6), 128, 63, 1e-4)
    heights = model_surfaces.surfaces(power, 128, 63, 7, range(3, 4))
    np.testing.assert_allclose(dataset["height"], statistics.scaled(heights, (1e-4,), None, 0.1)[0], rtol=1e-12)
    assert float(dataset["rms_gradient"]) == pytest.approx(0.1)


def test_lengths_are_in_periods_without_a_length():
    spectrum = {"model": "self_affine", "hurst": 0.5, "roll_off": 0.2, "cut_on": 0.01}
    file = {"surface": {"method": "psd", **spectrum, "rms_height": 0.01, "points": 512}}
    dataset = make_surface(file | {"hurst_range": {"shortest": 0.01, "longest": 0.2}})
    assert dataset["height"].attrs["units"] == "1"
    scaled = {**spectrum, "roll_off": 0.2e-3, "cut_on": 0.01e-3}
    in_metres = make_surface(
        {"surface": {"method": "psd", **scaled, "rms_height": 0.01e-3, "points": 512}, "length": 1e-3}
        | {"hurst_range": {"shortest": 0.01e-3, "longest": 0.2e-3}}
    )
    np.testing.assert_allclose(in_metres["height"], 1e-3 * dataset["height"], rtol=1e-9)
    for name in ("rms_gradient", "nayak", "hurst_exponent", "gaussian_distance"):
        assert float(in_metres[name]) == pytest.approx(float(dataset[name]), rel=1e-9)
    assert float(dataset["hurst_exponent"]) == pytest.approx(0.5, abs=4 * float(dataset["hurst_exponent_error"]))


@pytest.mark.long
@pytest.mark.parametrize("dimension", [1, 2])
def test_command_writes_surface_and_picture(tmp_path, dimension):
    file = {"surface": {"method": "psd", **K_CORRELATION, "rms_height": 3e-7, "points": 64}, "length": 1e-4}
    (tmp_path / "s.yaml").write_text(yaml.safe_dump(file | {"dimension": dimension}))
    assert gfmd("check", tmp_path / "s.yaml").output == f"{tmp_path / 's.yaml'}: a surface\n"
    done = gfmd("surface", tmp_path / "s.yaml", "-o", tmp_path / "s.nc")
    assert done.exit_code == 0
    assert "rms_height              300 nm\n" in done.output
    assert (tmp_path / "s.png").stat().st_size > 20_000
    assert "give one like steel.nc" in gfmd("surface", tmp_path / "s.yaml", "-o", tmp_path / "t.png").stderr
    with xr.open_dataset(tmp_path / "s.nc") as dataset:
        assert dataset["height"].dims == (("x",) if dimension == 1 else ("y", "x"))
        assert float(dataset["autocorrelation"][0]) == pytest.approx(1.0)


def test_a_written_surface_is_read_as_a_measured_one(tmp_path):
    file = {"surface": {"method": "psd", **K_CORRELATION, "rms_height": 3e-7, "points": 64}, "length": 1e-4}
    dataset = make_surface(file | {"dimension": 2})
    dataset.to_netcdf(tmp_path / "s.nc", engine="netcdf4")
    again = make_surface({"surface": {"method": "measured", "file": str(tmp_path / "s.nc"), "detrend": "none"}})
    np.testing.assert_allclose(again["height"], dataset["height"], rtol=1e-12)
    np.testing.assert_allclose(again["x"], dataset["x"])
    assert float(again["rms_gradient"]) == pytest.approx(float(dataset["rms_gradient"]))
    assert "spectral_density_theory" not in again


def test_the_heights_of_a_wave_are_distributed_as_its_sine():
    wave = 1e-3 * np.sin(2 * np.pi * np.arange(20_000) / 20_000)
    record = {"method": "measured", "heights": wave, "units": {"z": "L_x"}, "detrend": "none"}
    found = surface_dataset(*load_surface({"surface": record}))
    h = np.linspace(-np.sqrt(2), np.sqrt(2), 10_001)
    exact = abs(0.5 + np.arcsin(h / np.sqrt(2)) / np.pi - norm.cdf(h)).max()
    assert float(found["gaussian_distance"]) == pytest.approx(exact, abs=1e-4)
    assert float(found["kurtosis"]) == pytest.approx(1.5)
    assert float(found["skewness"]) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.usefixtures("undrawn")
def test_measured_profile_is_processed_and_says_how(tmp_path):
    x = np.arange(50) * 2e-6
    np.savetxt(
        tmp_path / "p.csv",
        np.column_stack([x, 1e-7 * np.sin(x / 7e-6) + 0.01 * x]),
        delimiter=",",
        header="x [m], z [m]",
    )
    (tmp_path / "s.yaml").write_text(
        "surface: {method: measured, file: p.csv, detrend: tilt, periodic: mirror, points: 400}\n"
    )
    done = gfmd("surface", tmp_path / "s.yaml", "-o", tmp_path / "s.nc")
    assert done.exit_code == 0
    assert "done     subtracted the tilt" in done.output
    assert "done     mirrored at its ends" in done.output
    assert "done     resampled from 100 to 400 points" in done.output
    with xr.open_dataset(tmp_path / "s.nc") as dataset:
        assert dataset.sizes["x"] == 400
        assert float(dataset["x"][1]) == pytest.approx(200e-6 / 400)


RANDOM = """\
surface: {method: midpoint_displacement, hurst: 0.8, roll_off: 2e-5, cut_on: 1e-6, rms_gradient: 0.1, points: 512}
length: 1e-4
"""


@pytest.mark.parametrize(
    ("text", "old", "new", "said"),
    [
        (
            SURFACE,
            "correlation_length: 4e-6",
            "correlation_length: 4e-5",
            "correlation_length: you gave 4e-05; gfmd allows at most mound_separation = 9e-06",
        ),
        (
            SURFACE,
            "hurst: 0.8",
            "hurst: 1.2",
            "surface.hurst: you gave 1.2; gfmd allows a number from 0.01 to 1",
        ),
        (SURFACE, "hurst: 0.8", "hurst: 0", "4:10: surface.hurst: you gave 0; gfmd allows"),
        (
            SURFACE,
            "cut_on: 1e-6",
            "cut_on: 1e-7",
            "cut_on: you gave 1e-07; gfmd allows at least 3.92157e-07, the shortest wave",
        ),
        (SURFACE, "  rms_height: 3e-7\n", "", "2:3: surface: you gave {'correlation_length': 4e-06"),
        (SURFACE, "points: 512", "points: 3", "9:11: surface.points: you gave 3; gfmd allows a whole number from 4"),
        (
            SURFACE,
            "  points: 512\n",
            "",
            "surface.points: you gave nothing; gfmd needs the number of grid points over L_x",
        ),
        (SURFACE, "points: 512", "points: 100000000000", "a grid that fits in"),
        (SURFACE, "points: 512", "points: 512\nhurst_range: {shortest: 2, longest: 1}", "10:25: hurst_range.shortest"),
        (SURFACE, "model: exponential", "model: exponentail", "did you mean 'exponential'?"),
        (SURFACE, "method: psd", "method: psdm", "did you mean 'psd'?"),
        (RANDOM, "hurst: 0.8", "hurst: -0.1", "1:49: surface.hurst: you gave -0.1; gfmd allows a number from 0 to 1"),
        (
            RANDOM,
            "cut_on: 1e-6",
            "cut_on: 1.5e-5",
            "surface.cut_on: you gave 1.5e-05; gfmd allows at most half of roll_off",
        ),
        (
            RANDOM,
            "roll_off: 2e-5",
            "roll_off: 2e-4",
            "surface.roll_off: you gave 0.0002; gfmd allows at most the period",
        ),
        (RANDOM, "cut_on: 1e-6", "cut_on: 1e-7", "surface.cut_on: you gave 1e-07; gfmd allows at least 3.92157e-07"),
    ],
)
def test_a_surface_that_makes_no_sense_is_refused_where_it_stands(tmp_path, text, old, new, said):
    assert text.count(old) == 1
    assert said in complaint(tmp_path, load_surface, text.replace(old, new))


def test_a_range_of_the_hurst_exponent_without_waves_is_refused(tmp_path):
    text = SURFACE + "hurst_range: {shortest: 2.1e-6, longest: 2.11e-6}\n"
    assert "bad.yaml:11:14: hurst_range: you gave {" in complaint(tmp_path, make_surface, text)


def test_models_that_need_a_map_are_refused_on_a_profile(tmp_path):
    surface = {"method": "psd", **ANISOTROPIC, "rms_height": 3e-7, "points": 64}
    file = {"surface": surface, "length": 1e-4}
    message = complaint(tmp_path, load_surface, yaml.safe_dump(file))
    assert "dimension: you gave nothing; gfmd needs 2, which model length_anisotropy needs" in message


def test_a_period_too_short_for_the_filter_is_refused(tmp_path):
    text = (
        SURFACE.replace("psd", "fourier_filter")
        .replace("\nlength: 1e-4", "\nlength: 5e-6")
        .replace("  cut_on: 1e-6\n", "")
    )
    assert "not a spectrum that is negative" in complaint(tmp_path, make_surface, text)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("gaps.csv", "# [m]\n0,1\n1,nan\n2,1\n3,nan\n4,2\n", "height nan at index 1 and 1 more, not a finite number"),
        ("uneven.csv", "0,1\n1,2\n2,1\n3.5,0\n4.5,1\n", "a spacing of 1.5 in x at index 2, where 1.125 is the mean"),
        ("falling.csv", "4,1\n3,2\n2,1.0\n3,0\n", "positions x that are in no order from index 2 on"),
        ("few.csv", "# [m]\n0,1\n1,2\n2,1\n", "3 heights, not at least 4"),
        ("three.csv", "0,1,2\n1,2,2\n2,1,2\n3,1,2\n", "2 x 4 heights, not at least 4"),
        ("flat.csv", "1\n1\n1\n1\n", "flat surface"),
        ("tiny.csv", "# [m]\n0,1e-200\n1,0\n2,3e-200\n3,0\n", "heights that differ by 3e-200 at most"),
        ("short.csv", "# [m]\n0,1\n1e-300,0\n2e-300,3\n3e-300,0\n", "a physical size of"),
        ("words.csv", "one\ntwo\n", "no row of numbers, but 'one'"),
        ("broken.npy", "no array", "no .npy array"),
        ("broken.nc", "no dataset", "no netCDF file"),
    ],
)  # fmt: skip
def test_an_unusable_measurement_is_refused_with_its_reason(tmp_path, name, content, said):
    (tmp_path / name).write_text(content)
    text = f"surface: {{method: measured, file: {name}}}\n"
    message = complaint(tmp_path, make_surface, text)
    assert message.startswith(f"bad.yaml:1:35: surface.file: you gave {name} (")
    assert said in message


def test_a_map_with_uneven_rows_is_refused(tmp_path):
    y = np.array([0.0, 1.0, 2.0, 3.5, 4.0])
    heights = xr.DataArray(np.random.default_rng(0).normal(size=(5, 6)), {"y": y, "x": np.arange(6.0)}, ("y", "x"))
    heights.to_dataset(name="height").to_netcdf(tmp_path / "map.nc", engine="netcdf4")
    message = complaint(tmp_path, make_surface, "surface: {method: measured, file: map.nc}\n")
    assert "a spacing of 1.5 in y at index 2" in message


def test_a_file_that_is_not_there_and_a_length_too_many_are_told(tmp_path):
    (tmp_path / "steel.csv").write_text("# [m]\n0,1\n1,2\n2,1\n3,1\n")
    message = complaint(tmp_path, make_surface, "surface: {method: measured, file: stel.csv}\n")
    assert "did you mean 'steel.csv'?" in message
    message = complaint(tmp_path, make_surface, "surface: {method: measured, file: steel.csv}\nlength: 1e-3\n")
    assert "positions over a period of 4 m, one spacing for each of the 4 points, not length = 0.001 m" in message
    message = complaint(tmp_path, make_surface, "surface: {method: measured, file: steel.csv}\ndimension: 1\n")
    assert "dimension: you gave 1; gfmd allows nothing" in message


def test_a_scene_in_place_of_a_surface_is_told_what_to_write():
    with pytest.raises(InputError, match=r"^scene: you gave a scene; gfmd allows a file of a surface: write the"):
        make_surface({"scene": {"roughness": {"method": "psd"}}})
