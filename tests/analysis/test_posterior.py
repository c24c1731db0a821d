"""The mean over laws against what a dense grid, least squares and brute force find."""

from itertools import combinations, product

import numpy as np
import pytest
from scipy.stats import t as student

from gfmd_numba.analysis import fit_tfc
from gfmd_numba.analysis.exponent_posterior import Means, _narrowed, along, posterior_weights, weighed
from gfmd_numba.analysis.gauss_markov import means_of
from gfmd_numba.analysis.laws import power, unseen_slope
from gfmd_numba.analysis.selection import groups_to_fit
from support.synthetic_campaigns import ALPHA, CROSS, REFERENCE, WANING, campaign, noisy

pytestmark = pytest.mark.usefixtures("laws_that_hold")

EXACT = {name: (value, value) for name, value in ALPHA.items()}


def group_and_means(seed=0, spread=0.05, variable="kappa", **options):
    options = {"realisations": 30, "cross": CROSS} | options
    dataset = noisy(campaign(**options, **WANING), np.random.default_rng(seed), spread=spread, own=spread / 20)
    dataset = dataset.rename(kappa=variable)
    (group,) = groups_to_fit(dataset, variable, omit_nyquist=True)
    return dataset, group, means_of(group, group.values)


def columns_at(means, relative):
    """Columns of a fit (case, coefficient) whose laws over their value at the reference are `relative`."""
    own = [relative[name](means.levels[name]) for name in means.levels]
    return np.column_stack(
        [
            np.ones(means.values.size),
            *own,
            *products(dict(zip(means.levels, own, strict=True)), means.interaction_power),
        ]
    )


def products(laws, waning):
    """Laws of each pair of limits; that of eps_f has a power where the correction in eps_t wanes with it."""
    return [
        laws[first] ** (waning if (first, second) == ("eps_f", "eps_t") else 1.0) * laws[second]
        for first, second in combinations(laws, 2)
    ]


def ratio(exponent, name):
    return lambda eps: (eps / REFERENCE[name]) ** exponent


def least_squares(means, columns, before):
    """Generalised least squares with the scatter of the last coefficients before: coefficients, covariance, chi^2."""
    weight = means.whitener.T @ means.whitener
    known = np.zeros(columns.shape[1])
    known[-len(before) :] = before**-2.0
    covariance = np.linalg.inv(columns.T @ weight @ columns + np.diag(known))
    found = covariance @ columns.T @ weight @ means.values
    left = means.values - columns @ found
    return found, covariance, left @ weight @ left + known @ found**2


def known_before(means, relative):
    """Scatter about 0, in parts of the corrections of a fit that adds them up.

    Of the correction in eps_t, half of itself, and of interactions half of the smaller correction, but for that of
    eps_f and eps_t, which is free.
    """
    columns = columns_at(means, relative)[:, : 1 + len(means.levels)]
    weight = means.whitener.T @ means.whitener
    c, f, t = abs(np.linalg.solve(columns.T @ weight @ columns, columns.T @ weight @ means.values)[1:])
    return np.array([t / 2, min(c, f) / 2, min(c, t) / 2, np.inf])


def sizes_at(means, middle):
    return known_before(means, {name: ratio(middle[name], name) for name in means.levels})


@pytest.mark.parametrize("cross", [(), CROSS[:1], CROSS], ids=["none", "one", "all"])
def test_at_exact_exponents_a_fit_is_generalised_least_squares(cross):
    dataset, _, means = group_and_means(cross=cross)
    columns = columns_at(means, {name: ratio(ALPHA[name], name) for name in ALPHA})
    found, covariance, chi2 = least_squares(means, columns, sizes_at(means, ALPHA))
    fit = fit_tfc(dataset, fixed=ALPHA).isel(group=0)
    said = np.concatenate([[fit["kappa_tfc"]], fit["correction"], fit["interaction"]])
    errors = np.concatenate([[fit["kappa_tfc_error"]], fit["correction_error"], fit["interaction_error"]])
    scale = np.sqrt(np.diag(covariance))
    np.testing.assert_allclose(said, found, atol=1e-9 * scale.max())
    np.testing.assert_allclose(errors, scale, rtol=1e-8)
    assert fit["chi2"].item() == pytest.approx(chi2, rel=1e-6)
    half = student.ppf(0.95, 29) * scale[0]
    np.testing.assert_allclose([fit["kappa_tfc_low"], fit["kappa_tfc_high"]], [found[0] - half, found[0] + half])


