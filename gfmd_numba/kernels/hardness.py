"""Compiled parts of contact under a hardness: plastic nodes carry exactly that, open ones nothing, free ones between.

A plastic node may penetrate. Arrays are `[x]`.
"""

import numpy as np

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.kernels.active_sets import Iterate
from gfmd_numba.kernels.compilation import jit

_ROUNDED = 1e-12  # of all that is added up


@jit
def approach_without_free_nodes(p: Reals, gap: Reals, n: int) -> float:
    """Approach half way between the highest gap of a plastic node and the lowest one of an open node."""
    highest = -np.inf
    lowest = np.inf
    for j in range(n):
        if p[j] > 0.0:
            highest = max(highest, gap[j])
        else:
            lowest = min(lowest, gap[j])
    return 0.5 * (highest + lowest)


@jit
def level(p: Reals, gap: Reals, hardness: float, n: int) -> None:
    """Take the approach off the gap under a prescribed load, which the free nodes fix."""
    approach = 0.0
    count = 0
    for j in range(n):
        if 0.0 < p[j] < hardness:
            approach += gap[j]
            count += 1
    if count > 0:
        approach /= count
    else:
        approach = approach_without_free_nodes(p, gap, n)
    for j in range(n):
        gap[j] -= approach


@jit
def bound(p: Reals, movable: Flags, total: float, hardness: float, n: int) -> None:
    """Move pressures by one number so that all add up to `total` between their bounds: the nearest pressures that do.

    Nodes that are not `movable` are at a bound, and move only if the others cannot carry the rest; `total` is less than
    n times the hardness. The sum grows with the number: Newton's method, or halves of where it is.
    """
    fixed = 0.0
    count = 0
    for j in range(n):
        if movable[j]:
            count += 1
        else:
            fixed += p[j]
    some = fixed < total < fixed + count * hardness
    if not some:
        fixed = 0.0
        movable = np.ones(n, dtype=np.bool_)
    shift = _shift(p, movable, total, fixed, hardness, n)
    inside = 0
    missing = total - fixed
    for j in range(n):
        if movable[j]:
            p[j] = min(max(p[j] + shift, 0.0), hardness)
            missing -= p[j]
            inside += 0.0 < p[j] < hardness
    for j in range(n):  # what rounding took, where pressures were far beyond their bounds
        if inside > 0 and 0.0 < p[j] < hardness and movable[j]:
            p[j] = min(max(p[j] + missing / inside, 0.0), hardness)


@jit
def _shift(p: Reals, movable: Flags, total: float, fixed: float, hardness: float, n: int) -> float:
    """Number by which movable pressures move between their bounds to add up to `total` with the `fixed` rest."""
    shift = 0.0
    low = -np.inf
    high = np.inf
    for _ in range(200):
        carried = fixed
        inside = 0
        below = -np.inf
        above = np.inf
        for j in range(n):
            if not movable[j]:
                continue
            moved = p[j] + shift
            if moved <= 0.0:
                below = max(below, moved)
            elif moved < hardness:
                carried += moved
                inside += 1
            else:
                carried += hardness
                above = min(above, moved - hardness)
        missing = total - carried
        if missing > 0.0:
            low = shift
        else:
            high = shift
        if abs(missing) <= 1e-15 * total:
            break
        if inside > 0:
            following = shift + missing / inside
        else:  # half way into the nodes that come next
            following = shift - below + 0.5 * hardness if missing > 0.0 else shift - above - 0.5 * hardness
        if not low < following < high:
            following = 0.5 * (low + high)
            if not low < following < high:
                break
        shift = following
    return shift


@jit
def bounded_step(iterate: Iterate, step: float, load: float, hardness: float, n: int, free_mean: bool) -> float:
    """Step of free nodes along t, of the others along the gap, to the nearest pressures between bounds.

    Return 0 if nodes have become free, of which t says nothing, so that the next direction begins anew, or else 1.
    """
    p, gap, t, _ = iterate
    for j in range(n):
        p[j] -= step * (t[j] if 0.0 < p[j] < hardness else gap[j])
    if free_mean:
        bound(p, np.ones(n, dtype=np.bool_), load * n, hardness, n)
    else:
        for j in range(n):
            p[j] = min(max(p[j], 0.0), hardness)
    for j in range(n):
        if t[j] == 0.0 and 0.0 < p[j] < hardness:
            return 0.0
    return 1.0


