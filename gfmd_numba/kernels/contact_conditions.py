"""Compiled contact conditions: the nearest pressure that a contact allows, and by how much tractions violate them."""

from typing import Any, NamedTuple, Self

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit


def friction_bound(pressure: Any, friction: Any, limit: Any, rise: Any) -> Any:
    """Largest tangential traction under a positive pressure, of a node or of an array of nodes.

    That is `friction` times the pressure, as Coulomb says, but at most a `limit` that may have a `rise` with pressure.
    """
    return np.minimum(friction * pressure, limit + rise * pressure)


class Conditions(NamedTuple):
    """What holds at a node that touches: its pressure is at most `hardness`, its `friction` holds that times pressure.

    Without a hardness that is infinite; without friction that is 0, and no node bears a tangential traction. None
    bears more than the `limit`, which may have a `rise` with the pressure. Where friction depends on more, `bounds`
    `[realisation, node]` is what it holds; empty otherwise.
    """

    hardness: float = np.inf
    friction: float = 0.0
    limit: float = np.inf
    rise: float = 0.0
    bounds: Reals = np.empty((0, 0))

    def friction_bound(self, pressure: Reals, slip: Reals | None = None) -> Reals:
        """Largest tangential traction under a pressure; 0 where that is not positive, even if friction is infinite.

        The `slip` is for friction that depends on it, like `interface/slip_rate.py`.
        """
        bound, bears = np.zeros_like(pressure), pressure > 0.0
        bound[bears] = friction_bound(pressure[bears], self.friction, self.limit, self.rise)
        return bound

    def linearised(self, pressure: Reals, slip: Reals) -> tuple[Reals | None, Reals, None]:
        """Constant part and part per pressure `[node]` of what is held near a pressure; None is no such part."""
        limited = (self.friction - self.rise) * pressure > self.limit
        constant = np.where(limited, self.limit, 0.0) if limited.any() else None
        return constant, np.where(limited, self.rise, self.friction), None


_compiled_bound = jit(friction_bound)


@jit
def bound_of_node(pressure: float, conditions: Conditions) -> float:
    """Largest tangential traction of a node under a positive pressure."""
    bound: float = _compiled_bound(pressure, conditions.friction, conditions.limit, conditions.rise)
    return bound


class SurfaceState(NamedTuple):
    """Displacements `u` of a batch `[realisation, component, x]`, the tractions `ku` that restore them, and what acts.

    The normal component comes last, after tangential ones along x and on maps along y. Normal displacements may not
    pass the `wall` `[realisation, x]`; the `load` `[realisation]` is the mean pressure. A node slips from its `anchor`,
    which has tangential components alone.
    """

    u: Reals
    ku: Reals
    wall: Reals
    load: Reals
    anchor: Reals

    @classmethod
    def of_normal(cls, u: Reals, ku: Reals, wall: Reals, load: Reals) -> Self:
        """State of the normal displacement alone `[realisation, x]`."""
        return cls(u[:, np.newaxis], ku[:, np.newaxis], wall, load, u[:, np.newaxis][:, :0])


@jit
def allowed_pressure(traction: float, u: float, wall: float, hardness: float) -> float:
    """Pressure nearest to a traction: none on a free node, from 0 to the hardness on a touching one.

    A node that penetrates bears exactly the hardness.
    """
    if u > wall:
        return hardness
    return min(max(traction, 0.0), hardness) if u >= wall else 0.0


@jit
def wall_violation(
    state: SurfaceState, conditions: Conditions, active: Indices, n: int, worst: Reals, peak: Reals, imbalance: Reals
) -> None:
    """Largest violation of a contact condition, largest pressure, and mean normal traction that nothing balances.

    Not-a-number if any traction is not finite.
    """
    u, ku, wall, load, _ = state
    normal = u.shape[1] - 1
    for i in active:
        largest = 0.0
        highest = 0.0
        total = 0.0  # a NaN or infinity anywhere survives in a sum, not in a comparison
        carried = 0.0
        for j in range(n):
            traction = load[i] - ku[i, normal, j]
            total += traction
            pressure = allowed_pressure(traction, u[i, normal, j], wall[i, j], conditions.hardness)
            carried += pressure
            highest = max(highest, pressure)
            largest = max(largest, abs(traction - pressure))
        imbalance[i] = abs(total - carried) / n
        if normal > 0:
            sideways, total_sideways = tangential_violation(state, conditions, i, n)
            largest, total = max(largest, sideways), total + total_sideways
        worst[i] = largest if np.isfinite(total) else np.nan
        peak[i] = highest


@jit
def tangential_violation(state: SurfaceState, conditions: Conditions, i: int, n: int) -> tuple[float, float]:
    """Largest tangential traction of a row that friction does not balance, and the sum of all.

    Free nodes bear none, sticking nodes at most what friction holds, sliding ones exactly that against the way they
    have slid. Under an infinite friction a node that slid has left its anchor, and bears nothing.
    """
    u, ku, wall, load, anchor = state
    normal = u.shape[1] - 1
    friction = conditions.friction
    largest = 0.0
    total = 0.0
    for j in range(n):
        traction, way = 0.0, 0.0  # squares
        for c in range(normal):
            total += ku[i, c, j]
            traction += ku[i, c, j] ** 2
            way += (u[i, c, j] - anchor[i, c, j]) ** 2
        violation, slid = np.sqrt(traction), np.sqrt(way)
        pressure = load[i] - ku[i, normal, j]
        held = conditions.bounds[i, j] if conditions.bounds.size > 0 else bound_of_node(pressure, conditions)
        if friction > 0.0 and u[i, normal, j] >= wall[i, j] and pressure > 0.0:
            if slid > 0.0 and np.isinf(friction):
                violation = max(violation, pressure)
            elif slid > 0.0:
                traction = 0.0
                for c in range(normal):
                    against = held * ((u[i, c, j] - anchor[i, c, j]) / slid)
                    traction += (ku[i, c, j] + against) ** 2
                violation = np.sqrt(traction)
            else:
                violation = max(violation - held, 0.0)
        largest = max(largest, violation)
    return largest, total


@jit
def wall_pressure(state: SurfaceState, hardness: float, active: Indices, n: int) -> None:
    """Replace the normal restoring traction by the pressure of the wall: the nearest one that the contact allows."""
    u, ku, wall, load, _ = state
    normal = u.shape[1] - 1
    for i in active:
        for j in range(n):
            ku[i, normal, j] = allowed_pressure(load[i] - ku[i, normal, j], u[i, normal, j], wall[i, j], hardness)
