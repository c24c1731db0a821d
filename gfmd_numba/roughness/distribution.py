"""Distribution of heights: moments, and how far it is from a Gaussian one (thesis 3.5.3)."""

import numpy as np
from scipy import stats

from gfmd_numba.arrays import Reals


def standardised(heights: Reals, dimension: int = 1) -> Reals:
    """Heights of each profile or map less their mean, over their rms height; ValueError for a flat surface."""
    axes = tuple(range(-dimension, 0))
    spread = heights.std(axis=axes, keepdims=True)
    if not (spread > 0.0).all():
        raise ValueError("a flat surface, which has no distribution of heights")
    return np.asarray((heights - heights.mean(axis=axes, keepdims=True)) / spread)


def skewness(heights: Reals, dimension: int = 1) -> Reals:
    """Third moment m3 / w^3 `[...]` of the heights, 0 for a Gaussian surface (thesis 3.2)."""
    return np.asarray((standardised(heights, dimension) ** 3).mean(axis=tuple(range(-dimension, 0))))


def kurtosis(heights: Reals, dimension: int = 1) -> Reals:
    """Fourth moment m4 / w^4 `[...]` of the heights, 3 for a Gaussian surface (thesis 3.2)."""
    return np.asarray((standardised(heights, dimension) ** 4).mean(axis=tuple(range(-dimension, 0))))


def gaussian_distance(heights: Reals, dimension: int = 1) -> Reals:
    """Largest difference `[...]` between the cumulative distributions of the heights and of (3.1) with their w."""
    unit = standardised(heights, dimension)
    ordered = np.sort(unit.reshape(*unit.shape[:-dimension], -1), axis=-1)
    n = ordered.shape[-1]
    expected = stats.norm.cdf(ordered)
    above = (np.arange(1, n + 1) / n - expected).max(axis=-1)
    return np.asarray(np.maximum(above, (expected - np.arange(n) / n).max(axis=-1)))
