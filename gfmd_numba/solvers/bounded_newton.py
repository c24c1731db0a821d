"""Active-set Newton method for a hard wall that yields: pressures have two bounds, 0 and the hardness."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices
from gfmd_numba.solvers.active_set_newton import ActiveSetNewton
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.last_pressure import UPHILL_FROM_THE_START, LastPressure
from gfmd_numba.solvers.options import Options

_FEW = 16  # nodes to and fro between their bounds: where more change sides, a step uphill mostly leads on


def bounded_newton(batch: Batch, options: Options) -> "BoundedNewton | None":
    """Begin under a hardness."""
    return None if batch.interface.hardness is None else BoundedNewton(batch, options)


class BoundedNewton(ActiveSetNewton):
    """Pressure of a batch between 0 and the hardness, found by guessing which nodes are at neither.

    Two bounds may send nodes to and fro between them. So a solution of the linear problem is followed by a step of
    all nodes along what is violated, to the nearest pressure between the bounds that carries the load (a projected
    gradient). A step that increases the energy is cut short where the energy is least. Where few
    nodes change sides, one that does so from its start is replaced by one towards the solution of the linear problem,
    as far as the first node reaches a bound.
    """

    def __init__(self, batch: Batch, options: Options) -> None:
        super().__init__(batch, options)
        self._last = LastPressure(self.pressure)
        self._careful = np.zeros(len(self.pressure), dtype=np.bool_)

    def _open_gap(self, row: Indices) -> None:
        super()._open_gap(row)
        i = row[0]
        p, gap = self.pressure[i], self.gap[i]
        uphill = self._last.damp(i, p, gap, self.field.n)
        if uphill == UPHILL_FROM_THE_START and self.changed[i] <= _FEW:
            p[:], gap[:] = self._last.pressure[i], self._last.gap[i]
            self._careful[i] = True
        elif uphill == UPHILL_FROM_THE_START:
            self._last.remember(i, p, gap)
        if uphill:
            self._contact[i] = (p > 0.0) & (p < self.hardness)

    def _revise(self, row: Indices, count: int) -> int:
        i, n, iterate = row[0], self.field.n, self.rows[row[0]]
        if self._careful[i]:
            self._careful[i] = False
            stopped = kernels.stop_at_first_bound(iterate.p, self._last.pressure[i], self._contact[i], self.hardness, n)
            if stopped:
                return int(stopped)
        square = kernels.wrong_gaps(iterate, self._nodes, count, n, self.rounding[i], self.free_mean)
        if square > 0.0:
            self.field.apply(self.compliance, row, source=1)
        changed = kernels.revise_bounds(
            iterate, square, self._contact[i], n, self.load[i], self.hardness, self.free_mean
        )
        return int(changed)

    def _balance(self) -> None:
        if self.free_mean:
            n = self.field.n
            for p, load in zip(self.pressure, self.load, strict=True):
                kernels.bound(p, np.ones(n, dtype=np.bool_), load * n, self.hardness, n)
