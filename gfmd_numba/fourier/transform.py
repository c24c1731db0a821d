"""Planned transforms with owned buffers: the solvers' only way into Fourier space."""

import math
import sys
from copy import copy
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from typing import Any

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier.grid import wave_indices


def _compiled_pyfftw() -> Any:
    """Compiled module of pyfftw, without the interfaces for which its package imports dask.array and scipy.fftpack.

    It is registered nowhere: whoever imports pyfftw, before or after, has the whole package, and these classes in it.
    """
    name = "pyfftw.pyfftw"
    if name in sys.modules:
        return sys.modules[name]
    try:
        package = find_spec("pyfftw")
        spec = PathFinder.find_spec(name, package.submodule_search_locations) if package else None
        if spec is None or spec.loader is None:
            raise ImportError(name)
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
    except ImportError:  # the package may have to prepare it, as wheels for Windows do
        return import_module("pyfftw")
    sys.modules.pop(name, None)  # a Cython module enters itself
    return module


pyfftw = _compiled_pyfftw()
_FIRST = np.zeros(1, dtype=np.int64)
_COLUMNS = 8  # of a map that are transformed together where it is pruned: 2048 nodes of them fit into 256 kB
_LINE = 64  # bytes of a cache line: rows padded to it are all aligned alike, so every row has the same plan


def library_version() -> str:
    """Return the version of FFTW that makes the transforms."""
    return str(pyfftw._fftw_version_dict["64"]).removeprefix("fftw-")