def dense(means, nodes, relative_at, sizes, wholes=None):
    """Weights of nodes by their chi^2, and kappa_tfc and its variance there."""
    kappa, variance, chi2 = np.empty((3, len(nodes)))
    for index, node in enumerate(nodes):
        columns = columns_at(means, relative_at(node))
        if wholes is not None:  # kappa_tfc (1 + excess)
            law = columns[:, 1 + list(means.levels).index("eps_f")]
            columns[:, 0] += wholes(node) * law
            columns = np.delete(columns, 1 + list(means.levels).index("eps_f"), axis=1)
        found, covariance, chi2[index] = least_squares(means, columns, sizes)
        kappa[index], variance[index] = found[0], covariance[0, 0]
    return kappa, variance, chi2


def mixture(weight, kappa, variance):
    weight = weight / weight.sum()
    mean = weight @ kappa
    return mean, np.sqrt(weight @ (variance + (kappa - mean) ** 2)), weight


def quantile(share, weight, kappa, variance, freedom):
    """Where a mixture of Student's distributions reaches a share, by brute force."""
    counts = weight > 1e-7
    weight, kappa, variance = weight[counts], kappa[counts], variance[counts]
    ends = np.linspace(kappa.min() - 9 * variance.max() ** 0.5, kappa.max() + 9 * variance.max() ** 0.5, 401)
    below = [weight @ student.cdf((end - kappa) / np.sqrt(variance), freedom) for end in ends]
    return np.interp(share, below, ends)


@pytest.mark.parametrize(("seed", "spread"), [pytest.param(0, 0.2, marks=pytest.mark.long), (1, 0.05)])
def test_the_mean_over_two_exponents_is_that_of_a_dense_grid(seed, spread):
    ranges = {"eps_c": (0.5, 2.0), "eps_f": (0.3, 1.5)}
    dataset, group, means = group_and_means(seed, spread, "kappa_r", waning=1.0)
    axes = [
        low + (high - low) * (np.arange(n) + 0.5) / n for (low, high), n in zip(ranges.values(), (36, 120), strict=True)
    ]
    nodes = np.array(list(product(*axes)))
    middle = ALPHA | {name: np.mean(ends) for name, ends in ranges.items()}
    sizes = sizes_at(means, middle)

    def relative_at(node):
        exponents = ALPHA | dict(zip(ranges, node, strict=True))
        return {name: ratio(exponents[name], name) for name in ALPHA}

    kappa, variance, chi2 = dense(means, nodes, relative_at, sizes)
    mean, error, weight = mixture(np.exp(-(chi2 - chi2.min()) / 2), kappa, variance)
    fit = fit_tfc(dataset, "kappa_r", fixed=ALPHA | ranges).isel(group=0)
    assert fit["kappa_r_tfc"].item() == pytest.approx(mean, abs=0.01 * error)
    assert fit["kappa_r_tfc_error"].item() == pytest.approx(error, rel=0.01)
    ends = [quantile(share, weight, kappa, variance, group.n_realisations - 1) for share in (0.05, 0.95)]
    np.testing.assert_allclose([fit["kappa_r_tfc_low"], fit["kappa_r_tfc_high"]], ends, atol=0.02 * error)
    for axis, name in enumerate(ranges):
        alpha = fit.sel(limit=name)
        spread_of_alpha = np.sqrt(weight @ (nodes[:, axis] - weight @ nodes[:, axis]) ** 2)
        assert alpha["alpha"].item() == pytest.approx(weight @ nodes[:, axis], abs=0.02 * spread_of_alpha)
        assert alpha["alpha_error"].item() == pytest.approx(spread_of_alpha, rel=0.02)
        inside = np.array([weight[nodes[:, axis] == value].sum() for value in axes[axis]])
        given = [(weight * kappa)[nodes[:, axis] == value].sum() for value in axes[axis]]
        means_there = np.divide(given, inside, out=np.full(len(inside), mean), where=inside > 0)
        effect = np.sqrt(inside @ (means_there - mean) ** 2)
        assert fit["error_budget"].sel(source=name).item() == pytest.approx(effect, rel=0.1, abs=0.01 * error)


