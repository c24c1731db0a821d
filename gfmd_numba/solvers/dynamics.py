"""Damped dynamics of a batch towards equilibrium (thesis 2.4, appendix 2.A), of the normal displacement or of all.

The equation of motion is u'' = F - c u' with unit mass. Both Verlet schemes read
u[n+1] = u[n] + memory (u[n] - u[n-1]) + push F[n].
"""

import math
from collections.abc import Callable

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier.transform import aligned_rows
from gfmd_numba.interface import vector_slip
from gfmd_numba.solvers.certificate import Certificate
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.products import Products
from gfmd_numba.solvers.table import Options
from gfmd_numba.solvers.truncated_newton import starting_displacement
from gfmd_numba.theory.damping import critical_damping, stability_limit


def verlet(batch: Batch, options: Options) -> "Dynamics":
    """Begin with the position Stormer-Verlet scheme."""
    coefficients = position_verlet(*_extremes(batch), options.number("time_step"), options.number("damping"))
    return Dynamics(batch, lambda displacement: Verlet(displacement, *coefficients))


def gronbech_jensen_farago(batch: Batch, options: Options) -> "Dynamics":
    """Begin with the scheme of Gronbech-Jensen and Farago."""
    coefficients = gronbech_jensen(*_extremes(batch), options.number("time_step"), options.number("damping"))
    return Dynamics(batch, lambda displacement: Verlet(displacement, *coefficients))


def fire(batch: Batch, options: Options) -> "Dynamics":
    """Begin with the fast inertial relaxation engine."""
    longest = options.number("time_step") * 2.0 / math.sqrt(_extremes(batch)[1])
    return Dynamics(batch, lambda displacement: Fire(displacement[:, 0], longest))


def position_verlet(softest: float, stiffest: float, time_step: float, damping: float) -> tuple[float, float]:
    """Memory and push of the position Stormer-Verlet scheme with explicit damping (6.55).

    `time_step` is a fraction of the stability limit of the stiffest mode, `damping` of the critical damping of the
    softest.
    """
    dt = time_step * stability_limit(softest, stiffest, damping)
    return 1.0 - damping * critical_damping(softest, dt) * dt * dt, dt * dt


def gronbech_jensen(softest: float, stiffest: float, time_step: float, damping: float) -> tuple[float, float]:
    """Memory and push of the scheme of Gronbech-Jensen and Farago (Mol. Phys. 111:983, 2013), stable at any damping.

    With b = 1 / (1 + c dt / 2) it reads u[n+1] = 2 b u[n] - (2 b - 1) u[n-1] + b dt^2 F[n], for K dt^2 < 4; the roots
    of a mode coincide where b^2 (2 - K dt^2)^2 = 4 (2 b - 1).
    """
    dt2 = 4.0 * time_step**2 / stiffest
    x = softest * dt2
    # the root of that quadratic with b <= 1, rationalised so that x -> 0 and x -> 2 keep their digits
    critical = 2.0 / (2.0 + math.sqrt(x * (4.0 - x)))
    b = 1.0 / (1.0 + damping * (1.0 / critical - 1.0))
    return 2.0 * b - 1.0, b * dt2


def _extremes(batch: Batch) -> tuple[float, float]:
    """Stiffness of the softest and of the stiffest mode, the latter with the laws."""
    softest, stiffest = batch.response.extremes()
    return softest, stiffest + batch.law_stiffness()


class Verlet:
    """A batch's last displacements, what a step keeps of their velocity and how far a force pushes."""

    def __init__(self, displacement: Reals, memory: float, push: float) -> None:
        self._last, self._memory, self._push = displacement.copy(), memory, push

    def step(self, state: kernels.SurfaceState, limits: kernels.ContactLimits, active: Indices, n: int) -> None:
        """Make one step in the active rows."""
        kernels.verlet_step(state, self._last, active, n, self._memory, self._push)
        if limits.friction > 0.0:
            kernels.friction_step(state, self._last, limits, active, n, self._push)


