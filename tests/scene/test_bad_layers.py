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
        ({"base": None}, "scene.body.base: given an empty value; allowed: 'rigid' or a mapping of"),
        ({"base": "soft"}, f"scene.body.base: given 'soft'; allowed: {BASE}"),
        ({"base": {"youngs_modulus": 1.0}}, "scene.body.base.poissons_ratio: given nothing; allowed: a number above"),
        (
            {"base": {"youngs_modulus": 1.0, "poissons_ratio": 0.3, "height": 0.3}},
            "scene.body.base.height: given an unknown key; allowed: one of 'youngs_modulus', 'poissons_ratio'",
        ),
        ({"base": {"youngs_modulus": 1.0, "poissons_ratio": 0.6}}, "scene.body.base.poissons_ratio: given 0.6; "),
        ({"base": {"youngs_modulus": 1e-7, "poissons_ratio": 0.3}}, "scene.body.base.youngs_modulus: given 1e-07; "),
        ({"layers": []}, "scene.body.layers: given []; allowed: a list of one or more mapping"),
        ({"layers": 3}, "scene.body.layers: given 3; allowed: a list of one or more mapping"),
        ({"layers": [{"height": 0.1, "poissons_ratio": 0.3}]}, "scene.body.layers[0].youngs_modulus: given nothing; "),
        ({"layers": [TOP | {"height": 0.0}]}, "scene.body.layers[0].height: given 0.0; allowed: a number from 1e-30"),
        ({"layers": [TOP, TOP | {"height": 1e-13}]}, "scene.body.layers[1].height: given 1e-13; allowed: a height "),
        ({"layers": [TOP, SOFT | {"youngs_modulus": 1e11}]}, "scene.body.layers[1].youngs_modulus: given "),
        ({"layers": [TOP | {"hight": 1.0}]}, "scene.body.layers[0].hight: given an unknown key; allowed: "),
        ({"youngs_modulus": 1.0}, "scene.body.youngs_modulus: given 1.0; allowed: nothing beside layers"),
        ({"poissons_ratio": 0.3}, "scene.body.poissons_ratio: given 0.3; allowed: nothing beside layers"),
        ({"aspect_ratio": 0.3}, "scene.body.aspect_ratio: given 0.3; allowed: nothing beside layers"),
        ({"layers": None}, "scene.body.poissons_ratio: given nothing; allowed: a number above -1"),
        ({"layers": None, "poissons_ratio": 0.3}, "scene.body.base: given 'rigid'; allowed: nothing without layers"),
    ],
)
def test_layers_that_make_no_body_are_refused_where_they_stand(change, said):
    assert refused(HARD_ON_SOFT | change).startswith(said)


def test_layers_on_a_half_space_have_no_reference_for_displacement():
    said = refused(SOFT_ON_HARD, loading={"displacement": 1e-4})
    assert said.startswith("scene.body.base: given {")
    assert "allowed: rigid, or loading.reduced_pressure" in said
    friction = {"hard_wall": {}, "friction": {"coefficient": 0.3}}
    said = refused(SOFT_ON_HARD, interface=friction, path=[{"sliding": 1e-4}])
    assert said.startswith("path[0].sliding: given 0.0001; allowed: nothing without base rigid")


def test_the_schema_says_whose_modulus_counts():
    result = CliRunner().invoke(main, ["schema", "scene"])
    layers = json.loads(result.output)["$defs"]["Body"]["properties"]["layers"]
    assert "E* in reduced_pressure and kappa" in layers["description"]
    assert "the first one" in layers["description"]