@pytest.mark.long
@pytest.mark.parametrize(("seed", "spread"), [(0, 0.2), (1, 0.05)])
def test_two_laws_count_by_how_well_each_fits_over_its_ranges(seed, spread):
    dataset, _, means = group_and_means(seed, spread)
    law, (low, high) = unseen_slope(0.8, 0.007), (0.3, 1.5)
    first = low + (high - low) * (np.arange(400) + 0.5)[:, np.newaxis] / 400
    cut, tail = 0.055 * np.exp(3.0 * 0.8 - 6.0 * 0.007) / 0.007**0.55, np.exp(0.25 - 0.95 * 0.8)
    cuts, tails = cut * 1.4 ** np.linspace(-5.0, 5.0, 61), np.geomspace(0.25, 2.5, 61)
    second = np.array(list(product(cuts, tails)))
    deviations = np.log(second / [cut, tail]) / np.log([1.4, 1.2])
    usual = np.exp(-(deviations**2).sum(axis=1) / 2)
    priors = [np.full(len(first), 1 / len(first)), usual / usual.sum()]
    one = {name: ratio(ALPHA[name], name) for name in ALPHA}

    def theory(node):
        at = law.value(np.array([REFERENCE["eps_f"]]), node[np.newaxis])[0, 0]
        return one | {"eps_f": lambda eps: law.value(eps, node[np.newaxis])[0] / at}

    sizes = [sizes_at(means, ALPHA | {"eps_f": 0.9}), known_before(means, theory(np.array([cut, tail])))]

    found = [
        dense(means, first, lambda node: one | {"eps_f": ratio(node[0], "eps_f")}, sizes[0]),
        dense(
            means,
            second,
            theory,
            sizes[1],
            lambda node: law.value(np.array([REFERENCE["eps_f"]]), node[np.newaxis])[0, 0],
        ),
    ]
    powers = {name: power(name, EXACT | {"eps_f": (low, high)}) for name in means.levels}
    choices = [weighed([means], laws) for laws in (powers, powers | {"eps_f": law})]
    for choice, share, prior, (value, scatter, misfit) in zip(
        choices, posterior_weights(choices), priors, found, strict=True
    ):
        inside, outside = mixture(prior * np.exp(-(misfit - misfit.min()) / 2), value, scatter)[:2]
        mine = choice.fits[0]
        its = mixture(share, mine.coefficients[:, 0], mine.covariance[:, 0, 0])[:2]
        assert its[0] == pytest.approx(inside, abs=0.02 * outside)
        assert its[1] == pytest.approx(outside, rel=0.02)
    at_reference = law.value(np.array([REFERENCE["eps_f"]]), choices[1].nodes[:, 1:3])[:, 0]
    correction = choices[1].fits[0].coefficients[:, 0] * at_reference
    np.testing.assert_allclose(choices[1].fits[0].coefficients[:, 2], correction, rtol=1e-10)
    likely = [prior @ np.exp(-(misfit - 10) / 2) for prior, (_, _, misfit) in zip(priors, found, strict=True)]
    assert posterior_weights(choices)[1].sum() == pytest.approx(likely[1] / sum(likely), rel=0.03)
    kappa, variance, chi2 = (np.concatenate(each) for each in zip(*found, strict=True))
    mean, error, _ = mixture(np.concatenate(priors) * np.exp(-(chi2 - chi2.min()) / 2), kappa, variance)
    fit = fit_tfc(dataset, fixed=ALPHA | {"eps_f": (low, high)}).isel(group=0)
    assert fit["kappa_tfc"].item() == pytest.approx(mean, abs=0.03 * error)
    assert fit["kappa_tfc_error"].item() == pytest.approx(error, rel=0.03)


