"""Least-variance means of the cases of a campaign, and their covariance V.

Realisation r is the same random surface in every case, so the case means are strongly correlated. A finer eps_f or
eps_t averages over more asperities, so the variances of the means differ several-fold. The fit weighs the means of a
group by V^-1. The sample covariance of ten cases from thirty realisations is too noisy to be used raw. It is shrunk
towards "common offset plus independent residuals", as if there were two pseudo-realisations more for each case.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import scipy  # its modules load with their first use
from numpy.typing import NDArray

from gfmd_numba.analysis import exponent_posterior
from gfmd_numba.analysis.exponent_posterior import ChoiceOfLaws, Means
from gfmd_numba.analysis.selection import Group
from gfmd_numba.arrays import Reals
from gfmd_numba.theory.exponent_ranges import has_slope_law


def _designs(values: Reals) -> Iterator[tuple[NDArray[np.intp], Reals]]:
    """Yield the cases that some realisations have, and their values (realisation, case) in these realisations."""
    patterns, member = np.unique(np.isfinite(values), axis=0, return_inverse=True)
    for index, pattern in enumerate(patterns):
        there = np.flatnonzero(pattern)
        if there.size:
            yield there, values[np.ix_(member.ravel() == index, there)]


def best_means(values: Reals, covariance: Reals) -> tuple[Reals, Reals]:
    """Return the least-variance means of the cases (Gauss-Markov) and their covariance.

    Realisations that only the cheaper cases have improve the dearer ones through the covariance of the two: for
    nested levels this is multilevel Monte Carlo with the best control coefficients (Giles 2008).
    """
    information, total = np.zeros_like(covariance), np.zeros(len(covariance))
    for there, rows in _designs(values):
        weight = np.linalg.inv(covariance[np.ix_(there, there)])
        information[np.ix_(there, there)] += len(rows) * weight
        total[there] += weight @ rows.sum(axis=0)
    variance = np.linalg.inv(information)
    return variance @ total, (variance + variance.T) / 2


def scatter_of_means(values: Reals, covariance: Reals, of_means: Reals) -> Reals:
    """Return the covariance (case, case) of the best means from the scatter of the realisations (White 1980).

    The weights of the means follow from the estimated `covariance` of one realisation, and so does the covariance
    `of_means`; the scatter found here does not rely on that estimate. Realisations of the same cases form a design; the
    mean of each design is subtracted.
    """
    mean, scatter = np.nanmean(values, axis=0), np.zeros_like(of_means)
    for there, rows in _designs(values):
        parts = (rows - mean[there]) @ np.linalg.solve(covariance[np.ix_(there, there)], of_means[there])
        n = len(parts)
        centred = parts - parts.mean(axis=0) if n > 1 else parts
        scatter += centred.T @ centred * (n / (n - 1) if n > 1 else 1.0)
    return scatter


def covariance_of_one(values: Reals) -> Reals:
    """Return the covariance (case, case) of one realisation's values, nan where there are none.

    If all realisations have all cases, it is the shrunk sample covariance, and otherwise that of a tree (`_tree`).
    """
    present = np.isfinite(values)
    centred = np.where(present, values - np.nanmean(values, axis=0), 0.0)
    if (centred**2).mean() <= (1e-12 * np.nanmax(abs(values))) ** 2:
        # one realisation or perfect data: nothing to weight by, and no error but rounding
        return (1e-9 * np.nanmax(abs(values))) ** 2 * np.eye(values.shape[1])
    if not present.all():
        return _tree(centred, present)
    n, n_cases = centred.shape
    sample = centred.T @ centred / max(n - 1, 1)
    own = centred - centred.mean(axis=1, keepdims=True)
    residual = (own**2).sum(axis=0) / max(n - 1, 1)
    # no case, the reference least of all, may look exact by chance, nor compared with a huge common offset
    residual = residual.clip(max(0.05 * residual.mean(), 1e-12 * sample.trace()))
    between = sample[~np.eye(n_cases, dtype=bool)].mean().clip(0)
    weight = n / (n + 2 * n_cases)
    found = weight * sample + (1 - weight) * (np.diag(residual) + between)
    return np.asarray(found + np.diag(_unseen_variance(centred, present)))


def _unseen_variance(centred: Reals, present: NDArray[np.bool_]) -> Reals:
    """Return the variance (case) that equal values may hide, 0 for cases whose values differ.

    By the rule of succession, if n realisations have one value, the next has another with probability 1 / (n + 2). We
    assume that it differs by as much as deviating values of the other cases do.
    """
    scatters = abs(centred).max(axis=0) > 1e-9 * abs(centred).max()
    if scatters.all():
        return np.zeros(len(scatters))
    off = (centred - np.nanmedian(np.where(present, centred, np.nan), axis=0))[present & scatters]
    off = off[abs(off) > 1e-9 * abs(centred).max()]
    return np.where(scatters, 0.0, (off**2).mean() / (present.sum(axis=0) + 2))


def _tree(centred: Reals, present: NDArray[np.bool_]) -> Reals:
    """Return the covariance in which each case knows the others only through its closest one (Chow and Liu 1968).

    Slopes come from the realisations that two cases share, so that dear levels with few of them follow cheap ones.
    """
    there = present.astype(float)
    counts, shared = there.sum(axis=0), there.T @ there
    offset = centred.T @ there / shared.clip(1)  # mean of case i over the realisations it shares with j
    freedom = (shared - 1).clip(1)
    joint = (centred.T @ centred - shared * offset * offset.T) / freedom
    rounding = 1e-9 * (centred**2).sum() / there.sum()  # areas of few nodes may all be alike
    variance = (((centred**2).T @ there - shared * offset**2) / freedom).clip(rounding)  # of case i over those
    correlation = abs((joint / np.sqrt(variance * variance.T)).clip(-1, 1))
    order, closest = _spanned(correlation, counts)
    unexplained = 1 - correlation[order[1:], closest] ** 2
    unexplained = unexplained.clip(max(0.05 * unexplained.mean(), 1e-12))  # no case may look exact by chance
    tree = np.diag((centred**2).sum(axis=0) / (counts - 1).clip(1))
    for position, (case, above) in enumerate(zip(order[1:], closest, strict=True), start=1):
        slope = joint[case, above] / variance[above, case]
        earlier = order[:position]
        tree[case, earlier] = tree[earlier, case] = slope * tree[above, earlier]
        tree[case, case] = slope**2 * tree[above, above] + unexplained[position - 1] * variance[case, above]
    return tree + np.diag(_unseen_variance(centred, present))


def _spanned(correlation: Reals, counts: Reals) -> tuple[list[int], list[int]]:
    """Return the cases, those of many realisations first, and the most correlated earlier one of all but the first."""
    order, closest = [int(counts.argmax())], []
    left = set(range(len(counts))) - set(order)
    while left:
        most = max(counts[case] for case in left)
        pairs = ((case, above) for case in left if counts[case] == most for above in order)
        case, above = max(pairs, key=lambda pair: correlation[pair])
        order.append(case)
        closest.append(above)
        left.remove(case)
    return order, closest


def pooled_covariance(values: Reals) -> Reals:
    """Return the covariance (case, case) of one realisation from all `values` (realisation, case), nan if not asked."""
    if np.isfinite(values).all():  # complete realisations, by which a ragged design is fitted
        return _tree(values - values.mean(axis=0), np.isfinite(values))
    return covariance_of_one(values)


def degrees_of_freedom(values: Reals, covariance: Reals, columns: Reals) -> float:
    """Return the effective degrees of freedom of the variance of the first coefficient of a fit (Satterthwaite 1946).

    `values` (realisation, case) are nan where a case was not asked; their `covariance` (case, case) is that of one
    realisation, and the fit has the `columns` (case, parameter). Realisations that were asked of the same cases form a
    sample of their own. Each adds its part to the variance, and has as many degrees of freedom as realisations beyond
    its cases.
    """
    parts, freedom = [], []
    for there, rows in _designs(values):
        information = np.zeros_like(covariance)
        information[np.ix_(there, there)] = len(rows) * np.linalg.inv(covariance[np.ix_(there, there)])
        parts.append(information)
        freedom.append(max(2, len(rows) - there.size))
    weights = columns @ np.linalg.pinv(columns.T @ sum(parts) @ columns, hermitian=True)[0]
    variances = np.array([weights @ information @ weights for information in parts])
    return float(variances.sum() ** 2 / (variances**2 / freedom).sum())


def means_of(group: Group, values: Reals) -> Means:
    """Return a group's means of values (realisation, case), nan where a case was not asked of a realisation."""
    covariance = covariance_of_one(values)
    mean, of_means = best_means(values, covariance)
    interaction_power = (
        exponent_posterior.INTERACTION_POWER[group.dimension]
        if has_slope_law(group.variable, group.parameters.get("hurst", np.nan), group.load)
        else 1.0
    )
    whitener, scatter = np.linalg.inv(np.linalg.cholesky(of_means)), _scatter(values, covariance, mean, of_means)
    means = Means(mean, whitener, group.levels, group.reference, interaction_power, scatter)
    if scatter is None:
        return means
    influence, contrasts = exponent_posterior.linear_influence(means)
    fewest = int(np.isfinite(values).sum(axis=0).min())
    ratio = (influence @ scatter @ influence) / (influence @ of_means @ influence)
    # V is only estimated, and the weights of contrasts come from the same realisations as the means; some case may have
    # few of them (Lavenberg and Welch 1981)
    factor = float(ratio * (1.0 + contrasts / fewest))
    return replace(means, whitener=means.whitener / np.sqrt(factor))


