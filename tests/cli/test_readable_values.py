"""Values are printed with the units that people use for them, and are still the values."""

import re

import pytest
import xarray as xr

from gfmd_numba.analysis.plots import style
from gfmd_numba.cli import tables
from gfmd_numba.scene.units import ENERGY_PER_AREA, FORCE_PER_LENGTH, LENGTH, PRESSURE
from gfmd_numba.text.numbers import si_prefix, typical, with_prefix
from support.campaigns import SMALL
from support.command_line import gfmd
from support.faulty_files import changed
from support.scenes import SCENE, SURFACE

pytestmark = pytest.mark.usefixtures("undrawn")


@pytest.mark.parametrize(
    ("value", "unit", "expected"),
    [
        (5e7, "Pa", ("50", "MPa")),
        (-2e-4, "m", ("-200", "µm")),
        (0.05, "J m-2", ("50", "mJ/m²")),
        (999.9999999, "Pa", ("1", "kPa")),
        (1e3, "N", ("1", "kN")),
        (2.5e4, "N/m", ("25", "kN/m")),
        (2.5e-3, "J/m^2", ("2.5", "mJ/m²")),
        (1.0, "m", ("1", "m")),
        (0.0, "m", ("0", "m")),
        (1e-25, "m", ("1e-25", "m")),
        (5e7, "1", ("5e+07", "1")),
        (5e7, "m-1", ("5e+07", "m-1")),
        (float("inf"), "Pa", ("inf", "Pa")),
    ],
)
def test_a_value_has_the_prefix_that_makes_it_short(value, unit, expected):
    assert with_prefix(value, unit, 6) == " ".join(expected)


@pytest.mark.parametrize(
    ("values", "unit"),
    [
        ([1e6, 1e9], "MPa"),  # halfway, as both are short then
        ([1e5, 4e6], "MPa"),
        ([0.0, 3e6], "MPa"),
        ([1e-6, 2e8], "MPa"),  # what is nearly nothing does not make the others long
        ([1.0, 1e9], "MPa"),
        ([1e-6, 5e6], "MPa"),
        ([float("nan")], "Pa"),
    ],
)
def test_numbers_of_a_column_share_the_unit_of_the_large_ones(values, unit):
    assert si_prefix(typical(values), "Pa")[1] == unit


@pytest.mark.parametrize("value", [1.23456e-11, 3.3e-7, 0.25, 77.7, 123456.0, 8.5e10])
def test_what_is_printed_reads_as_the_same_value(value):
    for quantity in (LENGTH, PRESSURE, ENERGY_PER_AREA, FORCE_PER_LENGTH):
        assert quantity.si_value(with_prefix(value, quantity.si, 6)) == pytest.approx(value, rel=1e-5)


@pytest.mark.parametrize("unit", ["m", "Pa", "N", "N m-1", "J m-2"])
@pytest.mark.parametrize("value", [2.5e-13, 2.5e-10, 2.5e-7, 2.5e-4, 2.5, 2.5e4, 2.5e7])
def test_sentences_tables_and_figures_write_one_unit(value, unit):
    line = xr.Dataset({"force": ((), value, {"units": unit})})
    sentence = with_prefix(value, unit).split()[1]
    assert tables.line(line, "force").text[14:] == sentence == style.prefix(line["force"], "")[1]


def test_check_tells_what_a_scene_is_in_si(tmp_path):
    text = changed(SCENE, "length: 1e-4", "length: 0.1 mm")
    (tmp_path / "s.yaml").write_text(changed(text, "reduced_pressure: 0.05", "pressure: 50 MPa"))
    said = gfmd("check", tmp_path / "s.yaml").output
    assert said == f"{tmp_path / 's.yaml'}: a scene, length 100 µm, youngs_modulus 70 GPa, pressure 50 MPa\n"


def test_check_and_plan_tell_no_load_that_the_grid_replaces(tmp_path):
    text = changed(SMALL, "reduced_pressure: 0.05", "pressure: 1 Pa")
    for grid, told in (("{hurst: [0.3, 0.8]}", ", pressure 1 Pa"), ("{pressure: [50 MPa, 60 MPa]}", "")):
        (tmp_path / "c.yaml").write_text(changed(text, "{hurst: [0.3, 0.8]}", grid))
        assert gfmd("check", tmp_path / "c.yaml").output.endswith(f"realisations, youngs_modulus 70 GPa{told}\n")
        planned = gfmd("plan", tmp_path / "c.yaml", "--pilot", "0").output
        assert f"scene         youngs_modulus 70 GPa{told}\n" in planned


def test_solve_and_surface_print_prefixes(tmp_path):
    (tmp_path / "s.yaml").write_text(changed(SCENE, "reduced_pressure: 0.05", "pressure: 50 MPa"))
    (tmp_path / "r.yaml").write_text(changed(SURFACE, "rms_height: 3e-7", "rms_height: 300 nm"))
    said = gfmd("solve", tmp_path / "s.yaml", "-o", tmp_path / "s.nc").output
    assert re.search(r"^mean pressure +50 +MPa$", said, re.M)
    said = gfmd("surface", tmp_path / "r.yaml", "-o", tmp_path / "r.nc").output
    assert re.search(r"^rms_height +[23]\d\d\.?\d* nm$", said, re.M)
