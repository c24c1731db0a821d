"""Compiled products with a periodic sum of decays, linear in the number of nodes.

C_ij = sum_s weight_s base_s^d summed over all images, d = |x_i - x_j| + k n, + white delta_ij: sweeps over the ordered
nodes carry what each decay has gathered so far, eight decays at a time and always in the same order.
"""

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit

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


@jit
def decay_product(
    rows: Indices,
    count: int,
    powers: Reals,
    weights: Reals,
    white: float,
    mean: float,
    source: Reals,
    product: Reals,
) -> None:
    """Product of the sum with a source on the first `count` nodes; `mean` is added for each pair of nodes.

    `rows` are those of `powers` `[row, decay]` that lead to each node from the one before, the first from the last
    across the cut; the decays are in the order of their rates, a multiple of eight. `weights` is `[2, decay]`, the
    second row 1 / (1 - base^n).
    """
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
