"""Numbers with units: read to the very float of the number in SI units, or refused where they stand."""

import pickle
import re
from fractions import Fraction
from pathlib import Path

import pytest
from pydantic import TypeAdapter
from pydantic_core import PydanticCustomError

import gfmd_numba
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.scene import Body, Interface, Scene, load_scene
from gfmd_numba.scene.quantities import Length, Pressure, WorkOfAdhesion
from gfmd_numba.scene.records import SceneFile
from gfmd_numba.scene.surface_file import load_surface
from gfmd_numba.scene.units import (
    FORCE,
    FORCE_PER_LENGTH,
    LENGTH,
    PRESSURE,
    QUANTITIES,
    VISCOSITY,
    WEAR_RATE,
    WithUnit,
)
from gfmd_numba.text.input_error import InputError
from support.command_line import python
from support.faulty_files import CAMPAIGN, assert_complaint, changed, complaint, load_checked

SCENE = """\
scene:
  length: 0.2 mm
  body: {youngs_modulus: 70 GPa, poissons_ratio: 0.33, aspect_ratio: 1/2}
  roughness: {method: psd, hurst: 0.8, rms_height: 1.2 um, points: 64, cut_on: 10 um, roll_off: 20 µm}
  interface: {hard_wall: {}, exponential: {work_of_adhesion: 50 mJ/m^2, range: 5 um}}
  loading: {pressure: 50 MPa}
path: [{pressure: 60 MPa}]
"""
BARE = """\
scene:
  body: {poissons_ratio: 0.33, aspect_ratio: 1/2}
  roughness: {method: psd, hurst: 0.8, rms_height: 0.01, points: 64, cut_on: 0.1, roll_off: 0.2}
  interface: {hard_wall: {}, exponential: {work_of_adhesion: 0.001, range: 0.05}}
  loading: {displacement: 0.001}
path: [{displacement: 0.002}]
"""
FACTORS = {
    ("length", "mm"): "1/1000",
    ("length", "um"): "1/1000000",
    ("length", "µm"): "1/1000000",  # the micro sign
    ("length", "μm"): "1/1000000",  # the Greek letter
    ("length", "micron"): "1/1000000",
    ("length", "Å"): "1/10000000000",
    ("length", "inch"): "254/10000",
    ("pressure", "GPa"): "1000000000",
    ("pressure", "N/mm^2"): "1000000",
    ("pressure", "bar"): "100000",
    ("energy per area", "mJ/m^2"): "1/1000",
    ("energy per area", "mJ/m²"): "1/1000",
    ("energy per area", "J m-2"): "1",
    ("energy per area", "erg/cm2"): "1/1000",
    ("force per length", "N/mm"): "1000",
    ("force", "kN"): "1000",
    ("time", "min"): "60",
    ("time", "h"): "3600",
    ("memory", "GB"): "1000000000",
    ("dynamic viscosity", "cP"): "1/1000",
    ("thermal conductivity", "W/(m K)"): "1",
    ("thermal conductivity", "W/(cm*K)"): "100",
    ("electrical conductivity", "MS/m"): "1000000",
    ("memory", "MiB"): "1048576",
}


@pytest.mark.parametrize(("kind", "unit"), FACTORS)
@pytest.mark.parametrize("number", ["0.1", "70", "1e-3", "1/3", "+2.5E2", ".7"])
def test_a_number_with_a_unit_is_the_float_nearest_to_its_value(kind, unit, number):
    (quantity,) = (each for each in QUANTITIES if each.name == kind)
    for text in (f"{number} {unit}", f" {number}{unit} "):
        assert quantity.si_value(text) == float(Fraction(number) * Fraction(FACTORS[kind, unit])), text


@pytest.mark.parametrize("unit", ["mm^3/Nm", "mm³/Nm", "mm3/N m", "mm^3/(N m)", "mm^3/(N*m)", "mm3/(N·m)", "mm^3/N/m"])
def test_a_wear_rate_is_read_as_it_is_mostly_written(unit):
    assert WEAR_RATE.si_value(f"2 {unit}") == 2e-9


def test_the_documentation_lists_these_quantities_and_units():
    text = (Path(__file__).parents[2] / "docs/campaigns.md").read_text()
    for quantity in QUANTITIES:
        others = ", ".join(quantity.units[1:]).replace("um", "um (or µm)")
        assert f"| {quantity.name} | {quantity.si} | {others} |\n" in text


def test_every_unit_that_messages_name_is_one_of_its_quantity():
    for quantity in QUANTITIES:
        assert quantity.si_value(f"1 {quantity.si}") == 1.0
        assert all(quantity.si_value(f"2 {unit}") > 0.0 for unit in quantity.units)


