"""Heights that occur too often in a measured field: of a saturated or stuck instrument, or marks of missing heights."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from gfmd_numba.arrays import Flags, Reals

OFTEN = 4.0  # times as often as the heights next to it in size,
ROUNDED = 8  # and as many more times where those repeat themselves, too, as in files of few digits
SHARE = 5e-4  # of all heights, that are equal
FEWEST = 5  # equal heights
LEVELS = 12  # different heights: with fewer, the surface is a grating, or counts
BEYOND = 0.1  # of the range of all other heights, by which a mark of missing heights lies outside
_NEXT = 8  # heights above and below, with which one is compared
_RUN = 3.0  # equal neighbours in the mean, from which on heights are stuck
_DESIGN = 0.005  # of the second difference, by which it changes between neighbours on wedges, parabolas and circles

Cause = Literal["top", "bottom", "mark", "stuck"]


@dataclass(frozen=True)
class Repeated:
    """A height, how often it occurs in how many runs, what it may be, and where it is `[nx]` or `[ny, nx]`."""

    height: float
    runs: int
    cause: Cause
    at: Flags

    @property
    def count(self) -> int:
        """Number of points with this height."""
        return int(self.at.sum())


def repeated(heights: Reals) -> list[Repeated]:
    """Heights of a field that occur too often, the most frequent first; missing ones are not-a-number."""
    values, counts = np.unique(heights[~np.isnan(heights)], return_counts=True)
    if len(values) < LEVELS or is_design(heights):
        return []
    least = max(FEWEST, SHARE * heights.size)
    found = []
    for i in np.flatnonzero(counts >= least):
        nearest = np.concatenate([counts[max(i - _NEXT, 0) : i], counts[i + 1 : i + 1 + _NEXT]])
        if counts[i] > OFTEN * nearest.mean() + (ROUNDED if nearest.max() > 1 else 0):
            found.append(_described(heights, values, int(i)))
    return sorted(found, key=lambda each: -each.count)


def is_design(heights: Reals) -> bool:
    """Whether a surface has no roughness at all: its second difference along x hardly changes between neighbours."""
    second = np.diff(heights, 2, axis=-1)
    rounding = 64.0 * float(np.finfo(np.float64).eps * np.nanmax(abs(heights)))
    return float(np.nanmedian(abs(np.diff(second, axis=-1)))) <= _DESIGN * float(np.nanmedian(abs(second))) + rounding


def _described(heights: Reals, values: Reals, i: int) -> Repeated:
    at = heights == values[i]
    others = np.delete(values, i)
    gap = max(others[0] - values[i], values[i] - others[-1])
    runs = int(at[..., 0].sum() + (np.diff(at.astype(np.int8), axis=-1) == 1).sum())
    cause: Cause = "stuck"
    if gap > BEYOND * (others[-1] - others[0]):
        cause = "mark"
    elif gap > 0.0:
        cause = "top" if i else "bottom"
    elif at.sum() < _RUN * runs:
        cause = "mark"
    return Repeated(float(values[i]), runs, cause, at)
