"""Compiled time steps of displacements of which the normal one is clipped at the hard wall."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.contact_conditions import ContactLimits, SurfaceState, friction_limit_of_node


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
    state: SurfaceState, u_old: Reals, limits: ContactLimits, active: Indices, n: int, push: float
) -> None:
    """Hold touching nodes by Coulomb friction after a Verlet step from `u_old` (an infinite one sticks).

    Friction acts against the slip s from the `anchor`. The step is a proximal one without inertia, by half the push of
    a free node, which is stable for every mode: with the trial slip s' = s - push/2 ku and the friction limit f,

        s <- (1 - min(1, (push/2) f / |s'|)) s',

    so that a node sticks to its anchor if |s'| <= (push/2) f. A node that infinite friction has pulled off sticks where
    it touches down again.
    """
    u, ku, wall, load, anchor = state
    normal = u.shape[1] - 1
    for i in active:
        for j in range(n):
            pressure = load[i] - ku[i, normal, j]
            if not (u_old[i, normal, j] >= wall[i, j] and pressure > 0.0):
                if np.isinf(limits.friction):
                    for c in range(normal):
                        anchor[i, c, j] = u_old[i, c, j]
                continue
            square = 0.0
            for c in range(normal):
                square += (u_old[i, c, j] - 0.5 * push * ku[i, c, j] - anchor[i, c, j]) ** 2
            slid, limit = np.sqrt(square), 0.5 * push * friction_limit_of_node(pressure, limits)
            left = 1.0 - limit / slid if slid > limit else 0.0  # part of the slip that friction cannot prevent
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
