"""Corrections that do not add up, laws that are no powers, and errors that have to be right for both."""

import numpy as np
import pytest

from gfmd_numba.analysis import fit_tfc
from gfmd_numba.analysis.fit_dataset import in_the_limit
from gfmd_numba.analysis.gauss_markov import covariance_of_one
from support.synthetic_campaigns import ALPHA, CROSS, LEVELS, REFERENCE, TFC, WANING, C, campaign, noisy
from support.unseen_slope import of_unseen_slope

pytestmark = pytest.mark.usefixtures("laws_that_hold")

PLANTED = {("eps_c", "eps_f"): 0.04, ("eps_c", "eps_t"): -0.05, ("eps_f", "eps_t"): 0.08}


@pytest.mark.parametrize("fixed", [ALPHA, {"eps_t": 1.0}], ids=["exact", "free"])
def test_planted_interactions_are_found_with_cross_levels(fixed):
    dataset = campaign(cross=CROSS, interactions=PLANTED, waning=1.0)
    dataset = dataset.rename(kappa="kappa_r")  # which has no law but powers
    fit = fit_tfc(dataset, "kappa_r", fixed=fixed).isel(group=0)
    np.testing.assert_allclose(fit["interaction"], list(PLANTED.values()), atol=1e-7)
    np.testing.assert_allclose(fit["interaction_error"], 0.0, atol=1e-7)
    np.testing.assert_allclose(fit["kappa_r_tfc"], TFC[0.8], atol=1e-7)
    np.testing.assert_allclose(fit["C"], list(C.values()), rtol=1e-6)
    assert "corrections" not in fit["message"].item()  # the interactions say it
    # how far the finest levels are from the limit, other corrections there or not
    for name, finest in fit["finest_eps"].to_series().items():
        alone = C[name] * finest ** ALPHA[name]
        by_pairs = sum(size for pair, size in PLANTED.items() if name in pair)
        together = alone + by_pairs * (finest / REFERENCE[name]) ** ALPHA[name]
        assert fit["extrapolated"].sel(limit=name).item() == pytest.approx(max(alone, together), abs=1e-7)


def test_planted_interactions_lie_within_their_errors():
    dataset = noisy(campaign(realisations=60, cross=CROSS, interactions=PLANTED), np.random.default_rng(5), spread=0.05)
    fit = fit_tfc(dataset, fixed=ALPHA).isel(group=0)
    assert (abs(fit["interaction"] - list(PLANTED.values())) < 2.5 * fit["interaction_error"]).all()
    assert abs(fit["kappa_tfc"] - TFC[0.8]) < 2.5 * fit["kappa_tfc_error"]


@pytest.mark.parametrize("first", [-1.0, 0.0, 1.0])
@pytest.mark.parametrize("second", [0.5, 1.0, 1.5])
def test_without_cross_levels_likely_interactions_lie_inside_the_error(first, second):
    """Of eps_c a standard deviation, half the smaller correction; of eps_f and eps_t half or one and a half of it."""
    size = C["eps_t"] * REFERENCE["eps_t"]
    planted = {("eps_c", "eps_f"): 0.5 * first * C["eps_f"] * REFERENCE["eps_f"] ** ALPHA["eps_f"]}
    planted[("eps_f", "eps_t")] = second * size
    # corrections as they are seen one at a time hold those interactions
    coefficients = C | {"eps_t": C["eps_t"] * (1 - second)}
    fit = fit_tfc(campaign(coefficients=coefficients, interactions=planted), fixed=ALPHA)
    assert abs(fit["kappa_tfc"] - TFC[0.8]) < 1.7 * fit["kappa_tfc_error"]
    assert "no cross level tells whether" in fit["message"].item()


def test_one_cross_level_leaves_the_other_pairs_open():
    dataset = campaign(cross=CROSS[:1], interactions=PLANTED, waning=1.0).rename(kappa="kappa_r")
    fit = fit_tfc(dataset, "kappa_r", fixed=ALPHA).isel(group=0)
    lines = fit["message"].item().splitlines()
    assert "whether the corrections of eps_c and eps_t; eps_f and eps_t add up" in lines[0]
    known, *unknown = fit["interaction_error"].values
    assert known < 1e-7
    assert min(unknown) > 0.01


@pytest.mark.long
@pytest.mark.parametrize("hurst", [0.5, 1.0])
def test_kappa_of_unseen_slope_is_found_where_a_power_is_off(hurst):
    """Of five levels of eps_f with little scatter, which follow kappa_tfc / sqrt(1 - S) without being told so."""
    levels = LEVELS | {"eps_f": [1 / 64, 1 / 256, 1 / 1024, 1 / 4096, 1 / 16384]}
    truth = of_unseen_slope(campaign(levels=levels, realisations=40, cross=CROSS, **WANING), hurst)
    rng = np.random.default_rng(2)
    others = {"eps_c": ALPHA["eps_c"], "eps_t": ALPHA["eps_t"]}
    found = []
    for _ in range(8):
        dataset = noisy(truth, rng, spread=0.01)
        fit, power = (
            fit_tfc(dataset.rename(kappa=name), name, fixed=others | given)
            for name, given in (("kappa", {}), ("kappa_r", {"eps_f": (0.05, 3.0)}))
        )
        limits = [[float(each.item()) for each in in_the_limit(one)] for one in (fit, power)]
        found.append([[value - TFC[0.8], error] for value, error in limits])
    (off, error), (off_by_power, error_of_power) = np.transpose(found, (1, 2, 0))
    assert np.sqrt(np.mean((off / error) ** 2)) < 1.6
    assert abs(np.mean(off_by_power)) > 2 * abs(np.mean(off))
    assert np.sqrt(np.mean((off_by_power / error_of_power) ** 2)) > 1.6


def test_the_error_of_one_limit_is_that_of_its_estimate_in_each_realisation():
    """White 1980 and Lavenberg and Welch 1981, with the weights of generalised least squares."""
    dataset = noisy(
        campaign(levels={"eps_c": [1 / 2, 1 / 4, 1 / 8, 1 / 16]}, realisations=12), np.random.default_rng(0)
    )
    values = dataset["kappa"].values.T
    columns = np.column_stack([np.ones(4), dataset["eps_c"].values])
    weight = np.linalg.inv(covariance_of_one(values))
    each = values @ (weight @ columns @ np.linalg.inv(columns.T @ weight @ columns))[:, 0]
    fit = fit_tfc(dataset, fixed={"eps_c": 1.0})
    assert "no law" not in fit["message"].item()
    assert fit["kappa_tfc"].item() == pytest.approx(each.mean(), rel=1e-10)
    assert fit["kappa_tfc_error"].item() == pytest.approx(np.sqrt(each.var(ddof=1) / 12 * (1 + 2 / 12)), rel=1e-9)
