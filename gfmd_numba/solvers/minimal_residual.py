"""Generalised minimal residuals (Saad & Schultz, SIAM J. Sci. Stat. Comput. 7:856, 1986) for one small system."""

import math
from collections.abc import Callable

import numpy as np

from gfmd_numba.arrays import Reals


def minimal_residual(product: Callable[[Reals], Reals], residual: Reals, aim: float, most: int) -> tuple[Reals, Reals]:
    """Return directions `[k, unknown]` and how far to go along each `[k]`, so that |residual - product| is at most aim.

    `product` is called once for each direction, in their order: whoever keeps what it found along the way need not
    compute it again for the solution. At most `most` directions are tried.
    """
    size = float(np.linalg.norm(residual))
    basis = np.empty((most + 1, residual.size))
    hessenberg = np.zeros((most + 1, most))
    shares: Reals = np.zeros(0)
    if not size > aim:
        return basis[:0], shares
    basis[0] = residual / size
    rotations: list[tuple[float, float]] = []  # that make the matrix triangular
    left = size
    for k in range(most):
        new = product(basis[k])
        for _ in range(2):  # once leaves rounding errors in the angles
            along = basis[: k + 1] @ new
            hessenberg[: k + 1, k] += along
            new -= along @ basis[: k + 1]
        hessenberg[k + 1, k] = norm = math.sqrt(new @ new)
        if not math.isfinite(norm):
            return basis[: k + 1], np.full(k + 1, np.nan)
        above, *below = hessenberg[: k + 1, k].tolist()
        for (cosine, sine), each in zip(rotations, below, strict=True):
            above = cosine * each - sine * above
        length = math.hypot(above, norm)
        rotations.append((above / length, norm / length) if length > 0.0 else (1.0, 0.0))
        left *= rotations[-1][1]
        if left <= aim or norm == 0.0:
            break
        basis[k + 1] = new / norm
    target = np.zeros(k + 2)
    target[0] = size
    shares = np.linalg.lstsq(hessenberg[: k + 2, : k + 1], target, rcond=None)[0].astype(np.float64)
    return basis[: k + 1], shares
