"""Compiled tractions of the cohesive law, which damped dynamics ask for in every step."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.contact_conditions import SurfaceState


@jit
def xu_needleman_pull(
    state: SurfaceState,
    punch: Reals,
    sliding: Reals,
    active: Indices,
    n: int,
    work: float,
    normal: float,
    tangential: float,
) -> None:
    """Take the tractions of Xu and Needleman's law off the restoring tractions of a state.

    `sliding` `[component, x]` is how far the punch has moved over each of the n nodes: in x, and on maps in y.
    """
    u, ku, along = state.u, state.restoring, sliding.shape[0]
    for i in active:
        for j in range(n):
            gap = (punch[i, j] - u[i, along, j]) / normal
            overlap = min(gap, 0.0)  # repels as without slip
            gap = max(gap, 0.0)
            exponent = -gap
            for c in range(along):
                slip = (sliding[c, j] - u[i, c, j]) / tangential
                exponent -= slip * slip
            decay = work * np.exp(exponent)
            drag = 2.0 / tangential * (1.0 + gap) * decay
            for c in range(along):
                ku[i, c, j] -= (sliding[c, j] - u[i, c, j]) / tangential * drag
            ku[i, along, j] -= gap / normal * decay + overlap / normal * work * np.exp(-overlap)
