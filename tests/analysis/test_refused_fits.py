"""Campaigns whose limit cannot be had, or only in part: what is refused, and what is said."""

from dataclasses import replace

import numpy as np
import pytest

from gfmd_numba.analysis import UnusableDataError, fit_tfc
from gfmd_numba.analysis.selection import groups_to_fit
from support.synthetic_campaigns import ALPHA, CROSS, LEVELS, C, assert_refused, campaign, noisy, notes

pytestmark = pytest.mark.usefixtures("laws_that_hold")

KNOWN = {"eps_f": ALPHA["eps_f"]}


@pytest.mark.parametrize("spread", [0.0, 0.02])
def test_a_flat_limit_has_no_exponent(spread):
    rng = np.random.default_rng(6)
    dataset = campaign(coefficients={"eps_c": 0.4, "eps_f": 6.0, "eps_t": 0.0}, realisations=15).rename(kappa="kappa_r")
    dataset["kappa_r"] = dataset["kappa_r"] + spread * rng.standard_normal(dataset["kappa_r"].shape)
    fixed = {"eps_c": 1.1, "eps_f": 0.6}
    assert_refused(
        fit_tfc(dataset, "kappa_r", fixed=fixed),
        "exponent of eps_t has no influence on the fit",
        "levels 1, 1/2, 1/4, 1/8",
        "15 realisations",
        "`gfmd fit --fixed eps_t=1:2`",
        "`fit: {fixed: {eps_t: [1, 2]}}`",
        "fixed={'eps_t': (1.0, 2.0)}",
    )
    rescued = fit_tfc(dataset, "kappa_r", fixed=fixed | {"eps_t": 1.0})
    assert rescued["fit_status"] == "ok"
    assert abs(rescued["kappa_r_tfc"] - 2.0) < 5 * rescued["kappa_r_tfc_error"] + 1e-9


def test_an_exponent_known_only_to_a_factor_of_ten_is_refused():
    rng = np.random.default_rng(8)
    dataset = campaign(alpha=ALPHA | {"eps_t": 0.8}, realisations=30).rename(kappa="kappa_r")
    dataset["kappa_r"] = dataset["kappa_r"] + 0.16 * rng.standard_normal(dataset["kappa_r"].shape)
    fit = fit_tfc(dataset, "kappa_r", fixed={"eps_c": 1.1, "eps_f": 0.6})
    assert_refused(fit, "exponent of eps_t with 90 % interval 0.1", "uncertain by more than a factor 8")
    mean = dataset["kappa_r"].mean("realisation")
    dataset["kappa_r"] = mean + 0.2 * (dataset["kappa_r"] - mean)
    assert fit_tfc(dataset, "kappa_r", fixed={"eps_c": 1.1, "eps_f": 0.6})["fit_status"] == "ok"


def test_one_doubtful_exponent_refuses_every_group_that_shares_it():
    dataset = noisy(campaign((0.3, 0.8), coefficients=C | {"eps_t": 0.0}, realisations=10), np.random.default_rng(1))
    fit = fit_tfc(dataset)
    assert_refused(fit, "exponent of eps_t")
    assert "exponent of eps_t" in fit["message"].values[1]


def test_two_levels_need_a_fixed_exponent():
    dataset = campaign(levels=LEVELS | {"eps_t": [1, 1 / 2]}, cross=CROSS)
    assert_refused(fit_tfc(dataset), "eps_t needs three levels, has two (1, 1/2)", "fixed={'eps_t'")
    fit = fit_tfc(dataset, fixed=KNOWN | {"eps_t": 1.0})
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=3e-8)


def test_a_limit_that_is_not_varied_is_named_and_left_in_the_result():
    fit = fit_tfc(campaign(levels={name: LEVELS[name] for name in ("eps_c", "eps_f")}), fixed=KNOWN)
    assert fit["fit_status"] == "ok"
    assert notes(fit) == ["eps_t is not varied: kappa_tfc is not extrapolated in it"]
    assert "the corrections of eps_c and eps_f add up" in fit["message"].item()
    assert np.isnan(fit["interaction"]).values.tolist() == [[False, True, True]]
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0 + 0.3 / 2, atol=3e-8)
    assert np.isnan(fit["C"].sel(limit="eps_t"))


def test_no_limit_varied_is_refused():
    assert_refused(fit_tfc(campaign(levels={})), "no discretisation is varied")


def test_limits_varied_together_are_refused():
    dataset = campaign(levels={"eps_c": LEVELS["eps_c"]})
    dataset = dataset.assign_coords(eps_t=dataset["eps_c"] / 2)
    assert_refused(fit_tfc(dataset), "3 cases cannot tell eps_c, eps_t apart")


