"""What a design promises is for each group, and the words say for which."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner

from gfmd_numba.campaign import design as accuracy
from gfmd_numba.campaign.plan import plan
from gfmd_numba.cli import main
from gfmd_numba.cli.tables import show_target
from support.campaigns import campaign
from support.command_line import unfolded

FIXED = {"reference:": "fit: {fixed: {eps_c: 1, eps_f: 0.7}}\nreference:"}
SIX = FIXED | {"grid: {hurst: [0.3, 0.8]}": "grid: {hurst: [0.3, 0.5, 0.8], reduced_pressure: [0.01, 0.1]}"}


@pytest.fixture
def patience(monkeypatch):
    """Sets how many seconds a pilot may take."""
    return lambda seconds: monkeypatch.setattr(accuracy, "_SECONDS", seconds)


def test_a_pilot_solves_every_group_it_has_time_for(tmp_path, patience):
    planned = plan(campaign(tmp_path, **SIX))
    patience(1e6)
    found = accuracy.pilot(planned)
    assert (found.n_solved, found.n_groups) == (6, 6)
    assert accuracy.promise(found) == "each of the 6 groups reaches this error with 90 % probability"


def test_without_time_for_all_it_solves_those_that_scatter_most_and_says_so(tmp_path, patience):
    planned = plan(campaign(tmp_path, **SIX))
    patience(0.0)
    found = accuracy.pilot(planned)
    assert (found.n_solved, found.n_groups) == (3, 6)
    assert (found.results["reduced_pressure"] == 0.01).all()  # of light contact there is less, and it scatters more
    for part in ("each of the 3 groups of the pilot, out of 6", "nothing is promised for the others"):
        assert part in accuracy.promise(found)


def test_the_seconds_of_a_pilot_are_those_of_all_groups(tmp_path, empty_cache, patience, monkeypatch):
    planned = plan(campaign(tmp_path, **SIX))
    clock = SimpleNamespace(now=0.0)
    measured = accuracy.measured

    def seconds(problem):
        return 1e-6 * (problem.surface.nodes + 1000) * problem.mean_pressure**0.15

    def timed(problem, realisations):
        clock.now += realisations * seconds(problem)
        return measured(problem, realisations)

    monkeypatch.setattr(accuracy, "measured", timed)
    monkeypatch.setattr(accuracy, "time", SimpleNamespace(thread_time=lambda: clock.now))
    total = sum(map(seconds, planned.problems))
    patience(1e6)
    assert sum(accuracy.pilot(planned).seconds) == pytest.approx(total, rel=1e-9)
    patience(0.0)
    assert sum(accuracy.pilot(planned).seconds) == pytest.approx(total, rel=0.2)


def test_what_a_pilot_of_a_design_measures_is_not_measured_again(tmp_path, empty_cache, monkeypatch):
    planned = plan(campaign(tmp_path, **SIX))
    found = accuracy.pilot(planned)
    monkeypatch.setattr("gfmd_numba.campaign.cost._measured", lambda *_: pytest.fail("it measures again"))
    predicted = planned.predicted_cost(2.0)
    assert predicted.pilot == len(planned.problems)
    assert sum(predicted.seconds.values()) == pytest.approx(sum(found.seconds))


def test_groups_with_the_same_problems_are_solved_once(tmp_path, patience):
    """As those of another Poisson's ratio of a half-space, which then are promised, too."""
    grid = {"grid: {hurst: [0.3, 0.8]}": "grid: {hurst: [0.3, 0.8], poissons_ratio: [0.2, 0.3, 0.4]}"}
    patience(0.0)
    found = accuracy.pilot(plan(campaign(tmp_path, **FIXED | grid)))
    assert (found.n_solved, found.n_groups) == (6, 6)
    assert set(found.results["poissons_ratio"].values) == {0.2}


def test_how_far_a_pilot_is_can_be_watched(tmp_path, patience):
    patience(1e6)
    told = []
    accuracy.pilot(plan(campaign(tmp_path, **SIX)), told.append)
    np.testing.assert_allclose(told, np.arange(1, 7) / 6)


def test_a_plan_with_a_target_shows_the_size_of_its_design(tmp_path):
    path = campaign(tmp_path, **FIXED)
    written = tmp_path / "planned.yaml"
    goal = CliRunner().invoke(main, ["plan", str(path), "--target=8%", "--write", str(written)])
    assert goal.exit_code == 0, goal.output
    after = CliRunner().invoke(main, ["plan", str(written), "--pilot=0"])
    for line in ("simulations ", "memory ", "results "):
        shown = [[each for each in said.output.splitlines() if each.startswith(line)] for said in (goal, after)]
        assert shown[0] == shown[1]
        assert len(shown[0]) == 1
    for line in ("promised      each of the 2 groups", "with 90 % probability below", "of CPU time   contacts"):
        assert line in goal.output


def test_a_missed_target_is_explained(capsys):
    limits = {"kappa_tfc": ("group", [2.0, 2.0]), "kappa_tfc_error": ("group", [0.1, 0.2])}
    missed = xr.Dataset(limits, attrs={"variable": "kappa"})
    show_target(missed, 0.08)
    said = capsys.readouterr().out
    assert "missed by 1 of 2 groups" in said
    assert "with 90 % probability, not with certainty" in unfolded(said)


def test_one_group_is_promised_in_the_singular():
    assert accuracy.promise(SimpleNamespace(n_solved=1, n_groups=1)) == (
        "the group reaches this error with 90 % probability"
    )
