"""From a measured field to a periodic surface: square, gaps, trend, ends, shortest wave, grid, and what was done."""

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from gfmd_numba.arrays import Flags, Reals
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.grid import resample
from gfmd_numba.roughness.form import polynomial
from gfmd_numba.roughness.measurements import Measurement, place
from gfmd_numba.scene.checks import arrays_per_realisation, beyond_memory
from gfmd_numba.scene.units import in_unit_of
from gfmd_numba.text.numbers import counted

Detrend = Literal["none", "mean", "tilt", "curvature"]
Periodic = Literal["none", "mirror", "window"]
Fill = Literal["refuse", "interpolate"]

ORDERS: dict[Detrend, int] = {"none": -1, "mean": 0, "tilt": 1, "curvature": 2}  # of what is subtracted
MOST = 0.5  # of all heights, that may be missing: of the rest a surface is made up, not measured
_EQUAL = 1e-3  # by which sizes of the square may differ without a word: positions and sizes in files are rounded
_WHOLE = 1e-6  # of a spacing, likewise


@dataclass(frozen=True)
class Processed:
    """Heights `[nx]` or `[ny, nx]`, their periods, and a sentence for each thing that was done to them."""

    heights: Reals
    lengths: tuple[float, ...]
    done: tuple[str, ...]


def detrended(heights: Reals, detrend: Detrend) -> tuple[Reals, tuple[str, ...]]:
    """Heights less the least-squares polynomial of that name, and what was done."""
    if detrend == "none":
        return heights, ()
    if detrend == "mean":
        return heights - heights.mean(), ("subtracted the mean",)
    terms = [name for name, order in ORDERS.items() if 0 < order <= ORDERS[detrend]]
    trends = [polynomial(heights, ORDERS[name]) for name in terms]
    shares = np.diff([0.0, *(trend.var() for trend in trends)]) / (heights.var() or 1.0)
    told = (f"the {term}, {share:.2g} of the mean square height" for term, share in zip(terms, shares, strict=True))
    return heights - trends[-1], ("subtracted " + " and ".join(told),)


def made_periodic(
    heights: Reals,
    lengths: tuple[float, ...],
    periodic: Periodic = "none",
    cutoff: float | None = None,
    points: int | None = None,
    ends: tuple[bool, ...] = (),
) -> Processed:
    """Heights of a field of these sizes made periodic: mirrored or windowed, then filtered, then resampled.

    `cutoff` is the shortest wavelength kept, in the unit of `lengths`. `points` counts grid points along the last axis;
    the others have the same spacing. Along axes where the field `ends` it stays as it is: its Fourier series is that of
    the field and its mirror images, so that no wave knows of a jump between its ends. Raises ValueError for a cutoff
    that leaves all waves or none, and if resampling would leave fewer than 4 points in a direction.
    """
    ends, done = ends or (False,) * heights.ndim, []
    if periodic == "mirror":
        repeats = tuple(not end for end in ends)
        heights, lengths = mirrored(heights, repeats), _doubled(lengths, repeats)
        done.append(f"mirrored at its ends: a period holds the field, and its contacts, {2 ** sum(repeats)} times")
    if periodic == "window":
        heights = windowed(heights, ends)
        done.append("multiplied by a Hann window in each direction, and scaled back to its mean square height")
    shape = heights.shape if points is None else tuple(round(length / lengths[-1] * points) for length in lengths)
    if shape != heights.shape:
        if min(shape) < 4:
            raise ValueError(f"{_times(shape)} points after resampling, not at least 4")
        if allowed := beyond_memory(float(np.prod(shape, dtype=float)), arrays_per_realisation(len(shape), (), ends)):
            raise ValueError(f"{_times(shape)} points after resampling, not {allowed}")
    if cutoff is None and shape == heights.shape:
        return Processed(heights, lengths, tuple(done))
    (whole, sizes), images = closed(heights, lengths, ends), ", together with its mirror images" if any(ends) else ""
    if cutoff is not None:
        whole = filtered(whole, sizes, cutoff)
        done.append(f"left out all waves shorter than {in_unit_of(cutoff, cutoff)} of its Fourier series{images}")
    if shape != heights.shape:
        done.append(f"resampled from {_times(heights.shape)} to {_times(shape)} points by its Fourier series{images}")
        whole = resample(whole, tuple(2 * n if end else n for n, end in zip(shape, ends, strict=True)))
    return Processed(whole[grid.corner(shape)], lengths, tuple(done))


def closed(heights: Reals, lengths: tuple[float, ...], ends: tuple[bool, ...]) -> tuple[Reals, tuple[float, ...]]:
    """Heights and their lengths, with the mirror image along axes where they end, so that no wave knows of a jump."""
    return mirrored(heights, ends), _doubled(lengths, ends)


def _doubled(lengths: tuple[float, ...], axes: tuple[bool, ...]) -> tuple[float, ...]:
    return tuple(2.0 * length if axis else length for length, axis in zip(lengths, axes, strict=True))


def filtered(heights: Reals, lengths: tuple[float, ...], cutoff: float) -> Reals:
    """Periodic heights without the waves that are shorter than a cutoff; ValueError if that is none of them or all."""
    shape = heights.shape
    kept = grid.magnitudes(shape, lengths) <= 2.0 * np.pi / cutoff * (1.0 + 1e-9)
    if kept.all():
        raise ValueError(
            f"no wave shorter than cutoff = {in_unit_of(cutoff, cutoff)}: leave it out, or give a longer one"
        )
    if kept.sum() == 1:
        raise ValueError(
            f"no wave as long as cutoff = {in_unit_of(cutoff, cutoff)} in the period {in_unit_of(cutoff, max(lengths))}"
        )
    return grid.signal(grid.coefficients(heights, heights.ndim) * kept, *shape)