def _scatter(values: Reals, covariance: Reals, mean: Reals, of_means: Reals) -> Reals | None:
    """Return the scatter of the best means of values (realisation, case); None if they have none."""
    if len(values) < 2 or np.nanstd(values - mean) <= 1e-9 * np.nanmax(abs(values)):
        return None
    present = np.isfinite(values)
    unseen = _unseen_variance(np.where(present, values - np.nanmean(values, axis=0), 0.0), present)
    return scatter_of_means(values, covariance, of_means) + np.diag(unseen / present.sum(axis=0))


def misfit_factor(groups: Sequence[Group], means: Sequence[Means], found: Sequence[ChoiceOfLaws]) -> float:
    """Return chi^2 of the best laws over what one in twenty campaigns would exceed by chance, at least 1.

    The chi^2 is that of the means without the prior: coefficients other than expected are no misfit of a law. Its
    distribution follows from the scatter of the means, as V is only estimated (Satterthwaite 1946).
    """
    scatters = [each.scatter for each in means if each.scatter is not None]
    freedom = min(group.n_realisations for group in groups) - 1
    if freedom < 1 or len(scatters) < len(groups):
        return 1.0
    ratios = []
    for choice in found:
        best = int(np.argmin(np.sum([fit.misfit for fit in choice.fits], axis=0)))
        chi2 = expected = squares = 0.0
        for each, scatter in zip(means, scatters, strict=True):
            prior_std = exponent_posterior.prior_deviations(each, choice.laws)
            weights = exponent_posterior.misfit_form(each, choice.laws, choice.nodes[best], prior_std)
            chi2 += float(each.values @ weights @ each.values)
            form = weights @ scatter
            expected += float(np.trace(form))
            squares += float(np.trace(form @ form))
        if expected <= 0.0:
            continue
        contrasts = expected**2 / squares
        searched = sum(parameter.low < parameter.high for parameter in choice.parameters)
        expected *= max(1.0, contrasts - searched) / contrasts
        limit = expected * scipy.special.fdtri(max(1.0, contrasts - searched), freedom, 0.95)
        ratios.append(chi2 / limit)
    return max(1.0, min(ratios, default=1.0))
