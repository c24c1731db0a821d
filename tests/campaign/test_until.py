"""Runs until the limit has an error: rounds that decide the same after any kill, keep to a budget and end."""

import json
import shutil

import numpy as np
import pytest
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis import fit_tfc
from gfmd_numba.campaign import rounds, workers
from gfmd_numba.campaign import run as runs
from gfmd_numba.campaign.goal import Goal
from gfmd_numba.campaign.limits import FEWEST
from gfmd_numba.campaign.run import run_until
from gfmd_numba.campaign.status import campaign_in, progress, verify
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.scene import InputError
from gfmd_numba.storage import atomic_file
from support.campaigns import Killed, campaign, numbers

pytestmark = pytest.mark.usefixtures("laws_that_hold")

FIT = {"reference: {": "fit: {exponents: free, fixed: {eps_c: 1.5, eps_f: 0.7}}\nlevels: only\nreference: {"}
ONE = FIT | {"grid: {hurst: [0.3, 0.8]}": ""}
GOAL = Goal(targets={"kappa": 0.03})
HERE = Workers(0)


@pytest.fixture(scope="module")
def reached(tmp_path_factory, laws_that_hold):
    folder = tmp_path_factory.mktemp("reached")
    return run_until(campaign(folder, **ONE), GOAL, folder / "out", HERE)


def opened(outcome):
    return gfmd_numba.open_campaign(outcome.results)


def realisations(outcome):
    return [each.realisations for each in outcome.rounds.rounds]


def test_a_run_ends_with_the_error_that_was_asked_for(reached):
    results = opened(reached)
    fitted = fit_tfc(results, fixed={"eps_c": 1.5, "eps_f": 0.7})
    error = (fitted["kappa_tfc_error"] / fitted["kappa_tfc"]).item()
    last = reached.rounds.now
    assert reached.reached
    assert len(reached.rounds.rounds) > 1
    found = last.errors["kappa"]
    assert error == pytest.approx(found.error)
    xr.testing.assert_identical(reached.fits["kappa"], fit_tfc(results, **json.loads(results.attrs["fit"])))
    assert found.error * found.factor <= GOAL.targets["kappa"]
    assert found.factor > 1.0
    assert found.reached
    np.testing.assert_array_equal(results["realisations"], last.realisations)


@pytest.mark.long
def test_the_pilot_has_twenty_realisations_of_the_finest_level_and_more_of_coarser_ones(reached, tmp_path):
    """Whatever the file asks for: levels without realisations are solved, too."""
    file = {"realisations: 6": "realisations: {reference: 3, eps_f: [0, 2, 2]}"}
    again = run_until(campaign(tmp_path, **ONE | file), GOAL, tmp_path / "out", HERE)
    pilot = np.array(realisations(again)[0])
    nodes = np.array([np.prod(level) ** -1.0 for of_group in again.rounds.rounds[0].levels for level in of_group])
    assert pilot.min() == pilot[nodes.argmax()] == FEWEST == 20
    assert (np.diff(pilot[np.argsort(nodes)]) <= 0).all()
    assert pilot.max() == 20 * round((nodes.max() / nodes.min()) ** (2 / 3))
    assert realisations(again) == realisations(reached)
    xr.testing.assert_identical(
        numbers(opened(again)).drop_vars("round_cpu_seconds"), numbers(opened(reached)).drop_vars("round_cpu_seconds")
    )


def test_the_decisions_stand_in_the_file(reached):
    results, found = opened(reached), reached.rounds.rounds
    np.testing.assert_array_equal(results["round_realisations"], [each.realisations for each in found])
    for name in ("error", "error_factor", "predicted_error", "price", "cpu_seconds"):
        variable = results[f"round_{name}"]
        told = [(each.model_dump() | each.told_of("kappa"))[name] for each in found]
        np.testing.assert_array_equal(variable, np.array(told, dtype=float))
        assert {"long_name", "units"} <= variable.attrs.keys()
    said = {name: results.attrs[name] for name in ("until", "ended", "reached", "target")}
    assert said == {"until": "kappa=0.03", "ended": "reached", "reached": "kappa", "target": '{"kappa": 0.03}'}
    assert json.loads((reached.results.parent / "rounds.json").read_text())["ended"] == "reached"
    assert (np.diff(results["round_price"]) > 0).all()


def test_what_looks_at_the_directory_knows_the_rounds(reached):
    out = reached.results.parent
    found, verdict = progress(out), verify(out)
    assert found.done == found.blocks
    assert (verdict.missing, verdict.damaged, verdict.foreign) == (0, [], [])
    assert campaign_in(out)[0].demand[opened(reached)["case_id"].values[0]] == reached.rounds.now.realisations[0]


def killed_at(write, patch):
    """Die after a number of files have been written, as a kill leaves them."""
    left = [write]
    replace = atomic_file.os.replace

    def dying(source, target):
        replace(source, target)
        left[0] -= 1
        if left[0] == 0:
            raise Killed

    patch.setattr(atomic_file.os, "replace", dying)
    return left


