"""Compiled active-set steps of a profile whose compliance is a sum of decays: no transforms, no work on open nodes.

The first values of an array over candidates belong to the candidates, those of an array over the contact to its nodes;
what follows them has no meaning.
"""

import numpy as np

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.kernels.active_sets import newton_error, without_mean
from gfmd_numba.kernels.candidates import candidates, distances_around, join_deepest
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.decay_sums import POWERS, decay_product, far_powers
from gfmd_numba.kernels.exponential_sum import exponential_sum_factor, exponential_sum_solve, exponential_sum_solve_two

_LOOSE = 0.03  # relative error allowed in the first pressure on a new contact
_TIGHTEN = 0.1  # factor on that error after each step
_MANY = 0.01  # share of a contact under tension from which on one iteration is enough
_STEPS = 30  # contacts tried for one gap
_ROUNDS = 3  # in which nodes may join at the last tolerance, before the gap is found anew
_ITERATIONS = 60  # of conjugate gradients for each


@jit
def decay_contact(
    p: Reals,
    sp: Reals,
    wall: Reals,
    n: int,
    load: float,
    rounding: float,
    free_mean: bool,
    target: float,
    share: float,
    wider: float,
    powers: Reals,
    weights: Reals,
    white: float,
    mean: float,
    near: Reals,
    rates: Reals,
    coarse_near: Reals,
    coarse_weights: Reals,
    coarse_white: float,
    floor: float,
    indices: Indices,
    touches: Flags,
    values: Reals,
    decay: Reals,
    lower: Reals,
    carried: Reals,
) -> tuple[float, int]:
    """Find the contact and its pressure p that leave no overlap and no tension under a sum of decays.

    The sum only acts on what p changes by: the gap it starts from is that of the displacement sp. Conjugate gradients,
    preconditioned by a coarser sum, solve for the pressure on one contact after the other. First nodes under tension
    leave until there are none, then overlapping ones join; none join if `wider` is 0. The contact has settled once no
    node joins, or after a few rounds at the last tolerance. The relative error is then at most `target`, or `share` of
    the relative change that the first contact asked for if that is larger. Returns the largest change of the pressure
    over the largest pressure, infinite if the contact did not settle, and the number of nodes in contact.
    """
    nodes, distances, rows, inside, contact, contact_rows = (
        indices[0], indices[1], indices[2], indices[3], indices[4], indices[5],
    )  # fmt: skip
    new, old, opened, gap, r, z, uniform, t, st, diagonal = (
        values[0], values[1], values[2], values[3], values[4], values[5], values[6], values[7], values[8], values[9],
    )  # fmt: skip
    count, approach = candidates(p, sp, wall, n, free_mean, wider, nodes, inside)
    if count == 0:
        return 0.0, 0
    distances_around(nodes, count, n, distances)
    free = far_powers(powers, near, distances, count, POWERS, rows)
    touching = 0
    for k in range(count):
        old[k] = p[nodes[k]]
        new[k] = old[k]
        opened[k] = wall[nodes[k]] + sp[nodes[k]] - approach
        gap[k] = opened[k]
        touches[k] = old[k] > 0.0
    if wider > 0.0:
        misfit = 0.0
        for k in range(count):
            if touches[k]:
                misfit += abs(gap[k])
                touching += 1
        join_deepest(gap, touches, nodes, count, -max(misfit / max(touching, 1), rounding))
    tolerance = _LOOSE
    final = -1.0
    settled = False
    nothing = np.empty(0)
    rounds = 0
    for _ in range(_STEPS):
        touching = 0
        for k in range(count):
            if touches[k]:
                inside[touching] = k
                contact[touching] = nodes[k]
                r[touching] = -gap[k]
                touching += 1
        if touching > 0:
            distances_around(contact, touching, n, distances)
            far_powers(powers, near, distances, touching, free, contact_rows)
            exponential_sum_factor(
                contact,
                touching,
                n,
                rates,
                coarse_near,
                coarse_weights,
                coarse_white,
                floor,
                decay,
                lower,
                diagonal,
                carried,
                nothing,
            )
            if free_mean:
                without_mean(r, touching)
                for k in range(touching):
                    t[k] = 1.0
                exponential_sum_solve_two(
                    r, t, touching, coarse_weights, decay, lower, diagonal, z, uniform, carried[0], carried[1]
                )
            else:
                exponential_sum_solve(r, touching, coarse_weights, decay, lower, diagonal, z, carried[0])
            solved = True
        elif final < 0.0:
            final = target
        while True:
            last = 0.0
            hasty = False
            for _ in range(_ITERATIONS if touching > 0 else 0):
                if not solved:
                    exponential_sum_solve(r, touching, coarse_weights, decay, lower, diagonal, z, carried[0])
                solved = False
                energy, error = newton_error(r, z, uniform, new, inside, touching, rounding, free_mean)
                if final < 0.0:
                    final = max(target, share * error) if error < np.inf else target
                    tolerance = max(tolerance, final)
                if not error > tolerance:
                    break
                if last == 0.0 and tolerance > final:
                    leaving = 0
                    for k in range(touching):
                        if not new[inside[k]] + z[k] > 0.0:
                            leaving += 1
                    hasty = leaving > _MANY * touching
                    if hasty:
                        for k in range(touching):
                            new[inside[k]] += z[k]
                        break
                beta = energy / last if last > 0.0 else 0.0
                for k in range(touching):
                    t[k] = z[k] + beta * t[k] if last > 0.0 else z[k]
                last = energy
                decay_product(contact_rows, touching, near, weights, white, mean, t, st)
                curvature = 0.0
                for k in range(touching):
                    curvature += t[k] * st[k]
                if not curvature > 0.0:
                    break
                length = energy / curvature
                for k in range(touching):
                    new[inside[k]] += length * t[k]
                    r[k] -= length * st[k]
                if free_mean:
                    without_mean(r, touching)
            leaving = 0
            total = 0.0
            misfit = rounding
            for k in range(touching):
                total += max(new[inside[k]], 0.0)
                misfit = max(misfit, abs(r[k]))
                if not new[inside[k]] > 0.0:
                    leaving += 1
            joining = 0
            if leaving > 0:
                scale = load * n / total if free_mean else 1.0
                for k in range(touching):
                    i = inside[k]
                    t[k] = (z[k] if hasty else 0.0) - new[i]
                    touches[i] = new[i] > 0.0
                    new[i] = scale * new[i] if new[i] > 0.0 else 0.0
                    t[k] += new[i]
                decay_product(contact_rows, touching, near, weights, white, mean, t, st)
                for k in range(touching):
                    gap[inside[k]] = st[k] - r[k]
                break
            if not wider > 0.0:
                settled = True
                tolerance = final
                break
            for k in range(count):
                z[k] = new[k] - old[k]
            decay_product(rows, count, near, weights, white, mean, z, gap)
            approach = 0.0
            for k in range(count):
                gap[k] += opened[k]
            if free_mean:
                for k in range(touching):
                    approach += gap[inside[k]]
                approach /= touching
            joining = join_deepest(gap, touches, nodes, count, approach - misfit)
            if tolerance <= final:
                rounds += 1
            settled = joining == 0 or rounds > _ROUNDS
            if joining > 0 or tolerance <= final:
                break
            tolerance = final
        if settled and tolerance <= final:
            break
        if joining > 0:
            tolerance = max(_TIGHTEN * tolerance, final)
    change = 0.0
    largest = 0.0
    for k in range(count):
        change = max(change, abs(new[k] - old[k]))
        largest = max(largest, new[k])
        p[nodes[k]] = new[k]
    if not settled:
        return np.inf, touching
    return (change / largest if largest > 0.0 else 0.0), touching


