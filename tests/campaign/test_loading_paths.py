"""A campaign along a loading path: what it records, how it resumes, and what it refuses."""

import shutil
from itertools import pairwise

import numpy as np
import pytest

import gfmd_numba
import gfmd_numba.analysis
from gfmd_numba.analysis.plots.path import plot_path
from gfmd_numba.campaign.execution import perform
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.run import Choice
from gfmd_numba.campaign.run import run as run_campaign
from gfmd_numba.campaign.shards import Finished
from gfmd_numba.campaign.status import verify
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.contact import load_path
from gfmd_numba.contact.observables import OBSERVABLES, PATH_OBSERVABLES
from support.campaigns import TINY, campaign
from support.command_line import gfmd
from support.friction_losses import slipping_losses
from support.paths import DRAGGED, LOOP, PSD, PULLED, one


@pytest.fixture(scope="module")
def dragged(tmp_path_factory):
    return gfmd_numba.run(DRAGGED, tmp_path_factory.mktemp("dragged") / "out")


@pytest.fixture(scope="module")
def directory_of_pulled(tmp_path_factory):
    directory = tmp_path_factory.mktemp("pulled") / "out"
    gfmd_numba.run(PULLED, directory)
    return directory


@pytest.fixture
def pulled(directory_of_pulled):
    return gfmd_numba.open_campaign(directory_of_pulled)


@pytest.mark.long
def test_the_numbers_are_those_of_gfmd_solve_step_by_step(dragged, pulled):
    """`gfmd solve` keeps the status and the effort of each step; a campaign has one of the path."""
    cases = ((dragged, DRAGGED, 0, "coefficient", 0.05), (pulled, PULLED, 1, "work_of_adhesion", 1e-4))
    for results, file, case, key, value in cases:
        alone = gfmd_numba.solve(one(file, 1, **{key: value}))
        found = results.isel(case=case, realisation=1)
        assert found["status"] == 0
        shared = [name for name in (*OBSERVABLES, *PATH_OBSERVABLES) if name in found]
        for name in shared:
            row = OBSERVABLES.get(name) or PATH_OBSERVABLES[name]
            if row.of in ("contact", "path"):
                np.testing.assert_array_equal(found[name], alone[name], err_msg=name)
                assert found[name].attrs["units"] == alone[name].attrs["units"]
        assert found["n_transforms"] == alone["n_transforms"].sum()
        assert found["residual"] == alone["residual"].max()


@pytest.mark.long
def test_a_step_tells_what_it_prescribed(dragged, pulled):
    np.testing.assert_array_equal(dragged["step_sliding"], [[0.0] + [step["sliding"] for step in DRAGGED["path"]]] * 2)
    assert (dragged["step_load"] == 0.05).all()
    np.testing.assert_array_equal(pulled["step_load"], [LOOP] * 2)
    assert "step_sliding" not in pulled.coords


@pytest.mark.long
def test_what_a_pulled_punch_has_not_is_not_recorded(pulled):
    assert PATH_OBSERVABLES.keys() - pulled.keys() == {
        "mean_tangential_traction",
        "mean_tangential_traction_y",
        "slid_over_peaks",
        "stick_fraction",
    }


def test_what_the_scene_has_not_is_not_recorded(dragged, tmp_path):
    assert PATH_OBSERVABLES.keys() - dragged.keys() == {"pull_off_pressure", "mean_tangential_traction_y"}
    text = TINY + "path: [{reduced_pressure: 0.1}]\n"
    hard = gfmd_numba.open_campaign(run_campaign(campaign(tmp_path, text), tmp_path / "out", Workers(0))[0])
    assert not PATH_OBSERVABLES.keys() & hard.keys()
    np.testing.assert_allclose(hard["mean_pressure"] / 0.01, [[[0.05, 0.1]] * 2])


def test_a_campaign_without_a_path_has_no_steps(tmp_path):
    plain = gfmd_numba.open_campaign(run_campaign(campaign(tmp_path, TINY), tmp_path / "out", Workers(0))[0])
    assert "step" not in plain.dims
    assert not [name for name in plain.variables if str(name).startswith("step")]
    assert set(plain["kappa"].dims) == {"case", "realisation"}


