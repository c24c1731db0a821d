"""Damped dynamics: position Stormer-Verlet with hard-wall projection (thesis 2.4, appendix 2.A)."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.dynamics.damping import critical_damping, stability_limit
from gfmd_numba.fourier import Convolution, aligned_rows

Reals = npt.NDArray[np.float64]
Rows = npt.NDArray[np.int64]


class Verlet:
    """Displacement and velocity of a batch; one forward and one inverse transform a step.

    `load` is the mean pressure pushing the body against the punch `[realisation]`, zero where the displacement of
    the punch is prescribed instead.
    """

    def __init__(self, punch: Reals, stiffness: Reals, load: Reals, time_step: float, damping: float) -> None:
        rows, n = punch.shape
        elastic = stiffness[stiffness > 0.0]
        softest, stiffest = float(elastic.min()), float(elastic.max())
        dt = time_step * stability_limit(softest, stiffest, damping)
        self.dt2 = dt * dt
        self.eta = damping * critical_damping(softest, dt)
        self.load = load
        self.field = Convolution(rows, n)
        self.punch = aligned_rows(rows, n)
        self.punch[:, :n] = punch
        self._stiffness = self.field.symbol(stiffness)
        (self.displacement,) = self.field.sources
        self.displacement[:, :n] = np.minimum(punch, 0.0)
        self._u_old = self.displacement.copy()
        self.field.apply(self._stiffness, np.arange(rows))

    def advance(self, active: Rows) -> None:
        """Make one time step in the active rows."""
        field = self.field
        kernels.verlet_step(
            self.displacement, self._u_old, field.result, self.punch, self.load, active, field.n, self.dt2, self.eta
        )
        field.apply(self._stiffness, active)

    def violation(self, active: Rows) -> Reals:
        """Largest violation of the contact conditions, in E* `[active]`; costs no transform."""
        field = self.field
        worst = np.empty(self.load.size)
        kernels.kkt_violation(self.displacement, field.result, self.punch, self.load, active, field.n, worst)
        return worst[active]
