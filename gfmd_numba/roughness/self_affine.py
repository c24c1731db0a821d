"""Periodic self-affine profiles by the power spectral density method (thesis 3.5.2.1)."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import grid
from gfmd_numba.roughness.amplitudes import complex_gaussian

Reals = npt.NDArray[np.float64]


def profiles(hurst: float, cut_on_index: int, cut_off_index: int, nx: int, seed: int, realisations: range) -> Reals:
    """Heights `[realisation, nx]` of zero mean and unit rms gradient, in L_x.

    The amplitude falls as q^-(1/2 + H) (3.28) between the wave indices `cut_on_index` = L_x / lambda_l and
    `cut_off_index` = L_x / lambda_s,H, is constant below and zero above. Random numbers belong to (seed,
    realisation, wave index): a finer grid samples the same surface, a larger `cut_off_index` adds waves to it.
    """
    index = np.arange(1, cut_off_index + 1)
    envelope = np.maximum(index, cut_on_index) ** -(0.5 + hurst)
    spectrum = np.zeros((len(realisations), nx // 2 + 1), dtype=np.complex128)
    for row, realisation in zip(spectrum, realisations, strict=True):
        waves = envelope * complex_gaussian(seed, realisation, cut_off_index)
        waves /= np.sqrt(2.0 * np.sum((2.0 * np.pi * index) ** 2 * np.abs(waves) ** 2))
        row[index] = waves
    if 2 * cut_off_index == nx:  # at Nyquist both signs of q share one real coefficient
        spectrum[:, -1] = 2.0 * spectrum[:, -1].real
    return grid.signal(spectrum, nx)
