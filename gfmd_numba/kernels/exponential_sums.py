"""Compiled loops over profiles whose compliance is a sum of exponential decays: no transforms, no work on open nodes.

C_ij = sum_s weight_s exp(-rate_s |x_i - x_j|) + white delta_ij is semiseparable. Its factors L D L' = C take one sweep
over the ordered nodes (Foreman-Mackey et al., Astron. J. 154:220, 2017), each node some operations for each pair of
decays. A product with it takes sweeps that carry what each decay has gathered so far, eight decays at a time and always
in the same order.

Candidates are the nodes of a profile that may come into contact. They are listed around the period, behind the widest
gap between them. The first values of an array over candidates belong to the candidates, those of an array over the
contact to its nodes; what follows them has no meaning.
"""

from typing import NamedTuple

import numpy as np

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.pressure_solvers import begin_behind_widest_gap, change_few, sum_of, take_off


@jit
def least_squares(matrix: Reals, right: Reals, solution: Reals) -> None:
    """Solve `matrix` `[row, column]` times the solution = `right` by Householder's reflections, in place.

    Libraries take the order of sums from where arrays lie in memory.
    """
    rows, columns = matrix.shape
    for k in range(columns):
        norm = 0.0
        for i in range(k, rows):
            norm += matrix[i, k] ** 2
        norm = np.sqrt(norm)
        if matrix[k, k] > 0.0:
            norm = -norm
        matrix[k, k] -= norm  # the column becomes the reflector
        square = -norm * matrix[k, k]
        for c in range(k + 1, columns):
            along = 0.0
            for i in range(k, rows):
                along += matrix[i, k] * matrix[i, c]
            along /= square
            for i in range(k, rows):
                matrix[i, c] -= along * matrix[i, k]
        along = 0.0
        for i in range(k, rows):
            along += matrix[i, k] * right[i]
        along /= square
        for i in range(k, rows):
            right[i] -= along * matrix[i, k]
        matrix[k, k] = norm
    for k in range(columns - 1, -1, -1):
        value = right[k]
        for c in range(k + 1, columns):
            value -= matrix[k, c] * solution[c]
        solution[k] = value / matrix[k, k]


class Decays(NamedTuple):
    """The sum: `rates`, decays over short distances `near` `[distance, rate]`, `weights` and the `white` part.

    Pivots below `floor` are lifted to it: the factors then are those of some positive definite matrix, whatever the
    weights.
    """

    rates: Reals
    near: Reals
    weights: Reals
    white: float
    floor: float


class Factors(NamedTuple):
    """Its factors: `decay` and `lower` `[node, rate]`, pivots `diagonal` `[node]`; scratch `carried` `[rate, rate]`."""

    decay: Reals
    lower: Reals
    diagonal: Reals
    carried: Reals


@jit
def exponential_sum_factor(decays: Decays, factors: Factors, nodes: Indices, count: int, n: int, own: Reals) -> None:
    """Factor the sum on the first `count` of the nodes, which follow each other around a period of n.

    `own` `[node]` is what each node adds to the diagonal; it may be empty.
    """
    rates, near, weights, white, floor = decays
    decay, lower, diagonal, carried = factors
    terms = rates.size
    carried[:] = 0.0
    for i in range(count):
        last = 0.0
        if i > 0:
            last = diagonal[i - 1]
            distance = (nodes[i] - nodes[i - 1]) % n
            if distance < near.shape[0]:
                for s in range(terms):
                    decay[i, s] = near[distance, s]
            else:
                for s in range(terms):
                    decay[i, s] = np.exp(-rates[s] * distance)
        for s in range(terms):
            lower[i, s] = 1.0
        pivot = white + (own[i] if own.size > 0 else 0.0)
        for s in range(terms if i > 0 else 0):  # the lower triangle tells the upper one
            added = last * lower[i - 1, s]
            known = 0.0
            for r in range(s):
                carried[s, r] = decay[i, s] * decay[i, r] * (carried[s, r] + added * lower[i - 1, r])
                known += carried[s, r] * weights[r]
                lower[i, r] -= carried[s, r] * weights[s]
            carried[s, s] = decay[i, s] * decay[i, s] * (carried[s, s] + added * lower[i - 1, s])
            lower[i, s] -= known + carried[s, s] * weights[s]
        for s in range(terms):
            pivot += weights[s] * lower[i, s]
        diagonal[i] = max(pivot, floor)
        share = 1.0 / diagonal[i]
        for s in range(terms):
            lower[i, s] *= share


