"""Active-set Newton method for the hard wall (Hintermueller, Ito & Kunisch, SIAM J. Optim. 13:865, 2002)."""

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier.resampling import resample
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.preconditioners.exponential_sum import ExponentialSum
from gfmd_numba.solvers.preconditioners.far_field import FarField
from gfmd_numba.solvers.preconditioners.restricted_stiffness import RestrictedStiffness
from gfmd_numba.solvers.pressure_iterate import PressureIterate

# what follows is tuned on half-spaces of 2^13 to 2^20 nodes at H = 0.3 and 0.8; other values cost slightly more
_COARSEST = 256  # nodes up to which the first guess is full contact
_COARSE_STEPS = 6  # on the coarser grid, at most
_SETTLED = 0.02  # share of the contact that may still change when the coarser grid is left
_TIGHTEN = 0.1  # factor on the error allowed in the pressure after a step that left the contact as it was
_INNER_ITERATIONS, _SPARE_ITERATIONS = 40, 200  # the latter with the preconditioner that is farther off


class _Tuned(NamedTuple):
    """What is best in one dimension, and in two.

    The contact is guessed on a grid with fewer nodes along x by the factor `coarsening`. `loose` is the relative error
    allowed in the first pressure on a new contact. After a step that changed the contact the error allowed is smaller
    by the factor `tighten`, and at most `ahead` times the share of nodes that changed sides: inner iterations of maps
    converge slower, and need not know more than the contact. `inverse` makes the preconditioner on a grid from the
    stiffness `[(ny,) nx // 2 + 1]` and the symbol of the compliance.
    """

    coarsening: int
    loose: float
    tighten: float
    ahead: float
    inverse: Callable[[Reals, Reals, tuple[int, ...]], ExponentialSum | FarField]


_TUNED = {
    1: _Tuned(
        4, 0.03, _TIGHTEN, np.inf, lambda _, soft, shape: ExponentialSum(soft.astype(np.float64) * shape[0], *shape)
    ),
    2: _Tuned(2, 0.2, 0.5, 0.1, lambda stiffness, _, shape: FarField(stiffness, shape)),
}