def aligned_rows(rows: int, n: int, dtype: npt.DTypeLike = np.float64) -> npt.NDArray[Any]:
    """Zeroed array `[rows, n padded]` whose rows all start on a cache line."""
    line = _LINE // 8
    array: npt.NDArray[Any] = pyfftw.zeros_aligned((rows, -(-n // line) * line), dtype=dtype, n=_LINE)
    return array


def padded(waves: int) -> int:
    """Length of rows for so many waves of a map that is an odd number of cache lines.

    Transforms along y walk from row to row, and a distance that is a power of two would map all rows onto the same few
    lines of the cache. At 4096 x 4096 nodes that halves the time.
    """
    line = _LINE // 16
    lines = -(-waves // line)
    return (lines + 1 - lines % 2) * line


class Transform:
    """Planned transforms of profiles or maps, and their products with symbols of q: every row of a buffer is one, flat.

    `shape` is (nx,) or (ny, nx). Each of the `sources` is a buffer of its own; spectrum and result are shared. Rows of
    the spectrum of a map are `padded`.

    With `in_place` all of them are one buffer, the only one of the size of a map: a transform overwrites the `samples`
    `[row, (y,) x]` by their `waves` `[row, (y,) padded]` and back. Both are views of its `memory` of real numbers.

    Rows are planned one by one so that a result does not depend on the batch it was computed in. Plans use
    ESTIMATE: MEASURE picks other algorithms, hence other last bits, from run to run.
    """

    def __init__(
        self, rows: int, *shape: int, sources: int = 1, in_place: bool = False, filled: int | None = None
    ) -> None:
        self.shape, self.n, self.half = shape, math.prod(shape), shape[-1] // 2 + 1
        self._waves = (*shape[:-1], self.half if len(shape) == 1 else padded(self.half))
        self.spectrum = aligned_rows(rows, math.prod(self._waves), np.complex128)
        self.waves = self.spectrum[:, : math.prod(self._waves)].reshape(rows, *self._waves)
        self.memory: Reals = self.waves.view(np.float64)
        if in_place:
            self.result = self.spectrum.view(np.float64)
            self.sources, self.samples = [self.result], self.memory[..., : shape[-1]]
            samples = [self.samples]
        else:
            self.result, *self.sources = (aligned_rows(rows, self.n) for _ in range(1 + sources))
            self.samples, *samples = (each[:, : self.n].reshape(rows, *shape) for each in (self.result, *self.sources))
        self.n_transforms = np.zeros(rows, dtype=np.int64)
        kept, axes = self.waves[..., : self.half], tuple(range(len(shape)))
        self._forward = [
            [pyfftw.FFTW(*pair, axes=axes, flags=("FFTW_ESTIMATE",)) for pair in zip(each, kept, strict=True)]
            for each in samples or [self.samples]
        ]
        back = {"direction": "FFTW_BACKWARD", "flags": ("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT")}
        self._inverse = [pyfftw.FFTW(*pair, axes=axes, **back) for pair in zip(kept, self.samples, strict=True)]
        self._pruned = None if filled is None else _Pruned(self.samples[:, :filled], kept[:, :filled], shape[0])

    def symbol(self, values: Reals) -> Reals:
        """Symbol `[(ny,) nx // 2 + 1]`, ready for `apply`: flat and padded, with the forward transform's 1/n."""
        symbol: Reals = np.zeros(self._waves)
        symbol[..., : self.half] = values.reshape(*self.shape[:-1], self.half) / self.n
        return symbol.ravel()

    def apply(self, symbol: Reals, active: Indices, source: int = 0) -> None:
        """Fill the active rows of `result` from one of the sources; two transforms a row."""
        for i in active:
            self._forward[source][i].execute()
        kernels.multiply(self.spectrum, symbol, active)
        for i in active:
            self._inverse[i].execute()
        kernels.count(self.n_transforms, active, 2)

    def forward(self, active: Indices, source: int = 0) -> None:
        """Fill the active rows of `spectrum` with n times the Fourier coefficients of a source."""
        plans = self._forward[source]
        for i in active:
            plans[i].execute()
        kernels.count(self.n_transforms, active, 1)

    def inverse(self, active: Indices) -> None:
        """Fill the active rows of `result` from the `spectrum`, which is lost."""
        for i in active:
            self._inverse[i].execute()
        kernels.count(self.n_transforms, active, 1)

    def read(self, row: Reals) -> None:
        """Fill the first `spectrum` from any row of `aligned_rows`, whoever owns it; not counted."""
        plan = self._forward[0][0]
        plan.update_arrays(row[: self.n], self.waves[0])
        plan.execute()

    def write(self, row: Reals) -> None:
        """Fill any row of `aligned_rows` from the first spectrum, which is lost; not counted."""
        plan = self._inverse[0]
        plan.update_arrays(self.waves[0], row[: self.n])
        plan.execute()

    def transfer(self, symbol: Reals, source: Reals, result: Reals) -> None:
        """Fill a row with the product of another with a symbol; two transforms that are not counted."""
        self.read(source)
        kernels.multiply(self.spectrum, symbol, _FIRST)
        self.write(result)

    def stiffen(self, stiffness: Reals) -> None:
        """Replace the first displacement by the traction that restores it, in place; `stiffness` is of a map."""
        self.forward(_FIRST)
        kernels.stiffen(self.waves[0], stiffness, self.n)
        self.inverse(_FIRST)

    def soften(self, stiffness: Reals, pruned: bool = False) -> None:
        """Replace the first pressure by the displacement that it causes, in place; 0 at stiffness 0 or infinity."""
        if pruned and self._pruned is not None:
            self._pruned.soften(stiffness, self.n)
            kernels.count(self.n_transforms, _FIRST, 2)
            return
        self.forward(_FIRST)
        kernels.soften(self.waves[0], stiffness, self.n)
        self.inverse(_FIRST)

    def coarsen(self, coarse: "Transform", pruned: bool = False) -> None:
        """Fill the first samples of a transform of fewer nodes with the waves of a map that it holds; of both alone."""
        ky, kx = wave_indices(coarse.shape)
        if pruned and self._pruned is not None:
            self._pruned.some_waves(ky[:, 0], coarse.waves[0, :, : kx.size])
            kernels.count(self.n_transforms, _FIRST, 1)
        else:
            self.forward(_FIRST)
            coarse.waves[0, :, : kx.size] = self.waves[0, ky, kx]
        held = (np.abs(ky) < coarse.shape[0] / 2) & (kx < coarse.shape[1] / 2)
        coarse.waves[0, :, : kx.size] *= np.where(held, 1.0 / self.n, 0.0)
        coarse.inverse(_FIRST)

    def row(self, i: int) -> "Transform":
        """Return the transform in place of one row alone, in the same memory."""
        alone, one = copy(self), slice(i, i + 1)
        alone.spectrum, alone.waves, alone.result = self.spectrum[one], self.waves[one], self.result[one]
        alone.samples, alone.memory, alone.n_transforms = self.samples[one], self.memory[one], self.n_transforms[one]
        alone._forward, alone._inverse = [plans[one] for plans in self._forward], self._inverse[one]
        alone._pruned = None if self._pruned is None else self._pruned.row(i)
        return alone


class _Pruned:
    """Transforms of maps `[row, y, x]` in place that are zero beyond these rows of theirs, where alone they are needed.

    Rows are transformed along x. Then some columns at a time are copied, transformed along y, multiplied and
    transformed back, all in the cache: a third less work than on all rows, and fewer ways to the memory.
    """

    def __init__(self, samples: Reals, waves: npt.NDArray[Any], across: int) -> None:
        self._waves, flags = waves, ("FFTW_ESTIMATE",)
        self._block = pyfftw.zeros_aligned((across, _COLUMNS), dtype=waves.dtype, n=_LINE)
        back = {"direction": "FFTW_BACKWARD", "flags": (*flags, "FFTW_DESTROY_INPUT")}
        self._along_x = [pyfftw.FFTW(*pair, axes=(1,), flags=flags) for pair in zip(samples, waves, strict=True)]
        self._back = [pyfftw.FFTW(*pair, axes=(1,), **back) for pair in zip(waves, samples, strict=True)]
        self._along_y = pyfftw.FFTW(self._block, self._block, axes=(0,), flags=flags)
        self._back_along_y = pyfftw.FFTW(self._block, self._block, axes=(0,), **back)

    def row(self, i: int) -> "_Pruned":
        """Return the transforms of one row alone, in the same memory."""
        alone, one = copy(self), slice(i, i + 1)
        alone._waves, alone._along_x, alone._back = self._waves[one], self._along_x[one], self._back[one]
        return alone

    def some_waves(self, rows: Indices, found: npt.NDArray[Any]) -> None:
        """Fill the transform `[row, column]` of the first map with some rows and the first columns of it."""
        waves, block = self._waves[0], self._block
        filled, columns = len(waves), found.shape[1]
        self._along_x[0].execute()
        for first in range(0, columns, _COLUMNS):
            kernels.take_columns(waves, filled, first, block)
            self._along_y.execute()
            last = min(first + _COLUMNS, columns)
            found[:, first:last] = block[rows, : last - first]

    def soften(self, stiffness: Reals, n: int) -> None:
        """Replace the first pressure by the displacement that it causes, n nodes to a map."""
        waves, block = self._waves[0], self._block
        filled, columns = waves.shape
        self._along_x[0].execute()
        for first in range(0, columns, _COLUMNS):
            kernels.take_columns(waves, filled, first, block)
            self._along_y.execute()
            kernels.soften_columns(block, stiffness, first, n)
            self._back_along_y.execute()
            kernels.put_columns(block, first, waves, filled)
        self._back[0].execute()