@jit
def exponential_sum_solve(y: Reals, count: int, weights: Reals, factors: Factors, z: Reals) -> None:
    """Solve L D L' z = y with the factors of `exponential_sum_factor`."""
    decay, lower, diagonal, carried = factors.decay, factors.lower, factors.diagonal, factors.carried[0]
    terms = weights.size
    carried[:] = 0.0
    for i in range(count):
        value = y[i]
        if i > 0:
            for s in range(terms):
                carried[s] = decay[i, s] * (carried[s] + lower[i - 1, s] * z[i - 1])
                value -= weights[s] * carried[s]
        z[i] = value
    for i in range(count):
        z[i] /= diagonal[i]
    carried[:] = 0.0
    for i in range(count - 2, -1, -1):
        value = z[i]
        for s in range(terms):
            carried[s] = decay[i + 1, s] * (carried[s] + weights[s] * z[i + 1])
            value -= lower[i, s] * carried[s]
        z[i] = value


DECAYS_AT_ONCE = 8
POWERS = 64  # distances are written in this base, with a table of powers for each digit
_FELT = 1e-6  # what a decay keeps across the cut of the period, below which its images do not count

Eight = tuple[float, float, float, float, float, float, float, float]


@jit
def far_powers(powers: Reals, near: Reals, distances: Indices, count: int, first: int, rows: Indices) -> int:
    """Find the row of `near` with the decays to the power of each distance, and return where the next rows are free.

    `powers` is `[tables POWERS, decay]`, one table for each digit of a distance. `near` begins with the first of them;
    distances beyond it get rows from `first` on.
    """
    for i in range(count):
        rest = distances[i]
        if rest < POWERS:
            rows[i] = rest
            continue
        for s in range(near.shape[1]):
            near[first, s] = 1.0
        table = 0
        while rest > 0:
            digit = table + rest % POWERS
            for s in range(near.shape[1]):
                near[first, s] *= powers[digit, s]
            rest //= POWERS
            table += POWERS
        rows[i] = first
        first += 1
    return first


@jit
def eight(values: Reals, row: int, s: int) -> Eight:
    """Eight values of a row from s on."""
    return (
        values[row, s], values[row, s + 1], values[row, s + 2], values[row, s + 3],
        values[row, s + 4], values[row, s + 5], values[row, s + 6], values[row, s + 7],
    )  # fmt: skip


@jit
def faded(state: Eight, source: float, factors: Eight) -> Eight:
    """States at the next node after one that adds the same to each."""
    a, b, c, d, e, f, g, h = state
    p, q, r, s, t, u, v, w = factors
    return (
        (a + source) * p, (b + source) * q, (c + source) * r, (d + source) * s,
        (e + source) * t, (f + source) * u, (g + source) * v, (h + source) * w,
    )  # fmt: skip


@jit
def raised(state: Eight, source: float, factors: Eight) -> Eight:
    """States with a source added that has faded by these factors."""
    a, b, c, d, e, f, g, h = state
    p, q, r, s, t, u, v, w = factors
    return (
        a + source * p, b + source * q, c + source * r, d + source * s,
        e + source * t, f + source * u, g + source * v, h + source * w,
    )  # fmt: skip


@jit
def summed(state: Eight, weights: Eight) -> float:
    """Weighted sum of states."""
    a, b, c, d, e, f, g, h = state
    p, q, r, s, t, u, v, w = weights
    return ((a * p + e * t) + (c * r + g * v)) + ((b * q + f * u) + (d * s + h * w))


class DecaySum(NamedTuple):
    """An accurate sum of decays: `near` `[row, decay]` has rows for the `powers` of long distances.

    Decays are in the order of their rates, a multiple of eight. `weights` is `[2, decay]`, the second row
    1 / (1 - base^n). `white` is what a node adds to itself, `mean` what is added for each pair of nodes.
    """

    powers: Reals
    near: Reals
    weights: Reals
    white: float
    mean: float


