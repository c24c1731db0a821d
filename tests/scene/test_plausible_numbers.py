"""Numbers that are implausible for what they are get a sentence with the likely unit; others none."""

from inspect import isclass
from typing import get_args

import numpy as np
import pytest
from pydantic import BaseModel

import gfmd_numba
from gfmd_numba.scene import Boundary, SceneFile, load_scene
from gfmd_numba.scene.plausible_numbers import COMMON, LOADS, implausible
from gfmd_numba.scene.surface_file import SurfaceFile, load_surface
from gfmd_numba.scene.units import quantities
from support.command_line import gfmd, unfolded

ROUGH = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02}
COARSE = {"eps_c": 0.5, "eps_f": 0.25, "eps_t": 0.5}
STEEL = {"youngs_modulus": "210 GPa", "poissons_ratio": 0.3}
SCENE = {
    "length": "100 um",
    "body": STEEL,
    "roughness": ROUGH,
    "interface": {"hard_wall": {}},
    "loading": {"pressure": "10 MPa"},
}


def file(path=(), **changes):
    scene = {key: value for key, value in (SCENE | changes).items() if value is not None}
    return {"scene": scene, "discretisation": COARSE, "path": list(path)}


def said(path=(), **changes):
    described, _ = load_scene(file(path, **changes))
    return implausible(described.scene, described.path)


def steel(modulus):
    return {"body": STEEL | {"youngs_modulus": modulus}}


def law(**values):
    return {"interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 0.05, "range": 1e-6} | values}}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        (steel(210), "body.youngs_modulus is 210 Pa, softer than rubber (210 GPa or 210 MPa?)"),
        (steel(210e12), "body.youngs_modulus is 2.1e+14 Pa, stiffer than diamond"),
        ({"interface": {"hard_wall": {"hardness": 2}}}, "hardness is 2 Pa, softer than wax (2 GPa or 2 MPa?)"),
        (law(work_of_adhesion=50), "work_of_adhesion is 50 J/m^2, stronger than a glue (50 mJ/m^2?)"),
        (law(range=2), "range is 2 m, longer than forces between surfaces reach (2 nm or 2 um?)"),
        ({"length": 200}, "length is 200 m, longer than 10 cm (200 um or 200 nm?)"),
        ({"loading": {"displacement": 0.2}}, "loading.displacement is 0.2 m, more than 1 cm (0.2 um or 0.2 nm?)"),
        ({"roughness": ROUGH | {"rms_gradient": None, "rms_height": 0.3}}, "roughness.rms_height is 0.3 m, more than"),
        ({"loading": {"pressure": 10}}, "loading.pressure is 10 Pa, which makes 4.3e-11 E* (E* = 230.8 GPa) (10 MPa"),
        ({"loading": {"line_load": 2}}, "loading.line_load is 2 N/m, which makes 8.7e-08 E* (E* = 230.8 GPa) (2 N/mm"),
        ({"loading": {"pressure": "300 GPa"}}, "loading.pressure is 300 GPa, which makes 1.3 E* (E* = 230.8 GPa)"),
        ({"loading": {"line_load": "50 MN/m"}}, "loading.line_load is 50 MN/m, which makes 2.17 E*"),
        (
            {"loading": {"displacement": "2 mm"}},
            "loading.displacement is 2 mm, 20 periods L_x: check the units of both",
        ),
        (law(range="2 mm"), "interface.exponential.range is 2 mm, 20 periods L_x"),
        ({"boundary": {"normal_traction": "-1 TPa"}}, "boundary.normal_traction is -1000 GPa, which makes 4.33 E*"),
    ],
)
def test_what_is_implausible_gets_one_sentence_with_the_likely_unit(changes, sentence):
    sentences = said(**changes)
    assert len(sentences) == 1
    assert sentence in sentences[0]


def test_a_step_of_a_path_and_a_layer_are_named_by_their_places():
    layers = [{"height": 3, "youngs_modulus": 2, "poissons_ratio": 0.4}]
    body = {"layers": layers, "base": {"youngs_modulus": "2 GPa", "poissons_ratio": 0.3}}
    (sentence,) = said(path=[{"sliding": 3}], body=body | {"layers": [layers[0] | {"youngs_modulus": 200.0}]})
    for place in ("body.layers[0].height is 3 m", "body.layers[0].youngs_modulus is 200 Pa", "path[0].sliding is 3 m"):
        assert place in sentence


