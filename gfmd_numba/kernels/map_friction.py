"""Compiled loops of Coulomb friction on maps, where both tangential displacements are followed.

Rows of tangential quantities are the x components of all realisations, then the y components. What a row of the
profile's kernels (`steps.py`, `conditions.py`, `spectral.py`) does with a sign, these do with a direction.
"""

import numpy as np

from gfmd_numba.arrays import Complexes, Indices, Reals
from gfmd_numba.kernels.compilation import jit


@jit
def couple_map(
    spectrum: Complexes,
    xx: Reals,
    xy: Reals,
    yy: Reals,
    xz: Reals,
    yz: Reals,
    zz: Reals,
    active: Indices,
    rows: int,
) -> None:
    """Restoring tractions of the displacements along x (row i), along y (rows + i) and normal (2 rows + i), in place.

    The phase is that of `couple`.
    """
    for i in active:
        for k in range(xx.size):
            x, y, z = spectrum[i, k], spectrum[rows + i, k], spectrum[2 * rows + i, k]
            spectrum[i, k] = xx[k] * x + xy[k] * y + 1j * xz[k] * z
            spectrum[rows + i, k] = xy[k] * x + yy[k] * y + 1j * yz[k] * z
            spectrum[2 * rows + i, k] = zz[k] * z - 1j * (xz[k] * x + yz[k] * y)


@jit
def coupled_map_step(
    u1: Reals,
    u1_old: Reals,
    anchor: Reals,
    k1: Reals,
    u3: Reals,
    u3_old: Reals,
    k3: Reals,
    wall: Reals,
    load: Reals,
    friction: float,
    active: Indices,
    n: int,
    memory: float,
    push: float,
) -> None:
    """One Verlet step of all components with the hard wall and Coulomb friction, as `coupled_step` makes it."""
    rows = load.size
    for i in active:
        for j in range(n):
            pressure = load[i] - k3[i, j]
            x, y = u1[i, j], u1[rows + i, j]
            if friction > 0.0 and u3[i, j] >= wall[i, j] and pressure > 0.0:
                if np.isnan(anchor[i, j]):
                    anchor[i, j], anchor[rows + i, j] = x, y
                along = x - 0.5 * push * k1[i, j] - anchor[i, j]
                across = y - 0.5 * push * k1[rows + i, j] - anchor[rows + i, j]
                slid = np.hypot(along, across)
                held = 0.5 * push * friction * pressure
                left = 1.0 - held / slid if slid > held else 0.0
                new_x, new_y = anchor[i, j] + left * along, anchor[rows + i, j] + left * across
            else:
                anchor[i, j] = anchor[rows + i, j] = np.nan
                new_x = x + memory * (x - u1_old[i, j]) - push * k1[i, j]
                new_y = y + memory * (y - u1_old[rows + i, j]) - push * k1[rows + i, j]
            u1_old[i, j], u1_old[rows + i, j] = x, y
            u1[i, j], u1[rows + i, j] = new_x, new_y
            now = u3[i, j]
            new = now + memory * (now - u3_old[i, j]) + push * pressure
            u3_old[i, j] = now
            u3[i, j] = min(new, wall[i, j])


@jit
def map_friction_violation(
    u1: Reals,
    anchor: Reals,
    k1: Reals,
    u3: Reals,
    k3: Reals,
    wall: Reals,
    load: Reals,
    friction: float,
    active: Indices,
    n: int,
    worst: Reals,
) -> None:
    """Raise `worst` to the largest tangential force that friction does not balance, as `friction_violation` does."""
    rows = load.size
    for i in active:
        largest = 0.0
        total = 0.0
        for j in range(n):
            x, y = k1[i, j], k1[rows + i, j]
            total += x + y
            violation = np.hypot(x, y)
            pressure = load[i] - k3[i, j]
            if friction > 0.0 and u3[i, j] >= wall[i, j] and pressure > 0.0:
                along, across = u1[i, j] - anchor[i, j], u1[rows + i, j] - anchor[rows + i, j]
                slid = np.hypot(along, across)
                if slid > 0.0 and np.isinf(friction):
                    violation = max(violation, pressure)
                elif slid > 0.0:
                    bound = friction * pressure
                    violation = np.hypot(x + bound * along / slid, y + bound * across / slid)
                else:
                    violation = max(violation - friction * pressure, 0.0)
            largest = max(largest, violation)
        worst[i] = max(worst[i], largest) if np.isfinite(total) and not np.isnan(worst[i]) else np.nan
