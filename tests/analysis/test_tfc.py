"""The limit of synthetic campaigns: parameters that were planted are found, within the errors that are said."""

import json

import numpy as np
import pytest
import xarray as xr
from scipy.stats import binom

import gfmd_numba
from gfmd_numba.analysis import fit_tfc, select_limit
from support.synthetic_campaigns import ALPHA, CROSS, LEVELS, REFERENCE, TFC, C, campaign, noisy

pytestmark = pytest.mark.usefixtures("laws_that_hold")

KNOWN = {"eps_f": ALPHA["eps_f"]}


@pytest.mark.parametrize(
    ("exponents", "fixed"),
    [("shared", {}), ("free", {}), ("free", ALPHA)],
)
def test_planted_parameters_are_recovered_exactly(exponents, fixed):
    """With cross levels, which tell that corrections add up; kappa_r has no law but powers."""
    dataset = campaign((0.3, 0.8), cross=CROSS).rename(kappa="kappa_r")
    fit = fit_tfc(dataset, "kappa_r", exponents=exponents, fixed=fixed)
    assert fit["fit_status"].values.tolist() == ["ok", "ok"]
    np.testing.assert_allclose(fit["kappa_r_tfc"], [3.0, 2.0], atol=2e-8)
    for row in range(2):
        np.testing.assert_allclose(fit["alpha"][row], list(ALPHA.values()), rtol=2e-7)
        np.testing.assert_allclose(fit["C"][row], list(C.values()), rtol=5e-7)
        at_reference = [C[name] * REFERENCE[name] ** ALPHA[name] for name in C]
        np.testing.assert_allclose(fit["correction"][row], at_reference, rtol=2e-7)
    np.testing.assert_allclose(fit["kappa_r_tfc_error"], 0, atol=3e-8)
    np.testing.assert_allclose(fit["interaction"], 0, atol=1e-8)
    np.testing.assert_allclose(fit["interaction_error"], 0, atol=3e-8)
    np.testing.assert_allclose(fit["rms_residual"], 0, atol=3e-8)
    assert fit["n_cases"].values.tolist() == [13, 13]
    assert fit["freedom"].values.tolist() == [6, 6]  # less the limit, three corrections and three interactions


def test_corrections_taken_one_at_a_time_leave_open_whether_they_add_up():
    """Nothing tells of interactions, nor of the correction in eps_t, but what is known before.

    It is so where interactions are products of both laws, as of kappa_r. With eps_c seen one at a time as c + cf + ct,
    eps_f as f + cf + ft and eps_t as t + ct + ft, the sum of all is what is seen of eps_c, eps_f and eps_t less cf, ct
    and ft: the limit goes as cf - t.
    """
    fit = fit_tfc(campaign((0.3, 0.8)).rename(kappa="kappa_r"), "kappa_r", fixed=ALPHA)
    sizes = {name: C[name] * REFERENCE[name] ** ALPHA[name] for name in C}
    for row, truth in enumerate((TFC[0.3], TFC[0.8])):
        found, unknown = fit["interaction"][row], fit["interaction_error"][row]
        of_t = sizes["eps_t"] / 2
        of_cf, of_ct = (min(sizes["eps_c"], sizes[name]) / 2 for name in ("eps_f", "eps_t"))
        np.testing.assert_allclose(found, [0.0, 0.0, sizes["eps_t"]], atol=1e-8)
        np.testing.assert_allclose(unknown, [of_cf, of_ct, np.hypot(of_t, of_ct)], rtol=1e-6)
        assert fit["correction"][row].sel(limit="eps_t").item() == pytest.approx(0.0, abs=1e-8)
        assert fit["correction_error"][row].sel(limit="eps_t").item() == pytest.approx(of_t, rel=1e-6)
        assert fit["kappa_r_tfc"][row].item() == pytest.approx(truth + sizes["eps_t"], abs=1e-7)
        whole = np.hypot(of_cf, of_t)
        assert fit["kappa_r_tfc_error"][row].item() == pytest.approx(whole, rel=1e-6)
        assert fit["error_budget"][row].sel(source="interaction").item() == pytest.approx(whole, rel=1e-6)
        said = (
            "no cross level tells whether the corrections of eps_c and eps_f; eps_c and eps_t; eps_f and eps_t add up"
        )
        assert said in fit["message"].values[row]