def test_the_rounding_of_a_path_is_no_length():
    circle = [{"sliding": 1e-6 * np.sin(angle)} for angle in np.pi * np.arange(5) / 2]
    assert said(path=circle) == []
    assert len(said(path=[*circle, {"sliding": 1.0}])) == 1


@pytest.mark.parametrize(
    "changes",
    [
        {},
        steel(210e9),
        steel("3 kPa") | {"loading": {"pressure": "10 Pa"}},  # a gel
        steel("210 Pa") | {"loading": {"pressure": "1 Pa"}},
        law(work_of_adhesion="50 mJ/m^2", range="2 nm"),
        {"loading": {"pressure": "10 Pa"}},
        {"length": "2 m", "loading": {"pressure": 1e6}},
        {"loading": {"displacement": 0}},
        steel("80 GPa") | {"loading": {"pressure": "1 Pa"}},
    ],
)
def test_common_numbers_and_those_with_their_units_get_none(changes):
    assert said(**changes) == []


@pytest.mark.parametrize("length", [None, 1.0])
@pytest.mark.parametrize("modulus", [None, 1.0, 210.0, 0.2])
def test_numbers_in_units_of_their_own_get_none(length, modulus):
    loading = {"displacement": 0.2} if modulus is None else {"pressure": 0.01 * modulus}
    interface = {"hard_wall": {"hardness": 0.3 * (modulus or 1.0)}, "exponential": {"work_of_adhesion": 1, "range": 1}}
    body = {"poissons_ratio": 0.3} | ({} if modulus is None else {"youngs_modulus": modulus})
    assert said(body=body, length=length, loading=loading, interface=interface) == []
    if modulus is not None:
        (sentence,) = said(body=body, length=length, loading={"pressure": 1e6 * modulus})
        assert "check the units of both" in sentence


def test_mixed_units_of_their_own_get_one_sentence_that_says_how_to_do_without():
    (sentence,) = said(length=2, body=STEEL | {"youngs_modulus": 5}, loading={"pressure": 0.1})
    assert "body.youngs_modulus is 5 Pa" in sentence
    assert "length is 2 m" in sentence
    assert sentence.endswith("to calculate in units of L_x and E*, leave out length and youngs_modulus")


def records(annotation):
    if isclass(annotation) and issubclass(annotation, BaseModel):
        yield annotation
        for field in annotation.model_fields.values():
            yield from records(field.annotation)
    for inner in get_args(annotation):
        yield from records(inner)


def test_every_quantity_of_a_file_is_compared_with_something():
    files = (SceneFile, SurfaceFile)
    named = {name for kind in files for record in records(kind) for name in quantities(record)}
    of_measured = {"shortest", "longest"}  # of a file, whose sizes are looked at as they are read
    of_boundaries = quantities(Boundary).keys()  # with E* and the period
    assert named - COMMON.keys() - LOADS.keys() - of_boundaries <= of_measured


