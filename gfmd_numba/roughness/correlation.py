"""Second-order statistics of periodic surfaces: autocorrelation, spectrum in logarithmic bins, Hurst exponent."""

from typing import Any

import numpy as np
from scipy.optimize import brentq

from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import statistics


def autocorrelation(heights: Reals, lengths: tuple[float, ...] = statistics.UNIT) -> Reals:
    """Autocorrelation R `[..., nx]` or `[..., ny, nx]` at all periodic shifts, 1 at none; heights about their mean."""
    dimension = len(lengths)
    mean: tuple[Any, ...] = (..., *(slice(0, 1),) * dimension)  # of coefficients, and no shift of shifts
    power = statistics.power(heights, lengths)
    power[mean] = 0.0
    found = grid.signal(power, *heights.shape[-dimension:])
    return np.asarray(found / found[mean])


def radial_mean(correlation: Reals, lengths: tuple[float, float]) -> tuple[Reals, Reals]:
    """Distances and means over rings of one spacing's width of a map of shifts `[ny, nx]`, up to half a period."""
    spacing = [length / n for length, n in zip(lengths, correlation.shape, strict=True)]
    y, x = (grid.shifts(n, length) for n, length in zip(correlation.shape, lengths, strict=True))
    distance = np.hypot(y[:, np.newaxis], x)
    ring = np.rint(distance / max(spacing)).astype(np.int64).ravel()
    kept = ring <= int(min(lengths) / 2.0 / max(spacing))
    count = np.bincount(ring[kept])
    sums = [np.bincount(ring[kept], values.ravel()[kept]) for values in (distance, correlation)]
    return sums[0] / count, sums[1] / count


def spectral_density(
    heights: Reals, lengths: tuple[float, ...] = statistics.UNIT, bins_per_decade: int = 10
) -> tuple[Reals, Reals, Reals]:
    """Wave numbers, spectral density C and number of independent waves of each logarithmic bin, means over the batch.

    C is in height^2 length^d, two-sided, and integrates to w^2 over all of q-space; bins without waves are left out.
    """
    q, squares, weight = _waves(heights, lengths)
    q_min = q.min()
    which = np.floor(np.log10(q / q_min * (1.0 + 1e-9)) * bins_per_decade).astype(np.int64)
    total = np.bincount(which, weight)
    full = total > 0
    mean_q = np.exp(np.bincount(which, weight * np.log(q))[full] / total[full])
    mean = np.bincount(which, weight * squares)[full] / total[full]
    batch = np.prod(heights.shape[: -len(lengths)], dtype=np.int64)
    cell = np.prod(2.0 * np.pi / np.asarray(lengths))
    return mean_q, mean / cell, total[full] / 2.0 * batch


def hurst_exponent(
    heights: Reals, q_low: float, q_high: float, lengths: tuple[float, ...] = statistics.UNIT
) -> tuple[float, float]:
    """Hurst exponent and its standard error from the waves q_low <= q <= q_high, C ~ q^-(d + 2H) (3.8).

    The most likely exponent, the power of each wave being exponentially distributed about C (Whittle), of all
    surfaces in the batch together. Raises ValueError for fewer than 3 different wave numbers.
    """
    q, squares, weight = _waves(heights, lengths)
    inside = (q >= q_low * (1.0 - 1e-9)) & (q <= q_high * (1.0 + 1e-9)) & (weight > 0)
    q, squares, weight = q[inside], squares[inside], weight[inside]
    if np.unique(q).size < 3:
        raise ValueError(f"{np.unique(q).size} wave numbers from {q_low:g} to {q_high:g}, not at least 3")
    log_q = np.log(q) - (weight * np.log(q)).sum() / weight.sum()

    def slope(exponent: float) -> float:
        tilted = weight * squares * np.exp(exponent * log_q)
        return float((tilted * log_q).sum() / tilted.sum())

    exponent = brentq(slope, -20.0, 20.0, xtol=1e-12)
    independent = np.prod(heights.shape[: -len(lengths)], dtype=np.int64) * weight / 2.0
    error = 1.0 / np.sqrt((independent * log_q**2).sum())
    return (float(exponent) - len(lengths)) / 2.0, float(error) / 2.0


def _waves(heights: Reals, lengths: tuple[float, ...]) -> tuple[Reals, Reals, Reals]:
    """Wave number, mean square coefficient over the batch and multiplicity of each wave but the mean, flat."""
    power = statistics.power(heights, lengths)
    squares = power.reshape(-1, *power.shape[-len(lengths) :]).mean(axis=0)
    weight = np.broadcast_to(grid.multiplicity(heights.shape[-1]), squares.shape)
    q = statistics.wavenumbers(heights, lengths)
    return q.ravel()[1:], squares.ravel()[1:], weight.ravel()[1:]
