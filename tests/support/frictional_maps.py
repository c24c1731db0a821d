"""Rough maps with friction and their solution, step by step."""

import numpy as np

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.table import Options

NEWTON = Options("frictional_newton", max_iterations=100)  # and no other solver after it


def rough(shape, seed, hurst=0.8, waves=8, rows=1):
    """Punches of waves up to an index, whatever the shape of the grid, of about unit gradient."""
    rng, q = np.random.default_rng(seed), grid.magnitudes(shape) / (2.0 * np.pi)
    size = np.where((q > 0.0) & (q <= waves), np.maximum(q, 1.0) ** (-1.0 - hurst), 0.0)
    heights = np.fft.irfft2(size * np.exp(2j * np.pi * rng.random((rows, *q.shape))), shape)
    heights /= 2.0 * np.pi * np.sqrt((q * size) ** 2).sum() / np.prod(shape)
    return heights.max(axis=(1, 2), keepdims=True) - heights


def press(punch, body, load, friction, start=None, sliding=(0.0, 0.0), options=NEWTON):
    stiffness = body.response(punch.shape[1:]) if isinstance(body, ElasticBody) else body
    drag = np.reshape(sliding, (2, 1, 1))
    return equilibrate(punch, stiffness, load, options, Interactions(True, friction=friction), start, drag)


def follow(steps, body, friction, options=NEWTON):
    """Equilibrium of each step (punch, load, sliding), and what it began with."""
    before = None
    for punch, load, sliding in steps:
        drag = np.reshape(sliding, (2, 1, 1))
        start = None if before is None else following(before, punch, drag)
        before = press(punch, body, load, friction, start, drag, options)
        yield before, start
