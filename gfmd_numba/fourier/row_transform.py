"""Transforms of profiles one after the other, with one plan for all of them."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.fourier.convolution import aligned_rows, pyfftw

_FIRST = np.zeros(1, dtype=np.int64)


class RowTransform:
    """Transforms between rows `[n padded]` of `aligned_rows` and one spectrum; plans use ESTIMATE (`Convolution`)."""

    def __init__(self, n: int) -> None:
        self.n, self.shape, self.half = n, (n,), n // 2 + 1
        self._row = aligned_rows(1, n)[0]
        self._padded = aligned_rows(1, self.half, np.complex128)
        self.spectrum = self._padded[0, : self.half]
        self._forward = pyfftw.FFTW(self._row[:n], self.spectrum, flags=("FFTW_ESTIMATE",))
        self._inverse = pyfftw.FFTW(
            self.spectrum, self._row[:n], direction="FFTW_BACKWARD", flags=("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT")
        )

    def symbol(self, values: Reals) -> Reals:
        """Symbol `[n // 2 + 1]`, ready for `apply`: with the forward transform's 1/n."""
        return np.asarray(values / self.n, dtype=np.float64)

    def forward(self, source: Reals) -> None:
        """Fill the spectrum with n times the Fourier coefficients of a row."""
        self._forward.update_arrays(source[: self.n], self.spectrum)
        self._forward.execute()

    def inverse(self, result: Reals) -> None:
        """Fill a row from the spectrum, which is lost."""
        self._inverse.update_arrays(self.spectrum, result[: self.n])
        self._inverse.execute()

    def apply(self, symbol: Reals, source: Reals, result: Reals) -> None:
        """Fill a row with the product of another with a symbol; two transforms."""
        self.forward(source)
        kernels.multiply(self._padded, symbol, _FIRST)
        self.inverse(result)