class ActiveSetNewton(PressureIterate):
    """Pressure of a batch, found by guessing the contact: its nodes alone then pose a linear problem.

    Nodes under tension leave, overlapping ones join. If displacing a node pulls its neighbours the same way, as on a
    half-space, and each linear problem is solved exactly, the contact shrinks to that of equilibrium. These are
    solved by conjugate gradients, ever more exactly. Preconditioned by an exponential sum on profiles (by the stiffness
    itself where that cannot be used), they take some transforms whatever the grid; on maps, by near and far field, a
    few more for each doubling of nx. The first guess comes from the waves that a coarser grid holds. The run ends when
    the residual is at most `options.residual`, not when the contact stops changing: `certificate.py` measures it, the
    largest violation of a contact condition over the largest pressure.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options) -> None:
        super().__init__(batch)
        rows, n = len(batch.punch), self.field.n
        self.changed = np.full(rows, n)  # nodes that changed sides in the last step
        self.touching = np.full(rows, n)  # nodes in contact before it
        self._coarse_transforms = np.zeros(rows)
        self._tuned = _TUNED[len(self.field.shape)]
        if n > _COARSEST:
            self._guess(batch, options)
        self._contact = (self.pressure > 0.0) & (self.pressure < self.hardness)
        self._spare: RestrictedStiffness | None = None  # where the other cannot be used
        self._response = batch.response
        self._inverse = self._tuned.inverse(batch.response.normal, self.compliance, self.field.shape)
        self._target = 0.2 * options.residual  # the certificate's measure is a slightly different one
        self._tolerance = np.full(rows, self._tuned.loose)
        self._nodes = np.empty(n, dtype=np.int64)
        self._closing, self._pressure_change, self._uniform = np.empty((3, n))

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation, those of coarser grids in proportion to their cost."""
        return self.field.n_transforms + np.ceil(self._coarse_transforms).astype(np.int64)

    @property
    def _spent(self) -> float:
        """Transforms made so far by preconditioners."""
        return self._inverse.transforms + (0.0 if self._spare is None else self._spare.transforms)

    def advance(self, active: Indices) -> None:
        """Solve for the pressure on the contact of each active row, and revise its contact."""
        n = self.field.n
        for row in active.reshape(-1, 1):
            i = row[0]
            if self.changed[i]:
                self._open_gap(row)
            count = kernels.contact_nodes(self._contact[i], n, self._nodes)
            spent = self._spent
            self._close_gap(row, count)
            self._coarse_transforms[i] += self._spent - spent
            changed = self._revise(row, count) or self._opened(row, count)
            tighter = _TIGHTEN * self._tolerance[i]
            if changed:
                tighter = min(self._tuned.tighten * self._tolerance[i], self._tuned.ahead * changed / max(count, 1))
            self._tolerance[i] = max(tighter, self._target) if changed else min(tighter, self._target)
            self.changed[i], self.touching[i] = changed, count

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions; costs two transforms a row."""
        return self.violation(active)

    def _open_gap(self, row: Indices) -> None:
        """Gap under the pressure, up to the approach."""
        i = row[0]
        self.field.apply(self.compliance, row, source=0)
        kernels.open_gap(self.field.result[i], self.wall[i], self.field.n, self.gap[i])

    def _revise(self, row: Indices, count: int) -> int:
        """Revise the contact of a row; returns how many nodes changed sides."""
        i = row[0]
        changed = kernels.revise_contact(
            self.rows[i], self._contact[i], self._nodes, count, self.field.n, self.load[i], self.rounding[i],
            self.free_mean,
        )  # fmt: skip
        return int(changed)

    def _opened(self, row: Indices, count: int) -> int:
        """Open the node that full contact presses least, where a body that keeps its volume has room; how many.

        No pressure closes all gaps there: the uniform part of what is found grows without bound.
        """
        i, n, rigid = row[0], self.field.n, self.certificate.rigid_mean
        if rigid is None or count < n or not self.wall[i, :n].mean() > self.rounding[i]:
            return 0
        self.displacement[i, :n] = self.wall[i, :n]
        self.field.apply(self._stiffness, row, source=2)
        pressing = -self.field.result[i, :n]
        self.pressure[i, :n] = np.minimum(pressing - pressing.min(), self.hardness)
        self._contact[i] = (self.pressure[i] > 0.0) & (self.pressure[i] < self.hardness)
        return int(n - np.count_nonzero(self._contact[i]))

    def _close_gap(self, row: Indices, count: int) -> None:
        """Conjugate gradients for the pressure that closes the gap of a row on the nodes in contact."""
        field, n, i, nodes = self.field, self.field.n, row[0], self._nodes
        iterate = self.rows[i]
        r, z, uniform = self._closing, self._pressure_change, self._uniform
        if count == 0:
            return
        kernels.closing_displacement(iterate.gap, nodes, count, r, self.free_mean)
        inverse = self._factored(nodes, count)
        if self.free_mean:
            z[:count] = 1.0
            inverse.solve(z, uniform)
        last = 0.0
        for _ in range(_SPARE_ITERATIONS if inverse is self._spare else _INNER_ITERATIONS):
            inverse.solve(r, z)
            energy, error = kernels.newton_error(
                r, z, uniform, iterate.p, nodes, count, self.rounding[i], self.free_mean
            )
            if not error > self._tolerance[i]:
                break
            kernels.newton_direction(z, last, energy, nodes, count, n, iterate.t)
            last = energy
            field.apply(self.compliance, row, source=1)
            kernels.newton_update(iterate, energy, nodes, count, n, r, self.free_mean)

    def _factored(self, nodes: Indices, count: int) -> ExponentialSum | RestrictedStiffness | FarField:
        """Preconditioner that can be used on the first `count` of the nodes, prepared for them."""
        decays = self._inverse
        decays.factor(nodes, count)
        if decays.is_positive or not self._needs_spare:
            return decays
        if self._spare is None:
            self._spare = RestrictedStiffness(self._response.normal, self.field.n)
        self._spare.factor(nodes, count)
        return self._spare

    @cached_property
    def _needs_spare(self) -> bool:
        """Whether no sum of decays is close to the compliance, whatever that of the mean, which is one wave of many."""
        if self.free_mean:
            return True
        n, compliance = self.field.n, self.compliance.astype(np.float64)
        decays = ExponentialSum(np.concatenate(([0.0], compliance[1:])) * n, n)
        decays.factor(np.arange(n), n)
        return not decays.is_positive

    def _guess(self, batch: Batch, options: Options) -> None:
        """Begin with the pressure of the waves that a coarser grid holds."""
        n, fine_shape = self.field.n, self.field.shape
        shape = tuple(-(-nodes // self._tuned.coarsening) for nodes in fine_shape)
        smooth = np.concatenate([resample(row[np.newaxis], shape) for row in batch.punch])  # whatever the others
        fewer = replace(batch, punch=smooth.astype(batch.punch.dtype), response=batch.response.coarsened(shape))
        coarse = type(self)(fewer, replace(options, residual=_SETTLED))
        active = np.arange(len(batch.punch))
        for _ in range(_COARSE_STEPS):
            coarse.advance(active)
            active = active[coarse.changed[active] > _SETTLED * coarse.touching[active]]
        m = coarse.field.n
        for fine, p in zip(self.pressure, coarse.pressure, strict=True):
            p = p[:m].reshape(shape)
            # of nodes next to the contact, which interpolation would load too, keep those nearer to a contact node
            inside = _interpolated((p > 0.0).astype(np.float64), fine_shape) >= 0.5
            fine[:n] = np.where(inside, _interpolated(p, fine_shape), 0.0).ravel()
        self._balance()
        cost = m * np.log(m) / (n * np.log(n))
        self._coarse_transforms = coarse.n_transforms * cost

    def _balance(self) -> None:
        """Scale the pressure of each realisation to its load."""
        if self.free_mean:
            mean = self.pressure[:, : self.field.n].mean(axis=1)
            self.pressure[:, : self.field.n] *= (self.load / mean)[:, np.newaxis]


def _interpolated(values: Reals, shape: tuple[int, ...]) -> Reals:
    """Periodic values between their nodes, linearly in each direction."""
    for axis, n in enumerate(shape):
        x = np.arange(n) * (values.shape[axis] / n)
        values = np.apply_along_axis(_interpolated_along, axis, values, x)
    return values


def _interpolated_along(p: Reals, x: Reals) -> Reals:
    return np.asarray(np.interp(x, np.arange(p.size + 1), np.append(p, p[0])))
