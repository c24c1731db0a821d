"""Campaigns around one measured surface: loads, bodies and slabs are varied, the surface is what it is."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from click.testing import CliRunner

import gfmd_numba
from gfmd_numba.campaign.plan import plan
from gfmd_numba.cli import main
from gfmd_numba.roughness import surface_files
from gfmd_numba.scene import InputError

pytestmark = pytest.mark.usefixtures("undrawn")

SCENE = {
    "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.2},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.05},
    "roughness": {"method": "measured", "file": "steel.npy", "detrend": "mean"},
}
RANDOM = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05}
GRID = {"reduced_pressure": [0.01, 0.05], "aspect_ratio": [0.1, 1.0]}


KINDS = {"params": [1, pytest.param(2, marks=pytest.mark.long)], "ids": ["profile", "map"]}


@pytest.fixture(**KINDS)
def folder(request, tmp_path):
    """A folder with a campaign around a measured surface, and the heights of that."""
    return filled(tmp_path, request.param)


@pytest.fixture(**KINDS, scope="module")
def ran(request, tmp_path_factory):
    folder = filled(tmp_path_factory.mktemp("ran"), request.param)
    return folder, gfmd_numba.run(folder / "steel.yaml", folder / "out")


def filled(folder, dimension):
    surface = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.05, "points": 32, "cut_on": 1 / 8, "roll_off": 1 / 2}
    np.save(folder / "steel.npy", gfmd_numba.make_surface({"surface": surface, "dimension": dimension})["height"])
    write(folder)
    return folder


def write(folder, **changes):
    campaign = {"name": "steel", "scene": SCENE, "grid": GRID} | changes
    (folder / "steel.yaml").write_text(yaml.safe_dump(campaign))
    return folder / "steel.yaml"


def test_a_case_is_the_contact_that_solve_finds(ran):
    folder, found = ran
    assert found["kappa"].shape == (4, 1)
    for case in (0, 3):  # which differ in both
        values = {name: float(found[name][case]) for name in GRID}
        body = SCENE["body"] | {"aspect_ratio": values["aspect_ratio"]}
        roughness = SCENE["roughness"] | {"file": str(folder / "steel.npy")}
        loading = {"reduced_pressure": values["reduced_pressure"]}
        one = gfmd_numba.solve(SCENE | {"body": body, "loading": loading, "roughness": roughness})
        assert float(one["kappa"]) == pytest.approx(float(found["kappa"][case, 0]), rel=1e-12)
    assert "mean" in found.attrs["processing"]


@pytest.mark.long
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
        ({"seed": 1}, r"seed: you gave 1; gfmd allows nothing, as no surface is random"),
        ({"realisations": 1}, r"realisations: you gave 1; gfmd allows nothing, as no surface is random"),
        (
            {"scene": SCENE | {"body": SCENE["body"] | {"roughness": RANDOM}}},
            r"seed: you gave nothing; gfmd needs a whole number at least 0 and below 4294967296, as surfaces are "
            r"random",
        ),
        (
            {"reference": {"eps_c": 1, "eps_f": 1, "eps_t": 1}},
            r"reference: you gave .*; gfmd allows nothing, as the surface",
        ),
        ({"grid": {"hurst": [0.3, 0.8]}}, r"grid.hurst: you gave .*; gfmd allows nothing without"),
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


def test_results_name_the_file_as_the_campaign_does(ran):
    folder, found = ran
    assert found.attrs["campaign"] == (folder / "steel.yaml").read_text()
    told = [found.attrs, *(each.attrs for each in found.variables.values()), *(each.values for each in found.values())]
    assert str(folder) not in str(told)


@pytest.mark.long
def test_a_copy_of_the_campaign_in_its_directory_reads_the_same_file_from_anywhere(folder, monkeypatch):
    monkeypatch.chdir(folder)
    first = gfmd_numba.run(yaml.safe_load(Path("steel.yaml").read_text()))
    monkeypatch.chdir(folder.parent)
    again = gfmd_numba.run(folder / "steel" / "campaign.yaml", folder / "steel")
    assert again.attrs["content_sha256"] == first.attrs["content_sha256"]
    assert len(list((folder / "steel" / "shards").glob("*.shard"))) == 4


@pytest.mark.long
def test_a_map_of_a_file_bears_a_force_without_a_dimension_in_the_scene(folder):
    heights, name = np.load(folder / "steel.npy"), {1: "line_load", 2: "force"}
    right, wrong = name[heights.ndim], name[3 - heights.ndim]
    body = {"youngs_modulus": 1e9, "poissons_ratio": 0.3}
    treated = SCENE["roughness"] | {"units": {"z": "m"}}
    for load in (right, wrong):
        scene = SCENE | {"body": body, "length": 1.0, "roughness": treated, "loading": {load: 1e5}}
        done = CliRunner().invoke(main, ["check", str(write(folder, scene=scene, grid={load: [1e5, 1e6]}))])
        assert done.exit_code == (0 if load == right else 2), done.output
    said = " ".join(done.output.split())
    assert f"scene.loading.{wrong}: you gave 100000.0; gfmd allows a {right} with dimension {heights.ndim}" in said
    scene["loading"] = {right: 1e5}
    found = gfmd_numba.run(write(folder, scene=scene, grid={right: [1e5, 1e6]}), folder / "out")
    assert found["dimension"].values.tolist() == 2 * [heights.ndim]
    assert (found["status"] == 0).all()


def test_planning_reads_the_file_once(folder, monkeypatch):
    read = []
    monkeypatch.setattr(surface_files, "read_npy", lambda path: read.append(path) or np.load(path))
    done = CliRunner().invoke(main, ["plan", str(folder / "steel.yaml"), "--pilot", "0"])
    assert done.exit_code == 0, done.output
    assert len(read) == 1