def test_a_single_realisation_has_no_sampling_error():
    fit = fit_tfc(campaign(realisations=1, cross=CROSS), fixed=KNOWN)
    assert fit["fit_status"] == "ok"
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=3e-8)
    assert np.isnan(fit["kappa_tfc_error"])
    assert np.isnan(fit["kappa_tfc_low"])
    assert "sampling error is unknown (1 realisation)" in fit["message"].item()


@pytest.mark.parametrize("lacking", ["is_reference", "case_id", "eps_t"])
def test_a_dataset_that_is_no_campaign_is_named(lacking):
    with pytest.raises(ValueError, match="you gave no results of a campaign"):
        fit_tfc(campaign().drop_vars(lacking))
    with pytest.raises(ValueError, match=r"you gave a dataset in which .* is over .*, not over \(case"):
        fit_tfc(campaign().isel(case=0))


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"variable": "kapa"}, "no variable 'kapa' in the dataset; it has .*kappa"),
        ({"exponents": "both"}, "exponents: you gave 'both'; gfmd allows 'shared' or 'free'"),
        ({"fixed": {"eps_x": 1.0}}, "fixed: you gave {'eps_x': 1.0}; gfmd allows a mapping of 'eps_c'"),
        ({"fixed": {"eps_c": -1.0}}, "exponents above 0 and up to 100"),
        ({"fixed": {"eps_c": np.nan}}, "exponents above 0 and up to 100"),
        ({"fixed": {"eps_c": (0.0, 1.0)}}, "exponents above 0 and up to 100"),
        ({"fixed": {"eps_c": (1.0, 0.5)}}, r"you gave {'eps_c': \(1.0, 0.5\)}; gfmd allows"),
        ({"fixed": {"eps_c": (1.0, np.inf)}}, "exponents above 0 and up to 100"),
        ({"fixed": {"eps_c": (0.5, 0.7, 1.0)}}, r"\(low, high\)"),
        ({"fixed": {"eps_c": "1.0"}}, "you gave {'eps_c': '1.0'}; gfmd allows"),
    ],
)
def test_wrong_options_are_named(options, match):
    with pytest.raises(ValueError, match=match):
        fit_tfc(campaign(), **options)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_number_whose_square_overflows_is_refused(sign):
    dataset = campaign(realisations=5)
    dataset["eps_c"] = dataset["eps_c"] * 0.0 + sign * 1e200
    with pytest.raises(UnusableDataError, match="has a number beyond"):
        fit_tfc(dataset)


@pytest.mark.parametrize("eps", [0.0, -1 / 2])
def test_a_discretisation_that_is_not_above_0_is_refused(eps):
    dataset = campaign()
    at_none = dataset["eps_f"].values.copy()
    at_none[2] = eps
    with pytest.raises(ValueError, match="eps_f is not above 0"):
        fit_tfc(dataset.assign_coords(eps_f=("case", at_none, dataset["eps_f"].attrs)))


def test_sentences_have_the_unit_of_the_variable():
    (group,) = groups_to_fit(campaign(), "kappa", omit_nyquist=True)
    assert [replace(group, unit=unit).shown(2.5e-7) for unit in ("1", "m")] == ["2.5e-07", "250 nm"]


RANGES = {"eps_c": (0.8, 1.5), "eps_f": (0.3, 1.0), "eps_t": (0.5, 1.5)}


def equal(cases, realisations=20):
    """A share of the contact that is 1 in all realisations of some cases, and differs once in the others."""
    dataset = campaign(realisations=realisations, cross=CROSS).rename(kappa="stick_fraction")
    share = np.ones(dataset["stick_fraction"].shape)
    share[np.arange(len(share)) >= cases, 0] = 0.9
    counts = np.full(len(share), realisations)
    counts[:2] = realisations // 2
    share[:2, realisations // 2 :] = np.nan
    return dataset.assign(stick_fraction=(("case", "realisation"), share)).assign_coords(realisations=("case", counts))


@pytest.mark.parametrize("cases", [1, 5, 12])
def test_values_that_are_equal_at_some_levels_have_an_error(cases):
    """One surface in n may have another value where none of n has."""
    fit = fit_tfc(equal(cases), "stick_fraction", fixed=RANGES)
    assert (fit["fit_status"] == "ok").all()
    sampling = fit["error_budget"].sel(source="sampling").item()
    assert 0.1 / 30 / 4 < sampling < 0.1
