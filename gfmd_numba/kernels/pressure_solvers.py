"""Compiled parts of solvers that iterate on the pressure: all but the transforms and the preconditioner.

An active-set Newton step works on one row: arrays are `[x]`, those over the nodes in contact hold `count` values.

Under a hardness, plastic nodes carry exactly the hardness, open nodes nothing, and free nodes a pressure in between. A
plastic node may penetrate.

A constrained conjugate gradient iteration (Polonsky & Keer, Wear 231:206, 1999) works on a batch. A row has a list of
its free nodes, so that only the gap is computed node by node; elsewhere the direction is zero. `search`
`[3, realisation]` is what iterations leave to the next: the sum of the squared gaps, the step, and 0 where the
direction does not count any more, or else 1.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.kernels.compilation import jit


class Iterate(NamedTuple):
    """Pressure `p` of a row or of a batch, its `gap`, the direction `t` of the search and its displacement `st`."""

    p: Reals
    gap: Reals
    t: Reals
    st: Reals


@jit
def contact_nodes(contact: Flags, n: int, nodes: Indices) -> int:
    """List the nodes in contact in their order around the period, beginning behind the widest gap; their number."""
    ascending = np.flatnonzero(contact[:n])
    begin_behind_widest_gap(ascending, ascending.size, n, nodes)
    return ascending.size


@jit
def begin_behind_widest_gap(ascending: Indices, count: int, n: int, nodes: Indices) -> None:
    """Copy nodes in ascending order so that they begin behind the widest gap between two."""
    start = 0
    widest = 0
    for k in range(count):
        before = ascending[k - 1] if k > 0 else ascending[count - 1] - n
        if ascending[k] - before > widest:
            widest = ascending[k] - before
            start = k
    for k in range(count):
        nodes[k] = ascending[(start + k) % count]


@jit
def closing_displacement(gap: Reals, nodes: Indices, r: Reals) -> float:
    """Displacement r that closes the gap on some nodes in contact; its sum."""
    total = 0.0
    for k in range(nodes.size):
        r[k] = -gap[nodes[k]]
        total += r[k]
    return total


@jit
def take_off(r: Reals, mean: float) -> None:
    """Take a mean off all values."""
    for k in range(r.size):
        r[k] -= mean


@jit
def sum_of(values: Reals) -> float:
    """Sum of all values."""
    total = 0.0
    for k in range(values.size):
        total += values[k]
    return total


@jit
def sums_of(z: Reals, uniform: Reals) -> tuple[float, float]:
    """Sums of all values, of a change and of the pressures that a uniform displacement takes."""
    total = takes = 0.0
    for k in range(z.size):
        total += z[k]
        takes += uniform[k]
    return total, takes


@jit
def newton_change(
    r: Reals, z: Reals, uniform: Reals, share: float, p: Reals, nodes: Indices
) -> tuple[float, float, float, float, float, float]:
    """Take a share of a `uniform` displacement's pressure off the change z of the pressure on some nodes; its sizes.

    The sizes are its energy r z, the largest |z|, |pressure| and |r|, and the sums of |z| and |pressure|.
    """
    energy = 0.0
    largest = 0.0
    peak = 0.0
    open_by = 0.0
    moved = 0.0
    carried = 0.0
    for k in range(nodes.size):
        if share != 0.0:
            z[k] -= share * uniform[k]
        energy += r[k] * z[k]
        largest = max(largest, abs(z[k]))
        peak = max(peak, abs(p[nodes[k]]))
        open_by = max(open_by, abs(r[k]))
        moved += abs(z[k])
        carried += abs(p[nodes[k]])
    return energy, largest, peak, open_by, moved, carried


@jit
def newton_error(sizes: tuple[float, float, float, float, float, float], rounding: float) -> float:
    """Size of a change of the pressure: the largest over the largest, or sum over sum.

    It is zero where what it is to close is within `rounding` of zero.
    """
    energy, largest, peak, open_by, moved, carried = sizes
    return max(largest / peak, moved / carried) if open_by > rounding and energy > 0.0 else 0.0


@jit
def quotient(dividend: float, divisor: float) -> float:
    """Quotient of two numbers, infinite or not a number where the divisor is 0, which Python refuses."""
    return dividend / divisor


@jit
def sum_from(gap: Reals, first: float, nodes: Indices) -> float:
    """Sum of the gaps on some nodes beyond the first one."""
    total = 0.0
    for k in range(nodes.size):
        total += gap[nodes[k]] - first
    return total


@jit
def work_done(z: Reals, st: Reals, nodes: Indices) -> float:
    """Sum of the products of some pressures with the displacement of the last direction on their nodes."""
    total = 0.0
    for k in range(nodes.size):
        total += z[k] * st[nodes[k]]
    return total


@jit
def curvature(t: Reals, st: Reals, nodes: Indices) -> float:
    """Sum of the products of the direction with its displacement on some nodes."""
    total = 0.0
    for k in range(nodes.size):
        total += t[nodes[k]] * st[nodes[k]]
    return total


@jit
def newton_direction(z: Reals, beta: float, nodes: Indices, t: Reals) -> None:
    """Add z to beta times the last direction on some nodes."""
    for k in range(nodes.size):
        t[nodes[k]] = z[k] + beta * t[nodes[k]]


@jit
def newton_update(iterate: Iterate, step: float, nodes: Indices, r: Reals) -> float:
    """Go a step along the direction on some nodes, in all but the gap; the sum of r there."""
    p, t, st = iterate.p, iterate.t, iterate.st
    total = 0.0
    for k in range(nodes.size):
        p[nodes[k]] += step * t[nodes[k]]
        r[k] -= step * st[nodes[k]]
        total += r[k]
    return total


@jit
def close_few(gap: Reals, nodes: Indices, r: Reals, free_mean: bool) -> None:
    """Displacement r that closes the gap on the nodes in contact.

    `free_mean`: the load is prescribed, so the gap is known up to a constant; r has no mean then.
    """
    total = closing_displacement(gap, nodes, r)
    if free_mean:
        take_off(r, total / nodes.size)


@jit
def change_few(
    r: Reals, z: Reals, uniform: Reals, p: Reals, nodes: Indices, rounding: float, free_mean: bool
) -> tuple[float, float]:
    """Energy r z of a change z of the pressure, and its size as in `newton_error`.

    Under a prescribed load a multiple of the pressure of a `uniform` displacement is subtracted from z first, so that z
    does not change the load.
    """
    share = 0.0
    if free_mean:
        total, takes = sums_of(z, uniform)
        share = total / takes
    sizes = newton_change(r, z, uniform, share, p, nodes)
    return sizes[0], newton_error(sizes, rounding)


@jit
def direct_few(z: Reals, step: float, last: float, nodes: Indices, iterate: Iterate) -> None:
    """Make the direction z, conjugate to the last one; the energy `last` is zero if there was none."""
    beta = 0.0
    if last > 0.0:
        beta = -step / last * work_done(z, iterate.st, nodes)
    else:
        iterate.t[:] = 0.0
    newton_direction(z, beta, nodes, iterate.t)


@jit
def update_few(iterate: Iterate, energy: float, nodes: Indices, r: Reals, free_mean: bool) -> float:
    """Line search along the direction, of all but the gap; the step."""
    step: float = energy / curvature(iterate.t, iterate.st, nodes)
    total = newton_update(iterate, step, nodes, r)
    if free_mean:
        take_off(r, total / nodes.size)
    return step


@jit
def add_displacement(gap: Reals, st: Reals, step: float) -> None:
    """Add what a step along a direction opens to the gap."""
    for j in range(gap.size):
        gap[j] += step * st[j]


@jit
def revise_contact(p: Reals, gap: Reals, contact: Flags, approach: float, rounding: float) -> tuple[int, float]:
    """Take the approach off the gap; nodes under tension leave the contact and lose it, nodes that overlap join.

    Return how many nodes changed sides, and the sum of the pressures.
    """
    changed = 0
    total = 0.0
    for j in range(p.size):
        gap[j] -= approach
        if contact[j]:
            if p[j] > 0.0:
                total += p[j]
            else:
                p[j] = 0.0
                contact[j] = False
                changed += 1
        elif gap[j] < -rounding:
            contact[j] = True
            changed += 1
    return changed, total


_ROUNDED = 1e-12  # of all that is added up


@jit
def approach(p: Reals, gap: Reals, free_gaps: float, count: int, n: int) -> float:
    """Approach under a prescribed load: the mean of the gaps of `count` free nodes, which add up to `free_gaps`.

    Without any it is half way between the highest gap of a plastic node and the lowest one of an open node.
    """
    if count > 0:
        return free_gaps / count
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
    free_gaps = 0.0
    count = 0
    for j in range(n):
        if 0.0 < p[j] < hardness:
            free_gaps += gap[j]
            count += 1
    gap[:n] -= approach(p, gap, free_gaps, count, n)


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
def line_search(p: Reals, gap: Reals, last_p: Reals, last_gap: Reals, n: int) -> int:
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
def part_to_bound(p: float, last_p: float, hardness: float) -> float:
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
            first = min(first, part_to_bound(p[j], last_p[j], hardness))
    if first == 1.0:
        return 0
    stopped = 0
    for j in range(n):
        if contact[j]:
            if part_to_bound(p[j], last_p[j], hardness) == first:
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
        free_gaps = 0.0
        for k in range(count):
            free_gaps += gap[nodes[k]]
        gap[:n] -= approach(p, gap, free_gaps, count, n)
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


Nodes = npt.NDArray[np.uint32]

_BLOCK = 64  # nodes that are counted at once, which tells whether one of them is worth a look


@jit
def cg_free(
    p: Reals, t: Reals, nodes: Nodes, count: Indices, active: Indices, n: int, hardness: float = np.inf
) -> None:
    """List the free nodes in order, and set the direction t to zero on those that were free before."""
    for i in active:
        for k in range(count[i]):
            j = nodes[i, k]
            if not 0.0 < p[i, j] < hardness:
                t[i, j] = 0.0
        found = 0
        for j in range(n):
            if p[i, j] > 0.0 and p[i, j] < hardness:  # a chain of both takes longer where most are zero
                nodes[i, found] = j
                found += 1
        count[i] = found


@jit
def cg_gap(
    sp: Reals, punch: Reals, gap: Reals, nodes: Nodes, count: Indices, active: Indices, n: int, free_mean: bool
) -> None:
    """Gap left by a pressure whose displacement is sp (Polonsky & Keer 1999, eqs 5-6).

    `free_mean`: the load is prescribed, so the gap is known up to the approach, which the touching nodes fix.
    """
    for i in active:
        approach = 0.0
        if free_mean:
            first = punch[i, nodes[i, 0]] + sp[i, nodes[i, 0]]
            for k in range(count[i]):  # as differences: a sum of gaps almost alike would lose digits
                j = nodes[i, k]
                approach += punch[i, j] + sp[i, j] - first
            approach = first + approach / count[i]
        for j in range(n):
            gap[i, j] = punch[i, j] + sp[i, j] - approach


@jit
def cg_direction(
    gap: Reals, t: Reals, nodes: Nodes, count: Indices, search: Reals, rounding: Reals, active: Indices, free_mean: bool
) -> None:
    """Conjugate direction on the free nodes (Polonsky & Keer 1999, eq. 7); elsewhere t stays zero.

    Nodes that left or joined the contact spoil the old direction in two ways. Under a prescribed load the direction may
    now change the load, which rescaling the pressure would undo: its mean is subtracted. And the direction may lead
    uphill: it is then dropped. If all gaps are within `rounding` of closed, the direction is zero.
    """
    norm, keep = search[0], search[2]
    for i in active:
        free = count[i]
        new_norm = 0.0
        downhill = 0.0
        mean = 0.0
        for k in range(free):
            j = nodes[i, k]
            new_norm += gap[i, j] * gap[i, j]
            downhill += gap[i, j] * t[i, j]
            mean += t[i, j]
        mean = mean / free if free_mean and free > 0 else 0.0
        beta = keep[i] * new_norm / norm[i] if norm[i] > 0.0 else 0.0
        if new_norm + beta * downhill <= 0.0:
            beta = 0.0
        closed = new_norm <= free * rounding[i] ** 2
        for k in range(free):
            j = nodes[i, k]
            t[i, j] = 0.0 if closed else gap[i, j] + beta * (t[i, j] - mean)
        norm[i] = new_norm


@jit
def overlapping(p: Reals, gap: Reals, nodes: Nodes, count: int, n: int) -> int:
    """Append the nodes without pressure that overlap to a list `[x]`, and return how long it is then."""
    for first in range(0, n, _BLOCK):
        pressures = p[first : min(first + _BLOCK, n)]
        gaps = gap[first : min(first + _BLOCK, n)]
        found = 0
        for k in range(gaps.size):
            found += 1 if (gaps[k] < 0.0) & (pressures[k] == 0.0) else 0
        if found > 0:
            for k in range(gaps.size):
                if gaps[k] < 0.0 and pressures[k] == 0.0:
                    nodes[count] = first + k
                    count += 1
    return count


@jit
def cg_update(
    iterate: Iterate,
    nodes: Nodes,
    count: Indices,
    search: Reals,
    load: Reals,
    active: Indices,
    free_mean: bool,
    hardness: float = np.inf,
) -> None:
    """Line search, clipping, overlap correction and load balance (Polonsky & Keer 1999, eqs 8-12).

    Penetrating nodes at the hardness keep it, those that have opened come down from it as overlapping ones rise from 0.
    Without hardness the list then has the nodes under pressure, those that joined at its end.
    """
    p, gap, t, st = iterate
    n, step, keep = nodes.shape[1], search[1], search[2]
    for i in active:
        free = count[i]
        mean = 0.0
        total = 0.0
        gt = 0.0
        rt = 0.0
        for k in range(free):
            j = nodes[i, k]
            mean += st[i, j]
            total += t[i, j]
            gt += gap[i, j] * t[i, j]
            rt += st[i, j] * t[i, j]
        if free_mean and free > 0:  # a uniform displacement does no work on a constant load
            rt -= mean * total / free
        if rt > 0.0:  # a single touching node has no direction of its own: it keeps the last step
            step[i] = gt / rt
        if hardness < np.inf:
            keep[i] = bounded_step(Iterate(p[i], gap[i], t[i], st[i]), step[i], load[i], hardness, n, free_mean)
            continue
        listed = overlapping(p[i], gap[i], nodes[i], free, n)
        overlap = listed > free
        touching = 0
        total = 0.0
        for k in range(listed):
            j = nodes[i, k]
            new = max(p[i, j] - step[i] * t[i, j], 0.0)
            if new == 0.0 and gap[i, j] < 0.0:
                overlap = True
                new = -step[i] * gap[i, j]
            p[i, j] = new
            if new > 0.0:
                total += new
                nodes[i, touching] = j
                touching += 1
            else:
                t[i, j] = 0.0
        count[i] = touching
        keep[i] = 0.0 if overlap else 1.0
        if free_mean:
            scale = load[i] * n / total
            for k in range(touching):
                p[i, nodes[i, k]] *= scale


@jit
def close_gap(p: Reals, gap: Reals, punch: Reals, active: Indices, n: int, u: Reals, hardness: float = np.inf) -> None:
    """Displacement that touches wherever there is pressure or overlap, and penetrates only under the hardness."""
    for i in active:
        for j in range(n):
            if p[i, j] >= hardness:
                u[i, j] = punch[i, j] - min(gap[i, j], 0.0)
            else:
                u[i, j] = punch[i, j] - (0.0 if p[i, j] > 0.0 else max(gap[i, j], 0.0))
