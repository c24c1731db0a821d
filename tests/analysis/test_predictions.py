"""The error that numbers of realisations are going to give, from results with fewer realisations of the dear cases."""

import numpy as np
import pytest
from scipy.stats import chi2

from gfmd_numba.analysis import UnusableDataError, fit_tfc, predictions
from gfmd_numba.analysis.pooled_covariance import degrees_of_freedom
from support.synthetic_campaigns import ALPHA, campaign, noisy

LEVELS = {"eps_c": [1 / 2, 1 / 4, 1 / 8], "eps_f": [1 / 512, 1 / 1024, 1 / 2048], "eps_t": [1, 1 / 2, 1 / 4]}


def results(counts, seed):
    """Results with some realisations of each case."""
    counts = np.array(counts)
    drawn = noisy(campaign(levels=LEVELS, realisations=counts.max()), np.random.default_rng(seed))
    kept = np.arange(counts.max()) < counts[:, None]
    return drawn.assign(kappa=drawn["kappa"].where(kept)).assign_coords(realisations=("case", counts))


SOME, MORE = [80, 50, 50, 120, 50, 120, 60], [300, 50, 90, 500, 60, 600, 150]


def test_as_many_realisations_of_every_case_have_the_freedom_of_a_sample():
    values = np.random.default_rng(0).standard_normal((30, 4))
    columns = np.column_stack([np.ones(4), np.arange(4.0)])
    assert degrees_of_freedom(values, np.cov(values.T), columns) == pytest.approx(26)


def test_samples_of_different_cases_add_up_as_satterthwaite_says():
    """The mean of a case in both of two samples; the other case is in one of them, and tells nothing of the first."""
    values = np.ones((50, 2))
    values[20:, 1] = np.nan
    expected = 50**2 / (20**2 / 18 + 30**2 / 29)
    assert degrees_of_freedom(values, np.eye(2), np.eye(2)) == pytest.approx(expected)


@pytest.mark.parametrize("counts", [SOME, MORE])
def test_the_predicted_error_is_the_scatter_of_campaigns(counts):
    """It takes the weights of a fit for known, so that it is a little too good; half the time the factor makes up."""
    found = [fit_tfc(results(counts, 1000 + seed), fixed=ALPHA)["kappa_tfc"].item() for seed in range(150)]
    scatter = np.std(found, ddof=1) / 2.0
    told = [predictions(results(SOME, seed), counts, fixed=ALPHA)[0] for seed in range(40)]
    ratio = np.array([each.error for each in told]) / scatter
    assert 0.85 < np.median(ratio / [each.factor for each in told]) < 1.15
    assert np.median(ratio) > 1.0


def test_more_results_make_a_prediction_surer():
    few, many = (predictions(results(counts, 0), MORE, fixed=ALPHA)[0] for counts in ([40] * 7, MORE))
    assert few.factor == pytest.approx(np.sqrt(33 / chi2.ppf(0.1, 33)))
    assert 1.0 < many.factor < few.factor
    assert 1.0 < many.caution < few.caution


def test_too_few_results_predict_nothing():
    with pytest.raises(UnusableDataError, match="given a pilot of 10 good realisations; allowed: at least 20"):
        predictions(results([40, 40, 40, 40, 40, 40, 10], 0), MORE, fixed=ALPHA)
