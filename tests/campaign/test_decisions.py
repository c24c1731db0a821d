"""Realisations of the next round for campaigns with cross levels: made-up results, no contact is solved."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from gfmd_numba.analysis import UnusableDataError, fit_tfc
from gfmd_numba.campaign import next_round
from gfmd_numba.campaign.goal import Goal
from gfmd_numba.campaign.next_round import (
    Fit,
    Fitted,
    Known,
    UnknownExponentsError,
    _Doubt,
    _doubts,
    _hopeless,
    after,
    decide,
    judge,
)
from gfmd_numba.campaign.rounds import Round, Rounds
from support.cross_levels import LEVELS, crossed
from support.synthetic_campaigns import ALPHA, CROSS, campaign, noisy

pytestmark = pytest.mark.usefixtures("laws_that_hold")

DEAR = {"eps_c": 1 / 512, "eps_t": 1 / 64}
HELD = 40  # realisations of every case so far
EXACT = Fit("kappa", ALPHA)


def results(dataset, seed=0):
    """Results of a pilot as a file has them."""
    drawn = noisy(dataset, np.random.default_rng(seed))
    nodes = (2 / (drawn["eps_c"] * drawn["eps_f"] * drawn["eps_t"])).values.astype(int)
    n_cases = drawn.sizes["case"]
    counts, flat = np.full(n_cases, drawn.sizes["realisation"]), np.ones(n_cases, dtype=int)
    drawn = drawn.assign_coords(nx=("case", nodes), dimension=("case", flat), realisations=("case", counts))
    return drawn.assign(n_transforms=(("case", "realisation"), np.full(drawn["kappa"].shape, 40)))


def decided(found, target, fit=EXACT, most=np.inf):
    known = Known(found, fit)
    return decide(known, judge(known, fit_tfc(found, fixed=fit.fixed)), target, most)


@pytest.mark.long
def test_every_cross_level_has_realisations_of_its_own_wherever_it_stands():
    """A dear one that tells little keeps those of the pilot, whatever the order of the cases."""
    for levels in ((*CROSS, DEAR), (DEAR, *CROSS)):
        found = results(crossed(*levels))
        counts = np.array(decided(found, 0.03).realisations)
        dear = (found["eps_c"] == DEAR["eps_c"]).values
        cheap = (found["limit"] == "cross").values & ~dear
        assert counts[dear] == [HELD]
        assert (counts >= HELD).all()
        assert (counts[cheap] > HELD).any()


@pytest.mark.long
def test_the_order_of_cases_hardly_changes_the_price():
    """The search for the best numbers goes level after level, and ends near the best ones."""
    found = results(crossed(*CROSS))
    order = np.random.default_rng(1).permutation(found.sizes["case"])
    one, other = (decided(each, 0.015) for each in (found, found.isel(case=order)))
    assert one.price == pytest.approx(other.price, rel=0.1)
    assert one.predicted_error == pytest.approx(other.predicted_error, rel=0.05)


def test_a_round_makes_up_for_an_error_that_was_larger_than_predicted():
    """Only after the pilot, whose error falls as laws are told apart."""
    found = results(crossed(*CROSS))
    known = Known(found, EXACT)
    judged = judge(known, fit_tfc(found, fixed=ALPHA))
    missed = replace(judged, predicted=0.7 * judged.sure_error)
    pilot, later = (decide(known, missed, 0.8 * judged.error, after_pilot=first) for first in (True, False))
    assert later.predicted_error < 0.8 * pilot.predicted_error


def test_a_round_is_judged_by_its_worst_group():
    found = results(campaign((0.3, 0.8), realisations=HELD, cross=CROSS))
    alone = [found.isel(case=found["hurst"].values == hurst) for hurst in (0.3, 0.8)]
    both, first, second = (judge(Known(each, EXACT), fit_tfc(each, fixed=ALPHA)) for each in (found, *alone))
    assert first.predicted != pytest.approx(second.predicted, rel=1e-2)
    assert both.predicted == pytest.approx(max(first.predicted, second.predicted), rel=1e-2)
    assert both.error == pytest.approx(max(first.error, second.error), rel=1e-2)


def test_laws_are_judged_at_the_worst_step_of_a_path():
    found = results(campaign((0.3, 0.8), realisations=HELD, cross=CROSS))
    fitted, known = fit_tfc(found, fixed=ALPHA).isel(group=[0, 1, 0]), Known(found, EXACT)
    fitted["extrapolation_error"].loc[{"limit": "eps_f"}] = [0.05, 0.1, 0.02]
    steps = [_doubts(Fitted(known, fitted.isel(group=[group])), 1)[0] for group in range(3)]
    (path,) = _doubts(Fitted(known, fitted), 1)
    assert steps[1].size > 1.01 * max(steps[0].size, steps[2].size)
    assert path == replace(steps[1], error=max(step.error for step in steps))
    assert _doubts(Fitted(known, fitted), 3) == steps


def test_groups_that_keep_their_levels_aim_at_what_their_laws_leave(monkeypatch):
    found, seen = results(campaign((0.3, 0.8), realisations=HELD, cross=CROSS)), []
    fitted, known = fit_tfc(found, fixed=ALPHA), Known(found, EXACT)
    monkeypatch.setattr(next_round, "_decision", lambda state, standing, aim, most: seen.append(aim))
    eps = zip(*(found[name].values.tolist() for name in ("eps_c", "eps_f", "eps_t")), strict=True)
    level = list(dict.fromkeys(eps))
    levels = (tuple(level), tuple(level))
    first = Round(realisations=(HELD,) * found.sizes["case"], is_last=False, levels=levels)
    state = Rounds(goal=Goal(targets={"kappa": 0.05}), campaign_sha256="", rounds=(first,))
    doubts = [_Doubt(0.2, "eps_f", 0.1, 0.2), _Doubt(0.03, "eps_f", 0.03, 0.1)]
    standing = next_round._Standing(known, fitted, 0.05, judge(known, fitted), doubts, None)
    finer = (levels[0][:-1], levels[1])  # of the first group
    assert next_round._for_the_others(state, standing, finer, 1e9) == ({}, 0.0)
    assert seen == [pytest.approx(0.04)]


def test_surfaces_aim_at_what_the_least_known_law_leaves(monkeypatch):
    found = results(campaign((0.3, 0.8), realisations=HELD, cross=CROSS))
    fitted, known, aims = fit_tfc(found, fixed=ALPHA), Known(found, EXACT), []
    monkeypatch.setattr(next_round, "_with_another", lambda state, group, aim, of_laws: aims.append((aim, of_laws)))
    doubts = [_Doubt(size, "eps_f", size, 0.1) for size in (0.01, 0.03)]
    first = Round(realisations=(HELD,) * found.sizes["case"], is_last=False)
    state = Rounds(goal=Goal(targets={"kappa": 0.05}), campaign_sha256="", rounds=(first,))
    standing = next_round._Standing(known, fitted, 0.05, judge(known, fitted), doubts, None)
    next_round._decided(state, standing, 1.0, may_refine=False)
    assert aims == [(pytest.approx(0.04), 0.03)]


def test_levels_become_finer_at_once_where_laws_leave_most_of_the_target_open(monkeypatch):
    found = results(campaign((0.3, 0.8), realisations=HELD, cross=CROSS))
    fitted, known = fit_tfc(found, fixed=ALPHA), Known(found, EXACT)
    monkeypatch.setattr(next_round, "_refined", lambda state, group, most: "finer levels")
    monkeypatch.setattr(next_round, "_with_another", lambda *given: pytest.fail("no surfaces mend this"))
    doubts = [_Doubt(size, "eps_f", size, 0.1) for size in (0.01, 0.04)]
    first = Round(realisations=(HELD,) * found.sizes["case"], is_last=False)
    state = Rounds(goal=Goal(targets={"kappa": 0.05}), campaign_sha256="", rounds=(first,))
    standing = next_round._Standing(known, fitted, 0.05, judge(known, fitted), doubts, None)
    assert next_round._decided(state, standing, 1.0, may_refine=True) == "finer levels"


def test_cases_of_a_round_are_numbered_unless_it_has_levels_of_its_own():
    assert Round(realisations=(3, 4), is_last=False).cases == [0, 1]
    level = (0.25, 0.1, 0.5)
    assert Round(realisations=(3,), is_last=False, levels=((level,),)).cases == [(0, level)]


@pytest.mark.parametrize(("of_levels", "cheaper"), [(13.0, True), (11.0, False)])
def test_surfaces_come_first_if_levels_add_more_than_half_of_their_price(of_levels, cheaper):
    one = {"realisations": (1,), "is_last": True}
    surfaces, levels = (
        Rounds(goal=Goal(targets={"kappa": 0.01}), campaign_sha256="", rounds=(Round(**one, **prices),))
        for prices in ({"price": 14.0, "target_price": 14.0}, {"price": of_levels})
    )
    assert next_round._is_cheaper(surfaces, levels, spent=10.0) is cheaper
    assert not next_round._is_cheaper(surfaces.ending("in vain"), levels, spent=10.0)
    unknown = surfaces.now.model_copy(update={"target_price": None})
    assert not next_round._is_cheaper(surfaces.model_copy(update={"rounds": (unknown,)}), levels, spent=10.0)


def test_a_round_is_a_quarter_dearer_than_all_before():
    found = results(crossed(*CROSS))
    known = Known(found, EXACT)
    now = judge(known, fit_tfc(found, fixed=ALPHA)).sure_error
    assert decided(found, 1.5 * now).price >= 1.25 * known.whole_price(known.held)


@pytest.mark.parametrize(("by", "ends"), [(1.0, True), (0.001, False)])
def test_one_group_that_contradicts_a_fixed_exponent_ends_a_run(by, ends):
    """By a share of its limit that counts against the target."""
    found = results(campaign((0.3, 0.8), realisations=HELD, cross=CROSS)).assign_attrs(cpu_seconds=1.0)
    fitted = fit_tfc(found, fixed=ALPHA)
    fitted["contradiction"].loc[{"limit": "eps_f"}] = [0.0, by]
    first = Round(realisations=(HELD,) * found.sizes["case"], is_last=False)
    state = Rounds(goal=Goal(targets={"kappa": 0.001}), campaign_sha256="", rounds=(first,))
    ended = after(state, [Fitted(Known(found, EXACT), fitted)]).ended
    assert ("the levels contradict the fixed eps_f: 0.6" in ended) == ends


@pytest.mark.parametrize("rounds", [2, 3])
def test_a_limit_of_zero_is_told_after_two_rounds_more_than_the_pilot(rounds):
    found = results(crossed(*CROSS)).assign_attrs(cpu_seconds=1.0)
    fitted = fit_tfc(found, fixed=ALPHA)
    fitted["kappa_tfc_error"] = 0.6 * fitted["kappa_tfc"]
    each = Round(realisations=(HELD,) * found.sizes["case"], is_last=False)
    state = Rounds(goal=Goal(targets={"kappa": 0.01}), campaign_sha256="", rounds=(each,) * rounds)
    ended = after(state, [Fitted(Known(found, EXACT), fitted)]).ended or ""
    assert ("the limit of kappa is 0 within two standard errors" in ended) is (rounds > 2)


def test_a_cross_level_of_several_references_has_one_number_of_realisations():
    """An eps of the grid gives each of its values a reference, and cross levels of the same name."""
    fine = crossed({"eps_f": 1 / 512, "eps_t": 1})
    fine = fine.isel(case=fine["limit"].values != "eps_c")
    coarse = fine.copy(deep=True).assign_coords(eps_c=2 * fine["eps_c"] / 4)
    grid = xr.concat([fine, coarse], "case")
    grid["eps_c"].attrs = fine["eps_c"].attrs
    grid["case_id"] = ("case", [f"case-{i}" for i in range(grid.sizes["case"])])
    found = results(grid)
    counts = decided(found, 0.03, Fit("kappa", {"eps_f": 0.6, "eps_t": 1.0})).realisations
    assert (found["limit"] == "cross").sum() == 2
    assert len(set(np.array(counts)[(found["limit"] == "cross").values])) == 1


@pytest.mark.long
def test_interactions_that_no_cross_level_tells_ask_for_cross_levels():
    """Narrower ranges would not help."""
    for levels in ((), CROSS[:1]):
        with pytest.raises(UnusableDataError, match="no cross level tells whether corrections add up"):
            decided(results(crossed(*levels)), 0.001)
    assert decided(results(crossed(*CROSS)), 0.01).target_price > 0


@pytest.mark.long
def test_exponents_that_no_surfaces_tell_ask_for_narrower_ranges():
    one = results(campaign(levels={"eps_f": LEVELS["eps_f"]}, coefficients={"eps_f": 6.0}, realisations=HELD))
    with pytest.raises(UnknownExponentsError, match=r"exponents are not known better than that; .* narrower ranges"):
        decided(one, 0.00005, Fit("kappa", {"eps_f": (0.1, 4)}))
    with pytest.raises(UnknownExponentsError) as advised:
        decided(one, 0.00005, Fit("kappa", {}))
    assert str(advised.value).endswith("lie in our campaigns, `fit: {fixed: {eps_f: [0.3, 2]}}`")
    with pytest.raises(
        UnusableDataError, match=r"error of 0.014%; gfmd allows a larger target, or levels further from"
    ):
        decided(one, 0.00005, Fit("kappa", {"eps_f": 0.6}))


def test_a_target_that_cross_levels_nearly_reach_asks_for_no_others():
    found = results(crossed(*CROSS))
    for target, told in ((0.0001, "1000000 realisations of every case would leave"), (0.0003, "more than 1000000")):
        with pytest.raises(UnusableDataError, match=told) as refused:
            decided(found, target)
        assert str(refused.value).endswith("; gfmd allows a larger target, or levels further from the reference")


def test_a_round_makes_the_best_of_a_budget():
    found = results(crossed(*CROSS))
    free = decided(found, 0.01)
    known = Known(found, EXACT)
    spent = known.whole_price(known.held)
    most = (spent + free.price) / 2
    bounded = decided(found, 0.01, most=most)
    assert spent < 0.8 * most < bounded.price <= most
    assert bounded.predicted_error > free.predicted_error
    assert (bounded.is_last, bounded.target_price) == (True, free.target_price)
    assert spent < free.price <= 4.0 * spent < free.target_price  # no round is much larger than all before


def test_the_group_that_leaves_most_open_says_why_levels_do_not_suffice():
    doubts = [_Doubt(size, "eps_f", 0.0, size) for size in (0.01, 0.2, np.inf)]
    fitted = xr.Dataset({"message": ("group", ["", "", ""]), "fit_status": ("group", ["ok"] * 3)})
    assert "leaves 20.00% open, mostly that of eps_f" in _hopeless(fitted, doubts, False, 0.1)
    assert _hopeless(fitted, doubts[:1], False, 0.1) == ""


def test_a_run_ends_with_the_advice_that_helps():
    found = results(crossed()).assign_attrs(cpu_seconds=1.0)
    first = Round(realisations=(HELD,) * found.sizes["case"], is_last=False)
    state = Rounds(goal=Goal(targets={"kappa": 0.001}), campaign_sha256="", rounds=(first,))
    ended = after(state, [Fitted(Known(found, EXACT), fit_tfc(found, fixed=ALPHA))]).ended
    assert ended.startswith("not reached: 1000000 realisations of every case would leave an error of")
    assert ended.endswith("a cross level for every pair of limits under `limits: {cross: ...}`")