@pytest.mark.long
def test_the_loss_of_a_cycle_is_the_area_of_the_loop_of_forces(dragged, pulled):
    """From one end of sliding to the other and back; pulled apart, the work alone: no energy is left at the ends."""
    cycle = slice(2, None)  # from 8e-4 to -8e-4 and back: the second state is that of the first load, the last again
    force = dragged["mean_tangential_traction"]
    settled = abs(force[..., -1] - force[..., 2]) < 1e-9  # the same state at both ends
    assert settled.all()
    np.testing.assert_allclose(dragged["hysteresis"], dragged["energy_lost"].sum("step"), rtol=1e-12)
    turns = [0.0, *(step["sliding"] for step in DRAGGED["path"])]
    fine = np.concatenate([np.linspace(a, b, 17)[1:] for a, b in pairwise(turns)])
    path = gfmd_numba.solve(one(DRAGGED, 0, coefficient=0.05) | {"path": [{"sliding": float(s)} for s in fine]})
    loop = slice(2 * 16, None)
    area = np.trapezoid(path["mean_tangential_traction"][loop], path["sliding"][loop])
    assert float(dragged["energy_lost"][0, 0, 3:].sum()) == pytest.approx(area, rel=2e-3)
    assert (dragged["energy_lost"][..., cycle] > 0.0).all()


def test_friction_takes_its_loss_at_the_slipping_nodes(dragged):
    """Independent of all energies: tractions times the slip of their nodes, in fields that `gfmd solve` leaves."""
    taken = slipping_losses(gfmd_numba.solve(one(DRAGGED, 0, coefficient=0.05)), 0.05)
    np.testing.assert_allclose(dragged["energy_lost"][0, 0, 1:], taken, rtol=1e-5, atol=1e-14)


def test_sticking_nodes_are_the_contact_under_the_load_without_what_drags(dragged):
    """Ciavarella and Jaeger: with nu = 1/2 the stick zone under Q is the contact under P - Q / mu."""
    for case, friction in enumerate(DRAGGED["grid"]["friction_coefficient"]):
        for realisation in range(2):
            found = dragged.isel(case=case, realisation=realisation, step=1)
            left = float(found["mean_pressure"] - abs(found["mean_tangential_traction"]) / friction)
            scene = DRAGGED["scene"] | {"interface": {"hard_wall": {}}}
            scene["loading"] = {"reduced_pressure": left / PSD["rms_gradient"]}
            lighter = gfmd_numba.solve(one(DRAGGED, realisation) | {"scene": scene, "path": []})
            nodes = float(found["contact_area_fraction_counted"]) * lighter.sizes["x"]
            sticking = float(lighter["contact_area_fraction_counted"]) * lighter.sizes["x"]
            assert 0.1 < found["stick_fraction"] < 0.98
            assert abs(float(found["stick_fraction"]) * nodes - sticking) <= 2.0


@pytest.mark.long
def test_pull_off_is_the_largest_tension_and_unknown_before_it_is_reached(pulled, tmp_path):
    tension = -pulled["mean_pressure"].min("step")
    assert (pulled["pull_off_pressure"] >= tension).all()  # jumps are located between the steps
    assert (pulled["pull_off_pressure"] < 1.2 * tension).all()
    assert (pulled["pull_off_pressure"][1] > pulled["pull_off_pressure"][0]).all()
    for steps in (3, 4):  # pressed in alone, where it is pulled in too, and withdrawn a little
        short = PULLED | {"path": PULLED["path"][:steps], "realisations": 1}
        assert gfmd_numba.run(short, tmp_path / str(steps))["pull_off_pressure"].isnull().all()


@pytest.mark.long
def test_tension_that_falls_because_the_punch_comes_back_is_no_pull_off(tmp_path):
    back = PULLED | {"realisations": 1, "grid": {}, "path": [{"displacement": d} for d in (5e-4, -1e-3, 0.0)]}
    found = gfmd_numba.run(back, tmp_path / "back")
    pressure = found["mean_pressure"].values[0, 0]
    assert pressure[2] < pressure[3] < pressure[1]
    assert pressure[2] < 0.0
    assert found["pull_off_pressure"].isnull().all()


