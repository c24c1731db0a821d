"""Compiled parts of a constrained conjugate gradient iteration (Polonsky & Keer, Wear 231:206, 1999).

Free are the nodes whose pressure is between its bounds, 0 and the `hardness`.
"""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.hardness import bounded_step


@jit
def cg_gap(p: Reals, sp: Reals, punch: Reals, gap: Reals, active: Indices, n: int, free_mean: bool) -> None:
    """Gap left by the pressure p whose displacement is sp (Polonsky & Keer 1999, eqs 5-6).

    `free_mean`: the load is prescribed, so the gap is known up to the approach, which the touching nodes fix.
    """
    for i in active:
        approach = 0.0
        if free_mean:
            touching = 0
            for j in range(n):
                if p[i, j] > 0.0:
                    approach += punch[i, j] + sp[i, j]
                    touching += 1
            approach /= touching
        for j in range(n):
            gap[i, j] = punch[i, j] + sp[i, j] - approach


@jit
def cg_direction(
    p: Reals,
    gap: Reals,
    t: Reals,
    norm: Reals,
    keep: Reals,
    rounding: Reals,
    active: Indices,
    n: int,
    free_mean: bool,
    hardness: float = np.inf,
) -> None:
    """Conjugate direction on the free nodes (Polonsky & Keer 1999, eq. 7).

    Nodes that left or joined the contact spoil the old direction in two ways. Under a prescribed load it may now
    change the load, which rescaling the pressure would undo: it loses its mean. And it may lead uphill: it is
    then dropped. Gaps within `rounding` of closed point nowhere: the direction is then zero.
    """
    for i in active:
        new_norm = 0.0
        downhill = 0.0
        mean = 0.0
        touching = 0
        for j in range(n):
            if 0.0 < p[i, j] < hardness:
                new_norm += gap[i, j] * gap[i, j]
                downhill += gap[i, j] * t[i, j]
                mean += t[i, j]
                touching += 1
        mean = mean / touching if free_mean and touching > 0 else 0.0
        beta = keep[i] * new_norm / norm[i] if norm[i] > 0.0 else 0.0
        if new_norm + beta * downhill <= 0.0:
            beta = 0.0
        closed = new_norm <= touching * rounding[i] ** 2
        for j in range(n):
            moves = 0.0 < p[i, j] < hardness and not closed
            t[i, j] = gap[i, j] + beta * (t[i, j] - mean) if moves else 0.0
        norm[i] = new_norm


@jit
def cg_update(
    p: Reals,
    st: Reals,
    gap: Reals,
    t: Reals,
    load: Reals,
    step: Reals,
    keep: Reals,
    active: Indices,
    n: int,
    free_mean: bool,
    hardness: float = np.inf,
) -> None:
    """Line search, clipping, overlap correction and load balance (Polonsky & Keer 1999, eqs 8-12).

    Penetrating nodes at the hardness keep it, those that have opened come down from it as overlapping ones rise from 0.
    """
    for i in active:
        touching = 0
        mean = 0.0
        total = 0.0
        gt = 0.0
        rt = 0.0
        for j in range(n):
            if 0.0 < p[i, j] < hardness:
                touching += 1
                mean += st[i, j]
                total += t[i, j]
                gt += gap[i, j] * t[i, j]
                rt += st[i, j] * t[i, j]
        if free_mean and touching > 0:  # a uniform displacement does no work on a constant load
            rt -= mean * total / touching
        if rt > 0.0:  # a single touching node has no direction of its own: it keeps the last step
            step[i] = gt / rt
        if hardness < np.inf:
            keep[i] = bounded_step(p[i], gap[i], t[i], step[i], load[i], hardness, n, free_mean)
            continue
        overlap = False
        total = 0.0
        for j in range(n):
            new = p[i, j]
            if new > 0.0:
                new = max(new - step[i] * t[i, j], 0.0)
            if new == 0.0 and gap[i, j] < 0.0:
                overlap = True
                new = -step[i] * gap[i, j]
            p[i, j] = new
            total += new
        keep[i] = 0.0 if overlap else 1.0
        if free_mean:
            scale = load[i] * n / total
            for j in range(n):
                p[i, j] *= scale


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
