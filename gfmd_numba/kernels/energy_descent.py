"""Compiled parts of a truncated Newton step on the energy of a displacement that a wall bounds.

All work on the unknowns of one row, each with a load of its own. Unknowns that the wall keeps from moving are held;
their `weight` is 0.
"""

from typing import NamedTuple

from gfmd_numba.arrays import Reals
from gfmd_numba.kernels.compilation import jit


class Unknowns(NamedTuple):
    """Displacements `u` of one row, their restoring tractions `ku`, the walls that stop them, and their loads."""

    u: Reals
    ku: Reals
    wall: Reals
    load: Reals


class Descent(NamedTuple):
    """Direction `d` of a Newton step so far, its restoring traction `kd` of the body, and the residual.

    The residual is the unbalanced traction `r` of the nodes that may move.
    """

    d: Reals
    kd: Reals
    r: Reals


@jit
def descent_start(unknowns: Unknowns, weight: Reals, descent: Descent) -> None:
    """Begin a direction at 0, and tell which nodes may move: those have the weight 1."""
    u, ku, wall, load = unknowns
    d, kd, r = descent
    for j in range(u.size):
        force = load[j] - ku[j]
        d[j] = kd[j] = 0.0
        held = u[j] >= wall[j] and force >= 0.0
        weight[j] = 0.0 if held else 1.0
        r[j] = 0.0 if held else force


@jit
def descent_norm(r: Reals, weight: Reals, compliant: Reals) -> float:
    """Square of the unbalanced traction r by its displacement, of which that of held nodes becomes 0."""
    total = 0.0
    for j in range(r.size):
        compliant[j] = compliant[j] if weight[j] > 0.0 else 0.0
        total += r[j] * compliant[j]
    return total


@jit
def descent_direction(compliant: Reals, keep: float, p: Reals, source: Reals) -> None:
    """Conjugate direction p, which keeps a share of the last one."""
    for j in range(p.size):
        p[j] = compliant[j] + keep * p[j]
        source[j] = p[j]


@jit
def descent_curvature(p: Reals, kp: Reals, curvature: Reals, pulled: Reals) -> tuple[float, float]:
    """Second derivative of the energy along p, and the part of the body, whose restoring traction is kp.

    Fills the traction with which the law restores p, of each displacement alone.
    """
    law, body = 0.0, 0.0
    for j in range(p.size):
        pulled[j] = curvature[j] * p[j]
        law += p[j] * pulled[j]
        body += p[j] * kp[j]
    return law + body, body


@jit
def descent_update(p: Reals, kp: Reals, pulled: Reals, weight: Reals, step: float, descent: Descent) -> float:
    """Go a step along p: update the direction of the Newton step and the residual; return the largest residual."""
    d, kd, r = descent
    largest = 0.0
    for j in range(p.size):
        d[j] += step * p[j]
        kd[j] += step * kp[j]
        if weight[j] > 0.0:
            r[j] -= step * (kp[j] + pulled[j])
            largest = max(largest, abs(r[j]))
    return largest


@jit
def descent_trial(u: Reals, wall: Reals, d: Reals, step: float, source: Reals) -> bool:
    """Displacement a step along d, stopped at the wall; whether any is."""
    stops = False
    for j in range(u.size):
        way = u[j] + step * d[j]
        stops |= way > wall[j]
        source[j] = min(way, wall[j])
    return stops


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
