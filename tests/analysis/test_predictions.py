"""The error that numbers of realisations are going to give, from results with fewer realisations of the dear cases."""

import numpy as np
import pytest
from scipy.stats import chi2

from gfmd_numba.analysis import UnusableDataError, fit_tfc
from gfmd_numba.analysis.allocation import Pilot, _Ensemble, _relative_error
from gfmd_numba.analysis.gauss_markov import degrees_of_freedom
from support.expected_interactions import drawn
from support.pilots import predictions
from support.synthetic_campaigns import ALPHA, CROSS, TFC, campaign, noisy

LEVELS = {"eps_c": [1 / 2, 1 / 4, 1 / 8], "eps_f": [1 / 512, 1 / 1024, 1 / 2048], "eps_t": [1, 1 / 2, 1 / 4]}


def results(counts, seed):
    """Results with some realisations of each case, cross levels among them where there are counts of these.

    Interactions are drawn from what is expected of them: a prediction allows for those that no cross level tells.
    """
    counts, rng = np.array(counts), np.random.default_rng(seed)
    cross = CROSS[: len(counts) - 7]
    whole = noisy(campaign(levels=LEVELS, realisations=counts.max(), cross=cross, **drawn(rng)), rng)
    kept = np.arange(counts.max()) < counts[:, None]
    return whole.assign(kappa=whole["kappa"].where(kept)).assign_coords(realisations=("case", counts))


WITHOUT_CROSS = [80, 50, 50, 120, 50, 120, 60]
SOME, MORE = [*WITHOUT_CROSS, 60, 60, 60], [300, 50, 90, 500, 60, 600, 150, 200, 200, 200]


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


@pytest.mark.long
@pytest.mark.parametrize(
    ("some", "counts"),
    [(SOME, MORE), (WITHOUT_CROSS, WITHOUT_CROSS)],
    ids=["more", "no cross level"],
)
def test_the_predicted_error_is_how_far_campaigns_are_off(some, counts):
    """It holds a factor on the scatter of the surfaces, and none on what is known before."""
    found = [fit_tfc(results(counts, 1000 + seed), fixed=ALPHA)["kappa_tfc"].item() for seed in range(24)]
    achieved = np.sqrt(np.mean((np.array(found) / TFC[0.8] - 1.0) ** 2))
    told = [predictions(results(some, seed), counts, fixed=ALPHA)[0] for seed in range(6)]
    ratio = np.array([each.error for each in told]) / achieved
    assert 0.7 < np.median(ratio) < 1.45  # two standard errors of `achieved`, which are 0.14, below, and three above


def test_few_surfaces_of_the_dear_levels_leave_their_covariance_uncertain():
    """Lavenberg and Welch: (n - 2) / (n - c - 2) on the variance, c the controls, each by its share of realisations."""
    counts = np.array([20.0, 40.0, 80.0])
    unknown = _Ensemble(np.eye(3), np.ones((3, 1)), np.zeros((3, 0)), np.zeros(1), np.arange(3), 2.0, 1.5, 30.0)
    expected = np.sqrt(1.5 * (20 - 2) / (20 - 1.5 - 2) / counts.sum()) / 2.0
    for known_exponents in (False, True):
        assert _relative_error(unknown, counts, known_exponents) == pytest.approx(expected)


def test_cross_levels_are_what_a_prediction_lacks_without_them():
    with_, without = (predictions(results(counts, 0), counts, fixed=ALPHA)[0] for counts in (SOME, WITHOUT_CROSS))
    assert with_.error < 0.7 * without.error


def test_many_realisations_leave_what_no_cross_level_tells():
    """And with cross levels next to nothing, whatever is known of the exponents."""
    without, crossed = (
        predictions(results(counts, 0), [10**9] * len(counts), fixed=ALPHA)[0] for counts in (WITHOUT_CROSS, SOME)
    )
    assert without.interactions == pytest.approx(without.error, rel=1e-3)
    assert crossed.error < 1e-3 * without.error
    assert without.exponents == crossed.exponents == pytest.approx(0.0, abs=1e-9)


def test_wide_ranges_of_exponents_are_part_of_the_error():
    levels = {"eps_f": LEVELS["eps_f"]}
    only = noisy(campaign(levels=levels, coefficients={"eps_f": 6.0}, realisations=40), np.random.default_rng(0))
    exact, wide = (predictions(only, [10**6] * 3, fixed={"eps_f": known})[0] for known in (0.6, (0.1, 4.0)))
    assert exact.exponents == pytest.approx(0.0, abs=1e-9)
    assert wide.exponents**2 > wide.error**2 / 3
    assert wide.interactions == pytest.approx(0.0, abs=1e-6)


def test_more_results_make_a_prediction_surer():
    few, many = (predictions(results(counts, 0), MORE, fixed=ALPHA)[0] for counts in ([40] * 10, MORE))
    assert few.factor == pytest.approx(np.sqrt(30 / chi2.ppf(0.1, 30)))
    assert 1.0 < many.factor < few.factor
    assert 1.0 < many.caution < few.caution


def test_shares_of_ten_cases_are_chosen_by_a_variance_that_may_be_larger():
    """By as much as 40 results leave open with 98 % confidence, as the errors of fits have noise, too."""
    (ensemble,) = Pilot.of(results([40] * 10, 0), "kappa", ALPHA).ensembles
    assert ensemble.variance_factor == pytest.approx(39 / chi2.ppf(0.02, 30))


def test_too_few_results_predict_nothing():
    with pytest.raises(UnusableDataError, match="you gave a pilot of 10 good realisations; gfmd allows at least 20"):
        predictions(results([40, 40, 40, 40, 40, 40, 10, 40, 40, 40], 0), MORE, fixed=ALPHA)
