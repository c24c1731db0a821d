"""What the distance from the finest level adds to the error of a limit, and what rival fits add to it."""

import re
from dataclasses import replace

import numpy as np
import pytest

from gfmd_numba.analysis import fit_tfc, limit_errors
from gfmd_numba.analysis.laws import choices, unseen_slope
from gfmd_numba.analysis.limit_errors import _without, expected_extrapolation_errors, rivals
from gfmd_numba.analysis.selection import groups_to_fit
from support.doubts import without_doubts
from support.synthetic_campaigns import ALPHA, CROSS, TFC, WANING_OF_KAPPA, campaign, noisy
from support.unseen_slope import factor, of_unseen_slope

COARSE, FINE = ([1 / (first * 4**level) for level in range(5)] for first in (4, 64))
OF_TWO_POWERS = (0.3, 2.0)  # range of exponents that the user gives


def of(levels, law, realisations=30):
    """Made-up campaign of one limit, whose kappa_r goes to its limit by a law."""
    dataset = campaign(levels={"eps_f": levels}, coefficients={}, realisations=realisations)
    moved = dataset["kappa"] + law(dataset["eps_f"])
    return dataset.assign(kappa=moved).rename(kappa="kappa_r")


def unseen(eps_f):
    """The correction by the unseen slope at H = 0.8 and p* = 0.007."""
    law = unseen_slope(0.8, 0.007)
    cut, tail = (parameter.middle for parameter in law.parameters)
    return TFC[0.8] * eps_f.copy(data=law.value(eps_f.values, np.array([[cut, tail]]))[0])


def scattered(dataset, seed):
    noise = noisy(dataset.rename(kappa_r="kappa"), np.random.default_rng(seed), spread=0.05, own=0.002)
    return noise.rename(kappa="kappa_r")


def part(fit, source):
    return fit["error_budget"].sel(source=source).item()


def test_the_doubt_grows_with_the_distance():
    """For a power it is in proportion to it, whatever the surfaces."""
    doubts = []
    for levels in (FINE, COARSE):
        for size in (1.0, 3.0):
            fit = fit_tfc(of(levels, lambda eps: size * eps**0.5), "kappa_r", fixed={"eps_f": 0.5})  # noqa: B023
            at = fit.sel(limit="eps_f")
            finest = min(min(levels), 1 / 1024)
            assert at["finest_eps"].item() == finest
            assert at["extrapolated"].item() == pytest.approx(size * finest**0.5, rel=1e-6)
            assert fit["kappa_r_tfc_error"].item() == pytest.approx(at["extrapolation_error"].item(), rel=1e-3)
            assert part(fit, "extrapolation") == pytest.approx(at["extrapolation_error"].item())
            assert np.isnan(fit["extrapolated"].sel(limit="eps_c").item())
            doubts.append(at["extrapolation_error"].item() / finest**0.5)
    np.testing.assert_allclose(np.array(doubts) / doubts[0], [1.0, 3.0, 1.0, 3.0], rtol=1e-6)


@pytest.mark.long
def test_from_coarse_levels_the_unseen_slope_is_doubted_as_a_power_is(monkeypatch):
    """Until the finest level is one for which its error was measured."""
    whole = of_unseen_slope(campaign(levels={"eps_f": FINE[:4]}, coefficients={}, realisations=30), 0.8)
    dataset = noisy(whole, np.random.default_rng(0), spread=0.01, own=0.001)
    finest = min(FINE[:4])

    def bridged(coarsest):
        monkeypatch.setattr(limit_errors, "_COARSEST", {1: coarsest, 2: finest})
        fit = fit_tfc(dataset).sel(limit="eps_f")
        assert fit["law"].item() == "unseen slope"
        return fit, fit["extrapolation_error"].item() / fit["extrapolated"].item()

    known, of_known = bridged(finest)
    coarse, of_coarse = bridged(0.9 * finest)
    assert of_coarse == pytest.approx(0.3, rel=0.02)
    assert of_known < 0.1
    assert coarse["kappa_tfc"].item() == known["kappa_tfc"].item()
    rest = expected_extrapolation_errors(fit_tfc(dataset), "eps_f", 2.0, 1).item()  # finer levels are known
    assert rest < 0.5 * coarse["extrapolation_error"].item()
    assert expected_extrapolation_errors(fit_tfc(dataset), "eps_f", 1.0, 1).item() == pytest.approx(
        coarse["extrapolation_error"].item()
    )