@pytest.mark.usefixtures("undrawn")
@pytest.mark.filterwarnings("ignore")
def test_check_solve_curve_plan_and_surface_say_it(tmp_path):
    text = """
scene:
  length: 100 um
  body: {youngs_modulus: 210, poissons_ratio: 0.3}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.02}
  interface: {hard_wall: {}}
  loading: {pressure: 1 Pa}
"""
    (tmp_path / "scene.yaml").write_text(text + "discretisation: {eps_c: 1/2, eps_f: 1/4, eps_t: 1/2}\n")
    reference = "name: q\nseed: 1\nrealisations: 1\nreference: {eps_c: 1/2, eps_f: 1/4, eps_t: 1/2}\n"
    (tmp_path / "campaign.yaml").write_text(f"{reference}{text}grid: {{hurst: [0.3, 0.8]}}\n")
    (tmp_path / "surface.yaml").write_text(
        "length: 200\nsurface: {method: psd, hurst: 0.8, rms_height: 1 um, points: 64, cut_on: 10, roll_off: 100}\n"
    )
    for command in (
        ("check", "scene.yaml"),
        ("solve", "scene.yaml", "-o", tmp_path / "contact.nc"),
        ("curve", "scene.yaml", "--loads", "1Pa,2Pa", "-o", tmp_path / "curve.nc"),
        ("check", "campaign.yaml"),
        ("plan", "campaign.yaml", "--pilot=0"),
    ):
        done = gfmd(command[0], tmp_path / command[1], *command[2:])
        assert done.exit_code == 0, done.output
        assert "body.youngs_modulus is 210 Pa, softer than rubber (210 GPa or" in unfolded(done.stderr), command
    for command in (("check",), ("surface", "-o", tmp_path / "surface.nc")):
        done = gfmd(command[0], tmp_path / "surface.yaml", *command[1:])
        assert "length is 200 m, longer than 10 cm (200 um or 200 nm?)" in unfolded(done.stderr), command


def test_a_value_of_a_grid_is_named_as_such(tmp_path):
    text = """
name: q
seed: 1
realisations: 1
scene:
  length: 100 um
  body: {youngs_modulus: 210 GPa, poissons_ratio: 0.3}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.02}
  interface: {hard_wall: {}}
  loading: {pressure: 1}
reference: {eps_c: 1/2, eps_f: 1/4, eps_t: 1/2}
grid: {pressure: GIVEN}
"""
    for given, expected in (("[10, 20]", True), ("[1 MPa, 10]", True), ("[10 MPa, 20 MPa]", False)):
        (tmp_path / "q.yaml").write_text(text.replace("GIVEN", given))
        assert ("grid.pressure is 10 Pa" in unfolded(gfmd("check", tmp_path / "q.yaml").stderr)) == expected


def test_a_loaded_body_says_it():
    loaded = {"scene": {"body": STEEL, "boundary": {"normal_displacement": "2 mm"}, "length": "1 mm"}, "points": 8}
    with pytest.warns(UserWarning, match="boundary.normal_displacement is 2 mm, 2 periods L_x"):
        gfmd_numba.solve(loaded)


def test_a_surface_in_its_own_units_says_nothing():
    surface = {"surface": ROUGH | {"points": 64, "cut_on": 0.1, "roll_off": 0.5}}
    assert implausible(load_surface(surface)[0]) == []


@pytest.mark.parametrize(
    ("changes", "place", "meant"),
    [
        ({"interface": {"hard_wall": {"hardness": 1.5}}}, "scene.interface.hard_wall.hardness", "1.5 GPa"),
        ({"plasticity": {"yield_stress": 250.0}}, "scene.body.plasticity.yield_stress", "250 MPa"),
    ],
)
def test_a_load_is_not_blamed_for_a_strength_without_its_unit(changes, place, meant):
    body = {"youngs_modulus": "80 GPa", "poissons_ratio": 0.3}
    body |= {"plasticity": changes["plasticity"]} if "plasticity" in changes else {}
    heights = (1e-8 * np.cos(2.0 * np.pi * np.arange(64) / 64)).tolist()
    scene = {"length": 1e-5, "body": body, "roughness": {"method": "measured", "heights": heights, "units": {"z": "m"}}}
    scene |= {"interface": changes.get("interface", {"hard_wall": {}}), "loading": {"pressure": "1 MPa"}}
    with pytest.raises(gfmd_numba.InputError, match=rf"{place}: you gave [\d.]+; .*{meant}.*\?"):
        gfmd_numba.solve({"scene": scene})


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"loading": {"pressure": "20 mPa"}}, "loading.pressure is 20 mPa, which makes"),
        (steel("80e9 GPa"), "body.youngs_modulus is 8e+10 GPa, stiffer than diamond. Check the unit"),
        (steel("80 mPa"), "body.youngs_modulus is 80 mPa, softer than rubber (80 GPa or 80 MPa?). Check the unit"),
    ],
)
def test_a_unit_does_not_excuse_every_number(changes, told):
    (sentence,) = said(**changes)
    assert told in sentence