class Fire:
    """Fast inertial relaxation engine: finds its own damping, and its own time step up to a longest one."""

    def __init__(self, displacement: Reals, longest: float) -> None:
        rows = len(displacement)
        self._velocity, self._longest = np.zeros_like(displacement), longest
        self._dt, self._mixing = np.full(rows, 0.1 * longest), np.full(rows, 0.1)
        self._downhill = np.zeros(rows, dtype=np.int64)

    def step(self, state: kernels.SurfaceState, limits: kernels.ContactLimits, active: Indices, n: int) -> None:
        """Make one step of the normal displacement in the active rows."""
        kernels.fire_step(state, self._velocity, self._dt, self._mixing, self._downhill, active, n, self._longest)


class Dynamics:
    """Displacements of a batch and the tractions that restore them; a transform pair of each component a step.

    The wall of the state is what the normal displacement may not pass; laws act across the gap to the punch. A node
    that touches is held at its anchor, wherever its own motion touches down.
    """

    check_every = 10

    def __init__(self, batch: Batch, integrator: "Callable[[Reals], Verlet | Fire]") -> None:
        interface, start, (rows, *shape) = batch.interface, batch.start, batch.punch.shape
        self._law, self._cohesive = interface.normal_law, interface.cohesive
        self._products = Products(batch.response, rows, tuple(shape))
        self.field, n = self._products.field, self._products.field.n
        u, along = self._products.displacement, self._products.components - 1
        self._punch = aligned_rows(rows, n)
        self._punch[:, :n] = batch.punch.reshape(rows, n)
        wall = self._punch if interface.hard_wall else np.full_like(self._punch, np.inf)
        anchor = np.full_like(u[:, :along], np.nan)
        if interface.friction:
            anchor[..., :n] = start.anchor.reshape(rows, along, n)
        u[:, :along, :n] = start.tangential[:, :along].reshape(rows, along, n)
        u[:, -1, :n] = self._without_overlap(batch).reshape(rows, n)
        if self._cohesive is not None:
            sliding = np.broadcast_to(batch.sliding, (along, *shape)).reshape(along, n)
            self._sliding = np.ascontiguousarray(sliding)
        self.state = kernels.SurfaceState(u, self._products.restoring, wall, batch.loads, anchor)
        self.certificate = Certificate(rows, interface.limits)
        self._integrator = integrator(u)
        self._restore(np.arange(rows))

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation."""
        return self._products.n_transforms

    def advance(self, active: Indices) -> None:
        """Make one time step in the active rows."""
        self._integrator.step(self.state, self.certificate.limits, active, self.field.n)
        self._restore(active)

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions `[active]`; costs no transform."""
        return self.certificate.look(self.state, active, self.field.n, self._strongest(active))

    def _strongest(self, active: Indices) -> Reals:
        """Largest traction of a law on each active row."""
        n, u, strongest = self.field.n, self.state.u, np.zeros(active.size)
        if self._law is None and self._cohesive is None:
            return strongest
        gap, tractions = self._punch[active, :n] - u[active, -1, :n], []
        if self._law is not None:
            tractions.append(self._law.traction(gap))
        if self._cohesive is not None:
            slip = vector_slip.length(self._sliding[:, np.newaxis] - u[active, :-1, :n].swapaxes(0, 1))
            with np.errstate(over="ignore", invalid="ignore"):  # of a run that diverges, as its status says
                tractions += [self._cohesive.normal_traction(gap, slip), self._cohesive.tangential_traction(gap, slip)]
        for traction in tractions:
            strongest = np.maximum(strongest, np.abs(traction).max(axis=1))
        return strongest

    def _without_overlap(self, batch: Batch) -> Reals:
        """Normal displacement to begin with: not beyond a wall, nor where the law repels by more than any pressure."""
        if batch.interface.hard_wall or self._cohesive is None:
            return np.minimum(batch.start.displacement, batch.punch)
        law, none = self._cohesive, np.zeros(batch.punch[0].size)
        return starting_displacement(batch, lambda gap: law.normal_traction(gap, none))

    def _restore(self, active: Indices) -> None:
        self._products.restore(active)
        u, ku, n = self.state.u, self.state.restoring, self.field.n
        if self._law is not None:
            with np.errstate(over="ignore", invalid="ignore"):  # of a run that diverges, as its status says
                ku[active, -1, :n] -= self._law.traction(self._punch[active, :n] - u[active, -1, :n])
        if self._cohesive is not None:
            self._cohesive.pull(self.state, self._punch, self._sliding, active, n)
