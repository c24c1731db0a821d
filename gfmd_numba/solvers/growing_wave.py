"""The wave with which a run has blown up."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.iteration import Stiffness


def growing_wave(displacement: Reals, sideways: Reals | None, stiffness: Stiffness, free_mean: bool) -> Indices:
    """Return the index `[realisation]` of the wave with the largest restoring traction: the run blew up from nothing.

    `displacement` is normal, `[realisation, (y,) x]`; `sideways` the tangential one `[realisation, (component, y,) x]`,
    None without any (L_x). `stiffness` is that of `equilibrate`; with a `free_mean` nothing restores the mean.
    """
    normal = stiffness if isinstance(stiffness, np.ndarray) else stiffness.k33
    tractions = np.abs(grid.coefficients(displacement, normal.ndim)) * normal
    if free_mean:
        tractions.reshape(len(tractions), -1)[:, 0] = 0.0
    if not isinstance(stiffness, np.ndarray) and sideways is not None:
        tangential = np.abs(grid.coefficients(sideways, normal.ndim)) * stiffness.k11
        tractions = np.maximum(tractions, tangential if normal.ndim == 1 else tangential.max(axis=1))
    index = grid.magnitudes(displacement.shape[1:]).ravel() / (2.0 * np.pi)
    return np.asarray(np.round(index[tractions.reshape(len(tractions), -1).argmax(axis=1)]), dtype=np.int64)
