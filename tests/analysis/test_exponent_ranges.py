"""Exponents known only to a range: what the data say of them counts, and errors cover the truth."""

import numpy as np
import pytest
import xarray as xr

from gfmd_numba.analysis import fit_tfc
from support.synthetic_campaigns import ALPHA, CROSS, LEVELS, REFERENCE, C, campaign, noisy, with_axes

pytestmark = pytest.mark.usefixtures("laws_that_hold")


def test_error_bars_cover_an_exponent_known_only_to_a_range():
    planted = ALPHA | {"eps_f": 0.67}
    dataset = noisy(campaign(alpha=planted, realisations=30, cross=CROSS), np.random.default_rng(14), spread=0.02)
    dataset = dataset.rename(kappa="kappa_r")  # which has no law but powers
    others = {"eps_c": ALPHA["eps_c"], "eps_t": ALPHA["eps_t"]}
    exact, ranged = (fit_tfc(dataset, "kappa_r", fixed=others | {"eps_f": e}) for e in (0.67, (0.3, 1.5)))
    assert ranged["kappa_r_tfc_low"] < 2.0 < ranged["kappa_r_tfc_high"]
    assert ranged["kappa_r_tfc_error"] > 1.2 * exact["kappa_r_tfc_error"]  # interactions add to both
    assert ranged["error_budget"].sel(source="eps_f") > 0.5 * ranged["kappa_r_tfc_error"]
    eps_f = ranged.sel(limit="eps_f", group=0)
    assert abs(eps_f["alpha"] - 0.67) < 2 * eps_f["alpha_error"]
    assert abs(eps_f["C"] - C["eps_f"]) < 3 * eps_f["C_error"]
    assert ranged.attrs["fixed"] == "eps_c: 1.1, eps_t: 1, eps_f: 0.3..1.5"
    assert ranged["alpha_low"].sel(limit=["eps_c", "eps_f"]).values[0].tolist() == [1.1, 0.3]
    assert ranged["alpha_high"].sel(limit=["eps_c", "eps_f"]).values[0].tolist() == [1.1, 1.5]


WIDE = {"eps_c": (0.5, 2.5), "eps_f": (0.3, 1.5), "eps_t": (0.5, 2.0)}


def test_what_the_data_say_of_an_exponent_counts_within_its_range():
    long = LEVELS | {"eps_f": [4.0**-n for n in range(3, 9)]}
    dataset = noisy(campaign(levels=long, realisations=30), np.random.default_rng(3), spread=0.02)
    eps_f = fit_tfc(dataset.rename(kappa="kappa_r"), "kappa_r", fixed=WIDE).sel(limit="eps_f", group=0)
    assert eps_f["alpha_error"] < 0.2 * (1.5 - 0.3) / np.sqrt(12)
    assert abs(eps_f["alpha"] - ALPHA["eps_f"]) < 3 * eps_f["alpha_error"]


def test_an_exponent_pressed_to_the_low_end_of_its_range_is_told():
    dataset = noisy(campaign(realisations=60), np.random.default_rng(5), spread=0.02).rename(kappa="kappa_r")
    said = [fit_tfc(dataset, "kappa_r", fixed=ALPHA | {"eps_f": ends}) for ends in ((0.2, 2.0), (1.0, 2.0))]
    assert ["low end of its range" in fit["message"].item() for fit in said] == [False, True]
    assert "exponent of eps_f lies at the low end of its range, 1, and the true limit" in said[1]["message"].item()


def test_a_small_exponent_that_the_data_know_is_not_pressed():
    """At a sixth of its range or less, and yet many standard deviations above the low end."""
    long = LEVELS | {"eps_f": [4.0**-n for n in range(3, 9)]}
    dataset = noisy(campaign(levels=long, realisations=60), np.random.default_rng(3), spread=0.005, own=2e-4)
    fit = fit_tfc(dataset.rename(kappa="kappa_r"), "kappa_r", fixed=ALPHA | {"eps_f": (0.4, 4.0)})
    eps_f = fit.sel(limit="eps_f", group=0)
    assert 0.4 + 3 * eps_f["alpha_error"] < eps_f["alpha"] < 0.4 + 0.15 * 3.6
    assert "low end of its range" not in fit["message"].item()


