"""What a recorded scene says in the title of a picture."""

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
