"""Levels that a run chooses by itself: those it begins with, and finer ones until its target is reached."""

import json

import numpy as np
import pytest
import yaml

import gfmd_numba
from gfmd_numba.campaign import next_round
from gfmd_numba.campaign import run as runs
from gfmd_numba.campaign.file import load_campaign
from gfmd_numba.campaign.goal import Goal
from gfmd_numba.campaign.limits import STEP, finer_levels, first_levels, first_realisations, limit_of, limits_around
from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.rounds import pilot_plan
from gfmd_numba.campaign.run import run_until
from gfmd_numba.campaign.status import campaign_in, verify
from gfmd_numba.campaign.workers import Workers
from gfmd_numba.scene import InputError
from support.campaigns import killed_in

SCENE = {
    "body": {"poissons_ratio": 0.33},
    "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
    "interface": {"hard_wall": {}},
    "loading": {"reduced_pressure": 0.05},
}
SHORT = {"name": "short", "seed": 1, "scene": SCENE, "target": {"kappa": "5%"}}
COARSE = SHORT | {
    "reference": {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2},
    "limits": {"eps_f": [1 / 2, 1 / 4], "eps_t": [1], "cross": [{"eps_f": 1 / 4, "eps_t": 1}]},
    "fit": {"exponents": "free", "fixed": {"eps_f": [0.3, 2], "eps_t": 1}},
}
GOAL = Goal(targets={"kappa": 0.1})
HERE = Workers(0)


def rounds_of(outcome):
    return [(each.levels, each.realisations, each.predicted_error, each.price) for each in outcome.rounds.rounds]


def digest(outcome):
    return gfmd_numba.open_campaign(outcome.results).attrs["content_sha256"]


@pytest.fixture(scope="module")
def refined(tmp_path_factory):
    return run_until(COARSE, GOAL, tmp_path_factory.mktemp("refined") / "out", HERE)


@pytest.mark.parametrize("dimension", [1, 2])
def test_a_campaign_of_a_target_alone_begins_with_first_levels(dimension):
    found, document = load_campaign(SHORT | {"scene": SCENE | {"dimension": dimension}})
    reference, *others = first_levels(dimension)
    assert found.target == {"kappa": 0.05}
    assert tuple(found.reference.model_dump().values()) == reference
    assert found.limits == limits_around(reference, others)
    assert found.n_cases == len(first_levels(dimension))
    fixed = found.fit.model_dump()["fixed"]
    assert fixed["eps_c"] is not None
    assert fixed["eps_f"] is None  # theory gives its law
    assert yaml.safe_load(document.text).keys() == SHORT.keys()  # what is chosen is not in the user's file


@pytest.mark.parametrize("dimension", [1, 2])
def test_first_levels_lie_around_the_cheapest_reference_of_the_finest_waves(dimension):
    reference, *others = first_levels(dimension)
    step, (c, f, t) = STEP[dimension], reference
    assert {level[0] for level in others} == {c, c / 2, c / 4}
    assert {level[1] for level in others} == {f, step * f, step**2 * f}
    assert {level[2] for level in others} == {2 * t, t, t / 2}
    assert sum(1 / np.prod(level) > 2 / np.prod(reference) for level in others) == 0  # none costs far more


@pytest.mark.parametrize("given", [{"scene": 3.0}, {"grid": [1.5, 4.0]}])
def test_the_longest_waves_of_anisotropic_maps_fit_the_first_levels(given):
    anisotropic = SCENE["roughness"] | ({"anisotropy": given["scene"]} if "scene" in given else {})
    grid = {"grid": {"anisotropy": given["grid"]}} if "grid" in given else {}
    found, _ = load_campaign(SHORT | {"scene": SCENE | {"dimension": 2, "roughness": anisotropic}} | grid)
    coarsest = max(placed.discretisation.eps_t for placed in found.discretisations())
    assert coarsest == 1 / 4


@pytest.mark.parametrize(
    ("body", "grid", "eps_t"),
    [
        ({"aspect_ratio": 0.1}, {}, 1 / 16),
        ({"aspect_ratio": 0.001}, {}, 1 / 64),
        ({}, {"aspect_ratio": [float("inf"), 0.05]}, 1 / 32),
        ({}, {}, 1 / 4),
    ],
)
def test_no_layer_is_lower_than_the_longest_wave_at_first(body, grid, eps_t):
    scene = SCENE | {"body": SCENE["body"] | body}
    found, _ = load_campaign(SHORT | {"scene": scene} | ({"grid": grid} if grid else {}))
    assert found.reference.eps_t == eps_t


