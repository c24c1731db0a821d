"""`gfmd statistics`, `leakage` and `conductance`: what they write, print and draw of a solved contact."""

import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import gfmd_numba
from support.command_line import gfmd, unfolded
from support.scenes import SCENE

pytestmark = pytest.mark.usefixtures("undrawn")

MAP = SCENE.replace("scene:\n", "scene:\n  dimension: 2\n").replace(", aspect_ratio: 1/2", "")
MAP = MAP.replace("eps_c: 1/4, eps_f: 1/16", "eps_c: 1/2, eps_f: 1/8")
TRANSPORT = {"leakage": gfmd_numba.leakage, "conductance": gfmd_numba.contact_conductance}


@pytest.fixture(scope="module")
def folder(undrawn, tmp_path_factory):
    folder = tmp_path_factory.mktemp("contacts")
    for name, text in {
        "map": MAP,
        "path": MAP + "path: [{reduced_pressure: 0.5}]\n",
        "profile": SCENE,
        "failed": SCENE + "numerics: {max_iterations: 1}\n",
    }.items():
        (folder / f"{name}.yaml").write_text(text)
        gfmd("solve", folder / f"{name}.yaml", "-o", folder / f"{name}.nc")
    return folder


def test_distributions_are_written_and_drawn_without_what_was_not_asked_for(folder, tmp_path):
    done = gfmd("statistics", folder / "map.nc", "-o", tmp_path / "statistics.nc")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "statistics.png").is_file()
    written = xr.load_dataset(tmp_path / "statistics.nc")
    xr.testing.assert_allclose(written, gfmd_numba.contact_statistics(folder / "map.nc"))
    assert "gap_connects" not in written
    printed = [line.split("  ")[0] for line in done.stdout.splitlines()[2:]]
    assert printed == ["contact area fraction", "Persson's estimate of it", "mean gap over rms height", "perimeter"]


@pytest.mark.long
def test_percolation_is_added_and_printed_where_asked_for(folder, tmp_path):
    done = gfmd("statistics", folder / "map.nc", "-o", tmp_path / "statistics.nc", "--percolation")
    assert done.exit_code == 0, done.output
    written = xr.load_dataset(tmp_path / "statistics.nc")
    expected = gfmd_numba.gap_percolation(folder / "map.nc")
    for name in expected.data_vars:
        xr.testing.assert_allclose(written[name].drop_attrs(), expected[name].drop_attrs())
        assert written[name].attrs == expected[name].attrs
    assert "channel along x" in done.output


