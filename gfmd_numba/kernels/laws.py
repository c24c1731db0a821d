"""Compiled tractions of interaction laws."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit


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
    u1: Reals,
    k1: Reals,
    u3: Reals,
    k3: Reals,
    punch: Reals,
    sliding: Reals,
    active: Indices,
    n: int,
    work: float,
    normal: float,
    tangential: float,
) -> None:
    """Take the tractions of Xu and Needleman's law off the restoring tractions k1 and k3.

    `sliding` is how far the punch has moved over each of the n nodes.
    """
    for i in active:
        for j in range(n):
            gap = (punch[i, j] - u3[i, j]) / normal
            slip = (sliding[j] - u1[i, j]) / tangential
            overlap = min(gap, 0.0)  # repels as without slip
            gap = max(gap, 0.0)
            decay = work * np.exp(-gap - slip * slip)
            k1[i, j] -= 2.0 * slip / tangential * (1.0 + gap) * decay
            k3[i, j] -= gap / normal * decay + overlap / normal * work * np.exp(-overlap)


@jit
def xu_needleman_map_pull(
    u1: Reals,
    k1: Reals,
    u3: Reals,
    k3: Reals,
    punch: Reals,
    sliding: Reals,
    active: Indices,
    n: int,
    work: float,
    normal: float,
    tangential: float,
) -> None:
    """Do the same on maps, where rows of u1 and k1 are the x components of all realisations, then the y components.

    `sliding` is `[component, n]`.
    """
    rows = punch.shape[0]
    for i in active:
        for j in range(n):
            gap = (punch[i, j] - u3[i, j]) / normal
            x = (sliding[0, j] - u1[i, j]) / tangential
            y = (sliding[1, j] - u1[rows + i, j]) / tangential
            overlap = min(gap, 0.0)
            gap = max(gap, 0.0)
            decay = work * np.exp(-gap - x * x - y * y)
            drag = 2.0 / tangential * (1.0 + gap) * decay
            k1[i, j] -= x * drag
            k1[rows + i, j] -= y * drag
            k3[i, j] -= gap / normal * decay + overlap / normal * work * np.exp(-overlap)
