"""Steps of an instrument: places of a measured field at which all heights beyond are offset."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals

WIDTHS = (1, 4, 16)  # points whose means are compared on both sides of a place
STANDARDS = 8.0  # standard differences of such means
OVER_NEXT = 2.0  # the largest of all other differences: a surface made of walls has many
SHARE = 0.5  # of the rms height, which a step is at least
MOST = 4  # steps
_LASTS = 8  # points over which half of a step lasts
_SAMPLES = 24  # independent differences, of which a standard one can be told


def offsets(level: Reals) -> list[tuple[int, int, float]]:
    """Axis, index of the last point before, and height of the steps of level heights `[nx]` or `[ny, nx]`."""
    if level.ndim == 1:
        return [(0, int(i), float(step)) for i, step in _of_line(level, float(level.std()))]
    found = []
    for axis in range(level.ndim):
        other = 1 - axis
        line = np.append(0.0, np.cumsum(np.median(np.diff(level, axis=axis), axis=other)))
        found += [(axis, int(i), float(step)) for i, step in _of_line(line, float(level.std()))]
    return found


def _of_line(line: Reals, rms: float) -> list[tuple[int, float]]:
    n = len(line)
    sums = np.append(0.0, np.cumsum(line))
    for width in WIDTHS:
        if n < _SAMPLES * width or n < 4 * _LASTS:
            break
        ends = np.arange(width, n - width + 1)
        steps = (sums[ends + width] - 2.0 * sums[ends] + sums[ends - width]) / width
        least = max(STANDARDS * 1.4826 * float(np.median(abs(steps))), SHARE * rms)
        at = _peaks(steps, width)
        sizes = abs(steps[at])
        for count in range(min(MOST, len(at) - 1), 0, -1):
            if sizes[count - 1] > max(least, OVER_NEXT * sizes[count]):
                places = [int(ends[i]) - 1 for i in sorted(at[:count])]
                kept = [(i, step) for i in places if (step := _lasting(line, i)) != 0.0]
                if len(kept) == count:
                    return kept
    return []


def _peaks(steps: Reals, width: int) -> Indices:
    """Indices of the largest differences, the largest first, none nearer to another than two widths."""
    left, chosen = abs(steps), []
    for _ in range(MOST + 1):
        i = int(left.argmax())
        chosen.append(i)
        left[max(i - 2 * width, 0) : i + 2 * width + 1] = 0.0
    return np.array(chosen)


def _lasting(line: Reals, i: int) -> float:
    """Height of a step after index i, which is 0 if it is gone after some points, or took some points to rise."""
    before, after = line[max(i - _LASTS + 1, 0) : i + 1], line[i + 1 : i + 1 + _LASTS]
    step = float(np.median(after) - np.median(before))
    sharp = float(abs(np.diff(line[max(i - 1, 0) : i + 4])).max())
    return step if sharp > 0.5 * abs(step) and abs(step) > 0.5 * abs(line[i + 1] - line[i]) else 0.0
