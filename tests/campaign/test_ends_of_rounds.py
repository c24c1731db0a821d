"""How runs until an error end where the target is not reached, and what they refuse before they begin."""

import shutil

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.analysis import fit_tfc
from gfmd_numba.campaign import execution, next_round, rounds
from gfmd_numba.campaign import run as runs
from gfmd_numba.campaign.failures import Ending, Failure
from gfmd_numba.campaign.goal import Goal, goal_of
from gfmd_numba.campaign.run import Choice, InterruptedRunError, run_until
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.scene import InputError
from support.campaigns import TINY, campaign
from support.command_line import gfmd

pytestmark = pytest.mark.usefixtures("laws_that_hold")

ONE = {
    "reference: {": "fit: {exponents: free, fixed: {eps_c: 1.5, eps_f: 0.7}}\nlevels: only\nreference: {",
    "grid: {hurst: [0.3, 0.8]}": "",
}
GOAL = Goal(targets={"kappa": 0.02})
HERE = Workers(0)


@pytest.fixture
def priced(monkeypatch):
    """A machine on which a unit of price takes a second."""
    monkeypatch.setattr(runs, "seconds_per_price", lambda planned, directory: 1.0)


@pytest.fixture(scope="module")
def free(tmp_path_factory, laws_that_hold):
    """A run that nothing ends before its target."""
    folder = tmp_path_factory.mktemp("free")
    return run_until(campaign(folder, **ONE), GOAL, folder / "out", HERE)


def opened(outcome):
    return gfmd_numba.open_campaign(outcome.results)


def prices(outcome):
    return [each.price for each in outcome.rounds.rounds]


@pytest.mark.long
def test_a_budget_is_not_exceeded(free, tmp_path, priced):
    """And is used where the target needs more than it. What `free` has finished is counted as if it were done anew."""
    path, small = campaign(tmp_path, **ONE), Goal(targets={"kappa": 0.005})
    pilot, whole = prices(free)[0], prices(free)[-1]
    for share in (0.5, 2.0):
        budget = pilot + share * (whole - pilot)
        out = shutil.copytree(free.results.parent, tmp_path / str(share))
        outcome = run_until(path, small.model_copy(update={"budget": budget}), out, HERE)
        assert not outcome.reached
        assert "budget" in outcome.rounds.ended
        assert 0.75 * budget < prices(outcome)[-1] <= budget
        first, last = (each.errors["kappa"].error for each in (outcome.rounds.rounds[0], outcome.rounds.now))
        assert small.targets["kappa"] < last < first
    out = shutil.copytree(free.results.parent, tmp_path / "enough")
    assert run_until(path, GOAL.model_copy(update={"budget": 2 * whole}), out, HERE).reached


@pytest.mark.long
def test_decisions_for_a_budget_use_the_seconds_noted_after_the_pilot(free, tmp_path, monkeypatch, priced):
    """Another machine, or the same one on another day, would decide otherwise."""
    path, out = campaign(tmp_path, **ONE), tmp_path / "out"
    goal = GOAL.model_copy(update={"budget": 1.8 * prices(free)[0]})
    whole = run_until(path, goal, shutil.copytree(free.results.parent, tmp_path / "whole"), HERE)
    perform = runs.finish

    def interrupted(planned, todo, *others):
        if rounds.read(out).now.predicted_error is not None:  # a round that follows the pilot
            raise KeyboardInterrupt
        return perform(planned, todo, *others)

    with monkeypatch.context() as patch:
        patch.setattr(runs, "finish", interrupted)
        with pytest.raises(InterruptedRunError):
            run_until(path, goal, out, HERE)
    monkeypatch.setattr(runs, "seconds_per_price", lambda planned, directory: 0.5)
    resumed = run_until(path, goal, out, HERE)
    assert opened(resumed).attrs["content_sha256"] == opened(whole).attrs["content_sha256"]
    assert opened(resumed).attrs["seconds_per_price"] == 1.0


