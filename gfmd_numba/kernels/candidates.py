"""Compiled lists of candidates: the nodes of a profile that may come into contact.

They are listed around the period, behind the widest gap between them.
"""

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.kernels.compilation import jit

_DEEP = 0.6  # share of the deepest overlap of a stretch from which on its nodes join the contact


@jit
def candidates(
    p: Reals, sp: Reals, wall: Reals, n: int, free_mean: bool, wider: float, nodes: Indices, spare: Indices
) -> tuple[int, float]:
    """List the candidates under the pressure p whose displacement is sp; their number, and the approach.

    They are the nodes with pressure and those less open than these are, at most, from being closed.
    """
    count = 0
    approach = 0.0
    for j in range(n):
        if p[j] > 0.0:
            spare[count] = j
            approach += wall[j] + sp[j]
            count += 1
    approach = approach / count if free_mean and count > 0 else 0.0
    misfit = 0.0
    for k in range(count):
        misfit += abs(wall[spare[k]] + sp[spare[k]] - approach)
    widest = approach + (wider * misfit / count if count > 0 else 0.0)
    if wider > 0.0:
        count = 0
        for j in range(n):
            spare[count] = j  # stays if j is one: without a branch, which would often be guessed wrong
            count += (wall[j] + sp[j] <= widest) | (p[j] > 0.0)
    begin_behind_widest_gap(spare, count, n, nodes)
    return count, approach


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
def distances_around(nodes: Indices, count: int, n: int, distances: Indices) -> None:
    """Distances of nodes around a period from the one before, of the first from the last."""
    for k in range(count):
        distance = nodes[k] - (nodes[k - 1] if k > 0 else nodes[count - 1])
        distances[k] = distance if distance > 0 else distance + n


@jit
def join_deepest(gap: Reals, touches: Flags, nodes: Indices, count: int, closed: float) -> int:
    """Bring into contact what overlaps, of each stretch of overlapping nodes the deepest part; how many nodes did."""
    joining = 0
    k = 0
    while k < count:
        if touches[k] or not gap[k] < closed:
            k += 1
            continue
        first = k
        deepest = gap[k]
        k += 1
        while k < count and not touches[k] and gap[k] < closed and nodes[k] == nodes[k - 1] + 1:
            deepest = min(deepest, gap[k])
            k += 1
        for m in range(first, k):
            if gap[m] - closed <= _DEEP * (deepest - closed):
                touches[m] = True
                joining += 1
    return joining
