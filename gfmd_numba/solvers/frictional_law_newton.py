"""Semismooth Newton method for Coulomb friction on a hard wall with a law of the gap, on profiles and maps."""

from dataclasses import replace

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.elasticity.coupled_stiffness import CoupledStiffness
from gfmd_numba.fourier.convolution import aligned_rows
from gfmd_numba.solvers.certificate import Certificate, RigidMean
from gfmd_numba.solvers.coupled_products import CoupledProducts
from gfmd_numba.solvers.friction_sets import bound, middle_slip
from gfmd_numba.solvers.iteration import Batch, Start, by_component
from gfmd_numba.solvers.law_guess import LawGuess, descended, next_normal
from gfmd_numba.solvers.law_stick_slip import LawStickSlip
from gfmd_numba.solvers.map_products import MapProducts
from gfmd_numba.solvers.minimal_residual import minimal_residual
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.preconditioners.law_tractions import MapTractions, ProfileTractions

_SETTLED, _MOST_SETTLED = 1e-2, 1e-5  # residual with which the first descent of the normal contact is left, later ones
_INNER = 0.1  # error left by the linear solution of one step over that before it
_FALLS = 0.7  # share of the nodes changed by the last step beyond which the next is solved more exactly
_EXACT = 1e-4  # the most exact of these
_TIGHTEN = 0.1  # factor on that error, or on the last one, where it was not small enough
_PATIENCE = 4  # steps that may come no closer before the normal contact is descended to anew
_CLOSER = 0.5  # part of the smallest change of the tractions so far that is closer
_CLOSE = 1e3  # change of the tractions over the residual asked for below which the certificate is looked at
_DIRECTIONS = {1: 100, 2: 40}  # of the linear solution, at most; of maps fewer, as these are large
_FAINT = 1e-6  # slope of the law times the largest compliance below which its traction is taken to be known


