"""Integrators of u'' = F - c u' for a batch whose displacement is clipped at the wall, unit mass.

Both Verlet schemes read u[n+1] = u[n] + memory (u[n] - u[n-1]) + push F[n].
"""

import math

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.theory.damping import critical_damping, stability_limit


class Verlet:
    """A batch's last displacement, what a step keeps of its velocity and how far a force pushes."""

    def __init__(self, displacement: Reals, memory: float, push: float) -> None:
        self._last = displacement.copy()
        self.memory = memory
        self.push = push

    def step(self, state: kernels.State, active: Indices, n: int) -> None:
        """Make one step in the active rows."""
        kernels.verlet_step(state, self._last, active, n, self.memory, self.push)


def position_verlet(displacement: Reals, softest: float, stiffest: float, time_step: float, damping: float) -> Verlet:
    """Position Stormer-Verlet with explicit damping (6.55).

    `time_step` is a fraction of the stability limit of the stiffest mode, `damping` of the critical damping of the
    softest.
    """
    dt = time_step * stability_limit(softest, stiffest, damping)
    eta = damping * critical_damping(softest, dt)
    return Verlet(displacement, memory=1.0 - eta * dt * dt, push=dt * dt)


def gronbech_jensen(displacement: Reals, softest: float, stiffest: float, time_step: float, damping: float) -> Verlet:
    """Gronbech-Jensen and Farago's integrator (Mol. Phys. 111:983, 2013), stable for K dt^2 < 4 at any damping.

    With b = 1 / (1 + c dt / 2) it reads u[n+1] = 2 b u[n] - (2 b - 1) u[n-1] + b dt^2 F[n]; the roots of a mode
    coincide where b^2 (2 - K dt^2)^2 = 4 (2 b - 1).
    """
    dt2 = 4.0 * time_step**2 / stiffest
    x = softest * dt2
    # the root of that quadratic with b <= 1, rationalised so that x -> 0 and x -> 2 keep their digits
    critical = 2.0 / (2.0 + math.sqrt(x * (4.0 - x)))
    b = 1.0 / (1.0 + damping * (1.0 / critical - 1.0))
    return Verlet(displacement, memory=2.0 * b - 1.0, push=b * dt2)


class Fire:
    """Fast inertial relaxation engine: finds its own damping, and its own time step up to a longest one."""

    def __init__(self, displacement: Reals, stiffest: float, time_step: float) -> None:
        rows = len(displacement)
        self._velocity = np.zeros_like(displacement)
        self._longest = time_step * 2.0 / math.sqrt(stiffest)
        self._dt = np.full(rows, 0.1 * self._longest)
        self._mixing = np.full(rows, 0.1)
        self._downhill = np.zeros(rows, dtype=np.int64)

    def step(self, state: kernels.State, active: Indices, n: int) -> None:
        """Make one step in the active rows."""
        kernels.fire_step(state, self._velocity, self._dt, self._mixing, self._downhill, active, n, self._longest)
