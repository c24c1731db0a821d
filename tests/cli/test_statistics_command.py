"""`gfmd statistics`: what it writes, prints and draws of a solved contact, and only what was asked for."""

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from support.command_line import gfmd, unfolded
from support.scenes import SCENE

MAP = SCENE.replace("scene:\n", "scene:\n  dimension: 2\n").replace(", aspect_ratio: 1/2", "")
ASKED = ("--percolation", "--leakage", "--conductance")
BEYOND = {"gap_connects", "hydraulic_gap", "conductance"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("contacts")
    for name, text in {
        "map": MAP,
        "path": MAP + "path: [{reduced_pressure: 0.5}]\n",
        "profile": SCENE,
        "failed": MAP + "numerics: {max_iterations: 1}\n",
    }.items():
        (folder / f"{name}.yaml").write_text(text)
        gfmd("solve", folder / f"{name}.yaml", "-o", folder / f"{name}.nc")
    return folder


def test_distributions_are_written_and_drawn_without_what_was_not_asked_for(folder, tmp_path):
    done = gfmd("statistics", folder / "map.nc", "-o", tmp_path / "statistics.nc")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "statistics.png").stat().st_size > 10_000
    written = xr.load_dataset(tmp_path / "statistics.nc")
    xr.testing.assert_allclose(written, gfmd_numba.contact_statistics(folder / "map.nc"))
    assert not BEYOND & set(written.variables)
    printed = [line.split("  ")[0] for line in done.stdout.splitlines()[2:]]
    assert printed == ["Persson's contact area", "mean gap over rms height", "perimeter"]


@pytest.mark.parametrize("asked", range(3))
def test_what_is_asked_for_is_added_and_printed(folder, tmp_path, asked):
    done = gfmd("statistics", folder / "map.nc", "-o", tmp_path / "statistics.nc", ASKED[asked])
    assert done.exit_code == 0, done.output
    written = xr.load_dataset(tmp_path / "statistics.nc")
    functions = (gfmd_numba.gap_percolation, gfmd_numba.leakage, gfmd_numba.contact_conductance)
    expected = functions[asked](folder / "map.nc")
    for name in expected.data_vars:
        xr.testing.assert_allclose(written[name].drop_attrs(), expected[name].drop_attrs())
        assert written[name].attrs == expected[name].attrs
    words = ("channel along x", "hydraulic gap along y", "conductance")[asked]
    assert words in done.output
    assert len(BEYOND & set(written.variables)) == 1


def test_the_steps_of_a_path_are_a_table(folder, tmp_path):
    done = gfmd("statistics", folder / "path.nc", "-o", tmp_path / "statistics.nc", *ASKED)
    assert done.exit_code == 0, done.output
    assert max(map(len, done.output.partition("steps of the path")[2].splitlines())) <= 80
    rows = [line.split()[0] for line in done.output.splitlines() if line.split() and line.split()[0] in "01"]
    assert rows == ["0", "1"] * (len(rows) // 2)
    assert "hydraulic" in done.output


def test_a_profile_has_distributions_and_a_conductance_but_no_channels(folder, tmp_path):
    done = gfmd("statistics", folder / "profile.nc", "-o", tmp_path / "statistics.nc", "--conductance")
    assert done.exit_code == 0, done.output
    assert "segments" in xr.load_dataset(tmp_path / "statistics.nc")
    for option in ASKED[:2]:
        done = gfmd("statistics", folder / "profile.nc", "-o", tmp_path / "statistics.nc", option)
        assert done.exit_code == 2
        said = unfolded(done.stderr)
        assert f"{folder / 'profile.nc'}: given no results of a map's contact; allowed: what `gfmd solve`" in said


def test_a_failed_run_has_no_statistics(folder, tmp_path):
    done = gfmd("statistics", folder / "failed.nc", "-o", tmp_path / "statistics.nc")
    assert done.exit_code == 2
    assert "given a run that is not ok" in unfolded(done.stderr)
    assert not list(tmp_path.iterdir())


def test_the_results_themselves_are_not_overwritten(folder):
    done = gfmd("statistics", folder / "map.nc", "-o", folder / "map.nc")
    assert done.exit_code == 2
    assert "which is an input" in unfolded(done.stderr)


def test_a_unit_that_somebody_wrote_is_escaped(folder, tmp_path):
    altered = xr.load_dataset(folder / "map.nc")
    altered["gap"].attrs["units"] = "\x1b[2J"
    altered["x"].attrs["units"] = np.array([1, 2])
    altered.to_netcdf(tmp_path / "altered.nc", engine="netcdf4")
    done = gfmd("statistics", tmp_path / "altered.nc", "-o", tmp_path / "statistics.nc", *ASKED)
    assert done.exit_code == 0, done.output
    assert "\x1b" not in done.output
    assert r"\x1b[2J" in done.output