def test_a_thin_layer_adds_to_the_doubt_in_eps_t():
    """It is stiffer than the half-space that it becomes, by no law of eps_t."""
    dataset = campaign(levels={"eps_t": [1 / 2, 1 / 4, 1 / 8]}, coefficients={}, realisations=30)
    thin = dataset.assign_coords(thinnest_layer=("case", np.full(dataset.sizes["case"], 0.05)))
    fits = [fit_tfc(each, fixed={"eps_t": 1.0}) for each in (dataset, thin)]
    of_half_space, of_layer = (fit["extrapolation_error"].sel(limit="eps_t").item() for fit in fits)
    assert ["lower than the longest waves" in fit["message"].item() for fit in fits] == [False, True]
    finest = dataset["eps_t"].values.min()
    expected = 0.01 * finest / 0.05 * TFC[0.8]
    assert np.hypot(of_half_space, expected) == pytest.approx(of_layer, rel=0.01)


def unseen_slope_at_one_period(stretches, correction=0.3):
    """A campaign in eps_f, whose correction in eps_t wanes with the unseen slope; `stretches` in the coarsest case."""
    dataset = campaign(levels={"eps_f": [1 / 64, 1 / 256, 1 / 1024]}, coefficients={}, realisations=30)
    law = np.array([factor(0.8, eps) for eps in dataset["eps_f"].values]) - 1.0
    kappa = TFC[0.8] * (1.0 + law) * (1.0 + correction * (law / law.max()) ** WANING_OF_KAPPA)
    dataset = dataset.assign(kappa=dataset["kappa"] * 0.0 + kappa[:, np.newaxis])
    dataset["contact_area_fraction_counted"] = 0.01 * dataset["kappa"]
    dataset["n_segments"] = dataset["kappa"] * 0.0 + stretches / dataset["eps_f"] / 64.0
    measured = ("case", np.full(dataset.sizes["case"], True))
    return noisy(dataset, np.random.default_rng(0), spread=0.01).assign_coords(has_measured_slope_law=measured)


def test_too_few_hills_in_a_period_count_where_eps_t_is_not_varied():
    """Their number scatters, so that kappa is larger, by 1.4 over its square; the fit takes this for the limit's."""
    few, many = (fit_tfc(unseen_slope_at_one_period(stretches)) for stretches in (2.2, 220.0))
    off = few["kappa_tfc"].item() - TFC[0.8]
    assert few["law"].sel(limit="eps_f").item() == "unseen slope"
    assert 2.0 * many["kappa_tfc_error"].item() < off < 2.0 * few["kappa_tfc_error"].item()
    assert ["2.2 stretches" in fit["message"].item() for fit in (few, many)] == [True, False]


def test_a_case_that_hardly_ever_touches_may_be_wrong_by_the_whole_value():
    dataset = unseen_slope_at_one_period(220.0)
    dataset["n_segments"] = dataset["n_segments"].where(dataset["eps_f"] < 1 / 64, 0.0)
    fit = fit_tfc(dataset)
    assert "100% too large" in fit["message"].item()
    assert fit["kappa_tfc_error"].item() > 0.1


def test_nothing_is_known_of_the_unseen_slope_over_layers_that_stay_thin():
    """Long waves meet another stiffness than short ones: k_c is that of the levels, and the error a part of the way."""
    dataset = unseen_slope_at_one_period(220.0, correction=0.0)
    eps_t = dataset["eps_t"].values[0]
    low, high = (
        fit_tfc(dataset.assign_coords(thinnest_layer=("case", np.full(dataset.sizes["case"], height))))
        for height in (0.9 * eps_t, eps_t)
    )
    for fit, share in ((low, 0.3), (high, 0.02)):
        at = fit.sel(limit="eps_f")
        assert (at["extrapolation_error"] / at["extrapolated"]).item() == pytest.approx(share, rel=0.2)
    assert ["only known from these levels" in fit["message"].item() for fit in (low, high)] == [True, False]


@pytest.mark.parametrize("thin", [True, False])
def test_the_cut_of_the_unseen_slope_is_usual_where_no_layer_stays_thin(thin):
    dataset = unseen_slope_at_one_period(220.0)
    height = dataset["eps_t"].values * (0.9 if thin else 1.0)
    groups = groups_to_fit(dataset.assign_coords(thinnest_layer=("case", height)), "kappa", omit_nyquist=True)
    cut, _ = choices(["eps_f"], groups, {})[-1]["eps_f"].parameters
    assert (cut.usual is None) == thin


