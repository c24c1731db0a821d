"""Damped dynamics of a batch towards equilibrium (thesis 2.4, appendix 2.A), whatever integrates it."""

from collections.abc import Callable
from typing import Protocol

import numpy as np
import numpy.typing as npt

from gfmd_numba.fourier.convolution import Convolution, aligned_rows
from gfmd_numba.interface.laws import Interface
from gfmd_numba.solvers.certificate import Certificate

Reals = npt.NDArray[np.float64]
Rows = npt.NDArray[np.int64]


class Integrator(Protocol):
    """One step of the displacement u under the force load - ku, clipped at the wall."""

    def step(self, u: Reals, ku: Reals, wall: Reals, load: Reals, active: Rows, n: int) -> None: ...  # noqa: D102


class Relaxation:
    """Displacement of a batch and the traction that restores it; one forward and one inverse transform a step.

    `load` is the mean pressure pushing the body against the punch `[realisation]`, zero where the displacement of
    the punch is prescribed instead. `wall` is what the displacement may not pass; the `law` acts across the gap
    to the punch.
    """

    check_every = 10

    def __init__(
        self,
        punch: Reals,
        stiffness: Reals,
        load: Reals,
        interface: Interface,
        start: Reals,
        integrator: Callable[[Reals], Integrator],
    ) -> None:
        rows, shape = len(punch), punch.shape[1:]
        punch, start = punch.reshape(rows, -1), start.reshape(rows, -1)
        self.load = load
        self.field = Convolution(rows, *shape, dtype=punch.dtype)
        n = self.field.n
        self._punch = aligned_rows(rows, n, punch.dtype)
        self._punch[:, :n] = punch
        self.wall = self._punch if interface.hard_wall else np.full_like(self._punch, np.inf)
        (self.displacement,) = self.field.sources
        self.displacement[:, :n] = np.minimum(start, punch)
        self.restoring = self.field.result
        self._stiffness = self.field.symbol(stiffness)
        self._law = interface.law
        self._strength = 0.0 if interface.law is None else abs(interface.law.strength)
        self.certificate = Certificate(rows)
        self._integrator = integrator(self.displacement)
        self._restore(np.arange(rows))

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation."""
        return self.field.n_transforms

    def advance(self, active: Rows) -> None:
        """Make one time step in the active rows."""
        field = self.field
        self._integrator.step(self.displacement, field.result, self.wall, self.load, active, field.n)
        self._restore(active)

    def residual(self, active: Rows) -> Reals:
        """Relative violation of the contact conditions `[active]`; costs no transform."""
        field = self.field
        self.certificate.look(self.displacement, field.result, self.wall, self.load, active, field.n)
        return self.certificate.residual(self.load, active, self._strength)

    def _restore(self, active: Rows) -> None:
        field = self.field
        field.apply(self._stiffness, active)
        if self._law is not None:
            self._law.pull(self.displacement, field.result, self._punch, active, field.n)
