"""Hard data for the fit: outliers, missing levels, extreme scales, contacts that the grid does not resolve."""

from functools import cache

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from gfmd_numba.analysis import fit_tfc
from gfmd_numba.analysis.gauss_markov import covariance_of_one, scatter_of_means
from support.synthetic_campaigns import REFERENCE, TFC, campaign, noisy

pytestmark = pytest.mark.usefixtures("laws_that_hold")

quick = settings(derandomize=True, deadline=None, max_examples=1)
FIXED = {"eps_c": 1.0, "eps_f": 0.6, "eps_t": 1.0}
RANGED = FIXED | {"eps_f": (0.5, 1.0)}


def measured(seed=0, **changes):
    return noisy(campaign(**({"realisations": 30} | changes)), np.random.default_rng(seed))


def fitted(dataset, **options):
    return fit_tfc(dataset, **({"fixed": FIXED} | options)).isel(group=0)


@cache
def plain_fit():
    return fitted(measured())


@given(seed=st.integers(0, 99), factor=st.floats(-30, 30))
@quick
def test_a_fit_knows_no_unit(seed, factor):
    dataset, scale = measured(seed), 10.0**factor
    plain, other = (fitted(each, fixed=RANGED) for each in (dataset, dataset.assign(kappa=scale * dataset["kappa"])))
    for name in ("kappa_tfc", "kappa_tfc_error", "correction", "reference"):
        np.testing.assert_allclose(other[name], scale * plain[name], rtol=1e-6)


@given(seed=st.integers(0, 99))
@quick
def test_a_fit_knows_no_order(seed):
    """Neither of cases nor of realisations, but for the draws of the bootstrap."""
    dataset, rng = measured(seed), np.random.default_rng(seed)
    shuffled = dataset.isel(case=rng.permutation(dataset.sizes["case"]))
    shuffled = shuffled.isel(realisation=rng.permutation(dataset.sizes["realisation"]))
    one, other = fitted(dataset), fitted(shuffled)
    for name in ("kappa_tfc", "correction", "chi2"):
        np.testing.assert_allclose(other[name], one[name], rtol=1e-6)


@given(seed=st.integers(0, 99), value=st.sampled_from([np.nan, np.inf, -np.inf, 1e300]))
@quick
def test_one_impossible_value_costs_one_realisation(seed, value):
    """Of a run that failed any value is impossible."""
    dataset = measured(seed)
    worse = dataset.copy(deep=True)
    worse["kappa"][3, 7] = value
    if np.isfinite(value):
        worse["status"][3, 7] = 1
    without = dataset.isel(realisation=np.arange(30) != 7)
    fit = fitted(worse)
    np.testing.assert_allclose(fit["kappa_tfc"], fitted(without)["kappa_tfc"], rtol=1e-6)
    assert "1 of 30 realisations dropped" in str(fit["message"].values)


@pytest.mark.parametrize("case", [0, 4])
def test_an_outlier_takes_the_weight_off_its_case(case):
    """It moves the limit by no more than the error says, which grows."""
    dataset = measured()
    worse = dataset.copy(deep=True)
    worse["kappa"][case, 7] += 20.0
    plain, other = plain_fit(), fitted(worse)
    shift = abs(float(other["kappa_tfc"] - plain["kappa_tfc"]))
    assert float(other["kappa_tfc_error"]) > float(plain["kappa_tfc_error"])
    assert shift < 3 * float(other["kappa_tfc_error"])


@pytest.mark.parametrize("missing", ["eps_c", "eps_f", "eps_t"])
def test_a_missing_level_is_named_and_the_rest_fitted(missing):
    dataset = measured()
    where = np.flatnonzero(dataset["limit"].values == missing)[0]
    dataset["kappa"][where] = np.nan
    fit = fitted(dataset)
    assert "left out, no good realisation" in str(fit["message"].values)
    assert abs(float(fit["kappa_tfc"]) - TFC[0.8]) < 5 * float(fit["kappa_tfc_error"])


def test_a_level_given_twice_counts_as_one():
    """Two cases at one level add precision, not a third level for an exponent."""
    dataset = measured()
    twice = dataset.isel(case=[*range(dataset.sizes["case"]), 1])
    np.testing.assert_allclose(fitted(twice)["kappa_tfc"], plain_fit()["kappa_tfc"], rtol=0.02)
    two = dataset.isel(case=dataset["eps_c"].isin([1 / 2, 1 / 4]).values)
    two = two.isel(case=[*range(two.sizes["case"]), 1])
    fit = fitted(two, fixed={"eps_f": 1.0, "eps_t": 1.0})
    assert fit["fit_status"] == "refused"
    assert "exponent of eps_c needs three levels, has two" in str(fit["message"].values)


