"""Commands that compute nothing or little: help, check, init, schema, doctor, and shipped campaigns."""

import json
from pathlib import Path

import pytest

from support.campaigns import campaign
from support.command_line import gfmd, python
from support.scenes import SCENE

CAMPAIGNS = Path(__file__).parents[2] / "campaigns"


def test_check_imports_nothing_of_weight(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE)
    script = (
        "import sys; from gfmd_numba.cli import main\n"
        "for path in sys.argv[1:]: main(['check', path], standalone_mode=False)\n"
        "print([m for m in ('numpy', 'numba', 'dask', 'xarray', 'scipy') if m in sys.modules])"
    )
    assert python(script, scene, campaign(tmp_path)).endswith("[]\n")


def test_check_tells_campaigns_from_scenes(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE)
    assert gfmd("check", scene).output == f"{scene}: a scene, length 100 µm, youngs_modulus 70 GPa\n"
    path = campaign(tmp_path)
    assert gfmd("check", path).output == f"{path}: a campaign of 10 cases x 6 realisations, youngs_modulus 70 GPa\n"


def test_bad_input_exits_with_2_and_names_the_place(tmp_path):
    path = campaign(tmp_path, **{"hurst: 0.8": "hurts: 0.8"})
    for command in (["check", path], ["plan", path], ["run", path]):
        done = gfmd(*command)
        assert done.exit_code == 2
        assert f"{path}:7:28" in done.stderr
        assert "did you mean 'hurst'" in done.stderr
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("path", sorted(CAMPAIGNS.glob("*.yaml")), ids=lambda path: path.name)
def test_shipped_campaigns_pass_their_check(path):
    assert gfmd("check", path).exit_code == 0


def test_init_writes_a_campaign_that_can_be_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert gfmd("init").exit_code == 0
    assert "a campaign of 16 cases x 60 realisations" in gfmd("check", "campaign.yaml").output
    again = gfmd("init")
    assert again.exit_code == 2
    assert "campaign.yaml: this file exists, and gfmd overwrites nothing; choose a new name" in again.output


@pytest.mark.parametrize("kind", ["campaign", "scene", "surface"])
def test_schemas_are_json(kind):
    schema = json.loads(gfmd("schema", kind).output)
    assert schema["additionalProperties"] is False


@pytest.mark.long
def test_doctor_finds_a_sound_installation():
    said = gfmd("doctor")
    assert said.exit_code == 0, said.output
    assert "of Westergaard's peak pressure" in said.output
    assert "2 started" in said.output


@pytest.mark.long
def test_doctor_finds_a_wrong_pressure(monkeypatch):
    monkeypatch.setattr("gfmd_numba.theory.closed_forms.westergaard_pressure", lambda x, p, a: x + 1.0)
    said = gfmd("doctor")
    assert said.exit_code == 3
    assert "failed: ArithmeticError" in said.output


def test_the_command_alone_shows_its_help():
    assert gfmd().output == gfmd("--help").output


@pytest.mark.parametrize(("content", "place"), [("x [mm],z [um]\n0,1\n1,2\n", "1:1"), (b"z [\xb5m]\n1\n", "1:4")])
def test_a_table_in_place_of_a_scene_is_told_from_it(tmp_path, content, place):
    table = tmp_path / "profile.csv"
    table.write_bytes(content if isinstance(content, bytes) else content.encode())
    done = gfmd("check", table)
    assert done.exit_code == 2
    assert f"{table}:{place}: you gave" in done.stderr
    assert "named by a YAML file, `roughness: {method: measured, file: profile.csv}`" in done.stderr
