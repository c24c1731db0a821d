"""Compiled tractions of interaction laws."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.conditions import CoupledState


@jit
def exponential_pull(
    u: Reals, ku: Reals, punch: Reals, active: Indices, n: int, strength: float, length: float
) -> None:
    """Take the traction strength * exp(-gap / length) towards the punch (6.110) off the restoring traction ku."""
    for i in active:
        for j in range(n):
            ku[i, j] -= strength * np.exp((u[i, j] - punch[i, j]) / length)


@jit
def xu_needleman_pull(
    state: CoupledState,
    punch: Reals,
    sliding: tuple[Reals, ...],
    active: Indices,
    n: int,
    work: float,
    normal: float,
    tangential: float,
) -> None:
    """Take the tractions of Xu and Needleman's law off the restoring tractions of a state.

    `sliding` is how far the punch has moved over each of the n nodes: in x, and on maps in y.
    """
    u1, k1, u3, k3 = state.u1, state.k1, state.u3, state.k3
    for i in active:
        for j in range(n):
            gap = (punch[i, j] - u3[i, j]) / normal
            overlap = min(gap, 0.0)  # repels as without slip
            gap = max(gap, 0.0)
            exponent = -gap
            for component in range(len(sliding)):
                slip = (sliding[component][j] - u1[component * len(punch) + i, j]) / tangential
                exponent -= slip * slip
            decay = work * np.exp(exponent)
            drag = 2.0 / tangential * (1.0 + gap) * decay
            for component in range(len(sliding)):
                row = component * len(punch) + i
                k1[row, j] -= (sliding[component][j] - u1[row, j]) / tangential * drag
            k3[i, j] -= gap / normal * decay + overlap / normal * work * np.exp(-overlap)
