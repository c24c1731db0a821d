"""Measured fields in m or L_x: what a file holds, in the units that it or the record states."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import inf
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.scene.measured_record import AXES, is_table
from gfmd_numba.scene.quantities import LARGEST, SMALLEST
from gfmd_numba.scene.units import COUNTS, METRES, PERIOD, length_unit, metres

_CONFUSED = "the heights are evenly spaced: if the two columns are confused, exchange them or label them, as z, x"
_REMEDIES = {  # of uneven positions, by the dimension
    1: "`points: {}`, or twice as many with `periodic: mirror`, has them sorted and interpolated",
    2: "interpolate the map to a regular grid",
}
_NAMES = {"x": "positions along x", "y": "positions along y", "z": "heights"}
UNEVEN = 1e-3  # of the spacing, by which neighbours in a file may be nearer or further than others
_ROUNDED = 1e-2  # of the spacing, by which positions may be off even ones, as numbers of few digits are
_EVEN = 0.05  # of the mean step, by which the steps of an axis may differ: its values may have few digits
_ALIKE = 2.0 * _EVEN  # likewise, by which a step of the heights may differ from one that goes on in the next row
_FEWEST = 4  # values that make an axis on their own
_SPARSE = 3  # times as many even positions as are given
_WHOLE, _RARE = 1.1, 0.05  # of the last digit, by which roundings differ; share of their short or long steps
_GAP = 4.0  # times the steps of uneven positions, of which a tenth are longer: nothing was measured there
_SCATTERED = 0.5  # of a grid without its heights: points at random fill far less


@dataclass(frozen=True)
class Content:
    """Heights `[nx]` or `[ny, nx]`, not-a-number where nothing was measured, as they stand in a file.

    A map of one row or column is a profile. `positions` along each axis or the physical `sizes` may be missing, or the
    sizes be `rounded` ones of a header. `units` are those of x, y and z that the file states: names of units of
    length, or the file's own words for another. `about_lengths` is a line of its header that speaks of a length. Raises
    ValueError for what is no row or table of numbers.
    """

    heights: npt.NDArray[Any]
    positions: Mapping[str, npt.NDArray[Any]] = field(default_factory=dict)
    sizes: Mapping[str, float] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    done: tuple[str, ...] = ()
    rounded: bool = False
    about_lengths: str | None = None

    def __post_init__(self) -> None:
        """Check the shape and the type of the heights."""
        given = self.heights
        if not is_table(given):
            raise ValueError(f"an array of shape {given.shape} and type {given.dtype}, not a row or a table of numbers")

    @property
    def nodes(self) -> dict[str, int]:
        """Numbers of heights along each axis that has several: a profile has one such axis."""
        shape = self.heights.shape
        return {axis: n for axis, n in zip(AXES[-len(shape) :], shape, strict=True) if n > 1}


@dataclass(frozen=True)
class Measurement:
    """Heights `[nx]` or `[ny, nx]`, not-a-number where none was measured, and sizes (L_x,) or (L_y, L_x) of the field.

    The sizes are None if the file does not tell them, and may be `rounded`. The `unit` of both is "m", or "1" for the
    period L_x of the surface to be made, or None where nobody stated one. `units` are the names of those that x, y and
    z came in. `done` tells what was done in reading.
    """

    heights: Reals
    lengths: tuple[float, ...] | None
    unit: Literal["m", "1"] | None = None
    done: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    rounded: bool = False


def measurement(content: Content, units: Mapping[str, str] | None = None, resample: bool = False) -> Measurement:
    """Profile or map of what stands in a file, with `units` of x, y and z for what the file does not state.

    Positions in descending order are turned round. Others that are not equidistant are refused, or, in a
    profile, interpolated linearly to as many equidistant ones if `resample` is set. Raises ValueError, saying what is
    wrong, where, and what to do, for files that cannot be read, units that are missing or contradict each other, and
    fewer than 4 heights.
    """
    given = np.atleast_1d(content.heights.squeeze())
    if given.dtype == np.float16:  # in metres, most heights lie below its smallest normal number
        raise ValueError("heights of type float16, which keeps 3 digits at most: give float32 or float64")
    if min(given.shape) < 4:
        heights_of, least = (" x ".join(map(str, each)) for each in (given.shape, (4,) * given.ndim))
        columns = "; columns of positions and heights are read from text: save them as text, or the heights alone"
        raise ValueError(f"{heights_of} heights, not at least {least}{columns if max(given.shape) >= 4 else ''}")
    with np.errstate(over="ignore"):  # of more than double precision
        heights = np.asarray(given, dtype=np.float64)
    check_finite(heights)
    axes = tuple(content.nodes)
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
        if content.rounded:
            spacing = f"{sizes[-1] / heights.shape[-1]:.6g} {content.units['x']}"
            done.append(f"took {spacing} from the header as the distance of neighbouring points")
    elif content.positions:
        raise ValueError("a map with positions along one direction: give them along both, or along none")
    scales, unit, named = _scales(content, units or {})
    unresolved = [size for size in sizes if not SMALLEST <= size <= LARGEST]
    if unresolved:
        raise ValueError(f"a physical size of {unresolved[0]:.3g}, not from {SMALLEST:g} to {LARGEST:g}")
    lengths = tuple(size * scales[axis] for size, axis in zip(sizes, axes, strict=True)) if sizes else None
    return Measurement(heights * scales["z"], lengths, unit, tuple(done), named, content.rounded)


def counts_points(content: Content) -> bool:
    """Whether positions, of no unit of length, are whole numbers that mostly go up by one, as numbers of points do."""
    for axis, each in content.positions.items():
        if content.units.get(axis, COUNTS[0]) not in COUNTS or each.dtype.kind not in "fiu":
            return False
        whole = np.asarray(each, dtype=np.float64)
        if (whole != np.round(whole)).any() or (len(whole) > 1 and np.median(abs(np.diff(whole))) != 1.0):
            return False
    return bool(content.positions)


def at_spacing(content: Content, spacing: float) -> Content:
    """Content whose positions are numbers of points, with positions in m of points so far apart."""
    return replace(
        content,
        positions={axis: spacing * np.asarray(each, dtype=np.float64) for axis, each in content.positions.items()},
        units={**content.units, **dict.fromkeys(content.positions, "m")},
        done=(*content.done, "took whole numbers for numbers of points, as there is a spacing"),
    )


def check_finite(heights: Reals) -> None:
    """Raise ValueError if a height is infinite, or if squares of the heights would be infinite or zero."""
    outside = np.argwhere(abs(heights) > LARGEST)
    if len(outside):
        first = heights[tuple(outside[0])]
        allowed = "a finite number"
        if np.isfinite(first):
            allowed = f"at most {LARGEST:g} in size; if it marks a missing height, write nan, and fill: interpolate"
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
    given = {"z", *content.positions, *(content.sizes.keys() & content.nodes)}
    for axis in asked:
        if axis not in given:
            raise ValueError(f"no {_NAMES[axis]} in the file, so that units.{axis} has to be left out")
    given -= {axis for axis, each in content.positions.items() if len(each) == 1}
    units: dict[str, str | None] = {}
    for axis in sorted(given):
        stated = content.units.get(axis)
        units[axis] = asked.get(axis, stated)
        known = stated in METRES or stated == PERIOD
        if stated is not None and known and asked.get(axis, stated).split()[-1] != stated:
            raise ValueError(f"{_NAMES[axis]} in {stated} as the file says, not {asked[axis]} as units.{axis} does")
        if stated is not None and stated[:1].isdecimal() and " " not in asked.get(axis, ""):
            name = asked.get(axis) or next(filter(None, map(length_unit, re.findall(r"\w+", stated))), "nm")
            number = stated.split()[0]
            raise ValueError(
                f"a scale of {stated} in the header: write units: {{{axis}: {number} {name}}} if the file holds "
                f"counts, or {{{axis}: 1 {name}}} if it holds {_NAMES[axis]} in {name}"
            )
        if stated in COUNTS and axis not in asked:
            raise ValueError(
                f"{_NAMES[axis]} that are numbers of points: give spacing, the distance of neighbouring points, or "
                f"units: {{{axis}: 0.5 um}}, with theirs"
            )
        if stated is not None and not known and axis not in asked:
            raise ValueError(
                f"{_NAMES[axis]} in {stated!r}, which is no unit of length: write units: "
                f"{_example([axis])}, with theirs"
            )
    missing = [axis for axis, unit in units.items() if unit is None]
    counted = "; if positions are numbers of points, give spacing instead" if counts_points(content) else ""
    if len(missing) == len(units):
        if len(units) > 1:
            raise ValueError(
                f"{_words(sorted(units))} without a unit: write units: {_example(sorted(units))}, with theirs, next to "
                f"file, or state them in the file{counted}"
            )
        if content.about_lengths is not None:
            told = f"heights without a unit under a header that says {content.about_lengths}"
            raise ValueError(f"{told}: write units: {{z: um}}, with theirs, in the same block")
        return {"z": 1.0}, None, {}
    if missing:
        raise ValueError(f"{_words(missing)} without a unit: write units: {_example(missing)}, with theirs{counted}")
    kinds = {"1" if unit == PERIOD else "m" for unit in units.values()}
    if len(kinds) > 1:
        raise ValueError(f"some of {_words(sorted(units))} in {PERIOD}, not all: state all in it or none")
    scales = {axis: metres(unit or PERIOD) for axis, unit in units.items()}
    named = {axis: unit.split()[-1] for axis, unit in units.items() if unit is not None}
    return scales, "1" if kinds == {"1"} else "m", named


def _words(axes: list[str]) -> str:
    return " and ".join(_NAMES[axis] for axis in axes)


def _example(axes: list[str]) -> str:
    return "{" + ", ".join(f"{axis}: {'um' if axis == 'z' else 'mm'}" for axis in axes) + "}"


def laid_out(
    heights: Reals, axis: int, positions: npt.NDArray[Any], name: str, interpolate: bool
) -> tuple[Reals, float, tuple[str, ...]]:
    """Heights on ascending equidistant positions along an axis of that `name`, the size there, and what was done.

    The size is one spacing for each of the `positions` `[n]`. They may be uneven only in a profile that is to be
    interpolated, linearly, to as many equidistant ones from the least on; heights that are not-a-number leave those
    next to them not-a-number. Raises ValueError, with the index, for positions that are not distinct finite numbers.
    """
    if positions.dtype.kind not in "fiu":
        raise ValueError(f"positions {name} of type {positions.dtype}, not numbers")
    x = np.asarray(positions, dtype=np.float64)
    outside = np.flatnonzero(~(abs(x) <= LARGEST))
    if len(outside):
        raise ValueError(f"position {name} = {x[outside[0]]} at index {outside[0]}, not a finite number")
    spacing, done = _spacing(x, positions.dtype, name)
    if spacing > 0.0:
        return heights, spacing * len(x), done
    if spacing < 0.0:
        turned = f"turned round along {name}, as its positions descend"
        return np.flip(heights, axis), -spacing * len(x), (*done, turned)
    steps = np.diff(x)
    order = np.argsort(x, kind="stable")
    ascending = x[order]
    complete = _completed(ascending) if interpolate or (steps > 0.0).all() or (steps < 0.0).all() else None
    if complete is not None:
        even, places = complete
        whole = np.full((*heights.shape[:axis], len(even), *heights.shape[axis + 1 :]), np.nan)
        np.moveaxis(whole, axis, 0)[places] = np.moveaxis(heights, axis, 0)[order]
        told = f"left {len(even) - len(x)} heights empty along {name}, where positions are missing"
        return whole, float((even[1] - even[0]) * len(even)), (told,)
    if interpolate and heights.ndim == 1:
        steps = np.diff(ascending)
        if not (steps > 0.0).all():
            raise ValueError(f"the position {name} = {ascending[int((steps <= 0.0).argmax())]:g} twice")
        if are_even(heights):
            raise ValueError(f"uneven positions {name}")
        mean = (ascending[-1] - ascending[0]) / (len(x) - 1)
        apart = f"at most {steps.max() / mean:.4g} mean spacings apart"
        heights = _interpolated(ascending, heights[order])
        return heights, float(mean * len(x)), (f"interpolated linearly from uneven positions {name}, {apart}",)
    raise _uneven(x, name, _REMEDIES[heights.ndim])


def _uneven(x: Reals, name: str, remedy: str) -> ValueError:
    """Error of positions along an axis that are not equidistant: where, and what to do."""
    steps, mean = np.diff(x), (x[-1] - x[0]) / (len(x) - 1)
    if (steps > 0.0).all() or (steps < 0.0).all():
        worst = int(abs(steps - mean).argmax())
        wrong = f"a spacing of {steps[worst]:g} in {name} at index {worst}, where {mean:g} is the mean: not equidistant"
    else:
        sign = np.sign(steps)
        turn = int((sign != sign[0]).argmax()) if sign[0] != 0.0 else 0
        wrong = f"positions {name} that are in no order from index {turn} on"
    if len(np.unique(x)) < len(x):
        return ValueError(f"{wrong}, and some twice: keep one pass over the surface")
    return ValueError(f"{wrong}; {remedy.format(len(x))}")


def _interpolated(x: Reals, heights: Reals) -> Reals:
    """Heights on as many even positions as those that rise, not-a-number in gaps between them."""
    at, steps = np.linspace(x[0], x[-1], len(x)), np.diff(x)
    found = np.interp(at, x, heights)
    for i in np.flatnonzero(steps > _GAP * np.quantile(steps, 0.9)):
        found[(at > x[i]) & (at < x[i + 1])] = np.nan
    return found


def are_even(heights: Reals) -> bool:
    """Whether heights are evenly spaced along x, as positions are."""
    steps = np.diff(heights)
    return bool((abs(steps - steps.mean()) < UNEVEN * abs(steps.mean())).all())


def split_axes(values: Reals, line: int) -> tuple[Reals, dict[str, Reals]]:
    """Heights `[ny, nx]` of a table, and the positions along x and y if its first row and first column are axes.

    An axis is strictly monotone and evenly spaced, and no neighbouring row goes on with its steps. The corner where
    both meet may hold anything. Raises ValueError, with the `line` of the first row, for one axis without the other.
    """
    if min(values.shape) < _FEWEST:
        return values, {}
    along_x, along_y = _is_axis(values[:, 1:]), _is_axis(values.T[:, 1:])
    both_even = _is_even(values[0, 1:]) and _is_even(values[1:, 0])
    corner_fits = _is_even(values[0]) if along_x else _is_even(values[:, 0])  # the only axis, which then begins there
    if (along_x and along_y) or ((along_x or along_y) and both_even and not corner_fits):
        return values[1:, 1:], {"x": values[0, 1:], "y": values[1:, 0]}
    for name, found in (("row", along_x or _is_axis(values)), ("column", along_y or _is_axis(values.T))):
        if found:
            where = f"a first row (line {line})" if name == "row" else f"a first column (from line {line} on)"
            x, y, other = ("x", "y", "column") if name == "row" else ("y", "x", "row")
            raise ValueError(
                f"{where} of evenly spaced numbers, unlike the {name}s next to it: if they are positions along {x}, "
                f"give those along {y} as the first {other}, evenly spaced too, or delete the {name}; if they are "
                "heights, save the map as .npy"
            )
    return values, {}


def on_a_grid(x: Reals, y: Reals, z: Reals) -> tuple[Reals, dict[str, Reals]]:
    """Heights `[ny, nx]` of points `[n]` on a grid, and the ascending positions along each axis.

    Points that are missing leave not-a-number. Raises ValueError, with the row, for positions that are missing, a point
    given twice, and points that lie on no grid.
    """
    present = ~(np.isnan(x) & np.isnan(y) & np.isnan(z))  # an empty line between rows is no point
    x, y, z = x[present], y[present], z[present]
    unknown = np.flatnonzero(~(np.isfinite(x) & np.isfinite(y)))
    if len(unknown):
        raise ValueError(f"a point without a finite x and y in row {unknown[0] + 1} of numbers")
    (along_x, i), (along_y, j) = (np.unique(each, return_inverse=True) for each in (x, y))
    cells = len(along_x) * len(along_y)
    place = j * len(along_x) + i
    order = np.argsort(place, kind="stable")
    again = np.flatnonzero(np.diff(place[order]) == 0)
    if len(again):
        row = order[again[0] + 1]
        raise ValueError(f"the point x = {x[row]:g}, y = {y[row]:g} twice, again in row {row + 1} of numbers")
    if len(x) < _SCATTERED * cells:
        raise ValueError(
            f"{len(x)} points of three columns x, y and z at {len(along_x)} different x and {len(along_y)} different "
            "y, which are no grid: interpolate them to one, or save the map as rows of heights; in a profile, delete "
            "what is neither positions nor heights"
        )
    along_x, of_x = _completed(along_x) or (along_x, np.arange(len(along_x)))
    along_y, of_y = _completed(along_y) or (along_y, np.arange(len(along_y)))
    heights = np.full((len(along_y), len(along_x)), np.nan)
    heights[of_y[j], of_x[i]] = z
    return heights, {"x": along_x, "y": along_y}


def _spacing(positions: Reals, of: np.dtype[Any], name: str) -> tuple[float, tuple[str, ...]]:
    """Spacing of even positions, that were stored in numbers `of` a type, and what was done; 0 of uneven ones."""
    mean, at = (positions[-1] - positions[0]) / (len(positions) - 1), np.arange(len(positions))
    rounding = 4.0 * float(np.finfo(of).eps) * abs(positions).max() if of.kind == "f" else 0.0
    is_even = (abs(np.diff(positions) - mean) <= UNEVEN * abs(mean) + rounding).all()
    if is_even or (abs(positions - positions[0] - mean * at) <= _ROUNDED * abs(mean)).all():
        return mean, ()
    # The steps of positions of few digits are of two sizes, which mix evenly. A few long ones are missing positions.
    digits = (10.0**-k for k in range(10))
    digit = next((d for d in digits if (abs(positions / d - np.round(positions / d)) < 1e-6).all()), inf)
    mean = float(np.polyfit(at, positions, 1)[0])
    short = int((np.round(np.diff(positions) / digit) == np.floor(mean / digit)).sum())
    rarer = min(short, len(positions) - 1 - short)
    if not np.ptp(positions - mean * at) <= _WHOLE * digit < inf or rarer < max(_FEWEST, _RARE * len(positions)):
        return 0.0, ()
    return mean, (f"took positions {name} for even ones {abs(mean):.4g} apart, rounded to {digit:g}",)


def _completed(positions: Reals) -> tuple[Reals, Indices] | None:
    """Even positions of which those given, which rise, are some, and their places; None if there are none."""
    steps = np.diff(positions)
    if len(steps) < _FEWEST or not (steps > 0.0).all():
        return None
    counts = np.round(steps / np.median(steps))
    total = counts.sum()
    if not len(steps) < total <= _SPARSE * len(steps) or not counts.all():
        return None
    places = np.append(0, np.cumsum(counts)).astype(np.int64)
    even = positions[0] + (positions[-1] - positions[0]) / total * np.arange(total + 1)
    return (even, places) if (abs(even[places] - positions) <= _ROUNDED * (even[1] - even[0])).all() else None


def _is_axis(rows: Reals) -> bool:
    """Whether the first of these rows is evenly spaced, and none of the next two goes on with it."""
    first = rows[0]
    if len(first) < _FEWEST or not _is_even(first):
        return False
    step = (first[-1] - first[0]) / (len(first) - 1)
    bends = abs(np.diff(rows.mean(axis=1), 2))  # of the slope across the rows: of a plane 0
    if len(bends) >= _FEWEST and bends[0] > 10.0 * bends[1:].max() + abs(step):
        return True
    for row in rows[1:3]:
        alike = abs(np.diff(row) - step) <= _ALIKE * abs(step)
        tilted = _is_even(row) and 0.25 <= (row[-1] - row[0]) / (first[-1] - first[0]) <= 4.0
        if tilted or alike.mean() >= 0.5:
            return False
    return True


def _is_even(line: Reals) -> bool:
    steps = np.diff(line)
    mean = steps.mean()
    return bool(mean != 0.0 and (abs(steps - mean) <= _EVEN * abs(mean)).all())
