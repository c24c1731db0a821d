"""From a measured field to a periodic surface: trend, ends, shortest wave, grid; what was done is recorded."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.resampling import resample
from gfmd_numba.scene.memory import arrays_per_realisation, beyond_memory
from gfmd_numba.scene.units import in_unit_of

Detrend = Literal["none", "mean", "tilt", "curvature"]
Periodic = Literal["none", "mirror", "window"]

_ORDER = {"mean": 0, "tilt": 1, "curvature": 2}


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
    trend = polynomial(heights, _ORDER[detrend])
    return heights - trend, (f"subtracted the {detrend} fitted by least squares, of rms height {trend.std():g}",)


def made_periodic(
    heights: Reals,
    lengths: tuple[float, ...],
    periodic: Periodic = "none",
    cutoff: float | None = None,
    points: int | None = None,
) -> Processed:
    """Heights of a field of these sizes made periodic: mirrored or windowed, then filtered, then resampled.

    `cutoff` is the shortest wavelength kept, in the unit of `lengths`. `points` counts grid points along the last axis;
    the others have the same spacing. Raises ValueError for a cutoff that leaves all waves or none, and if
    resampling would leave fewer than 4 points in a direction.
    """
    done = []
    if periodic == "mirror":
        heights, lengths = mirrored(heights), tuple(2.0 * length for length in lengths)
        done.append("mirrored at its ends, which doubles the period")
    if periodic == "window":
        heights = windowed(heights)
        done.append("multiplied by a Hann window in each direction, and scaled back to its mean square height")
    if cutoff is not None:
        heights = filtered(heights, lengths, cutoff)
        done.append(f"left out all waves shorter than {in_unit_of(cutoff, cutoff)} of its Fourier series")
    shape = heights.shape if points is None else tuple(round(length / lengths[-1] * points) for length in lengths)
    if shape != heights.shape:
        if min(shape) < 4:
            raise ValueError(f"{_times(shape)} points after resampling, not at least 4")
        if allowed := beyond_memory(float(np.prod(shape, dtype=float)), arrays_per_realisation(len(shape), ())):
            raise ValueError(f"{_times(shape)} points after resampling, not {allowed}")
        done.append(f"resampled from {_times(heights.shape)} to {_times(shape)} points by its Fourier series")
        heights = resample(heights, shape)
    return Processed(heights, lengths, tuple(done))


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


def mirrored(heights: Reals) -> Reals:
    """Profile or map followed by its mirror image in each direction; periodic without a jump."""
    for axis in range(heights.ndim):
        heights = np.concatenate([heights, np.flip(heights, axis)], axis)
    return heights


def windowed(heights: Reals) -> Reals:
    """Heights about their mean times a Hann window in each direction, scaled back to their mean square."""
    centred = heights - heights.mean()
    faded = centred
    for axis, n in enumerate(heights.shape):
        window = np.sin(np.pi * (np.arange(n) + 0.5) / n) ** 2
        faded = faded * window.reshape([-1 if i == axis else 1 for i in range(heights.ndim)])
    faded = faded - faded.mean()
    if not faded.any():
        return np.asarray(faded)
    return np.asarray(faded * np.sqrt((centred**2).mean() / (faded**2).mean()))


def polynomial(heights: Reals, order: int) -> Reals:
    """Return the least-squares polynomial of all powers up to an order, at the points of the heights."""
    coefficients, bases = orthogonal(heights, order)
    return np.asarray(_along_axes(coefficients, [base.T for base in bases]))


def orthogonal(heights: Reals, order: int) -> tuple[Reals, list[Reals]]:
    """Coefficients `[(power of y,) power of x]` of heights in orthonormal polynomials `[points, power]` of each axis.

    Those of a total power above the order are zero. Their squares add up to the squares of the heights that the
    polynomials of each power make up.
    """
    powers = [np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, n), order) for n in heights.shape]
    bases = [np.linalg.qr(each)[0] for each in powers]
    coefficients = _along_axes(heights, bases)
    total = np.add.reduce(np.indices(coefficients.shape))
    return np.where(total <= order, coefficients, 0.0), bases


def _along_axes(field: Reals, bases: list[Reals]) -> Reals:
    """Product of a field with a basis `[points, power]` along each axis."""
    for axis, basis in enumerate(bases):
        field = np.moveaxis(np.moveaxis(field, axis, -1) @ basis, -1, axis)
    return np.asarray(field)


def _times(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape))
