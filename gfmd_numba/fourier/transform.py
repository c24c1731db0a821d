"""Planned transforms with owned buffers: the solvers' only way into Fourier space."""

import math
import sys
from collections.abc import Callable
from copy import copy
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from typing import Any, NamedTuple, Self

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Complexes, Indices, Numbers, Reals
from gfmd_numba.arrays.threads import team
from gfmd_numba.fourier.grid import wave_indices

_FIRST = np.zeros(1, dtype=np.int64)
_ROWS, _COLUMNS = 16, 8  # of a large map that are transformed together: 8 columns of 2048 nodes fit into 256 kB
_LARGE = 2**20  # nodes of a map that is transformed in pieces
_LINE = 64  # bytes of a cache line: rows padded to it are all aligned alike, so every row has the same plan

OnRows = Callable[[int, Reals], None]  # of the first of some rows of a map, and their memory


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


def library_version() -> str:
    """Return the version of FFTW that makes the transforms."""
    return str(pyfftw._fftw_version_dict["64"]).removeprefix("fftw-")


def aligned_rows(rows: int, n: int, dtype: npt.DTypeLike = np.float64) -> npt.NDArray[Any]:
    """Zeroed array `[rows, n padded]` whose rows all start on a cache line, and which takes memory where touched."""
    line, of = _LINE // 8, np.dtype(dtype)
    size = rows * -(-n // line) * line * of.itemsize
    memory = np.zeros(size + _LINE, dtype=np.uint8)
    first = -memory.ctypes.data % _LINE
    array: npt.NDArray[Any] = memory[first : first + size].view(of).reshape(rows, -1)
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
        self._waves = (*shape[:-1], padded(self.half))
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
        self._blocks: list[_Blocks] | None = None
        if in_place and (filled is not None or self.n >= _LARGE):
            self._blocks = [_Blocks(*pair, filled) for pair in zip(self.samples, kept, strict=True)]

    def symbol(self, values: Numbers) -> Numbers:
        """Symbol `[(ny,) nx // 2 + 1]`, ready for `apply`: flat and padded, with the forward transform's 1/n."""
        symbol: Numbers = np.zeros(self._waves, dtype=values.dtype)
        symbol[..., : self.half] = values.reshape(*self.shape[:-1], self.half) / self.n
        return symbol.ravel()

    def apply(self, symbol: Reals | Complexes, active: Indices, source: int = 0) -> None:
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
        plan.update_arrays(row[: self.n], self.waves[0, : self.half])
        plan.execute()

    def write(self, row: Reals) -> None:
        """Fill any row of `aligned_rows` from the first spectrum, which is lost; not counted."""
        plan = self._inverse[0]
        plan.update_arrays(self.waves[0, : self.half], row[: self.n])
        plan.execute()

    def transfer(self, symbol: Reals, source: Reals, result: Reals) -> None:
        """Fill a row with the product of another with a symbol; two transforms that are not counted."""
        self.read(source)
        kernels.multiply(self.spectrum, symbol, _FIRST)
        self.write(result)

    def apply_stiffness(self, stiffness: Reals) -> None:
        """Replace the first displacement by the traction that restores it, in place; `stiffness` is of a map."""
        self._multiply(stiffness, divide=False, filled=False)

    def apply_compliance(
        self, stiffness: Reals, filled: bool = False, load: OnRows | None = None, read: OnRows | None = None
    ) -> None:
        """Replace the first pressure by the displacement that it causes, in place; 0 at stiffness 0 or infinity.

        Of the rows that may be `filled` alone, if so asked. A `load` fills the pressure into some rows at a time. A
        `read` is given the rows of the displacement, which is then kept nowhere else.
        """
        self._multiply(stiffness, divide=True, filled=filled, load=load, read=read)

    def _multiply(
        self, symbol: Reals, divide: bool, filled: bool, load: OnRows | None = None, read: OnRows | None = None
    ) -> None:
        if self._blocks is not None:
            self._blocks[0].multiply(symbol, self.n, divide, filled, load, read)
            kernels.count(self.n_transforms, _FIRST, 2)
            return
        if load is not None:
            load(0, self.memory[0])
        self.forward(_FIRST)
        kernels.multiply_map(self.waves[0], symbol, self.n, divide)
        self.inverse(_FIRST)
        if read is not None:
            read(0, self.memory[0])

    def coarsen(
        self, coarse: "Transform", filled: bool = False, stiffness: Reals | None = None, load: OnRows | None = None
    ) -> float:
        """Fill the first samples of a transform of fewer nodes with the waves of the first map that it holds.

        A `load` fills the map into some rows at a time. What is not in the rows that may be `filled` counts as zero, if
        so asked. With a `stiffness` of maps, return the root-mean-square traction that restores the
        map, but for its mean.
        """
        power = 0.0
        ky, kx = wave_indices(coarse.shape)
        if self._blocks is not None:
            power = self._blocks[0].coarsen(ky[:, 0], coarse.waves[0, :, : kx.size], filled, stiffness, load)
            kernels.count(self.n_transforms, _FIRST, 1)
        else:
            if load is not None:
                load(0, self.memory[0])
            self.forward(_FIRST)
            coarse.waves[0, :, : kx.size] = self.waves[0, ky, kx]
            if stiffness is not None:
                power = kernels.restoring_power(self.waves[0].T, stiffness, 0)
        held = (np.abs(ky) < coarse.shape[0] / 2) & (kx < coarse.shape[1] / 2)
        coarse.waves[0, :, : kx.size] *= np.where(held, 1.0 / self.n, 0.0)
        coarse.inverse(_FIRST)
        return math.sqrt(power) / self.n

    def row(self, i: int) -> "Transform":
        """Return the transform in place of one row alone, in the same memory."""
        alone, one = copy(self), slice(i, i + 1)
        alone.spectrum, alone.waves, alone.result = self.spectrum[one], self.waves[one], self.result[one]
        alone.samples, alone.memory, alone.n_transforms = self.samples[one], self.memory[one], self.n_transforms[one]
        alone._forward, alone._inverse = [plans[one] for plans in self._forward], self._inverse[one]
        alone._blocks = None if self._blocks is None else self._blocks[one]
        return alone


class _Blocks:
    """Transforms in place of one large map, piece by piece, multiplied by a symbol that is even along y in between.

    Rows are transformed along x, some at a time, which are made or read in the cache. Then some columns at a time are
    copied, transformed along y, multiplied and transformed back, all in the cache, which saves ways to the memory. Rows
    beyond those `filled` are left out where they hold nothing. Pieces do not depend on how many threads share them.
    """

    def __init__(self, samples: Reals, waves: npt.NDArray[Any], filled: int | None) -> None:
        self._samples, self._waves, self._filled = samples, waves, filled or len(waves)
        self._lines = math.gcd(len(waves), self._filled, _ROWS)
        self._workers: list[_Worker] = []

    def coarsen(
        self, ky: Indices, found: npt.NDArray[Any], filled: bool, stiffness: Reals | None, load: OnRows | None
    ) -> float:
        """Fill the transform `[row, column]` with some rows and the first columns of that of the map.

        Return the power of what restores the map, of all columns, if there is a stiffness.
        """
        rows, columns = self._filled if filled else len(self._waves), found.shape[1]
        powers = np.zeros(-(-self._waves.shape[1] // _COLUMNS))

        def take(own: "_Worker", x: int) -> None:
            end = min(x + _COLUMNS, columns)
            if x < end:
                found[:, x:end] = own.block[: end - x, ky].T
            if stiffness is not None:
                powers[x // _COLUMNS] = kernels.restoring_power(own.block, stiffness, x)

        self._along_both(rows, columns if stiffness is None else self._waves.shape[1], load, take)
        return float(powers.sum())

    def multiply(
        self, symbol: Reals, n: int, divide: bool, filled: bool, load: OnRows | None, read: OnRows | None
    ) -> None:
        """Multiply the map by a symbol `[ky, kx]`, or `divide` it, where 0 and infinity stand for 0; and by 1/n."""
        rows = self._filled if filled else len(self._waves)

        def multiply(own: "_Worker", x: int) -> None:
            kernels.multiply_columns(own.block, symbol, x, n, divide)
            own.back_along_y.execute()
            kernels.put_columns(own.block, x, self._waves, rows)

        self._along_both(rows, self._waves.shape[1], load, multiply)
        self._back_along_x(rows, read)

    def _along_both(self, rows: int, columns: int, load: OnRows | None, work: Callable[["_Worker", int], None]) -> None:
        """Transform so many rows along x, then some columns after others along y, and do some work with these.

        The work is given the worker whose block holds the columns, and the first of them.
        """
        while len(self._workers) < team().size:
            self._workers.append(_Worker.of(self._waves, self._samples.shape[1], self._lines))

        def along_x(worker: int, first: int, last: int) -> None:
            own = self._workers[worker]
            for y in range(first * self._lines, last * self._lines, self._lines):
                some = slice(y, y + self._lines)
                if load is None:
                    own.samples[:] = self._samples[some]
                else:
                    load(y, own.rows)
                own.along_x.update_arrays(own.samples, self._waves[some])
                own.along_x.execute()

        def along_y(worker: int, first: int, last: int) -> None:
            own = self._workers[worker]
            for x in range(first * _COLUMNS, min(last * _COLUMNS, columns), _COLUMNS):
                kernels.take_columns(self._waves, rows, x, own.block)
                own.along_y.execute()
                work(own, x)

        team().share(along_x, rows // self._lines, rows * self._samples.shape[1])
        team().share(along_y, -(-columns // _COLUMNS), rows * columns)

    def _back_along_x(self, rows: int, read: OnRows | None) -> None:
        def some(worker: int, first: int, last: int) -> None:
            own = self._workers[worker]
            for y in range(first * self._lines, last * self._lines, self._lines):
                some = slice(y, y + self._lines)
                own.back_along_x.update_arrays(self._waves[some], own.samples)
                own.back_along_x.execute()
                if read is None:
                    self._samples[some] = own.samples
                else:
                    read(y, own.rows)

        team().share(some, rows // self._lines, rows * self._samples.shape[1])


class _Worker(NamedTuple):
    """What a thread has of its own: memory of some rows, which holds samples, and some columns `[x, y]` of waves.

    Its plans transform the columns in place, and rows between this memory and the map.
    """

    rows: Reals
    samples: Reals
    along_x: Any
    back_along_x: Any
    block: npt.NDArray[Any]
    along_y: Any
    back_along_y: Any

    @classmethod
    def of(cls, waves: npt.NDArray[Any], nx: int, lines: int) -> Self:
        """Make plans of the same kind for each thread; here, as planning is not meant for several at once."""
        columns, here = len(waves), {"flags": ("FFTW_ESTIMATE",)}
        back = {"direction": "FFTW_BACKWARD", "flags": ("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT")}
        line = _LINE // 16
        # an odd number of cache lines apart, as in `padded`
        block = pyfftw.zeros_aligned((_COLUMNS, (columns // line + 1 | 1) * line), dtype=waves.dtype, n=_LINE)
        block = block[:, :columns]
        rows = pyfftw.zeros_aligned((lines, 2 * padded(nx // 2 + 1)), dtype=np.float64, n=_LINE)
        samples, some = rows[:, :nx], waves[:lines]
        return cls(
            rows,
            samples,
            pyfftw.FFTW(samples, some, axes=(1,), **here),
            pyfftw.FFTW(some, samples, axes=(1,), **back),
            block,
            pyfftw.FFTW(block, block, axes=(1,), **here),
            pyfftw.FFTW(block, block, axes=(1,), **back),
        )