@jit
def decay_product(rows: Indices, count: int, fine: DecaySum, source: Reals, product: Reals) -> None:
    """Product of the sum with a source on the first `count` nodes.

    `rows` are those of `near` that lead to each node from the one before, the first from the last across the cut.
    """
    _, powers, weights, white, mean = fine
    total = 0.0
    for i in range(count):
        total += source[i]
    for i in range(count):
        product[i] = white * source[i] + mean * total
    none = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for s in range(0, weights.shape[1], DECAYS_AT_ONCE):
        w = eight(weights, 0, s)
        forward = none
        backward = none
        if abs(powers[rows[0], s]) > _FELT:
            across = faded(none, 1.0, eight(powers, rows[0], s))
            reach = (1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
            backward = raised(backward, source[0], reach)
            for i in range(1, count):
                factors = eight(powers, rows[i], s)
                forward = faded(forward, source[i - 1], factors)
                reach = faded(reach, 0.0, factors)
                backward = raised(backward, source[i], reach)
            images = faded(eight(weights, 1, s), 0.0, across)
            forward = faded(forward, source[count - 1], images)
            backward = faded(backward, 0.0, images)
        product[0] += summed(forward, w)
        for i in range(1, count):
            forward = faded(forward, source[i - 1], eight(powers, rows[i], s))
            product[i] += summed(forward, w)
        product[count - 1] += summed(backward, w)
        for i in range(count - 1, 0, -1):
            backward = faded(backward, source[i], eight(powers, rows[i], s))
            product[i - 1] += summed(backward, w)


_DEEP = 0.6  # share of the deepest overlap of a stretch from which on its nodes join the contact


@jit
def candidates(
    p: Reals, sp: Reals, wall: Reals, n: int, free_mean: bool, wider: float, nodes: Indices, spare: Indices
) -> tuple[int, float]:
    """List the candidates under the pressure p whose displacement is sp; their number, and the approach.

    Candidates are the nodes with pressure, and the nodes whose gap is below the largest gap on these.
    """
    count = 0
    first, beyond = 0.0, 0.0  # gaps almost alike are added up as differences: a sum of a million would lose digits
    for j in range(n):
        if p[j] > 0.0:
            if count == 0:
                first = wall[j] + sp[j]
            spare[count] = j
            beyond += wall[j] + sp[j] - first
            count += 1
    approach = first + beyond / count if free_mean and count > 0 else 0.0
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


_LOOSE = 0.03  # relative error allowed in the first pressure on a new contact
_TIGHTEN = 0.1  # factor on that error after each step
_MANY = 0.01  # share of a contact under tension from which on one iteration is enough
_STEPS = 30  # contacts tried for one gap
_ROUNDS = 3  # in which nodes may join at the last tolerance, before the gap is found anew
_ITERATIONS = 60  # of conjugate gradients for each


class Task(NamedTuple):
    """Problem of a contact on `n` nodes: its mean pressure `load` if prescribed (`free_mean`), and the tolerances.

    The relative error is at most `target`, or `share` of the relative change that the first contact asks for if that is
    larger. Gaps within `rounding` are closed. Nodes `wider` open than others may join, none if that is 0.
    """

    n: int
    load: float
    rounding: float
    free_mean: bool
    target: float
    share: float
    wider: float


class Lists(NamedTuple):
    """Nodes, distances and rows of `near`, of the candidates and of the contact; `inside`: which candidates touch."""

    touches: Flags
    nodes: Indices
    distances: Indices
    rows: Indices
    inside: Indices
    contact: Indices
    contact_rows: Indices


class Values(NamedTuple):
    """Pressures `new` and `old` of the candidates, the gap `opened` by the old one and `gap`; values over the contact.

    Over the contact, `r` is the displacement that closes the gap, `z` the change of pressure, `uniform` the pressure of
    a uniform displacement, `t` the direction and `st` its displacement.
    """

    new: Reals
    old: Reals
    opened: Reals
    gap: Reals
    r: Reals
    z: Reals
    uniform: Reals
    t: Reals
    st: Reals


class DecayLevel(NamedTuple):
    """A grid: its accurate sum, the coarser one that preconditions it with room for its factors, and scratch."""

    fine: DecaySum
    coarse: Decays
    factors: Factors
    lists: Lists
    values: Values


@jit
def decay_contact(p: Reals, sp: Reals, wall: Reals, asked: Task, grid: DecayLevel) -> float:
    """Find the contact and its pressure p that leave no overlap and no tension under a sum of decays.

    The sum only acts on what p changes by: the gap it starts from is that of the displacement sp. Conjugate gradients,
    preconditioned by a coarser sum, solve for the pressure on one contact after the other. First nodes under tension
    leave until there are none, then overlapping ones join. The contact has settled once no node joins, or after a few
    rounds at the last tolerance. Returns the largest change of the pressure over the largest pressure, infinite if the
    contact did not settle.

    The records may be plain tuples, which a compiled function takes in a third of the time.
    """
    fine, coarse, factors, lists, values = grid
    level = DecayLevel(DecaySum(*fine), Decays(*coarse), Factors(*factors), Lists(*lists), Values(*values))
    task = Task(*asked)
    count, free = _gather(p, sp, wall, task, level)
    if count == 0:
        return 0.0
    tolerance, final, rounds, touching, settled = _LOOSE, -1.0, 0, 0, False
    for _ in range(_STEPS):
        touching = _list_contact(level.lists, level.values, count)
        joining = 0
        fresh = touching > 0
        if fresh:
            _factor(touching, free, task, level)
        elif final < 0.0:
            final = task.target
        while True:
            hasty = False
            if touching > 0:
                tolerance, final, hasty = _close_gap(touching, fresh, tolerance, final, task, level)
            fresh = False
            leaving, misfit = _tension(touching, task.rounding, level.lists, level.values)
            if leaving > 0:
                _let_go(touching, hasty, task, level)
                break
            if not task.wider > 0.0:
                settled, tolerance = True, final
                break
            joining = _join(count, touching, misfit, task, level)
            rounds += tolerance <= final
            settled = joining == 0 or rounds > _ROUNDS
            if joining > 0 or tolerance <= final:
                break
            tolerance = final
        if settled and tolerance <= final:
            break
        if joining > 0:
            tolerance = max(_TIGHTEN * tolerance, final)
    change = _put(p, count, level.lists.nodes, level.values)
    return change if settled else np.inf


@jit
def _gather(p: Reals, sp: Reals, wall: Reals, task: Task, level: DecayLevel) -> tuple[int, int]:
    """List the candidates and which of them touch; their number, and the first row of decays that is free."""
    touches, nodes, distances, rows, inside, _, _ = level.lists
    new, old, opened, gap = level.values.new, level.values.old, level.values.opened, level.values.gap
    count, approach = candidates(p, sp, wall, task.n, task.free_mean, task.wider, nodes, inside)
    if count == 0:
        return 0, 0
    distances_around(nodes, count, task.n, distances)
    free = far_powers(level.fine.powers, level.fine.near, distances, count, POWERS, rows)
    touching = 0
    misfit = 0.0
    for k in range(count):
        old[k] = p[nodes[k]]
        new[k] = old[k]
        opened[k] = wall[nodes[k]] + sp[nodes[k]] - approach
        gap[k] = opened[k]
        touches[k] = old[k] > 0.0
        if touches[k]:
            misfit += abs(gap[k])
            touching += 1
    if task.wider > 0.0:
        join_deepest(gap, touches, nodes, count, -max(misfit / max(touching, 1), task.rounding))
    return count, free


@jit
def _list_contact(lists: Lists, values: Values, count: int) -> int:
    """List the candidates that touch, and what closes their gaps; their number."""
    touching = 0
    for k in range(count):
        if lists.touches[k]:
            lists.inside[touching] = k
            lists.contact[touching] = lists.nodes[k]
            values.r[touching] = -values.gap[k]
            touching += 1
    return touching


@jit
def _factor(touching: int, free: int, task: Task, level: DecayLevel) -> None:
    """Factor the coarse sum on the contact, and solve for the first change of pressure."""
    _, _, distances, _, _, contact, contact_rows = level.lists
    r, z, uniform, t = level.values.r, level.values.z, level.values.uniform, level.values.t
    coarse, factors = level.coarse, level.factors
    distances_around(contact, touching, task.n, distances)
    far_powers(level.fine.powers, level.fine.near, distances, touching, free, contact_rows)
    exponential_sum_factor(coarse, factors, contact, touching, task.n, r[:0])
    if task.free_mean:
        take_off(r[:touching], sum_of(r[:touching]) / touching)
        t[:touching] = 1.0
        exponential_sum_solve(t, touching, coarse.weights, factors, uniform)
    exponential_sum_solve(r, touching, coarse.weights, factors, z)


@jit
def _close_gap(
    touching: int, fresh: bool, tolerance: float, final: float, task: Task, level: DecayLevel
) -> tuple[float, float, bool]:
    """Conjugate gradients for the pressure on the contact; the tolerances, and whether many nodes ended it early.

    `fresh`: the first change is already there.
    """
    new, _, _, _, r, z, uniform, t, st = level.values
    inside = level.lists.inside
    last = 0.0
    for _ in range(_ITERATIONS):
        if not fresh:
            exponential_sum_solve(r, touching, level.coarse.weights, level.factors, z)
        fresh = False
        lists = r[:touching], z[:touching], uniform[:touching], new, inside[:touching]
        energy, error = change_few(*lists, task.rounding, task.free_mean)
        if final < 0.0:
            final = max(task.target, task.share * error) if error < np.inf else task.target
            tolerance = max(tolerance, final)
        if not error > tolerance:
            break
        if last == 0.0 and tolerance > final and _steps_beyond(touching, inside, new, z):
            return tolerance, final, True
        beta = energy / last if last > 0.0 else 0.0
        for k in range(touching):
            t[k] = z[k] + beta * t[k] if last > 0.0 else z[k]
        last = energy
        decay_product(level.lists.contact_rows, touching, level.fine, t, st)
        curvature = 0.0
        for k in range(touching):
            curvature += t[k] * st[k]
        if not curvature > 0.0:
            break
        length = energy / curvature
        for k in range(touching):
            new[inside[k]] += length * t[k]
            r[k] -= length * st[k]
        if task.free_mean:
            take_off(r[:touching], sum_of(r[:touching]) / touching)
    return tolerance, final, False


@jit
def _steps_beyond(touching: int, inside: Indices, new: Reals, z: Reals) -> bool:
    """Take the whole change of pressure if it leaves many nodes under tension; whether it does."""
    leaving = 0
    for k in range(touching):
        if not new[inside[k]] + z[k] > 0.0:
            leaving += 1
    if leaving > _MANY * touching:
        for k in range(touching):
            new[inside[k]] += z[k]
        return True
    return False


@jit
def _tension(touching: int, rounding: float, lists: Lists, values: Values) -> tuple[int, float]:
    """Number of nodes under tension in the contact, and the largest gap there."""
    leaving = 0
    misfit = rounding
    for k in range(touching):
        misfit = max(misfit, abs(values.r[k]))
        if not values.new[lists.inside[k]] > 0.0:
            leaving += 1
    return leaving, misfit


@jit
def _let_go(touching: int, hasty: bool, task: Task, level: DecayLevel) -> None:
    """Open the nodes under tension, scale the pressure of the others to the load, and find their gaps."""
    new, _, _, gap, r, z, _, t, st = level.values
    inside, touches = level.lists.inside, level.lists.touches
    total = 0.0
    for k in range(touching):
        total += max(new[inside[k]], 0.0)
    scale = task.load * task.n / total if task.free_mean else 1.0
    for k in range(touching):
        i = inside[k]
        t[k] = (z[k] if hasty else 0.0) - new[i]
        touches[i] = new[i] > 0.0
        new[i] = scale * new[i] if new[i] > 0.0 else 0.0
        t[k] += new[i]
    decay_product(level.lists.contact_rows, touching, level.fine, t, st)
    for k in range(touching):
        gap[inside[k]] = st[k] - r[k]


@jit
def _join(count: int, touching: int, misfit: float, task: Task, level: DecayLevel) -> int:
    """Find the gaps of all candidates, and bring into contact those that overlap by more than the misfit; how many."""
    new, old, opened, gap, _, z, _, _, _ = level.values
    for k in range(count):
        z[k] = new[k] - old[k]
    decay_product(level.lists.rows, count, level.fine, z, gap)
    approach = 0.0
    for k in range(count):
        gap[k] += opened[k]
    if task.free_mean:
        for k in range(touching):
            approach += gap[level.lists.inside[k]]
        approach /= touching
    joining: int = join_deepest(gap, level.lists.touches, level.lists.nodes, count, approach - misfit)
    return joining


@jit
def _put(p: Reals, count: int, nodes: Indices, values: Values) -> float:
    """Put the pressure of the candidates into p; its largest change over the largest pressure."""
    change = 0.0
    largest = 0.0
    for k in range(count):
        change = max(change, abs(values.new[k] - values.old[k]))
        largest = max(largest, values.new[k])
        p[nodes[k]] = values.new[k]
    return change / largest if largest > 0.0 else 0.0


@jit
def touching_displacement(p: Reals, sp: Reals, wall: Reals, n: int, free_mean: bool, u: Reals) -> None:
    """Displacement nearest to sp, up to the approach, that touches where there is pressure and overlaps nowhere."""
    approach = 0.0
    if free_mean:
        count = 0
        first, beyond = 0.0, 0.0  # as in `candidates`
        for j in range(n):
            if p[j] > 0.0:
                if count == 0:
                    first = wall[j] + sp[j]
                beyond += wall[j] + sp[j] - first
                count += 1
        approach = first + beyond / count
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
