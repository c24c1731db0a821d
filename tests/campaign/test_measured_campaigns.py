"""Campaigns around one measured surface: loads, bodies and slabs are varied, the surface is what it is."""

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.campaign.plan import plan
from gfmd_numba.cli import main
from gfmd_numba.scene import InputError

SCENE = {
    "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.2},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.05},
    "roughness": {"method": "measured", "file": "steel.npy", "detrend": "mean"},
}
GRID = {"reduced_pressure": [0.01, 0.05], "aspect_ratio": [0.1, 1.0]}


@pytest.fixture(params=[1, 2], ids=["profile", "map"])
def folder(request, tmp_path):
    """A folder with a campaign around a measured surface, and the heights of that."""
    surface = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05, "points": 32, "cut_on": 1 / 8, "roll_off": 1 / 2}
    np.save(tmp_path / "steel.npy", gfmd_numba.make_surface({"surface": surface, "dimension": request.param})["height"])
    write(tmp_path)
    return tmp_path


def write(folder, **changes):
    campaign = {"name": "steel", "seed": 1, "realisations": 1, "scene": SCENE, "grid": GRID} | changes
    (folder / "steel.yaml").write_text(yaml.safe_dump(campaign))
    return folder / "steel.yaml"


def test_every_case_is_the_contact_that_solve_finds(folder):
    found = gfmd_numba.run(folder / "steel.yaml", folder / "out")
    assert found["kappa"].shape == (4, 1)
    for case in range(4):
        values = {name: float(found[name][case]) for name in GRID}
        body = SCENE["body"] | {"aspect_ratio": values["aspect_ratio"]}
        roughness = SCENE["roughness"] | {"file": str(folder / "steel.npy")}
        loading = {"reduced_pressure": values["reduced_pressure"]}
        one = gfmd_numba.solve(SCENE | {"body": body, "loading": loading, "roughness": roughness})
        assert float(one["kappa"]) == pytest.approx(float(found["kappa"][case, 0]), rel=1e-12)
    assert "mean" in found.attrs["processing"]


def test_a_run_is_looked_at_and_resumed_from_elsewhere(folder, monkeypatch, tmp_path_factory):
    gfmd_numba.run(folder / "steel.yaml", folder / "out")
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    for command in ("status", "verify", "collect"):
        done = CliRunner().invoke(main, [command, str(folder / "out")])
        assert done.exit_code == 0, done.output
    assert len(list((folder / "out" / "shards").glob("*.shard"))) == 4
    gfmd_numba.run(folder / "steel.yaml", folder / "out")


def test_another_surface_is_another_problem(folder):
    before = {problem.identity for problem in plan(folder / "steel.yaml").problems}
    np.save(folder / "steel.npy", np.load(folder / "steel.npy") ** 2)
    assert not before & {problem.identity for problem in plan(folder / "steel.yaml").problems}


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"realisations": 2}, r"realisations: given 2; allowed: 1, as a measured surface has no random"),
        ({"reference": {"eps_c": 1, "eps_f": 1, "eps_t": 1}}, r"reference: given .*; allowed: nothing, as the surface"),
        ({"grid": {"hurst": [0.3, 0.8]}}, r"grid.hurst: given .*; allowed: nothing without"),
        ({"scene": SCENE | {"roughness": {"method": "measured", "file": "steal.npy"}}}, r"did you mean 'steel.npy'"),
        ({"scene": SCENE | {"roughness": {"method": "measured", "heights": [0, 1, 0, 2]}}}, r"save the array as .npy"),
    ],
)
def test_what_a_measured_surface_cannot_have_is_refused(folder, changes, said):
    with pytest.raises(InputError, match=said):
        plan(write(folder, **changes))


def test_accuracy_of_a_measured_surface_is_refused(folder):
    done = CliRunner().invoke(main, ["accuracy", str(folder / "steel.yaml"), "-o", str(folder / "a.nc")])
    assert done.exit_code == 2
    assert "a random surface for `gfmd accuracy`" in " ".join(done.output.split())
