"""Fits of campaigns in which realisations or whole cases failed or are yet to run."""

import numpy as np
import pytest

from gfmd_numba.analysis import fit_tfc
from support.synthetic_campaigns import ALPHA, CROSS, LEVELS, C, assert_refused, campaign, fails, noisy, notes

pytestmark = pytest.mark.usefixtures("laws_that_hold")

KNOWN = {"eps_f": ALPHA["eps_f"]}


def test_only_complete_realisations_are_fitted():
    whole = noisy(campaign((0.3, 0.8), cross=CROSS, realisations=12), np.random.default_rng(9))
    broken = fails(whole, case=7, realisation=3)
    broken["kappa"][5, 4] = np.nan
    fit = fit_tfc(broken, exponents="free", fixed=ALPHA)
    assert fit["n_excluded"].values.tolist() == [2, 0]
    assert fit["n_realisations"].values.tolist() == [10, 12]
    assert fit["n_cases"].values.tolist() == [13, 13]
    assert [notes(fit, 0), notes(fit, 1)] == [["2 of 12 realisations dropped, not good in every case"], []]
    rest = whole.isel(realisation=np.delete(np.arange(12), [3, 4]))
    for row, same in enumerate((rest, whole)):
        expected = fit_tfc(same, exponents="free", fixed=ALPHA)
        for name in ("kappa_tfc", "C", "chi2"):
            np.testing.assert_allclose(fit[name][row], expected[name][row], rtol=1e-12)


def test_errors_of_incomplete_groups_are_those_of_the_rest_that_had_never_been_run():
    whole = noisy(campaign((0.3, 0.8), cross=CROSS, realisations=30), np.random.default_rng(13))
    broken = fails(whole, case=5, realisation=slice(0, 10))
    few, all_of_them = (fit_tfc(data, "kappa", "free", ALPHA)["kappa_tfc_error"] for data in (broken, whole))
    expected = fit_tfc(whole.isel(realisation=slice(10, 30)), "kappa", "free", ALPHA)["kappa_tfc_error"]
    np.testing.assert_allclose(few[0], expected[0], rtol=0.15)
    np.testing.assert_allclose(few[1], all_of_them[1], rtol=1e-12)


def test_simulations_that_have_not_run_yet_are_told_from_those_that_failed():
    dataset = noisy(campaign(realisations=12), np.random.default_rng(9))
    partial = fails(dataset, case=2, realisation=slice(6, 12))
    assert not any("not run yet" in note for note in notes(fit_tfc(partial, fixed=ALPHA)))
    partial["status"].attrs |= {"flag_values": np.array([0, 5], dtype=np.int8), "flag_meanings": "ok unfinished"}
    assert f"6 of {partial['status'].size} simulations have not run yet: `gfmd run` resumes" in notes(
        fit_tfc(partial, fixed=ALPHA)
    )


def test_a_case_that_mostly_failed_is_left_out_by_name():
    dataset = noisy(campaign(cross=CROSS, realisations=12), np.random.default_rng(9))
    fit = fit_tfc(fails(dataset, case=2, realisation=slice(0, 7)), fixed=ALPHA)
    case = "eps_c = 1/8, eps_f = 1/1024, eps_t = 1/2"
    assert notes(fit) == [f"left out, good in less than half of the realisations: {case}"]
    assert (fit["n_cases"], fit["n_realisations"], fit["n_excluded"]) == (12, 12, 7)
    half = fit_tfc(fails(dataset, case=2, realisation=slice(0, 6)), fixed=ALPHA)
    assert (half["n_cases"], half["n_realisations"], half["n_excluded"]) == (13, 6, 6)


def test_realisations_not_run_yet_are_no_failures_of_single_cases():
    dataset = campaign(cross=CROSS, realisations=12)
    dataset["kappa"][:, 4:] = np.nan
    fit = fit_tfc(dataset, fixed=KNOWN)
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=3e-8)
    assert (fit["n_cases"], fit["n_realisations"], notes(fit)) == (13, 4, [])


def test_a_group_without_a_complete_realisation_is_refused():
    dataset = campaign(cross=CROSS, realisations=4)
    for realisation in range(4):
        dataset = fails(dataset, case=realisation, realisation=realisation)
    assert_refused(fit_tfc(dataset), "no realisation is good in all 13 cases")


def test_a_group_with_one_complete_realisation_has_no_sampling_error():
    dataset = noisy(campaign((0.3, 0.8), cross=CROSS, realisations=4), np.random.default_rng(12), spread=0.01)
    for realisation in range(3):
        dataset = fails(dataset, case=realisation, realisation=realisation)
    fit = fit_tfc(dataset, fixed=ALPHA)
    assert fit["n_realisations"].values.tolist() == [1, 4]
    assert np.isnan(fit["kappa_tfc_error"]).values.tolist() == [True, False]
    assert "sampling error is unknown (1 realisation)" in fit["message"].values[0]


def test_missing_results_do_not_break_the_pairing():
    """A case that lost realisations with large offsets must not inherit the offset of those that remain."""
    rng = np.random.default_rng(10)
    dataset = campaign(cross=CROSS, realisations=20)
    offset = 10 * rng.standard_normal(20)
    dataset["kappa"] = dataset["kappa"] + offset + 0.001 * rng.standard_normal(dataset["kappa"].shape)
    broken = fails(dataset, case=2, realisation=np.argsort(offset)[10:])
    fit = fit_tfc(broken, fixed=ALPHA)
    assert fit["n_cases"] == 13
    np.testing.assert_allclose(fit["C"].values[0], list(C.values()), rtol=0.05)


def test_a_case_that_failed_entirely_is_left_out_by_name():
    dataset = fails(campaign(cross=CROSS, realisations=6), case=4)
    fit = fit_tfc(dataset, fixed=KNOWN)
    assert notes(fit) == ["left out, no good realisation: eps_c = 1/2, eps_f = 1/512, eps_t = 1/2"]
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=3e-8)
    assert fit["n_cases"] == 12
    assert fit["n_excluded"] == 6


def test_a_failed_reference_still_fixes_where_corrections_are_quoted():
    dataset = campaign(cross=CROSS, levels=LEVELS | {"eps_t": [1, 1 / 4, 1 / 8]})
    fit = fit_tfc(fails(dataset, case=0), fixed=KNOWN)
    np.testing.assert_allclose(fit["kappa_tfc"], 2.0, atol=3e-8)
    np.testing.assert_allclose(fit["correction"].sel(limit="eps_t"), 0.15, rtol=1e-7)


def test_a_reference_that_failed_bridges_no_distance():
    """The limit is as far as the finest level that has results."""
    dataset = campaign(levels={"eps_f": [1 / 128, 1 / 256, 1 / 512]}, coefficients={"eps_f": C["eps_f"]})
    for failed, finest in (([], 1 / 1024), (0, 1 / 512)):
        at = fit_tfc(fails(dataset, case=failed), fixed=KNOWN).isel(group=0).sel(limit="eps_f")
        assert at["finest_eps"] == finest
        np.testing.assert_allclose(at["extrapolated"], C["eps_f"] * finest ** ALPHA["eps_f"], rtol=1e-7)


def test_a_group_that_failed_entirely_does_not_take_the_others_along():
    dataset = campaign((0.3, 0.8), cross=CROSS)
    dataset = fails(dataset, case=np.flatnonzero(dataset["hurst"].values == 0.3))
    fit = fit_tfc(dataset, fixed=KNOWN)
    assert fit["fit_status"].values.tolist() == ["refused", "ok"]
    np.testing.assert_allclose(fit["kappa_tfc"][1], 2.0, atol=3e-8)
