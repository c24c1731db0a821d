"""Compiled parts of a constrained conjugate gradient iteration (Polonsky & Keer, Wear 231:206, 1999).

Free are the nodes whose pressure is between its bounds, 0 and the `hardness`. A row has a list of them, so that only
the gap is computed node by node; elsewhere the direction is zero. `search` `[3, realisation]` is what iterations leave
to the next: the sum of the squared gaps, the step, and 0 where the direction does not count any more, or else 1.
"""

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.active_sets import Iterate
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.hardness import bounded_step

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
            for k in range(count[i]):
                j = nodes[i, k]
                approach += punch[i, j] + sp[i, j]
            approach /= count[i]
        for j in range(n):
            gap[i, j] = punch[i, j] + sp[i, j] - approach


@jit
def cg_direction(
    gap: Reals,
    t: Reals,
    nodes: Nodes,
    count: Indices,
    search: Reals,
    rounding: Reals,
    active: Indices,
    free_mean: bool,
) -> None:
    """Conjugate direction on the free nodes (Polonsky & Keer 1999, eq. 7); elsewhere t stays zero.

    Nodes that left or joined the contact spoil the old direction in two ways. Under a prescribed load it may now
    change the load, which rescaling the pressure would undo: it loses its mean. And it may lead uphill: it is
    then dropped. Gaps within `rounding` of closed point nowhere: the direction is then zero.
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
def close_gap(
    p: Reals,
    gap: Reals,
    punch: Reals,
    active: Indices,
    n: int,
    u: Reals,
    hardness: float = np.inf,
) -> None:
    """Displacement that touches wherever there is pressure or overlap, and penetrates only under the hardness."""
    for i in active:
        for j in range(n):
            if p[i, j] >= hardness:
                u[i, j] = punch[i, j] - min(gap[i, j], 0.0)
            else:
                u[i, j] = punch[i, j] - (0.0 if p[i, j] > 0.0 else max(gap[i, j], 0.0))
