"""Semismooth Newton method for Coulomb friction on a hard wall: all displacements of profiles and maps together."""

from dataclasses import dataclass, replace

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier import grid
from gfmd_numba.interface.slip_rate import SlipRateFriction
from gfmd_numba.interface.vector_slip import length
from gfmd_numba.solvers.friction.friction_guess import (
    Found,
    FrictionGuess,
    FrictionLimits,
    Tangent,
    median_slip_node,
    on_coarser_grid,
)
from gfmd_numba.solvers.friction.linear_problem import CoupledBody, NearTractions, StickSlip, minimal_residual
from gfmd_numba.solvers.iteration import Batch, Start, begin, leave_pressures
from gfmd_numba.solvers.preconditioners import PRECONDITIONERS
from gfmd_numba.solvers.products import Products
from gfmd_numba.solvers.table import Options

_SETTLED, _MOST_SETTLED = 1e-2, 1e-5  # residual with which the first guess of the normal contact is left, later ones
_NORMAL_STEPS = 60  # of that, at most
_COARSENING, _COARSEST = 4, 256  # nodes of a profile over those of the grid its guess is made on; where that is normal
_COARSE_STEPS, _SHARE = 8, 0.02  # there, at most; share of the contact that may still change
_INNER, _INNER_OF_LAW = 0.03, 0.1  # error left by the linear solution of one step over that before it
_FALLS = 0.7  # share of the nodes changed by the last step beyond which the next is solved more exactly
_EXACT = 1e-4  # the most exact of these
_UNSURE = 0.3  # part of the error left by the linear solution by which a sticking node may be above friction
_TIGHTEN = 0.1  # factor on that error, or on the last one, where it was not small enough
_PATIENCE = 4  # steps that may come no closer; then one node alone changes, or the normal contact is found anew
_CLOSER = 0.5  # part of the smallest change of the tractions so far that is closer
_CLOSE = 1e3  # change of the tractions over the residual asked for below which the certificate is looked at


@dataclass
class _Progress:
    """How close the steps of a row have come, and how exactly the next one is solved.

    `last` is the error of the linear solution once the guess stands, `inner` that of one step before over the error it
    begins with. The last step has found `changed` nodes to be guessed wrong, and has `moved` the tractions by that much
    over the largest of them; `fewest` and `nearest` are the least of both. With a law the normal contact has been found
    anew `tries` times, and they count since then. `is_solved`: the last step has solved the problem of a guess that
    stands.
    """

    last: float
    inner: float
    changed: int
    fewest: int
    moved: float = np.inf
    nearest: float = np.inf
    patience: int = _PATIENCE
    tries: int = 0
    is_solved: bool = False

    def judge(self, changed: int, nears: bool) -> None:
        """Take note of how many nodes a step has found to be wrong, and whether it `nears` the solution even so."""
        if changed > _FALLS * self.changed:
            self.inner = max(_TIGHTEN * self.inner, _EXACT)
        comes_closer = changed < self.fewest or nears
        self.patience = _PATIENCE if comes_closer else self.patience - 1
        self.changed, self.fewest = changed, min(changed, self.fewest)
        self.nearest = min(self.moved, self.nearest)


