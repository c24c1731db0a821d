"""Measured fields in m or L_x: what a file holds, in the units that it or the record states."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness.positions import are_even, laid_out
from gfmd_numba.roughness.surface_files import Content
from gfmd_numba.scene.measured_record import AXES
from gfmd_numba.scene.quantities import LARGEST, SMALLEST
from gfmd_numba.scene.units import METRES, PERIOD

_CONFUSED = "the heights are evenly spaced: if the two columns are confused, exchange them or label them, as z, x"
_NAMES = {"x": "positions along x", "y": "positions along y", "z": "heights"}


@dataclass(frozen=True)
class Measurement:
    """Heights `[nx]` or `[ny, nx]`, not-a-number where none was measured, and sizes (L_x,) or (L_y, L_x) of the field.

    The sizes are None if the file does not tell them. The `unit` of both is "m", or "1" for the period L_x of the
    surface to be made, or None where nobody stated one. `units` are the names of those that x, y and z came in. `done`
    tells what was done in reading.
    """

    heights: Reals
    lengths: tuple[float, ...] | None
    unit: Literal["m", "1"] | None = None
    done: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)


def measurement(content: Content, units: Mapping[str, str] | None = None, resample: bool = False) -> Measurement:
    """Profile or map of what stands in a file, with `units` of x, y and z for what the file does not state.

    Positions in descending order are turned round. Others that are not equidistant are refused, or, in a
    profile, interpolated linearly to as many equidistant ones if `resample` is set. Raises ValueError, saying what is
    wrong, where, and what to do, for files that cannot be read, units that are missing or contradict each other, and
    fewer than 4 heights.
    """
    heights = _checked(content.heights)
    axes = AXES[-heights.ndim :]
    done = list(content.done)
    sizes: list[float] = []
    if set(axes) <= set(content.positions):
        for axis, (i, name) in zip(axes, enumerate(axes), strict=True):
            try:
                heights, size, along = laid_out(heights, i, content.positions[axis], name, resample)
            except ValueError as error:
                raise ValueError(f"{error}; {_CONFUSED}" if are_even(heights) else str(error)) from None
            done += along
            sizes.append(size)
    elif set(axes) <= set(content.sizes):
        sizes = [content.sizes[axis] for axis in axes]
    elif content.positions:
        raise ValueError("a map with positions along one direction: give them along both, or along none")
    scales, unit, named = _scales(content, units or {})
    unresolved = [size for size in sizes if not SMALLEST <= size <= LARGEST]
    if unresolved:
        raise ValueError(f"a physical size of {unresolved[0]:.3g}, not from {SMALLEST:g} to {LARGEST:g}")
    lengths = tuple(size * scales[axis] for size, axis in zip(sizes, axes, strict=True)) if sizes else None
    return Measurement(heights * scales["z"], lengths, unit, tuple(done), named)


def _checked(heights: npt.NDArray[Any]) -> Reals:
    if heights.ndim not in (1, 2) or heights.dtype.kind not in "fiu":
        kind = f"an array of shape {heights.shape} and type {heights.dtype}"
        raise ValueError(f"{kind}, not a row or a table of numbers")
    if min(heights.shape) < 4:
        raise ValueError(f"{' x '.join(map(str, heights.shape))} heights, not at least 4")
    with np.errstate(over="ignore"):  # of more than double precision
        heights = np.asarray(heights, dtype=np.float64)
    check_finite(heights)
    return heights


def check_finite(heights: Reals) -> None:
    """Raise ValueError if a height is infinite, or if squares of the heights would be infinite or zero."""
    outside = np.argwhere(abs(heights) > LARGEST)
    if len(outside):
        first = heights[tuple(outside[0])]
        allowed = f"at most {LARGEST:g} in size" if np.isfinite(first) else "a finite number"
        raise ValueError(f"height {first} at {place(outside)}, not {allowed}")
    known = heights[~np.isnan(heights)]
    if known.size and 0.0 < np.ptp(known) < SMALLEST:
        raise ValueError(f"heights that differ by {np.ptp(known):.3g} at most, not by at least {SMALLEST:g}")


def place(indices: npt.NDArray[np.int64]) -> str:
    """Index of the first of several heights, and how many more there are."""
    more = f" and {len(indices) - 1} more" if len(indices) > 1 else ""
    return f"index {', '.join(map(str, indices[0]))}{more}"


def _scales(
    content: Content, asked: Mapping[str, str]
) -> tuple[dict[str, float], Literal["m", "1"] | None, dict[str, str]]:
    """Factors to m or L_x for each axis with positions or sizes and for z, which of the two, and the units' names.

    Which of the two is None if nobody says.
    """
    given = {"z", *content.positions, *content.sizes}
    for axis in asked:
        if axis not in given:
            raise ValueError(f"no {_NAMES[axis]} in the file, so that units.{axis} has to be left out")
    units: dict[str, str | None] = {}
    for axis in sorted(given):
        stated = content.units.get(axis)
        units[axis] = asked.get(axis, stated)
        known = stated in METRES or stated == PERIOD
        if known and asked.get(axis, stated) != stated:
            raise ValueError(f"{_NAMES[axis]} in {stated} as the file says, not {asked[axis]} as units.{axis} does")
        if stated is not None and not known and axis not in asked:
            raise ValueError(f"{_NAMES[axis]} in {stated!r}, which is no unit of length: name theirs as units.{axis}")
    missing = [axis for axis, unit in units.items() if unit is None]
    if len(missing) == len(units):
        if len(units) > 1:
            raise ValueError(
                f"{_words(sorted(units))} without a unit: write units: {_example(sorted(units))}, with theirs, next to "
                "file, or state them in the file"
            )
        return {"z": 1.0}, None, {}
    if missing:
        raise ValueError(f"{_words(missing)} without a unit: write units: {_example(missing)}, with theirs")
    kinds = {"1" if unit == PERIOD else "m" for unit in units.values()}
    if len(kinds) > 1:
        raise ValueError(f"some of {_words(sorted(units))} in {PERIOD}, not all: state all in it or none")
    scales = {axis: METRES.get(unit or "", 1.0) for axis, unit in units.items()}
    return scales, "1" if kinds == {"1"} else "m", {axis: unit for axis, unit in units.items() if unit is not None}


def _words(axes: list[str]) -> str:
    return " and ".join(_NAMES[axis] for axis in axes)


def _example(axes: list[str]) -> str:
    return "{" + ", ".join(f"{axis}: {'um' if axis == 'z' else 'mm'}" for axis in axes) + "}"
