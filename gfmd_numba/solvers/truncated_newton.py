"""Truncated Newton method on the energy of a contact under a law of the gap, with or without the hard wall."""

import math
from collections.abc import Callable

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform, aligned_rows
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.solvers.certificate import Certificate
from gfmd_numba.solvers.held_mean import HeldMean
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.options import Options

_LOOSE = 0.1  # largest part of the unbalanced traction that a Newton step may leave unbalanced
_INNER_ITERATIONS = 60  # of conjugate gradients in a Newton step
_FLAT = 1e-6  # curvature over that of the body alone below which a direction is one of a fold, or downhill for ever
_LONGEST = 8.0  # step along such a direction over that in which the body alone would come to rest
_SUFFICIENT = 1e-4  # least decrease of the energy over what its slope promises (Armijo)
_ROUNDING = 1e-14  # of a change of energy, over the sum of its parts, in double precision
_FAR = 3.0  # ranges of an attraction beyond which a gap closes freely, and below which by one range a step
_SHORTEST = 1e-12  # step along a Newton direction that is tried before the gradient takes its place
_NOTHING = ExponentialLaw(0.0, 1.0)  # stands for no law: a hard wall alone


class TruncatedNewton:
    """Displacement of a batch that descends its energy, elastic, of the law and of the load.

    Each Newton step holds the nodes that press against the wall and frees the others, solves the linear problem that is
    left by preconditioned conjugate gradients (Steihaug, SIAM J. Numer. Anal. 20:626, 1983) up to a direction in which
    the energy curves down, stops nodes at the wall, and is cut short until the energy has decreased. So the energy
    never rises, and a contact on a stable branch stays on it. The preconditioner is the compliance of the bodies,
    restricted to the free nodes. The first transforms of a step are those of its gradient.

    A mean displacement that has to vanish is held by a large stiffness, and the mean pressure then takes over.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options) -> None:
        rows, shape = len(batch.punch), batch.punch.shape[1:]
        self.field = Transform(rows, *shape, dtype=batch.punch.dtype)
        n = self.field.n
        self._law = law = batch.interface.normal_law or _NOTHING
        response = self._with_held_mean(batch)
        stiffness = response.normal
        (compliance,) = response.restored().inverse()
        self._stiffness, self._compliance = self.field.symbol(stiffness), self.field.symbol(compliance)
        self._node_compliance = float((compliance * grid.multiplicity(shape[-1])).sum() / n)
        self._stiffest = float(stiffness.max()) + batch.law_stiffness()
        (self._source,), self._result = self.field.sources, self.field.result
        self._u = aligned_rows(rows, n, batch.punch.dtype)
        self._u[:, :n] = starting_displacement(batch, law.traction)
        # how far a step may close gaps: a stride over the range of an attraction might pass what keeps surfaces apart
        self._begin(batch, options, slice(0, n), law.strength / law.softening if law.softening > 0.0 else 0.0)

    @property
    def tangential(self) -> tuple[Reals, Reals, Reals] | None:
        """Nothing: the normal displacement alone is followed."""
        return None

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation."""
        return self.field.n_transforms

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions `[active]`; costs no transform.

        It is measured by the largest pressure of the wall or traction of the law, whichever is larger.
        """
        look, n = self.certificate, self.field.n
        look.look(kernels.State(self.displacement, self.restoring, self.wall, self.load), active, n)
        self._look_at_more(active)
        found = look.residual(self.load, active, self._strongest[active])
        if look.rigid_mean is not None:
            drift = look.rigid_mean.violation(self.displacement, active, n)
            self._drifts[active] = (drift >= look.worst[active]) | (look.drift[active] >= found)
        self._residual[active] = found
        return found

    def advance(self, active: Indices) -> None:
        """Make one Newton step in the active rows."""
        for row in active.reshape(-1, 1):
            if self._drifts[row[0]]:
                self._shift_load(row[0])
            bends_down = self._find_direction(row)
            self._descend(row, bends_down)

    def _with_held_mean(self, batch: Batch) -> SpectralResponse:
        """Response in which a mean that has to vanish is held; begins the certificate, which says so."""
        self._held_mean = held = HeldMean.of(batch)
        limits = batch.interface.hardness or np.inf, held.condition if held is not None else None
        self.certificate = Certificate(len(batch.punch), *limits)
        return batch.response if held is None else batch.response.with_mean(held.stiffness)

    def _begin(self, batch: Batch, options: Options, normal: slice, reach: float) -> None:
        """Find the tractions at the start; the normal displacements are a slice of the unknowns of a row."""
        rows, n, unknowns = len(batch.punch), self.field.n, self._u.shape[1]
        self._normal, self._reach, self._target = normal, reach, options.residual
        self.load = batch.loads.copy()
        self._load, self._elastic, self._restoring, self._wall = np.zeros((4, rows, unknowns), self._u.dtype)
        self._load[:, normal] = self.load[:, np.newaxis]
        self._wall[:] = np.inf
        self.displacement, self.restoring = self._u, self._restoring
        self._punch, self.wall = self._wall[:, normal], self._wall
        if batch.interface.hard_wall:
            self._wall[:, normal] = batch.punch.reshape(rows, -1)
        else:
            self._punch = batch.punch.reshape(rows, -1).copy()
        if normal.start > 0:  # not the normal displacement alone is followed
            self.displacement, self.restoring, self.wall = (aligned_rows(rows, n, self._u.dtype) for _ in range(3))
            self.wall[:, :n] = self._wall[:, normal]
        np.minimum(self._u, self._wall, out=self._u)
        self._ceiling = self._wall if self.certificate.hardness == np.inf else self._wall.copy()
        self._bound = self._ceiling.copy() if reach > 0.0 else self._ceiling
        self._rounding = _ROUNDING * float(np.finfo(self._u.dtype).eps / np.finfo(np.float64).eps)
        # where neither the load nor a wall says where the punch is, a large mean displacement would cost digits
        self._floats = batch.load is not None and not batch.interface.hard_wall
        self._level = np.zeros((rows, 1))
        if self._floats:
            self.displacement = aligned_rows(rows, n, self._u.dtype)
        self._strongest, self._residual = np.zeros(rows), np.ones(rows)
        self._drifts = np.zeros(rows, dtype=np.bool_)
        self._curvature, self._weight, self._unbalanced, self._direction, self._conjugate, self._closing = np.zeros(
            (6, unknowns), self._u.dtype
        )
        for row in np.arange(rows).reshape(-1, 1):
            self._source[row[0]] = self._u[row[0]]
            self._stiffen(row)
            self._accept(row[0])

    def _stiffen(self, row: Indices) -> None:
        """Fill the result of a row with the restoring tractions of its source."""
        self.field.apply(self._stiffness, row)

    def _comply(self, row: Indices) -> None:
        """Fill the result of a row with the displacements under its source."""
        self.field.apply(self._compliance, row)

    def _pull(self, i: int) -> Reals:
        """Traction of the law on each unknown of a row, in an array that is free between trials."""
        self._closing[self._normal] = self._law.traction(self._gap(i))
        return self._closing

    def _fill_curvature(self, i: int) -> None:
        """Fill the curvature of the law's energy for each unknown of a row alone."""
        self._curvature[self._normal] = self._law.stiffness(self._gap(i))

    def _add_coupling(self, i: int) -> float:
        """Add how the law couples the unknowns of a node to the result; return twice the energy of the coupling."""
        return 0.0

    def _change(self, i: int) -> float:
        """Change of the law's energy as the gaps of a row close."""
        return float(self._law.energy_change(self._gap(i), self._closing[self._normal]).sum(dtype=np.float64))

    def _split(self, i: int) -> None:
        """Prepare the preconditioner for the curvature of a row."""

    def _project(self, i: int) -> None:
        """Project the trial of a row onto the displacements where the energy is smooth."""

    def _longest(self, i: int) -> float:
        """Step along the direction that is tried first."""
        return 1.0

    def _look_at_more(self, active: Indices) -> None:
        """Measure violations of other than normal conditions."""

    def _gap(self, i: int) -> Reals:
        return np.asarray(self._punch[i] - self._u[i, self._normal])

    def _shift_load(self, i: int) -> None:
        """Let the mean pressure of a row take over what held its mean displacement."""
        if self._held_mean is not None:
            self.load[i] += self._held_mean.pressure(self.displacement[i, : self.field.n])
            self._load[i, self._normal] = self.load[i]

    def _find_direction(self, row: Indices) -> bool:
        """Fill the direction of a row's Newton step; returns whether the energy curves down somewhere along it."""
        i = row[0]
        curvature, weight, r = self._curvature, self._weight, self._unbalanced
        d, p, source, result = self._direction, self._conjugate, self._source[i], self._result[i]
        self._fill_curvature(i)
        state = kernels.State(self._u[i], self._restoring[i], self._ceiling[i], self._load[i])
        kernels.descent_start(state, curvature, self._node_compliance, weight, r, d, source)
        self._split(i)
        self._comply(row)
        first = last = kernels.descent_norm(r, weight, result)
        if not first > 0.0:
            return False
        p[:] = 0.0
        kernels.descent_direction(weight, result, 0.0, p, source)
        tolerance = self._tolerance(i)
        for _ in range(_INNER_ITERATIONS):
            self._stiffen(row)
            curve, elastic = kernels.descent_curvature(p, result, curvature)
            curve += self._add_coupling(i)
            if not curve > _FLAT * elastic:
                d += last / max(elastic, _FLAT * last) * p
                return True
            kernels.descent_update(p, result, curvature, weight, last / curve, d, r, source)
            self._comply(row)
            norm = kernels.descent_norm(r, weight, result)
            if not norm > tolerance**2 * first:
                break
            kernels.descent_direction(weight, result, norm / last, p, source)
            last = norm
        return False

    def _tolerance(self, i: int) -> float:
        """Part of the unbalanced traction that the next Newton step may leave: the less, the smaller that is."""
        residual = float(self._residual[i])
        return max(min(_LOOSE, math.sqrt(residual)), 0.3 * self._target / residual)

    def _descend(self, row: Indices, bends_down: bool) -> None:
        """Go along the direction of a row, as far as the energy decreases."""
        i, step = row[0], self._longest(row[0])
        change, slope = self._trial(row, step)
        while not _decreases(change, slope):
            step *= _shorter(change, slope)
            if step < _SHORTEST:
                self._direction[:] = (self._load[i] - self._restoring[i]) / self._stiffest
                change, slope = self._trial(row, 1.0)
                if _decreases(change, slope):
                    self._accept(i)
                return
            change, slope = self._trial(row, step)
        self._accept(i)
        while bends_down and 1.0 <= step < _LONGEST and _decreases(*self._trial(row, step)):
            self._accept(i)
            step *= 2.0

    def _trial(self, row: Indices, step: float) -> tuple[float, float]:
        """Change of a row's energy by a step, and what its slope promises; two transforms."""
        i = row[0]
        u, trial = self._u[i], self._source[i]
        kernels.descent_trial(u, self._bound[i], self._direction, step, trial)
        self._project(i)
        self._stiffen(row)
        work, slope, scale = kernels.descent_work(
            u, trial, self._elastic[i], self._result[i], self._restoring[i], self._load[i], self._closing
        )
        with np.errstate(over="ignore", invalid="ignore"):  # too long a step, which is then cut short
            law = self._change(i)
        return work + law - self._rounding * scale, min(slope, 0.0)

    def _accept(self, i: int) -> None:
        """Make the last trial of a row, whose restoring traction was the last result, its displacement."""
        self._u[i] = self._source[i]
        if self._floats:
            mean = float(self._u[i, self._normal].mean())
            self._u[i, self._normal] -= mean
            self._punch[i] -= mean
            self._level[i] += mean
        self._elastic[i] = self._result[i]
        if self._reach > 0.0:
            bound = self._gap(i)
            bound -= _FAR * self._reach
            np.maximum(bound, self._reach, out=bound)
            bound += self._u[i, self._normal]
            np.minimum(self._ceiling[i, self._normal], bound, out=self._bound[i, self._normal])
        pull = self._pull(i)
        np.subtract(self._elastic[i], pull, out=self._restoring[i])
        self._strongest[i] = max(pull.max(), -pull.min())
        n = self.field.n
        if self.displacement is not self._u:
            self.displacement[i, :n] = self._u[i, self._normal] + self._level[i]
        if self.restoring is not self._restoring:
            self.restoring[i, :n] = self._restoring[i, self._normal]


def starting_displacement(batch: Batch, traction: Callable[[Reals], Reals]) -> Reals:
    """Normal displacement `[realisation, node]` that a batch begins with, under a traction across gaps.

    Where a law repels by more than any pressure, a Newton step would be lost in its exponential.
    """
    punch = batch.punch.reshape(len(batch.punch), -1)
    start = batch.start.displacement.reshape(punch.shape)
    with np.errstate(over="ignore"):
        crushed = -traction(punch - start) > batch.largest_pressure
    return np.where(crushed, np.minimum(start, punch), start)


def _decreases(change: float, slope: float) -> bool:
    """Whether an energy changes by a sufficient part of what its slope promises."""
    return change <= _SUFFICIENT * slope


def _shorter(change: float, slope: float) -> float:
    """Part of a step after which a parabola of that slope and change is least, from a tenth to half."""
    if not (slope < 0.0 and math.isfinite(change)):
        return 0.1
    return min(max(-0.5 * slope / (change - slope), 0.1), 0.5)
