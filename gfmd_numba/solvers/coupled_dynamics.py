"""Damped dynamics of normal and tangential displacement together, with sticking or Coulomb friction (thesis 2.4)."""

import math

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.elasticity.coupled_stiffness import CoupledStiffness
from gfmd_numba.fourier.convolution import Convolution, aligned_rows
from gfmd_numba.interface.laws import Interface
from gfmd_numba.solvers.certificate import Certificate
from gfmd_numba.theory.damping import critical_damping, stability_limit

Reals = npt.NDArray[np.float64]
Rows = npt.NDArray[np.int64]


class CoupledRelaxation:
    """Both displacements of a batch and the tractions that restore them; two transform pairs a step.

    Rows of the field are tangential displacements, then normal ones. `anchor` is where the punch holds a node that
    touched it before, not-a-number for the others; `sliding` the tangential displacement of the punch.
    """

    check_every = 10

    def __init__(
        self,
        punch: Reals,
        stiffness: CoupledStiffness,
        load: Reals,
        interface: Interface,
        sliding: float,
        start: Reals,
        tangential_start: Reals,
        anchor: Reals,
        time_step: float,
        damping: float,
        largest_pressure: float,
    ) -> None:
        rows, n = punch.shape
        self._rows = rows
        self._friction = interface.friction or 0.0
        self._law = interface.law
        self._cohesion = interface.cohesion
        self._sliding = sliding
        self.certificate = Certificate(rows)
        self.load = load
        self.field = Convolution(2 * rows, n)
        self._punch = aligned_rows(rows, n)
        self._punch[:, :n] = punch
        self.wall = self._punch if interface.hard_wall else np.full_like(self._punch, np.inf)
        (both,) = self.field.sources
        self.tangential, self.displacement = both[:rows], both[rows:]
        self.tangential[:, :n] = tangential_start
        self.displacement[:, :n] = np.minimum(start, punch)
        self._last = both.copy()
        self._anchor = np.full_like(self.tangential, np.nan)
        self._anchor[:, :n] = anchor
        self.tangential_restoring, self.restoring = self.field.result[:rows], self.field.result[rows:]
        self._k11, self._k13, self._k33 = (self.field.symbol(k) for k in (stiffness.k11, stiffness.k13, stiffness.k33))
        smaller, larger = stiffness.principal()
        softest = float(smaller[smaller > 0.0].min())
        stiffest = float(larger.max())
        for law in (interface.law, interface.cohesion):
            stiffest += 0.0 if law is None else law.stiffest(largest_pressure, interface.hard_wall)
        dt = time_step * stability_limit(softest, stiffest, damping)
        self._push = dt * dt
        self._memory = 1.0 - damping * critical_damping(softest, dt) * dt * dt
        # tractions of a law may be far larger than the pressure: that of the largest attraction is a floor to it
        self._strength = 0.0 if interface.law is None else abs(interface.law.strength)
        if interface.cohesion is not None:
            self._strength = interface.cohesion.work / interface.cohesion.normal / math.e
        self._restore(np.arange(rows))

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation."""
        return self.field.n_transforms[: self._rows] + self.field.n_transforms[self._rows :]

    def advance(self, active: Rows) -> None:
        """Make one time step in the active rows."""
        last_tangential, last_normal = self._last[: self._rows], self._last[self._rows :]
        kernels.coupled_step(
            self.tangential, last_tangential, self._anchor, self.tangential_restoring, self.displacement, last_normal,
            self.restoring, self.wall, self.load, self._friction, active, self.field.n, self._memory, self._push,
        )  # fmt: skip
        self._restore(active)

    def residual(self, active: Rows) -> Reals:
        """Relative violation of the normal and tangential conditions `[active]`; costs no transform."""
        n, certificate = self.field.n, self.certificate
        certificate.look(self.displacement, self.restoring, self.wall, self.load, active, n)
        kernels.friction_violation(
            self.tangential, self._anchor, self.tangential_restoring, self.displacement, self.restoring, self.wall,
            self.load, self._friction, active, n, certificate.worst,
        )  # fmt: skip
        return certificate.residual(self.load, active, self._strength)

    def _restore(self, active: Rows) -> None:
        both = np.concatenate((active, active + self._rows))
        self.field.forward(both)
        kernels.couple(self.field.spectrum, self._k11, self._k13, self._k33, active, self._rows)
        self.field.inverse(both)
        if self._law is not None:
            self._law.pull(self.displacement, self.restoring, self._punch, active, self.field.n)
        if self._cohesion is not None:
            self._cohesion.pull(
                self.tangential, self.tangential_restoring, self.displacement, self.restoring, self._punch,
                self._sliding, active, self.field.n,
            )  # fmt: skip
