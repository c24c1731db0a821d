"""Damped dynamics of normal and tangential displacement together, with sticking or Coulomb friction (thesis 2.4)."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.fourier.convolution import Convolution, aligned_rows
from gfmd_numba.solvers.certificate import Certificate
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.options import Options
from gfmd_numba.theory.damping import critical_damping, stability_limit

Rows = npt.NDArray[np.int64]


class CoupledDynamics:
    """Both displacements of a batch and the tractions that restore them; two transform pairs a step.

    Rows of the field are tangential displacements, then normal ones. `anchor` is where the punch holds a node that
    touched it before, not-a-number for the others; `sliding` the tangential displacement of the punch.
    """

    check_every = 10

    def __init__(self, batch: Batch, options: Options) -> None:
        punch, stiffness, interface, start = batch.punch, batch.coupled_stiffness, batch.interface, batch.start
        rows, n = punch.shape
        self._rows = rows
        self._friction = interface.friction or 0.0
        self._law = interface.normal_law
        self._cohesion = interface.cohesive
        self._sliding = batch.sliding
        self.certificate = Certificate(rows)
        self.load = batch.loads
        self.field = Convolution(2 * rows, n)
        self._punch = aligned_rows(rows, n)
        self._punch[:, :n] = punch
        self.wall = self._punch if interface.hard_wall else np.full_like(self._punch, np.inf)
        (both,) = self.field.sources
        self._tangential, self.displacement = both[:rows], both[rows:]
        self._tangential[:, :n] = start.tangential
        self.displacement[:, :n] = np.minimum(start.displacement, punch)
        self._last = both.copy()
        self._anchor = np.full_like(self._tangential, np.nan)
        self._anchor[:, :n] = start.anchor
        self._tangential_restoring, self.restoring = self.field.result[:rows], self.field.result[rows:]
        self._k11, self._k13, self._k33 = (self.field.symbol(k) for k in (stiffness.k11, stiffness.k13, stiffness.k33))
        smaller, larger = stiffness.principal()
        softest = float(smaller[smaller > 0.0].min())
        stiffest = float(larger.max()) + batch.law_stiffness()
        time_step, damping = options.number("time_step"), options.number("damping")
        dt = time_step * stability_limit(softest, stiffest, damping)
        self._push = dt * dt
        self._memory = 1.0 - damping * critical_damping(softest, dt) * dt * dt
        self._restore(np.arange(rows))

    @property
    def tangential(self) -> tuple[Reals, Reals]:
        """Tangential displacement of the body and the traction that restores it."""
        return self._tangential, self._tangential_restoring

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation."""
        return self.field.n_transforms[: self._rows] + self.field.n_transforms[self._rows :]

    def advance(self, active: Rows) -> None:
        """Make one time step in the active rows."""
        last_tangential, last_normal = self._last[: self._rows], self._last[self._rows :]
        kernels.coupled_step(
            self._tangential, last_tangential, self._anchor, self._tangential_restoring, self.displacement, last_normal,
            self.restoring, self.wall, self.load, self._friction, active, self.field.n, self._memory, self._push,
        )  # fmt: skip
        self._restore(active)

    def residual(self, active: Rows) -> Reals:
        """Relative violation of the normal and tangential conditions `[active]`; costs no transform."""
        n, certificate = self.field.n, self.certificate
        certificate.look(self.displacement, self.restoring, self.wall, self.load, active, n)
        kernels.friction_violation(
            self._tangential, self._anchor, self._tangential_restoring, self.displacement, self.restoring, self.wall,
            self.load, self._friction, active, n, certificate.worst,
        )  # fmt: skip
        return certificate.residual(self.load, active, self._strongest(active))

    def _strongest(self, active: Rows) -> Reals:
        """Largest traction of a law on each active row."""
        n = self.field.n
        gap, strongest = self._punch[active, :n] - self.displacement[active, :n], np.zeros(active.size)
        tractions: list[Reals] = []
        if self._law is not None:
            tractions.append(self._law.traction(gap))
        if self._cohesion is not None:
            slip = self._sliding - self._tangential[active, :n]
            tractions += [self._cohesion.normal_traction(gap, slip), self._cohesion.tangential_traction(gap, slip)]
        for traction in tractions:
            strongest = np.maximum(strongest, np.abs(traction).max(axis=1))
        return strongest

    def _restore(self, active: Rows) -> None:
        both = np.concatenate((active, active + self._rows))
        self.field.forward(both)
        kernels.couple(self.field.spectrum, self._k11, self._k13, self._k33, active, self._rows)
        self.field.inverse(both)
        if self._law is not None:
            self._law.pull(self.displacement, self.restoring, self._punch, active, self.field.n)
        if self._cohesion is not None:
            self._cohesion.pull(
                self._tangential, self._tangential_restoring, self.displacement, self.restoring, self._punch,
                self._sliding, active, self.field.n,
            )  # fmt: skip