@pytest.mark.long
def test_a_path_resumes_with_one_digest(tmp_path):
    short = DRAGGED | {"realisations": 1, "path": DRAGGED["path"][:1]}
    whole = gfmd_numba.run(short, tmp_path / "whole")
    path, _ = run_campaign(short, tmp_path / "out", Workers(0), choice=Choice(limit=1))
    part = gfmd_numba.open_campaign(path)
    assert part["energy_lost"][1].isnull().all()
    assert part["energy_lost"][0].notnull().all()
    assert dict(part.sizes) == dict(whole.sizes)
    path, _ = run_campaign(tmp_path / "out" / "campaign.yaml", tmp_path / "out", Workers(0))
    assert gfmd_numba.open_campaign(path).attrs["content_sha256"] == whole.attrs["content_sha256"]
    assert verify(tmp_path / "out").sound == 2


@pytest.mark.filterwarnings("ignore:steps_used_up:UserWarning")
def test_a_path_ends_at_the_first_step_that_is_not_ok(tmp_path):
    """The first loading takes fewer iterations than the drag."""
    file = DRAGGED | {"numerics": {"solver": "verlet", "max_iterations": 600}, "realisations": 1}
    file["grid"] = {"friction_coefficient": [0.05]}
    file["path"] = [{"reduced_pressure": 0.05}, {"sliding": 5e-4}, {"sliding": 0.0}]
    results = gfmd_numba.run(file, tmp_path / "out")
    with pytest.raises(gfmd_numba.analysis.UnusableDataError, match="you gave no path that is ok"):
        plot_path(results.isel(case=[0]))
    found = results.isel(case=0, realisation=0)
    assert found["status"] == 1
    ended = found["contact_area_fraction"].isnull().values
    assert ended.any()
    assert not ended[0]
    assert (np.diff(ended.astype(int)) >= 0).all()
    for name in ("energy_lost", "stick_fraction", "mean_tangential_traction"):
        np.testing.assert_array_equal(found[name].isnull(), ended)
    assert np.isnan(found["hysteresis"])
    alone = gfmd_numba.solve(one(file, 0, coefficient=0.05) | {"numerics": file["numerics"]})
    assert alone["status"].values.tolist() == [0] * int((~ended).sum()) + [1]
    np.testing.assert_array_equal(alone["contact_area_fraction"][:-1], found["contact_area_fraction"][~ended])
    assert np.isnan(alone["hysteresis"])


def test_other_paths_are_other_problems():
    problem = plan(DRAGGED).problems[0]
    shorter = plan(DRAGGED | {"path": DRAGGED["path"][:-1]}).problems[0]
    without = plan({key: value for key, value in DRAGGED.items() if key != "path"}).problems[0]
    assert len({problem.identity, shorter.identity, without.identity}) == 3
    assert problem.n_loads == 7
    assert without.n_loads == 1


def test_a_block_of_a_path_is_as_much_work_as_any_other():
    planned = plan(DRAGGED | {"realisations": 100_000})
    sizes = {block.stop - block.first for block in planned.blocks}
    plain = plan({key: value for key, value in DRAGGED.items() if key != "path"} | {"realisations": 100_000})
    assert max(block.stop - block.first for block in plain.blocks) // 7 == max(sizes)


@pytest.mark.long
def test_run_shows_and_plot_draws_a_path(directory_of_pulled, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written = shutil.copytree(directory_of_pulled, tmp_path / "out") / "campaign.yaml"
    said = gfmd("run", written, "-o", "out", "--workers=0")
    assert said.exit_code == 0, said.output
    assert "end of the path of 8 steps" in said.output
    assert "hysteresis" in said.output
    assert "pull-off" in said.output
    assert "2 realisations along a path of 8 steps" in gfmd("check", written).output
    assert gfmd("plot", "out", "-o", "picture.png").exit_code == 0
    assert (tmp_path / "picture.png").stat().st_size > 5_000
    assert "path          8 steps" in gfmd("plan", written, "--pilot=0").output


@pytest.mark.long
def test_a_shard_holds_its_steps(tmp_path):
    planned = plan(DRAGGED | {"realisations": 1})
    block = next(planned.blocks)
    (tmp_path / "shards").mkdir()
    assert perform((block,), tmp_path, None) == {}
    read = Finished(tmp_path).read(block.name)
    measures = load_path.measured(block.problem, range(block.first, block.stop))
    assert read.keys() == measures.keys() | {"seconds"}
    for name in measures.keys() - {"wall_time"}:
        np.testing.assert_array_equal(read[name], measures[name])
    assert read["energy_lost"].shape == (1, 7)
