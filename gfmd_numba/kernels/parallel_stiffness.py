"""Compiled solution with a body and a law in parallel on every node of a profile, for both displacements at once."""

from gfmd_numba.arrays import Reals
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.decay_sums import eight, faded, raised, summed
from gfmd_numba.kernels.exponential_sum import Factors


@jit
def parallel_solve(r: Reals, second: int, own: Reals, weights: Reals, factors: Factors, t: Reals, d: Reals) -> None:
    """Fill d = A r - A (C + A)^-1 A r, for A = `own` and C a sum of eight decays that is factored.

    `r` and `d` hold the first component from 0 on, the second from `second` on. `own` and the scratch `t` are
    `[component, node]`. `weights` `[component, 8]` are those of the decays. Of the factors `lower` is
    `[component node, 8]`, `diagonal` has the reciprocal pivots `[component, node]`, and `decay` `[1, 8]` is what decays
    keep from a node to the next. The sweeps of both components run side by side, because each waits for its own last
    node.
    """
    decay, lower, share, _ = factors
    n = own.shape[1]
    keep, w, v = eight(decay, 0, 0), eight(weights, 0, 0), eight(weights, 1, 0)
    one = two = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    t[0, 0] = own[0, 0] * r[0]
    t[1, 0] = own[1, 0] * r[second]
    for i in range(1, n):
        one = faded(raised(one, t[0, i - 1], eight(lower, i - 1, 0)), 0.0, keep)
        two = faded(raised(two, t[1, i - 1], eight(lower, n + i - 1, 0)), 0.0, keep)
        t[0, i] = own[0, i] * r[i] - summed(one, w)
        t[1, i] = own[1, i] * r[second + i] - summed(two, v)
    for c in range(2):
        for i in range(n):
            t[c, i] *= share[c, i]
    one = two = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for i in range(n - 2, -1, -1):
        one = faded(raised(one, t[0, i + 1], w), 0.0, keep)
        two = faded(raised(two, t[1, i + 1], v), 0.0, keep)
        t[0, i] -= summed(one, eight(lower, i, 0))
        t[1, i] -= summed(two, eight(lower, n + i, 0))
    for i in range(n):
        d[i] = own[0, i] * (r[i] - t[0, i])
        d[second + i] = own[1, i] * (r[second + i] - t[1, i])
