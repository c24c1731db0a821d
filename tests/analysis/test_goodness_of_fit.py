"""Whether a law describes the means: alarms where none does, and hardly any where one does."""

import numpy as np
import pytest
import scipy
from scipy.stats import f as f_distribution

from gfmd_numba.analysis import fit_tfc
from gfmd_numba.analysis.exponent_posterior import weighed
from gfmd_numba.analysis.gauss_markov import means_of, misfit_factor
from gfmd_numba.analysis.laws import power, unseen_slope
from gfmd_numba.analysis.selection import groups_to_fit
from support.synthetic_campaigns import ALPHA, CROSS, LEVELS, WANING, campaign, noisy
from support.unseen_slope import of_unseen_slope

pytestmark = pytest.mark.usefixtures("laws_that_hold")


def factor_of(dataset, given, *others):
    """What is said of powers with given exponents, or of other laws of eps_f, and the means."""
    (group,) = groups_to_fit(dataset, "kappa", omit_nyquist=True)
    means = means_of(group, group.values)
    powers = {name: power(name, {each: np.broadcast_to(a, 2) for each, a in given.items()}) for name in means.levels}
    laws = [powers, *(powers | {"eps_f": other} for other in others)]
    return misfit_factor([group], [means], [weighed([means], each) for each in laws]), means


def alarms(n, truth, number):
    rng = np.random.default_rng(n)
    return sum(factor_of(noisy(truth, rng, spread=0.1), ALPHA)[0] > 1.0 for _ in range(number))


@pytest.mark.long
@pytest.mark.parametrize(("n", "cross", "planted"), [(12, CROSS, WANING), (60, (), {})], ids=["few", "many"])
def test_alarms_are_as_rare_for_every_number_of_realisations(n, cross, planted):
    """The covariance is shrunk, and coefficients are not quite as expected: not exactly one in twenty."""
    truth = campaign(realisations=n, cross=cross, **planted)
    assert 0.01 < alarms(n, truth, 120) / 120 < 0.11  # three standard errors of one in twenty above, and two below


@pytest.mark.parametrize("exponent", [1.0, (0.5, 1.5)], ids=["exact", "range"])
def test_chi2_is_judged_by_the_scatter_of_the_means(exponent):
    """Of one limit: the contrasts that least squares leave, with moments from the sample's covariance."""
    n, levels = 14, {"eps_c": [1 / 2, 1 / 4, 1 / 8, 1 / 16, 1 / 32]}
    dataset = noisy(campaign(levels=levels, realisations=n), np.random.default_rng(0))
    dataset["kappa"][2] += 0.03
    found, means = factor_of(dataset, {"eps_c": exponent})
    weight = means.whitener.T @ means.whitener
    chi2, form = np.inf, None
    for alpha in np.linspace(*np.broadcast_to(exponent, 2), 1 if exponent == 1.0 else 2001):
        columns = np.column_stack([np.ones(5), means.levels["eps_c"] ** alpha])
        here = weight - weight @ columns @ np.linalg.inv(columns.T @ weight @ columns) @ columns.T @ weight
        if means.values @ here @ means.values < chi2:
            chi2, form = means.values @ here @ means.values, here
    seen = form @ np.cov(dataset["kappa"].values) / n
    contrasts = np.trace(seen) ** 2 / np.trace(seen @ seen)
    left = contrasts - (exponent != 1.0)
    limit = np.trace(seen) / contrasts * left * f_distribution.ppf(0.95, left, n - 1)
    assert found == pytest.approx(chi2 / limit, rel=1e-8 if exponent == 1.0 else 1e-2)
    assert found > 1.5


def test_of_several_groups_the_one_with_the_fewest_surfaces_says_how_well_scatter_is_known(monkeypatch):
    draw, seen = np.random.default_rng(0), []
    both = [
        groups_to_fit(noisy(campaign(realisations=n), draw, spread=0.1), "kappa", omit_nyquist=True)[0]
        for n in (20, 90)
    ]
    means = [means_of(group, group.values) for group in both]
    powers = {name: power(name, {each: np.broadcast_to(a, 2) for each, a in ALPHA.items()}) for name in LEVELS}
    quantile = scipy.special.fdtri
    monkeypatch.setattr(scipy.special, "fdtri", lambda *given: seen.append(given[1]) or quantile(*given))
    misfit_factor(both, means, [weighed(means, powers)])
    assert seen == [19]


def test_errors_are_enlarged_and_it_is_said_where_no_law_describes_the_means():
    """The same in every realisation, what moves a mean leaves its scatter alone."""
    levels = {"eps_c": [1 / 2, 1 / 4, 1 / 8, 1 / 16]}
    dataset = noisy(campaign(levels=levels, realisations=30), np.random.default_rng(0), spread=0.02)
    moved = dataset.copy(deep=True)
    moved["kappa"][1] += 0.02
    plain, off = (fit_tfc(each, fixed={"eps_c": 1.1}) for each in (dataset, moved))
    factor, _ = factor_of(moved, {"eps_c": 1.1})
    assert "the means lie" not in plain["message"].item()
    far = f"{np.sqrt(factor):.3g}"
    said = (
        f"the means lie {far} times as far from the laws as their errors allow, so all errors are multiplied by {far};"
    )
    assert said in off["message"].item()
    assert (plain["misfit"].item(), off["misfit"].item()) == (1.0, pytest.approx(np.sqrt(factor)))
    assert factor > 2.0
    for error in ("kappa_tfc_error", "C_error"):
        np.testing.assert_allclose(off[error], np.sqrt(factor) * plain[error], rtol=1e-9)


def test_one_right_law_among_wrong_ones_is_enough():
    levels = LEVELS | {"eps_f": [1 / 64, 1 / 256, 1 / 1024, 1 / 4096, 1 / 16384]}
    truth = of_unseen_slope(campaign(levels=levels, realisations=40, cross=CROSS, **WANING), 0.5)
    dataset, given = noisy(truth, np.random.default_rng(2), spread=0.005, own=0.001), ALPHA | {"eps_f": (0.05, 3.0)}
    alone, both = factor_of(dataset, given)[0], factor_of(dataset, given, unseen_slope(0.5))[0]
    assert alone > 1.2
    assert both == 1.0


def test_results_without_scatter_alarm_nobody():
    assert factor_of(campaign(realisations=3, cross=CROSS), ALPHA)[0] == 1.0


def test_interactions_far_larger_than_expected_are_no_misfit_where_cross_levels_tell_them():
    planted = {("eps_c", "eps_f"): 0.9, ("eps_c", "eps_t"): -0.9}
    dataset = noisy(campaign(realisations=30, cross=CROSS, interactions=planted), np.random.default_rng(0), spread=0.02)
    assert factor_of(dataset, ALPHA)[0] == 1.0


def test_chi_squared_is_that_of_the_likeliest_law():
    """Another variable with the same numbers has powers alone, which fit these."""
    levels = LEVELS | {"eps_f": [1 / 16, 1 / 64, 1 / 256, 1 / 1024, 1 / 4096]}
    dataset = noisy(
        campaign(levels=levels, realisations=40, cross=CROSS, **WANING), np.random.default_rng(1), own=0.001
    )
    given = ALPHA | {"eps_f": (0.2, 2.0)}
    both, powers = (
        fit_tfc(dataset.assign(kappa_r=dataset["kappa"]), variable, fixed=given) for variable in ("kappa", "kappa_r")
    )
    assert both["law"].values[0].tolist()[1].startswith("power")
    assert both["chi2"].item() == pytest.approx(powers["chi2"].item(), rel=0.1)  # nodes
