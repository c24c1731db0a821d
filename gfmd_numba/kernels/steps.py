"""Compiled time steps of displacements of which the normal one is clipped at the hard wall."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.contact_conditions import Conditions, SurfaceState, bound_of_node


@jit
def verlet_step(state: SurfaceState, u_old: Reals, active: Indices, n: int, memory: float, push: float) -> None:
    """One Verlet step (6.55) of all components, as if none held tangential ones; the wall clips the normal (2.16)."""
    u, ku, wall, load, _ = state
    normal = u.shape[1] - 1
    for i in active:
        for c in range(normal):
            for j in range(n):
                now = u[i, c, j]
                u[i, c, j] = now + memory * (now - u_old[i, c, j]) - push * ku[i, c, j]
                u_old[i, c, j] = now
        for j in range(n):
            now = u[i, normal, j]
            new = now + memory * (now - u_old[i, normal, j]) + push * (load[i] - ku[i, normal, j])
            u_old[i, normal, j] = now
            u[i, normal, j] = min(new, wall[i, j])


@jit
def friction_step(
    state: SurfaceState, u_old: Reals, conditions: Conditions, active: Indices, n: int, push: float
) -> None:
    """Hold touching nodes by Coulomb friction after a Verlet step from `u_old` (an infinite one sticks).

    Friction acts against the way slid from the `anchor`; a node that an infinite one has pulled off sticks where it
    touches down again. Its step is a proximal one without inertia, by half the push of a free node, which is stable for
    every mode: within what friction can hold of the anchor the node sticks to it, beyond it is drawn back by as much.
    """
    u, ku, wall, load, anchor = state
    normal = u.shape[1] - 1
    for i in active:
        for j in range(n):
            pressure = load[i] - ku[i, normal, j]
            if not (u_old[i, normal, j] >= wall[i, j] and pressure > 0.0):
                if np.isinf(conditions.friction):
                    for c in range(normal):
                        anchor[i, c, j] = u_old[i, c, j]
                continue
            square = 0.0
            for c in range(normal):
                square += (u_old[i, c, j] - 0.5 * push * ku[i, c, j] - anchor[i, c, j]) ** 2
            slid, held = np.sqrt(square), 0.5 * push * bound_of_node(pressure, conditions)
            left = 1.0 - held / slid if slid > held else 0.0  # part of the way that friction cannot hold
            for c in range(normal):
                pulled = u_old[i, c, j] - 0.5 * push * ku[i, c, j] - anchor[i, c, j]
                u[i, c, j] = anchor[i, c, j] + left * pulled


@jit
def fire_step(
    state: SurfaceState, v: Reals, dt: Reals, mixing: Reals, downhill: Indices, active: Indices, n: int, longest: float
) -> None:
    """One step of FIRE (Bitzek et al., Phys. Rev. Lett. 97:170201, 2006) with the hard wall.

    A node that the force holds against the wall has neither force nor velocity.
    """
    u, ku, wall, load, _ = state
    for i in active:
        power = 0.0
        speed2 = 0.0
        force2 = 0.0
        for j in range(n):
            force = load[i] - ku[i, 0, j]
            if u[i, 0, j] >= wall[i, j] and force >= 0.0:
                v[i, j] = 0.0
            else:
                power += force * v[i, j]
                force2 += force * force
                speed2 += v[i, j] * v[i, j]
        keep = 0.0
        steer = 0.0
        if power > 0.0:
            keep = 1.0 - mixing[i]
            steer = mixing[i] * np.sqrt(speed2 / force2)
            downhill[i] += 1
            if downhill[i] > 5:
                dt[i] = min(1.1 * dt[i], longest)
                mixing[i] *= 0.99
        elif speed2 > 0.0:
            downhill[i] = 0
            dt[i] *= 0.5
            mixing[i] = 0.1
        for j in range(n):
            force = load[i] - ku[i, 0, j]
            if u[i, 0, j] >= wall[i, j] and force >= 0.0:
                continue
            v[i, j] = keep * v[i, j] + (steer + dt[i]) * force
            u[i, 0, j] = min(u[i, 0, j] + dt[i] * v[i, j], wall[i, j])
