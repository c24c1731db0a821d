"""Damped dynamics of a batch towards equilibrium (thesis 2.4, appendix 2.A), whatever integrates it."""

from collections.abc import Callable
from typing import Protocol

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier.transform import Transform, aligned_rows
from gfmd_numba.solvers.certificate import Certificate
from gfmd_numba.solvers.integrators import Fire, gronbech_jensen, position_verlet
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.options import Options


def verlet_dynamics(batch: Batch, options: Options) -> "DampedDynamics":
    """Begin with the position Stormer-Verlet scheme."""
    settings = *_extremes(batch), options.number("time_step"), options.number("damping")
    return DampedDynamics(batch, lambda displacement: position_verlet(displacement, *settings))


def gronbech_jensen_dynamics(batch: Batch, options: Options) -> "DampedDynamics":
    """Begin with the scheme of Gronbech-Jensen and Farago."""
    settings = *_extremes(batch), options.number("time_step"), options.number("damping")
    return DampedDynamics(batch, lambda displacement: gronbech_jensen(displacement, *settings))


def fire_dynamics(batch: Batch, options: Options) -> "DampedDynamics":
    """Begin with the fast inertial relaxation engine."""
    stiffest, time_step = _extremes(batch)[1], options.number("time_step")
    return DampedDynamics(batch, lambda displacement: Fire(displacement, stiffest, time_step))


def _extremes(batch: Batch) -> tuple[float, float]:
    """Stiffness of the softest and of the stiffest mode, the latter with the laws."""
    softest, stiffest = batch.response.extremes()
    return softest, stiffest + batch.law_stiffness()


class Integrator(Protocol):
    """One step of the displacement u under the force load - ku, clipped at the wall."""

    def step(self, state: kernels.State, active: Indices, n: int) -> None: ...  # noqa: D102


class DampedDynamics:
    """Displacement of a batch and the traction that restores it; one forward and one inverse transform a step.

    `wall` is what the displacement may not pass; the law acts across the gap to the punch.
    """

    check_every = 10
    tangential: tuple[Reals, Reals, Reals] | None = None

    def __init__(self, batch: Batch, integrator: Callable[[Reals], Integrator]) -> None:
        rows, shape = len(batch.punch), batch.punch.shape[1:]
        punch, start = batch.punch.reshape(rows, -1), batch.start.displacement.reshape(rows, -1)
        interface = batch.interface
        self.load = batch.loads
        self.field = Transform(rows, *shape, dtype=punch.dtype)
        n = self.field.n
        self._punch = aligned_rows(rows, n, punch.dtype)
        self._punch[:, :n] = punch
        self.wall = self._punch if interface.hard_wall else np.full_like(self._punch, np.inf)
        (self.displacement,) = self.field.sources
        self.displacement[:, :n] = np.minimum(start, punch)
        self.restoring = self.field.result
        self._stiffness = self.field.symbol(batch.response.normal)
        self._law = interface.normal_law
        self.certificate = Certificate(rows)
        self._state = kernels.State(self.displacement, self.restoring, self.wall, self.load)
        self._integrator = integrator(self.displacement)
        self._restore(np.arange(rows))

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation."""
        return self.field.n_transforms

    def advance(self, active: Indices) -> None:
        """Make one time step in the active rows."""
        self._integrator.step(self._state, active, self.field.n)
        self._restore(active)

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions `[active]`; costs no transform."""
        field, strongest = self.field, np.zeros(active.size)
        self.certificate.look(self._state, active, field.n)
        if self._law is not None:
            gap = self._punch[active, : field.n] - self.displacement[active, : field.n]
            strongest = np.abs(self._law.traction(gap)).max(axis=1)
        return self.certificate.residual(self.load, active, strongest)

    def _restore(self, active: Indices) -> None:
        field = self.field
        field.apply(self._stiffness, active)
        if self._law is not None:
            self._law.pull(self.displacement, field.result, self._punch, active, field.n)
