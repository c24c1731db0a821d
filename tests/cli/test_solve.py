"""`gfmd solve`: what it writes, prints and draws of one contact."""

import re

import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba import simulate
from gfmd_numba.solvers import dynamics
from gfmd_numba.solvers.status import Status
from support.campaigns import campaign
from support.command_line import gfmd, unfolded
from support.scenes import SCENE

pytestmark = pytest.mark.usefixtures("undrawn")


def test_solve_writes_fields_and_scalars(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE)
    done = gfmd("solve", scene, "-o", tmp_path / "out.nc")
    assert done.exit_code == 0
    result = xr.open_dataset(tmp_path / "out.nc")
    assert result.sizes == {"x": 256}
    assert {"height", "pressure", "displacement", "gap", "kappa", "status"} <= set(result.data_vars)
    assert gfmd("plot", tmp_path / "out.nc").exit_code == 0
    assert (tmp_path / "out.png").is_file()


@pytest.mark.parametrize(
    ("name", "content", "given"),
    [
        ("zeros.csv", b"0\n1\n0\0\n2\n", "a zero byte at byte 5: no text"),
        ("flat.csv", "z [um]\n1\n1\n1\n1\n", "a flat surface"),
        ("nan.csv", "z [um]\n1\n2\nnan\n4\n", "height nan at index 2"),
        ("short.csv", "1\n2\n", "2 heights, not at least 4"),
        ("columns.csv", "0,1\n1,2\n2,1\n3,0\n", "positions along x and heights without a unit"),
        ("words.csv", "one\ntwo\nthree\nfour\n", "no row of numbers, but 'one'"),
        ("empty.csv", "", "no number"),
        ("broken.npy", "no array", "no .npy array"),
        ("broken.nc", "no dataset", "no netCDF file"),
    ],
)
def test_an_unusable_profile_is_refused_with_its_reason(tmp_path, name, content, given):
    (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    scene = tmp_path / "scene.yaml"
    text = SCENE.replace("{method: psd, hurst: 0.8, rms_gradient: 0.01}", f"{{method: measured, file: {name}}}")
    scene.write_text(text.partition("discretisation")[0])
    done = gfmd("solve", scene, "-o", tmp_path / "out.nc")
    assert done.exit_code == 2
    assert f"{scene}:5:39: scene.roughness.file: you gave {name} (" in done.stderr
    assert given in done.stderr
    assert "gfmd allows a table of equidistant heights" in done.stderr


@pytest.mark.long
def test_a_prescribed_displacement_has_no_pressure_in_the_table_but_a_picture(tmp_path):
    changes = {
        "{reduced_pressure: 0.05}": "{displacement: 1e-4}",
        "0.33}": "0.33, aspect_ratio: 0.5}",
        "grid: {hurst: [0.3, 0.8]}": "fit: {fixed: {eps_c: 1, eps_f: 1}}",
    }
    done = gfmd("run", campaign(tmp_path, **changes), "-o", tmp_path / "out", "--workers=0")
    assert done.exit_code == 0
    assert "nan" not in done.output
    assert (tmp_path / "out" / "small.png").is_file()


def test_solve_follows_a_path(tmp_path):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE + "path: [{reduced_pressure: 0.1}, {reduced_pressure: 0.05}]\n")
    done = gfmd("solve", scene, "-o", tmp_path / "out.nc")
    assert done.exit_code == 0
    result = xr.load_dataset(tmp_path / "out.nc")
    assert result.sizes == {"step": 3, "x": 256}
    assert result["reduced_pressure"].values.tolist() == [0.05, 0.1, 0.05]
    rows = [line.split() for line in done.output.splitlines() if re.match(r" +\d ", line)]
    above, below = rows[:3], rows[3:]
    megapascals, nanometres = result["mean_pressure"] * 1e-6, result["mean_gap"] * 1e9
    assert [row[:3] for row in above] == [
        [str(i), f"{load:g}", f"{float(megapascals[i]):.4g}"] for i, load in enumerate([0.05, 0.1, 0.05])
    ]
    assert [row[4] for row in above] == [f"{float(gap):.4g}" for gap in nanometres]
    stiffness = 1e3 * float((megapascals[1] - megapascals[0]) / (nanometres[0] - nanometres[1]))  # MPa/µm
    assert [row[5] for row in above] == ["-", *[f"{stiffness:.4g}"] * 2]
    assert [row[-2] for row in below] == [f"{float(kappa):.4g}" for kappa in result["kappa"]]
    scene.write_text(SCENE + "path: [{reduced_pressure: 0.1}]\nnumerics: {max_iterations: 1}\n")
    done = gfmd("solve", scene, "-o", tmp_path / "out.nc")
    assert done.exit_code == 3
    said = unfolded(done.stderr)
    residual = f"{float(xr.load_dataset(tmp_path / 'out.nc')['residual'].item()):.1e}"
    ending = f"the run ended as steps_used_up after 1 iterations at a residual of {residual} in step 0 of 1"
    assert f"{ending}, which ends the path: do not use its" in said
    assert "raise numerics.max_iterations" in said


