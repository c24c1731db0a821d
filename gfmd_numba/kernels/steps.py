"""Compiled time steps of a displacement that is clipped at the hard wall."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit
from gfmd_numba.kernels.conditions import CoupledState, State


@jit
def verlet_step(state: State, u_old: Reals, active: Indices, n: int, memory: float, push: float) -> None:
    """One Verlet step (6.55) with the displacement clipped at the hard wall (2.16)."""
    u, ku, wall, load = state
    for i in active:
        for j in range(n):
            now = u[i, j]
            new = now + memory * (now - u_old[i, j]) + push * (load[i] - ku[i, j])
            u_old[i, j] = now
            u[i, j] = min(new, wall[i, j])


@jit
def fire_step(
    state: State, v: Reals, dt: Reals, mixing: Reals, downhill: Indices, active: Indices, n: int, longest: float
) -> None:
    """One step of FIRE (Bitzek et al., Phys. Rev. Lett. 97:170201, 2006) with the hard wall.

    A node that the force holds against the wall has neither force nor velocity.
    """
    u, ku, wall, load = state
    for i in active:
        power = 0.0
        speed2 = 0.0
        force2 = 0.0
        for j in range(n):
            force = load[i] - ku[i, j]
            if u[i, j] >= wall[i, j] and force >= 0.0:
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
            force = load[i] - ku[i, j]
            if u[i, j] >= wall[i, j] and force >= 0.0:
                continue
            v[i, j] = keep * v[i, j] + (steer + dt[i]) * force
            u[i, j] = min(u[i, j] + dt[i] * v[i, j], wall[i, j])


@jit
def coupled_step(
    state: CoupledState,
    last_tangential: Reals,
    last_normal: Reals,
    friction: float,
    active: Indices,
    n: int,
    memory: float,
    push: float,
) -> None:
    """One Verlet step of all components with the hard wall and Coulomb friction (an infinite one sticks).

    Friction acts against the way slid from the `anchor`: where the punch held the node before this load, or where it
    last touched down (not-a-number while it does not touch). Its step is a proximal one without inertia, by half the
    push of a free node, which is stable for every mode: within what friction can hold of the anchor the node sticks to
    it, beyond it is drawn back by as much.
    """
    u1, anchor, k1, u3, k3, wall, load = state
    for i in active:
        for row in range(i, u1.shape[0], load.size):
            for j in range(n):  # as if nothing touched: quickly, and right for most nodes
                now = u1[row, j]
                u1[row, j] = now + memory * (now - last_tangential[row, j]) - push * k1[row, j]
                last_tangential[row, j] = now
                touches = friction > 0.0 and u3[i, j] >= wall[i, j] and load[i] - k3[i, j] > 0.0
                anchor[row, j] = anchor[row, j] if touches else np.nan
        for j in range(n):
            now = u3[i, j]
            pressure = load[i] - k3[i, j]
            u3[i, j] = min(now + memory * (now - last_normal[i, j]) + push * pressure, wall[i, j])
            last_normal[i, j] = now
            if friction > 0.0 and now >= wall[i, j] and pressure > 0.0:
                square = 0.0
                for row in range(i, u1.shape[0], load.size):
                    if np.isnan(anchor[row, j]):
                        anchor[row, j] = last_tangential[row, j]
                    square += (last_tangential[row, j] - 0.5 * push * k1[row, j] - anchor[row, j]) ** 2
                slid, held = np.sqrt(square), 0.5 * push * friction * pressure
                left = 1.0 - held / slid if slid > held else 0.0  # part of the way that friction cannot hold
                for row in range(i, u1.shape[0], load.size):
                    pulled = last_tangential[row, j] - 0.5 * push * k1[row, j] - anchor[row, j]
                    u1[row, j] = anchor[row, j] + left * pulled
