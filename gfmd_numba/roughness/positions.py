"""Positions along one axis of a file: equidistant and ascending, or made so."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Reals
from gfmd_numba.scene.quantities import LARGEST

UNEVEN = 1e-3  # of the spacing, by which positions in a file may be rounded


@dataclass(frozen=True)
class Line:
    """Positions along the axis `name`: the `size` of the field, one spacing for each of them.

    They are `turned` if they descend. `uneven` are positions that have to be interpolated, `said` tells of that.
    """

    name: str
    size: float
    turned: bool = False
    uneven: Reals | None = None
    said: str = ""


def equidistant(positions: npt.NDArray[Any], name: str, interpolate: bool, of_map: bool) -> Line:
    """Look at the positions `[n]` along an axis, which may be uneven only in a profile that is interpolated.

    Raises ValueError, with the index, for positions that are not distinct finite numbers.
    """
    if positions.dtype.kind not in "fiu":
        raise ValueError(f"positions {name} of type {positions.dtype}, not numbers")
    x = np.asarray(positions, dtype=np.float64)
    outside = np.flatnonzero(~(abs(x) <= LARGEST))
    if len(outside):
        raise ValueError(f"position {name} = {x[outside[0]]} at index {outside[0]}, not a finite number")
    mean = (x[-1] - x[0]) / (len(x) - 1)
    rounding = 4.0 * float(np.finfo(positions.dtype).eps) * abs(x).max() if positions.dtype.kind == "f" else 0.0
    steps = np.diff(x)
    off = abs(steps - mean) > UNEVEN * abs(mean) + rounding
    if mean != 0.0 and not off.any():
        return Line(name, abs(mean) * len(x), turned=mean < 0.0)
    if interpolate and not of_map:
        return _uneven(x, name)
    if (steps > 0.0).all() or (steps < 0.0).all():
        worst = int(abs(steps - mean).argmax())
        wrong = f"a spacing of {steps[worst]:g} in {name} at index {worst}, where {mean:g} is the mean: not equidistant"
    else:
        wrong = f"positions {name} that are in no order from index {_turn(steps)} on"
    remedy = "interpolate the map to a regular grid" if of_map else "give points to have them sorted and interpolated"
    raise ValueError(f"{wrong}; {remedy}")


def interpolated(heights: Reals, x: Reals) -> Reals:
    """Heights `[n]` at positions in any order, linearly interpolated to n equidistant ones from the least on.

    Heights that are not-a-number leave the interpolated ones next to them not-a-number.
    """
    order = np.argsort(x, kind="stable")
    x, heights = x[order], heights[order]
    return np.interp(np.linspace(x[0], x[-1], len(x)), x, heights)


def _uneven(x: Reals, name: str) -> Line:
    """A line of positions in any order, all of them distinct."""
    ordered = np.sort(x)
    steps = np.diff(ordered)
    if not (steps > 0.0).all():
        raise ValueError(f"the position {name} = {ordered[int((steps <= 0.0).argmax())]:g} twice")
    mean = (ordered[-1] - ordered[0]) / (len(x) - 1)
    said = f"interpolated linearly from uneven positions {name}, at most {steps.max() / mean:.4g} mean spacings apart"
    return Line(name, mean * len(x), uneven=x, said=said)


def _turn(steps: Reals) -> int:
    """Index of the first position after which the direction changes."""
    sign = np.sign(steps)
    return int((sign != sign[0]).argmax()) if sign[0] != 0.0 else 0
