"""Active-set Newton method for the hard wall (Hintermueller, Ito & Kunisch, SIAM J. Optim. 13:865, 2002)."""

from dataclasses import replace
from functools import partial

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.preconditioners import PRECONDITIONERS
from gfmd_numba.solvers.pressures import UPHILL_FROM_THE_START, Closing, LastPressure, PressureIterate
from gfmd_numba.solvers.table import Options

# what follows is tuned on half-spaces of 2^13 to 2^20 nodes at H = 0.3 and 0.8; other values cost slightly more
_COARSEST = 256  # nodes up to which the first guess is full contact
_COARSE_STEPS = 6  # on the coarser grid, at most
_SETTLED = 0.02  # share of the contact that may still change when the coarser grid is left
_TIGHTEN = 0.1  # factor on the error allowed in the pressure after a step that left the contact as it was
_FEW = 16  # nodes to and fro between their bounds: where more change sides, a step uphill mostly leads on


class ActiveSetNewton(PressureIterate):
    """Pressure of a batch, found by guessing the contact: the pressure of the guessed nodes solves a linear problem.

    After each solution, nodes under tension leave the contact, and overlapping nodes join it. If displacing a node
    pulls its neighbours the same way, as on a half-space, and each linear problem is solved exactly, the contact only
    shrinks, to that of equilibrium. The linear problems are solved by conjugate gradients, ever more exactly,
    preconditioned as `preconditioners.py` says. The number of transforms does not grow with a profile, and grows by a
    few for each doubling of nx of a map. The first guess comes from the waves that a coarser grid holds. The run ends
    when the residual of `certificate.py` is at most `options.residual`, not when the contact stops changing.

    Under a hardness, the pressure has two bounds, and the guess is the set of nodes at neither bound. Two bounds may
    send nodes to and fro. So after the linear problem all nodes make a step of a projected gradient: along the violated
    gaps, to the nearest pressures between the bounds that carry the load. A step that increases the energy is cut short
    where the energy is least. If few nodes change sides and the step increases the energy from its start, it is
    replaced by a step towards the solution of the linear problem, up to where the first node reaches a bound.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options) -> None:
        super().__init__(batch)
        rows, n = len(batch.punch), self.field.n
        self.changed = np.full(rows, n)  # nodes that changed sides in the last step
        self.touching = np.full(rows, n)  # nodes in contact before it
        self._last = LastPressure(self.pressure) if self.hardness < np.inf else None
        self._careful = np.zeros(rows, dtype=np.bool_)
        shape = self.field.shape
        self._inverse = PRECONDITIONERS[len(shape)].of_contact(batch.response.normal, self.compliance, shape)
        self._tuning = self._inverse.tuning
        if n > _COARSEST:
            self._guess(batch, options)
        self._contact = (self.pressure > 0.0) & (self.pressure < self.hardness)
        self._target = 0.2 * options.residual  # the certificate's measure is a slightly different one
        self._tolerance = np.full(rows, self._tuning.loose)
        self._nodes = np.empty(n, dtype=np.int64)
        self._room, self._uniform = np.empty((2, n)), np.empty(n)

    def advance(self, active: Indices) -> None:
        """Solve for the pressure on the contact of each active row, and revise its contact."""
        n = self.field.n
        for row in active.reshape(-1, 1):
            i = row[0]
            if self.changed[i]:
                self._open_gap(row)
            count = kernels.contact_nodes(self._contact[i], n, self._nodes)
            spent = self._inverse.transforms
            closing = self._close_gap(row, count)
            self.elsewhere[i] += self._inverse.transforms - spent
            changed = self._revise(row, closing) or self._opened(row, count)
            tighter = _TIGHTEN * self._tolerance[i]
            if changed:
                tighter = min(self._tuning.tighten * self._tolerance[i], self._tuning.ahead * changed / max(count, 1))
            self._tolerance[i] = max(tighter, self._target) if changed else min(tighter, self._target)
            self.changed[i], self.touching[i] = changed, count

    def _open_gap(self, row: Indices) -> None:
        """Gap under the pressure, up to the approach."""
        i, n = row[0], self.field.n
        p, gap = self.pressure[i], self.gap[i]
        self.field.apply(self.compliance, row, source=0)
        np.add(self.wall[i, :n], self.field.result[i, :n], out=gap[:n])
        uphill = 0 if self._last is None else self._last.line_search(i, p, gap, n)
        if self._last is None or not uphill:
            return
        if uphill == UPHILL_FROM_THE_START and self.changed[i] <= _FEW:
            p[:], gap[:] = self._last.pressure[i], self._last.gap[i]
            self._careful[i] = True
        elif uphill == UPHILL_FROM_THE_START:
            self._last.remember(i, p, gap)
        self._contact[i] = (p > 0.0) & (p < self.hardness)

    def _revise(self, row: Indices, closing: Closing) -> int:
        """Revise the contact of a row; returns how many nodes changed sides."""
        i, n, iterate, contact = row[0], self.field.n, self.rows[row[0]], self._contact[row[0]]
        count = closing.nodes.size
        if self._last is None:
            return closing.revise(contact[:n], self.load[i] * n)
        if self._careful[i]:
            self._careful[i] = False
            stopped = kernels.stop_at_first_bound(iterate.p, self._last.pressure[i], contact, self.hardness, n)
            if stopped:
                return int(stopped)
        square = kernels.wrong_gaps(iterate, self._nodes, count, n, self.rounding[i], self.free_mean)
        if square > 0.0:
            self.field.apply(self.compliance, row, source=1)
        return int(kernels.revise_bounds(iterate, square, contact, n, self.load[i], self.hardness, self.free_mean))

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

    def _close_gap(self, row: Indices, count: int) -> Closing:
        """Find the pressure that closes the gap of a row on the nodes in contact; the problem that this was."""
        i, n, nodes, inverse, room = row[0], self.field.n, self._nodes[:count], self._inverse, self._room
        iterate = kernels.Iterate(*(each[:n] for each in self.rows[i]))
        apply_compliance = partial(self.field.apply, self.compliance, row, source=1)
        closing = Closing(
            iterate, nodes, inverse, apply_compliance, self._uniform, self.rounding[i], self.free_mean, room
        )
        if count == 0:
            return closing
        inverse.factor(nodes, count)
        if self.free_mean:
            room[0, :count] = 1.0
            inverse.solve(room[0], self._uniform)
        closing.solve(self._tolerance[i], inverse.iterations)
        return closing

    def _guess(self, batch: Batch, options: Options) -> None:
        """Begin with the pressure of the waves that a coarser grid holds."""
        shape = tuple(-(-nodes // self._tuning.coarsening) for nodes in self.field.shape)
        coarse = type(self)(batch.coarsened(shape), replace(options, residual=_SETTLED))
        active = np.arange(len(batch.punch))
        for _ in range(_COARSE_STEPS):
            coarse.advance(active)
            active = active[coarse.changed[active] > _SETTLED * coarse.touching[active]]
        self.begin_at(coarse)
        self._balance()

    def _balance(self) -> None:
        """Scale the pressure of each realisation to its load, or move it there between its bounds."""
        n = self.field.n
        if self.free_mean and self._last is None:
            self.pressure[:, :n] *= (self.load / self.pressure[:, :n].mean(axis=1))[:, np.newaxis]
        elif self.free_mean:
            for p, load in zip(self.pressure, self.load, strict=True):
                kernels.bound(p, np.ones(n, dtype=np.bool_), load * n, self.hardness, n)
