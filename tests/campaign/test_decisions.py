"""Realisations of the next round for campaigns with cross levels: made-up results, no contact is solved."""

import numpy as np
import pytest
import xarray as xr

from gfmd_numba.analysis import UnusableDataError, fit_tfc
from gfmd_numba.campaign import next_round
from gfmd_numba.campaign.goal import Goal
from gfmd_numba.campaign.next_round import Known, after, decide, judge
from gfmd_numba.campaign.rounds import Round, Rounds
from support.cross_levels import LEVELS, crossed
from support.synthetic_campaigns import ALPHA, CROSS, campaign, noisy

pytestmark = pytest.mark.usefixtures("laws_that_hold")

DEAR = {"eps_c": 1 / 512, "eps_t": 1 / 64}
HELD = 40  # realisations of every case so far


def results(dataset, seed=0):
    """Results of a pilot as a file has them."""
    drawn = noisy(dataset, np.random.default_rng(seed))
    nodes = (2 / (drawn["eps_c"] * drawn["eps_f"] * drawn["eps_t"])).values.astype(int)
    n_cases = drawn.sizes["case"]
    counts, flat = np.full(n_cases, drawn.sizes["realisation"]), np.ones(n_cases, dtype=int)
    drawn = drawn.assign_coords(nx=("case", nodes), dimension=("case", flat), realisations=("case", counts))
    return drawn.assign(n_transforms=(("case", "realisation"), np.full(drawn["kappa"].shape, 40)))


def decided(found, target, fixed=ALPHA, most=np.inf):
    known = Known(found, fit_tfc(found, fixed=fixed), "kappa", fixed)
    return decide(known, judge(known), target, most)


@pytest.mark.long
def test_every_cross_level_has_realisations_of_its_own_wherever_it_stands():
    """A dear one that tells little keeps those of the pilot, also where cheap ones follow it."""
    found = results(crossed(CROSS[0], DEAR, *CROSS[1:]))
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


def test_a_cross_level_of_several_references_has_one_number_of_realisations():
    """An eps of the grid gives each of its values a reference, and cross levels of the same name."""
    fine = crossed({"eps_f": 1 / 512, "eps_t": 1})
    fine = fine.isel(case=fine["limit"].values != "eps_c")
    coarse = fine.copy(deep=True).assign_coords(eps_c=2 * fine["eps_c"] / 4)
    grid = xr.concat([fine, coarse], "case")
    grid["eps_c"].attrs = fine["eps_c"].attrs
    grid["case_id"] = ("case", [f"case-{i}" for i in range(grid.sizes["case"])])
    found = results(grid)
    counts = decided(found, 0.03, {"eps_f": 0.6, "eps_t": 1.0}).realisations
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
    with pytest.raises(UnusableDataError, match=r"exponents are not known better than that; .* narrower ranges"):
        decided(one, 0.00005, {"eps_f": (0.1, 4)})
    with pytest.raises(UnusableDataError) as advised:
        decided(one, 0.00005, {})
    assert str(advised.value).endswith(
        "lie in our campaigns, `fit: {fixed: {eps_f: [0.3, 2]}}` (above all that of eps_f)"
    )
    with pytest.raises(
        UnusableDataError, match=r"error of 0.014%; gfmd allows a larger target, or levels further from"
    ):
        decided(one, 0.00005, {"eps_f": 0.6})


@pytest.mark.long
def test_a_target_that_cross_levels_nearly_reach_asks_for_no_others():
    found = results(crossed(*CROSS))
    for target, told in ((0.0001, "1000000 realisations of every case would leave"), (0.0003, "more than 1000000")):
        with pytest.raises(UnusableDataError, match=told) as refused:
            decided(found, target)
        assert str(refused.value).endswith("; gfmd allows a larger target, or levels further from the reference")


def test_a_run_ends_with_the_advice_that_helps():
    found = results(crossed()).assign_attrs(cpu_seconds=1.0)
    first = Round(realisations=(HELD,) * found.sizes["case"], is_last=False)
    state = Rounds(goal=Goal(targets={"kappa": 0.001}), campaign_sha256="", rounds=(first,))
    ended = after(state, [Known(found, fit_tfc(found, fixed=ALPHA), "kappa", ALPHA)]).ended
    assert ended.startswith("not reached: 1000000 realisations of every case would leave an error of")
    assert ended.endswith("a cross level for every pair of limits under `limits: {cross: ...}`")
