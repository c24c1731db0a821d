"""Statistics of periodic profiles `[..., nx]` and maps `[..., ny, nx]`: moments, spectrum, correlation, distribution.

`lengths` are the periods, (L_x,) of profiles and (L_y, L_x) of maps; heights share their unit.
"""

from collections.abc import Callable, Iterator
from functools import reduce
from math import frexp, ldexp
from typing import Any

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.arrays.threads import team
from gfmd_numba.fourier import grid

UNIT = (1.0,)
# Of the curvature over two nodes, that over one: of waves of 8 nodes 1.1, of 4 up to 1.5, with peaks of pressure right
# to 6 %; of 2 nodes, or edges of grooves, 1.7 to 8, with peaks down to half of those on finer grids, areas off by 16 %
SHARP = 1.6
_ROWS = 64  # that are worked on at once


def power(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Squares |h~(q)|^2 of the kept Fourier coefficients, `[..., nx // 2 + 1]` or `[..., ny, nx // 2 + 1]`."""
    waves = grid.coefficients(heights, len(lengths))
    return np.asarray(np.square(waves.real) + np.square(waves.imag))


def wavenumbers(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Magnitudes of the wave vectors of `power`."""
    return grid.magnitudes(heights.shape[-len(lengths) :], lengths)


def spectral_moment(heights: Reals, order: int, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Moment m_n = sum_q q^n |h~(q)|^2 `[...]` over all waves but the mean, in length^(2 - n)."""
    return moment_of_power(power(heights, lengths), heights.shape[-len(lengths) :], order, lengths)


def moment_of_power(power: Reals, shape: tuple[int, ...], order: int, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Moment sum_q q^n P `[...]` over all waves but the mean, of powers laid out like those of `power`."""
    return moments_of_power(power, shape, (order,), lengths)[0]


def moments_of_power(
    power: Reals, shape: tuple[int, ...], orders: tuple[int, ...], lengths: tuple[float, ...] = UNIT
) -> list[Reals]:
    """Moments `[...]` of several even orders, as `moment_of_power` has one."""
    *across, q_x = grid.wavevectors(shape, lengths)
    q_y = across[0] if across else np.zeros((1, 1))
    batch, weight = power.shape[: -len(shape)], grid.multiplicity(shape[-1])
    rows = power.reshape(-1, len(q_y), len(weight))
    sums = np.empty((len(orders), *rows.shape[:2]))

    def add(some: slice) -> None:
        for few in _few(some):
            weighted, q_squared = weight * rows[:, few], q_y[few] ** 2 + q_x**2
            if few.start == 0:
                weighted[:, 0, 0] = 0.0  # the mean
            for k, order in enumerate(orders):
                sums[k, :, few] = (weighted * q_squared ** (order // 2)).sum(axis=-1)

    # summed row by row: a matrix product would round differently in batches of different size
    team().by_rows(add, (len(q_y), rows.size // len(q_y)))
    return [np.asarray(each.sum(axis=-1).reshape(batch)) for each in sums]


def rms_height(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Root-mean-square height `[...]` about the mean."""
    return np.sqrt(spectral_moment(heights, 0, lengths))


def rms_gradient(heights: Reals, lengths: tuple[float, ...] = UNIT, ends: tuple[bool, ...] = ()) -> Reals:
    """Root-mean-square gradient `[...]`, sqrt(sum of |q|^2 |h(q)|^2) over all waves, on maps that of the whole vector.

    Heights may end along some axes (y,) x. Source: thesis (4.2), in which square and root are missing.
    """
    if any(ends):
        fields = heights.reshape(-1, *heights.shape[-len(lengths) :])
        squares = weighed_square_gradient(fields, np.broadcast_to(1.0, fields.shape), lengths, ends)
        return np.asarray(np.sqrt(squares / fields[0].size).reshape(heights.shape[: -len(lengths)]))
    return np.sqrt(spectral_moment(heights, 2, lengths))


def median_wave(heights: Reals, lengths: tuple[float, ...] = UNIT) -> tuple[float, float]:
    """Longest wave that is needed for half of the mean square gradient, and the share of it and all shorter ones.

    To one wave number along the longest period. A pure wave has all of it.
    """
    q, weight = wavenumbers(heights, lengths), grid.multiplicity(heights.shape[-1])
    ring = np.rint(q * max(lengths) / (2.0 * np.pi)).astype(np.intp)
    of_longer = np.bincount(ring.ravel(), (weight * q**2 * power(heights, lengths)).ravel()).cumsum()
    median = max(1, int(np.searchsorted(of_longer, 0.5 * of_longer[-1])))
    return max(lengths) / median, 1.0 - float(of_longer[median - 1] / of_longer[-1])


def scaled_gradient(heights: Reals, ends: tuple[bool, ...] = ()) -> tuple[float, float]:
    """A power of two about as large as the heights, which rounds nothing, and their rms gradient in units of it."""
    scale = ldexp(1.0, frexp(np.abs(heights).max())[1] - 1)
    return scale, float(rms_gradient(heights / scale, (1.0,) * heights.ndim, ends))


def rms_curvature(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Root-mean-square second derivative of profiles, or Laplacian of maps, `[...]`, in 1 / length."""
    return np.sqrt(spectral_moment(heights, 4, lengths))


def nayak(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Nayak's parameter m0 m4 / m2^2 `[...]` of profiles, or of the profiles of a map in all directions."""
    shape = heights.shape[-len(lengths) :]
    m0, m2, m4 = moments_of_power(power(heights, lengths), shape, (0, 2, 4), lengths)
    return nayak_of_moments(m0, m2, m4, len(lengths))


def nayak_of_moments(m0: Reals, m2: Reals, m4: Reals, dimension: int) -> Reals:
    """Nayak's parameter `[...]` of the moments of profiles (dimension 1) or maps."""
    # q_x^2 and q_x^4 average to q^2/2 and 3 q^4/8 over the directions of a map
    return np.asarray(m0 * m4 / m2**2 * (0.5 * (1 + dimension)))


def distance_of_peaks(m0: Reals, m2: Reals, nayak: Reals) -> Reals:
    """Mean distance `[...]` of the peaks of a random profile, 2 pi (m2 / m4)^(1/2), by moments along its direction.

    Source: Longuet-Higgins, Phil. Trans. R. Soc. A 249:321, 1957.
    """
    return np.asarray(2.0 * np.pi * (m0 / nayak / m2) ** 0.5)


def gradient(heights: Reals, length: float = 1.0) -> Reals:
    """Spectral derivative dh/dx `[..., nx]` at the grid points, along the last axis of period `length`."""
    nx, waves = heights.shape[-1], grid.coefficients(heights)
    if nx % 2 == 0:  # the derivative of the Nyquist wave vanishes on the grid
        waves[..., -1] = 0.0
    return grid.signal(grid.derivative(waves), nx) / length


def _gradient_between_ends(heights: Reals, length: float) -> Reals:
    """Derivative along the last axis of a cubic spline, whose third derivative is continuous next to its ends."""
    from scipy.interpolate import make_interp_spline  # it takes longer to import than most contacts to solve

    nodes = np.arange(heights.shape[-1])
    return np.asarray(make_interp_spline(nodes, heights, axis=-1)(nodes, 1) * (len(nodes) / length))


def weighed_square_gradient(
    heights: Reals, weight: Reals, lengths: tuple[float, ...] = UNIT, ends: tuple[bool, ...] = ()
) -> Reals:
    """Sum over the nodes of the squared gradient times a `weight` `[realisation, (y,) x]`, `[realisation]`.

    Derivatives are spectral, or along (y,) x those of a spline where that `ends`. Lines without weight cost nothing.
    """
    found = np.zeros(len(heights))
    for axis, length in zip(range(-1, -len(lengths) - 1, -1), lengths[::-1], strict=True):
        derivative = _gradient_between_ends if ends and ends[axis] else gradient
        found += _along_lines(heights.swapaxes(axis, -1), weight.swapaxes(axis, -1), derivative, length)
    return found


def _along_lines(heights: Reals, weight: Reals, derivative: Callable[[Reals, float], Reals], length: float) -> Reals:
    """Sum over lines `[realisation, (line,) node]` that have weight of the squared derivative along them times it."""
    taken = np.nonzero(weight.any(axis=-1))
    sums = np.empty(len(taken[0]))

    def add(some: slice) -> None:
        for few in _few(some):
            lines = tuple(each[few] for each in taken)
            sums[few] = (derivative(heights[lines], length) ** 2 * weight[lines]).sum(axis=-1)

    team().by_rows(add, (len(sums), heights.shape[-1]))
    return np.asarray(np.bincount(taken[0], sums, len(heights)), dtype=np.float64)


def _few(rows: slice) -> Iterator[slice]:
    """Parts of some rows that stay in the cache, and leave the memory to the map."""
    for first in range(rows.start, rows.stop, _ROWS):
        yield slice(first, min(first + _ROWS, rows.stop))


def bends(heights: Reals, ends: tuple[bool, ...]) -> tuple[Reals, Reals]:
    """Curvatures of each node by its neighbours and by those two nodes off `[..., (y,) x]`, times the spacing squared.

    They are 0 at both ends of an axis without a period.
    """
    near, far = np.zeros(heights.shape), np.zeros(heights.shape)
    for axis, end in enumerate(ends, -len(ends)):
        for k, bend in ((1, near), (2, far)):
            bend += (np.roll(heights, k, axis) + np.roll(heights, -k, axis) - 2.0 * heights) / k**2
            if end:
                np.moveaxis(bend, axis, 0)[[0, 1, -2, -1]] = 0.0
    return near, far


def typical_slope(heights: Reals, length: float = 1.0) -> Reals:
    """Standard deviation sigma(theta) `[...]` in rad of the slope angle along each row (thesis Tab. 3.2)."""
    return np.asarray(np.arctan(gradient(heights, length)).std(axis=-1))


def scaled(
    heights: Reals, lengths: tuple[float, ...], rms_height: float | None = None, rms_gradient: float | None = None
) -> Reals:
    """Surfaces scaled one by one to an rms height or an rms gradient, whichever is given, about a zero mean.

    Raises ValueError for a flat surface.
    """
    order, wanted = (0, rms_height) if rms_gradient is None else (2, rms_gradient)
    present = np.sqrt(spectral_moment(heights, order, lengths))
    if not (present > 0.0).all():
        raise ValueError("a flat surface, which no factor makes rough")
    axes = tuple(range(-len(lengths), 0))
    centred = heights - heights.mean(axis=axes, keepdims=True)
    return np.asarray(centred * np.expand_dims(np.asarray(wanted) / present, axes))


def autocorrelation(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Autocorrelation R `[..., nx]` or `[..., ny, nx]` at all periodic shifts, 1 at none; heights about their mean."""
    dimension = len(lengths)
    mean: tuple[Any, ...] = (..., *(slice(0, 1),) * dimension)  # of coefficients, and no shift of shifts
    of_waves = power(heights, lengths)
    of_waves[mean] = 0.0
    found = grid.signal(of_waves, *heights.shape[-dimension:])
    return np.asarray(found / found[mean])


def radial_mean(correlation: Reals, lengths: tuple[float, ...]) -> tuple[Reals, Reals]:
    """Distances and means over rings of one spacing's width of all shifts `[(ny,) nx]`, up to half a period."""
    spacing = max(length / n for length, n in zip(lengths, correlation.shape, strict=True))
    along = (grid.shifts(n, length) for n, length in zip(correlation.shape, lengths, strict=True))
    distance = reduce(np.hypot, np.ix_(*along), np.zeros(1))
    ring = np.rint(distance / spacing).astype(np.int64).ravel()
    kept = ring <= int(min(lengths) / 2.0 / spacing * (1.0 + 1e-9))
    count = np.bincount(ring[kept])
    sums = [np.bincount(ring[kept], values.ravel()[kept]) for values in (distance, correlation)]
    return sums[0] / count, sums[1] / count


def spectral_density(heights: Reals, lengths: tuple[float, ...] = UNIT) -> tuple[Reals, Reals, Reals]:
    """Wave numbers, spectral density C and number of independent waves of each tenth of a decade, means over the batch.

    C is in height^2 length^d, two-sided, and integrates to w^2 over all of q-space; bins without waves are left out.
    """
    q, squares, weight = _waves(heights, lengths)
    q_min = q.min()
    which = np.floor(np.log10(q / q_min * (1.0 + 1e-9)) * 10).astype(np.int64)
    total = np.bincount(which, weight)
    full = total > 0
    mean_q = np.exp(np.bincount(which, weight * np.log(q))[full] / total[full])
    mean = np.bincount(which, weight * squares)[full] / total[full]
    batch = np.prod(heights.shape[: -len(lengths)], dtype=np.int64)
    cell = np.prod(2.0 * np.pi / np.asarray(lengths))
    return mean_q, mean / cell, total[full] / 2.0 * batch


def hurst_exponent(
    heights: Reals, q_low: float, q_high: float, lengths: tuple[float, ...] = UNIT
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
    from scipy.optimize import brentq  # it takes longer to import than most contacts to solve

    def slope(exponent: float) -> float:
        tilted = weight * squares * np.exp(exponent * log_q)
        return float((tilted * log_q).sum() / tilted.sum())

    exponent = brentq(slope, -20.0, 20.0, xtol=1e-12)
    independent = np.prod(heights.shape[: -len(lengths)], dtype=np.int64) * weight / 2.0
    error = 1.0 / np.sqrt((independent * log_q**2).sum())
    return (float(exponent) - len(lengths)) / 2.0, float(error) / 2.0


def _waves(heights: Reals, lengths: tuple[float, ...]) -> tuple[Reals, Reals, Reals]:
    """Wave number, mean square coefficient over the batch and multiplicity of each wave but the mean, flat."""
    of_waves = power(heights, lengths)
    squares = of_waves.reshape(-1, *of_waves.shape[-len(lengths) :]).mean(axis=0)
    weight = np.broadcast_to(grid.multiplicity(heights.shape[-1]), squares.shape)
    q = wavenumbers(heights, lengths)
    return q.ravel()[1:], squares.ravel()[1:], weight.ravel()[1:]
