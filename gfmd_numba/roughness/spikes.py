"""Spikes of an instrument: single heights that stand far out of a measured field, found and replaced.

The filter is Hampel's with a recursion, as Pearson, Neuvo, Astola and Gabbouj describe it (EURASIP Journal on Advances
in Signal Processing 2016:87, doi 10.1186/s13634-016-0383-6): a height that lies too far from the median of a window
about it is replaced by that median, until none does. What it finds is then interpolated, as a median would stick out of
a slope or a crest by itself. Three things fit it to surfaces. The form is subtracted first. The
scale is that of the steps between neighbours, by their median absolute value, as a surface has no scale of heights. And
a spike is small: what extends over more than three points is an edge, a scratch or a piece of the surface.
"""

import numpy as np
import scipy  # its modules load with their first use

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.roughness.form import polynomial
from gfmd_numba.roughness.processing import interpolated

STEPS = 8.0  # standard steps between neighbours by which a spike is off the median of the heights around it
NEARBY = 5.0  # rms steps around it, likewise: where a surface is rough, its steps are large
QUANTA = 4.0  # quanta of a digitiser
NEIGHBOUR = 0.4  # of a spike, by which no point next to it is off: the flanks of a valley are
MOST = 3  # points of a spike
FEWEST = 24  # points in each direction, on which steps have a scale
_HALF = {1: (3, 6), 2: (2, 3)}  # half widths of the windows of the median and of the steps around, by dimension
_ROUNDING = 1e-9  # of the range of heights, below which differences are rounding
_AGAIN = 1e-3  # of all heights
_ROUNDS = 8
_SHOWN = 20


def without_spikes(heights: Reals) -> tuple[Reals, tuple[str, ...]]:
    """Heights `[nx]` or `[ny, nx]` interpolated where they had spikes, and what was done and where."""
    _, found = despiked(heights)
    indices = np.argwhere(found)
    if not len(indices):
        return heights, ("found no spikes",)
    shown = "; ".join(", ".join(map(str, index)) for index in indices[:_SHOWN].tolist())
    more = f" and {len(indices) - _SHOWN} more" if len(indices) > _SHOWN else ""
    many = "height in a spike" if len(indices) == 1 else "heights in spikes"
    cleaned, how = interpolated(heights, found)
    return cleaned, (f"interpolated {len(indices)} {many} {how}, of {heights.size}, at index {shown}{more}",)


def despiked(heights: Reals, step: float = 0.0) -> tuple[Reals, Flags]:
    """Heights `[nx]` or `[ny, nx]` with medians in place of spikes, and where those are.

    `step` is that of a digitiser whose heights were levelled since, so that they do not tell it.
    """
    found = np.zeros(heights.shape, dtype=bool)
    if min(heights.shape) < FEWEST:
        return heights, found
    cleaned = heights
    finest = max(QUANTA * max(step, quantum(heights)), _ROUNDING * float(np.ptp(heights)))
    for _ in range(_ROUNDS):
        form = polynomial(cleaned, 2)
        level = cleaned - form
        at, medians = _spikes(level, finest)
        if not len(at):
            break
        where = tuple(at.T)
        level[where] = medians
        found[where] = True
        cleaned = np.where(found, level + form, heights)
    return cleaned, found


def _spikes(level: Reals, finest: float) -> tuple[Indices, Reals]:
    """Indices `[spike, axis]` of the spikes of level heights, none as small as the finest, and the medians around."""
    steps = [np.diff(level, axis=axis) for axis in range(level.ndim)]
    standard = 1.4826 * float(np.median(np.concatenate([abs(each).ravel() for each in steps])))
    least = max(STEPS * standard, finest)
    suspects = np.zeros(level.shape, dtype=bool)  # next to a large step
    for axis, each in enumerate(steps):
        along, large = np.moveaxis(suspects, axis, 0), np.moveaxis(abs(each) > least / 2.0, axis, 0)
        along[:-1] |= large
        along[1:] |= large
    at = np.argwhere(suspects)
    if not len(at):
        return at, np.empty(0)
    median_half, step_half = _HALF[level.ndim]
    points = tuple(range(1, level.ndim + 1))
    medians = np.median(_windows(level, at, median_half), axis=points)
    off = np.zeros(level.shape)
    off[tuple(at.T)] = abs(level[tuple(at.T)] - medians)
    calm = level.copy()
    far = off > least
    calm[far] = medians[far[tuple(at.T)]]
    around = _windows(calm, at, step_half)
    nearby = np.zeros(level.shape)
    nearby[tuple(at.T)] = np.sqrt(
        np.mean([(np.diff(around, axis=axis) ** 2).mean(axis=points) for axis in points], axis=0)
    )
    out = _alone(far & (off > NEARBY * nearby), off)[tuple(at.T)]
    return at[out], medians[out]


def quantum(heights: Reals) -> float:
    """Least difference of heights that occur again and again, as they do in few digits or bits; 0 without any."""
    values, counts = np.unique(heights, return_counts=True)
    again = values[counts > max(2.0, _AGAIN * heights.size)]
    return float(np.diff(again).min()) if len(again) > 1 else 0.0


def _windows(field: Reals, at: Indices, half: int) -> Reals:
    """Windows `[point, (y,) x]` about points, mirrored about the last point at the ends."""
    windows = np.lib.stride_tricks.sliding_window_view(
        np.pad(field, half, mode="reflect"), (2 * half + 1,) * field.ndim
    )
    return np.asarray(windows[tuple(at.T)])


def _alone(far: Flags, off: Reals) -> Flags:
    """Those of the points far off that stand in small groups, next to which no point is off by nearly as much."""
    groups, count = scipy.ndimage.label(far, np.ones((3,) * far.ndim))
    if not count:
        return far
    every = np.arange(1, count + 1)
    around = scipy.ndimage.maximum_filter(np.where(far, 0.0, off), 3, mode="constant")
    alone = scipy.ndimage.maximum(around, groups, every) < NEIGHBOUR * scipy.ndimage.maximum(off, groups, every)
    small = np.bincount(groups.ravel())[1:] <= MOST
    return np.asarray(np.concatenate([[False], alone & small])[groups])
