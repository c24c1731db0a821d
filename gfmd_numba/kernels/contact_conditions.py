"""Compiled contact conditions: the nearest pressure that a contact allows, and by how much tractions violate them."""

from typing import Any, NamedTuple, Self

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit


def friction_limit(pressure: Any, friction: Any, shear_strength: Any, shear_rise: Any) -> Any:
    """Largest tangential traction of a node, or of an array of nodes, under a positive pressure p.

    min(friction p, shear_strength + shear_rise p)
    """
    return np.minimum(friction * pressure, shear_strength + shear_rise * pressure)


class ContactLimits(NamedTuple):
    """Limits of the tractions of a node that touches: 0 <= p <= `hardness`, and |t| <= `friction_limit` of p.

    Here p is the pressure and t the tangential traction. An absent hardness is infinite, and absent friction is 0. If
    friction depends on more than p, as on the slip rate, `friction_limits` `[realisation, node]` are its limits; empty
    otherwise.
    """

    hardness: float = np.inf
    friction: float = 0.0
    shear_strength: float = np.inf
    shear_rise: float = 0.0
    friction_limits: Reals = np.empty((0, 0))

    def friction_limit(self, pressure: Reals, slip: Reals | None = None) -> Reals:
        """Largest tangential traction under a pressure; 0 where that is not positive, even if friction is infinite.

        The `slip` is for friction that depends on it, like `interface/slip_rate.py`.
        """
        limit, bears = np.zeros_like(pressure), pressure > 0.0
        limit[bears] = friction_limit(pressure[bears], self.friction, self.shear_strength, self.shear_rise)
        return limit

    def linearised(self, pressure: Reals, slip: Reals) -> tuple[Reals | None, Reals, None]:
        """Constant part and part per pressure `[node]` of the friction limit near a pressure; None is no such part."""
        limited = (self.friction - self.shear_rise) * pressure > self.shear_strength
        constant = np.where(limited, self.shear_strength, 0.0) if limited.any() else None
        return constant, np.where(limited, self.shear_rise, self.friction), None


_compiled_limit = jit(friction_limit)


@jit
def friction_limit_of_node(pressure: float, limits: ContactLimits) -> float:
    """Largest tangential traction of a node under a positive pressure."""
    limit: float = _compiled_limit(pressure, limits.friction, limits.shear_strength, limits.shear_rise)
    return limit


class SurfaceState(NamedTuple):
    """Displacements `u` of a batch `[realisation, component, x]`, the `restoring` tractions K u, and what acts.

    The normal component comes last, after tangential ones along x and on maps along y. Normal displacements may not
    pass the `wall` `[realisation, x]`; the `load` `[realisation]` is the mean pressure. A node slips from its `anchor`,
    which has tangential components alone. Kernels unpack the restoring tractions as `ku`.
    """

    u: Reals
    restoring: Reals
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
    state: SurfaceState, limits: ContactLimits, active: Indices, n: int, worst: Reals, peak: Reals, imbalance: Reals
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
            pressure = allowed_pressure(traction, u[i, normal, j], wall[i, j], limits.hardness)
            carried += pressure
            highest = max(highest, pressure)
            largest = max(largest, abs(traction - pressure))
        imbalance[i] = abs(total - carried) / n
        if normal > 0:
            sideways, total_sideways = tangential_violation(state, limits, i, n)
            largest, total = max(largest, sideways), total + total_sideways
        worst[i] = largest if np.isfinite(total) else np.nan
        peak[i] = highest


@jit
def tangential_violation(state: SurfaceState, limits: ContactLimits, i: int, n: int) -> tuple[float, float]:
    """Largest tangential traction of a row that friction does not balance, and the sum of all.

    Free nodes bear none, sticking nodes at most the friction limit, and slipping nodes exactly the limit, against their
    slip since the anchor. Under infinite friction a node that has slipped has left its anchor, and bears nothing.
    """
    u, ku, wall, load, anchor = state
    normal = u.shape[1] - 1
    friction = limits.friction
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
        known = limits.friction_limits
        limit = known[i, j] if known.size > 0 else friction_limit_of_node(pressure, limits)
        if friction > 0.0 and u[i, normal, j] >= wall[i, j] and pressure > 0.0:
            if slid > 0.0 and np.isinf(friction):
                violation = max(violation, pressure)
            elif slid > 0.0:
                traction = 0.0
                for c in range(normal):
                    against = limit * ((u[i, c, j] - anchor[i, c, j]) / slid)
                    traction += (ku[i, c, j] + against) ** 2
                violation = np.sqrt(traction)
            else:
                violation = max(violation - limit, 0.0)
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
