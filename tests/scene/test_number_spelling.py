"""Numbers written as elsewhere are refused with the reason, in scenes, lists of loads and files of surfaces."""

import numpy as np
import pytest

from gfmd_numba.roughness.measurements import measurement
from gfmd_numba.roughness.surface_files import read_content
from gfmd_numba.roughness.surface_text import read_table
from gfmd_numba.scene import load_scene
from gfmd_numba.scene.units import LENGTH, METRES, length_unit, respelt
from support.faulty_files import SCENE, changed, complaint

SPELLINGS = {
    "1.0D-6": "exponents have an e: 1.0e-6",
    "1.0D-6 m": "exponents have an e: 1.0e-6",
    "-2d+3": "exponents have an e: -2e+3",
    "1,000 um": "thousands have no separator: 1000, or 1.000 with a decimal point",
    "1,234,567.5": "thousands have no separator: 1234567.5",
    "1 000 um": "thousands have no separator: 1000",
    "1'000": "thousands have no separator: 1000",
    "1_000_000": "thousands have no separator: 1000000",
    "0,2 mm": "decimals have a point: 0.2",
    "12,5e-3": "decimals have a point: 12.5",
}


@pytest.mark.parametrize("text", SPELLINGS)
def test_a_number_written_as_elsewhere_is_told_how_to_be_written(tmp_path, text):
    assert respelt(text) == SPELLINGS[text]
    for field, good in (("rms_gradient", "rms_gradient: 0.01"), ("rms_height", "rms_gradient: 0.01")):
        said = complaint(tmp_path, load_scene, changed(SCENE, good, f"{field}: {text}"))
        assert f"scene.roughness.{field}: you gave " in said
        assert said.endswith(f"; {SPELLINGS[text]}"), said


@pytest.mark.parametrize("text", ["1.5e-6", "1/64", "20 um", "5 mm 2", "2 N m-1", "x", "", "1 D", "3 days"])
def test_other_texts_are_no_such_numbers(text):
    assert respelt(text) == ""


@pytest.mark.parametrize(
    ("unit", "name"),
    [
        ("meters", "m"),
        ("metres", "m"),
        ("Micrometers", "um"),
        ("micrometres", "um"),
        ("nanometre", "nm"),
        ("MILLIMETERS", "mm"),
        ("\u00b5m", "um"),
        ("\u03bcm", "um"),
        ("inches", "in"),
        ("angstroms", "angstrom"),
        ("MM", None),
        ("Mm", None),
        ("\u00b5", None),
    ],
)
def test_units_of_files_by_their_full_names(tmp_path, unit, name):
    assert length_unit(unit) == name
    if name is not None:
        (tmp_path / "p.csv").write_text(f"x [{unit}], z [{unit}]\n1,2\n2,3\n", encoding="utf-8")
        assert read_table(tmp_path / "p.csv").units == (name, name)


def test_exponents_of_fortran_are_read(tmp_path):
    (tmp_path / "p.txt").write_text("1.0D-6 2.5d+00\n2.D-6 -.5D1\n3.0D-06 1d0\n")
    np.testing.assert_array_equal(read_table(tmp_path / "p.txt").values, [[1e-6, 2.5], [2e-6, -5], [3e-6, 1]])
    (tmp_path / "p.csv").write_text("1,5D-6;2,5D0\n2,5D-6;Bad\n")
    np.testing.assert_array_equal(read_table(tmp_path / "p.csv").values, [[1.5e-6, 2.5], [2.5e-6, np.nan]])


@pytest.mark.parametrize(
    "text",
    [
        "1,234.5\n987.1\n2,001.0\n3,456.7\n",
        "z [nm]\n1,234.5\n2,987.1\n3,001.0\n4,456.7\n",
        "1,234.5\n1,987.1\n1,001.0\n",
        "0.1\t1,234.5\n0.2\t987.1\n",
        "0.1 1,234.5\n0.2 987.1\n",
        "0.1;1,234,567\n0.2;987\n",
        '1,"1,234.5"\n2,"987.1"\n',
    ],
)
def test_commas_between_thousands_are_refused_as_such(tmp_path, text):
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(ValueError, match=r"numbers like 1,234\S+ with commas between thousands: write 1234"):
        measurement(read_content(tmp_path / "p.csv"))


@pytest.mark.parametrize(
    ("text", "shape"),
    [
        ("1,234.5\n2,345.6\n3,456.7\n", (3, 2)),
        ("x,z\n3,234.5\n1,345.6\n2,456.7\n", (3, 2)),
        ("123,456,789,111\n123,456,789,112\n", (2, 4)),
        ("12,345\t0,5\n12,346\t0,6\n", (2, 2)),
        ("z\n12,345\n13,346\n", (2, 1)),
    ],
)
def test_commas_between_columns_or_decimals_are_none(tmp_path, text, shape):
    (tmp_path / "p.csv").write_text(text)
    assert read_table(tmp_path / "p.csv").values.shape == shape


@pytest.mark.parametrize("unit", ["mil", "mils", "uin", "Å", "in"])
def test_a_scene_knows_the_units_of_length_that_files_know(unit):
    assert LENGTH.si_value(f"3 {unit}") == pytest.approx(3.0 * METRES[length_unit(unit)], rel=1e-15)