@pytest.mark.parametrize(("coarser", "is_known"), [(4, False), (2, True)])
def test_the_unseen_slope_is_known_better_from_fine_levels(coarser, is_known):
    """From 1/eps_f = 512 on; the finest level, which is the reference, has 1024 before all are made coarser."""
    dataset = campaign(levels={"eps_f": [1 / 64, 1 / 256]}, coefficients={}, realisations=30)
    dataset = dataset.assign_coords(eps_f=coarser * dataset["eps_f"])
    dataset = dataset.assign(kappa=dataset["kappa"] + unseen(dataset["eps_f"]))
    at = fit_tfc(noisy(dataset, np.random.default_rng(0))).sel(limit="eps_f")
    share = (at["extrapolation_error"] / at["extrapolated"]).item()
    assert share < 0.15 if is_known else share == pytest.approx(0.3, rel=0.05)


def test_the_law_of_the_unseen_slope_is_off_by_a_small_part_of_the_limit_at_most():
    dataset = noisy(of(COARSE, unseen).rename(kappa_r="kappa"), np.random.default_rng(0))
    by_law, by_power = (fit_tfc(dataset, fixed=fixed) for fixed in ({}, {"eps_f": 0.3}))
    assert 0.0 < part(by_law, "extrapolation") < 0.02 * by_law["kappa_tfc"].item()
    assert part(by_power, "extrapolation") > 0.02 * by_power["kappa_tfc"].item()


@pytest.mark.parametrize(
    ("load", "less"),
    [
        (0.007, True),
        pytest.param(0.0069, False, marks=pytest.mark.long),
        pytest.param(0.4, False, marks=pytest.mark.long),
    ],
)
def test_the_law_of_the_unseen_slope_is_off_by_less_for_contacts_like_those_measured(load, less):
    dataset = noisy(of(COARSE, unseen).rename(kappa_r="kappa"), np.random.default_rng(0))
    size = dataset.sizes["case"]
    dataset = dataset.assign_coords(reduced_pressure=("case", np.full(size, load), {"axis": "physics"}))
    like = dataset.assign_coords(has_measured_slope_law=("case", np.full(size, True)))
    by_law, by_power = (
        [
            part(each, "extrapolation") / abs(each["extrapolated"].sel(limit="eps_f").item())
            for each in (fit_tfc(one, fixed=fixed) for one in (like, dataset))
        ]
        for fixed in ({}, {"eps_f": 0.6})
    )
    assert (0.0 < by_law[0] < 0.6 * by_law[1]) if less else by_law[0] == by_law[1] > 0.0
    assert by_power[0] == pytest.approx(by_power[1])


def test_an_asserted_exponent_does_not_make_the_error_smaller_than_theory_does():
    """And a note says what theory makes of the same levels."""
    dataset = noisy(of(COARSE, unseen).rename(kappa_r="kappa"), np.random.default_rng(0))
    by_law, asserted = (fit_tfc(dataset, fixed=fixed) for fixed in ({}, {"eps_f": 0.3}))
    by_theory = by_law["kappa_tfc_error"] ** 2 - part(by_law, "extrapolation") ** 2 - part(by_law, "rivals") ** 2
    assert asserted["kappa_tfc_error"] ** 2 - part(asserted, "extrapolation") ** 2 > 0.99 * by_theory
    assert part(asserted, "rivals") > 0.0
    said = "by the law of the unseen slope alone, without what is given of the exponent, kappa_tfc is"
    assert said in asserted["message"].item()
    both = fit_tfc(dataset, fixed={"eps_f": OF_TWO_POWERS})
    assert said in both["message"].item()
    assert said not in by_law["message"].item()
    by_each = re.findall(
        r"([\d.]+)±([\d.]+) by (a power of eps_f|the law of the unseen slope) ", both["message"].item()
    )
    assert len(by_each) == 2
    for value, error, _ in by_each:
        assert abs(float(value) - both["kappa_tfc"].item()) < 5 * both["kappa_tfc_error"].item()
        assert 0.0 < float(error) < 2 * both["kappa_tfc_error"].item()


def test_rivals_keep_all_limits():
    """Without the finest eps_f, which is the reference, nothing would tell the correction in eps_t."""
    levels = {"eps_f": [1 / 64, 1 / 128, 1 / 256], "eps_t": [1 / 4, 1]}
    crossed = [{"eps_f": 1 / 64, "eps_t": 1 / 4}]
    whats = []
    for cross in ([], crossed):
        groups = groups_to_fit(campaign(levels=levels, cross=cross), "kappa", omit_nyquist=True)
        found = list(rivals(groups, {}))
        assert all({"eps_f", "eps_t"} <= group.levels.keys() for rival in found for group in rival.groups)
        whats.append([rival.what for rival in found])
    assert whats[0] == ["without the coarsest level of eps_f, 1/64"]
    assert "without the finest level of eps_f, 1/1024" in whats[1]


