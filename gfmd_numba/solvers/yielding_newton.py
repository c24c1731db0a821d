"""Truncated Newton method under a hardness: nodes at it penetrate, and a law of the gap acts on them as at gap 0."""

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.solvers.active_set_newton import ActiveSetNewton
from gfmd_numba.solvers.bounded_newton import newton
from gfmd_numba.solvers.decay_newton import DecayNewton
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.map_newton import MapNewton
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.truncated_newton import TruncatedNewton


def truncated_newton(batch: Batch, options: Options) -> TruncatedNewton | ActiveSetNewton | DecayNewton | MapNewton:
    """Begin the method for as many bounds as the pressure of the wall has.

    Without a law, an energy that is made of kinks may hardly curve; the pressures are then found by their active sets.
    """
    if batch.interface.hardness is None:
        return TruncatedNewton(batch, options)
    return newton(batch, options) if batch.interface.normal_law is None else YieldingNewton(batch, options)


class YieldingNewton(TruncatedNewton):
    """Displacement of a batch that descends its energy, to which penetration adds the hardness times its depth.

    That energy has a kink where a node touches the wall. So each Newton step leaves every node on its side: nodes that
    yield, as they penetrate or press on the wall by more than the hardness, are pushed back by the hardness and stop at
    the wall from behind; the others stop at it from before. A node at the wall that presses by less is held. A node
    that yields has no gap, so that its law pulls as it does at gap 0.
    """

    def _begin(self, batch: Batch, options: Options, normal: slice, reach: float) -> None:
        self._yields = np.zeros((len(batch.punch), self.field.n), dtype=np.bool_)
        super()._begin(batch, options, normal, reach)

    def _pull(self, i: int) -> Reals:
        self._closing[self._normal] = self._law.traction(np.maximum(self._gap(i), 0.0))
        return self._closing

    def _fill_curvature(self, i: int) -> None:
        super()._fill_curvature(i)
        self._curvature[self._normal][self._yields[i]] = 0.0

    def _change(self, i: int) -> float:
        """Change of the law's energy, which goes on as its tangent at gap 0 where nodes penetrate."""
        yields, closing = self._yields[i], self._closing[self._normal]
        gap, approach = (np.where(yields, 0.0, each) for each in (self._gap(i), closing))
        along_tangent = self._law.strength * closing[yields].sum()
        return float(self._law.energy_change(gap, approach).sum() - along_tangent)

    def _project(self, i: int) -> None:
        """Stop yielding nodes of the trial of a row at the wall."""
        trial = self._source[i, self._normal]
        np.maximum(trial, self._punch[i], out=trial, where=self._yields[i])

    def _shift_load(self, i: int) -> None:
        super()._shift_load(i)
        self._load[i, self._normal] -= self.certificate.hardness * self._yields[i]

    def _accept(self, i: int) -> None:
        super()._accept(i)
        hardness, punch, u = self.certificate.hardness, self._punch[i], self._u[i, self._normal]
        presses = self.load[i] - self._restoring[i, self._normal] > hardness
        self._yields[i] = (u > punch) | ((u == punch) & presses)
        self._load[i, self._normal] = self.load[i] - hardness * self._yields[i]
        for bound in (self._ceiling[i, self._normal], self._bound[i, self._normal]):
            bound[:] = np.where(self._yields[i], np.inf, np.minimum(bound, punch))
