"""Statistics of periodic profiles `[..., nx]` and maps `[..., ny, nx]`, from their Fourier coefficients.

`lengths` are the periods, (L_x,) of profiles and (L_y, L_x) of maps; heights share their unit.
"""

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid

UNIT = (1.0,)


def power(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Squares |h~(q)|^2 of the kept Fourier coefficients, `[..., nx // 2 + 1]` or `[..., ny, nx // 2 + 1]`."""
    return np.asarray(np.abs(grid.coefficients(heights, len(lengths))) ** 2)


def wavenumbers(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Magnitudes of the wave vectors of `power`."""
    return grid.magnitudes(heights.shape[-len(lengths) :], lengths)


def spectral_moment(heights: Reals, order: int, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Moment m_n = sum_q q^n |h~(q)|^2 `[...]` over all waves but the mean, in length^(2 - n)."""
    return moment_of_power(power(heights, lengths), heights.shape[-len(lengths) :], order, lengths)


def moment_of_power(power: Reals, shape: tuple[int, ...], order: int, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Moment sum_q q^n P `[...]` over all waves but the mean, of powers laid out like those of `power`."""
    weighted = grid.multiplicity(shape[-1]) * power
    flat = weighted.reshape(*power.shape[: -len(shape)], -1)
    q = grid.magnitudes(shape, lengths)
    # summed row by row: a matrix product would round differently in batches of different size
    return np.asarray((flat[..., 1:] * q.ravel()[1:] ** order).sum(axis=-1))


def rms_height(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Root-mean-square height `[...]` about the mean."""
    return np.sqrt(spectral_moment(heights, 0, lengths))


def rms_gradient(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Root-mean-square gradient `[...]` (thesis (4.2), corrected)."""
    return np.sqrt(spectral_moment(heights, 2, lengths))


def rms_curvature(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Root-mean-square second derivative of profiles, or Laplacian of maps, `[...]`, in 1 / length."""
    return np.sqrt(spectral_moment(heights, 4, lengths))


def nayak(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Nayak's parameter m0 m4 / m2^2 `[...]` of profiles, or of the profiles of a map in all directions."""
    m0, m2, m4 = (spectral_moment(heights, order, lengths) for order in (0, 2, 4))
    return nayak_of_moments(m0, m2, m4, len(lengths))


def nayak_of_moments(m0: Reals, m2: Reals, m4: Reals, dimension: int) -> Reals:
    """Nayak's parameter `[...]` of the moments of profiles (dimension 1) or maps."""
    # q_x^2 and q_x^4 average to q^2/2 and 3 q^4/8 over the directions of a map
    return np.asarray(m0 * m4 / m2**2 * (0.5 * (1 + dimension)))


def gradient(heights: Reals, length: float = 1.0) -> Reals:
    """Spectral derivative dh/dx `[..., nx]` at the grid points, along the last axis of period `length`."""
    nx = heights.shape[-1]
    waves = grid.coefficients(heights)
    if nx % 2 == 0:  # the derivative of the Nyquist wave vanishes on the grid
        waves[..., -1] = 0.0
    return grid.signal(grid.derivative(waves), nx) / length


def gradients_of_patch(heights: Reals, lengths: tuple[float, ...] = UNIT) -> list[Reals]:
    """Derivatives of heights that end at the edges of a patch, along each axis from the last, at the nodes.

    They are those of a cubic spline through the heights.
    """
    from scipy.interpolate import CubicSpline  # takes long to load, and periodic surfaces do without

    found = []
    for axis, length in zip(range(-1, -len(lengths) - 1, -1), lengths[::-1], strict=True):
        nodes = np.arange(heights.shape[axis]) * (length / heights.shape[axis])
        found.append(np.asarray(CubicSpline(nodes, heights, axis=axis)(nodes, 1)))
    return found


def rms_gradient_of_patch(heights: Reals, lengths: tuple[float, ...] = UNIT) -> Reals:
    """Root-mean-square gradient `[...]` of heights that end at the edges of a patch."""
    squares = sum(each**2 for each in gradients_of_patch(heights, lengths))
    return np.asarray(np.sqrt(np.mean(squares, axis=tuple(range(-len(lengths), 0)))))


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
