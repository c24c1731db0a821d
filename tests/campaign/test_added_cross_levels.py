"""Cross levels that a run to an accuracy adds to a campaign without any, and names as a file would."""

from dataclasses import replace

import pytest

from gfmd_numba.campaign.plan import plan
from gfmd_numba.campaign.rounds import added, with_cross_levels
from support.campaigns import TINY, campaign
from support.command_line import gfmd

LIMITS = "limits: {eps_c: [1/2, 1/4, 1/8], eps_f: [1/8, 1/16, 1/32]}"
THREE = {LIMITS: "limits: {eps_c: [1, 1/2, 1/8], eps_f: [1/32, 1/8], eps_t: [1/2, 1, 1/4]}"}


def levels_added(folder, changes):
    return with_cross_levels(plan(campaign(folder, **changes))).campaign.limits.crossed


def test_each_pair_of_limits_gets_its_coarsest_cross_level_that_is_not_at_nyquist(tmp_path):
    assert levels_added(tmp_path, THREE) == (
        {"eps_c": 1 / 2, "eps_f": 1 / 8},
        {"eps_c": 1 / 2, "eps_t": 1},
        {"eps_f": 1 / 8, "eps_t": 1},
    )


def test_a_level_without_surfaces_is_in_no_cross_level(tmp_path):
    without = {"realisations: 6": "realisations: {reference: 6, eps_c: [0, 4, 4]}"}
    assert levels_added(tmp_path, without) == ({"eps_c": 1 / 8, "eps_f": 1 / 8},)


def test_a_cross_level_without_whole_waves_gives_way_to_the_next_finer_one(tmp_path):
    odd = {LIMITS: "limits: {eps_f: [1/32, 2/3, 1/8], eps_t: [1, 1/4]}"}  # eps_f = 2/3 and eps_t = 1 make 3/2 waves
    assert levels_added(tmp_path, odd) == ({"eps_f": 2 / 3, "eps_t": 1 / 4},)


def test_a_cross_level_whose_grid_does_not_resolve_a_law_gives_way_in_units_too(tmp_path):
    in_units = {
        "youngs_modulus: 70e9": "youngs_modulus: 70 GPa",
        "scene:": "case_timeout: 2 min\nscene:\n  length: 0.2 mm",
        "{hard_wall: {}}": "{hard_wall: {}, exponential: {work_of_adhesion: 3 kJ/m^2, range: 0.2 um}}",
        "reduced_pressure: 0.05": "pressure: 10 MPa",
    }
    assert levels_added(tmp_path, in_units) == ({"eps_c": 1 / 2, "eps_f": 1 / 32},)


@pytest.mark.parametrize("limits", ["", "limits: {eps_c: [1/2, 1/4, 1/8]}", "limits: {eps_c: [1], eps_f: [1/8]}"])
def test_without_two_limits_nothing_is_added(tmp_path, limits):
    planned = plan(campaign(tmp_path, **{LIMITS: limits}))
    assert with_cross_levels(planned) is planned


def test_cross_levels_that_are_given_stay_alone(tmp_path):
    planned = plan(campaign(tmp_path, **{"1/16, 1/32]}": "1/16, 1/32], cross: [{eps_c: 1/8, eps_f: 1/32}]}"}))
    assert with_cross_levels(planned) is planned


@pytest.mark.parametrize("value", ["1/3", "0.4", "1/16384"])
def test_values_are_written_as_fractions(tmp_path, value):
    cross = f"limits: {{cross: [{{eps_f: {value}, eps_t: 1/8}}]}}"
    bare = plan(campaign(tmp_path, TINY)).document
    found = plan(campaign(tmp_path, TINY.replace("reference:", f"{cross}\nreference:")))
    assert added(found) == ""
    assert added(replace(found, document=bare)) == f"[{{eps_f: {value.replace('0.4', '2/5')}, eps_t: 1/8}}]"


def test_a_plan_without_a_target_adds_nothing(tmp_path):
    said = gfmd("plan", campaign(tmp_path), "--pilot=0")
    assert "cases         10, of which 10 distinct problems" in said.output
    assert "cross" not in said.output