@pytest.mark.filterwarnings("ignore:The flow factor")
def test_flow_and_resistance_are_printed_in_units_of_engineers(folder):
    done = gfmd("leakage", folder / "map.nc", "--viscosity", "1 cP", "--pressure", "2 bar", "--seal", "1mm", "0.3 m")
    found = gfmd_numba.leakage(folder / "map.nc", 1e-3, 2e5, ("1 mm", 0.3))["flow"]
    for along, flow in zip("xy", found.values.tolist(), strict=True):
        assert f"flow along {along}                {flow:.3g} m^3/s = {3.6e6 * flow:.3g} L/h\n" in done.stdout
    done = gfmd("conductance", folder / "map.nc", *["--conductivity", "16 W/m/K"] * 2)
    found = float(gfmd_numba.contact_conductance(folder / "map.nc", "16 W/m/K")["resistance"])
    assert f"resistance                  {found:.5g} K/W\n" in done.stdout
    done = gfmd("leakage", folder / "map.nc", "--viscosity", "1 cP")
    assert done.exit_code == 2
    assert "--pressure: you gave nothing" in unfolded(done.output)


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:The flow factor")
@pytest.mark.parametrize("command", TRANSPORT)
def test_what_crosses_a_contact_is_written_drawn_and_printed(folder, tmp_path, command):
    done = gfmd(command, folder / "map.nc", "-o", tmp_path / "out.nc")
    assert done.exit_code == 0, done.output
    assert (tmp_path / "out.png").is_file()
    assert {"leakage": "hydraulic gap along y", "conductance": "conductance   "}[command] in done.stdout
    expected = TRANSPORT[command](folder / "map.nc")
    xr.testing.assert_allclose(xr.load_dataset(tmp_path / "out.nc"), expected)
    assert " ".join(expected.validity.split()) in unfolded(done.stderr)
    (tmp_path / "out.png").unlink()
    assert gfmd("plot", tmp_path / "out.nc").exit_code == 0
    assert (tmp_path / "out.png").is_file()


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:The flow factor", "ignore:No channel is open")
@pytest.mark.parametrize("command", TRANSPORT)
def test_without_an_output_nothing_is_written_and_programs_read_json(folder, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    done = gfmd(command, folder / "path.nc", "--json")
    assert done.exit_code == 0, done.output
    assert not list(tmp_path.iterdir())
    read = json.loads(done.stdout, parse_constant=pytest.fail)
    expected = TRANSPORT[command](folder / "path.nc")
    for name, told in read["data_vars"].items():
        np.testing.assert_array_equal(np.array(told["data"], dtype=float), expected[name])
        assert told["attrs"]["units"] == expected[name].units
    assert read["dims"]["step"] == 2
    done = gfmd(command, folder / "path.nc", "--json", "-o", tmp_path / "out.nc")
    assert json.loads(done.stdout) == read
    assert (tmp_path / "out.png").exists()


@pytest.mark.long
def test_what_is_not_finite_is_null_in_json(folder, tmp_path):
    closed = xr.load_dataset(folder / "map.nc")
    closed["gap"] *= 0.0
    closed.to_netcdf(tmp_path / "closed.nc", engine="netcdf4")
    done = gfmd("conductance", tmp_path / "closed.nc", "--json")
    assert json.loads(done.stdout, parse_constant=pytest.fail)["data_vars"]["conductance"]["data"] is None
    assert "conductance                 inf" in gfmd("conductance", tmp_path / "closed.nc").stdout


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:The flow factor")
@pytest.mark.parametrize("command", ["statistics", *TRANSPORT])
def test_the_steps_of_a_path_are_a_table(folder, tmp_path, command):
    done = gfmd(command, folder / "path.nc", "-o", tmp_path / "out.nc")
    assert done.exit_code == 0, done.output
    assert max(map(len, done.output.partition("steps of the path")[2].splitlines())) <= 80
    rows = [line.split()[0] for line in done.stdout.splitlines() if line.split() and line.split()[0] in "01"]
    assert rows == ["0", "1"] * (len(rows) // 2)


def test_a_profile_has_distributions_but_no_channels(folder, tmp_path):
    done = gfmd("statistics", folder / "profile.nc", "-o", tmp_path / "statistics.nc")
    assert done.exit_code == 0, done.output
    assert "segments" in xr.load_dataset(tmp_path / "statistics.nc")
    done = gfmd("statistics", "--percolation", folder / "profile.nc", "-o", tmp_path / "out.nc")
    assert done.exit_code == 2
    said = unfolded(done.stderr)
    assert f"{folder / 'profile.nc'}: you gave the contact of a profile" in said
    assert "solve a scene with `dimension: 2`" in said


@pytest.mark.parametrize(("command", "what"), [("conductance", "ridges"), ("leakage", "grooves")])
def test_a_profile_conducts_and_leaks_with_a_word_on_its_ridges(folder, tmp_path, command, what):
    done = gfmd(command, folder / "profile.nc", "-o", tmp_path / "out.nc")
    assert done.exit_code == 0
    assert (tmp_path / "out.png").is_file()
    assert f"{what}" in unfolded(done.stderr)
    assert "without end along y" in unfolded(done.stderr)


@pytest.mark.parametrize("command", ["statistics", *TRANSPORT])
def test_a_failed_run_has_no_statistics(folder, tmp_path, command):
    done = gfmd(command, folder / "failed.nc", "-o", tmp_path / "statistics.nc")
    assert done.exit_code == 2
    assert f"{folder / 'failed.nc'}: you gave a run that is not ok" in unfolded(done.stderr)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", ["statistics", *TRANSPORT])
def test_the_results_themselves_are_not_overwritten(folder, command):
    done = gfmd(command, folder / "map.nc", "-o", folder / "map.nc")
    assert done.exit_code == 2
    assert "which is an input" in unfolded(done.stderr)


@pytest.mark.long
def test_a_unit_that_somebody_wrote_is_escaped(folder, tmp_path):
    altered = xr.load_dataset(folder / "map.nc")
    altered["gap"].attrs["units"] = "\x1b[2J"
    altered.to_netcdf(tmp_path / "altered.nc", engine="netcdf4")
    for command in (("statistics", "--percolation"), ("leakage",), ("conductance",)):
        done = gfmd(*command, tmp_path / "altered.nc", "-o", tmp_path / "statistics.nc")
        assert done.exit_code == 0, done.output
        assert "\x1b" not in done.output
        assert r"\x1b[2J" in done.output or command[0] == "conductance"


@pytest.mark.filterwarnings("ignore:The flow factor", "ignore:No channel is open")
def test_a_path_has_its_loads_in_the_printed_and_in_the_written_table(folder, tmp_path):
    done = gfmd("conductance", folder / "path.nc", "-o", tmp_path / "out.nc")
    assert done.exit_code == 0, done.output
    found = gfmd_numba.contact_conductance(folder / "path.nc")
    loads = xr.load_dataset(folder / "path.nc")["reduced_pressure"].values
    rows = [line.split() for line in done.stdout.splitlines() if line.split()[:1] in (["0"], ["1"])]
    assert [float(row[1]) for row in rows] == pytest.approx(loads)
    assert "p*" in done.stdout
    table = pd.read_csv(tmp_path / "out.csv", comment="#")
    np.testing.assert_allclose(table["reduced_pressure (1)"], loads, rtol=1e-14)
    np.testing.assert_allclose(table[f"conductance ({found['conductance'].units})"], found["conductance"], rtol=1e-14)


def test_a_curve_is_told_how_its_loads_become_contacts(folder, tmp_path):
    gfmd("curve", folder / "profile.yaml", "--loads", "0.01,0.1", "-o", tmp_path / "curve.nc")
    for command in ("conductance", "leakage", "statistics", "fields"):
        done = gfmd(command, tmp_path / "curve.nc", "-o", tmp_path / "out.nc")
        assert done.exit_code == 2
        assert "a curve, which has no fields" in unfolded(done.stderr)
        assert "for several loads, give its scene a path: [{pressure: 2 MPa}" in unfolded(done.stderr)


@pytest.mark.parametrize(
    "arguments",
    [
        ("leakage", "--viscosity", "46", "--pressure", "2 bar"),
        ("leakage", "--viscosity", "1 mPa s", "--pressure", "2"),
        ("leakage", "--viscosity", "1 mPa s", "--pressure", "2 bar", "--seal", "1", "300mm"),
    ],
)
def test_plain_numbers_of_a_fluid_are_refused(folder, arguments):
    said = gfmd(arguments[0], folder / "map.nc", *arguments[1:])
    assert said.exit_code == 2
    assert "a value with its unit" in unfolded(said.output)
