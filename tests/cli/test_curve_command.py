"""`gfmd curve`: what it writes, prints and draws, and how it ends."""

import csv
from itertools import islice

import numpy as np
import pytest
import xarray as xr

from gfmd_numba.cli import terminal
from gfmd_numba.simulate import curve
from gfmd_numba.storage.mark import marked_table
from support.command_line import gfmd, refused, unfolded
from support.scenes import SCENE

pytestmark = pytest.mark.usefixtures("undrawn")


@pytest.fixture
def scene(tmp_path):
    file = tmp_path / "scene.yaml"
    file.write_text(SCENE)
    return file


def table(file):
    """Columns by name, and their units."""
    with open(file, newline="") as opened:
        mark, headings, *rows = csv.reader(opened)
    assert mark[0].startswith("# written by gfmd-numba")
    names, units = zip(*(heading.removesuffix(")").split(" (") for heading in headings), strict=True)
    columns = zip(*rows, strict=True)
    return {name: [float(cell) for cell in column] for name, column in zip(names, columns, strict=True)}, dict(
        zip(names, units, strict=True)
    )


@pytest.mark.long
@pytest.mark.parametrize("realisations", [1, 3])
def test_table_and_netcdf_have_the_same_numbers_and_units(scene, tmp_path, realisations):
    done = gfmd("curve", scene, "--loads", "1e-2:1:3", "--realisations", realisations, "-o", tmp_path / "c.nc")
    assert done.exit_code == 0, done.output
    with xr.open_dataset(tmp_path / "c.nc") as opened:
        written = opened.load()
    columns, units = table(tmp_path / "c.csv")
    assert set(columns) == set(written.variables)
    for name, column in columns.items():
        np.testing.assert_array_equal(written[name].values, column, err_msg=name)
        assert units[name] == written[name].attrs.get("units", "1")
    np.testing.assert_allclose(columns["prescribed_load"], [0.01, 0.1, 1.0])
    assert (tmp_path / "c.png").is_file()
    printed = [line.split() for line in done.stdout.splitlines() if line.strip().startswith("0.1 ")]
    assert printed[0][1] == f"{columns['mean_pressure'][1] * 1e-6:.4g}"


def test_units_that_the_scene_leaves_open_stand_in_the_table(tmp_path):
    (tmp_path / "free.yaml").write_text(SCENE.replace("  length: 1e-4\n", "").replace("youngs_modulus: 70e9, ", ""))
    assert gfmd("curve", tmp_path / "free.yaml", "--loads=0.1,0.2", "-o", tmp_path / "c.nc").exit_code == 0
    _, units = table(tmp_path / "c.csv")
    names = ("mean_pressure", "mean_gap", "contact_stiffness", "elastic_energy", "contact_area_fraction")
    assert [units[name] for name in names] == ["E*", "L_x", "E*/L_x", "E* L_x", "1"]


@pytest.mark.parametrize(
    ("loads", "megapascals"),
    [
        ("1:4MPa:3", [1, 2, 4]),
        pytest.param("1, 4 MPa", [1, 4], marks=pytest.mark.long),
        ("4000 kPa:1N/mm^2:3", [4, 2, 1]),
    ],
)
def test_the_unit_of_the_last_load_is_that_of_numbers_before_it(tmp_path, loads, megapascals):
    scene, out = tmp_path / "s.yaml", tmp_path / "c.nc"
    coarse = SCENE.replace("eps_c: 1/4, eps_f: 1/16", "eps_c: 1/2, eps_f: 1/4")
    scene.write_text(coarse.replace("reduced_pressure: 0.05", "pressure: 1 MPa"))
    done = gfmd("curve", scene, "--loads", loads, "-o", out)
    assert done.exit_code == 0, done.output
    np.testing.assert_allclose(xr.load_dataset(out)["prescribed_load"], 1e6 * np.array(megapascals), rtol=1e-9)


