"""Transforms of one map in a single buffer, which is the only array of the map's size that they need."""

import math

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.fourier.convolution import padded, pyfftw

_LINE = 64  # bytes of a cache line


def storage(maps: int, shape: tuple[int, ...], dtype: npt.DTypeLike = np.float64) -> Complexes:
    """Zeroed memory `[map, y, padded]` of as many transforms, with rows of a `padded` length."""
    waves = np.result_type(dtype, 1j)
    row = padded(shape[1] // 2 + 1, waves.itemsize)
    zeroed: Complexes = pyfftw.zeros_aligned((maps, shape[0], row), dtype=waves, n=_LINE)
    return zeroed


class InPlaceTransform:
    """Planned transforms of one map `[y, x]` that overwrite `samples` with its `spectrum` and back.

    Both are memory of the same `rows` `[y, padded]`, whose first nx columns are the samples. Plans use ESTIMATE, as in
    `convolution.py`.
    """

    def __init__(self, shape: tuple[int, ...], storage: Complexes) -> None:
        self.shape, self.n = shape, math.prod(shape)
        nx = shape[1]
        self.spectrum, self.rows = storage, storage.view(np.float32 if storage.itemsize == 8 else np.float64)
        self.samples, kept = self.rows[:, :nx], storage[:, : nx // 2 + 1]
        self.n_transforms = 0
        self._forward = pyfftw.FFTW(self.samples, kept, axes=(0, 1), flags=("FFTW_ESTIMATE",))
        self._inverse = pyfftw.FFTW(
            kept,
            self.samples,
            axes=(0, 1),
            direction="FFTW_BACKWARD",
            flags=("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT"),
        )

    def forward(self) -> None:
        """Replace the samples by their waves: ny nx times the Fourier coefficients."""
        self._forward.execute()
        self.n_transforms += 1

    def inverse(self) -> None:
        """Replace waves by ny nx times the samples that have them."""
        self._inverse.execute()
        self.n_transforms += 1

    def stiffen(self, stiffness: Reals) -> None:
        """Replace a displacement by the traction that restores it; `stiffness` is `[ny, nx // 2 + 1]`."""
        self.forward()
        kernels.stiffen(self.spectrum, stiffness, self.n)
        self.inverse()

    def soften(self, stiffness: Reals) -> None:
        """Replace a pressure by the displacement that it causes; waves of zero or infinite stiffness have none."""
        self.forward()
        kernels.soften(self.spectrum, stiffness, self.n)
        self.inverse()