def test_a_budget_that_the_pilot_exceeds_is_refused(tmp_path):
    goal = GOAL.model_copy(update={"budget": 1e-6})
    with pytest.raises(
        InputError, match=r"budget: you gave 1e-06 s of processor time, where the pilot .*; gfmd allows"
    ) as told:
        run_until(campaign(tmp_path, **ONE), goal, tmp_path / "out", HERE)
    assert "realisations of every case" not in str(told.value)  # coarser levels have more
    assert not (tmp_path / "out").exists()


@pytest.mark.long
def test_exponents_that_nobody_knows_end_a_run(tmp_path):
    """Two levels and the reference do not tell an exponent and an error of it, however many surfaces they have."""
    wide = ONE | {"reference: {": "fit: {fixed: {eps_c: [0.2, 4], eps_f: [0.1, 4]}}\nlevels: only\nreference: {"}
    outcome = run_until(
        campaign(tmp_path, **wide), GOAL.model_copy(update={"targets": {"kappa": 1e-4}}), tmp_path / "out", HERE
    )
    assert not outcome.reached
    assert "1000000 realisations of every case would leave an error of" in outcome.rounds.ended
    assert "narrower ranges under `fit: {fixed: ...}` (above all that of eps_" in outcome.rounds.ended
    assert len(outcome.rounds.rounds) == 1
    assert opened(outcome).attrs["ended"] == outcome.rounds.ended


@pytest.mark.long
def test_a_refused_fit_ends_a_run_once_it_was_meant_to_be_good(tmp_path, monkeypatch):
    def refusing(*given, **options):
        found = fit_tfc(*given, **options)
        said = {"fit_status": ("group", ["refused"]), "message": ("group", ["no exponent\nno idea"])}
        return found.assign(said | {"kappa_tfc": np.nan * found["kappa_tfc"]})

    monkeypatch.setattr(runs, "fit_tfc", refusing)
    outcome = run_until(campaign(tmp_path, **ONE), GOAL, tmp_path / "out", HERE)
    assert outcome.rounds.ended == "not reached: the fit is refused, no exponent; no idea"
    assert outcome.rounds.now.is_last
    assert outcome.rounds.now.errors["kappa"].error is None
    assert opened(outcome)["round_error"].isnull().all()


@pytest.mark.long
def test_a_contradicted_exponent_ends_a_run_and_is_named(tmp_path, monkeypatch):
    """Fits without a level, which disagree as well, blame no exponent."""

    def rivalled(by_level, by_exponent):
        def fit(*given, **options):
            found = fit_tfc(*given, **options)
            found["error_budget"].loc[{"source": "rivals"}] = by_level * found["kappa_tfc"]
            found["contradiction"].loc[{"limit": "eps_c"}] = by_exponent * found["kappa_tfc"]
            return found

        return fit

    path = campaign(tmp_path, **ONE)
    monkeypatch.setattr(runs, "fit_tfc", rivalled(0.1, 0.0))
    assert "contradict" not in run_until(path, GOAL, tmp_path / "level", HERE).rounds.ended
    monkeypatch.setattr(runs, "fit_tfc", rivalled(0.1, -0.1))
    ended = run_until(path, GOAL, tmp_path / "exponent", HERE).rounds.ended
    assert ended == "not reached: the levels contradict the fixed eps_c: 1.5; gfmd allows the range that it lies in"


@pytest.mark.long
def test_rounds_come_to_an_end(tmp_path, monkeypatch):
    """Where each fit says less than was expected, or the other way round."""
    monkeypatch.setattr(next_round, "_MOST", 2)
    monkeypatch.setattr(next_round, "_GROWTH", 1.3)
    outcome = run_until(
        campaign(tmp_path, **ONE), GOAL.model_copy(update={"targets": {"kappa": 0.01}}), tmp_path / "out", HERE
    )
    assert outcome.rounds.ended == "not reached: 2 rounds did not suffice"
    assert len(outcome.rounds.rounds) == 3


@pytest.mark.long
def test_an_error_that_stays_larger_than_expected_asks_for_more(free, tmp_path, monkeypatch):
    """A round that was planned to be the last is not, until the fit itself says so."""

    def doubting(*given, **options):
        found = fit_tfc(*given, **options)
        return found.assign(kappa_tfc_error=2.0 * found["kappa_tfc_error"])

    monkeypatch.setattr(runs, "fit_tfc", doubting)
    outcome = run_until(campaign(tmp_path, **ONE), GOAL, tmp_path / "out", HERE)
    assert outcome.reached
    assert prices(outcome)[-1] > 1.5 * prices(free)[-1]
    assert all(1.2 < after / before < 4.5 for before, after in zip(prices(outcome), prices(outcome)[1:], strict=False))


