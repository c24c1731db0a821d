"""Semismooth Newton method for a hard wall with Coulomb friction: both displacements of a profile together."""

from dataclasses import replace

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.coupled_stiffness import CoupledStiffness
from gfmd_numba.fourier.convolution import aligned_rows
from gfmd_numba.fourier.resampling import resample
from gfmd_numba.solvers.active_set_newton import ActiveSetNewton
from gfmd_numba.solvers.certificate import Certificate
from gfmd_numba.solvers.coupled_products import CoupledProducts
from gfmd_numba.solvers.friction_sets import middle_slip, revised
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Start
from gfmd_numba.solvers.minimal_residual import minimal_residual
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.preconditioners.profile_inverse import ProfileInverse
from gfmd_numba.solvers.stick_slip import StickSlip

_COARSENING, _COARSEST = 4, 256  # nodes over those of the grid the guess is made on; where that is frictionless
_GUESS_STEPS, _SETTLED = 8, 0.02  # there, at most; share of the contact that may still change
_INNER = 0.02  # error left by the linear solution of one step over that before it: with 0.1 guesses may cycle
_FALLS = 0.7  # share of the nodes changed by the last step beyond which the next is solved more exactly
_EXACT = 1e-4  # the most exact of these
_PATIENCE = 4  # steps that may change no fewer nodes than any before; then one node alone is changed
_CLOSE = 1e3  # change of the tractions over the residual asked for below which a changing guess may hold too
_TIGHTEN = 0.1  # factor on that error, or on the last one, where it was not small enough
_DIRECTIONS = 40  # of the linear solution, at most


