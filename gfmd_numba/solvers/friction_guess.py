"""What Newton's method for friction begins with: which nodes touch, stick and slip, and the tractions on them."""

from dataclasses import dataclass, replace

import numpy as np

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.elasticity.coupled_stiffness import CoupledStiffness
from gfmd_numba.fourier.resampling import resample
from gfmd_numba.solvers.active_set_newton import ActiveSetNewton
from gfmd_numba.solvers.friction_sets import bound
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Start
from gfmd_numba.solvers.options import Options

_STEPS, _SETTLED = 8, 0.02  # of the frictionless contact, at most; share of it that may still change


@dataclass
class FrictionGuess:
    """Nodes in contact, sign of the distance slid (0 where they stick) and both tractions `[realisation, x]`.

    `transforms` `[realisation]` is what the guess has cost so far.
    """

    contact: Flags
    slip: Indices
    pressure: Reals
    shear: Reals
    transforms: Indices

    @classmethod
    def without_friction(cls, batch: Batch, options: Options) -> "FrictionGuess":
        """The frictionless contact, roughly, with all its nodes sticking."""
        rows, n = batch.punch.shape
        normal = replace(batch, stiffness=batch.coupled_stiffness.condensed(), interface=HARD_WALL)
        solver = ActiveSetNewton(normal, replace(options, solver="active_set_newton"))
        active = np.arange(rows)
        for _ in range(_STEPS):
            solver.advance(active)
            active = active[solver.changed[active] > _SETTLED * solver.touching[active]]
        pressure = solver.pressure[:, :n].copy()
        slip, shear = np.zeros((rows, n), dtype=np.int64), np.zeros((rows, n))
        return cls(pressure > 0.0, slip, pressure, shear, solver.n_transforms.copy())

    def on_finer_grid(self, n: int, friction: float) -> "FrictionGuess":
        """The same on n nodes; transforms count in proportion to their cost."""
        m = self.contact.shape[1]
        nearest = np.round(np.arange(n) * (m / n)).astype(np.int64) % m
        contact = self.contact[:, nearest]
        pressure = np.where(contact, _between(self.pressure, n), 0.0)
        contact &= pressure > 0.0
        most = bound(friction, pressure)
        shear = np.clip(_between(self.shear, n), -most, most)
        cost = m * np.log(m) / (n * np.log(n))
        transforms = np.ceil(self.transforms * cost).astype(np.int64)
        return FrictionGuess(contact, self.slip[:, nearest] * contact, pressure, shear, transforms)


def on_coarser_grid(batch: Batch, anchor: Reals, m: int) -> Batch:
    """The problem of the waves that a grid of m nodes holds; its nodes slip from the `anchor` `[realisation, x]`."""
    fine = batch.coupled_stiffness
    stiffness = CoupledStiffness.on_grid(m, *(k[: m // 2 + 1].copy() for k in (fine.k11, fine.k13, fine.k33)))
    punch, anchor = _resampled(batch.punch, m), _resampled(anchor, m)
    return replace(batch, punch=punch, stiffness=stiffness, start=replace(Start.at_rest(punch), tangential=anchor))


def _resampled(rows: Reals, m: int) -> Reals:
    return np.concatenate([resample(row[np.newaxis], (m,)) for row in rows])  # each whatever the others


def _between(rows: Reals, n: int) -> Reals:
    """Periodic values `[row, m]` on n nodes, linearly between those of m."""
    m = rows.shape[1]
    x = np.arange(n) * (m / n)
    return np.array([np.interp(x, np.arange(m + 1), np.append(row, row[0])) for row in rows])