def test_a_layer_on_a_base_is_as_thin_as_it_is():
    layers = [{"height": "0.3 mm", "youngs_modulus": 2.0, "poissons_ratio": 0.3}]
    layered = {"layers": layers, "base": {"youngs_modulus": 1.0, "poissons_ratio": 0.3}}
    found, _ = load_campaign(SHORT | {"scene": SCENE | {"body": layered, "length": "10 mm"}})
    assert found.scene.thinnest_layer == pytest.approx(0.03)
    assert found.reference.eps_t == 1 / 64


@pytest.mark.long
def test_the_limit_of_a_thin_slab_is_that_of_the_half_space(tmp_path):
    """The height is a share of the period, so that the slab becomes thick where eps_t goes to 0."""
    scene = SCENE | {"body": {"poissons_ratio": 0.33, "aspect_ratio": 0.1}, "loading": {"reduced_pressure": 0.007}}
    scene["roughness"] = SCENE["roughness"] | {"hurst": 0.3}
    results = gfmd_numba.run({"name": "slab", "seed": 5, "scene": scene, "target": {"kappa": "5%"}}, tmp_path / "out")
    fit = gfmd_numba.fit_tfc(results, **json.loads(results.attrs["fit"]))
    assert results.attrs["ended"] == "reached"
    assert fit["kappa_tfc_low"].item() < 2.851 < fit["kappa_tfc_high"].item()  # docs/results.md, of half-spaces


def test_a_campaign_without_a_target_needs_levels():
    without = {key: value for key, value in SHORT.items() if key != "target"} | {"realisations": 2}
    with pytest.raises(InputError, match=r"reference: you gave .*; gfmd (allows|needs) .* a `target` like"):
        load_campaign(without)


@pytest.mark.parametrize("given", [0.05, "5%", {}, {"kappa": 0}, {"kappa": "150%"}, {"area": 0.1}])
def test_what_is_no_target_is_refused(given):
    with pytest.raises(InputError, match=r"target.*: you gave .*; gfmd allows "):
        load_campaign(SHORT | {"target": given})


@pytest.mark.parametrize("period", [1.0, 1 / 2, 1 / 4, 1 / 16])
@pytest.mark.parametrize("others", [{2.0, 1 / 2}, {1 / 2}, {2.0}, {4.0, 2.0}])
def test_no_finer_level_has_a_period_below_its_longest_wave(period, others):
    """Whatever levels a user gives: their longest waves may fit the period just once."""
    reference = (1 / 2, 1 / 64, period)
    given = [(*reference[:2], factor * period) for factor in others if factor * period <= 1.0]
    levels = [reference, (1 / 2, 1 / 16, period), (1 / 4, *reference[1:]), *given]
    for limit in ("eps_f", "eps_t", "eps_f", "eps_c", "eps_f"):
        levels = finer_levels(levels, limit, 4.0)
        assert max(level[2] for level in levels) == max([period, *(level[2] for level in given)])
        limits_around(levels[0], levels[1:])


def test_a_level_belongs_to_the_limit_in_which_it_differs_and_to_none_alone_if_there_are_several():
    reference = (1 / 2, 1 / 64, 1 / 4)
    levels = {"reference": reference, "eps_f": (1 / 2, 1 / 16, 1 / 4), "cross": (1 / 4, 1 / 16, 1 / 4)}
    assert {limit: limit_of(reference, level) for limit, level in levels.items()} == {each: each for each in levels}


@pytest.mark.parametrize("levels", [3, 18])
def test_a_pilot_of_many_cases_has_as_many_surfaces_more_as_tell_its_errors(levels):
    """Eight more than there are cases, and 20 at least."""
    eps = {"eps_c": 1 / 2, "eps_f": 1 / 64, "eps_t": 1 / 2}
    given = {"eps_f": [1 / (8 + 2 * i) for i in range(levels)]}
    piloted = pilot_plan(plan(COARSE | {"reference": eps, "limits": given, "fit": {}}), GOAL)
    assert len(piloted.cases) == levels + 1
    assert min(case.realisations for case in piloted.cases) == max(20, levels + 1 + 8)


@pytest.mark.parametrize(("other", "expected"), [(1 / 2, 1 / 2), (1 / 8, 1 / 8)])
def test_a_finer_eps_f_is_seen_at_a_shorter_period_if_there_is_one_and_else_at_a_longer_one(other, expected):
    """The shorter one costs less."""
    levels = [(1 / 2, 1 / 64, 1 / 4), (1 / 2, 1 / 16, 1 / 4), (1 / 2, 1 / 64, other)]
    new = set(finer_levels(levels, "eps_f", 4.0)) - set(levels)
    assert {level for level in new if level[1] == 1 / 256} == {(1 / 2, 1 / 256, 1 / 4), (1 / 2, 1 / 256, expected)}


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize("limit", ["eps_c", "eps_f", "eps_t"])
def test_finer_levels_keep_the_old_ones(limit, dimension):
    old = first_levels(dimension)
    new = finer_levels(old, limit, STEP[dimension])
    axis = ["eps_c", "eps_f", "eps_t"].index(limit)
    assert set(old) < set(new)
    assert len(set(new)) == len(new)
    assert min(level[axis] for level in new) < min(level[axis] for level in old)
    assert (new[0] == old[0]) == (limit != "eps_f")
    if limit == "eps_f":  # its correction is told by a new reference, for which the old one is a level
        assert new[0][1] < min(level[1] for level in old)
        assert limit_of(new[0], old[0]) == "eps_f"
    number = dict(zip(new, first_realisations(new, dimension), strict=True))
    assert min(number.values()) == 20
    assert number[max(new, key=np.prod)] == max(number.values()) <= 400