def test_units_stand_wherever_a_field_has_a_dimension(tmp_path):
    (tmp_path / "scene.yaml").write_text(SCENE)
    file, _ = load_scene(tmp_path / "scene.yaml")
    scene, law = file.scene, file.scene.interface.exponential
    found = (scene.length, scene.body.youngs_modulus, law.work_of_adhesion, law.range, scene.loading.pressure)
    assert found == (2e-4, 7e10, 0.05, 5e-6, 5e7)
    rough = scene.roughness
    assert (rough.rms_height, rough.cut_on, rough.roll_off, file.path[0].pressure) == (1.2e-6, 1e-5, 2e-5, 6e7)
    assert load_surface({"surface": rough.model_dump(), "length": "200 um"})[0].length == 2e-4


def test_units_stand_in_campaigns_and_their_lists(tmp_path):
    text = changed(CAMPAIGN, "poissons_ratio: 0.33,", "youngs_modulus: 2 GPa, poissons_ratio: 0.33,")
    text = changed(text, "reduced_pressure: 0.007", "pressure: 1 MPa")
    (tmp_path / "c.yaml").write_text(
        changed(text, "grid: {hurst: [0.3, 0.5]}", "grid: {pressure: [1 MPa, 10 MPa]}\ncase_timeout: 10 min")
    )
    campaign, _ = load_campaign(tmp_path / "c.yaml")
    assert campaign.grid.pressure == (1e6, 1e7)
    assert campaign.case_timeout == 600.0
    assert load_campaign(campaign)[0] == campaign


def test_a_time_with_a_unit_has_the_bounds_of_one_in_seconds(tmp_path):
    said = complaint(tmp_path, load_campaign, CAMPAIGN + "case_timeout: 31 day\n")
    assert "case_timeout: you gave '31 day'; gfmd allows a number above 0 and at most 2592000.0, or a time in s" in said


def test_units_stand_in_the_boundary_of_a_body():
    file, _ = load_scene(
        {
            "scene": {
                "length": "1 mm",
                "body": {"youngs_modulus": "2 GPa", "poissons_ratio": 0.3, "aspect_ratio": 1.0},
                "boundary": {"normal_displacement": "-2 nm", "tangential_traction": "3 MPa"},
            },
            "points": 8,
        }
    )
    assert (file.scene.boundary.normal_displacement, file.scene.boundary.tangential_traction) == (-2e-9, 3e6)


def test_records_take_the_same_text():
    body = Body(youngs_modulus="70 GPa", poissons_ratio=0.3)
    assert body.youngs_modulus == 7e10
    assert pickle.loads(pickle.dumps(body)) == body
    law = Interface.model_validate({"hard_wall": {}, "exponential": {"work_of_adhesion": 1.0, "range": "2 nm"}})
    parts = {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1}, "loading": {"reduced_pressure": 0.1}}
    with pytest.raises(ValueError, match="a number without a unit, as there is no length"):
        Scene.model_validate({"body": body, "interface": law, **parts})
    assert Scene.model_validate({"body": body, "interface": law, **parts, "length": "1 um"}).length == 1e-6


def test_a_number_with_a_unit_is_a_float_in_all_else():
    number = TypeAdapter(Length).validate_python("2 mm")
    assert isinstance(number, WithUnit)
    assert (number, hash(number), repr(number), type(number * 1.0)) == (2e-3, hash(2e-3), "0.002", float)
    again = pickle.loads(pickle.dumps(number))
    assert (again, again.quantity) == (number, number.quantity)
    assert not isinstance(TypeAdapter(Length).validate_python(2e-3), WithUnit)


