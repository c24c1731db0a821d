"""Damped dynamics of normal and tangential displacement together, with sticking or Coulomb friction (thesis 2.4)."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.dynamics.certificate import Certificate
from gfmd_numba.dynamics.damping import critical_damping, stability_limit
from gfmd_numba.elasticity.surface import CoupledStiffness
from gfmd_numba.fourier import Convolution, aligned_rows

Reals = npt.NDArray[np.float64]
Rows = npt.NDArray[np.int64]


class CoupledRelaxation:
    """Both displacements of a batch and the tractions that restore them; two transform pairs a step.

    Rows of the field are tangential displacements, then normal ones. `friction` is Coulomb's coefficient: 0 lets
    touching nodes slide freely, infinity makes them stick. `anchor` is where the punch holds a node that touched it
    before, not-a-number for the others.
    """

    def __init__(
        self,
        punch: Reals,
        stiffness: CoupledStiffness,
        load: Reals,
        friction: float,
        start: Reals,
        tangential_start: Reals,
        anchor: Reals,
        time_step: float,
        damping: float,
    ) -> None:
        rows, n = punch.shape
        self._rows = rows
        self._friction = friction
        self.certificate = Certificate(rows)
        self.load = load
        self.field = Convolution(2 * rows, n)
        self.wall = aligned_rows(rows, n)
        self.wall[:, :n] = punch
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
        dt = time_step * stability_limit(softest, float(larger.max()), damping)
        self._push = dt * dt
        self._memory = 1.0 - damping * critical_damping(softest, dt) * dt * dt
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
        return certificate.residual(self.load, active)

    def _restore(self, active: Rows) -> None:
        both = np.concatenate((active, active + self._rows))
        self.field.forward(both)
        kernels.couple(self.field.spectrum, self._k11, self._k13, self._k33, active, self._rows)
        self.field.inverse(both)
