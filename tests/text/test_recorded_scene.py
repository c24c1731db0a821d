"""What a recorded scene says in the title of a picture."""

import json

import pytest

from gfmd_numba.text.recorded_scene import described

SCENE = '{"scene": {"body": {"youngs_modulus": 7e10}, "roughness": {"method": "psd", "hurst": 0.8}, "length": 1e-3}}'


def test_a_scene_is_described_in_units():
    assert described(SCENE) == "rough profile, Hurst exponent 0.8, 1 mm long, on a half-space of Young's modulus 70 GPa"


@pytest.mark.parametrize(
    "altered", ["", "garbage", "[]", "null", '{"scene": 3}', '{"scene": {"body": 3}}', SCENE.replace("7e10", '"soft"')]
)
def test_an_altered_record_says_nothing(altered):
    assert described(altered) == ""


def test_the_length_of_a_mirrored_surface_is_that_of_the_period():
    scene = {"body": {"youngs_modulus": 1e9, "poissons_ratio": 0.3}, "length": 442.9e-6}
    for rough, told in (
        ({"method": "measured", "periodic": "mirror"}, "measured profile, mirrored to a period of 442.9 µm"),
        ({"method": "measured", "periodic": "none"}, "measured profile, 442.9 µm long"),
    ):
        assert described(json.dumps({"scene": scene | {"roughness": rough}})).startswith(told)
