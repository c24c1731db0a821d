"""Compiled Cholesky factorisation of a sum of exponential decays on scattered nodes, linear in their number.

C_ij = sum_s weight_s exp(-rate_s |x_i - x_j|) + white delta_ij is semiseparable: L D L' = C takes one sweep over the
ordered nodes (Foreman-Mackey et al., Astron. J. 154:220, 2017), each node some operations for each pair of decays.
"""

from typing import NamedTuple

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit


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


@jit
def exponential_sum_solve_two(
    y: Reals, second: Reals, count: int, weights: Reals, factors: Factors, z: Reals, solution: Reals
) -> None:
    """Solve L D L' z = y and L D L' solution = second at once, as `exponential_sum_solve` does each."""
    decay, lower, diagonal = factors.decay, factors.lower, factors.diagonal
    carried, other = factors.carried[0], factors.carried[1]
    terms = weights.size
    carried[:] = 0.0
    other[:] = 0.0
    for i in range(count):
        value = y[i]
        value_two = second[i]
        if i > 0:
            for s in range(terms):
                carried[s] = decay[i, s] * (carried[s] + lower[i - 1, s] * z[i - 1])
                other[s] = decay[i, s] * (other[s] + lower[i - 1, s] * solution[i - 1])
                value -= weights[s] * carried[s]
                value_two -= weights[s] * other[s]
        z[i] = value
        solution[i] = value_two
    for i in range(count):
        z[i] /= diagonal[i]
        solution[i] /= diagonal[i]
    carried[:] = 0.0
    other[:] = 0.0
    for i in range(count - 2, -1, -1):
        value = z[i]
        value_two = solution[i]
        for s in range(terms):
            carried[s] = decay[i + 1, s] * (carried[s] + weights[s] * z[i + 1])
            other[s] = decay[i + 1, s] * (other[s] + weights[s] * solution[i + 1])
            value -= lower[i, s] * carried[s]
            value_two -= lower[i, s] * other[s]
        z[i] = value
        solution[i] = value_two
