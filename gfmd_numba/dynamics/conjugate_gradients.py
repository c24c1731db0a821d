"""Constrained conjugate gradients on the pressure (Polonsky & Keer, Wear 231:206, 1999)."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.dynamics.certificate import Certificate
from gfmd_numba.fourier import Convolution, aligned_rows

Reals = npt.NDArray[np.float64]
Rows = npt.NDArray[np.int64]


class ConjugateGradients:
    """Pressure of a batch; two forward and two inverse transforms an iteration.

    `load` is the prescribed mean pressure `[realisation]`, or None where the displacement of the punch is
    prescribed; only then may the stiffness at q = 0 be non-zero (or infinite, for an incompressible slab).
    """

    def __init__(self, punch: Reals, stiffness: Reals, load: Reals | None) -> None:
        rows, n = punch.shape
        self._free_mean = load is not None
        self._rigid_mean = not np.isfinite(stiffness[0])
        self.field = Convolution(rows, n, sources=3)
        self._p, self._direction, self.displacement = self.field.sources
        self.restoring = self.field.result
        self.wall = aligned_rows(rows, n)
        self.wall[:, :n] = punch
        softest = stiffness[1] if self._free_mean or self._rigid_mean else stiffness[0]
        start = -softest * punch.min(axis=1) if load is None else load
        self.load = np.zeros(rows) if load is None else load
        self._p[:, :n] = start[:, np.newaxis]
        with np.errstate(divide="ignore"):
            compliance = np.where(stiffness > 0.0, 1.0 / stiffness, 0.0)
        self._compliance = self.field.symbol(compliance)
        self._stiffest = float(stiffness[np.isfinite(stiffness)].max())
        self._stiffness = self.field.symbol(np.where(np.isfinite(stiffness), stiffness, 0.0))
        self._gap = aligned_rows(rows, n)
        self.certificate = Certificate(rows)
        self._rounding = np.finfo(float).eps * np.ptp(punch, axis=1)
        self._norm = np.zeros(rows)
        self._step = np.zeros(rows)
        self._keep = np.zeros(rows)

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation."""
        return self.field.n_transforms

    def advance(self, active: Rows) -> None:
        """Make one iteration in the active rows."""
        self._open_gap(active)
        field, n = self.field, self.field.n
        kernels.cg_direction(
            self._p, self._gap, self._direction, self._norm, self._keep, self._rounding, active, n,
            self._free_mean,
        )  # fmt: skip
        field.apply(self._compliance, active, source=1)
        kernels.cg_update(
            self._p, field.result, self._gap, self._direction, self.load, self._step, self._keep, active, n,
            self._free_mean,
        )  # fmt: skip

    def residual(self, active: Rows) -> Reals:
        """Relative violation of the contact conditions by the nearest displacement that does not penetrate.

        Leaves it in `displacement` and its restoring traction in `restoring`; costs four transforms a row.
        """
        self._open_gap(active)
        field, n = self.field, self.field.n
        kernels.close_gap(self._p, self._gap, self.wall, active, n, self.displacement)
        field.apply(self._stiffness, active, source=2)
        if self._rigid_mean:  # no displacement tells the mean pressure: it is the multiplier of a zero mean
            self.load[active] = self._p[active, :n].mean(axis=1)
        self.certificate.look(self.displacement, field.result, self.wall, self.load, active, n)
        if self._rigid_mean:
            drift = self._stiffest * np.abs(self.displacement[active, :n].mean(axis=1))
            self.certificate.worst[active] = np.maximum(self.certificate.worst[active], drift)
        return self.certificate.residual(self.load, active)

    def _open_gap(self, active: Rows) -> None:
        field = self.field
        field.apply(self._compliance, active, source=0)
        kernels.cg_gap(self._p, field.result, self.wall, self._gap, active, field.n, self._free_mean)
