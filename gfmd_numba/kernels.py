"""Compiled loops over batches `[realisation, x]`; every function works in place on the rows listed in `active`.

Rows may be longer than the `n` samples they hold (padding keeps each row aligned for the transforms).
"""

from typing import Any

import numpy as np
import numpy.typing as npt
from numba import njit

Reals = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
Rows = npt.NDArray[np.int64]
jit: Any = njit(cache=True, error_model="numpy")


@jit
def multiply(spectrum: Complexes, symbol: Reals, active: Rows) -> None:
    """Multiply each active spectrum by a real symbol of the wave number."""
    for i in active:
        for k in range(symbol.size):
            spectrum[i, k] *= symbol[k]


@jit
def exponential_pull(u: Reals, ku: Reals, punch: Reals, active: Rows, n: int, strength: float, length: float) -> None:
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
    sliding: float,
    active: Rows,
    n: int,
    work: float,
    normal: float,
    tangential: float,
) -> None:
    """Take the tractions of Xu and Needleman's law off the restoring tractions k1 and k3."""
    for i in active:
        for j in range(n):
            gap = (punch[i, j] - u3[i, j]) / normal
            slip = (sliding - u1[i, j]) / tangential
            decay = work * np.exp(-gap - slip * slip)
            k1[i, j] -= 2.0 * slip / tangential * (1.0 + gap) * decay
            k3[i, j] -= gap / normal * decay