@pytest.mark.long
def test_an_unstable_run_says_when_and_by_which_wave(tmp_path, monkeypatch):
    scene, out = tmp_path / "scene.yaml", tmp_path / "out.nc"
    scene.write_text(SCENE + "path: [{reduced_pressure: 0.1}]\nnumerics: {solver: verlet}\n")
    assert gfmd("solve", scene, "-o", out).exit_code == 0
    assert "growing_wave" not in xr.load_dataset(out)
    limit = dynamics.stability_limit
    monkeypatch.setattr(dynamics, "stability_limit", lambda *modes: 1.1 * limit(*modes))
    done = gfmd("solve", scene, "-o", out)
    assert done.exit_code == 3
    result = xr.load_dataset(out)
    steps, wave = int(result["n_iterations"][0]), int(result["growing_wave"][0])
    assert wave > 100  # of 128
    said = unfolded(done.stderr)
    assert f"unstable after {steps} iterations with wave {wave} growing in step 0 of 1, which" in said
    assert said.count("gfmd: Tractions grew without bound: lower numerics.time_step") == 1
    assert "at a residual" not in said


@pytest.mark.parametrize("status", [Status.steps_used_up, Status.nonfinite])
def test_only_a_run_that_has_not_converged_is_told_the_residual_it_found(tmp_path, monkeypatch, status):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE)
    ended = gfmd_numba.solve(scene)
    ended["status"][...] = status
    ended["residual"][...] = 3.2e-7
    monkeypatch.setattr(simulate, "solve", lambda *given: ended)
    done = gfmd("solve", scene, "-o", tmp_path / "out.nc")
    assert done.exit_code == 3
    said = unfolded(done.stderr)
    assert f"the run ended as {status.name} after {int(ended['n_iterations'])} iterations" in said
    assert ("iterations at a residual of 3.2e-07: " in said) == (status == Status.steps_used_up)


@pytest.mark.long
def test_pull_off_and_what_the_whole_path_loses_are_printed_below_its_steps(tmp_path):
    law = "{hard_wall: {}, exponential: {work_of_adhesion: 0.1, range: 2e-7}}"
    pulled = SCENE.replace("{hard_wall: {}}", law).replace("{reduced_pressure: 0.05}", "{displacement: -1e-7}")
    (tmp_path / "scene.yaml").write_text(pulled + "path: [{displacement: 1e-7}, {displacement: -4e-7}]\n")
    done = gfmd("solve", tmp_path / "scene.yaml", "-o", tmp_path / "out.nc")
    result, printed = xr.open_dataset(tmp_path / "out.nc"), unfolded(done.stdout).partition("steps of the path")[2]
    assert done.exit_code == 0
    assert result["hysteresis"].dims == ()
    for name in ("hysteresis", "pull-off pressure"):
        assert (name in printed) == bool(result[name.replace("-", "_").replace(" ", "_")].notnull())


@pytest.mark.parametrize(
    ("modulus", "wall", "is_told"),
    [
        ("youngs_modulus: 70e9, ", "{}", True),
        ("youngs_modulus: 70e9, ", "{hardness: 2e9}", False),
        ("youngs_modulus: 1e6, ", "{}", False),
        ("", "{}", False),
    ],
)
def test_large_pressures_of_elastic_bodies_ask_for_a_hardness(tmp_path, modulus, wall, is_told):
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE.replace("youngs_modulus: 70e9, ", modulus).replace("hard_wall: {}", f"hard_wall: {wall}"))
    done = gfmd("solve", scene, "-o", tmp_path / "out.nc")
    assert done.exit_code == 0
    assert ("note bodies are elastic here" in unfolded(done.stdout)) == is_told
