"""Generalised minimal residuals (Saad & Schultz, SIAM J. Sci. Stat. Comput. 7:856, 1986) for one small system."""

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
    target = np.zeros(most + 1)
    target[0] = size
    if not size > aim:
        return basis[:0], shares
    basis[0] = residual / size
    for k in range(most):
        new = product(basis[k])
        for _ in range(2):  # once leaves rounding errors in the angles
            along = basis[: k + 1] @ new
            hessenberg[: k + 1, k] += along
            new -= along @ basis[: k + 1]
        hessenberg[k + 1, k] = norm = float(np.linalg.norm(new))
        part = hessenberg[: k + 2, : k + 1]
        if not np.isfinite(part).all():
            return basis[: k + 1], np.full(k + 1, np.nan)
        shares = np.linalg.lstsq(part, target[: k + 2], rcond=None)[0].astype(np.float64)
        if np.linalg.norm(part @ shares - target[: k + 2]) <= aim or norm == 0.0:
            break
        basis[k + 1] = new / norm
    return basis[: shares.size], shares
