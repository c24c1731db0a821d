"""The means of a group's cases as a fit takes them, with what is known of their errors."""

from dataclasses import replace

import numpy as np

from gfmd_numba.analysis.gauss_markov import best_means, covariance_of_one, inflation, scatter_of_means
from gfmd_numba.analysis.linear_fit import POWER_OF_WANING, Means, linear_influence
from gfmd_numba.analysis.selection import Group
from gfmd_numba.arrays import Reals
from gfmd_numba.theory.exponents import has_slope_law


def means_of(group: Group, values: Reals) -> Means:
    """Return a group's means of values (realisation, case), nan where a case was not asked of a realisation."""
    covariance = covariance_of_one(values)
    mean, of_means = best_means(values, covariance)
    waning = (
        POWER_OF_WANING[group.dimension]
        if has_slope_law(group.variable, group.parameters.get("hurst", np.nan), group.load)
        else 1.0
    )
    means = Means(mean, np.linalg.inv(np.linalg.cholesky(of_means)), group.levels, group.reference, waning)
    scatter = scatter_of(values)
    if scatter is None:
        return means
    influence, contrasts = linear_influence(means)
    fewest = int(np.isfinite(values).sum(axis=0).min())
    factor = inflation(scatter, of_means, influence, contrasts, fewest)
    return replace(means, whitener=means.whitener / np.sqrt(factor))


def scatter_of(values: Reals) -> Reals | None:
    """Return the scatter of the means of values (realisation, case); None if they have none."""
    covariance = covariance_of_one(values)
    mean, of_means = best_means(values, covariance)
    if len(values) < 2 or np.nanstd(values - mean) <= 1e-9 * np.nanmax(abs(values)):
        return None
    return scatter_of_means(values, covariance, of_means)
