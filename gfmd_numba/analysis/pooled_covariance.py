"""What a sample tells of variances, where cases may have different numbers of realisations."""

import numpy as np

from gfmd_numba.analysis.gauss_markov import covariance_of_levels, covariance_of_one
from gfmd_numba.arrays import Reals


def pooled_covariance(values: Reals) -> Reals:
    """Return the covariance (case, case) of one realisation from all `values` (realisation, case), nan if not asked."""
    return covariance_of_levels(values) if np.isfinite(values).all() else covariance_of_one(values)


def degrees_of_freedom(values: Reals, covariance: Reals, columns: Reals) -> float:
    """Return the effective degrees of freedom of the variance of the first coefficient of a fit (Satterthwaite 1946).

    `values` (realisation, case) are nan where a case was not asked; their `covariance` (case, case) is that of one
    realisation, and the fit has the `columns` (case, parameter). Realisations that were asked of the same cases form a
    sample of their own. Each adds its part to the variance, and has as many degrees of freedom as realisations beyond
    its cases.
    """
    patterns, sizes = np.unique(np.isfinite(values), axis=0, return_counts=True)
    parts = []
    for pattern, size in zip(patterns, sizes, strict=True):
        there = np.flatnonzero(pattern)
        information = np.zeros_like(covariance)
        information[np.ix_(there, there)] = size * np.linalg.inv(covariance[np.ix_(there, there)])
        parts.append(information)
    weights = columns @ np.linalg.pinv(columns.T @ sum(parts) @ columns, hermitian=True)[0]
    variances = np.array([weights @ information @ weights for information in parts])
    freedom = np.maximum(2, sizes - patterns.sum(axis=1))
    return float(variances.sum() ** 2 / (variances**2 / freedom).sum())
