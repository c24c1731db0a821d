"""Runs to errors of several variables: the one that is furthest from its target decides, and each is told."""

import json

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.analysis import fit_tfc, plot_rounds
from gfmd_numba.campaign import rounds
from gfmd_numba.campaign import run as runs
from gfmd_numba.campaign.file import fitted_variable, load_campaign
from gfmd_numba.campaign.goal import Goal
from gfmd_numba.campaign.run import run_until
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.scene import InputError
from gfmd_numba.theory.exponent_ranges import exponent_ranges
from support.campaigns import campaign, killed_in
from support.command_line import gfmd, unfolded

pytestmark = pytest.mark.usefixtures("laws_that_hold", "undrawn")

KNOWN = "{eps_c: 1.5, eps_f: 0.7}"
ONE = {
    "reference: {": f"fit: {{exponents: free, fixed: {KNOWN}}}\nlevels: only\nreference: {{",
    "grid: {hurst: [0.3, 0.8]}": "",
}
GOAL = Goal(targets={"kappa": 0.03, "kappa_r": 0.06})
HERE = Workers(0)


@pytest.fixture(scope="module")
def reached(tmp_path_factory, laws_that_hold):
    folder = tmp_path_factory.mktemp("several")
    return run_until(campaign(folder, **ONE), GOAL, folder / "out", HERE)


@pytest.mark.long
def test_a_run_ends_with_every_error_that_was_asked_for(reached):
    results, last = gfmd_numba.open_campaign(reached.results), reached.rounds.now
    assert reached.reached
    for variable, target in GOAL.targets.items():
        found = last.errors[variable]
        assert found.reached
        assert found.error * found.factor <= target
    options = {"kappa": json.loads(results.attrs["fit"])} | json.loads(results.attrs["fits_of_targets"])
    for variable, of_fit in options.items():
        fitted = fit_tfc(results, **of_fit)
        error = (fitted[f"{variable}_tfc_error"] / fitted[f"{variable}_tfc"]).item()
        assert error == pytest.approx(last.errors[variable].error)


@pytest.mark.long
def test_what_is_known_of_exponents_is_about_the_variable_that_is_fitted(reached):
    others = json.loads(gfmd_numba.open_campaign(reached.results).attrs["fits_of_targets"])
    assert others["kappa_r"]["fixed"]["eps_c"] == list(exponent_ranges("kappa_r", 1)["eps_c"])
    assert set(others) == {"kappa_r"}


@pytest.mark.long
def test_the_furthest_target_decides(reached):
    for before, now in zip(reached.rounds.rounds, reached.rounds.rounds[1:], strict=False):
        share = {name: found.error * found.factor / GOAL.targets[name] for name, found in before.errors.items()}
        assert share[now.variable] > 1.0
        assert share[now.variable] > 0.8 * max(share.values())  # the factor is that of the surfaces alone


@pytest.mark.long
def test_the_errors_of_each_target_stand_in_the_file(reached):
    results, found = gfmd_numba.open_campaign(reached.results), reached.rounds.rounds
    assert results["target"].values.tolist() == ["kappa", "kappa_r"]
    for variable in GOAL.targets:
        told = results.sel(target=variable)
        for name in ("error", "error_factor", "predicted_error"):
            values = np.array([each.told_of(variable)[name] for each in found], dtype=float)
            np.testing.assert_array_equal(told[f"round_{name}"], values)
    assert results["round_price"].dims == ("round",)
    assert results.attrs["until"] == "kappa=0.03, kappa_r=0.06"
    assert results.attrs["reached"] == "kappa, kappa_r"
    assert json.loads(results.attrs["target"]) == GOAL.targets
    assert rounds.read(reached.results.parent).goal == GOAL


@pytest.mark.long
def test_a_run_that_resumes_decides_as_before(reached, tmp_path):
    """It was killed between the two fits of its last round."""
    with killed_in(runs, "fit_tfc", 2 * len(reached.rounds.rounds) - 1):
        run_until(campaign(tmp_path, **ONE), GOAL, tmp_path / "out", HERE)
    resumed = run_until(campaign(tmp_path, **ONE), GOAL, tmp_path / "out", HERE)
    digests = [gfmd_numba.open_campaign(each.results).attrs["content_sha256"] for each in (resumed, reached)]
    assert digests[0] == digests[1]


@pytest.mark.long
def test_each_target_is_told_and_drawn(tmp_path):
    path, options = campaign(tmp_path, **ONE), ("--until=kappa=5%", "--until=kappa_r=0.01%", "--budget=1000 h")
    done = gfmd("run", path, "-o", tmp_path / "out", "--workers=0", *options)
    said = unfolded(done.stdout)
    assert done.exit_code == 3
    assert "round 0: kappa error " in said
    assert "until kappa to 5.00%: reached until kappa_r to 0.01%: not reached: kappa_r: " in said
    assert "`gfmd fit --variable NAME` shows the limit of kappa_r" in said
    fitted = unfolded(gfmd("fit", tmp_path / "out", "--variable", "kappa_r").stdout)
    assert "kappa_r to 0.01%: not reached" in fitted
    (axis,) = plot_rounds(gfmd_numba.open_campaign(tmp_path / "out")).axes
    labels = {line.get_label() for line in axis.lines}
    assert {r"$\kappa$: target 5 %", r"$\kappa_r$: target 0.01 %"} <= labels


@pytest.mark.long
def test_a_plan_tells_each_target(tmp_path):
    options = ("--target=kappa=3%", "--target=kappa_r=50%")
    said = unfolded(gfmd("plan", campaign(tmp_path, **ONE), "--workers=0", *options).stdout)
    assert "kappa in the limit: error " in said
    assert "kappa_r in the limit: error " in said
    assert "50.00%: reached by the pilot" in said


def test_the_first_target_is_fitted_where_the_file_names_no_variable(tmp_path):
    plain = {key: text for key, text in ONE.items() if key != "reference: {"}
    path = campaign(tmp_path, **plain)
    assert load_campaign(path, {"kappa_r": 0.1, "kappa": 0.1})[0].fit.variable == "kappa_r"
    assert fitted_variable(path) == "kappa"
    named = campaign(tmp_path, **plain, **{"reference: {": "fit: {variable: kappa_counted}\nreference: {"})
    assert load_campaign(named, {"kappa_r": 0.1})[0].fit.variable == "kappa_counted"
    assert fitted_variable(named) == "kappa_counted"
    own = campaign(tmp_path, **plain, **{"reference: {": "target: {kappa_r: 2%, kappa: 3%}\nreference: {"})
    assert fitted_variable(own) == "kappa_r"


def test_a_target_of_a_path_needs_one(tmp_path):
    with pytest.raises(InputError, match=r"target.hysteresis: you gave .*; gfmd allows what a single contact has"):
        load_campaign(campaign(tmp_path, **ONE), {"kappa": 0.1, "hysteresis": 0.1})
