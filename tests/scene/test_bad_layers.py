"""Layers that make no body, and what layers on a half-space cannot bear, are refused where they stand."""

import json

import pytest
from click.testing import CliRunner

from gfmd_numba.cli import main
from support.layered_scenes import HARD_ON_SOFT, SOFT, SOFT_ON_HARD, TOP, refused

BASE = "'rigid', or a mapping of 'youngs_modulus', 'poissons_ratio' for a half-space of that material"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"base": None}, "scene.body.base: you gave an empty value; gfmd allows 'rigid' or a mapping of"),
        ({"base": "soft"}, f"scene.body.base: you gave 'soft'; gfmd allows {BASE}"),
        (
            {"base": {"youngs_modulus": 1.0}},
            "scene.body.base.poissons_ratio: you gave nothing; gfmd needs a number above",
        ),
        (
            {"base": {"youngs_modulus": 1.0, "poissons_ratio": 0.3, "height": 0.3}},
            "scene.body.base.height: you gave an unknown key; gfmd allows one of 'youngs_modulus', 'poissons_ratio'",
        ),
        ({"base": {"youngs_modulus": 1.0, "poissons_ratio": 0.6}}, "scene.body.base.poissons_ratio: you gave 0.6; "),
        ({"base": {"youngs_modulus": 1e-7, "poissons_ratio": 0.3}}, "scene.body.base.youngs_modulus: you gave 1e-07; "),
        ({"layers": []}, "scene.body.layers: you gave []; gfmd allows a list of one or more mapping"),
        ({"layers": 3}, "scene.body.layers: you gave 3; gfmd allows a list of one or more mapping"),
        (
            {"layers": [{"height": 0.1, "poissons_ratio": 0.3}]},
            "scene.body.layers[0].youngs_modulus: you gave nothing; ",
        ),
        (
            {"layers": [TOP | {"height": 0.0}]},
            "scene.body.layers[0].height: you gave 0.0; gfmd allows a number from 1e-30",
        ),
        (
            {"layers": [TOP, TOP | {"height": 1e-13}]},
            "scene.body.layers[1].height: you gave 1e-13; gfmd allows a height ",
        ),
        ({"layers": [TOP, SOFT | {"youngs_modulus": 1e11}]}, "scene.body.layers[1].youngs_modulus: you gave "),
        ({"layers": [TOP | {"hight": 1.0}]}, "scene.body.layers[0].hight: you gave an unknown key; gfmd allows "),
        ({"youngs_modulus": 1.0}, "scene.body.youngs_modulus: you gave 1.0; gfmd allows nothing with layers"),
        ({"poissons_ratio": 0.3}, "scene.body.poissons_ratio: you gave 0.3; gfmd allows nothing with layers"),
        ({"aspect_ratio": 0.3}, "scene.body.aspect_ratio: you gave 0.3; gfmd allows nothing with layers"),
        ({"layers": None}, "scene.body.poissons_ratio: you gave nothing; gfmd needs a number above -1"),
        (
            {"layers": None, "poissons_ratio": 0.3},
            "scene.body.base: you gave 'rigid'; gfmd allows nothing without layers",
        ),
    ],
)
def test_layers_that_make_no_body_are_refused_where_they_stand(change, said):
    assert refused(HARD_ON_SOFT | change).startswith(said)


def test_layers_on_a_half_space_have_no_reference_for_displacement():
    said = refused(SOFT_ON_HARD, loading={"displacement": 1e-4})
    assert said.startswith("scene.body.base: you gave {")
    assert "gfmd allows rigid, periodic false, or a pressure or another load in place" in said
    friction = {"hard_wall": {}, "friction": {"coefficient": 0.3}}
    said = refused(SOFT_ON_HARD, interface=friction, path=[{"sliding": 1e-4}])
    assert said.startswith("path[0].sliding: you gave 0.0001; gfmd allows nothing without base rigid")


def test_a_layer_too_soft_around_a_window_is_told_the_least_modulus():
    """A tenth of that of the stiffest layer above it."""
    soft = HARD_ON_SOFT["layers"][1] | {"height": 2.0}
    said = refused({"layers": [TOP, soft, soft], "base": "rigid"}, periodic=False)
    assert said.startswith("scene.body.layers[1].youngs_modulus: you gave 1.0; gfmd allows without a period only at ")
    assert said.count("at least 10 Pa, 0.1 times the modulus of the stiffest layer above it") == 2
    soft |= {"youngs_modulus": "8 kPa"}
    said = refused({"layers": [TOP | {"youngs_modulus": "0.1 MPa"}, soft], "base": "rigid"}, periodic=False, length=1.0)
    assert "you gave '8 kPa'; gfmd allows without a period only at least 10 kPa, 0.1 times" in said


def test_the_schema_says_whose_modulus_counts():
    result = CliRunner().invoke(main, ["schema", "scene"])
    layers = json.loads(result.output)["$defs"]["Body"]["properties"]["layers"]
    assert "E* in reduced_pressure and kappa" in layers["description"]
    assert "the first one" in layers["description"]
