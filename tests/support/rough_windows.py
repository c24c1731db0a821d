"""Rough heights without a period."""

import numpy as np

from gfmd_numba.fourier import grid


def rough(n, dimension, seed=1):
    """Rough heights `[(y,) x]`, the ends of which do not meet."""
    shape = (2 * n,) * dimension
    q = grid.magnitudes(shape)
    waves = np.where((q > 8.0) & (q < 0.5 * np.pi * n), np.maximum(q, 1.0) ** (-0.8 - 0.5 * dimension), 0.0)
    phases = np.exp(2j * np.pi * np.random.default_rng(seed).random(q.shape))
    return grid.signal(waves * phases, *shape)[(slice(n),) * dimension]
