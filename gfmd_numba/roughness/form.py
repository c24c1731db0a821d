"""The form of a measured field: which share of its heights a tilt and a curvature make up, and which radius they have.

The share alone tells no form from roughness, as the long waves of a rough surface carry most of its heights. A form
stands out, as the coefficients of a rough surface in orthogonal polynomials follow a power law: those of a self-affine
surface fall with the power at most as with a Hurst exponent of 1. Waves are compared with the law of the shorter ones.
"""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals

HIGHEST = {1: 64, 2: 24}  # power by dimension, unless there are too few points
FEWEST = 24  # points in each direction
_MOST = 4096  # means along an axis, to which more heights are reduced: the highest power has 64 a half wave
WAVY = 8  # power, up to which polynomials follow waves of two and a half periods
_FLAT = 0.1  # of the larger curvature of a map, below which the other one is none


@dataclass(frozen=True)
class Part:
    """Share of the mean square height, and how far it stands out.

    A part stands out by its mean square coefficient over what the powers next above it lead one to expect.
    """

    share: float
    over_expected: float


@dataclass(frozen=True)
class FormShares:
    """Parts of the heights: a tilt, and of what is left without it a curvature, and long waves together with that.

    `rest` is the mean square height that is left at last.
    """

    tilt: Part
    curvature: Part
    waves: Part
    rest: float


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


def form(heights: Reals) -> FormShares:
    """Form of a field `[nx]` or `[ny, nx]` of at least 24 points in each direction."""
    highest = min(HIGHEST[heights.ndim], min(heights.shape) // 2)
    means = _means(heights)
    squares = orthogonal(means, highest)[0] ** 2 * (heights.size / means.size)
    power = np.arange(highest + 1)
    total = np.add.reduce(np.indices(squares.shape))
    of = np.array([squares[total == k].sum() for k in power])
    mean = of / (1.0 + power) ** (len(squares.shape) - 1)  # of the terms of each power
    # mean squares of self-affine surfaces fall no faster than with H = 1
    level = mean * power ** (2.0 + squares.ndim)
    short = float(level[3 : WAVY + 1].mean())
    levelled = float(((heights - heights.mean()) ** 2).sum()) - of[1]
    waves = float(of[2 : WAVY + 1].sum())
    return FormShares(
        Part(_ratio(of[1], levelled + of[1]), _ratio(level[1], short)),
        Part(_ratio(of[2], levelled), _ratio(level[2], short)),
        Part(_ratio(waves, levelled), _ratio(mean[2 : WAVY + 1].mean(), _expected(mean))),
        max(levelled - waves, 0.0) / heights.size,
    )


def _means(heights: Reals) -> Reals:
    """Heights, or means of neighbours where there are far more than `_MOST` along an axis."""
    for axis, n in enumerate(heights.shape):
        if n > 4 * _MOST:
            begins = np.arange(_MOST) * n // _MOST
            sums = np.moveaxis(np.add.reduceat(heights, begins, axis), axis, -1)
            heights = np.moveaxis(sums / np.diff(begins, append=n), -1, axis)
    return heights


def _expected(mean: Reals) -> float:
    """Mean square of the coefficients up to `WAVY` that the power law of those above it leads one to expect."""
    middle = round(np.sqrt((WAVY + 1) * len(mean)))
    near, far = mean[WAVY + 1 : middle].mean(), mean[middle:].mean()
    ends = np.sqrt((WAVY + 1) * (middle - 1)), np.sqrt(middle * (len(mean) - 1))
    exponent = max(np.log(near / far) / np.log(ends[1] / ends[0]), 0.0) if far > 0.0 else np.inf
    return float(near * np.mean((np.arange(2, WAVY + 1) / ends[0]) ** -exponent)) if near > 0.0 else np.inf


def radii(heights: Reals, lengths: tuple[float, ...]) -> tuple[float, ...]:
    """Radii of curvature of the least-squares paraboloid, the smallest first; above 0 for peaks.

    A profile has one; a map has one if it is a cylinder, and otherwise two.
    """
    fit = polynomial(heights, 2)
    steps = [(n - 1) // 2 for n in fit.shape]
    spans = [m * length / n for m, n, length in zip(steps, fit.shape, lengths, strict=True)]

    def at(*axes: int) -> float:
        """Height a step along each of the axes from the first point."""
        return float(fit[tuple(m * axes.count(axis) for axis, m in enumerate(steps))])

    along = list(enumerate(spans))
    second = np.array([[(at() - at(i) - at(j) + at(i, j)) / (a * b) for j, b in along] for i, a in along])
    curvatures = -np.linalg.eigvalsh(second)
    curvatures = curvatures[np.argsort(-abs(curvatures))]
    return tuple(1.0 / float(each) for each in curvatures if abs(each) > _FLAT * abs(curvatures[0]))


def _ratio(part: float, whole: float) -> float:
    return float(part / whole) if whole > 0.0 else (np.inf if part > 0.0 else 0.0)


def _along_axes(field: Reals, bases: list[Reals]) -> Reals:
    """Product of a field with a basis `[points, power]` along each axis."""
    for axis, basis in enumerate(bases):
        field = np.moveaxis(np.moveaxis(field, axis, -1) @ basis, -1, axis)
    return np.asarray(field)
