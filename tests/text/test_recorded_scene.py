"""What a recorded scene says in the title of a picture."""

import json

import pytest

from gfmd_numba.scene import Scene
from gfmd_numba.text.recorded_scene import (
    asked,
    described,
    fields_in_period,
    hardness,
    is_elastic_contact,
    is_form_alone,
    is_measured_profile,
)

SCENE = '{"scene": {"body": {"youngs_modulus": 7e10}, "roughness": {"method": "psd", "hurst": 0.8}, "length": 1e-3}}'


def test_a_scene_is_described_in_units():
    assert described(SCENE) == "rough profile, Hurst exponent 0.8, 1 mm long, on a half-space of Young's modulus 70 GPa"


@pytest.mark.parametrize(
    "altered", ["", "garbage", "[]", "null", '{"scene": 3}', '{"scene": {"body": 3}}', SCENE.replace("7e10", '"soft"')]
)
def test_an_altered_record_says_nothing(altered):
    assert described(altered) == ""
    assert hardness(altered) is None
    assert not is_elastic_contact(altered)
    assert not is_form_alone(altered)
    assert not is_measured_profile(altered)
    assert fields_in_period(altered) == 1


@pytest.mark.parametrize("wall", [3, "hard", [], {"hardness": "soft"}, {"hardness": [1]}])
def test_an_altered_wall_has_no_hardness(wall):
    assert hardness(json.dumps({"scene": {"interface": {"hard_wall": wall}}})) is None
    assert hardness('{"scene": {"interface": {"hard_wall": {"hardness": 2e9}}}}') == 2e9


def test_what_was_asked_is_text_whatever_stands_there():
    assert asked({"yaml": 3, "title": "contact"}) == {"yaml": "3"}


def test_the_length_of_a_mirrored_surface_is_that_of_the_period():
    scene = {"body": {"youngs_modulus": 1e9, "poissons_ratio": 0.3}, "length": 442.9e-6}
    for rough, told in (
        ({"method": "measured", "periodic": "mirror"}, "measured profile, mirrored to a period of 442.9 µm"),
        ({"method": "measured", "periodic": "none"}, "measured profile, 442.9 µm long"),
    ):
        assert described(json.dumps({"scene": scene | {"roughness": rough}})).startswith(told)


def test_surfaces_of_bodies_are_no_smooth_ones():
    body = {"youngs_modulus": 1e9, "poissons_ratio": 0.3}
    rough = {"roughness": {"method": "measured", "periodic": "mirror"}}
    for bodies, told in (
        ({"body": body | rough, "counter_body": body}, "measured profile, mirrored to a period of 1 mm, on a half"),
        ({"body": body, "counter_body": body | rough}, "measured profile, mirrored to a period of 1 mm, on a half"),
        ({"body": body | rough, "counter_body": body | rough}, "measured profiles, mirrored to a period of 1 mm, on"),
        ({"body": body | rough, "counter_body": body | {"roughness": {"hurst": 0.8}}}, "measured and rough profiles, "),
        ({"body": body | {"roughness": {"hurst": 0.8}}, "counter_body": body}, "rough profile, Hurst exponent 0.8, 1"),
        ({"body": body, "counter_body": body}, "smooth profile, 1 mm long, on"),
    ):
        assert described(json.dumps({"scene": bodies | {"length": 1e-3}})).startswith(told)


@pytest.mark.parametrize(
    ("dimension", "periodic", "fields"), [(1, True, 2), (2, True, 4), (2, "x", 2), (2, "y", 2), (2, False, 1)]
)
def test_the_fields_in_a_period_are_those_of_the_scene(dimension, periodic, fields):
    mirrored = {"method": "measured", "file": "p.csv", "periodic": "mirror"}
    scene = {"body": {"poissons_ratio": 0.3}, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.1}}
    scene |= {"periodic": periodic, "dimension": dimension}
    record = Scene.model_validate(scene | {"roughness": mirrored})
    assert record.fields_in_period == fields
    assert fields_in_period(json.dumps({"scene": record.model_dump(mode="json")})) == fields
    assert fields_in_period(json.dumps({"scene": scene | {"roughness": mirrored | {"periodic": "none"}}})) == 1
    form = Scene.model_validate(scene | {"roughness": mirrored, "form": {"radius": 1.0}})
    assert form.fields_in_period == fields_in_period(json.dumps({"scene": form.model_dump(mode="json")})) == 1
