"""Compiled active-set steps of a profile whose compliance is a sum of decays: no transforms, no work on open nodes.

The first values of an array over candidates belong to the candidates, those of an array over the contact to its nodes;
what follows them has no meaning.
"""

from typing import NamedTuple

import numpy as np

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.kernels.active_sets import newton_error, without_mean
from gfmd_numba.kernels.candidates import candidates, distances_around, join_deepest
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.decay_sums import POWERS, decay_product, far_powers
from gfmd_numba.kernels.exponential_sum import (
    Decays,
    Factors,
    exponential_sum_factor,
    exponential_sum_solve,
    exponential_sum_solve_two,
)

_LOOSE = 0.03  # relative error allowed in the first pressure on a new contact
_TIGHTEN = 0.1  # factor on that error after each step
_MANY = 0.01  # share of a contact under tension from which on one iteration is enough
_STEPS = 30  # contacts tried for one gap
_ROUNDS = 3  # in which nodes may join at the last tolerance, before the gap is found anew
_ITERATIONS = 60  # of conjugate gradients for each


class Task(NamedTuple):
    """What is asked of a contact on `n` nodes: a mean pressure `load` if it is given (`free_mean`), and how exactly.

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


class DecaySum(NamedTuple):
    """An accurate sum of decays, as `decay_product` takes it: `near` has rows for the `powers` of long distances."""

    powers: Reals
    near: Reals
    weights: Reals
    white: float
    mean: float


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

    There `r` is the displacement that closes the gap, `z` the change of pressure, `uniform` that of a uniform
    displacement, `t` the direction and `st` its displacement.
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


class Level(NamedTuple):
    """A grid: its accurate sum, the coarser one that preconditions it with room for its factors, and scratch."""

    fine: DecaySum
    coarse: Decays
    factors: Factors
    lists: Lists
    values: Values


@jit
def decay_contact(p: Reals, sp: Reals, wall: Reals, asked: Task, grid: Level) -> tuple[float, int]:
    """Find the contact and its pressure p that leave no overlap and no tension under a sum of decays.

    The sum only acts on what p changes by: the gap it starts from is that of the displacement sp. Conjugate gradients,
    preconditioned by a coarser sum, solve for the pressure on one contact after the other. First nodes under tension
    leave until there are none, then overlapping ones join. The contact has settled once no node joins, or after a few
    rounds at the last tolerance. Returns the largest change of the pressure over the largest pressure, infinite if the
    contact did not settle, and the number of nodes in contact.

    The records may come as plain tuples: a compiled function takes these in a third of the time.
    """
    fine, coarse, factors, lists, values = grid
    level = Level(DecaySum(*fine), Decays(*coarse), Factors(*factors), Lists(*lists), Values(*values))
    task = Task(*asked)
    count, free = _gather(p, sp, wall, task, level)
    if count == 0:
        return 0.0, 0
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
    return (change if settled else np.inf), touching


@jit
def _gather(p: Reals, sp: Reals, wall: Reals, task: Task, level: Level) -> tuple[int, int]:
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
def _factor(touching: int, free: int, task: Task, level: Level) -> None:
    """Factor the coarse sum on the contact, and solve for the first change of pressure."""
    _, _, distances, _, _, contact, contact_rows = level.lists
    r, z, uniform, t = level.values.r, level.values.z, level.values.uniform, level.values.t
    coarse, factors = level.coarse, level.factors
    distances_around(contact, touching, task.n, distances)
    far_powers(level.fine.powers, level.fine.near, distances, touching, free, contact_rows)
    exponential_sum_factor(coarse, factors, contact, touching, task.n, r[:0])
    if task.free_mean:
        without_mean(r, touching)
        for k in range(touching):
            t[k] = 1.0
        exponential_sum_solve_two(r, t, touching, coarse.weights, factors, z, uniform)
    else:
        exponential_sum_solve(r, touching, coarse.weights, factors, z)


@jit
def _close_gap(
    touching: int, fresh: bool, tolerance: float, final: float, task: Task, level: Level
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
        energy, error = newton_error(r, z, uniform, new, inside, touching, task.rounding, task.free_mean)
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
        _multiply(level.lists.contact_rows, touching, level.fine, t, st)
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
            without_mean(r, touching)
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
def _multiply(rows: Indices, count: int, fine: DecaySum, source: Reals, product: Reals) -> None:
    decay_product(rows, count, fine.near, fine.weights, fine.white, fine.mean, source, product)


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
def _let_go(touching: int, hasty: bool, task: Task, level: Level) -> None:
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
    _multiply(level.lists.contact_rows, touching, level.fine, t, st)
    for k in range(touching):
        gap[inside[k]] = st[k] - r[k]


@jit
def _join(count: int, touching: int, misfit: float, task: Task, level: Level) -> int:
    """Find the gaps of all candidates, and bring into contact those that overlap by more than the misfit; how many."""
    new, old, opened, gap, _, z, _, _, _ = level.values
    for k in range(count):
        z[k] = new[k] - old[k]
    _multiply(level.lists.rows, count, level.fine, z, gap)
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