def inside(dataset, seeds):
    """In how many of some seeds the 90 % interval holds the limit."""
    count = 0
    for seed in range(seeds):
        fit = fit_tfc(scattered(dataset, seed), "kappa_r", fixed={"eps_f": OF_TWO_POWERS})
        count += bool(fit["kappa_r_tfc_low"].item() <= TFC[0.8] <= fit["kappa_r_tfc_high"].item())
    return count


@pytest.mark.long
def test_a_law_that_changes_beyond_the_levels_has_its_limit_in_the_interval(monkeypatch):
    """Of two powers the levels tell an exponent between them, and the slower one stays."""
    levels = [1 / 16, 1 / 32, 1 / 64, 1 / 128, 1 / 256]
    dataset = of(levels, lambda eps: 2.0 * eps**0.4 + 2.0 * eps)
    with_doubts = inside(dataset, 30)
    without_doubts(monkeypatch)
    assert with_doubts >= 24
    assert inside(dataset, 20) / 20 < with_doubts / 30 - 0.2


def test_a_level_that_does_not_fit_contradicts_no_exponent():
    """The finest one is off: fits without it disagree, and nobody asserted an exponent."""
    dataset = of(FINE, lambda eps: 6.0 * eps**0.6 - 0.3 * (eps < 1 / 10_000), realisations=400)
    fit = fit_tfc(scattered(dataset, 0), "kappa_r", fixed={"eps_f": OF_TWO_POWERS})
    assert part(fit, "rivals") > 0.0
    assert fit["contradiction"].sel(limit="eps_f").item() == 0.0


def test_a_wrong_exponent_that_is_asserted_is_found_out_by_its_rival():
    """Many surfaces make its own error small, but not what the levels say."""
    dataset = scattered(of(FINE, lambda eps: 6.0 * eps**0.6, realisations=400), 0)
    right, wrong = (fit_tfc(dataset, "kappa_r", fixed={"eps_f": exponent}) for exponent in (0.6, 0.9))
    assert "with an exponent of eps_f between" not in right["message"].item()
    assert "with an exponent of eps_f between" in wrong["message"].item()
    assert "the error includes this" in wrong["message"].item()
    assert right["contradiction"].sel(limit="eps_f").item() == 0.0
    assert abs(wrong["contradiction"].sel(limit="eps_f").item()) == pytest.approx(part(wrong, "rivals"))
    assert np.isnan(wrong["contradiction"].sel(limit=["eps_c", "eps_t"])).all()  # which are not varied
    assert part(wrong, "rivals") > part(wrong, "sampling")
    assert part(wrong, "rivals") > 5 * part(right, "rivals")
    assert wrong["kappa_r_tfc_error"].item() >= part(wrong, "rivals")
    assert abs(wrong["kappa_r_tfc"].item() - TFC[0.8]) < 2 * wrong["kappa_r_tfc_error"].item()


def test_a_finer_level_leaves_the_doubt_of_a_shorter_distance():
    """A power law bridges a factor finer ** -alpha of the distance, and its doubt is in proportion to that."""
    fit = fit_tfc(noisy(campaign(realisations=20, cross=CROSS), np.random.default_rng(0)), fixed=ALPHA)
    for limit, finer in (("eps_f", 4.0), ("eps_c", 2.0)):
        now = fit["extrapolation_error"].sel(limit=limit).values
        assert (now > 0.0).all()
        np.testing.assert_allclose(expected_extrapolation_errors(fit, limit, finer, 1), now * finer ** -ALPHA[limit])


def test_no_level_is_left_out_without_which_a_group_has_a_limit_less():
    whole = groups_to_fit(campaign((0.3, 0.8)), "kappa", omit_nyquist=True)
    finest = whole[0].levels["eps_f"].min()
    only_there = np.where(whole[0].levels["eps_f"] == finest, 1 / 2, 1 / 4)
    first = replace(whole[0], levels=whole[0].levels | {"eps_t": only_there})
    assert _without(whole, "eps_f", finest) is not None
    assert _without([first, whole[1]], "eps_f", finest) is None
    assert _without([whole[1], first], "eps_f", finest) is None