@jit
def touching_displacement(p: Reals, sp: Reals, wall: Reals, n: int, free_mean: bool, u: Reals) -> None:
    """Displacement nearest to sp, up to the approach, that touches where there is pressure and overlaps nowhere."""
    approach = 0.0
    if free_mean:
        count = 0
        for j in range(n):
            if p[j] > 0.0:
                approach += wall[j] + sp[j]
                count += 1
        approach /= count
    for j in range(n):
        u[j] = wall[j]
        gap = wall[j] + sp[j] - approach
        if gap > 0.0 and not p[j] > 0.0:
            u[j] -= gap


@jit
def refined_pressure(coarse: Reals, m: int, load: float, free_mean: bool, n: int, fine: Reals, p: Reals) -> None:
    """Interpolate a pressure of m nodes to n, less the pressure `fine`, on nodes nearer to a contact node; balance it.

    Where nothing is left the fine pressure does not count.
    """
    total = 0.0
    for share in (1.0, 0.0):
        for j in range(n):
            p[j] = 0.0
        for i in range(m):
            here = coarse[i]
            there = coarse[i + 1] if i + 1 < m else coarse[0]
            if not (here > 0.0 or there > 0.0):
                continue
            for j in range(-(-i * n // m), -(-(i + 1) * n // m)):
                x = (j * m - i * n) / n
                if (x <= 0.5 and here > 0.0) or (x >= 0.5 and there > 0.0):
                    p[j] = max((1.0 - x) * here + x * there - share * fine[j], 0.0)
                    total += p[j]
        if total > 0.0:
            break
    if free_mean:
        for j in range(n):
            p[j] *= load * n / total