@jit
def verlet_step(
    u: Reals,
    u_old: Reals,
    ku: Reals,
    punch: Reals,
    load: Reals,
    active: Rows,
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
    downhill: Rows,
    active: Rows,
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
def kkt_violation(
    u: Reals,
    ku: Reals,
    punch: Reals,
    load: Reals,
    active: Rows,
    n: int,
    worst: Reals,
    peak: Reals,
    imbalance: Reals,
) -> None:
    """Largest traction on a free node or tension on a touching one, largest pressure, and mean unbalanced traction.

    For displacements that do not penetrate; not-a-number if any traction is not finite.
    """
    for i in active:
        largest = 0.0
        highest = 0.0
        total = 0.0  # a NaN or infinity anywhere survives in a sum, not in a comparison
        carried = 0.0
        for j in range(n):
            traction = load[i] - ku[i, j]
            total += traction
            pressure = max(traction, 0.0) if u[i, j] >= punch[i, j] else 0.0
            carried += pressure
            highest = max(highest, pressure)
            largest = max(largest, abs(traction - pressure))
        worst[i] = largest if np.isfinite(total) else np.nan
        peak[i] = highest
        imbalance[i] = abs(total - carried) / n


@jit
def wall_pressure(u: Reals, ku: Reals, punch: Reals, load: Reals, active: Rows, n: int, p: Reals) -> None:
    """Pressure of the hard wall: on touching nodes under compression, zero elsewhere."""
    for i in active:
        for j in range(n):
            p[i, j] = max(load[i] - ku[i, j], 0.0) if u[i, j] >= punch[i, j] else 0.0


@jit
def cg_gap(p: Reals, sp: Reals, punch: Reals, gap: Reals, active: Rows, n: int, free_mean: bool) -> None:
    """Gap left by the pressure p whose displacement is sp (Polonsky & Keer 1999, eqs 5-6).

    `free_mean`: the load is prescribed, so the gap is known up to the approach, which the touching nodes fix.
    """
    for i in active:
        approach = 0.0
        if free_mean:
            touching = 0
            for j in range(n):
                if p[i, j] > 0.0:
                    approach += punch[i, j] + sp[i, j]
                    touching += 1
            approach /= touching
        for j in range(n):
            gap[i, j] = punch[i, j] + sp[i, j] - approach


@jit
def cg_direction(
    p: Reals,
    gap: Reals,
    t: Reals,
    norm: Reals,
    keep: Reals,
    rounding: Reals,
    active: Rows,
    n: int,
    free_mean: bool,
) -> None:
    """Conjugate direction on the touching nodes (Polonsky & Keer 1999, eq. 7).

    Nodes that left or joined the contact spoil the old direction in two ways. Under a prescribed load it may now
    change the load, which rescaling the pressure would undo: it loses its mean. And it may lead uphill: it is
    then dropped. Gaps within `rounding` of closed point nowhere: the direction is then zero.
    """
    for i in active:
        new_norm = 0.0
        downhill = 0.0
        mean = 0.0
        touching = 0
        for j in range(n):
            if p[i, j] > 0.0:
                new_norm += gap[i, j] * gap[i, j]
                downhill += gap[i, j] * t[i, j]
                mean += t[i, j]
                touching += 1
        mean = mean / touching if free_mean else 0.0
        beta = keep[i] * new_norm / norm[i] if norm[i] > 0.0 else 0.0
        if new_norm + beta * downhill <= 0.0:
            beta = 0.0
        closed = new_norm <= touching * rounding[i] ** 2
        for j in range(n):
            moves = p[i, j] > 0.0 and not closed
            t[i, j] = gap[i, j] + beta * (t[i, j] - mean) if moves else 0.0
        norm[i] = new_norm


@jit
def cg_update(
    p: Reals,
    st: Reals,
    gap: Reals,
    t: Reals,
    load: Reals,
    step: Reals,
    keep: Reals,
    active: Rows,
    n: int,
    free_mean: bool,
) -> None:
    """Line search, clipping, overlap correction and load balance (Polonsky & Keer 1999, eqs 8-12)."""
    for i in active:
        mean = 0.0
        if free_mean:
            touching = 0
            for j in range(n):
                if p[i, j] > 0.0:
                    mean += st[i, j]
                    touching += 1
            mean /= touching
        gt = 0.0
        rt = 0.0
        for j in range(n):
            if p[i, j] > 0.0:
                gt += gap[i, j] * t[i, j]
                rt += (st[i, j] - mean) * t[i, j]
        if rt > 0.0:  # a single touching node has no direction of its own: it keeps the last step
            step[i] = gt / rt
        overlap = False
        total = 0.0
        for j in range(n):
            new = p[i, j]
            if new > 0.0:
                new = max(new - step[i] * t[i, j], 0.0)
            if new == 0.0 and gap[i, j] < 0.0:
                overlap = True
                new = -step[i] * gap[i, j]
            p[i, j] = new
            total += new
        keep[i] = 0.0 if overlap else 1.0
        if free_mean:
            scale = load[i] * n / total
            for j in range(n):
                p[i, j] *= scale


@jit
def close_gap(p: Reals, gap: Reals, punch: Reals, active: Rows, n: int, u: Reals) -> None:
    """Displacement that touches wherever there is pressure or overlap, and never penetrates."""
    for i in active:
        for j in range(n):
            u[i, j] = punch[i, j] - (0.0 if p[i, j] > 0.0 else max(gap[i, j], 0.0))


@jit
def couple(spectrum: Complexes, k11: Reals, k13: Reals, k33: Reals, active: Rows, rows: int) -> None:
    """Restoring tractions of tangential (row i) and normal (row rows + i) displacement, in place (6.57).

    The phase is that of coefficients of exp(+i q x) with the normal displacement out of the body: a compressed
    stretch draws the surface together.
    """
    for i in active:
        for k in range(k11.size):
            tangential, normal = spectrum[i, k], spectrum[rows + i, k]
            spectrum[i, k] = k11[k] * tangential + 1j * k13[k] * normal
            spectrum[rows + i, k] = k33[k] * normal - 1j * k13[k] * tangential


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
    active: Rows,
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


@jit
def friction_violation(
    u1: Reals,
    anchor: Reals,
    k1: Reals,
    u3: Reals,
    k3: Reals,
    wall: Reals,
    load: Reals,
    friction: float,
    active: Rows,
    n: int,
    worst: Reals,
) -> None:
    """Raise `worst` to the largest tangential force that friction does not balance.

    Free nodes have none, sticking nodes less than friction times pressure, sliding ones exactly that against the
    distance slid.
    """
    for i in active:
        largest = 0.0
        total = 0.0
        for j in range(n):
            total += k1[i, j]
            violation = abs(k1[i, j])
            pressure = load[i] - k3[i, j]
            if friction > 0.0 and u3[i, j] >= wall[i, j] and pressure > 0.0:
                slid = u1[i, j] - anchor[i, j]
                if slid > 0.0:
                    violation = abs(k1[i, j] + friction * pressure)
                elif slid < 0.0:
                    violation = abs(k1[i, j] - friction * pressure)
                else:
                    violation = max(violation - friction * pressure, 0.0)
            largest = max(largest, violation)
        worst[i] = max(worst[i], largest) if np.isfinite(total) and np.isfinite(worst[i]) else np.nan
