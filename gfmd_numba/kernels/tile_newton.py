"""Compiled parts of an active-set Newton step on the tiles of a map that the contact may reach.

Arrays are flat, `[node]`, over the nodes of these tiles. Pressures, residuals and directions are zero off the contact.
"""

from gfmd_numba.arrays import Flags, Reals
from gfmd_numba.kernels.active_sets import Iterate
from gfmd_numba.kernels.compilation import jit


@jit
def closing_residual(gap: Reals, contact: Flags, r: Reals, count: int, free_mean: bool) -> None:
    """Displacement r that closes the gap on the `count` nodes in contact.

    `free_mean`: the load is prescribed, so the gap is known up to a constant; r has no mean then.
    """
    for j in range(gap.size):
        r[j] = -gap[j] if contact[j] else 0.0
    if free_mean:
        centre(r, contact, count)


@jit
def centre(r: Reals, contact: Flags, count: int) -> None:
    """Take the mean off the values on the nodes in contact."""
    mean = 0.0
    for j in range(r.size):
        mean += r[j]
    mean /= count
    for j in range(r.size):
        r[j] -= mean if contact[j] else 0.0


@jit
def tile_error(
    r: Reals, z: Reals, p: Reals, contact: Flags, count: int, rounding: float, free_mean: bool
) -> tuple[float, float]:
    """Energy r z of a change z of the pressure, and its size: the largest over the largest, or sum over sum.

    Under a prescribed load z first loses its mean, which would change the load. The error is zero where r is within
    `rounding` of zero.
    """
    if free_mean:
        centre(z, contact, count)
    energy = 0.0
    largest = 0.0
    peak = 0.0
    moved = 0.0
    carried = 0.0
    open_by = 0.0
    for j in range(z.size):
        energy += r[j] * z[j]
        largest = max(largest, abs(z[j]))
        peak = max(peak, abs(p[j]))
        moved += abs(z[j])
        carried += abs(p[j])
        open_by = max(open_by, abs(r[j]))
    return energy, (max(largest / peak, moved / carried) if open_by > rounding and energy > 0.0 else 0.0)


@jit
def tile_direction(z: Reals, st: Reals, t: Reals, step: float, last: float) -> None:
    """Make t the direction z, conjugate to the last t whose displacement is st; zero energy `last` if there was none.

    Polak and Ribiere's formula, as the preconditioner is not exactly the same from one iteration to the next.
    """
    beta = 0.0
    if last > 0.0:
        for j in range(z.size):
            beta -= z[j] * st[j]
        beta *= step / last
    for j in range(z.size):
        t[j] = z[j] + beta * t[j]


@jit
def tile_update(iterate: Iterate, energy: float, contact: Flags, count: int, r: Reals, free_mean: bool) -> float:
    """Line search along the direction; the step."""
    p, gap, t, st = iterate
    curvature = 0.0
    for j in range(t.size):
        curvature += t[j] * st[j]
    step = energy / curvature
    for j in range(t.size):
        p[j] += step * t[j]
        gap[j] += step * st[j]
        r[j] -= step * st[j] if contact[j] else 0.0
    if free_mean:
        centre(r, contact, count)
    return step


@jit
def revise_tiles(
    p: Reals, gap: Reals, contact: Flags, count: int, load: float, rounding: float, free_mean: bool
) -> tuple[int, int]:
    """Nodes under tension leave the contact and lose it, nodes that overlap join: how many did, and are in contact now.

    Under a prescribed load (the sum of all pressures) the nodes in contact fix the approach, which is taken off the
    gap, and the others carry what was lost.
    """
    approach = 0.0
    if free_mean:
        for j in range(p.size):
            approach += gap[j] if contact[j] else 0.0
        approach /= count
    changed = 0
    total = 0.0
    after = 0
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
        after += contact[j]
    if free_mean and changed > 0:
        scale = load / total
        for j in range(p.size):
            p[j] *= scale
    return changed, after
