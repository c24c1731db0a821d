"""Planned transforms with owned buffers: the solvers' only way into Fourier space."""

import math
import sys
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from typing import Any

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals


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
_LINE = 64  # bytes of a cache line: rows padded to it are all aligned alike, so every row has the same plan


def library_version() -> str:
    """Return the version of FFTW that makes the transforms."""
    return str(pyfftw._fftw_version_dict["64"]).removeprefix("fftw-")


def aligned_rows(rows: int, n: int, dtype: npt.DTypeLike = np.float64) -> Reals:
    """Zeroed array `[rows, n padded]` whose rows all start on a cache line."""
    line = _LINE // min(np.dtype(dtype).itemsize, 8)
    array: Reals = pyfftw.zeros_aligned((rows, -(-n // line) * line), dtype=dtype, n=_LINE)
    return array


def padded(waves: int, itemsize: int) -> int:
    """Length of rows for so many waves of a map that is an odd number of cache lines.

    Transforms along y walk from row to row, and a distance that is a power of two would map all rows onto the same few
    lines of the cache. At 4096 x 4096 nodes that halves the time.
    """
    line = _LINE // itemsize
    lines = -(-waves // line)
    return (lines + 1 - lines % 2) * line


class Convolution:
    """Product with a symbol of q on a batch: `result = inverse(symbol * forward(source))`, one plan a row.

    `shape` is (nx,) or (ny, nx); every row of a buffer is one profile or one map, flat.

    Each of the `sources` is a buffer of its own; spectrum and result are shared. All are of the precision `dtype`. Rows
    of the spectrum of a map are `padded`.

    Rows are planned one by one so that a result does not depend on the batch it was computed in. Plans use
    ESTIMATE: MEASURE picks other algorithms, hence other last bits, from run to run.
    """

    def __init__(self, rows: int, *shape: int, sources: int = 1, dtype: npt.DTypeLike = np.float64) -> None:
        self.n = n = math.prod(shape)
        self.shape = shape
        axes = tuple(range(len(shape)))
        complex_dtype = np.result_type(dtype, 1j)
        half = shape[-1] // 2 + 1
        row = half if len(shape) == 1 else padded(half, complex_dtype.itemsize)
        self._waves = waves = (*shape[:-1], row)
        self.sources = [aligned_rows(rows, n, dtype) for _ in range(sources)]
        self.result = aligned_rows(rows, n, dtype)
        self.spectrum = aligned_rows(rows, math.prod(waves), complex_dtype)
        spectra = self.spectrum[:, : math.prod(waves)].reshape(rows, *waves)[..., :half]
        self.n_transforms = np.zeros(rows, dtype=np.int64)
        self._forward = [
            [
                pyfftw.FFTW(
                    source[i, :n].reshape(shape),
                    spectra[i],
                    axes=axes,
                    flags=("FFTW_ESTIMATE",),
                )
                for i in range(rows)
            ]
            for source in self.sources
        ]
        self._inverse = [
            pyfftw.FFTW(
                spectra[i],
                self.result[i, :n].reshape(shape),
                axes=axes,
                direction="FFTW_BACKWARD",
                flags=("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT"),
            )
            for i in range(rows)
        ]

    def symbol(self, values: Reals) -> Reals:
        """Symbol `[(ny,) nx // 2 + 1]`, ready for `apply`: flat and padded, with the forward transform's 1/n."""
        symbol: Reals = np.zeros(self._waves, dtype=self.result.dtype)
        half = self.shape[-1] // 2 + 1
        symbol[..., :half] = values.reshape(*self.shape[:-1], half) / self.n
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