@pytest.mark.parametrize(
    ("loads", "said"),
    [
        ("0.1:1", "you gave '0.1:1'; gfmd allows A:B:N with N from 2"),
        ("0.1-1", "you gave '0.1-1'; gfmd allows A:B:N with N from 2"),
        ("0.1:1:1", "you gave '0.1:1:1'; gfmd allows A:B:N with N from 2"),
        ("0.1:1:3.5", "gfmd allows A:B:N with N from 2"),
        ("0.1:1:99999999999", "gfmd allows A:B:N with N from 2"),
        ("0.1:1:²", "gfmd allows A:B:N with N from 2"),
        ("0.1:1:3:4", "gfmd allows A:B:N with N from 2"),
        ("1,5MPa", "you gave '1,5MPa'; gfmd allows 1.5MPa, or two values with a blank between them: '1, 5MPa'"),
        ("0:1:3", "gfmd allows two different ends above 0"),
        ("1:1:3", "gfmd allows two different ends above 0"),
        ("0.1,x", "loads[1]: you gave 'x'; gfmd allows a number"),
        ("1MPA", "you gave '1MPA'; gfmd allows numbers, or text with the unit of a load; did you mean 'MPa'?"),
        ("1 mpa:2 mpa:3", "did you mean 'MPa'?"),
        ("1 N/M", "did you mean 'N/m'?"),
        ("1.0D6 Pa", "exponents have an e: 1.0e6"),
        ("0.1,.inf", "loads[1]: you gave inf; gfmd allows a number"),
        ("0.1,", "loads[1]: you gave an empty value; gfmd allows a number"),
        ("true", "loads[0]: you gave true; gfmd allows a number"),
        ("0.1,-0.2", "loads[1]: you gave -0.2; gfmd allows a number from 1e-30 to 1e+30"),
        ("0.1,0.3,0.2", "loads[2]: you gave 0.2; gfmd allows loads that all rise, or all fall"),
    ],
)
def test_bad_loads_say_which_and_what_is_allowed(scene, tmp_path, loads, said):
    done = gfmd("curve", scene, "--loads", loads, "-o", tmp_path / "c.nc")
    assert done.exit_code == 2
    assert said in unfolded(done.stderr)
    assert not (tmp_path / "c.nc").exists()


def test_loads_that_fail_are_marked_and_exit_with_3(scene, tmp_path, monkeypatch):
    few = tmp_path / "few.yaml"
    few.write_text(SCENE + "numerics: {max_iterations: 1}\n")
    done = gfmd("curve", few, "--loads=0.05,0.1", "-o", tmp_path / "c.nc")
    assert done.exit_code == 3
    assert done.stdout.count("steps_used_up") == 2
    assert "not ok at load 0.05, 0.1: they are left out" in unfolded(done.stderr)
    assert "raise numerics.max_iterations" in unfolded(done.stderr)
    assert not (tmp_path / "c.png").exists()
    assert "nan" not in done.stdout


@pytest.mark.long
def test_an_interrupt_leaves_what_is_solved(scene, tmp_path, monkeypatch):
    solve = curve.solve_curve

    def interrupt_after(loads):
        def interrupted(*asked):
            yield from islice(solve(*asked), loads)
            raise KeyboardInterrupt

        monkeypatch.setattr(curve, "solve_curve", interrupted)

    for solved, realisations, loads, told in (
        (2, 1, 2, "interrupted after 2 of 3 loads"),
        (7, 4, 3, "interrupted after 2 of 4 realisations"),
        (1, 4, 1, "interrupted after 1 of 3 loads of the first of 4 realisations"),
    ):
        interrupt_after(solved)
        done = gfmd("curve", scene, "--loads=0.1,0.2,0.3", f"--realisations={realisations}", "-o", tmp_path / "c.nc")
        assert done.exit_code == 130
        assert told in unfolded(done.stderr)
        assert xr.load_dataset(tmp_path / "c.nc").sizes["prescribed_load"] == loads
    interrupt_after(0)
    done = gfmd("curve", scene, "--loads=0.1,0.2", "-o", tmp_path / "none.nc")
    assert done.exit_code == 130
    assert "nothing is written" in unfolded(done.stderr)
    assert not (tmp_path / "none.nc").exists()


@pytest.mark.long
def test_files_of_somebody_else_are_not_written_over(scene, tmp_path):
    for suffix in (".nc", ".csv", ".png"):
        file = tmp_path / f"mine{suffix}"
        file.write_text("precious")
        assert "gfmd did not write" in refused("curve", scene, "--loads=0.1", "-o", tmp_path / "mine.nc")
        assert file.read_text() == "precious"
        file.unlink()
    for _ in range(2):  # the second time over its own
        assert gfmd("curve", scene, "--loads=0.1", "-o", tmp_path / "mine.nc").exit_code == 0
    assert "the table takes the name with .csv" in refused("curve", scene, "--loads=0.1", "-o", tmp_path / "c.csv")
    profile = tmp_path / "p.csv"
    profile.write_bytes(marked_table(b"0\n1\n0\n2\n"))
    text = SCENE.replace("{method: psd, hurst: 0.8, rms_gradient: 0.01}", "{method: measured, file: p.csv}")
    scene.write_text(text.partition("discretisation")[0])
    assert "p.csv, which is an input" in refused("curve", scene, "--loads=0.1", "-o", tmp_path / "p.nc")


