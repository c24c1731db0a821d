"""Fits of campaigns whose levels have different numbers of realisations."""

import numpy as np
import pytest

from gfmd_numba.analysis import fit_tfc
from gfmd_numba.analysis.gauss_markov import covariance_of_one
from support.synthetic_campaigns import ALPHA, CROSS, TFC, WANING, campaign, fails, noisy, notes

pytestmark = pytest.mark.usefixtures("laws_that_hold")


def ragged(dataset, **counts):
    """Leave each limit the number of realisations given for it."""
    asked = np.array([counts.get(str(limit), dataset.sizes["realisation"]) for limit in dataset["limit"].values])
    kept = np.arange(dataset.sizes["realisation"]) < asked[:, None]
    values = dataset["kappa"].where(kept)
    return dataset.assign(kappa=values).assign_coords(realisations=("case", asked))


@pytest.mark.long
def test_limits_with_fewer_realisations_lose_little_and_stay_unbiased():
    """Fine levels only have to tell their difference from the reference: they need fewer surfaces."""
    estimates, errors = [], []
    for seed in range(40):
        whole = noisy(campaign(realisations=120, cross=CROSS, **WANING), np.random.default_rng(seed), own=0.01)
        designs = whole, ragged(whole, eps_c=10), whole.isel(realisation=slice(10))
        fits = [fit_tfc(design, fixed=ALPHA) for design in designs]
        estimates.append([fit["kappa_tfc"].item() for fit in fits])
        errors.append([fit["kappa_tfc_error"].item() for fit in fits])
    scatter = np.std(estimates, axis=0, ddof=1)
    assert (np.abs(np.mean(estimates, axis=0) - TFC[0.8]) < 3 * scatter / np.sqrt(40)).all()
    assert scatter[1] < 1.5 * scatter[0]
    assert scatter[2] > 1.5 * scatter[0]  # ten surfaces everywhere
    stated = np.nanmean(errors, axis=0)
    np.testing.assert_allclose(stated[:2], scatter[:2], rtol=0.3)
    assert fits[1]["n_realisations"] == 10


def test_the_order_of_a_ragged_design_does_not_matter():
    whole = noisy(campaign(realisations=20), np.random.default_rng(3))
    design = ragged(whole, eps_c=5, eps_t=8)
    turned = design.isel(case=slice(None, None, -1))
    first, second = (fit_tfc(each, fixed=ALPHA)["kappa_tfc"] for each in (design, turned))
    np.testing.assert_allclose(first, second, rtol=1e-10)


def test_what_shared_surfaces_have_alike_is_no_slope():
    values = np.random.default_rng(1).standard_normal((12, 2))
    values[:4, 0], values[4:, 1] = 0.1, np.nan  # areas of few nodes: four surfaces have the same
    covariance = covariance_of_one(values)
    assert np.linalg.cond(covariance) < 100
    np.testing.assert_allclose(np.diag(covariance), np.nanvar(values, axis=0, ddof=1), rtol=1e-6)


def test_a_failure_in_a_ragged_design_is_dropped_where_it_was_asked_for():
    design = ragged(noisy(campaign(realisations=20), np.random.default_rng(3)), eps_c=5)
    fit = fit_tfc(fails(design, case=0, realisation=2), fixed=ALPHA)
    assert notes(fit) == ["1 of 20 realisations dropped, not good in every case"]
    assert (fit["n_realisations"], fit["n_excluded"]) == (4, 1)
