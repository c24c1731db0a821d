"""Signs that a measured surface is not what it was taken for: each a sentence with its number and what to do.

The thresholds are far beyond what random self-affine surfaces reach, so that a sentence is worth reading. Heights are
`[nx]` or `[ny, nx]`, their periods `lengths` (L_x,) or (L_y, L_x) in the same unit.
"""

from collections.abc import Iterable

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness import statistics
from gfmd_numba.roughness.processing import polynomial

SEAM = 5.0  # rms steps: one Gaussian step in two million is larger
SEAM_OVER_LARGEST = 1.5  # of the largest step: a surface made of walls may have one of them at its seam
TILT = 0.9  # of the mean square height: a sine over the whole period has 6/pi^2 = 0.61, a sawtooth 1
LONGEST = 10.0  # m: of profilometers and microscopes none sees as far
GRADIENT = 0.3  # sin(x), tan(x) and x differ by 3 to 5 per cent: the elasticity is linear in slopes
SPIKE = 10.0  # rms heights of all others, above the neighbours: white noise of 10^9 heights reaches 7
FILLED = 0.05  # of all heights: as much of the contact may lie where nothing was measured


def of_field(heights: Reals, filled: float = 0.0) -> tuple[str, ...]:
    """Sentences about a measured field before it is made periodic, `filled` of whose heights were not measured."""
    return tuple(filter(None, (_filled(filled), _tilt(heights), _spike(heights))))


def of_surface(heights: Reals, lengths: tuple[float, ...]) -> tuple[str, ...]:
    """Sentences about a periodic surface."""
    return tuple(filter(None, (*_seams(heights), _gradient(heights, lengths), _range(heights, lengths))))


def of_period(length: float) -> tuple[str, ...]:
    """Sentences about a period L_x in m."""
    return (f"a period of {length:.3g} m: check the units of positions and sizes",) if length > LONGEST else ()


def _filled(share: float) -> str:
    if share <= FILLED:
        return ""
    return f"{100 * share:.3g} % of the heights were missing and filled: measure again, or cut out a part without gaps"


def _tilt(heights: Reals) -> str:
    variance = heights.var()
    share = polynomial(heights, 1).var() / variance if variance > 0.0 else 0.0
    if share <= TILT:
        return ""
    return f"a tilt makes up {100 * share:.4g} % of the mean square height: detrend: tilt subtracts it"


def _spike(heights: Reals) -> str:
    along = range(heights.ndim)
    neighbours = np.mean([np.roll(heights, shift, axis) for axis in along for shift in (-1, 1)], axis=0)
    inner = tuple(slice(1, -1) for _ in along)  # a field that is not periodic has a step at its ends
    off = abs(heights - neighbours)[inner]
    where = np.unravel_index(int(off.argmax()), off.shape)
    others = np.delete(heights.ravel(), np.ravel_multi_index(tuple(i + 1 for i in where), heights.shape))
    rms = others.std()
    if off[where] <= SPIKE * rms:
        return ""
    index = ", ".join(str(int(i) + 1) for i in where)
    times = (
        f"{off[where] / rms:.3g} rms heights of all others"
        if rms > 0.0
        else f"{off[where]:.3g} where all others are level"
    )
    return f"the height at index {index} stands out from its neighbours by {times}: if it is a spike, remove it"


def _seams(heights: Reals) -> Iterable[str]:
    for axis, name in zip(range(-heights.ndim, 0), ("y", "x")[-heights.ndim :], strict=True):
        lines = np.moveaxis(heights, axis, -1)
        inner = _rms(np.diff(lines, axis=-1))
        jump = float(_rms(lines[..., :1] - lines[..., -1:])[0])
        rms, largest = float(np.sqrt((inner**2).mean())), float(inner.max())
        if jump > SEAM * rms and jump > SEAM_OVER_LARGEST * largest:
            yield (
                f"the heights jump by {jump:.3g} where the period along {name} closes, {jump / rms:.3g} rms steps "
                "between neighbours: periodic: mirror or window makes the ends meet, detrend: tilt removes a slope"
                if rms > 0.0
                else f"the heights jump by {jump:.3g} where the period along {name} closes, and nowhere else"
            )


def _rms(steps: Reals) -> Reals:
    """Root mean square over all rows of steps `[..., n]`."""
    return np.asarray(np.sqrt((steps**2).mean(axis=tuple(range(steps.ndim - 1)))))


def _gradient(heights: Reals, lengths: tuple[float, ...]) -> str:
    gradient = float(statistics.rms_gradient(heights, lengths))
    if gradient <= GRADIENT:
        return ""
    return (
        f"an rms gradient of {gradient:.3g}, above {GRADIENT:g}, where linear elasticity is no longer good: check the "
        "units of the file, or leave out short waves by a cutoff"
    )


def _range(heights: Reals, lengths: tuple[float, ...]) -> str:
    found = float(np.ptp(heights))
    if found <= min(lengths):
        return ""
    return f"heights that range over {found / min(lengths):.3g} periods: check the units of the file, and the length"
