"""Random midpoint displacement and successive random addition, periodic and with cut-on and roll-off (thesis 3.5.1).

Points a quarter of the roll-off wavelength apart have independent heights of one variance. A step halves the spacing:
new points are means of their nearest neighbours, and Gaussian heights of variance (3.24) are added, to the new points
only (midpoint displacement) or, half as large, to all (successive addition). Steps end at half the cut-on wavelength,
and the surface between the points is their trigonometric interpolant. On a map a step has two halves: centres of
squares, then of edges.

Neither process is stationary, which is the artefact these methods are known for. `power_of_points` is their
spectrum, averaged over positions, exactly. It is the same for both methods; they differ in how much the variance
depends on position.
"""

from dataclasses import dataclass, replace
from typing import ClassVar, Literal, Self

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.fourier.grid import magnitudes, resample
from gfmd_numba.roughness.amplitudes import stream
from gfmd_numba.roughness.generators import Shape, band, power_law
from gfmd_numba.scene.records import Discretisation
from gfmd_numba.scene.surfaces import Recursive


@dataclass(frozen=True)
class Recursion:
    """How a surface of period 1 is subdivided (thesis 3.5.1); `cut_on` and `roll_off` are wavelengths in periods.

    Raises ValueError unless 0 < 2 cut_on <= roll_off <= 1.
    """

    unit_gradient: ClassVar = False
    method: Literal["midpoint_displacement", "successive_addition"]
    dimension: int
    hurst: float
    cut_on: float
    roll_off: float

    def __post_init__(self) -> None:
        if not 0.0 < 2.0 * self.cut_on <= self.roll_off <= 1.0:
            raise ValueError(
                f"a roll_off of {self.roll_off:g} periods, not at least twice cut_on = {self.cut_on:g} and at most 1"
            )

    @property
    def first(self) -> int:
        """Number n of the step whose spacing 2^-n is a quarter of the roll-off wavelength, or up to twice that.

        Points a quarter of a wavelength apart are where the autocorrelation of a power law with a plateau has fallen
        to about 0.1, so that independent heights come closest to it.
        """
        return 1 + _step(self.roll_off)

    @property
    def last(self) -> int:
        """Number n of the step whose spacing 2^-n is half the cut-on wavelength, or up to twice that."""
        return _step(self.cut_on)

    @property
    def everywhere(self) -> bool:
        """Whether heights are added to old points as well."""
        return self.method == "successive_addition"

    @property
    def band(self) -> tuple[float, float]:
        """Wave indices of the roll-off and of the cut-on wavelength."""
        return 1.0 / self.roll_off, 1.0 / self.cut_on

    def heights(self, shape: Shape, seed: int, realisations: range) -> Reals:
        """Heights `[realisation, (y,) x]` of period 1 and unit rms height in the ensemble, averaged over positions.

        A finer grid samples the same surface; a smaller cut-on keeps the points of midpoint displacement and adds to
        all points of successive addition. Raises ValueError for a cut-on beyond Nyquist.
        """
        if 2**self.last > shape[0]:
            raise ValueError(f"{2**self.last} points of the last step on a grid of {shape[0]}")
        power = power_of_points(self)
        norm = np.sqrt(float(power.sum() - power.flat[0]))
        heights = np.empty((len(realisations), *shape))
        for row, realisation in zip(heights, realisations, strict=True):
            numbers = stream(seed, realisation)
            points = numbers.standard_normal((2**self.first,) * self.dimension)
            for step in range(self.first + 1, self.last + 1):
                points = _DIVIDE[self.dimension](points, self, 0.5**step, numbers)
            row[...] = resample(points / norm, shape)
        return heights

    def mean_square_height(self, shape: Shape) -> float:
        """Mean square height of the ensemble, to which the recursion is scaled."""
        return 1.0

    def without_shortest(self, halvings: int) -> Self | None:
        """The same from twice its cut-on wavelength, so often."""
        cut_on = self.cut_on * 2**halvings
        return None if 2.0 * cut_on > self.roll_off else replace(self, cut_on=cut_on)

    def power(self, shape: Shape) -> Reals:
        """Mean power that is asked for, a power law with a plateau; `power_of_points` is that of the recursion."""
        longest, shortest = self.band
        index = magnitudes(shape) / (2.0 * np.pi)
        return power_law(index, len(shape) + 2.0 * self.hurst, (longest, min(shortest, (shape[0] - 1) // 2)))

    def variance(self, distance: float) -> float:
        """Variance of the heights added to means of neighbours at a distance (3.24), per that of the first points.

        It is what self-affine height differences, 2 (distance / first spacing)^(2H), leave of the height of a point
        once the mean of its two neighbours, or of the four of a map, is known.
        """
        h = self.hurst
        left = {1: 1.0 - 2.0 ** (2.0 * h - 2.0), 2: 1.0 - 2.0 ** (h - 2.0) - 2.0 ** (2.0 * h - 3.0)}[self.dimension]
        return float((1.0 if self.everywhere else 2.0) * left * (distance * 2**self.first) ** (2.0 * h))


def generator(record: Recursive, discretisation: Discretisation | None, dimension: int, nx: int) -> Recursion:
    """Subdivision of a record between its wavelengths, or those of the discretisation."""
    longest, shortest = band(record, discretisation)
    return Recursion(record.method, dimension, record.hurst, 1.0 / shortest, 1.0 / longest)


def _step(wavelength: float) -> int:
    return 1 + int(np.floor(np.log2(1.0 / wavelength) + 1e-9))


def _divide_profile(old: Reals, recursion: Recursion, spacing: float, numbers: np.random.Generator) -> Reals:
    new = np.empty(2 * old.size)
    new[::2] = old
    new[1::2] = 0.5 * (old + np.roll(old, -1))
    added = new if recursion.everywhere else new[1::2]
    added += np.sqrt(recursion.variance(spacing)) * numbers.standard_normal(added.size)
    return new


def _divide_map(old: Reals, recursion: Recursion, spacing: float, numbers: np.random.Generator) -> Reals:
    n = len(old)
    size = np.sqrt([recursion.variance(np.sqrt(2.0) * spacing), recursion.variance(spacing)])
    new = np.empty((2 * n, 2 * n))
    corners, centres, along_x, along_y = new[::2, ::2], new[1::2, 1::2], new[::2, 1::2], new[1::2, ::2]
    below = np.roll(old, -1, axis=0)
    corners[...] = old
    centres[...] = 0.25 * (old + below + np.roll(old + below, -1, axis=1))
    for points in (corners, centres)[0 if recursion.everywhere else 1 :]:
        points += size[0] * numbers.standard_normal((n, n))
    along_x[...] = 0.25 * (corners + np.roll(corners, -1, axis=1) + centres + np.roll(centres, 1, axis=0))
    along_y[...] = 0.25 * (corners + np.roll(corners, -1, axis=0) + centres + np.roll(centres, 1, axis=1))
    for points in (along_x, along_y, corners, centres)[: 4 if recursion.everywhere else 2]:
        points += size[1] * numbers.standard_normal((n, n))
    return new


_DIVIDE = {1: _divide_profile, 2: _divide_map}


def power_of_points(recursion: Recursion) -> Reals:
    """Mean power `[(n,) n]` of all coefficients on the n = 2^last points of the last step, on no scale.

    Each step filters the repeated spectrum and adds white noise.
    """
    d, everywhere = recursion.dimension, recursion.everywhere
    found = np.full((2**recursion.first,) * d, 0.5 ** (recursion.first * d))
    for step in range(recursion.first + 1, recursion.last + 1):
        n, spacing = 2**step, 0.5**step
        cosine = np.cos(2.0 * np.pi * np.arange(n) / n)
        found = np.tile(found, (2,) * d)
        noise = recursion.variance(spacing) * (1.0 if everywhere else 0.5) / n**d
        if d == 1:
            found = ((1.0 + cosine) / 2.0) ** 2 * found + noise
        else:
            first = recursion.variance(np.sqrt(2.0) * spacing) * (0.5 if everywhere else 0.25) / n**2
            centres = (1.0 + np.multiply.outer(cosine, cosine)) ** 2
            edges = (1.0 + np.add.outer(cosine, cosine) / 2.0) ** 2
            found = edges * (centres * found / 16.0 + first) + noise
    return found