@pytest.mark.long
def test_an_interrupt_leaves_the_best_estimate(free, tmp_path, monkeypatch):
    """Blocks that are finished count, those of a half-finished level up to the first that is not."""
    monkeypatch.setattr("gfmd_numba.campaign.cases._BLOCK_SAMPLES", 256 * 50)
    path, out = campaign(tmp_path, **ONE), tmp_path / "out"
    first = np.array(free.rounds.rounds[0].realisations)
    pilot = dict(zip(opened(free)["case_id"].values.tolist(), first.tolist(), strict=True))
    perform, left = execution.perform, [3]

    def interrupted(task, *others, **options):
        if any(block.first >= pilot[block.problem.identity] for block in task):
            left[0] -= 1
            if left[0] < 0:
                raise KeyboardInterrupt
        return perform(task, *others, **options)

    with monkeypatch.context() as patch:
        patch.setattr(execution, "perform", interrupted)
        patch.setattr("gfmd_numba.campaign.run.tasks", lambda todo, *others: [(block,) for block in todo])
        with pytest.raises(InterruptedRunError) as stopped:
            run_until(path, GOAL, out, HERE)
    partial_ = opened(stopped.value.outcome)
    asked = np.array(free.rounds.rounds[1].realisations)
    assert partial_.attrs["ended"] == "not reached: the run was interrupted"
    assert (partial_["realisations"].values >= first).all()
    assert first.sum() < partial_["realisations"].values.sum() < asked.sum()
    assert not (partial_["status"] == Ending.unfinished).any()
    assert fit_tfc(partial_, fixed={"eps_c": 1.5, "eps_f": 0.7})["fit_status"].item() == "ok"
    resumed = run_until(path, GOAL, out, HERE)
    assert opened(resumed).attrs["content_sha256"] == opened(free).attrs["content_sha256"]


def test_an_interrupt_in_the_pilot_is_one(tmp_path, monkeypatch):
    def interrupted(*given, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(execution, "perform", interrupted)
    with pytest.raises(KeyboardInterrupt) as stopped:
        run_until(campaign(tmp_path, **ONE), GOAL, tmp_path / "out", HERE)
    assert not isinstance(stopped.value, InterruptedRunError)
    assert not stopped.value.args  # nothing is done that could be kept


def test_an_interrupt_before_a_run_begins_promises_nothing(tmp_path, monkeypatch):
    def interrupted(*given):
        raise KeyboardInterrupt

    monkeypatch.setattr(runs, "plan", interrupted)
    ran = gfmd("run", campaign(tmp_path), "-o", tmp_path / "out", "--workers=0")
    assert (ran.exit_code, ran.stderr) == (130, "gfmd: interrupted\n")


@pytest.mark.long
def test_an_interrupt_between_the_contacts_of_a_pilot_and_their_fit_loses_none(tmp_path, monkeypatch):
    """And the status says what became of the run: its blocks are done, its target is not reached."""

    def interrupted(*given, **options):
        raise KeyboardInterrupt

    path, out = campaign(tmp_path, **ONE), tmp_path / "out"
    with monkeypatch.context() as patch:
        patch.setattr(runs, "fit_tfc", interrupted)
        with pytest.raises(InterruptedRunError) as stopped:
            run_until(path, GOAL, out, HERE)
    assert stopped.value.args == ("finished work is kept, the same command resumes",)
    pilot = opened(stopped.value.outcome)
    assert pilot.attrs["ended"] == "not reached: the run was interrupted"
    assert (pilot["status"] == 0).any()
    assert not (pilot["status"] == Ending.unfinished).any()
    assert "blocks done; not reached: the run was interrupted" in gfmd("status", out).output
    rounds.write(out, rounds.read(out).ending(""))  # as a run leaves it that is killed there
    assert "blocks done; not running" in gfmd("status", out).output


@pytest.mark.long
def test_the_first_failure_may_stop_a_run(tmp_path, monkeypatch):
    def boom(problem, chosen):
        if problem.surface.nodes > 16:  # kernels are compiled on less
            raise FloatingPointError("boom")
        return solve(problem, chosen)

    solve = execution.measured
    monkeypatch.setattr(execution, "measured", boom)
    path, out = campaign(tmp_path, **ONE), tmp_path / "out"
    outcome = run_until(path, GOAL, out, HERE, choice=Choice(fail_fast=True))
    assert outcome.rounds.ended == "not reached: the run stopped at the first failure"
    assert list(outcome.failures.values()) == [Failure("crashed", "FloatingPointError: boom")]
    outcome = run_until(path, GOAL, out, HERE)
    assert "you gave no good realisation" in outcome.rounds.ended
    monkeypatch.setattr(execution, "measured", solve)
    assert run_until(path, GOAL, out, HERE, choice=Choice(retry_failed=True)).reached


def test_a_campaign_without_limits_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"until: you gave a campaign without a limit; gfmd allows one with levels"):
        run_until(campaign(tmp_path, TINY), GOAL, tmp_path / "out", HERE)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "given", [0.01, {}, {"kappa": 0}, {"kappa": 1}, {"kappa": "much"}, {"area": 0.1}, {"kappa": 0.1, "kappa_r": 2}, "x"]
)
def test_what_is_no_target_is_refused(given, tmp_path):
    with pytest.raises(InputError, match=r"^until: you gave .*; gfmd allows one of kappa, kappa_counted, "):
        gfmd_numba.run(campaign(tmp_path, **ONE), tmp_path / "out", until=given)