@pytest.mark.long
def test_a_kill_anywhere_changes_no_decision_and_no_number(reached, tmp_path, monkeypatch):
    """After every eighth file that a run writes, notes of rounds, shards and results alike, and with all its luck."""
    with monkeypatch.context() as patch:
        left = killed_at(0, patch)
        run_until(campaign(tmp_path, **ONE), GOAL, tmp_path / "whole", HERE)
    for write in range(1, -left[0] + 1, 8):
        out = tmp_path / str(write)
        with monkeypatch.context() as patch:
            killed_at(write, patch)
            with pytest.raises(Killed):
                run_until(campaign(tmp_path, **ONE), GOAL, out, HERE)
        resumed = run_until(campaign(tmp_path, **ONE), GOAL, out, HERE)
        assert realisations(resumed) == realisations(reached)
        assert opened(resumed).attrs["content_sha256"] == opened(reached).attrs["content_sha256"]


@pytest.mark.long
def test_rounds_that_are_damaged_are_decided_anew(reached, tmp_path):
    out = shutil.copytree(reached.results.parent, tmp_path / "out")
    for content in ("", "null", "[" * 10_000, '{"goal": 1}', json.dumps({"rounds": []})):
        (out / "rounds.json").write_text(content)
        assert rounds.read(out) is None
        if content:
            with pytest.raises(InputError, match=r"rounds.json: you gave a path which gfmd did not write"):
                run_until(campaign(tmp_path, **ONE), GOAL, out, HERE)
            assert (out / "rounds.json").read_text() == content
    (out / "rounds.json").unlink()
    again = run_until(campaign(tmp_path, **ONE), GOAL, out, HERE)
    assert opened(again).attrs["content_sha256"] == opened(reached).attrs["content_sha256"]


@pytest.fixture
def solved(monkeypatch):
    """Numbers of realisations that have been solved."""
    counted = []
    perform = runs.finish

    def counting(planned, todo, *others):
        counted.append(sum(block.stop - block.first for block in todo))
        return perform(planned, todo, *others)

    monkeypatch.setattr(runs, "finish", counting)
    return counted


@pytest.mark.long
def test_a_finished_run_solves_nothing_again(reached, tmp_path, solved):
    out = shutil.copytree(reached.results.parent, tmp_path / "out")
    again = run_until(campaign(tmp_path, **ONE), GOAL, out, HERE)
    assert solved == [0]
    assert opened(again).attrs["content_sha256"] == opened(reached).attrs["content_sha256"]


@pytest.mark.long
def test_realisations_of_an_earlier_run_are_used(reached, tmp_path, solved):
    """And what is more than the target asks for is kept; cross levels that the file has not are solved."""
    many = campaign(tmp_path, **ONE | {"realisations: 6": "realisations: 600"})
    gfmd_numba.run(many, tmp_path / "out")
    solved.clear()
    outcome = run_until(campaign(tmp_path, **ONE), GOAL, tmp_path / "out", HERE)
    *own, cross = reached.rounds.now.realisations
    assert max(own) < 600
    assert sum(solved) == cross
    assert opened(outcome).attrs["content_sha256"] == opened(reached).attrs["content_sha256"]


@pytest.mark.long
def test_another_target_decides_anew_from_the_same_results(reached, tmp_path, solved):
    path, looser = campaign(tmp_path, **ONE), Goal(targets={"kappa": 0.05})
    run_until(path, looser, tmp_path / "out", HERE)
    solved.clear()
    further = run_until(path, GOAL, tmp_path / "out", HERE)
    assert opened(further).attrs["content_sha256"] == opened(reached).attrs["content_sha256"]
    assert run_until(path, looser, tmp_path / "out", HERE).reached


@pytest.mark.long
def test_a_plain_run_forgets_the_rounds(tmp_path, finished):
    """And those of a next run with a target are decided from the same results."""
    path, out = campaign(tmp_path), tmp_path / "out"
    first = run_until(campaign(tmp_path, **FIT), Goal(targets={"kappa": 0.05}), out, HERE)
    digest = opened(first).attrs["content_sha256"]
    plain = gfmd_numba.run(path, out)
    xr.testing.assert_identical(numbers(plain), numbers(finished))
    again = run_until(campaign(tmp_path, **FIT), Goal(targets={"kappa": 0.05}), out, HERE)
    assert opened(again).attrs["content_sha256"] == digest


@pytest.mark.long
def test_every_group_has_numbers_of_its_own(tmp_path):
    outcome = run_until(campaign(tmp_path, **FIT), GOAL, tmp_path / "out", HERE)
    results = opened(outcome)
    assert outcome.reached
    of_group = [results["realisations"].values[results["hurst"].values == hurst] for hurst in (0.3, 0.8)]
    assert not np.array_equal(*of_group)


@pytest.mark.long
def test_local_workers_start_once(reached, tmp_path, monkeypatch):
    started = []
    local = workers.local
    monkeypatch.setattr(workers, "local", lambda count: (started.append(count), local(count))[1])
    outcome = run_until(campaign(tmp_path, **ONE), GOAL, tmp_path / "out", Workers(1))
    assert len(outcome.rounds.rounds) > 1
    assert started == [1]
    assert opened(outcome).attrs["content_sha256"] == opened(reached).attrs["content_sha256"]
    run_until(campaign(tmp_path, **ONE), GOAL, tmp_path / "out", Workers(1))
    assert started == [1]  # with nothing left to do none is needed


def test_no_worker_starts_before_the_memory_is_looked_at(tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "local", lambda count: pytest.fail("started"))
    with pytest.raises(InputError, match=r"--workers: you gave 1000000, .* gfmd allows at most \d+"):
        run_until(campaign(tmp_path, **ONE), GOAL, tmp_path / "out", Workers(1_000_000))
