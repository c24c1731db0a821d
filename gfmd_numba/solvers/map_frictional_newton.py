"""Semismooth Newton method for a hard wall with Coulomb friction on maps: all three displacements together."""

from dataclasses import replace

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier.convolution import aligned_rows
from gfmd_numba.solvers.bounded_newton import newton
from gfmd_numba.solvers.certificate import Certificate, RigidMean
from gfmd_numba.solvers.friction_sets import bound
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, by_component
from gfmd_numba.solvers.map_products import MapProducts
from gfmd_numba.solvers.map_stick_slip import MapGuess, MapStickSlip
from gfmd_numba.solvers.minimal_residual import minimal_residual
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.preconditioners.near_tractions import NearTractions

_FRICTIONLESS, _SETTLED = 12, 0.03  # steps of the first guess, at most; relative residual with which it is left
_INNER = 0.05  # error left by the linear solution of one step over that before it
_FALLS = 0.7  # share of the nodes changed by the last step beyond which the next is solved more exactly
_EXACT = 1e-4  # the most exact of these
_TIGHTEN = 0.1  # factor on that error, or on the last one, where it was not small enough
_CLOSE = 1e3  # change of the tractions over the residual asked for below which the certificate is looked at
_DIRECTIONS = 40  # of the linear solution, at most


