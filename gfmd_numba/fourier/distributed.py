"""Transforms of a map whose rows processes share: along x, then an exchange of rows for columns, then along y.

mpi4py-fft would do the same, but has no wheel, and builds only where the headers of FFTW are.
"""

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.arrays.processes import Slab, exchange
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import aligned_rows, padded, pyfftw

_TOGETHER = 8  # rows, and columns, that are transformed at once, in buffers of their own for any number of processes


class SlabTransform:
    """Products of a map of ny rows and nx columns with a stiffness `symbol` of |q|, or with its inverse.

    Each process has the rows of its `slab`, and in between some columns of the waves k_x. Besides these two buffers
    there is none of the size of a slab.
    """

    def __init__(self, slab: Slab, nx: int, symbol: Callable[[Reals], Reals]) -> None:
        self.slab, self.shape, self.transforms = slab, (slab.bounds[-1], nx), 0
        ny, half, size = slab.bounds[-1], nx // 2 + 1, slab.communicator.size
        pieces = -(-half // _TOGETHER)
        ends = [min(_TOGETHER * (pieces * each // size), half) for each in range(size + 1)]
        self._parts = [slice(*pair) for pair in pairwise(ends)]
        self.columns = self._parts[slab.communicator.rank]
        wide = [part.stop - part.start for part in self._parts]
        self._own = wide[slab.communicator.rank]
        self._of_rows, self._of_columns = [slab.rows * m for m in wide], [rows * self._own for rows in slab.counts]
        self._sent = np.empty(slab.rows * half, dtype=np.complex128)
        self._held = np.empty(ny * self._own, dtype=np.complex128)
        q_y, q_x = grid.wavevectors(self.shape, (1.0, 1.0))
        self._symbol = symbol(np.hypot(q_y[: ny // 2 + 1], q_x[:, self.columns]))
        self._rows, self._waves = aligned_rows(_TOGETHER, nx)[:, :nx], aligned_rows(_TOGETHER, half, np.complex128)
        self._waves = self._waves[:, :half]
        self._block = aligned_rows(_TOGETHER, padded(ny), np.complex128)[:, :ny]
        here = {"axes": (1,), "flags": ("FFTW_ESTIMATE",)}
        back = {"direction": "FFTW_BACKWARD"}
        self._along_x = pyfftw.FFTW(self._rows, self._waves, **here)
        self._back_along_x = pyfftw.FFTW(self._waves, self._rows, **here, **back)
        self._along_y = pyfftw.FFTW(self._block, self._block, **here)
        self._back_along_y = pyfftw.FFTW(self._block, self._block, **here, **back)

    def apply_stiffness(self, values: Reals) -> None:
        """Replace the displacement of the slab `[row, x]` by the traction that restores it."""
        self._multiply(values, divide=False)

    def apply_compliance(self, values: Reals) -> None:
        """Replace the pressure of the slab `[row, x]` by the displacement that it causes, but for the mean."""
        self._multiply(values, divide=True)

    def signal(self, waves: Complexes) -> Reals:
        """Real samples `[row, x]` of the slab from coefficients `[k_y, column]` in the columns of this process.

        They are those of `grid.signal` to the last bit.
        """
        self._held[:] = np.fft.ifft(waves, axis=0, norm="forward").ravel()
        exchange(self.slab.communicator, self._held, self._of_columns, self._sent, self._of_rows)
        found = np.empty((self.slab.rows, self.shape[1]))
        for rows, parts in self._pieces():
            self._gather(parts)
            found[rows] = np.fft.irfft(self._waves, self.shape[1], norm="forward")[: rows.stop - rows.start]
        return found

    def _multiply(self, values: Reals, divide: bool) -> None:
        for rows, parts in self._pieces():
            self._rows[: rows.stop - rows.start] = values[rows]
            self._along_x.execute()
            for part, piece in zip(self._parts, parts, strict=True):
                piece[:] = self._waves[: len(piece), part]
        communicator, held = self.slab.communicator, self._held.reshape(self.shape[0], self._own)
        exchange(communicator, self._sent, self._of_rows, self._held, self._of_columns)
        for x in range(0, self._own, _TOGETHER):
            kernels.take_columns(held, self.shape[0], x, self._block)
            self._along_y.execute()
            kernels.multiply_columns(self._block, self._symbol, x, self.shape[0] * self.shape[1], divide)
            self._back_along_y.execute()
            kernels.put_columns(self._block, x, held, self.shape[0])
        exchange(communicator, self._held, self._of_columns, self._sent, self._of_rows)
        for rows, parts in self._pieces():
            self._gather(parts)
            self._back_along_x.execute()
            values[rows] = self._rows[: rows.stop - rows.start]
        self.transforms += 2

    def _pieces(self) -> Iterator[tuple[slice, list[Complexes]]]:
        """Some rows after others, and where their waves are in what is sent to each process."""
        ends = np.cumsum([0, *self._of_rows])
        own = [self._sent[a:b].reshape(self.slab.rows, -1) for a, b in pairwise(ends.tolist())]
        for y in range(0, self.slab.rows, _TOGETHER):
            rows = slice(y, min(y + _TOGETHER, self.slab.rows))
            yield rows, [each[rows] for each in own]

    def _gather(self, parts: list[Complexes]) -> None:
        for part, piece in zip(self._parts, parts, strict=True):
            self._waves[: len(piece), part] = piece
