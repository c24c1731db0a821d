"""Generalised least squares of kappa_tfc + sum_i C_i eps_i^alpha_i by variable projection.

Realisation r is the same random surface in every case, so the case means are strongly correlated, and a
finer eps_f or eps_t averages over more asperities, so their variances differ several-fold: each group is
whitened by its covariance. That of ten cases from thirty realisations is too noisy to be used raw: it is
shrunk towards "common offset plus independent residuals" with the weight of twice as many
pseudo-realisations as there are cases.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.optimize import least_squares
from scipy.special import expit

from gfmd_numba.analysis.exponents import Ranges
from gfmd_numba.arrays import Reals

BOUNDS = (0.1, 5.0)

_SPAN = np.log(BOUNDS[1] / BOUNDS[0])
_STARTS = (0.5, 2.0)


@dataclass(frozen=True)
class WhitenedGroup:
    """One group's whitened problem: minimise |whitener (means - [1, exp(log_ratio alpha)] beta)|."""

    means: Reals
    whitener: Reals
    log_ratio: Reals  # (case, varied limit)
    limits: NDArray[np.intp]  # index of each varied limit in the vector of exponents


def whitened(values: Reals, log_ratio: Reals, limits: NDArray[np.intp]) -> WhitenedGroup:
    """Return the block of a group's values (realisation, case), nan where a case was not asked of a realisation."""
    means, covariance = best_means(values, covariance_of_one(values))
    lower = np.linalg.cholesky(covariance)
    whitener = solve_triangular(lower, np.eye(len(lower)), lower=True)
    return WhitenedGroup(means, whitener, log_ratio, limits)


def best_means(values: Reals, covariance: Reals) -> tuple[Reals, Reals]:
    """Return the least-variance means of the cases (Gauss-Markov) and their covariance.

    Realisations that only the cheaper cases have improve the dearer ones through the covariance of the two: for
    nested levels this is multilevel Monte Carlo with the best control coefficients (Giles 2008).
    """
    present = np.isfinite(values)
    patterns, member = np.unique(present, axis=0, return_inverse=True)
    information, total = np.zeros_like(covariance), np.zeros(len(covariance))
    for index, pattern in enumerate(patterns):
        there = np.flatnonzero(pattern)
        if not there.size:
            continue
        rows = values[np.ix_(member.ravel() == index, there)]
        weight = np.linalg.inv(covariance[np.ix_(there, there)])
        information[np.ix_(there, there)] += len(rows) * weight
        total[there] += weight @ rows.sum(axis=0)
    variance = np.linalg.inv(information)
    return variance @ total, (variance + variance.T) / 2


def covariance_of_one(values: Reals) -> Reals:
    """Return the covariance (case, case) of one realisation's values, nan where there are none.

    Complete, it is the shrunk one; with cases of few realisations among others of many, the tree.
    """
    present = np.isfinite(values)
    centred = np.where(present, values - np.nanmean(values, axis=0), 0.0)
    if (centred**2).mean() <= (1e-12 * np.nanmax(abs(values))) ** 2:
        return np.eye(values.shape[1])  # one realisation or perfect data: nothing to weight by
    return _shrunk(centred) if present.all() else _tree(centred, present)


def covariance_of_levels(values: Reals) -> Reals:
    """Return the covariance (case, case) of one of the complete realisations by which a ragged design is fitted."""
    return _tree(values - values.mean(axis=0), np.isfinite(values))


def _shrunk(centred: Reals) -> Reals:
    n, n_cases = centred.shape
    sample = centred.T @ centred / max(n - 1, 1)
    own = centred - centred.mean(axis=1, keepdims=True)
    residual = (own**2).sum(axis=0) / max(n - 1, 1)
    # no case, the reference least of all, may look exact by chance, nor beside a huge common offset
    residual = residual.clip(max(0.05 * residual.mean(), 1e-12 * sample.trace()))
    between = sample[~np.eye(n_cases, dtype=bool)].mean().clip(0)
    weight = n / (n + 2 * n_cases)
    return np.asarray(weight * sample + (1 - weight) * (np.diag(residual) + between))


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
    return tree


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


def project(blocks: Sequence[WhitenedGroup], alpha: Reals) -> tuple[Reals, Reals, list[Reals]]:
    """Return residuals, their derivative to alpha (Kaufman 1975) and each block's coefficients."""
    residuals, jacobians, coefficients = [], [], []
    for block in blocks:
        powers = np.exp(block.log_ratio * alpha[block.limits])
        q, r = np.linalg.qr(block.whitener @ np.column_stack([np.ones(len(powers)), powers]))
        data = block.whitener @ block.means
        beta = solve_triangular(r, q.T @ data)
        slope = block.whitener @ (block.log_ratio * powers * beta[1:])
        jacobian = np.zeros((len(powers), alpha.size))
        jacobian[:, block.limits] = q @ (q.T @ slope) - slope
        residuals.append(data - q @ (q.T @ data))
        jacobians.append(jacobian)
        coefficients.append(beta)
    return np.concatenate(residuals), np.concatenate(jacobians), coefficients


def best_fit(blocks: Sequence[WhitenedGroup], ranges: Ranges) -> Reals:
    """Return the exponents with the least sum of squares, the free ones searched from several starts.

    An exponent known to lie in a range is searched within it, the middle its best guess.
    """
    free = ranges.free
    found = []
    for start in product(_STARTS, repeat=free.size):
        trial = ranges.middle
        trial[free] = start
        found.append(search(blocks, trial, ranges, trial))
    return min(found, key=lambda each: each[1])[0]


def search(blocks: Sequence[WhitenedGroup], alpha: Reals, ranges: Ranges, guess: Reals) -> tuple[Reals, float]:
    """Return the exponents (those not exact start from alpha, stay in their ranges) and the sum of squares.

    The distance of an exponent known to a range from its guess counts in the sum, over the range's variance: guesses
    drawn from the range, beside data drawn from the sample, give the distribution of the exponent (Bardsley, Solonen,
    Haario & Laine 2014).
    """
    moving = np.flatnonzero(~ranges.exact)
    if not moving.size:
        return alpha, 0.0
    known = np.isfinite(ranges.low[moving])
    low, high = (np.where(known, *each) for each in zip((ranges.low[moving], ranges.high[moving]), BOUNDS, strict=True))
    span = np.log(high / low)
    certainty = ranges.certainty[moving]

    def exponents(position: Reals) -> Reals:
        trial = alpha.copy()
        trial[moving] = low * np.exp(span * expit(position.clip(-20, 20)))
        return trial

    def residuals(position: Reals) -> Reals:
        trial = exponents(position)
        return np.concatenate([project(blocks, trial)[0], np.where(known, certainty * (trial - guess)[moving], 0.0)])

    def jacobian(position: Reals) -> Reals:
        trial = exponents(position)
        inside = expit(position.clip(-20, 20))
        slope: Reals = trial[moving] * span * inside * (1 - inside)
        return np.concatenate([project(blocks, trial)[1][:, moving], np.diag(certainty)]) * slope

    fraction = (np.log(alpha[moving] / low) / span).clip(1e-3, 1 - 1e-3)
    start = np.log(fraction / (1 - fraction))
    # the logistic map keeps alpha in bounds, so that MINPACK can be used: five times faster than "trf" here
    found = least_squares(residuals, start, jacobian, method="lm", ftol=1e-14, xtol=1e-14, gtol=1e-14, max_nfev=100)
    return exponents(found.x), 2 * float(found.cost)
