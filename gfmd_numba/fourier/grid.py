"""The periodic grid, its waves, and *the* transform convention of the whole package.

Samples h_j stand at x_j = j L_x / n, j = 0 ... n - 1, and are periodic. Their Fourier coefficients are

    h~_k = 1/n sum_j h_j exp(-2 pi i j k / n),    h_j = sum_k h~_k exp(+2 pi i j k / n),

so that exp(i q x) with q = 2 pi k / L_x has a positive sign on the way back, d/dx multiplies by i q, and the forward
transform alone is divided by n: h~_0 is the mean, and coefficients do not change when the grid is refined.

Signals are real, h~_-k = conj(h~_k): only k = 0 ... n // 2 are kept. A sum over all waves counts each kept one as often
as `multiplicity` says, as in Parseval's theorem, 1/n sum_j h_j^2 = sum_k multiplicity_k |h~_k|^2.

Nyquist, for even n: the waves k = n/2 and -n/2 are the same on the nodes, so the last kept coefficient is real, counts
once, and holds the cosine alone. The sine vanishes on every node, and with it the derivative of the cosine.

Maps `[y, x]` are transformed along both axes and divided by ny nx. Columns are kept like the waves of profiles; rows
are k_y = 0, 1, ... and then the negative ones up to -1, with -ny/2 at the Nyquist wave of even ny. Of k_x = 0 and of
k_x at Nyquist both k_y and -k_y are kept, one the conjugate of the other, so that multiplicity depends on k_x alone.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy  # its modules load with their first use

from gfmd_numba.arrays import Complexes, Indices, Reals
from gfmd_numba.arrays.threads import team


def wave_indices(shape: tuple[int, ...]) -> tuple[Indices, ...]:
    """Wave indices (k_x,) or (k_y, k_x), ready to broadcast, of the coefficients of `[(y,) x]` samples.

    As an index into coefficients on a finer grid they find those of the same waves.
    """
    *across, nx = shape
    along_y = [(np.arange(n) + n // 2) % n - n // 2 for n in across]
    return np.ix_(*along_y, np.arange(nx // 2 + 1))


def corner(shape: tuple[int, ...]) -> Any:
    """Index of the first (ny,) nx nodes in fields `[..., (y,) x]` on a larger grid."""
    return (..., *(slice(n) for n in shape))


def some_waves(shape: tuple[int, ...], few: tuple[int, ...]) -> tuple[Indices, ...]:
    """Wave indices of a grid of `shape`, as many as one of `few` nodes has, but spread over all wavelengths.

    They tell what a symbol is to near neighbours, whatever the size of the grid. That of an odd number of nodes has no
    wave at Nyquist: the last one before stands for it.
    """
    spread = (np.round(k * (n / m)).astype(np.int64) for k, n, m in zip(wave_indices(few), shape, few, strict=True))
    return tuple(np.clip(each, -(n // 2), n // 2) for each, n in zip(spread, shape, strict=True))


def relative_cost(nodes: int, of: int) -> float:
    """Cost of a transform of some nodes over that of others, as n log n."""
    return nodes * math.log(max(nodes, 2)) / (of * math.log(of))


def wavenumbers(nx: int) -> Reals:
    """Wave numbers q = 2 pi k / L_x `[nx // 2 + 1]`, in 1/L_x."""
    return 2.0 * np.pi * np.arange(nx // 2 + 1, dtype=np.float64)


def wavevectors(shape: tuple[int, ...], lengths: tuple[float, ...]) -> tuple[Reals, ...]:
    """Components (q_x,) or (q_y, q_x), ready to broadcast, of the coefficients of `[(y,) x]` samples.

    `lengths` are the periods (L_x,) or (L_y, L_x); the result is in one over their unit.
    """
    along_y = [2.0 * np.pi * np.fft.fftfreq(n, lengths[0] / n).astype(np.float64) for n in shape[:-1]]
    return np.ix_(*along_y, wavenumbers(shape[-1]) / lengths[-1])


def magnitudes(shape: tuple[int, ...], lengths: tuple[float, ...] | None = None) -> Reals:
    """Magnitudes q = |q| `[(ny,) nx // 2 + 1]` of the wave vectors; without `lengths` in 1/L_x, all periods L_x."""
    *along_y, along_x = wavevectors(shape, (1.0,) * len(shape) if lengths is None else lengths)
    if not along_y:
        return along_x
    found = np.empty((shape[0], along_x.size))
    team().by_rows(lambda some: np.hypot(along_y[0][some], along_x, out=found[some]), found.shape)
    return found


def multiplicity(nx: int) -> Reals:
    """Weight `[nx // 2 + 1]` of kept coefficients in a sum over all waves: 1 at q_x = 0 and Nyquist, otherwise 2."""
    weight = np.full(nx // 2 + 1, 2.0)
    weight[0] = 1.0
    if nx % 2 == 0:
        weight[-1] = 1.0
    return weight


def shifts(n: int, length: float) -> Reals:
    """Smallest shifts `[n]` that take the origin to each node of a period: 0, 1, ... -1 spacings."""
    return np.fft.fftfreq(n).astype(np.float64) * length


def coefficients(samples: Reals, dimension: int = 1) -> Complexes:
    """Fourier coefficients `[..., (ny,) nx // 2 + 1]` of real samples `[..., (y,) x]`."""
    found = np.empty((*samples.shape[:-1], samples.shape[-1] // 2 + 1), dtype=np.complex128)
    _along(-1, partial(np.fft.rfft, norm="forward"), samples, found)
    for axis in range(-dimension, -1):
        _along(axis, partial(np.fft.fft, norm="forward"), found, found)
    return found


def signal(spectrum: Complexes | Reals, *shape: int) -> Reals:
    """Real samples `[..., (y,) x]` of the given shape, nx or ny, nx, from their coefficients.

    Columns that are not given are zero.
    """
    waves = spectrum
    for axis in range(-len(shape), -1):
        given, waves = waves, np.empty(waves.shape, dtype=np.complex128)
        _along(axis, partial(np.fft.ifft, norm="forward"), given, waves)
    found = np.empty((*waves.shape[:-1], shape[-1]))
    _along(-1, partial(np.fft.irfft, n=shape[-1], norm="forward"), waves, found)
    return found


def _along(axis: int, transform: Callable[..., object], given: npt.NDArray[Any], found: npt.NDArray[Any]) -> None:
    """Fill an array with transforms of another along an axis, whose lines across the other one threads share."""
    lines, filled = np.atleast_2d(given, found)
    beyond = [slice(None)] * (2 + axis)

    def some(_: int, first: int, last: int) -> None:
        piece = (..., slice(first, last), *beyond)
        transform(lines[piece], axis=axis, out=filled[piece])

    team().share(some, lines.shape[-3 - axis], found.size)


def of_half_a_period(samples: Reals, axis: int = -1, odd: bool = False) -> Reals:
    """Return n times the coefficients of samples at x_0 ... x_(n/2) that go on evenly, or oddly, beyond both ends.

    Those of odd samples are without the factor -i.
    """
    if not odd:
        return np.asarray(scipy.fft.dct(samples, type=1, axis=axis))
    inside = np.moveaxis(samples, axis, -1)[..., 1:-1]
    return np.moveaxis(np.pad(scipy.fft.dst(inside, type=1), (*((0, 0),) * (samples.ndim - 1), (1, 1))), -1, axis)


def derivative(spectrum: Complexes) -> Complexes:
    """Coefficients of the derivative along x, in 1/L_x, of those of a signal without the Nyquist wave."""
    return 1j * wavenumbers(2 * spectrum.shape[-1] - 2) * spectrum


def without_nyquist(spectrum: Complexes, shape: tuple[int, ...]) -> Complexes:
    """Coefficients `[..., (ny,) nx // 2 + 1]` on a grid of this shape, nx or ny, nx, with zero in the Nyquist waves."""
    kept = spectrum.copy()
    for axis, n in zip((-1, -2), shape[::-1], strict=False):
        if n % 2 == 0:
            np.moveaxis(kept, axis, 0)[n // 2] = 0.0
    return kept


def influence(symbol: Reals, *shape: int) -> Reals:
    """Influence coefficients `[(y,) x]` of a symbol: what one unit at the origin alone causes on every node.

    Its Fourier coefficients are 1/n each, so these are the samples with coefficients symbol / n.
    """
    return np.fft.irfftn(symbol, shape, axes=tuple(range(-len(shape), 0)))


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


def moved(samples: Reals, way: tuple[float, ...]) -> Reals:
    """Periodic samples `[..., (y,) x]` moved by a way (x,) or (x, y), in periods, as the sums of waves they are."""
    shape = samples.shape[samples.ndim - len(way) :]
    phase = sum(q * step for q, step in zip(wavevectors(shape, (1.0,) * len(shape)), way[::-1], strict=True))
    return signal(np.exp(-1j * phase) * coefficients(samples, len(shape)), *shape)


def coefficients_of_window(samples: Reals, shape: tuple[int, ...], periods: tuple[float, ...]) -> Complexes:
    """Coefficients `[..., (k_y,) k_x]`, rows as those of a grid of a shape, of samples in a window of length 1.

    The samples `[..., (y,) x]` are zero in the rest of the periods. Axes of one row have no waves.
    """
    found: Complexes = samples.astype(np.complex128)
    for axis, k, period in zip(range(-len(shape), 0), wave_indices(shape), periods, strict=True):
        n = samples.shape[axis]
        if k.size > 1:
            waves = np.exp(-2j * np.pi / (period * n) * np.outer(np.arange(n), k)) / (period * n)
            found = np.moveaxis(np.moveaxis(found, axis, -1) @ waves, -1, axis)
    return found


def signal_at(spectrum: Complexes, *places: Reals) -> Reals:
    """Real samples `[..., (y,) x]` at places (x,) or (y, x), in periods, from coefficients `[..., (k_y,) k_x]`."""
    *across, x = places
    for y in across:
        rows = spectrum.shape[-2]
        k = (np.arange(rows) + rows // 2) % rows - rows // 2
        spectrum = np.exp(2j * np.pi * np.outer(y, k)) @ spectrum
    k = np.arange(spectrum.shape[-1])
    waves = multiplicity(2 * k.size - 2)[:, np.newaxis] * np.exp(2j * np.pi * np.outer(k, x))
    return np.asarray((spectrum @ waves).real)