@pytest.mark.long
def test_groups_that_share_exponents_weigh_them_together():
    """chi^2 of the groups add up, and so an exponent is known better than in each of them."""
    dataset = noisy(campaign((0.3, 0.8), realisations=30, **WANING), np.random.default_rng(3), spread=0.02)
    shared, free = (
        fit_tfc(dataset, exponents=how, fixed=ALPHA | {"eps_f": (0.3, 1.5)}).sel(limit="eps_f")
        for how in ("shared", "free")
    )
    groups = groups_to_fit(dataset, "kappa", omit_nyquist=True)
    exponents = np.linspace(0.3, 1.5, 2001)
    chi2 = np.zeros(len(exponents))
    for group in groups:
        means = means_of(group, group.values)
        sizes = sizes_at(means, ALPHA | {"eps_f": 0.9})
        for index, exponent in enumerate(exponents):
            columns = columns_at(means, {name: ratio((ALPHA | {"eps_f": exponent})[name], name) for name in ALPHA})
            chi2[index] += least_squares(means, columns, sizes)[2]
    weight = np.exp(-(chi2 - chi2.min()) / 2)
    weight /= weight.sum()
    mean = weight @ exponents
    error = np.sqrt(weight @ (exponents - mean) ** 2)
    np.testing.assert_allclose(shared["alpha"], mean, atol=0.01 * error)
    np.testing.assert_allclose(shared["alpha_error"], error, rtol=0.01)
    assert (shared["alpha_error"] < free["alpha_error"]).all()


def test_a_curve_passes_through_the_fit_of_each_case():
    _, _, means = group_and_means()
    choice = weighed([means], {name: power(name, EXACT) for name in means.levels})
    for name, levels in means.levels.items():
        there = np.array([levels.min(), means.reference[name]])
        found = along(choice, 0, means, name, there)[0]
        coefficients = choice.fits[0].coefficients[0]
        own = {
            other: ratio(ALPHA[other], other)(there if other == name else np.full(2, REFERENCE[other]))
            for other in ALPHA
        }
        columns = [np.ones(2), *own.values(), *products(own, means.interaction_power)]
        np.testing.assert_allclose(found, np.array(columns).T @ coefficients, rtol=1e-12)


def test_weights_of_all_laws_add_up_to_one():
    _, _, means = group_and_means()
    laws = [{name: power(name, {"eps_c": (0.5, 2.0)} | EXACT) for name in means.levels}]
    laws.append(laws[0] | {"eps_f": unseen_slope(0.8)})
    assert sum(share.sum() for share in posterior_weights([weighed([means], each) for each in laws])) == pytest.approx(
        1.0
    )


def test_results_without_scatter_have_the_limit_that_was_planted_whatever_their_weights():
    levels = {
        "eps_c": np.array([1 / 4, 1 / 2, 1.0, 1 / 4, 1 / 4]),
        "eps_t": np.array([1 / 4, 1 / 4, 1 / 4, 1 / 2, 1.0]),
    }
    values = 3.0 + 2 * levels["eps_c"] - levels["eps_t"]
    whitener = np.diag([1.0, 5.0, 0.2, 3.0, 7.0])
    choice = weighed(
        [Means(values, whitener, levels, dict.fromkeys(levels, 1 / 4))], {n: power(n, {n: (1.0, 1.0)}) for n in levels}
    )
    np.testing.assert_allclose(choice.fits[0].coefficients[0], [3.0, 0.5, -0.25, 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("likeliest", "box", "found"),
    [
        (6, (0.2, 0.4), (0.2, 0.5)),  # by half of its width
        (0, (0.2, 0.4), (0.1, 0.4)),
        (6, (0.7, 0.9), (0.7, 1.0)),  # no further than its range
        (0, (0.05, 0.25), (0.0, 0.25)),
        (3, (0.2, 0.4), "narrower"),
    ],
)
def test_a_box_grows_where_likely_parameters_lie_at_its_edge(likeliest, box, found):
    """And is narrowed to the nodes next to likely ones elsewhere."""
    misfit = np.full((7, 1), 1e3)  # of two parameters, one of which is exact
    misfit[likeliest] = 0.0
    low, high = (np.array([end, 2.0]) for end in box)
    new_low, new_high = _narrowed(misfit, low, high, np.array([[0.0, 1.0], [2.0, 2.0]]))
    assert (new_low[1], new_high[1]) == (2.0, 2.0)
    if found == "narrower":
        points = 0.2 + 0.2 * (1.0 + np.polynomial.legendre.leggauss(7)[0]) / 2.0
        found = points[2], points[4]
    assert (new_low[0], new_high[0]) == pytest.approx(found)
