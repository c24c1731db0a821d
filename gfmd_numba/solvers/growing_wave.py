"""The wave with which a run has blown up."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid


def growing_wave(displacement: Reals, sideways: Reals | None, response: SpectralResponse) -> Indices:
    """Return the index `[realisation]` of the wave with the largest restoring traction: the run blew up from nothing.

    `displacement` is normal, `[realisation, (y,) x]`; `sideways` the tangential one `[realisation, (component, y,) x]`,
    None without any (L_x). The `response` is the one that the run has had.
    """
    rows, shape = len(displacement), displacement.shape[1:]
    moved = displacement[:, np.newaxis]
    if sideways is not None:
        moved = np.concatenate((sideways.reshape(rows, -1, *shape), moved), axis=1)
    tractions = (np.abs(grid.coefficients(moved, len(shape))) * response.diagonal[-moved.shape[1] :]).max(axis=1)
    index = grid.magnitudes(shape).ravel() / (2.0 * np.pi)
    return np.asarray(np.round(index[tractions.reshape(rows, -1).argmax(axis=1)]), dtype=np.int64)