@pytest.mark.parametrize("given", ["soon", -1, 0, "nan", float("inf"), "5 m", True, []])
def test_what_is_no_time_is_refused(given):
    with pytest.raises(InputError, match=r"^budget: you gave .*; gfmd allows a time like 20min, 2h or 90 s"):
        goal_of({"kappa": 0.1}, given)


def test_times_are_read_as_others():
    read = [goal_of({"kappa": 0.1}, given).budget for given in ("20min", "2h", "90 s", "90", 90, "1/2 h")]
    assert read == [1200.0, 7200.0, 90.0, 90.0, 90.0, 1800.0]


def test_a_budget_without_a_target_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"^budget: you gave it without until"):
        gfmd_numba.run(campaign(tmp_path, **ONE), tmp_path / "out", budget=5)


@pytest.mark.long
def test_python_warns_of_a_target_that_is_not_reached(tmp_path, priced):
    path = campaign(tmp_path, **ONE)
    with pytest.warns(UserWarning, match=r"kappa=0.001 is not reached: the budget"):
        given = gfmd_numba.run(path, tmp_path / "missed", until={"kappa": 0.001}, budget="1000 h")
    assert given.attrs["ended"].startswith("not reached: the budget")
    assert gfmd_numba.run(path, tmp_path / "reached", until={"kappa": 0.05}).attrs["ended"] == "reached"


@pytest.mark.long
def test_rounds_taken_one_by_one_are_those_of_a_run(tmp_path):
    """And a run goes on from where the loop was left."""
    path, target = campaign(tmp_path, **ONE), {"kappa": 0.04}
    whole = gfmd_numba.run(path, tmp_path / "whole", until=target)
    assert whole.sizes["round"] > 1
    for first in gfmd_numba.rounds(path, tmp_path / "left", until=target):
        assert first.attrs["ended"] == "not reached: the run stopped before its next round"
        break
    assert first.sizes["round"] == 1
    rest = list(gfmd_numba.rounds(path, tmp_path / "left", until=target))
    assert [each.sizes["round"] for each in rest] == list(range(1, whole.sizes["round"] + 1))
    assert rest[-1].attrs["ended"] == "reached"
    np.testing.assert_array_equal(rest[-1].kappa, whole.kappa)
    np.testing.assert_array_equal(rest[-1].round_error, whole.round_error)


def test_rounds_without_a_target_are_refused_before_they_are_taken(tmp_path):
    with pytest.raises(InputError, match=r"^until: you gave none, and no target in the campaign"):
        gfmd_numba.rounds(campaign(tmp_path, **ONE))