@pytest.mark.long
def test_a_run_adds_finer_levels_until_its_target_is_reached(refined):
    first, *_, last = refined.rounds.rounds
    assert refined.reached
    assert last.errors["kappa"].error <= 0.1
    assert set(first.levels[0]) < set(last.levels[0])
    before = refined.rounds.rounds[:-1]
    finer = [
        after for each, after in zip(before, refined.rounds.rounds[1:], strict=True) if each.levels != after.levels
    ]
    assert not any(each.is_last or each.predicted_error for each in finer)  # nobody knows what new levels will tell
    assert last.levels[0][0][1] < first.levels[0][0][1]
    results = gfmd_numba.open_campaign(refined.results)
    assert results["is_reference"].values.tolist() == [True] + [False] * (len(last.levels[0]) - 1)
    assert results["eps_f"].values[0] == last.levels[0][0][1]
    asked = results["round_realisations"].values
    assert (asked[0] > 0).sum() == len(first.levels[0])
    assert (asked[-1] == results["realisations"].values).all()
    found, _ = campaign_in(refined.results.parent)
    assert [case.realisations for case in found.cases] == list(last.realisations)
    assert (verify(refined.results.parent).missing, verify(refined.results.parent).foreign) == (0, [])


@pytest.mark.long
def test_groups_that_need_no_finer_levels_get_surfaces_in_the_same_round(tmp_path, monkeypatch):
    monkeypatch.setattr(next_round, "_MOST", 2)
    goal = GOAL.model_copy(update={"targets": {"kappa": 0.02}})
    outcome = run_until(COARSE | {"grid": {"hurst": [0.9, 0.3]}}, goal, tmp_path / "out", HERE)
    before, last = outcome.rounds.rounds[-2:]
    assert (last.levels[0] == before.levels[0], last.levels[1] == before.levels[1]) == (False, True)
    counts = [dict(zip(each.cases, each.realisations, strict=True)) for each in (before, last)]
    assert any(counts[1][case] > counts[0][case] for case in before.cases if case[0] == 1)
    assert all(counts[1][case] >= counts[0][case] for case in before.cases)


@pytest.mark.long
def test_groups_of_the_same_problems_cost_what_one_costs(refined, tmp_path):
    twice = run_until(COARSE | {"grid": {"poissons_ratio": [0.3, 0.33]}}, GOAL, tmp_path / "out", HERE)
    once, both = ([each.price for each in outcome.rounds.rounds] for outcome in (refined, twice))
    assert 1 < len(both) == len(once)
    assert both == pytest.approx(once)


@pytest.mark.long
def test_levels_only_adds_none_and_says_what_is_in_the_way(tmp_path):
    outcome = run_until(COARSE | {"levels": "only"}, GOAL, tmp_path / "out", HERE)
    assert {each.levels for each in outcome.rounds.rounds} == {outcome.rounds.rounds[0].levels}
    assert outcome.rounds.ended.startswith("not reached: the distance from the finest levels to the limit leaves ")
    assert "mostly that of eps_f" in outcome.rounds.ended
    assert gfmd_numba.open_campaign(outcome.results).attrs["ended"] == outcome.rounds.ended


@pytest.mark.long
def test_finer_levels_stay_within_a_budget(refined, tmp_path, monkeypatch):
    monkeypatch.setattr(runs, "seconds_per_price", lambda planned, directory: 1.0)
    first, *_, last = (each.price for each in refined.rounds.rounds)
    outcome = run_until(COARSE, GOAL.model_copy(update={"budget": 1.05 * first}), tmp_path / "out", HERE)
    assert outcome.rounds.ended.startswith("not reached: the budget is too small")
    assert outcome.rounds.now.price <= 1.05 * first < last


@pytest.mark.long
def test_a_run_that_was_killed_chooses_the_same_levels(refined, tmp_path):
    """In the fit of the round after the pilot, whose decision is not made yet."""
    with killed_in(runs, "fit_tfc", 1):
        run_until(COARSE, GOAL, tmp_path / "out", HERE)
    resumed = run_until(COARSE, GOAL, tmp_path / "out", HERE)
    assert rounds_of(resumed) == rounds_of(refined)
    assert digest(resumed) == digest(refined)