def test_no_power_of_eps_f_is_passed_off_as_a_limit_where_there_is_a_logarithm():
    dataset = campaign(realisations=3)
    steep = [with_axes(dataset.assign_coords(hurst=("case", np.full(10, hurst)))) for hurst in (0.8, 1)]
    notes = [fit_tfc(each, fixed=ALPHA) for each in steep]
    assert ["1 / log(1 / eps_f)" in fit["message"].item() for fit in notes] == [False, True]


@pytest.mark.long
def test_without_a_correction_all_exponents_of_a_range_are_as_good():
    flat = dict.fromkeys(C, 0.0)
    dataset = noisy(campaign(coefficients=flat, realisations=60), np.random.default_rng(4))
    fit = fit_tfc(dataset, fixed=WIDE)
    uniform = [(high - low) / np.sqrt(12) for low, high in WIDE.values()]
    np.testing.assert_allclose(fit["alpha_error"].isel(group=0), uniform, rtol=0.35)


@pytest.mark.long
def test_errors_are_right_when_exponents_lie_anywhere_in_their_ranges():
    rng = np.random.default_rng(12)
    found = []
    for _ in range(40):
        planted = {name: rng.uniform(*ends) for name, ends in WIDE.items()}
        coefficients = {name: C[name] * REFERENCE[name] ** (ALPHA[name] - planted[name]) for name in C}
        truth = campaign(alpha=planted, coefficients=coefficients, realisations=30, cross=CROSS)
        fit = fit_tfc(noisy(truth, rng).rename(kappa="kappa_r"), "kappa_r", fixed=WIDE)  # powers alone
        found.append((fit["kappa_r_tfc"].item() - 2.0, fit["kappa_r_tfc_error"].item()))
    scatter, claimed = np.sqrt(np.mean(np.square(found), axis=0))
    assert 0.65 < claimed / scatter < 1.5


@pytest.mark.parametrize("exponents", ["shared", "free"])
def test_without_noise_the_error_is_that_of_the_range(exponents):
    levels = LEVELS | {"eps_c": [1 / 2, 1 / 4]}  # the least that are known of an exponent
    dataset = campaign((0.3, 0.8), levels, realisations=3, cross=CROSS)
    fit = fit_tfc(dataset, exponents=exponents, fixed=ALPHA | {"eps_c": (1.0, 1.2)})
    ends = [fit_tfc(dataset, exponents=exponents, fixed=ALPHA | {"eps_c": end})["kappa_tfc"] for end in (1.0, 1.2)]
    # kappa_tfc is nearly linear in the exponent over so short a range
    np.testing.assert_allclose(fit["kappa_tfc_error"], abs(ends[1] - ends[0]) / np.sqrt(12), rtol=0.1)
    assert (fit["kappa_tfc_low"] >= ends[0]).all()
    assert (fit["kappa_tfc_high"] <= ends[1]).all()
    assert (fit["alpha_error"].sel(limit=["eps_f", "eps_t"]) == 0.0).all()


def test_without_noise_three_levels_tell_an_exponent_in_its_range():
    dataset = campaign((0.3, 0.8), realisations=3, cross=CROSS)
    fit = fit_tfc(dataset, fixed=ALPHA | {"eps_t": (0.8, 1.3)})
    np.testing.assert_allclose(fit["alpha"].sel(limit="eps_t"), 1.0, rtol=1e-6)
    np.testing.assert_allclose(fit["kappa_tfc"], [3.0, 2.0], rtol=1e-7)
    np.testing.assert_allclose(fit["kappa_tfc_error"], 0.0, atol=1e-7)


def test_a_range_as_wide_as_what_is_searched_is_a_range():
    dataset = campaign(coefficients=C | {"eps_t": 0.0}, realisations=3)
    assert fit_tfc(dataset, fixed=ALPHA | {"eps_t": (0.1, 5.0)})["fit_status"] == "ok"


def test_a_range_of_no_width_is_an_exact_exponent():
    dataset = noisy(campaign(realisations=10), np.random.default_rng(0))
    exact, ranged = (fit_tfc(dataset, fixed=ALPHA | {"eps_t": e}) for e in (1.0, [1.0, 1.0]))
    xr.testing.assert_identical(exact, ranged)