class FrictionalNewton:
    """Tractions of a batch, found by guessing which nodes touch, stick and slip which way (Alart & Curnier 1991).

    The linear problem of a guess is solved by generalised minimal residuals, preconditioned by the inverses of both
    compliances on its nodes; coupling is left to the iteration. Then nodes under tension leave and overlapping
    ones join, sticking nodes whose traction is above friction slip, and slipping ones that go against their traction
    stick. The first guess is the frictionless contact, all of it sticking.

    A node slips by its distance from the anchor: where the punch held it before this load or, for a node that did not
    touch, where it would be had it moved with the punch since.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options) -> None:
        punch, stiffness, start = batch.punch, batch.coupled_stiffness, batch.start
        rows, n = punch.shape
        if batch.interface.friction is None or not np.isfinite(batch.interface.friction):
            raise ValueError("this solver knows finite friction alone")
        self._friction = batch.interface.friction
        self._products = CoupledProducts(stiffness, rows, n)
        self.field = self._products.field
        self.displacement, self.restoring = self._products.displacement, self._products.restoring
        self.load = batch.loads
        self.wall = aligned_rows(rows, n)
        self.wall[:, :n] = punch
        self.certificate = Certificate(rows)
        self._free_mean = batch.load is not None
        self._rigid_mean = batch.has_rigid_mean
        self._impossible = punch.mean(axis=1) < 0.0  # a rigid mean leaves no room below that of the punch
        self._stiffest = float(stiffness.k33[1:].max())
        self._drifts = stiffness.k11[0] == 0.0
        compliance = stiffness.compliance()
        self._inverses = ProfileInverse(compliance.s11, n), ProfileInverse(compliance.s33, n)
        self._anchor = aligned_rows(rows, n)
        self._anchor[:, :n] = start.tangential + start.dragged
        self._rounding = np.finfo(np.float64).eps * np.ptp(punch, axis=1)
        self._asked = options.residual
        self._target = np.full(rows, options.residual)
        self._inner = np.full(rows, _INNER)
        self._changed = np.full(rows, n)  # nodes whose guess the last step changed
        self._fewest = np.full(rows, n)  # and the fewest that any step did
        self._patience = np.full(rows, _PATIENCE)
        self._moved = np.full(rows, np.inf)  # change of the tractions in it over the largest pressure
        self._guess(batch, options)

    @property
    def tangential(self) -> tuple[Reals, Reals]:
        """Tangential displacement of the body and the traction that restores it."""
        return self._products.tangential, self._products.tangential_restoring

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation."""
        return self._products.n_transforms + self._other_transforms

    def advance(self, active: Indices) -> None:
        """Solve the linear problem of the guess of each active row, and revise the guess."""
        for i in active:
            self._step(int(i))

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the normal and tangential conditions `[active]`.

        Costs four transforms for each row whose guess no longer changes. Others are measured by their last change.
        """
        n, products, certificate = self.field.n, self._products, self.certificate
        if self._rigid_mean:  # no displacement tells the mean pressure: it is the multiplier of a zero mean
            self.load[active] = self._pressure[active].mean(axis=1)
        settled = (self._changed[active] == 0) | (self._moved[active] < _CLOSE * self._asked)
        products.restore(active[settled])
        changing = active[~settled]
        products.tangential_restoring[changing, :n] = self._shear[changing]
        self.restoring[changing, :n] = self.load[changing, np.newaxis] - self._pressure[changing]
        certificate.look(self.displacement, self.restoring, self.wall, self.load, active, n)
        kernels.friction_violation(
            products.tangential, self._anchor, products.tangential_restoring, self.displacement, self.restoring,
            self.wall, self.load, self._friction, active, n, certificate.worst,
        )  # fmt: skip
        if self._rigid_mean:
            drift = self._stiffest * np.abs(self.displacement[active, :n].mean(axis=1))
            certificate.worst[active] = np.maximum(certificate.worst[active], drift)
            certificate.worst[self._impossible] = np.inf
        residual = certificate.residual(self.load, active)
        self._target[active[settled & (residual > self._asked)]] *= _TIGHTEN
        unsure = np.maximum(self._moved[active], 10.0 * self._asked)
        return np.where(settled, residual, np.maximum(residual, unsure))

    def _step(self, i: int) -> None:
        n, products = self.field.n, self._products
        wall, anchor = self.wall[i, :n], self._anchor[i, :n]
        total = self.load[i] * n if self._free_mean else None
        spent = self._spent
        guess = StickSlip(self._contact[i], self._slip[i], self._friction, total, self._drifts, self._inverses)
        asked = guess.restricted(anchor, wall)
        x = guess.unknowns(self._pressure[i], self._shear[i])
        u = products.deflect(i, *guess.tractions(x))
        change, _ = guess.correction(asked - guess.restricted(*u))
        peak = float(np.abs(x).max(initial=0.0))
        aim = self._target[i] * peak
        moved = float(np.linalg.norm(change))
        if self._changed[i]:
            aim = max(aim, self._inner[i] * moved)
        self._moved[i] = moved / peak if peak > 0.0 else moved and np.inf
        found: list[Reals] = []

        def product(direction: Reals) -> Reals:
            found.append(products.deflect(i, *guess.tractions(direction)))
            return guess.correction(guess.restricted(*found[-1]))[0]

        basis, shares = minimal_residual(product, change, aim, min(_DIRECTIONS, change.size))
        x += shares @ basis
        for share, moved in zip(shares, found, strict=False):
            u += share * moved
        self._level(u, guess, guess.correction(asked - guess.restricted(*u))[1])
        self._other_transforms[i] += self._spent - spent
        self._revise(i, u, *guess.tractions(x))

    def _level(self, u: Reals, guess: StickSlip, uniform: Reals) -> None:
        """Move displacements uniformly where no traction tells how far."""
        if guess.normal_is_free:
            u[1] -= uniform[0]
        if guess.drifts:
            u[0] += uniform[-1]

    def _revise(self, i: int, u: Reals, shear: Reals, pressure: Reals) -> None:
        """Revise the guess of a row, and store the displacement that is nearest to the conditions."""
        n = self.field.n
        wall, anchor = self.wall[i, :n], self._anchor[i, :n]
        contact, slip = self._contact[i], self._slip[i]
        slid = u[0] - anchor
        sticks = contact & (slip == 0)
        middle = -1
        if self._drifts and contact.any() and not sticks.any():
            middle = middle_slip(slid, pressure, contact)
            u[0] -= slid[middle]
            slid = u[0] - anchor
        bears = contact & (pressure > 0.0)
        self.displacement[i, :n] = np.where(bears, wall, np.minimum(u[1], wall))
        held = bears & (slip * slid <= 0.0)
        self._products.tangential[i, :n] = np.where(held, anchor, u[0])
        new_contact, new_slip = revised(
            contact, slip, shear, pressure, wall - u[1], slid, self._friction, self._rounding[i]
        )
        if middle >= 0:
            new_slip[middle] = 0
        other = np.flatnonzero((new_contact != contact) | (new_slip != slip))
        if other.size > _FALLS * self._changed[i]:
            self._inner[i] = max(_TIGHTEN * self._inner[i], _EXACT)
        if other.size < self._fewest[i]:
            self._fewest[i], self._patience[i] = other.size, _PATIENCE
        else:
            self._patience[i] -= 1
        self._changed[i] = other.size
        if self._patience[i] < 0:
            other = other[-1:]
        contact[other], slip[other] = new_contact[other], new_slip[other]
        self._pressure[i] = np.maximum(pressure, 0.0)
        self._shear[i] = np.clip(shear, -self._friction * self._pressure[i], self._friction * self._pressure[i])

    @property
    def _spent(self) -> int:
        return round(sum(inverse.transforms for inverse in self._inverses))

    def _guess(self, batch: Batch, options: Options) -> None:
        """Begin with the waves that a coarser grid holds, on the coarsest with the frictionless contact, all sticking."""
        rows, n = batch.punch.shape
        self._shear, self._slip = np.zeros((rows, n)), np.zeros((rows, n), dtype=np.int64)
        active = np.arange(rows)
        if n <= _COARSEST:
            normal = batch.coupled_stiffness.condensed()
            solver = ActiveSetNewton(
                replace(batch, stiffness=normal, interface=HARD_WALL), replace(options, solver="active_set_newton")
            )
            for _ in range(_GUESS_STEPS):
                solver.advance(active)
            self._pressure = solver.pressure[:, :n].copy()
            self._contact = self._pressure > 0.0
            self._other_transforms = solver.n_transforms.copy()
            return
        m = -(-n // _COARSENING)
        coarse = FrictionalNewton(_coarser(batch, self._anchor[:, :n], m), options)
        for _ in range(_GUESS_STEPS):
            coarse.advance(active)
            active = active[coarse._changed[active] > _SETTLED * coarse._contact[active].sum(axis=1)]
        nearest = np.round(np.arange(n) * (m / n)).astype(np.int64) % m
        self._contact, self._slip = coarse._contact[:, nearest], coarse._slip[:, nearest]
        self._pressure = np.where(self._contact, _between(coarse._pressure, n), 0.0)
        self._contact &= self._pressure > 0.0
        self._slip *= self._contact
        limit = self._friction * self._pressure
        self._shear = np.clip(_between(coarse._shear, n), -limit, limit)
        cost = m * np.log(m) / (n * np.log(n))
        self._other_transforms = np.ceil(coarse.n_transforms * cost).astype(np.int64)


def _coarser(batch: Batch, anchor: Reals, m: int) -> Batch:
    """The same problem of the waves that a grid of m nodes holds."""
    fine = batch.coupled_stiffness
    stiffness = CoupledStiffness.on_grid(m, *(k[: m // 2 + 1].copy() for k in (fine.k11, fine.k13, fine.k33)))
    punch, anchor = (np.concatenate([resample(row[np.newaxis], (m,)) for row in rows]) for rows in (batch.punch, anchor))
    return replace(batch, punch=punch, stiffness=stiffness, start=replace(Start.at_rest(punch), tangential=anchor))


def _between(rows: Reals, n: int) -> Reals:
    """Periodic values `[row, m]` on n nodes, linearly between those of m."""
    m = rows.shape[1]
    x = np.arange(n) * (m / n)
    return np.array([np.interp(x, np.arange(m + 1), np.append(row, row[0])) for row in rows])