def test_a_correction_in_eps_t_that_wanes_with_eps_f_is_what_is_expected_without_cross_levels():
    size = C["eps_t"] * REFERENCE["eps_t"] ** ALPHA["eps_t"]
    waning = campaign(coefficients=C | {"eps_t": 0.0}, interactions={("eps_f", "eps_t"): size})
    assert fit_tfc(waning, fixed=ALPHA)["kappa_tfc"].item() == pytest.approx(TFC[0.8], abs=1e-7)


@pytest.mark.long
def test_free_exponents_differ_between_groups_and_shared_ones_do_not():
    planted = {0.3: ALPHA, 0.8: ALPHA | {"eps_f": 0.9}}
    dataset = campaign((0.3, 0.8), alpha=planted).rename(kappa="kappa_r")  # which has no law but powers
    free = fit_tfc(dataset, "kappa_r", exponents="free")
    np.testing.assert_allclose(free["alpha"].sel(limit="eps_f"), [0.6, 0.9], rtol=2e-7)
    shared = fit_tfc(dataset, "kappa_r", exponents="shared")["alpha"].sel(limit="eps_f")
    assert shared[0] == shared[1]
    assert 0.6 < shared[0] < 0.9


@pytest.mark.long
def test_a_group_with_two_levels_borrows_the_shared_exponent():
    dataset = campaign((0.3, 0.8), cross=CROSS)
    dataset = dataset.isel(case=~((dataset["hurst"] == 0.3) & (dataset["eps_c"] == 1 / 8)).values)
    fit = fit_tfc(dataset)
    np.testing.assert_allclose(fit["kappa_tfc"], [3.0, 2.0], atol=2e-8)
    alone = fit_tfc(dataset, exponents="free")
    assert alone["fit_status"].values.tolist() == ["refused", "ok"]


def test_a_full_product_without_a_reference_case_is_fitted():
    base = campaign()
    axes = np.meshgrid([1 / 2, 1 / 4, 1 / 8], [1 / 256, 1 / 1024, 1 / 4096], [1 / 2, 1 / 4, 1 / 8])
    c, f, t = (axis.ravel() for axis in axes)
    dataset = base.isel(case=np.zeros(c.size, int)).assign_coords(
        eps_c=("case", c), eps_f=("case", f), eps_t=("case", t), is_reference=("case", np.zeros(c.size, bool))
    )
    dataset["kappa"] += 2 + 0.4 * dataset["eps_c"] ** 1.1 + 6 * dataset["eps_f"] ** 0.6 + 0.3 * dataset["eps_t"]
    dataset["kappa"] -= base["kappa"].values[0, 0]
    fit = fit_tfc(dataset, fixed=KNOWN)
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=1e-8)
    np.testing.assert_allclose(fit["correction"].sel(limit="eps_t"), 0.3 / 8, rtol=1e-7)  # at the finest level


def test_noisy_parameters_lie_inside_the_error_bars():
    rng = np.random.default_rng(4)
    fit = fit_tfc(
        noisy(campaign((0.3, 0.8), realisations=30, cross=CROSS), rng, spread=0.02, own=0.005),
        fixed={"eps_t": 1.0},
    )
    assert (fit["fit_status"] == "ok").all()
    assert (abs(fit["kappa_tfc"] - [3.0, 2.0]) < 3 * fit["kappa_tfc_error"]).all()
    assert (abs(fit["C"] - list(C.values())) < 3 * fit["C_error"]).all()
    free = ["eps_c", "eps_f"]
    assert (abs(fit["alpha"] - list(ALPHA.values())) < 3 * fit["alpha_error"]).sel(limit=free).all()
    assert (fit["alpha_error"].sel(limit="eps_t") == 0).all()
    # the error of a 30-realisation mean, enlarged by the extrapolation
    assert (fit["kappa_tfc_error"] > 0.02 / np.sqrt(30)).all()
    assert (fit["kappa_tfc_error"] < 0.2 / np.sqrt(30)).all()


@pytest.mark.long
def test_ninety_percent_interval_covers_the_truth():
    rng = np.random.default_rng(11)
    truth, n = campaign(realisations=30, cross=CROSS), 60
    fixed = {"eps_f": ALPHA["eps_f"], "eps_t": ALPHA["eps_t"]}
    inside, error = 0, []
    for _ in range(n):
        fit = fit_tfc(noisy(truth, rng, spread=0.1), fixed=fixed)
        inside += int(fit["kappa_tfc_low"].item() <= 2.0 <= fit["kappa_tfc_high"].item())
        error.append((fit["kappa_tfc"].item() - 2.0, fit["kappa_tfc_error"].item()))
    assert binom.ppf(1e-3, n, 0.9) <= inside <= binom.ppf(1 - 1e-3, n, 0.9)
    scatter, claimed = np.sqrt(np.mean(np.square(error), axis=0))
    assert 0.78 < claimed / scatter < 1.38  # three standard errors of the scatter below