LENGTHS = "gfmd allows a length in m, mm, um, nm or the like"
RANGE = f"gfmd allows a number from 1e-30 to 1e+30, or {LENGTHS.removeprefix('gfmd allows ')}"
FAULTS = {
    "another dimension": ("0.2 mm", "5 kg", f"you gave '5 kg'; {LENGTHS}"),
    "a pressure": ("0.2 mm", "5 Pa", f"you gave '5 Pa'; {LENGTHS}"),
    "an area": ("0.2 mm", "5 mm^2", f"you gave '5 mm^2'; {LENGTHS}"),
    "an unknown unit": ("0.2 mm", "5 mmm", f"you gave '5 mmm'; {LENGTHS}; did you mean 'mm'?"),
    "an unknown word": ("0.2 mm", "5 milimeter", f"you gave '5 milimeter'; {LENGTHS}; did you mean 'millimeter'?"),
    "upper case": ("0.2 mm", "5 UM", f"you gave '5 UM'; {LENGTHS}; did you mean 'um'?"),
    "a scale with an offset": ("0.2 mm", "5 degC", f"you gave '5 degC'; {LENGTHS}"),
    "decibels": ("0.2 mm", "5 dBm", f"you gave '5 dBm'; {LENGTHS}"),
    "a huge power": ("0.2 mm", "5 m^99999999", f"you gave '5 m^99999999'; {LENGTHS}"),
    "a product without end": ("0.2 mm", "5 " + "m*" * 40 + "m", "you gave '5 m*m*m*m*m*m*m*m"),
    "no unit": ("0.2 mm", "5 %", f"you gave '5 %'; {LENGTHS}"),
    "a dunder": ("0.2 mm", "5 __import__('os')", 'you gave "5 __import__'),
    "two numbers": ("0.2 mm", "1 2 mm", f"you gave '1 2 mm'; {RANGE}"),
    "nan": ("0.2 mm", "nan mm", f"you gave 'nan mm'; {RANGE}"),
    "infinite": ("0.2 mm", ".inf mm", f"you gave '.inf mm'; {RANGE}"),
    "beyond a float": ("0.2 mm", "1e400 mm", f"you gave '1e400 mm'; {RANGE}"),
    "beyond a decimal": ("0.2 mm", "1e99999999999999999999 mm", f"you gave '1e99999999999999999999 mm'; {RANGE}"),
    "beneath a decimal": ("0.2 mm", "1e-99999999999999999999 mm", f"you gave '1e-99999999999999999999 mm'; {RANGE}"),
    "divided by 0": ("0.2 mm", "1/0 mm", f"you gave '1/0 mm'; {RANGE}"),
    "too small": ("0.2 mm", "1e-31 m", f"you gave '1e-31 m'; {RANGE}"),
    "below 0": ("0.2 mm", "-1 mm", f"you gave '-1 mm'; {RANGE}"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_unit_that_makes_no_sense_is_refused_where_it_stands(name, tmp_path):
    old, new, expected = FAULTS[name]
    assert_complaint(tmp_path, load_checked, SCENE, (old, new), f"bad.yaml:2:11: scene.length: {expected}")


@pytest.mark.parametrize(
    ("quantity", "text", "said"),
    [
        (PRESSURE, "250 HV", "HV, HB and HK are in kgf/mm^2: write that unit"),
        (PRESSURE, "250 HB", "HV, HB and HK are in kgf/mm^2"),
        (PRESSURE, "610 HV0.1", "HV, HB and HK are in kgf/mm^2"),
        (PRESSURE, "180 HBW 2.5/187.5", "HV, HB and HK are in kgf/mm^2"),
        (PRESSURE, "60 HRC", "a Rockwell hardness is no pressure: look up the HV that it is worth"),
        (PRESSURE, "30 Msi", "1 Msi is 1000 ksi"),
        (PRESSURE, "50 tsi", "a ton is 2240 lbf, or in America 2000 lbf: write psi"),
        (PRESSURE, "5.1 kp/mm²", "did you mean 'kgf/mm²'?"),
        (PRESSURE, "50 lb/in^2", "did you mean 'lbf/in^2'?"),
        (PRESSURE, "50 lbs/in2", "did you mean 'lbf/in2'?"),
        (PRESSURE, "50 kg/cm2", "did you mean 'kgf/cm2'?"),
        (PRESSURE, "5 t/cm^2", "did you mean 'tf/cm^2'?"),
        (PRESSURE, "50 MPa abs", "did you mean 'MPa'?"),
        (PRESSURE, "5 kg", ""),
        (PRESSURE, "3 mm", ""),
        (FORCE, "5 kg", "did you mean 'kgf'?"),
        (FORCE_PER_LENGTH, "5 kp/mm", "did you mean 'kgf/mm'?"),
        (VISCOSITY, "46 cSt", "a kinematic viscosity: write it times the density, as 46 cSt of oil are about 40 mPa s"),
        (VISCOSITY, "46 mm^2/s", "a kinematic viscosity"),
        (VISCOSITY, "46 mPas", "did you mean 'mPa s'?"),
        (LENGTH, "5 micro", "did you mean 'micron'?"),
    ],
)
def test_what_is_suggested_is_a_unit_of_the_same_quantity(quantity, text, said):
    with pytest.raises(PydanticCustomError) as caught:
        quantity.si_value(text)
    found = caught.value.context["suggestion"]
    assert (said in found) if said else not found
    if unit := re.search("did you mean '(.*)'", found):
        assert quantity.si_value(f"1 {unit[1]}") > 0.0


DIMENSIONLESS = [
    ("poissons_ratio: 0.33", "poissons_ratio: 0.33 MPa", "scene.body.poissons_ratio: you gave '0.33 MPa'"),
    ("hurst: 0.8", "hurst: 0.8 mm", "scene.roughness.hurst: you gave '0.8 mm'; gfmd allows a number from 0 to 1"),
    ("points: 64", "points: 64 m", "scene.roughness.points: you gave '64 m'; gfmd allows a whole number"),
]


@pytest.mark.parametrize(("old", "new", "expected"), DIMENSIONLESS)
def test_a_unit_of_what_has_none_is_refused(old, new, expected, tmp_path):
    said = complaint(tmp_path, load_checked, changed(SCENE, old, new))
    assert expected in said
    assert said.endswith("; this number has no unit")


NO_SCALE = [
    ("rms_height: 0.01", "rms_height: 1 um", "3:52: scene.roughness.rms_height", "length"),
    ("cut_on: 0.1", "cut_on: 1 um", "3:78: scene.roughness.cut_on", "length"),
    ("range: 0.05", "range: 1 um", "4:76: scene.interface.exponential.range", "length"),
    (
        "0.001, range",
        "5 J/m^2, range",
        "4:62: scene.interface.exponential.work_of_adhesion",
        "length and youngs_modulus",
    ),
    ("displacement: 0.001", "displacement: 1 nm", "5:27: scene.loading.displacement", "length"),
    ("displacement: 0.002", "displacement: 1 nm", "6:23: path[0].displacement", "length"),
]


@pytest.mark.parametrize(("old", "new", "place", "missing"), NO_SCALE)
def test_a_unit_without_a_scale_to_compare_it_with_is_refused(old, new, place, missing, tmp_path):
    allowed = (
        f"a number without a unit, as there is no {missing.replace('and', 'and no')}; to use units, give {missing}"
    )
    given = repr(new.split(": ")[-1].removesuffix(", range"))
    assert_complaint(
        tmp_path, load_checked, BARE, (old, new), f"bad.yaml:{place}: you gave {given}; gfmd allows {allowed}"
    )


def test_a_unit_in_the_grid_of_a_scene_without_a_length_is_refused(tmp_path):
    text = changed(CAMPAIGN, "{reduced_pressure: 0.007}", "{displacement: 0.001}")
    text = changed(text, "grid: {hurst: [0.3, 0.5]}", "grid: {displacement: [0.001, 2 nm]}")
    said = complaint(tmp_path, load_campaign, text)
    assert said.startswith("bad.yaml:11:30: grid.displacement[1]: you gave '2 nm'; gfmd allows a number without a unit")


def test_equal_numbers_with_and_without_units_are_not_confused():
    """Equal records are kept and used again: one of them may have had units."""
    scene = {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.1},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1.0, "range": 0.1}},
        "loading": {"reduced_pressure": 0.1},
    }
    file = {"name": "n", "seed": 1, "realisations": 1, "reference": {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 1}}
    in_metres = scene | {"length": 1.0, "body": {"poissons_ratio": 0.3, "youngs_modulus": 1.0}}
    load_campaign(file | {"scene": in_metres, "grid": {"interaction_range": ["500 mm"]}})
    load_campaign(file | {"scene": scene, "grid": {"interaction_range": [0.5]}})