class FrictionalLawNewton:
    """Tractions and displacements of a batch, found as `FrictionalNewton` finds tractions on a hard wall alone.

    Before the first step, and where steps come no closer, the normal contact descends its energy under the
    tangential tractions found last (`TruncatedNewton`), so that an adhesive contact stays on its branch. A step of
    Newton's method then takes the law as linear about the last gap. The bound of friction is what the wall bears: the
    traction of the law does not count. Raises ValueError unless friction, a law of the gap and a wall all act.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options) -> None:
        punch, stiffness, start, law = batch.punch, batch.all_stiffness, batch.start, batch.interface.normal_law
        rows, shape = len(punch), punch.shape[1:]
        if batch.interface.friction is None or law is None or not batch.interface.hard_wall:
            raise ValueError("this solver knows friction with a law of the gap only")
        self._friction, self._law, self._batch = batch.interface.friction, law, batch
        self._products: CoupledProducts | MapProducts
        self._near: ProfileTractions | MapTractions
        if isinstance(stiffness, CoupledStiffness):
            self._products, self._near = (
                CoupledProducts(stiffness, rows, shape[0], punch.dtype),
                ProfileTractions(stiffness, *shape),
            )
        else:
            self._products, self._near = (
                MapProducts(stiffness, rows, shape, punch.dtype),
                MapTractions(stiffness, shape),
            )
        self.field, self._components = self._products.field, len(shape)
        n = self.field.n
        self.displacement, self.restoring = self._products.displacement, self._products.restoring
        self.load = batch.loads.copy()
        self.wall, self._anchor = (aligned_rows(each, n, punch.dtype) for each in (rows, self._components * rows))
        self.wall[:, :n] = punch.reshape(rows, n)
        self._anchor[:, :n] = by_component(start.tangential + start.dragged, n)
        self.certificate = Certificate(rows, rigid_mean=RigidMean.of(punch, stiffness.k33))
        self._condensed = stiffness.condensed()
        self._softest = 1.0 / float(self._condensed.ravel()[1:].min())
        self._drifts = bool(stiffness.k11.flat[0] == 0.0)
        self._rounding = np.finfo(punch.dtype).eps * np.ptp(self.wall[:, :n], axis=1)
        self._asked = options.residual
        self._spent = np.zeros(rows, dtype=np.int64)  # transforms of descents
        self._guesses = [self._first_guess(i) for i in range(rows)]
        self._last = np.full(rows, options.residual)  # error of the linear solution once the guess stands
        self._inner = np.full(rows, _INNER)
        self._changed = np.full(rows, n)  # nodes that the last step found to be guessed wrong
        self._moved = np.full(rows, np.inf)  # change of the tractions in the last step over the largest of them
        self._tries = np.zeros(rows, dtype=np.int64)
        self._nearest, self._fewest = np.full(rows, np.inf), np.full(rows, n)  # the least of both
        self._patience = np.full(rows, _PATIENCE)

    @property
    def tangential(self) -> tuple[Reals, Reals, Reals]:
        """Tangential displacement of the body, the traction that restores it, and from where it slips."""
        return self._products.tangential, self._products.tangential_restoring, self._anchor

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation."""
        return self._products.n_transforms + self._spent

    def advance(self, active: Indices) -> None:
        """Solve the linear problem of the guess of each active row, and revise the guess."""
        for i in active:
            self._step(int(i))

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the normal and tangential conditions `[active]`.

        Costs four transforms, six on maps, for each row whose tractions hardly change; others have that change.
        """
        n, products, certificate = self.field.n, self._products, self.certificate
        residual = np.maximum(self._moved[active], 10.0 * self._asked)
        certificate.worst[active] = 0.0
        stands = self._moved[active] < _CLOSE * self._asked
        sure = active[stands]
        products.restore(sure)
        self._law.pull(self.displacement, self.restoring, self.wall, sure, n)
        certificate.look(self.displacement, self.restoring, self.wall, self.load, sure, n)
        violation = kernels.friction_violation if self._components == 1 else kernels.map_friction_violation
        violation(
            products.tangential, self._anchor, products.tangential_restoring, self.displacement, self.restoring,
            self.wall, self.load, self._friction, sure, n, certificate.worst,
        )  # fmt: skip
        strongest = np.abs(self._law.traction(self.wall[sure, :n] - self.displacement[sure, :n])).max(axis=1, initial=0)
        residual[stands] = certificate.residual(self.load, sure, strongest)
        self._last[sure[residual[stands] > self._asked]] *= _TIGHTEN
        return np.asarray(residual)

    def _own(self, i: int) -> list[int]:
        """Rows of the tangential components of a row."""
        return [i + component * len(self.load) for component in range(self._components)]

    def _deflect(self, i: int, tractions: Reals) -> Reals:
        """Displacements `[component, n]` of a row under tractions on the body."""
        if isinstance(self._products, CoupledProducts):
            return self._products.deflect(i, tractions[0], -tractions[1])
        return self._products.deflect(i, tractions)

    def _first_guess(self, i: int) -> LawGuess:
        """Guess of the normal contact under the tangential tractions with which the row begins, all nodes sticking."""
        n, start, products = self.field.n, self._batch.start, self._products
        row = np.array([i])
        products.tangential[self._own(i), :n] = by_component(start.tangential, n)[self._own(i)]
        self.displacement[i, :n] = np.minimum(start.displacement.reshape(-1, n)[i], self.wall[i, :n])
        held = ~np.isnan(by_component(start.anchor, n)[self._own(i)])
        shear = np.zeros((self._components, n))
        if held.any():
            products.restore(row)
            shear = np.where(held, products.tangential_restoring[self._own(i), :n], 0.0)
        return self._descended(i, shear)

    def _descended(self, i: int, shear: Reals, settled: float = _SETTLED) -> LawGuess:
        """Guess of the normal contact under given tangential tractions, from the displacement stored."""
        n, batch, lifted = self.field.n, self._batch, np.zeros(self.field.n)
        if shear.any():
            lifted = self._deflect(i, np.array([*shear, np.zeros(n)]))[-1]
        shape = (1, *batch.punch.shape[1:])
        punch, start = self.wall[i, :n] - lifted, self.displacement[i, :n] - lifted
        normal = replace(
            batch,
            punch=punch.reshape(shape),
            stiffness=self._condensed,
            load=None if batch.load is None else self.load[[i]],
            interface=replace(batch.interface, friction=None),
            start=replace(Start.at_rest(punch), displacement=start.reshape(shape)),
        )
        found, pressure, transforms = descended(normal, settled)
        self._spent[i] += transforms
        wall, contact = self.wall[i, :n], pressure > 0.0
        u = np.where(contact, wall, np.minimum(found + lifted, wall))
        pressure = np.where(contact, pressure, -self._law.traction(wall - u))
        return LawGuess.sticking(contact, np.array([*shear, pressure]), u)

    def _step(self, i: int) -> None:
        n, guess = self.field.n, self._guesses[i]
        gap = self.wall[i, :n] - guess.normal
        pull, slope = self._law.traction(gap), -self._law.stiffness(gap)
        slope[np.abs(slope) * self._softest < _FAINT] = 0.0
        total = None if self._batch.load is None else self.load[i] * n
        problem = LawStickSlip(
            guess, pull, slope, self._friction, total, self._drifts, lambda f: self._deflect(i, f), self._near
        )
        asked = problem.prescribed(self._anchor[self._own(i), :n])
        x = problem.unknowns(guess.tractions)
        u = problem.deflected(x, known=True)
        change, _ = problem.correction(asked - problem.restricted(u, x))
        peak, moved = float(np.abs(x).max(initial=0.0)), float(np.linalg.norm(change))
        aim = self._last[i] * peak
        if self._changed[i] or self._moved[i] > _CLOSE * self._asked:
            aim = max(aim, self._inner[i] * moved)
        self._moved[i] = moved / peak if peak > 0.0 else moved and np.inf
        found: list[Reals] = []  # of profiles: maps are too large to keep them

        def product(direction: Reals) -> Reals:
            displaced = problem.deflected(direction)
            if self._components == 1:
                found.append(displaced)
            return problem.correction(problem.restricted(displaced, direction))[0]

        basis, shares = minimal_residual(product, change, aim, min(_DIRECTIONS[self._components], change.size))
        x += shares @ basis
        if not np.isfinite(x).all():
            self._moved[i] = np.nan
            return
        for share, displaced in zip(shares, found, strict=False):
            u += share * displaced
        if self._components > 1 and shares.size:
            u = problem.deflected(x, known=True)
        problem.level(u, problem.correction(asked - problem.restricted(u, x))[1])
        self._revise(i, u, problem.tractions(x))

    def _revise(self, i: int, u: Reals, tractions: Reals) -> None:
        """Revise the guess of a row, and store the displacement that is nearest to the conditions."""
        n, guess, own = self.field.n, self._guesses[i], self._own(i)
        wall, anchor, contact = self.wall[i, :n], self._anchor[own, :n], guess.contact
        pressure = np.where(contact, tractions[-1], 0.0)
        slid, held = u[:-1] - anchor, bound(self._friction, pressure)
        sticks = contact & ~guess.direction.any(axis=0)
        if self._components == 1 and self._drifts and contact.any() and not sticks.any():
            slid -= slid[0, middle_slip(slid[0], pressure, contact)]  # nothing else tells where the body is
            u[:-1] = anchor + slid
        size, strength = np.sqrt((slid**2).sum(axis=0)), np.sqrt((tractions[:-1] ** 2).sum(axis=0))
        slips = contact & ~sticks
        leaves = contact & ~(pressure > 0.0)
        joins = ~contact & (u[-1] - wall > self._rounding[i])
        gives_way = sticks & ~leaves & (strength > held)
        turns_back = slips & ~((guess.direction * slid).sum(axis=0) > 0.0)
        goes_on = slips & ~turns_back & ~leaves
        direction = np.zeros_like(guess.direction)
        direction[:, goes_on] = slid[:, goes_on] / size[goes_on]
        direction[:, gives_way] = -tractions[:-1, gives_way] / strength[gives_way]
        starts = joins & (size > bound(self._friction, u[-1] - wall))
        direction[:, starts] = slid[:, starts] / size[starts]
        guess.slip_compliance[:] = 0.0
        guess.slip_compliance[goes_on] = size[goes_on] / held[goes_on]
        bears = contact & ~leaves
        wrong = np.flatnonzero(leaves | joins | gives_way | turns_back)
        self._judge_progress(i, wrong.size)
        if self._tries[i] > 0 and self._tries[i] % 3 == 0 and wrong.size > 1:
            others = wrong[:-1]
            leaves[others] = joins[others] = False
            direction[:, others] = guess.direction[:, others]
            guess.slip_compliance[others] = 0.0
        if np.isinf(self._friction):
            guess.released |= leaves
            anchor = self._anchor[own, :n] = np.where(guess.released, u[:-1], anchor)
        guess.contact = (contact | joins) & ~leaves
        guess.direction = direction
        part = np.divide(held, strength, out=np.ones(n), where=strength > held)
        self.displacement[i, :n] = np.where(bears, wall, np.minimum(u[-1], wall))
        self._products.tangential[own, :n] = self._slid_against(u[:-1], anchor, tractions[:-1], bears, slips, held)
        guess.normal = np.where(
            guess.contact, wall, next_normal(self._law, guess.normal, wall, u[-1], -tractions[-1], ~contact)
        )
        pull = self._law.traction(wall - guess.normal)
        own_pressure = np.where(guess.contact, np.maximum(pressure, 0.0), -pull)
        guess.tractions = np.array([*(part * tractions[:-1]), own_pressure])
        if self._patience[i] < 0:
            self._tries[i] += 1
            self._nearest[i], self._fewest[i], self._patience[i] = np.inf, n, _PATIENCE
            self._begin_anew(i)
        elif self._tries[i] % 3 == 2 and (leaves | joins).any():
            self._begin_anew(i)
        if self.certificate.rigid_mean is not None:  # the mean pressure is the multiplier of a zero mean
            self.load[i] = (own_pressure - np.where(guess.contact, pull, 0.0)).mean()

    def _slid_against(self, u: Reals, anchor: Reals, shear: Reals, bears: Flags, slips: Flags, held: Reals) -> Reals:
        """Tangential displacements in which a slipping node has slid exactly against its traction, others not."""
        slid = u - anchor
        forth = np.where(slips, -(slid * shear).sum(axis=0), 0.0)
        if self._components == 1:
            return np.where(bears & ~(forth > 0.0), anchor, u)
        size = np.hypot(*slid)
        against = np.divide(forth, (shear**2).sum(axis=0), out=np.zeros_like(forth), where=forth > 0.0)
        far = (forth > 0.0) & (size * self._near.tangential_of_a_node > held)
        return np.where(bears & ~far, anchor - against * shear, u)

    def _judge_progress(self, i: int, changed: int) -> None:
        """Remember how far a step has come; patience runs out where steps come no closer."""
        if changed > _FALLS * self._changed[i]:
            self._inner[i] = max(_TIGHTEN * self._inner[i], _EXACT)
        self._changed[i] = changed
        comes_closer = self._moved[i] < _CLOSER * self._nearest[i] or changed < self._fewest[i]
        comes_closer |= changed == 0 and self._moved[i] < _CLOSE * self._asked
        self._patience[i] = _PATIENCE if comes_closer else self._patience[i] - 1
        self._nearest[i], self._fewest[i] = min(self._moved[i], self._nearest[i]), min(changed, self._fewest[i])

    def _begin_anew(self, i: int) -> None:
        """Descend to the normal contact under the tangential tractions found."""
        guess = self._guesses[i]
        shear = guess.tractions[:-1] * guess.contact
        found = self._descended(i, shear, max(_SETTLED * _TIGHTEN ** self._tries[i], _MOST_SETTLED))
        found.direction, found.released = guess.direction * found.contact, guess.released
        self._guesses[i] = found