@jit
def damp(p: Reals, gap: Reals, last_p: Reals, last_gap: Reals, n: int) -> int:
    """Go back towards the last pressure, to the least energy on the way, if the energy has increased.

    The energy p (punch + gap) / 2 is a parabola between the two, whose slopes at both ends the gaps tell. Return 0 if
    it has not increased, 1 if it has and the pressure now is on the way, 2 if it increases from the start: nothing has
    then been changed. Otherwise the last pressure and gap become the present ones.
    """
    before = 0.0
    after = 0.0
    size = 0.0
    for j in range(n):
        change = p[j] - last_p[j]
        before += change * last_gap[j]
        after += change * gap[j]
        size += abs(change) * (abs(last_gap[j]) + abs(gap[j]))
    uphill = before + after > _ROUNDED * size
    if uphill and before >= 0.0:
        return 2
    if uphill:
        share = before / (before - after)
        for j in range(n):
            p[j] = last_p[j] + share * (p[j] - last_p[j])
            gap[j] = last_gap[j] + share * (gap[j] - last_gap[j])
    for j in range(n):
        last_p[j] = p[j]
        last_gap[j] = gap[j]
    return 1 if uphill else 0


@jit
def room(p: float, last_p: float, hardness: float) -> float:
    """Share of the way from the last pressure to p that stays between the bounds."""
    if p < 0.0:
        return last_p / (last_p - p)
    if p > hardness:
        return (hardness - last_p) / (p - last_p)
    return 1.0


@jit
def stop_at_first_bound(p: Reals, last_p: Reals, contact: Flags, hardness: float, n: int) -> int:
    """Go from the last pressure of free nodes only as far as the first of them reaches a bound, where it stays.

    Return how many did; 0 if none is beyond its bounds.
    """
    first = 1.0
    for j in range(n):
        if contact[j]:
            first = min(first, room(p[j], last_p[j], hardness))
    if first == 1.0:
        return 0
    stopped = 0
    for j in range(n):
        if contact[j]:
            if room(p[j], last_p[j], hardness) == first:
                p[j] = 0.0 if p[j] < 0.0 else hardness
                contact[j] = False
                stopped += 1
            else:
                p[j] = last_p[j] + first * (p[j] - last_p[j])
    return stopped


@jit
def wrong_gaps(iterate: Iterate, nodes: Indices, count: int, n: int, rounding: float, free_mean: bool) -> float:
    """Fill t with the gaps of open nodes that overlap and of plastic nodes that do not, and zero; sum of its squares.

    Under a prescribed load the free nodes fix the approach, which is taken off the gap.
    """
    p, gap, t, _ = iterate
    if free_mean:
        approach = 0.0
        for k in range(count):
            approach += gap[nodes[k]]
        if count > 0:
            approach /= count
        else:
            approach = approach_without_free_nodes(p, gap, n)
        for j in range(n):
            gap[j] -= approach
    for j in range(n):
        wrong = gap[j] > rounding if p[j] > 0.0 else gap[j] < -rounding
        t[j] = gap[j] if wrong else 0.0
    for k in range(count):
        t[nodes[k]] = 0.0
    square = 0.0
    for j in range(n):
        square += t[j] * t[j]
    return square


@jit
def revise_bounds(
    iterate: Iterate, square: float, contact: Flags, n: int, load: float, hardness: float, free_mean: bool
) -> int:
    """Step against the wrong gaps t to the nearest pressures between bounds, and mark which nodes are free; how many
    were wrong.

    The step is the best along t, whose displacement is st. Under a prescribed load, nodes with a right gap keep their
    bound; unless the step carries nodes across both bounds, as punches too rough to deform do: then all may move.
    """
    p, gap, t, st = iterate
    curvature = 0.0
    wrong = 0
    for j in range(n):
        curvature += t[j] * st[j]
        wrong += t[j] != 0.0
    step = square / curvature if wrong > 0 else 0.0
    across = step * step * square > wrong * hardness * hardness
    outside = 0
    for j in range(n):
        if contact[j]:
            outside += not 0.0 < p[j] < hardness
        elif across:
            p[j] -= step * gap[j]
        else:
            p[j] -= step * t[j]
    if wrong + outside == 0:
        return 0
    if free_mean:
        for j in range(n):
            contact[j] |= across or t[j] != 0.0
        bound(p, contact, load * n, hardness, n)
    for j in range(n):
        p[j] = min(max(p[j], 0.0), hardness)
        contact[j] = 0.0 < p[j] < hardness
    return wrong + outside