@pytest.mark.long
def test_weighted_fit_is_more_precise_than_ordinary_least_squares():
    """On paired data whose variances differ between cases, at fixed exponents where OLS is linear."""
    rng = np.random.default_rng(2)
    truth = campaign(realisations=30)
    names = list(C)
    design = np.column_stack([np.ones(10), *(truth[name].values ** ALPHA[name] for name in names)])
    ordinary, weighted = [], []
    for _ in range(40):
        dataset = noisy(truth, rng)
        beta = np.linalg.lstsq(design, dataset["kappa"].mean("realisation").values, rcond=None)[0]
        fit = fit_tfc(dataset.rename(kappa="kappa_r"), "kappa_r", fixed=ALPHA)
        ordinary.append([beta[0] - 2.0, beta[1] - C["eps_c"]])
        weighted.append([fit["kappa_r_tfc"].item() - 2.0, fit["C"].sel(limit="eps_c").item() - C["eps_c"]])
    ratio = np.std(weighted, axis=0) / np.std(ordinary, axis=0)
    assert ratio[0] < 0.95
    assert ratio[1] < 1.0


def test_a_huge_offset_common_to_all_levels_leaves_the_coefficients_alone():
    rng = np.random.default_rng(5)
    dataset = campaign((0.3, 0.8), realisations=20, cross=CROSS)
    dataset["kappa"] = dataset["kappa"] + 0.01 * rng.standard_normal(dataset["kappa"].shape)
    shifted = dataset.assign(kappa=dataset["kappa"] + 100 * rng.standard_normal(20))
    plain, paired = (fit_tfc(data, fixed=ALPHA) for data in (dataset, shifted))
    # but for the factor on all errors of a group, which is that of kappa_tfc
    assert (abs(paired["C"] - plain["C"]) < 0.1 * plain["C_error"]).all()
    np.testing.assert_allclose(paired["C_error"], plain["C_error"], rtol=0.25)
    assert (paired["kappa_tfc_error"] > 1000 * plain["kappa_tfc_error"]).all()
    unpaired = shifted.copy(deep=True)
    unpaired["kappa"][3] = rng.permutation(unpaired["kappa"][3].values)
    assert (fit_tfc(unpaired, fixed=ALPHA)["C_error"][0] > 100 * plain["C_error"][0]).any()


def test_one_draw_of_realisations_serves_all_groups():
    dataset = campaign((0.3, 0.8), realisations=10)
    noise = np.random.default_rng(7).standard_normal((10, 10))
    dataset["kappa"] = dataset["kappa"] + 0.1 * np.concatenate([noise, noise])
    fit = fit_tfc(dataset, exponents="free", fixed=ALPHA)
    np.testing.assert_allclose(fit["kappa_tfc_error"][0], fit["kappa_tfc_error"][1], rtol=1e-9)


def test_the_same_results_have_the_same_fit():
    dataset = noisy(campaign(realisations=10), np.random.default_rng(0))
    first, again = (fit_tfc(dataset, fixed=ALPHA | {"eps_f": (0.3, 0.9)}) for _ in range(2))
    xr.testing.assert_identical(first, again)


def test_roughness_at_nyquist_is_left_out_by_default():
    dataset = campaign(levels=LEVELS | {"eps_c": [1, 1 / 2, 1 / 4, 1 / 8]}, cross=CROSS)
    dataset["kappa"][dataset["eps_c"].values == 1] += 0.3
    fit = fit_tfc(dataset, fixed=KNOWN)
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=3e-8)
    assert fit["n_cases"] == 13
    kept = fit_tfc(dataset, fixed=KNOWN, omit_nyquist=False)
    assert kept["n_cases"] == 14
    assert abs(kept["kappa_tfc"] - 2.0) > 1e-3


def test_a_reference_at_nyquist_is_fitted_and_said():
    dataset = campaign(levels={name: LEVELS[name] for name in ("eps_f", "eps_t")}, cross=CROSS[2:])
    dataset["eps_c"][:] = 1.0
    fit = fit_tfc(dataset, fixed=KNOWN)
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0 + 0.4 * 0.5**1.1, atol=3e-8)
    assert fit["message"].item().startswith("eps_c = 1 is fitted as well")


