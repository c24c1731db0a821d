"""Compiled loops over a surface whose tractions are prescribed on free nodes, and whose displacement elsewhere."""

from typing import NamedTuple

import numpy as np

from gfmd_numba.arrays import Flags, Reals
from gfmd_numba.kernels.compilation import jit


class Boundary(NamedTuple):
    """The `traction` prescribed at `free` nodes `[component, x]`, and what balances it everywhere `[component]`."""

    traction: Reals
    free: Flags
    excess: Reals


@jit
def prescribed_step(u: Reals, u_old: Reals, ku: Reals, boundary: Boundary, n: int, memory: float, push: float) -> None:
    """One Verlet step (6.55) of the free nodes of each component under traction - ku - excess."""
    traction, free, excess = boundary
    for i in range(u.shape[0]):
        for j in range(n):
            if free[i, j]:
                now = u[i, j]
                u[i, j] = now + memory * (now - u_old[i, j]) + push * (traction[i, j] - ku[i, j] - excess[i])
                u_old[i, j] = now


@jit
def free_mean(ku: Reals, boundary: Boundary, i: int, n: int) -> float:
    """Mean of traction - ku over the free nodes of component i: what would move their mean displacement."""
    traction, free, _ = boundary
    total = 0.0
    count = 0
    for j in range(n):
        if free[i, j]:
            total += traction[i, j] - ku[i, j]
            count += 1
    return total / count


@jit
def prescribed_violation(ku: Reals, boundary: Boundary, n: int) -> tuple[float, float]:
    """Largest unbalanced traction of the free nodes, and largest traction of any; the former may be not-a-number."""
    traction, free, excess = boundary
    worst = 0.0
    peak = 0.0
    total = 0.0
    for i in range(ku.shape[0]):
        for j in range(n):
            restored = ku[i, j] + excess[i]
            total += restored
            peak = max(peak, abs(restored))
            if free[i, j]:
                worst = max(worst, abs(traction[i, j] - restored))
    return (worst if np.isfinite(total) else np.nan), peak