class MapFrictionalNewton:
    """Tractions of a batch of maps, found as `FrictionalNewton` finds those of profiles.

    A slipping node has a direction of slip in place of a sign, and Newton's method turns it. The linear problem of a
    guess is solved by generalised minimal residuals, preconditioned by the stiffness between near nodes. The first one
    is the frictionless contact with all its nodes sticking.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options) -> None:
        punch, stiffness, start = batch.punch, batch.map_stiffness, batch.start
        rows, shape = len(punch), punch.shape[1:]
        if batch.interface.friction is None:
            raise ValueError("this solver knows contacts with friction alone")
        self._friction = batch.interface.friction
        self._products = MapProducts(stiffness, rows, shape, punch.dtype)
        self._near = NearTractions(stiffness, shape)
        self.field = self._products.field
        n = self.field.n
        self.displacement, self.restoring = self._products.displacement, self._products.restoring
        self.load = batch.loads
        self.wall, self._anchor = (aligned_rows(each, n, punch.dtype) for each in (rows, 2 * rows))
        self.wall[:, :n] = punch.reshape(rows, n)
        self._anchor[:, :n] = by_component(start.tangential + start.dragged, n)
        self.certificate = Certificate(rows, rigid_mean=RigidMean.of(punch, stiffness.k33))
        self._free_mean = batch.load is not None
        self._drifts = bool(stiffness.k11[0, 0, 0] == 0.0)
        self._rounding = np.finfo(punch.dtype).eps * np.ptp(self.wall[:, :n], axis=1)
        self._asked = options.residual
        self._last = np.full(rows, options.residual)  # error of the linear solution once the guess stands
        self._inner = np.full(rows, _INNER)
        self._changed = np.full(rows, n)  # nodes that the last step found to be guessed wrong
        self._moved = np.full(rows, np.inf)  # change of the tractions in the last step over the largest pressure
        self._guesses, self._guessed = self._first_guesses(batch, options)

    @property
    def tangential(self) -> tuple[Reals, Reals, Reals]:
        """Tangential displacement of the body, the traction that restores it, and from where it slips."""
        return self._products.tangential, self._products.tangential_restoring, self._anchor

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation."""
        return self._products.n_transforms + self._guessed

    def advance(self, active: Indices) -> None:
        """Solve the linear problem of the guess of each active row, and revise the guess."""
        for i in active:
            self._step(int(i))

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the normal and tangential conditions `[active]`.

        Costs six transforms for each row whose tractions hardly change any more; others are measured by their change.
        """
        n, products, certificate = self.field.n, self._products, self.certificate
        if certificate.rigid_mean is not None:  # the mean pressure is the multiplier of a zero mean
            self.load[active] = [self._guesses[i].tractions[2].mean() for i in active]
        stands = self._moved[active] < _CLOSE * self._asked
        products.restore(active[stands])
        for i in active[~stands]:
            own = [i, len(self.load) + i]
            products.tangential_restoring[own, :n] = self._guesses[i].tractions[:2]
            self.restoring[i, :n] = self.load[i] - self._guesses[i].tractions[2]
        certificate.look(self.displacement, self.restoring, self.wall, self.load, active, n)
        kernels.map_friction_violation(
            products.tangential, self._anchor, products.tangential_restoring, self.displacement, self.restoring,
            self.wall, self.load, self._friction, active, n, certificate.worst,
        )  # fmt: skip
        residual = certificate.residual(self.load, active)
        self._last[active[stands & (residual > self._asked)]] *= _TIGHTEN
        unsure = np.maximum(self._moved[active], 10.0 * self._asked)
        return np.where(stands, residual, np.maximum(residual, unsure))

    def _step(self, i: int) -> None:
        n, guess = self.field.n, self._guesses[i]
        own = [i, len(self.load) + i]
        anchor, wall = self._anchor[own, :n], self.wall[i, :n]
        total = self.load[i] * n if self._free_mean else None
        problem = MapStickSlip(guess, self._friction, total, self._drifts, self._products, self._near, i)
        asked = problem.prescribed(anchor, wall)
        x = problem.unknowns(guess.tractions)
        change = problem.correction(asked - problem.restricted(problem.deflected(x), x))
        peak, moved = float(np.abs(x).max(initial=0.0)), float(np.linalg.norm(change))
        aim = self._last[i] * peak
        if self._changed[i] or self._moved[i] > _CLOSE * self._asked:
            aim = max(aim, self._inner[i] * moved)
        self._moved[i] = moved / peak if peak > 0.0 else moved and np.inf

        def product(direction: Reals) -> Reals:
            return problem.correction(problem.restricted(problem.deflected(direction), direction))

        basis, shares = minimal_residual(product, change, aim, min(_DIRECTIONS, change.size))
        x += shares @ basis
        u = problem.deflected(x)
        problem.level(u, asked - problem.restricted(u, x))
        self._revise(i, u, problem.tractions(x))

    def _revise(self, i: int, u: Reals, tractions: Reals) -> None:
        """Revise the guess of a row, and store the displacement that is nearest to the conditions."""
        n, guess = self.field.n, self._guesses[i]
        own = [i, len(self.load) + i]
        wall, anchor, contact = self.wall[i, :n], self._anchor[own, :n], guess.contact
        gap, slid, pressure = wall - u[2], u[:2] - anchor, tractions[2]
        sticks = contact & ~guess.direction.any(axis=0)
        slips, most = contact & ~sticks, bound(self._friction, pressure)
        size, strength = np.hypot(*slid), np.hypot(*tractions[:2])
        forth = np.where(slips, -(slid * tractions[:2]).sum(axis=0), 0.0)  # slip against the traction, times that
        leaves = contact & ~(pressure > 0.0)
        joins = ~contact & (gap < -self._rounding[i])
        gives_way = sticks & ~leaves & (strength > most)
        turns_back = slips & ~((guess.direction * slid).sum(axis=0) > 0.0)
        goes_on = slips & ~turns_back
        direction = np.zeros_like(guess.direction)
        direction[:, goes_on] = slid[:, goes_on] / size[goes_on]
        direction[:, gives_way] = -tractions[:2, gives_way] / strength[gives_way]
        starts = joins & (size > bound(self._friction, np.abs(gap)))
        direction[:, starts] = slid[:, starts] / size[starts]
        direction[:, leaves] = 0.0
        guess.slip_compliance[:] = 0.0
        moves = goes_on & ~leaves
        guess.slip_compliance[moves] = size[moves] / most[moves]
        if np.isinf(self._friction):  # what its traction pulls off sticks where it touches down, free of traction
            guess.released |= leaves
            anchor = self._anchor[own, :n] = np.where(guess.released, u[:2], anchor)
        bears = contact & (pressure > 0.0)
        self.displacement[i, :n] = np.where(bears, wall, np.minimum(u[2], wall))
        # a slipping node has slid exactly against its traction, any other that bears a pressure not at all; of a long
        # way the direction is known better than that of the traction
        against = np.divide(-forth, strength**2, out=np.zeros(n), where=forth > 0.0)
        far = (forth > 0.0) & (size * self._near.of_a_node > most)
        self._products.tangential[own, :n] = np.where(bears & ~far, anchor + against * tractions[:2], u[:2])
        changed = np.count_nonzero(leaves | joins | gives_way | turns_back)
        if changed > _FALLS * self._changed[i]:
            self._inner[i] = max(_TIGHTEN * self._inner[i], _EXACT)
        self._changed[i] = changed
        guess.contact = (contact | joins) & ~leaves
        guess.direction = direction
        held = np.divide(most, strength, out=np.ones(n), where=strength > most)
        guess.tractions = np.array([*(held * tractions[:2]), np.maximum(pressure, 0.0)])

    def _first_guesses(self, batch: Batch, options: Options) -> tuple[list[MapGuess], Indices]:
        n = self.field.n
        normal = replace(batch, stiffness=batch.map_stiffness.condensed(), interface=HARD_WALL)
        solver = newton(normal, Options("active_set_newton", _SETTLED, _FRICTIONLESS))
        every = active = np.arange(len(batch.punch))
        for _ in range(_FRICTIONLESS):
            solver.advance(active)
            active = active[solver.residual(active) > _SETTLED]
        u, ku = solver.displacement, solver.restoring
        solver.certificate.pressure(u, ku, solver.wall, solver.load, every, n, ku)
        nothing, nowhere = np.zeros((2, n)), np.zeros(n, dtype=np.bool_)
        guesses = [
            MapGuess(p > 0.0, nothing.copy(), np.zeros(n), np.array([0.0 * p, 0.0 * p, p]), nowhere.copy())
            for p in ku[:, :n]
        ]
        return guesses, solver.n_transforms.copy()
