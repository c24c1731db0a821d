"""Compiled time steps of a displacement that is clipped at the hard wall."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit


@jit
def verlet_step(
    u: Reals,
    u_old: Reals,
    ku: Reals,
    punch: Reals,
    load: Reals,
    active: Indices,
    n: int,
    memory: float,
    push: float,
) -> None:
    """One Verlet step (6.55) with the displacement clipped at the hard wall (2.16)."""
    for i in active:
        for j in range(n):
            now = u[i, j]
            new = now + memory * (now - u_old[i, j]) + push * (load[i] - ku[i, j])
            u_old[i, j] = now
            u[i, j] = min(new, punch[i, j])


@jit
def fire_step(
    u: Reals,
    v: Reals,
    ku: Reals,
    punch: Reals,
    load: Reals,
    dt: Reals,
    mixing: Reals,
    downhill: Indices,
    active: Indices,
    n: int,
    longest: float,
) -> None:
    """One step of FIRE (Bitzek et al., Phys. Rev. Lett. 97:170201, 2006) with the hard wall.

    A node that the force holds against the wall has neither force nor velocity.
    """
    for i in active:
        power = 0.0
        speed2 = 0.0
        force2 = 0.0
        for j in range(n):
            force = load[i] - ku[i, j]
            if u[i, j] >= punch[i, j] and force >= 0.0:
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
            if u[i, j] >= punch[i, j] and force >= 0.0:
                continue
            v[i, j] = keep * v[i, j] + (steer + dt[i]) * force
            u[i, j] = min(u[i, j] + dt[i] * v[i, j], punch[i, j])


@jit
def coupled_step(
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
    """One Verlet step of both components with the hard wall and Coulomb friction (an infinite one sticks).

    Friction acts against the distance slid from the `anchor`: where the punch held the node before this load, or
    where it last touched down (not-a-number while it does not touch). Its step is a proximal one without inertia, by
    half the push of a free node, which is stable for every mode: within what friction can hold of the anchor the
    node sticks to it, beyond it is drawn back by as much.
    """
    for i in active:
        for j in range(n):
            pressure = load[i] - k3[i, j]
            now = u1[i, j]
            if friction > 0.0 and u3[i, j] >= wall[i, j] and pressure > 0.0:
                if np.isnan(anchor[i, j]):
                    anchor[i, j] = now
                slid = now - 0.5 * push * k1[i, j] - anchor[i, j]
                held = 0.5 * push * friction * pressure
                new = anchor[i, j]
                if abs(slid) > held:
                    new += slid - held if slid > 0.0 else slid + held
            else:
                anchor[i, j] = np.nan
                new = now + memory * (now - u1_old[i, j]) - push * k1[i, j]
            u1_old[i, j] = now
            u1[i, j] = new
            now = u3[i, j]
            new = now + memory * (now - u3_old[i, j]) + push * pressure
            u3_old[i, j] = now
            u3[i, j] = min(new, wall[i, j])