def test_the_schema_says_of_each_field_which_quantity_it_is():
    defined = SceneFile.model_json_schema()["$defs"]
    asked = {("Body", "youngs_modulus"): "Pa", ("Scene", "length"): "m", ("Exponential", "work_of_adhesion"): "J/m^2"}
    for (record, name), unit in asked.items():
        field = defined[record]["properties"][name]
        choices = field.get("anyOf", [field])
        assert [each["unit"] for each in choices if "unit" in each] == [unit]
    adapted = TypeAdapter(Pressure).json_schema()
    assert (adapted["type"], adapted["quantity"], adapted["minimum"]) == (["number", "string"], "pressure", 1e-30)
    assert TypeAdapter(WorkOfAdhesion).json_schema()["quantity"] == "energy per area"


@pytest.mark.long
@pytest.mark.parametrize(("text", "loaded"), [(SCENE, True), (BARE, False)], ids=["with units", "without"])
def test_only_a_file_with_units_loads_the_library_of_units(text, loaded, tmp_path):
    (tmp_path / "scene.yaml").write_text(text)
    script = (
        "import sys; from gfmd_numba.cli import main\ntry: main(sys.argv[1:])\nfinally: print('pint' in sys.modules)"
    )
    assert python(script, "check", tmp_path / "scene.yaml").endswith(f"{loaded}\n")


def test_an_error_of_python_names_the_field():
    with pytest.raises(InputError, match=r"scene.length: you gave '5 kg'; gfmd allows a length in m"):
        gfmd_numba.solve({"scene": {"length": "5 kg"}})
