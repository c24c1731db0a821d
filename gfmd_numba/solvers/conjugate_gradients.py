"""Constrained conjugate gradients on the pressure (Polonsky & Keer, Wear 231:206, 1999)."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.pressures import UPHILL_FROM_THE_START, LastPressure, PressureIterate
from gfmd_numba.solvers.table import Options


class ConjugateGradients(PressureIterate):
    """Pressure of a batch; two forward and two inverse transforms an iteration.

    Under a hardness each step goes to the nearest pressure between the bounds that carries the load, and is cut short
    where it would increase the energy.
    """

    check_every = 10

    def __init__(self, batch: Batch, options: Options) -> None:
        super().__init__(batch)
        rows = len(batch.punch)
        self._search = np.zeros((3, rows))
        self._free = np.zeros((rows, self.field.n), dtype=np.uint32), np.zeros(rows, dtype=np.int64)
        self._is_open = False  # whether the gap is that of the pressure
        self._last = LastPressure(self.pressure) if self.hardness < np.inf else None
        kernels.cg_free(self.pressure, self.direction, *self._free, np.arange(rows), self.field.n, self.hardness)

    def advance(self, active: Indices) -> None:
        """Make one iteration in the active rows."""
        if not self._is_open:
            self._open_gap(active)
        kernels.cg_direction(self.gap, self.direction, *self._free, self._search, self.rounding, active, self.free_mean)
        self.field.apply(self.compliance, active, source=1)
        kernels.cg_update(self.iterate, *self._free, self._search, self.load, active, self.free_mean, self.hardness)
        self._is_open = False

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions; costs four transforms a row, two for the next step."""
        self._open_gap(active)
        self._is_open = True
        return super().residual(active)

    def _open_gap(self, active: Indices) -> None:
        field, n = self.field, self.field.n
        field.apply(self.compliance, active, source=0)
        if self._last is None:
            kernels.cg_gap(field.result, self.wall, self.gap, *self._free, active, n, self.free_mean)
            return
        for i in active:
            p, gap = self.pressure[i], self.gap[i]
            np.add(self.wall[i, :n], field.result[i, :n], out=gap[:n])
            uphill = self._last.line_search(i, p, gap, n)
            if uphill:
                self._search[2, i] = 0.0
            if uphill == UPHILL_FROM_THE_START:
                self._last.remember(i, p, gap)
            if self.free_mean:
                kernels.level(p, gap, self.hardness, n)
        kernels.cg_free(self.pressure, self.direction, *self._free, active, n, self.hardness)
