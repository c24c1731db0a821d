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

from gfmd_numba.analysis.selection import Array

BOUNDS = (0.1, 5.0)

_SPAN = np.log(BOUNDS[1] / BOUNDS[0])
_STARTS = (0.5, 2.0)


@dataclass(frozen=True)
class Block:
    """One group's whitened problem: minimise |whitener (means - [1, exp(log_ratio alpha)] beta)|."""

    means: Array
    whitener: Array
    log_ratio: Array  # (case, varied limit)
    limits: NDArray[np.intp]  # index of each varied limit in the vector of exponents


def whitened(values: Array, log_ratio: Array, limits: NDArray[np.intp]) -> Block:
    """Return the block of a group's values (realisation, case)."""
    lower = np.linalg.cholesky(_covariance(values) / len(values))
    whitener = solve_triangular(lower, np.eye(len(lower)), lower=True)
    return Block(values.mean(axis=0), whitener, log_ratio, limits)


def _covariance(values: Array) -> Array:
    """Return the shrunk covariance (case, case) of one realisation's values."""
    n, n_cases = values.shape
    centred = values - values.mean(axis=0)
    sample = centred.T @ centred / max(n - 1, 1)
    own = centred - centred.mean(axis=1, keepdims=True)
    residual = (own**2).sum(axis=0) / max(n - 1, 1)
    if residual.mean() <= (1e-12 * abs(values).max()) ** 2:
        return np.eye(n_cases)  # one realisation or perfect data: nothing to weight by
    # no case, the reference least of all, may look exact by chance, nor beside a huge common offset
    residual = residual.clip(max(0.05 * residual.mean(), 1e-12 * sample.trace()))
    between = sample[~np.eye(n_cases, dtype=bool)].mean().clip(0)
    weight = n / (n + 2 * n_cases)
    return np.asarray(weight * sample + (1 - weight) * (np.diag(residual) + between))


def project(blocks: Sequence[Block], alpha: Array) -> tuple[Array, Array, list[Array]]:
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


def best_fit(blocks: Sequence[Block], alpha: Array, free: NDArray[np.intp]) -> Array:
    """Return the exponents with the least sum of squares, the free ones searched from several starts."""
    found = []
    for start in product(_STARTS, repeat=free.size):
        trial = alpha.copy()
        trial[free] = start
        found.append(search(blocks, trial, free))
    return min(found, key=lambda each: each[1])[0]


def search(blocks: Sequence[Block], alpha: Array, free: NDArray[np.intp]) -> tuple[Array, float]:
    """Return the exponents (free ones start from alpha, stay inside BOUNDS) and the sum of squares."""
    if not free.size:
        return alpha, 0.0

    def exponents(position: Array) -> Array:
        trial = alpha.copy()
        trial[free] = BOUNDS[0] * np.exp(_SPAN * expit(position.clip(-20, 20)))
        return trial

    def residuals(position: Array) -> Array:
        return project(blocks, exponents(position))[0]

    def jacobian(position: Array) -> Array:
        trial = exponents(position)
        inside = expit(position.clip(-20, 20))
        slope: Array = trial[free] * _SPAN * inside * (1 - inside)
        return project(blocks, trial)[1][:, free] * slope

    fraction = (np.log(alpha[free] / BOUNDS[0]) / _SPAN).clip(1e-3, 1 - 1e-3)
    start = np.log(fraction / (1 - fraction))
    # the logistic map keeps alpha in bounds, so that MINPACK can be used: five times faster than "trf" here
    found = least_squares(residuals, start, jacobian, method="lm", ftol=1e-14, xtol=1e-14, gtol=1e-14, max_nfev=100)
    return exponents(found.x), 2 * float(found.cost)