def test_a_curve_is_drawn_again_from_its_file(scene, tmp_path):
    assert gfmd("curve", scene, "--loads=0.1,0.2", "-o", tmp_path / "c.nc").exit_code == 0
    (tmp_path / "c.png").unlink()
    assert gfmd("plot", tmp_path / "c.nc").exit_code == 0
    assert (tmp_path / "c.png").is_file()


@pytest.mark.long
def test_a_long_curve_says_how_far_it_is(scene, tmp_path, monkeypatch):
    monkeypatch.setattr(terminal, "_PATIENCE", 0.0)
    done = gfmd("curve", scene, "--loads=0.1:1:4", "-o", tmp_path / "c.nc")
    for number, share in enumerate((25, 50, 75, 100), 1):
        assert f"busy     solving loads, {share}% done ({number} of 4)\n" in done.stderr


@pytest.mark.long
def test_times_of_a_creeping_body_are_written_printed_and_drawn(tmp_path):
    soft = SCENE.replace("youngs_modulus: 70e9, ", "youngs_modulus: 70e9, relaxation: [{modulus: 7e10, time: 2}], ")
    (tmp_path / "creep.yaml").write_text(soft)
    done = gfmd("curve", tmp_path / "creep.yaml", "--times", "1s:1min:2", "-o", tmp_path / "c.nc")
    assert done.exit_code == 0, done.output
    columns, units = table(tmp_path / "c.csv")
    np.testing.assert_allclose(columns["time"], [1.0, 60.0])
    assert units["time"] == "s"
    assert done.stdout.count("creep curve") == 1
    assert (tmp_path / "c.png").is_file()
    assert gfmd("plot", tmp_path / "c.nc", "-o", tmp_path / "again.png").exit_code == 0


@pytest.mark.long
def test_speeds_over_a_creeping_body_are_written_printed_and_drawn(tmp_path):
    soft = SCENE.replace("youngs_modulus: 70e9, ", "youngs_modulus: 70e9, relaxation: [{modulus: 7e10, time: 2}], ")
    (tmp_path / "tyre.yaml").write_text(soft)
    done = gfmd("curve", tmp_path / "tyre.yaml", "--speeds", "1um/s:1mm/s:2", "-o", tmp_path / "c.nc")
    assert done.exit_code == 0, done.output
    columns, units = table(tmp_path / "c.csv")
    np.testing.assert_allclose(columns["speed"], [1e-6, 1e-3])
    assert units["speed"] == "m s-1"
    assert min(columns["hysteretic_friction"]) > 0.0
    assert done.stdout.count("friction curve") == 1
    assert (tmp_path / "c.png").is_file()
    assert gfmd("plot", tmp_path / "c.nc", "-o", tmp_path / "again.png").exit_code == 0


@pytest.mark.parametrize(
    "options",
    [
        [],
        ["--loads", "1e-2,1e-1", "--times", "1,2"],
        ["--times", "1 m,2 m"],
        ["--speeds", "1 m,2 m"],
        ["--speeds", "1,2", "--times", "1,2"],
    ],
)
def test_a_curve_is_over_loads_times_or_speeds(scene, tmp_path, options):
    assert "gfmd allows" in unfolded(refused("curve", scene, *options, "-o", tmp_path / "c.nc"))


@pytest.mark.parametrize(
    ("loads", "told"), [("5:300:15", "5MPa, "), ("5,50", "5MPa, 50MPa, ..."), ("1e6:1e9:3", "MPa")]
)
def test_loads_without_a_unit_are_refused_where_the_loading_has_one(tmp_path, loads, told):
    file = tmp_path / "steel.yaml"
    file.write_text(
        "scene:\n  length: 1 mm\n  body: {youngs_modulus: 105 GPa, poissons_ratio: 0.3}\n"
        "  roughness: {method: psd, hurst: 0.8, rms_height: 1 um}\n"
        "  interface: {hard_wall: {}}\n  loading: {pressure: 10 MPa}\n"
        "discretisation: {eps_c: 1/8, eps_f: 1/8, eps_t: 1/2}\n"
    )
    said = refused("curve", file, "--loads", loads, "-o", tmp_path / "c.nc")
    assert "--loads without a unit" in said
    assert told in said
    assert not (tmp_path / "c.nc").exists()
    assert "loads" in refused("curve", file, "--loads", "null,5", "-o", tmp_path / "c.nc")
    other = file.read_text().replace("10 MPa}", "1e7, duration: 10 s}")
    file.write_text(other)
    assert "without a unit" not in refused("curve", file, "--loads", loads, "-o", tmp_path / "c.nc")
