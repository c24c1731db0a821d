"""Compiled parts of an active-set Newton step in one row: all but the transforms and the preconditioner.

Arrays are `[x]`, those over the nodes in contact hold `count` values.
"""

from typing import NamedTuple

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
    first = -1
    last = -1
    widest = 0
    start = 0
    for j in range(n):
        if contact[j]:
            if first < 0:
                first = j
            elif j - last > widest:
                widest = j - last
                start = j
            last = j
    if first < 0:
        return 0
    if first + n - last >= widest:
        start = first
    count = 0
    for j in range(start, n):
        if contact[j]:
            nodes[count] = j
            count += 1
    for j in range(start):
        if contact[j]:
            nodes[count] = j
            count += 1
    return count


@jit
def open_gap(sp: Reals, punch: Reals, n: int, gap: Reals) -> None:
    """Gap under a pressure whose displacement is sp."""
    for j in range(n):
        gap[j] = punch[j] + sp[j]


@jit
def closing_displacement(gap: Reals, nodes: Indices, count: int, r: Reals, free_mean: bool) -> None:
    """Displacement r that closes the gap on the nodes in contact.

    `free_mean`: the load is prescribed, so the gap is known up to a constant; r has no mean then.
    """
    for k in range(count):
        r[k] = -gap[nodes[k]]
    if free_mean:
        without_mean(r, count)


@jit
def without_mean(r: Reals, count: int) -> None:
    """Take the mean off the first `count` values."""
    mean = 0.0
    for k in range(count):
        mean += r[k]
    mean /= count
    for k in range(count):
        r[k] -= mean


@jit
def newton_error(
    r: Reals, z: Reals, uniform: Reals, p: Reals, nodes: Indices, count: int, rounding: float, free_mean: bool
) -> tuple[float, float]:
    """Energy r z of a change z of the pressure, and its size: the largest over the largest, or sum over sum.

    Under a prescribed load z first loses what changes the load, by means of the pressure that a `uniform`
    displacement takes. The error is zero where r is within `rounding` of zero.
    """
    share = 0.0
    if free_mean:
        total = 0.0
        for k in range(count):
            share += z[k]
            total += uniform[k]
        share /= total
    energy = 0.0
    largest = 0.0
    peak = 0.0
    moved = 0.0
    carried = 0.0
    open_by = 0.0
    for k in range(count):
        if free_mean:
            z[k] -= share * uniform[k]
        energy += r[k] * z[k]
        largest = max(largest, abs(z[k]))
        peak = max(peak, abs(p[nodes[k]]))
        moved += abs(z[k])
        carried += abs(p[nodes[k]])
        open_by = max(open_by, abs(r[k]))
    return energy, (max(largest / peak, moved / carried) if open_by > rounding and energy > 0.0 else 0.0)


@jit
def newton_direction(z: Reals, last: float, energy: float, nodes: Indices, count: int, n: int, t: Reals) -> None:
    """Direction t conjugate to the last one, whose energy is zero if there was none."""
    beta = 0.0
    if last > 0.0:
        beta = energy / last
    else:
        for j in range(n):
            t[j] = 0.0
    for k in range(count):
        t[nodes[k]] = z[k] + beta * t[nodes[k]]


@jit
def newton_update(
    iterate: Iterate, energy: float, nodes: Indices, count: int, n: int, r: Reals, free_mean: bool
) -> None:
    """Line search along the direction."""
    p, gap, t, st = iterate
    curvature = 0.0
    for k in range(count):
        curvature += t[nodes[k]] * st[nodes[k]]
    step = energy / curvature
    for k in range(count):
        p[nodes[k]] += step * t[nodes[k]]
        r[k] -= step * st[nodes[k]]
    if free_mean:
        without_mean(r, count)
    for j in range(n):
        gap[j] += step * st[j]


@jit
def revise_contact(
    iterate: Iterate,
    contact: Flags,
    nodes: Indices,
    count: int,
    n: int,
    load: float,
    rounding: float,
    free_mean: bool,
) -> int:
    """Nodes under tension leave the contact and lose it, nodes that overlap join; how many did.

    Under a prescribed load the nodes in contact fix the approach, which is taken off the gap, and the others carry
    what was lost.
    """
    p, gap = iterate.p, iterate.gap
    if free_mean:
        approach = 0.0
        for k in range(count):
            approach += gap[nodes[k]]
        approach /= count
        for j in range(n):
            gap[j] -= approach
    changed = 0
    total = 0.0
    for j in range(n):
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
    if free_mean and changed > 0:
        scale = load * n / total
        for j in range(n):
            p[j] *= scale
    return changed