@pytest.mark.parametrize(("nodes", "said"), [(1.9, True), (2.1, False), (np.inf, False)])
def test_contacts_that_the_grid_does_not_resolve_are_told(nodes, said):
    """A certified contact of single nodes has an area, but that of the grid."""
    dataset = measured()
    nx = np.full(dataset.sizes["case"], 8192)
    nodes_here = nodes * dataset["eps_c"].min() / dataset["eps_c"]  # the finest level resolves most
    segments = xr_like(dataset, 0.0 if np.isinf(nodes) else 20.0)
    counted = xr_like(dataset, 1.0) if np.isinf(nodes) else segments * nodes_here / 8192
    dataset = dataset.assign_coords(nx=("case", nx)).assign(n_segments=segments, contact_area_fraction_counted=counted)
    fit = fitted(dataset)
    message = str(fit["message"].values)
    assert ("the area is that of the grid" in message) == said
    assert (f"stretches of contact have {nodes:.2g} nodes" in message) == said
    assert fit["fit_status"] == "ok"


def xr_like(dataset, value):
    return dataset["kappa"] * 0.0 + value


def test_constant_results_have_no_corrections():
    dataset = campaign(coefficients=dict.fromkeys(REFERENCE, 0.0))
    fit = fitted(dataset)
    assert float(fit["kappa_tfc"]) == pytest.approx(TFC[0.8], rel=1e-12)
    np.testing.assert_allclose(fit["correction"], 0.0, atol=1e-12)


def test_the_covariance_is_shrunk_towards_a_common_offset_with_independent_residuals():
    """With the weight of twice as many realisations as cases; no residual below a twentieth of their mean."""
    n, cases = 12, 5
    rng = np.random.default_rng(3)
    values = rng.normal(size=(n, 1)) + np.array([1e-3, 0.2, 0.3, 1.0, 2.0]) * rng.normal(size=(n, cases))
    sample = np.cov(values, rowvar=False)
    about = values - values.mean(axis=1, keepdims=True)
    residual = about.var(axis=0, ddof=1)
    residual = np.maximum(residual, residual.mean() / 20)
    between = (sample.sum() - np.trace(sample)) / (cases * (cases - 1))
    expected = n / (n + 10) * sample + 10 / (n + 10) * (np.diag(residual) + max(between, 0.0))
    np.testing.assert_allclose(covariance_of_one(values), expected, rtol=1e-12)


def test_variances_come_from_all_values_of_a_case():
    """Variances come from all values of a case."""
    values = np.random.default_rng(4).normal(size=(400, 3)) @ [[1.0, 0.9, 0.5], [0.0, 0.3, 0.5], [0.0, 0.0, 2.0]]
    whole = covariance_of_one(values)
    values[100:, 2] = np.nan
    ragged, n = covariance_of_one(values), 100
    variance = np.nanvar(values, axis=0, ddof=1)
    floor = np.nanvar(values - np.nanmean(values, axis=0), axis=0)  # of the order of the residuals it is mixed with
    assert (abs(np.diag(ragged) - variance) < 6 / (n + 6) * 2 * floor.max()).all()
    assert (abs(ragged - whole) < 0.25 * np.sqrt(np.outer(variance, variance))).all()


def test_the_scatter_of_means_is_that_of_each_design_about_its_own_mean():
    """White's sum over realisations: what each adds to the means, less the mean of those asked of the same cases."""
    values = np.random.default_rng(5).normal(size=(7, 2)) + 3.0
    values[3:6, 1] = np.nan
    values[6, 0] = np.nan  # alone, it has no mean to take off but that of its case
    covariance, of_means = np.array([[1.0, 0.4], [0.4, 2.0]]), np.array([[0.3, 0.1], [0.1, 0.5]])
    expected = np.zeros((2, 2))
    for rows, there in ((slice(0, 3), [0, 1]), (slice(3, 6), [0]), (slice(6, 7), [1])):
        adds = [
            of_means[:, there] @ np.linalg.inv(covariance[np.ix_(there, there)]) @ row
            for row in (values[rows] - np.nanmean(values, axis=0))[:, there]
        ]
        expected += len(adds) * np.cov(adds, rowvar=False) if len(adds) > 1 else np.outer(adds[0], adds[0])
    np.testing.assert_allclose(scatter_of_means(values, covariance, of_means), expected, rtol=1e-12)


@pytest.mark.long
def test_a_campaign_in_full_contact_is_fitted():
    """Kappa is the same in every case, so that no correction is left and no exponent can be found."""
    dataset = campaign()
    alike = dataset.assign(kappa=xr.full_like(dataset["kappa"], 0.2))
    alike["reduced_pressure"] = xr.full_like(dataset["reduced_pressure"], 5.0)
    known = fit_tfc(alike, fixed={"eps_c": (1.0, 3.0), "eps_f": (0.2, 2.0), "eps_t": (0.5, 2.0)})
    np.testing.assert_allclose(known["kappa_tfc"], 0.2)
    free = fit_tfc(alike, exponents="free")
    assert "give the ranges" in str(free["message"].values)
