"""Compiled contact conditions: how far they are violated, and the pressure they leave."""

from typing import NamedTuple

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit


class State(NamedTuple):
    """Displacement `u` of a batch `[realisation, x]`, the traction `ku` that restores it, and what acts on it.

    It may not pass the `wall`; the `load` `[realisation]` is the mean pressure.
    """

    u: Reals
    ku: Reals
    wall: Reals
    load: Reals


@jit
def kkt_violation(
    state: State, active: Indices, n: int, worst: Reals, peak: Reals, imbalance: Reals, hardness: float = np.inf
) -> None:
    """Largest traction that no pressure the contact allows balances, largest pressure, and mean unbalanced traction.

    A free node allows none, a touching one from 0 to the hardness, one that penetrates exactly the hardness.
    Not-a-number if any traction is not finite.
    """
    u, ku, wall, load = state
    for i in active:
        largest = 0.0
        highest = 0.0
        total = 0.0  # a NaN or infinity anywhere survives in a sum, not in a comparison
        carried = 0.0
        for j in range(n):
            traction = load[i] - ku[i, j]
            total += traction
            pressure = min(max(traction, 0.0), hardness) if u[i, j] >= wall[i, j] else 0.0
            if u[i, j] > wall[i, j]:
                pressure = hardness
            carried += pressure
            highest = max(highest, pressure)
            largest = max(largest, abs(traction - pressure))
        worst[i] = largest if np.isfinite(total) else np.nan
        peak[i] = highest
        imbalance[i] = abs(total - carried) / n


class CoupledState(NamedTuple):
    """Displacements of a batch and their restoring tractions, where tangential ones are followed too.

    Rows of `u1`, `anchor` and `k1` `[component * realisation, x]` are tangential: of one component, or of two on maps,
    where those along x come first. A node slips from its anchor. Rows of `u3`, `k3` and the `wall` `[realisation, x]`
    are normal; `load` `[realisation]` is the mean pressure.
    """

    u1: Reals
    anchor: Reals
    k1: Reals
    u3: Reals
    k3: Reals
    wall: Reals
    load: Reals


@jit
def friction_violation(state: CoupledState, friction: float, active: Indices, n: int, worst: Reals) -> None:
    """Raise `worst` to the largest tangential force that friction does not balance.

    Free nodes have none, sticking nodes less than friction times pressure, sliding ones exactly that against the way
    they have slid. Under an infinite friction a node that slid has left its anchor, and bears nothing.
    """
    u1, anchor, k1, u3, k3, wall, load = state
    for i in active:
        largest = 0.0
        total = 0.0
        for j in range(n):
            traction, way = 0.0, 0.0  # squares
            for row in range(i, u1.shape[0], load.size):
                total += k1[row, j]
                traction += k1[row, j] ** 2
                way += (u1[row, j] - anchor[row, j]) ** 2
            violation, slid = np.sqrt(traction), np.sqrt(way)
            pressure = load[i] - k3[i, j]
            if friction > 0.0 and u3[i, j] >= wall[i, j] and pressure > 0.0:
                if slid > 0.0 and np.isinf(friction):
                    violation = max(violation, pressure)
                elif slid > 0.0:
                    traction = 0.0
                    for row in range(i, u1.shape[0], load.size):
                        against = friction * pressure * ((u1[row, j] - anchor[row, j]) / slid)
                        traction += (k1[row, j] + against) ** 2
                    violation = np.sqrt(traction)
                else:
                    violation = max(violation - friction * pressure, 0.0)
            largest = max(largest, violation)
        worst[i] = max(worst[i], largest) if np.isfinite(total) and not np.isnan(worst[i]) else np.nan


@jit
def wall_pressure(state: State, active: Indices, n: int, p: Reals, hardness: float = np.inf) -> None:
    """Pressure of the hard wall: on touching nodes under compression, the hardness where they penetrate, else zero."""
    u, ku, wall, load = state
    for i in active:
        for j in range(n):
            if u[i, j] > wall[i, j]:
                p[i, j] = hardness
            else:
                p[i, j] = min(max(load[i] - ku[i, j], 0.0), hardness) if u[i, j] >= wall[i, j] else 0.0