class FrictionalNewton:
    """Tractions of a batch, found by guessing which nodes touch, stick and slip which way (Alart & Curnier 1991).

    The linear problem of a guess is solved by generalised minimal residuals, preconditioned by the approximate inverse
    of each component's compliance; what couples the components is left to the iteration. Then nodes under tension leave
    and overlapping ones join, sticking nodes whose traction is above friction slip, and slipping ones that go along
    with their traction stick. On maps the method also turns the direction of slip. A law of the gap is linear about the
    last gap; its traction does not count in the friction limit.

    The first guess of a profile comes from the waves that a coarser grid holds. There, on maps and with a law it is the
    normal contact under the tangential tractions of the step before, roughly, with all its nodes sticking: so an
    adhesive contact stays on its branch. Where steps come no closer, one node alone changes until fewer want to (Judice
    & Pires 1994). With a law the normal contact is then also found anew, under the tangential tractions found last.

    A node slips from its anchor: its place before this load, moved with the punch since.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options) -> None:
        punch, response, start, laws = batch.punch, batch.response, batch.start, batch.interface
        rows, shape = len(punch), punch.shape[1:]
        if laws.friction is None or not laws.hard_wall:
            raise ValueError("this solver knows friction on a hard wall only")
        self._friction: FrictionLimits = laws.limits if laws.slip_rate is None else laws.slip_rate
        self._law, self._batch = laws.normal_law, batch
        held = response.with_mean(0.0) if response.is_rigid else response
        self._products = products = Products(held, rows, shape, sources=2)
        self._near, self._kind, self.field = NearTractions(response, shape), PRECONDITIONERS[len(shape)], products.field
        n = self.field.n
        u, ku = products.displacement, products.restoring
        anchor, wall = np.zeros_like(u[:, :-1]), np.zeros_like(u[:, -1])
        wall[:, :n] = punch.reshape(rows, n)
        anchor[..., :n] = start.anchor.reshape(rows, -1, n)
        self.state = kernels.SurfaceState(u, ku, wall, batch.loads.copy(), anchor)
        self.certificate = batch.certificate()
        self._condensed = response.condensed()
        self._softest = 1.0 / float(self._condensed.normal.ravel()[1:].min())
        self._drifts = response.drifts
        self._rounding = np.finfo(np.float64).eps * np.ptp(wall[:, :n], axis=1)
        self._asked = options.residual
        # the problem of a guess that stands
        self._is_linear = self._law is None and laws.slip_rate is None and not self._kind.turns
        self._spent = np.zeros(rows, dtype=np.int64)  # transforms of first guesses and preconditioners
        self._guesses = self._first_guesses(batch, options)
        inner = _INNER if self._law is None else _INNER_OF_LAW
        self._progress = [_Progress(options.residual, inner, n, n) for _ in range(rows)]

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation, those of coarser grids in proportion to their cost."""
        return self._products.n_transforms + self._spent

    def advance(self, active: Indices) -> None:
        """Solve the linear problem of the guess of each active row, and revise the guess."""
        for i in active:
            spent = self._near.transforms
            self._step(int(i))
            self._spent[i] += round(self._near.transforms - spent)

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the normal and tangential conditions `[active]`.

        Costs four transforms, six on maps, for each row whose tractions hardly change any more; others are measured
        by that change.
        """
        n, (u, ku, wall, load, _) = self.field.n, self.state
        progress = [self._progress[i] for i in active]
        stands = np.array([each.is_solved or self._is_close(each) for each in progress], dtype=np.bool_)
        sure, strongest = active[stands], np.zeros(active.size)
        self._products.restore(sure)
        if self._law is not None:
            ku[sure, -1, :n] -= self._law.traction(wall[sure, :n] - u[sure, -1, :n])
            gap = wall[active, :n] - u[active, -1, :n]
            strongest = np.abs(self._law.traction(gap)).max(axis=1)
        for i in active[~stands]:
            guess = self._guesses[i]
            ku[i, :-1, :n] = guess.tractions[:-1]
            ku[i, -1, :n] = load[i] - guess.contact * guess.tractions[-1]
        if isinstance(self._friction, SlipRateFriction):
            self.certificate.limits = self._limits(sure)
        residual = self.certificate.look(self.state, active, n, strongest)
        for i in sure[residual[stands] > self._asked]:
            self._progress[i].last *= _TIGHTEN
        unsure = np.maximum([each.moved for each in progress], 10.0 * self._asked)
        return np.where(stands, residual, np.maximum(residual, unsure))

    def _limits(self, rows: Indices) -> kernels.ContactLimits:
        """Limits of the tractions of touching nodes under the pressures and slips of some rows."""
        n, (u, ku, _, load, anchor) = self.field.n, self.state
        friction_limits = np.zeros((len(u), n))
        for i in rows:
            slip = length(u[i, :-1, :n] - anchor[i, :, :n])
            friction_limits[i] = self._friction.friction_limit(load[i] - ku[i, -1, :n], slip)
        return self.certificate.limits._replace(friction_limits=friction_limits)

    def _is_close(self, progress: _Progress) -> bool:
        return progress.moved < _CLOSE * self._asked

    def _first_guesses(self, batch: Batch, options: Options) -> list[FrictionGuess]:
        """Guesses from the waves that a coarser grid holds, of coarse grids and with a law from the normal contact."""
        start, n = batch.start, self.field.n
        every = range(len(batch.punch))
        if self._law is not None or self._kind.turns or n <= _COARSEST:
            return [self._first_guess(i) for i in every]
        coarse = FrictionalNewton(on_coarser_grid(batch, start.anchor, -(-n // _COARSENING)), options)
        for i in every:
            for _ in range(_COARSE_STEPS):
                coarse.advance(np.array([i]))
                if coarse._progress[i].changed <= _SHARE * coarse._guesses[i].contact.sum():
                    break
        self._spent += np.ceil(coarse.n_transforms * grid.relative_cost(coarse.field.n, n)).astype(np.int64)
        return [coarse._guesses[i].on_finer_grid(batch.punch[i], self._friction) for i in every]

    def _first_guess(self, i: int) -> FrictionGuess:
        """Guess of the normal contact under the tangential tractions with which the row begins, all nodes sticking."""
        n, start, state = self.field.n, self._batch.start, self.state
        state.u[i, :-1, :n] = start.tangential[i].reshape(-1, n)
        state.u[i, -1, :n] = np.minimum(start.displacement[i].ravel(), state.wall[i, :n])
        held = (start.displacement[i].ravel() >= state.wall[i, :n]) & start.tangential[i].any()
        shear = np.zeros_like(state.anchor[i, :, :n])
        if held.any():
            self._products.restore(np.array([i]))
            shear = np.where(held, state.restoring[i, :-1, :n], 0.0)
        return self._normal_contact(i, shear)

    def _normal_contact(self, i: int, shear: Reals, settled: float = _SETTLED) -> FrictionGuess:
        """Guess of the normal contact under given tangential tractions, from the displacement stored."""
        n, batch, lifted, wall = self.field.n, self._batch, np.zeros(self.field.n), self.state.wall[i, : self.field.n]
        if shear.any():
            lifted = self._products.deflect(i, np.array([*shear, np.zeros(n)]))[-1]
        shape = (1, *batch.punch.shape[1:])
        punch, start = wall - lifted, self.state.u[i, -1, :n] - lifted
        normal = replace(
            batch,
            punch=punch.reshape(shape),
            response=self._condensed,
            load=None if batch.load is None else self.state.load[[i]],
            interface=replace(batch.interface, friction=None, slip_rate=None),
            begun=replace(Start.at_rest(punch), displacement=start.reshape(shape)),
        )
        solver, row = begin(normal, Options("frictional_newton", settled, _NORMAL_STEPS)), np.arange(1)
        for _ in range(_NORMAL_STEPS):
            solver.advance(row)
            if solver.residual(row)[0] <= settled:
                break
        self._spent[i] += int(solver.n_transforms[0])
        leave_pressures(solver, row)
        found, pressure = solver.state.u[0, -1, :n], solver.state.restoring[0, -1, :n]
        contact = pressure > 0.0
        u = np.where(contact, wall, np.minimum(found + lifted, wall))
        if self._law is not None:
            pressure = np.where(contact, pressure, -self._law.traction(wall - u))
        return FrictionGuess.sticking(contact, np.array([*shear, pressure]), u)

    def _step(self, i: int) -> None:
        guess, progress, n = self._guesses[i], self._progress[i], self.field.n
        total = None if self._batch.load is None else self.state.load[i] * n
        body = CoupledBody(lambda f: self._products.deflect(i, f), self._near, self._friction, total, self._drifts)
        wall = self.state.wall[i, :n]
        law = None if self._law is None else Tangent.of(self._law, wall - guess.normal, self._softest)
        problem = StickSlip(guess, law, body)
        asked = problem.prescribed(self.state.anchor[i, :, :n])
        x = problem.unknowns(guess.tractions)
        u = problem.deflected(x, known=True)
        change, _ = problem.correction(asked - problem.restricted(u, x))
        peak, moved = float(np.abs(x).max(initial=0.0)), float(np.linalg.norm(change))
        stands = progress.changed == 0 and (self._is_linear or self._is_close(progress))
        aim = progress.last * peak if stands else max(progress.last * peak, progress.inner * moved)
        progress.moved = moved / peak if peak > 0.0 else moved and np.inf
        found: list[Reals] = []  # of profiles: maps are too large to keep them

        def product(direction: Reals) -> Reals:
            displaced = problem.deflected(direction)
            if not self._kind.turns:
                found.append(displaced)
            return problem.correction(problem.restricted(displaced, direction))[0]

        basis, coefficients = minimal_residual(product, change, aim, min(self._kind.directions, change.size))
        x += coefficients @ basis
        if not np.isfinite(x).all():
            progress.moved = np.nan
            return
        for coefficient, displaced in zip(coefficients, found, strict=False):
            u += coefficient * displaced
        if self._kind.turns and coefficients.size:
            u = problem.deflected(x, known=True)
        problem.level(u, problem.correction(asked - problem.restricted(u, x))[1])
        self._revise(i, u, problem.tractions(x))
        is_known = problem.stuck.size == wall.size  # the displacement of each node, whatever is left of the error
        progress.is_solved = progress.changed == 0 and (stands or is_known)

    def _revise(self, i: int, u: Reals, tractions: Reals) -> None:
        """Revise the guess of a row, and store the displacement that is nearest to the conditions."""
        n, guess, progress, state = self.field.n, self._guesses[i], self._progress[i], self.state
        wall, anchor, contact = state.wall[i, :n], state.anchor[i, :, :n], guess.contact
        pressure = np.where(contact, tractions[-1], 0.0)
        all_slip = not self._kind.turns and contact.any() and guess.direction[0, contact].all()
        if self._drifts and all_slip and isinstance(self._friction, kernels.ContactLimits):
            slid = u[0] - anchor[0]
            u[0] = anchor[0] + (
                slid - slid[median_slip_node(slid, self._friction.friction_limit(pressure), contact)]
            )  # nothing else tells where it is
        found = Found(u, tractions, wall, anchor)
        unsure = _UNSURE * max(self._asked, progress.inner * min(progress.moved, 1.0)) * float(abs(tractions[-1]).max())
        revision = guess.revision(found, self._friction, self._rounding[i], unsure)
        nears = not self._is_linear and progress.moved < _CLOSER * progress.nearest
        progress.judge(revision.wrong.size, nears or (revision.wrong.size == 0 and self._is_close(progress)))
        if progress.patience < 0 or (progress.tries > 0 and progress.tries % 3 == 0):  # every third try with a law
            revision.keep(guess, revision.wrong[:-1])
        if np.isinf(self.certificate.limits.friction):
            guess.released |= revision.leaves
            anchor[:, guess.released] = u[:-1, guess.released]
        state.u[i, -1, :n] = np.where(contact & (pressure > 0.0), wall, np.minimum(u[-1], wall))
        state.u[i, :-1, :n] = self._slid_against(guess, found)
        pull = guess.revise(revision, found, self._friction, self._law)
        if self.certificate.rigid_mean is not None:  # the mean pressure is the multiplier of a zero mean
            state.load[i] = (guess.tractions[-1] - pull).mean()
        if self._law is None:
            return
        if progress.patience < 0:
            progress.tries += 1
            progress.nearest, progress.fewest, progress.patience = np.inf, n, _PATIENCE
            self._begin_anew(i)
        elif progress.tries % 3 == 2 and (revision.leaves | revision.joins).any():  # in every step of that try
            self._begin_anew(i)

    def _slid_against(self, guess: FrictionGuess, found: Found) -> Reals:
        """Tangential displacements in which a slipping node has slid exactly against its traction, others not at all.

        Of a long way the direction is known better than that of the traction.
        """
        slid, shear, pressure = found.u[:-1] - found.anchor, found.tractions[:-1], found.tractions[-1]
        bears, slips = guess.contact & (pressure > 0.0), guess.direction.any(axis=0)
        forth = np.where(slips, -(slid * shear).sum(axis=0), 0.0)  # slip against the traction, times that
        if not self._kind.turns:
            return np.where(bears & ~(forth > 0.0), found.anchor, found.u[:-1])
        against = np.divide(forth, (shear**2).sum(axis=0), out=np.zeros_like(forth), where=forth > 0.0)
        size = length(slid)
        far = (forth > 0.0) & (size * self._near.tangential_of_a_node > self._friction.friction_limit(pressure, size))
        return np.where(bears & ~far, found.anchor - against * shear, found.u[:-1])

    def _begin_anew(self, i: int) -> None:
        """Find the normal contact under the tangential tractions found."""
        guess = self._guesses[i]
        shear, settled = guess.tractions[:-1] * guess.contact, _SETTLED * _TIGHTEN ** self._progress[i].tries
        found = self._normal_contact(i, shear, max(settled, _MOST_SETTLED))
        found.direction, found.released = guess.direction * found.contact, guess.released
        self._guesses[i] = found
