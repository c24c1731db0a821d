"""Truncated Newton method on the energy of a contact under a law of the gap, with or without the hard wall."""

import math

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.convolution import Convolution, aligned_rows
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import NormalLaw
from gfmd_numba.solvers.certificate import Certificate
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.options import Options

Rows = npt.NDArray[np.int64]

_LOOSE = 0.1  # largest part of the unbalanced traction that a Newton step may leave unbalanced
_INNER_ITERATIONS = 60  # of conjugate gradients in a Newton step
_FLAT = 1e-6  # curvature over that of the body alone below which a direction is one of a fold, or downhill for ever
_LONGEST = 8.0  # step along such a direction over that in which the body alone would come to rest
_SUFFICIENT = 1e-4  # least decrease of the energy over what its slope promises (Armijo)
_ROUNDING = 1e-14  # of a change of energy, over the sum of its parts
_FAR = 3.0  # ranges of an attraction beyond which a gap closes freely, and below which by one range a step
_SHORTEST = 1e-12  # step along a Newton direction that is tried before the gradient takes its place


_NOTHING = ExponentialLaw(0.0, 1.0)  # acts beside a hard wall alone


class TruncatedNewton:
    """Displacement of a batch that descends its energy, elastic, of the law and of the load.

    Each Newton step holds the nodes that press against the wall and frees the others, solves the linear problem that is
    left by preconditioned conjugate gradients (Steihaug, SIAM J. Numer. Anal. 20:626, 1983) up to a direction in which
    the energy curves down, stops nodes at the wall, and is cut short until the energy has decreased. So
    the energy never rises, and a contact on a stable branch stays on it. The preconditioner is the compliance of the
    bodies, restricted to the free nodes. The first transforms of a step are those of its gradient.
    """

    check_every = 1
    tangential: tuple[Reals, Reals] | None = None

    def __init__(self, batch: Batch, options: Options) -> None:
        rows, shape = len(batch.punch), batch.punch.shape[1:]
        self.field = Convolution(rows, *shape)
        n = self.field.n
        self.load = batch.loads
        interface = batch.interface
        self._law = law = interface.normal_law or _NOTHING
        self._punch = aligned_rows(rows, n)
        self._punch[:, :n] = batch.punch.reshape(rows, -1)
        self.wall = self._punch if interface.hard_wall else np.full_like(self._punch, np.inf)
        # how far a step may close gaps: a stride over the range of an attraction might pass what keeps surfaces apart
        self._reach = law.strength / law.softening if law.softening > 0.0 else 0.0
        self._bound = self.wall.copy() if self._reach > 0.0 else self.wall
        (self._source,) = self.field.sources
        self._u, self._elastic, self.restoring = (aligned_rows(rows, n) for _ in range(3))
        # where neither the load nor a wall says where the punch is, a large mean displacement would cost digits
        self._floats = batch.load is not None and not interface.hard_wall
        self._level = np.zeros((rows, 1))
        self._u[:, :n] = _start(batch, self._punch[:, :n], self.wall[:, :n], law)
        self.certificate = Certificate(rows)
        self._target = options.residual
        stiffness = batch.normal_stiffness
        # the mean that a load moves freely is as stiff as contact makes it: of the order of the softest wave
        compliance = 1.0 / np.where(stiffness > 0.0, stiffness, stiffness.ravel()[1:].min())
        self._stiffness, self._compliance = self.field.symbol(stiffness), self.field.symbol(compliance)
        self._node_compliance = float((compliance * grid.multiplicity(shape[-1])).sum() / n)
        self._stiffest = float(stiffness.max()) + batch.law_stiffness()
        self._strongest, self._residual = np.zeros(rows), np.ones(rows)
        self._curvature, self._weight, self._unbalanced, self._direction, self._conjugate, self._closing = np.zeros(
            (6, n)
        )
        for row in np.arange(rows).reshape(-1, 1):
            i = row[0]
            self._source[i] = self._u[i]
            self.field.apply(self._stiffness, row)
            self._accept(i)

    @property
    def displacement(self) -> Reals:
        """Displacement of each row."""
        return self._u + self._level if self._floats else self._u

    @property
    def n_transforms(self) -> Rows:
        """Transforms made so far for each realisation."""
        return self.field.n_transforms

    def residual(self, active: Rows) -> Reals:
        """Relative violation of the contact conditions `[active]`; costs no transform.

        It is measured by the largest pressure of the wall or traction of the law, whichever is larger.
        """
        look, n = self.certificate, self.field.n
        look.look(self._u, self.restoring, self.wall, self.load, active, n)
        found = np.array(
            [look.residual(self.load, active[k : k + 1], self._strongest[i])[0] for k, i in enumerate(active)]
        )
        self._residual[active] = found
        return found

    def advance(self, active: Rows) -> None:
        """Make one Newton step in the active rows."""
        for row in active.reshape(-1, 1):
            bends_down = self._find_direction(row)
            self._descend(row, bends_down)

    def _find_direction(self, row: Rows) -> bool:
        """Fill the direction of a row's Newton step; returns whether the energy curves down somewhere along it."""
        i, n, field = row[0], self.field.n, self.field
        curvature, weight, r = self._curvature, self._weight, self._unbalanced
        d, p, source, result = self._direction, self._conjugate, self._source[i], self.field.result[i]
        curvature[:] = self._law.stiffness(self._punch[i, :n] - self._u[i, :n])
        kernels.descent_start(
            self._u[i], self.wall[i], self.restoring[i], self.load[i], curvature, self._node_compliance, n,
            weight, r, d, source,
        )  # fmt: skip
        field.apply(self._compliance, row)
        first = last = kernels.descent_norm(r, weight, result, n)
        if not first > 0.0:
            return False
        p[:] = 0.0
        kernels.descent_direction(weight, result, 0.0, n, p, source)
        tolerance = self._tolerance(i)
        for _ in range(_INNER_ITERATIONS):
            field.apply(self._stiffness, row)
            curve, elastic = kernels.descent_curvature(p, result, curvature, n)
            if not curve > _FLAT * elastic:
                d += last / elastic * p
                return True
            kernels.descent_update(p, result, curvature, weight, last / curve, n, d, r, source)
            field.apply(self._compliance, row)
            norm = kernels.descent_norm(r, weight, result, n)
            if not norm > tolerance**2 * first:
                break
            kernels.descent_direction(weight, result, norm / last, n, p, source)
            last = norm
        return False

    def _tolerance(self, i: int) -> float:
        """Part of the unbalanced traction that the next Newton step may leave: the less, the smaller that is."""
        residual = float(self._residual[i])
        return max(min(_LOOSE, math.sqrt(residual)), 0.3 * self._target / residual)

    def _descend(self, row: Rows, bends_down: bool) -> None:
        """Go along the direction of a row, as far as the energy decreases."""
        i, step = row[0], 1.0
        change, slope = self._trial(row, step)
        while not _decreases(change, slope):
            step *= _shorter(change, slope)
            if step < _SHORTEST:
                self._direction[:] = (self.load[i] - self.restoring[i, : self.field.n]) / self._stiffest
                change, slope = self._trial(row, 1.0)
                if _decreases(change, slope):
                    self._accept(i)
                return
            change, slope = self._trial(row, step)
        self._accept(i)
        while bends_down and 1.0 <= step < _LONGEST and _decreases(*self._trial(row, step)):
            self._accept(i)
            step *= 2.0

    def _trial(self, row: Rows, step: float) -> tuple[float, float]:
        """Change of a row's energy by a step, and what its slope promises; two transforms."""
        i, n = row[0], self.field.n
        u, trial = self._u[i], self._source[i]
        kernels.descent_trial(u, self._bound[i], self._direction, step, n, trial)
        self.field.apply(self._stiffness, row)
        work, slope, size = kernels.descent_work(
            u, trial, self._elastic[i], self.field.result[i], self.restoring[i], self.load[i], n, self._closing
        )
        with np.errstate(over="ignore"):
            law = float(self._law.energy_change(self._punch[i, :n] - u[:n], self._closing).sum())
        return work + law - _ROUNDING * size, min(slope, 0.0)

    def _accept(self, i: int) -> None:
        """Make the last trial of a row, whose restoring traction was the last result, its displacement."""
        n = self.field.n
        mean = float(self._source[i, :n].mean()) if self._floats else 0.0
        self._u[i, :n] = self._source[i, :n] - mean
        self._punch[i, :n] -= mean
        self._level[i] += mean
        self._elastic[i, :n] = self.field.result[i, :n]
        gap = self._punch[i, :n] - self._u[i, :n]
        if self._reach > 0.0:
            closing = np.subtract(gap, _FAR * self._reach, out=self._closing)
            np.maximum(closing, self._reach, out=closing)
            closing += self._u[i, :n]
            np.minimum(self.wall[i, :n], closing, out=self._bound[i, :n])
        traction = self._law.traction(gap)
        np.subtract(self._elastic[i, :n], traction, out=self.restoring[i, :n])
        self._strongest[i] = max(traction.max(), -traction.min())


def _start(batch: Batch, punch: Reals, wall: Reals, law: NormalLaw) -> Reals:
    """Displacement `[realisation, node]` that a batch begins with.

    Where a law repels by more than any pressure, a Newton step would be lost in its exponential.
    """
    start = np.minimum(batch.start.displacement.reshape(len(punch), -1), wall)
    with np.errstate(over="ignore"):
        crushed = -law.traction(punch - start) > batch.largest_pressure
    return np.where(crushed, np.minimum(start, punch), start)


def _decreases(change: float, slope: float) -> bool:
    """Whether an energy changes by a sufficient part of what its slope promises."""
    return change <= _SUFFICIENT * slope


def _shorter(change: float, slope: float) -> float:
    """Part of a step after which a parabola of that slope and change is least, from a tenth to half."""
    if not (slope < 0.0 and math.isfinite(change)):
        return 0.1
    return min(max(-0.5 * slope / (change - slope), 0.1), 0.5)
