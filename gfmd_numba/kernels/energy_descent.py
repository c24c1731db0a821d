"""Compiled parts of a truncated Newton step on the energy of a displacement that a wall bounds.

All work on the unknowns of one row, each of which has a load of its own. Held ones are those that the wall keeps
from moving on; their `weight` is 0.
"""

from typing import NamedTuple

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.kernels.compilation import jit


class Unknowns(NamedTuple):
    """Displacements `u` of one row, the tractions `ku` that restore them, what they may not pass, and their loads."""

    u: Reals
    ku: Reals
    wall: Reals
    load: Reals


@jit
def descent_start(
    unknowns: Unknowns, curvature: Reals, compliance: float, weight: Reals, r: Reals, d: Reals, source: Reals
) -> None:
    """Unbalanced traction r of the nodes that may move, their weights, and the first product to precondition.

    Where the law stiffens a node, its weight makes its compliance that of law and body in parallel.
    """
    u, ku, wall, load = unknowns
    for j in range(u.size):
        force = load[j] - ku[j]
        d[j] = 0.0
        if u[j] >= wall[j] and force >= 0.0:
            weight[j] = 0.0
            r[j] = 0.0
        else:
            weight[j] = 1.0 / np.sqrt(1.0 + max(curvature[j], 0.0) * compliance)
            r[j] = force
        source[j] = weight[j] * r[j]


@jit
def descent_norm(r: Reals, weight: Reals, compliant: Reals) -> float:
    """Square of the unbalanced traction r in the norm of the preconditioner."""
    total = 0.0
    for j in range(r.size):
        total += r[j] * weight[j] * compliant[j]
    return total


@jit
def descent_direction(weight: Reals, compliant: Reals, keep: float, p: Reals, source: Reals) -> None:
    """Conjugate direction p, which keeps a share of the last one."""
    for j in range(p.size):
        p[j] = weight[j] * compliant[j] + keep * p[j]
        source[j] = p[j]


@jit
def descent_curvature(p: Reals, kp: Reals, curvature: Reals) -> tuple[float, float]:
    """Second derivative of the energy along p, and the share of the body, whose restoring traction is kp."""
    law, body = 0.0, 0.0
    for j in range(p.size):
        law += p[j] * p[j] * curvature[j]
        body += p[j] * kp[j]
    return law + body, body


@jit
def descent_update(
    p: Reals, kp: Reals, curvature: Reals, weight: Reals, step: float, d: Reals, r: Reals, source: Reals
) -> None:
    """Go a step along p, in the direction d of the Newton step and in what it leaves unbalanced."""
    for j in range(p.size):
        d[j] += step * p[j]
        if weight[j] > 0.0:
            r[j] -= step * (kp[j] + curvature[j] * p[j])
        source[j] = weight[j] * r[j]


@jit
def descent_trial(u: Reals, wall: Reals, d: Reals, step: float, source: Reals) -> None:
    """Displacement a step along d, stopped at the wall."""
    for j in range(u.size):
        source[j] = min(u[j] + step * d[j], wall[j])


@jit
def descent_work(
    u: Reals, trial: Reals, elastic: Reals, trial_elastic: Reals, restoring: Reals, load: Reals, closing: Reals
) -> tuple[float, float, float]:
    """Work done on body and load from u to a trial, its slope with the law's, and the size of what was summed."""
    work, slope, size = 0.0, 0.0, 0.0
    for j in range(u.size):
        closing[j] = trial[j] - u[j]
        each = closing[j] * (0.5 * (elastic[j] + trial_elastic[j]) - load[j])
        work += each
        slope += closing[j] * (restoring[j] - load[j])
        size += abs(each)
    return work, slope, size
