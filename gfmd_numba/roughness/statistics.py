"""Statistics of periodic profiles, from their Fourier coefficients."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import grid

Reals = npt.NDArray[np.float64]


def spectral_moment(heights: Reals, order: int) -> Reals:
    """Moment m_n = sum_q q^n |h~(q)|^2 of each profile `[..., nx]`, in L_x^(2 - n)."""
    nx = heights.shape[-1]
    power = grid.multiplicity(nx) * np.abs(grid.coefficients(heights)) ** 2
    # summed row by row: a matrix product would round differently in batches of different size
    return np.asarray((power[..., 1:] * grid.wavenumbers(nx)[1:] ** order).sum(axis=-1))


def rms_gradient(heights: Reals) -> Reals:
    """Root-mean-square gradient of each profile `[..., nx]` (thesis (4.2), corrected)."""
    return np.sqrt(spectral_moment(heights, 2))


def nayak(heights: Reals) -> Reals:
    """Nayak's parameter m0 m4 / m2^2 of each profile `[..., nx]`."""
    m0, m2, m4 = (spectral_moment(heights, order) for order in (0, 2, 4))
    return np.asarray(m0 * m4 / m2**2)


def gradient(heights: Reals) -> Reals:
    """Spectral derivative dh/dx at the grid points of each profile `[..., nx]`."""
    nx = heights.shape[-1]
    slope = 1j * grid.wavenumbers(nx) * grid.coefficients(heights)
    if nx % 2 == 0:  # the derivative of the Nyquist wave vanishes on the grid
        slope[..., -1] = 0.0
    return grid.signal(slope, nx)