def mirrored(heights: Reals, axes: tuple[bool, ...] = (True, True)) -> Reals:
    """Profile or map followed by its mirror image along all axes, or some; periodic there without a jump."""
    for axis in range(heights.ndim):
        heights = np.concatenate([heights, np.flip(heights, axis)], axis) if axes[axis] else heights
    return heights


def windowed(heights: Reals, ends: tuple[bool, ...] = (False, False)) -> Reals:
    """Heights about their mean times a Hann window along all axes but where they end, scaled to their mean square."""
    centred = heights - heights.mean()
    faded = centred
    for axis, n in enumerate(heights.shape):
        if ends[axis]:
            continue
        window = np.sin(np.pi * (np.arange(n) + 0.5) / n) ** 2
        faded = faded * window.reshape([-1 if i == axis else 1 for i in range(heights.ndim)])
    faded = faded - faded.mean()
    if not faded.any():
        return np.asarray(faded)
    return np.asarray(faded * np.sqrt((centred**2).mean() / (faded**2).mean()))


def fill_gaps(heights: Reals, fill: Fill) -> tuple[Reals, tuple[str, ...]]:
    """Heights `[nx]` or `[ny, nx]` without not-a-numbers, and what was done.

    What is missing becomes the mean of its neighbours, along which profiles are linear and maps harmonic; beyond the
    last height they stay level. Raises ValueError for gaps that are to be refused, or more than half of the field.
    """
    missing = np.isnan(heights)
    share = float(missing.mean())
    if share == 0.0:
        return heights, ()
    if share > MOST:
        raise ValueError(f"{share:.3g} of all heights missing, more than {MOST:g}")
    if fill == "refuse":
        raise ValueError(
            f"height nan at {place(np.argwhere(missing))}, not a finite number; write fill: interpolate to fill gaps"
        )
    filled, how = interpolated(heights, missing)
    count = counted(int(missing.sum()), "missing height")
    return filled, (f"filled {count} of {heights.size} ({100 * share:.3g} %) {how}",)


def interpolated(heights: Reals, missing: Flags) -> tuple[Reals, str]:
    """Heights `[nx]` or `[ny, nx]` with each missing one the mean of its neighbours, and what that is called."""
    interpolate, how = _INTERPOLATED[heights.ndim]
    return interpolate(heights, missing), how


def largest_square(found: Measurement) -> Measurement:
    """Cut the largest square about the centre out of a map `[ny, nx]`.

    Where the spacings along x and y differ, so do the numbers of points, and the sides agree to half of the finer
    spacing. A map without sizes has square pixels. Raises ValueError for a profile, and for fewer than 4 points a side.
    """
    if found.heights.ndim == 1:
        raise ValueError("a profile, where crop: square needs a map: leave crop out")
    shape = found.heights.shape
    sizes = found.lengths if found.lengths is not None else tuple(map(float, shape))
    spacings = [size / n for size, n in zip(sizes, shape, strict=True)]
    coarse = max(spacings)
    side = math.floor(min(sizes) / coarse + _WHOLE) * coarse
    counts = [min(n, round(side / spacing)) for n, spacing in zip(shape, spacings, strict=True)]
    if tuple(counts) == shape and max(sizes) <= min(sizes) * (1.0 + _WHOLE):
        return found
    if min(counts) < 4:
        raise ValueError(f"{' x '.join(map(str, counts))} heights in the largest square, not at least 4")
    begins = [(n - count) // 2 for n, count in zip(shape, counts, strict=True)]
    heights = found.heights[tuple(slice(begin, begin + count) for begin, count in zip(begins, counts, strict=True))]
    said = f"cut out the middle {counts[0]} x {counts[1]} of {shape[0]} x {shape[1]} points, a square"
    misfit = max(abs(count * spacing / side - 1.0) for count, spacing in zip(counts, spacings, strict=True))
    if misfit > _EQUAL:
        said += f" once stretched by {100 * misfit:.2g} %"
    lengths = (side, side) if found.lengths is not None else None
    return replace(found, heights=heights, lengths=lengths, done=(*found.done, said))


def _times(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape))


def _linear(heights: Reals, missing: Flags) -> Reals:
    index = np.arange(heights.size)
    return np.where(missing, np.interp(index, index[~missing], heights[~missing]), heights)


def _harmonic(heights: Reals, missing: Flags) -> Reals:
    """Heights with each missing one the mean of its two to four neighbours on the map."""
    from scipy.sparse import coo_array, csr_array, diags_array
    from scipy.sparse.linalg import spsolve

    at, number = np.argwhere(missing), np.full(heights.shape, -1)
    unknowns = len(at)
    number[missing] = np.arange(unknowns)
    neighbours, known = np.zeros(unknowns), np.zeros(unknowns)
    rows, columns = [], []
    for step in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        next_to = at + step
        here = np.flatnonzero(((next_to >= 0) & (next_to < heights.shape)).all(axis=1))
        there = tuple(next_to[here].T)
        neighbours[here] += 1.0
        border = ~missing[there]
        known[here[border]] += heights[there][border]
        rows.append(here[~border])
        columns.append(number[there][~border])
    row, column = np.concatenate(rows), np.concatenate(columns)
    coupling = coo_array((np.ones(len(row)), (row, column)), shape=(unknowns, unknowns))
    filled = heights.copy()
    filled[missing] = spsolve(csr_array(diags_array(neighbours) - coupling).tocsc(), known)
    return filled


_INTERPOLATED = {1: (_linear, "linearly"), 2: (_harmonic, "by a harmonic function")}  # profiles and maps
