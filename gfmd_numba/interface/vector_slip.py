"""Laws of gap and slip, where the slip is a vector, on profiles of one component: they resist every direction alike.

The energy of a law is that of the length r of the slip s = r e. So it drags along e; its second derivative by the slip
is that of r along e, and the drag over r across it.
"""

from functools import reduce

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw


def length(slip: Reals) -> Reals:
    """Length of a slip `[component, ...]`."""
    return reduce(np.hypot, slip, np.zeros(()))


def tangential_traction(law: XuNeedlemanLaw, gap: Reals, slip: Reals) -> Reals:
    """Traction `[component, ...]` that drags the body along with the punch."""
    r = length(slip)
    return law.tangential_traction(gap, r) * _direction(slip, r)


def stiffness(law: XuNeedlemanLaw, gap: Reals, slip: Reals) -> tuple[Reals, ...]:
    """Second derivatives xx, xy, yy, xz, yz and zz of the energy by the displacements of the body, or xx, xz and zz."""
    r = length(slip)
    along, both, normal = law.stiffness(gap, r)
    way = _direction(slip, r)
    across = np.divide(law.tangential_traction(gap, r), r, out=along.copy(), where=r > 0.0)
    pairs = [(i, j) for i in range(len(slip)) for j in range(i + 1)]
    in_plane = [along * (way[i] * way[j]) + across * ((i == j) - way[i] * way[j]) for i, j in pairs]
    return (*in_plane, *(both * way), normal)


def energy_change(law: XuNeedlemanLaw, gap: Reals, slip: Reals, closing: Reals, dragged: Reals) -> Reals:
    """Change of the energy per area as the body closes gaps and is dragged along, without cancellation."""
    r, left = length(slip), slip - dragged
    both = r + length(left)
    shorter = np.divide((dragged * (slip + left)).sum(axis=0), both, out=np.zeros_like(both), where=both > 0.0)
    return law.energy_change(gap, r, closing, shorter)


def _direction(slip: Reals, r: Reals) -> Reals:
    return np.divide(slip, r, out=np.zeros_like(slip), where=r > 0.0)
