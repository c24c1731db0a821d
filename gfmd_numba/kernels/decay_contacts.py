"""Compiled active-set steps of a profile whose compliance is a sum of decays: no transforms, no work on open nodes.

Candidates are the nodes that may come into contact, listed around the period behind the widest gap between them.
Arrays over them, and over those in contact, hold as many values as there are, in longer arrays.
"""

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.kernels.active_sets import newton_error, without_mean
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.decay_sums import POWERS, decay_product, far_powers
from gfmd_numba.kernels.exponential_sum import exponential_sum_factor, exponential_sum_solve

_WIDER = 1.0  # gaps up to this many times the largest misfit on the contact make a node a candidate
_LOOSE = 0.03  # relative error allowed in the first pressure on a new contact
_TIGHTEN = 0.1  # factor on that error after each step
_STEPS = 30  # contacts tried for one gap
_ITERATIONS = 60  # of conjugate gradients for each


@jit
def candidates(
    p: Reals, sp: Reals, wall: Reals, n: int, free_mean: bool, nodes: Indices, spare: Indices
) -> tuple[int, float]:
    """List the candidates under the pressure p whose displacement is sp; their number, and the approach.

    They are the nodes with pressure and those less open than these are, at most, from being closed.
    """
    count = 0
    total = 0.0
    highest = 0.0
    lowest = 0.0
    for j in range(n):
        if p[j] > 0.0:
            gap = wall[j] + sp[j]
            if count == 0:
                highest = gap
                lowest = gap
            highest = max(highest, gap)
            lowest = min(lowest, gap)
            total += gap
            count += 1
    approach = total / count if free_mean and count > 0 else 0.0
    widest = approach + _WIDER * max(highest - approach, approach - lowest)
    count = 0
    for j in range(n):
        if wall[j] + sp[j] <= widest or p[j] > 0.0:
            spare[count] = j
            count += 1
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
    powers: Reals,
    weights: Reals,
    white: float,
    mean: float,
    near: Reals,
    rates: Reals,
    coarse_weights: Reals,
    coarse_white: float,
    floor: float,
    indices: Indices,
    touches: Flags,
    values: Reals,
    decay: Reals,
    lower: Reals,
    carried: Reals,
) -> tuple[float, int, int]:
    """Find the contact and its pressure p that leave no overlap and no tension under a sum of decays.

    The sum only acts on what p changes by: the gap it starts from is that of the displacement sp. Conjugate gradients
    solve for the pressure on one contact after the other, preconditioned by a coarser sum, until none changes and the
    relative error is at most `target`, or `share` of the relative change that the first contact asked for if that is
    larger. Returns the largest change of the pressure over the largest pressure, how many nodes changed sides between
    the first and the last contact, and how many nodes are in contact; the change is infinite if the contact did not
    settle.
    """
    nodes, distances, rows, inside, contact, contact_rows = (
        indices[0], indices[1], indices[2], indices[3], indices[4], indices[5],
    )  # fmt: skip
    new, old, opened, gap, r, z, uniform, t, st, diagonal = (
        values[0], values[1], values[2], values[3], values[4], values[5], values[6], values[7], values[8], values[9],
    )  # fmt: skip
    count, approach = candidates(p, sp, wall, n, free_mean, nodes, inside)
    distances_around(nodes, count, n, distances)
    free = far_powers(powers, near, distances, count, POWERS, rows)
    touching = 0
    for k in range(count):
        old[k] = p[nodes[k]]
        new[k] = old[k]
        opened[k] = wall[nodes[k]] + sp[nodes[k]] - approach
        gap[k] = opened[k]
        touches[k] = old[k] > 0.0
    tolerance = _LOOSE
    final = target
    settled = False
    first = True
    for _ in range(_STEPS):
        touching = 0
        for k in range(count):
            if touches[k]:
                inside[touching] = k
                contact[touching] = nodes[k]
                touching += 1
        if touching > 0:
            distances_around(contact, touching, n, distances)
            far_powers(powers, near, distances, touching, free, contact_rows)
            exponential_sum_factor(
                contact, touching, n, rates, coarse_weights, coarse_white, floor, decay, lower, diagonal, carried
            )
            for k in range(touching):
                r[k] = -gap[inside[k]]
            if free_mean:
                without_mean(r, touching)
                for k in range(touching):
                    z[k] = 1.0
                exponential_sum_solve(z, touching, coarse_weights, decay, lower, diagonal, uniform, carried[0])
        changed = 0
        while True:
            if touching > 0:
                last = 0.0
                for iteration in range(_ITERATIONS):
                    exponential_sum_solve(r, touching, coarse_weights, decay, lower, diagonal, z, carried[0])
                    energy, error = newton_error(r, z, uniform, new, inside, touching, rounding, free_mean)
                    if first:
                        final = max(target, share * error)
                        tolerance = max(tolerance, final)
                        first = False
                    if not error > tolerance:
                        break
                    beta = energy / last if iteration > 0 else 0.0
                    for k in range(touching):
                        t[k] = z[k] + beta * t[k] if iteration > 0 else z[k]
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
            for k in range(count):
                z[k] = new[k] - old[k]
            decay_product(rows, count, near, weights, white, mean, z, gap)
            for k in range(count):
                gap[k] += opened[k]
            if free_mean:
                approach = 0.0
                for k in range(touching):
                    approach += gap[inside[k]]
                approach /= touching
                for k in range(count):
                    gap[k] -= approach
            changed = 0
            total = 0.0
            for k in range(count):
                if touches[k]:
                    if new[k] > 0.0:
                        total += new[k]
                    else:
                        new[k] = 0.0
                        touches[k] = False
                        changed += 1
                elif gap[k] < -rounding:
                    touches[k] = True
                    changed += 1
            if changed > 0 or tolerance <= final:
                break
            tolerance = final
        if changed == 0:
            settled = True
            break
        tolerance = max(_TIGHTEN * tolerance, final)
        if free_mean:
            scale = load * n / total
            for k in range(count):
                new[k] *= scale
        for k in range(count):
            z[k] = new[k] - old[k]
        decay_product(rows, count, near, weights, white, mean, z, gap)
        for k in range(count):
            gap[k] += opened[k]
    change = 0.0
    largest = 0.0
    moved = 0
    for k in range(count):
        change = max(change, abs(new[k] - old[k]))
        largest = max(largest, new[k])
        if (old[k] > 0.0) != (new[k] > 0.0):
            moved += 1
        p[nodes[k]] = new[k]
    if not settled:
        return float("inf"), moved, touching
    return (change / largest if largest > 0.0 else 0.0), moved, touching


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
def refined_pressure(coarse: Reals, m: int, load: float, free_mean: bool, n: int, p: Reals) -> None:
    """Interpolate a pressure of m nodes to n, keep it on nodes nearer to a contact node, and scale it to the load."""
    for j in range(n):
        p[j] = 0.0
    total = 0.0
    for i in range(m):
        here = coarse[i]
        there = coarse[i + 1] if i + 1 < m else coarse[0]
        if not (here > 0.0 or there > 0.0):
            continue
        for j in range(-(-i * n // m), -(-(i + 1) * n // m)):
            x = (j * m - i * n) / n
            if (x <= 0.5 and here > 0.0) or (x >= 0.5 and there > 0.0):
                p[j] = (1.0 - x) * here + x * there
                total += p[j]
    if free_mean:
        for j in range(n):
            p[j] *= load * n / total
