"""The predicted cost of a campaign, and the tasks it is cut into."""

import time

import numpy as np
import pytest

from gfmd_numba.campaign import cost
from gfmd_numba.campaign.execution import compile_kernels
from gfmd_numba.campaign.plan import plan, tasks
from support.campaigns import campaign
from support.costs import noise, predicted, true_seconds

WIDE = {
    "grid: {hurst: [0.3, 0.8]}": "grid: {hurst: [0.2, 0.4, 0.6, 0.8], reduced_pressure: [0.01, 0.03, 0.1, 0.3]}",
    "eps_f: [1/8, 1/16, 1/32]": "eps_f: [1/8, 1/16, 1/32, 1/64, 1/128, 1/256]",
}


@pytest.fixture
def unmeasured(empty_cache, monkeypatch):
    """A machine on which nothing was measured before, and whose clock tells a law of its own."""
    asked = []

    def law(problem, *_):
        asked.append(problem.identity)
        return true_seconds(problem) * noise(problem)

    monkeypatch.setattr(cost, "_measured", law)
    return asked


def test_a_pilot_predicts_all_others(tmp_path, unmeasured):
    planned = plan(campaign(tmp_path, **WIDE))
    found = predicted(planned)
    assert found.pilot == len(unmeasured) < len(planned.problems) / 2
    errors = [np.log(found.seconds[p.identity] / true_seconds(p)) for p in planned.problems]
    assert np.std(errors) < 0.2
    total = 6 * sum(map(true_seconds, planned.problems))
    assert found.quantile(0.05) < total < found.quantile(0.95)
    assert found.quantile(0.5) == pytest.approx(total, rel=0.2)


def test_what_was_measured_is_remembered(tmp_path, unmeasured):
    planned = plan(campaign(tmp_path, **WIDE))
    first = predicted(planned)
    asked = len(unmeasured)
    assert predicted(planned).seconds == pytest.approx(first.seconds, rel=1e-9)
    assert len(unmeasured) == asked
    memory = next((tmp_path / "cache").rglob("*.json"))
    memory.write_text("damaged")
    predicted(planned)
    assert len(unmeasured) > asked


def test_without_a_budget_nothing_is_measured(tmp_path, unmeasured):
    planned = plan(campaign(tmp_path, **WIDE))
    found = predicted(planned, budget=0.0)
    assert found.pilot == 0
    assert not unmeasured
    assert found.quantile(0.9) / found.quantile(0.1) > 100  # it does not know, and says so


def test_tasks_are_of_about_equal_time_and_hold_every_block_once(tmp_path, unmeasured):
    planned = plan(campaign(tmp_path, **WIDE))
    found = predicted(planned)
    blocks = list(planned.blocks)
    grouped = tasks(blocks, found, 2)
    assert sorted(block.name for task in grouped for block in task) == sorted(block.name for block in blocks)

    def seconds(task):
        return sum(found.seconds[block.problem.identity] * (block.stop - block.first) for block in task)

    total = sum(map(seconds, grouped))
    assert all(seconds(task) <= total / 32 or len(task) == 1 for task in grouped)
    longest = max(seconds((block,)) for block in blocks)
    assert planned.wall_time(found, total, 2) == pytest.approx(total / 2)
    assert planned.wall_time(found, total, 10**6) == pytest.approx(longest)


def test_a_problem_that_fails_in_the_pilot_is_predicted_as_the_others(tmp_path, empty_cache, monkeypatch):
    """And one that takes too long; what is wrong with it is for the run to say."""
    planned = plan(campaign(tmp_path))
    compile_kernels(planned.problems)  # or the time to compile counts as that of a problem
    broken, slow = planned.problems[:2]
    solve = cost.measured

    def poisoned(problem, realisations):
        if problem == broken:
            raise ZeroDivisionError("poison")
        if problem == slow:
            time.sleep(60)
        return solve(problem, realisations)

    monkeypatch.setattr(cost, "measured", poisoned)
    wanted = [10_000] * len(planned.problems)
    found = cost.predict(planned.problems, wanted, 20.0, lambda problems: None, timeout=1.0)
    assert found.pilot == len(planned.problems) - 2
    assert found.seconds.keys() == {problem.identity for problem in planned.problems}
