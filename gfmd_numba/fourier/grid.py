"""The periodic grid: wave numbers and *the* transform convention.

Forward transforms divide by the number of samples, so u~(q) are Fourier coefficients; real signals keep q >= 0
only, and `multiplicity` says how often each kept coefficient stands in the full sum.
"""

import numpy as np

from gfmd_numba.arrays import Complexes, Reals


def wavenumbers(nx: int) -> Reals:
    """Wave numbers q = 2 pi k / L_x, k = 0 ... nx // 2, in 1/L_x."""
    return 2.0 * np.pi * np.arange(nx // 2 + 1, dtype=np.float64)


def wavevectors(shape: tuple[int, ...], lengths: tuple[float, ...]) -> tuple[Reals, ...]:
    """Components (q_x,) or (q_y, q_x), ready to broadcast, of the coefficients of `[nx]` or `[ny, nx]` samples.

    `lengths` are the periods (L_x,) or (L_y, L_x); the result is in one over their unit.
    """
    along_x = wavenumbers(shape[-1]) / lengths[-1]
    if len(shape) == 1:
        return (along_x,)
    along_y = 2.0 * np.pi * np.fft.fftfreq(shape[0], lengths[0] / shape[0]).astype(np.float64)
    return along_y[:, np.newaxis], along_x[np.newaxis]


def magnitudes(shape: tuple[int, ...]) -> Reals:
    """Magnitudes q = |q| `[nx // 2 + 1]` or `[ny, nx // 2 + 1]` of the wave vectors, in 1/L_x of a square period."""
    return wavenumbers(shape[0]) if len(shape) == 1 else np.hypot(*wavevectors(shape, (1.0,) * len(shape)))


def multiplicity(nx: int) -> Reals:
    """Weight of each kept coefficient in a sum over all wave numbers: 1 for q = 0 and Nyquist, otherwise 2."""
    weight = np.full(nx // 2 + 1, 2.0)
    weight[0] = 1.0
    if nx % 2 == 0:
        weight[-1] = 1.0
    return weight


def coefficients(signal: Reals, dimension: int = 1) -> Complexes:
    """Fourier coefficients `[..., nx // 2 + 1]` of real signals `[..., nx]`, or of both last axes."""
    return np.fft.rfftn(signal, axes=tuple(range(-dimension, 0)), norm="forward")


def signal(spectrum: Complexes, nx: int) -> Reals:
    """Real signals `[..., nx]` of Fourier coefficients `[..., nx // 2 + 1]`."""
    return np.fft.irfft(spectrum, nx, norm="forward")