def test_each_group_carries_the_mean_of_its_reference_case():
    dataset = noisy(campaign((0.3, 0.8), realisations=9), np.random.default_rng(3))
    backwards = dataset.isel(case=slice(None, None, -1))
    fit = fit_tfc(backwards, fixed=ALPHA)
    for group in range(2):
        values = dataset["kappa"].where(dataset["hurst"] == fit["hurst"][group]).where(dataset["is_reference"])
        values = values.dropna("case", how="all")[0]
        np.testing.assert_allclose(fit["reference"][group], values.mean())
        np.testing.assert_allclose(fit["reference_error"][group], values.std(ddof=1) / 3)
    assert fit["reference_eps"][0].values.tolist() == list(REFERENCE.values())


def test_of_several_references_the_finest_counts():
    """An eps in the grid of a campaign makes each of its values a reference with limits of its own."""
    coarse = campaign((0.3, 0.8), levels=LEVELS | {"eps_c": [1 / 2]})
    names = np.char.add(coarse["case_id"].values, "-fine")
    finer = coarse["eps_c"].copy(data=coarse["eps_c"].values / 4)
    fine = coarse.assign_coords(eps_c=finer, case_id=("case", names))
    fine["kappa"] += 0.4 * ((1 / 8) ** 1.1 - (1 / 2) ** 1.1)
    for order in ([coarse, fine], [fine, coarse]):
        both = xr.concat(order, "case")
        fit = fit_tfc(both, fixed=ALPHA)
        assert fit["reference_eps"].sel(limit="eps_c").values.tolist() == [1 / 8, 1 / 8]
        expected = np.array([3.0, 2.0]) + 0.4 * (1 / 8) ** 1.1 + 6 * (1 / 1024) ** 0.6 + 0.15
        np.testing.assert_allclose(fit["reference"], expected)
        together = fit["correction"].sum("limit") + fit["interaction"].sum("pair")
        np.testing.assert_allclose(fit["kappa_tfc"] + together, expected)
        assert set(select_limit(both, "eps_f")["eps_c"].values) == {1 / 8}


def test_result_survives_netcdf(tmp_path):
    fit = fit_tfc(campaign((0.3, 0.8)), fixed=ALPHA)
    fit.to_netcdf(tmp_path / "fit.nc")
    with xr.open_dataset(tmp_path / "fit.nc") as again:
        np.testing.assert_array_equal(again["kappa_tfc"], fit["kappa_tfc"])
        assert again.attrs["fixed"] == "eps_c: 1.1, eps_f: 0.6, eps_t: 1"
        assert again.attrs["variable"] == "kappa"
        assert again["fit_status"].values.tolist() == ["ok", "ok"]


def test_select_limit_orders_from_coarse_to_fine_and_includes_the_reference():
    chosen = select_limit(campaign((0.8,)).isel(case=slice(None, None, -1)), "eps_t")
    assert chosen["eps_t"].values.tolist() == [1, 1 / 2, 1 / 4, 1 / 8]
    assert chosen["is_reference"].values.tolist() == [False, True, False, False]
    assert set(chosen["eps_c"].values) == {1 / 2}
    with pytest.raises(ValueError, match="limit: you gave 'eps_x'; gfmd allows 'eps_c', 'eps_f' or 'eps_t'"):
        select_limit(campaign(), "eps_x")


def test_a_fit_in_python_takes_the_options_of_the_campaign_unless_others_are_given():
    results = noisy(campaign((0.3, 0.8), realisations=20), np.random.default_rng(1))
    results.attrs["fit"] = json.dumps({"variable": "kappa", "exponents": "free", "fixed": ALPHA})
    found = gfmd_numba.fit_tfc(results)
    xr.testing.assert_allclose(
        found.drop_vars("seconds"), fit_tfc(results, exponents="free", fixed=ALPHA).drop_vars("seconds")
    )
    assert found.attrs["exponents"] == "free"
    asked = gfmd_numba.fit_tfc(results, exponents="shared", fixed=ALPHA | {"eps_c": 2.0})
    assert (asked.attrs["exponents"], asked.attrs["fixed"]) == ("shared", "eps_c: 2, eps_f: 0.6, eps_t: 1")


def test_python_fits_a_target_as_the_run_did():
    results = noisy(campaign((0.3, 0.8), realisations=20), np.random.default_rng(1))
    own = {"variable": "kappa", "exponents": "free", "fixed": ALPHA}
    results.attrs |= {"fit": json.dumps(own | {"exponents": "shared"}), "fits_of_targets": json.dumps({"kappa": own})}
    assert gfmd_numba.fit_tfc(results, "kappa").attrs["exponents"] == "free"
