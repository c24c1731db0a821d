"""Axis values in the first row and the first column of a map in text, which are positions and no heights."""

import numpy as np

from gfmd_numba.arrays import Reals

_EVEN = 0.05  # of the mean step, by which the steps of an axis may differ: its values may have few digits
_ALIKE = 2.0 * _EVEN  # likewise, by which a step of the heights may differ from one that goes on in the next row
_FEWEST = 4  # values that make an axis on their own


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
