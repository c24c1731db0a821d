"""Band-limited interpolation of periodic heights between grids."""

import numpy as np

from gfmd_numba.arrays import Reals


def resample(heights: Reals, shape: tuple[int, ...]) -> Reals:
    """Trigonometric interpolant of periodic `[..., (y,) x]` samples on a grid of another shape.

    On a coarser grid the waves that do not fit are left out.
    """
    for axis, nx in zip(range(-len(shape), 0), shape, strict=True):
        present = heights.shape[axis]
        if nx == present:
            continue
        spectrum = np.moveaxis(np.fft.rfft(heights, axis=axis, norm="forward"), axis, -1)
        fewer = min(nx, present)
        kept = np.zeros((*spectrum.shape[:-1], nx // 2 + 1), dtype=np.complex128)
        kept[..., : fewer // 2 + 1] = spectrum[..., : fewer // 2 + 1]
        if fewer % 2 == 0:  # the wave at Nyquist of the coarser grid is one of the finer grid's pair
            kept[..., fewer // 2] = kept[..., fewer // 2] * (0.5 if nx > present else 2.0)
        heights = np.moveaxis(np.fft.irfft(kept, nx, norm="forward"), -1, axis)
    return heights
