"""Active-set Newton method for a hard wall that yields: pressures have two bounds, 0 and the hardness."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.solvers.active_set_newton import ActiveSetNewton
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.last_pressure import LastPressure
from gfmd_numba.solvers.options import Options

Rows = npt.NDArray[np.int64]


def newton(batch: Batch, options: Options) -> ActiveSetNewton:
    """Begin the method for as many bounds as the pressure has."""
    return ActiveSetNewton(batch, options) if batch.interface.hardness is None else BoundedNewton(batch, options)


class BoundedNewton(ActiveSetNewton):
    """Pressure of a batch between 0 and the hardness, found by guessing which nodes are at neither.

    Two bounds may send nodes to and fro between them. So a solution of the linear problem is followed by a step of
    all nodes along what is violated, to the nearest pressure between the bounds that carries the load (a projected
    gradient); and a step that does not decrease the energy is cut short where the energy is least.
    """

    def __init__(self, batch: Batch, options: Options) -> None:
        super().__init__(batch, options)
        self._last = LastPressure(self.pressure)

    def _open_gap(self, row: Rows) -> None:
        super()._open_gap(row)
        i = row[0]
        p = self.pressure[i]
        if self._last.damp(i, p, self.gap[i], self.field.n):
            self._contact[i] = (p > 0.0) & (p < self.hardness)

    def _revise(self, row: Rows, count: int) -> int:
        i, n, t = row[0], self.field.n, self.direction[row[0]]
        square = kernels.wrong_gaps(
            self.pressure[i], self.gap[i], self._nodes, count, n, self.rounding[i], self.free_mean, t
        )
        if square > 0.0:
            self.field.apply(self.compliance, row, source=1)
        changed = kernels.revise_bounds(
            self.pressure[i], self.gap[i], t, self.field.result[i], square, self._contact[i], n, self.load[i],
            self.hardness, self.free_mean,
        )  # fmt: skip
        return int(changed)

    def _balance(self) -> None:
        if self.free_mean:
            n = self.field.n
            for p, load in zip(self.pressure, self.load, strict=True):
                kernels.bound(p, np.ones(n, dtype=np.bool_), load * n, self.hardness, n)
