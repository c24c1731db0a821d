"""Semismooth Newton method for a hard wall with Coulomb friction: both displacements of a profile together."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier.convolution import aligned_rows
from gfmd_numba.solvers.active_set_newton import ActiveSetNewton
from gfmd_numba.solvers.bounded_newton import newton
from gfmd_numba.solvers.certificate import Certificate, RigidMean
from gfmd_numba.solvers.coupled_products import CoupledProducts
from gfmd_numba.solvers.decay_newton import DecayNewton
from gfmd_numba.solvers.friction_guess import FrictionGuess, on_coarser_grid
from gfmd_numba.solvers.friction_sets import bound, middle_slip, revised
from gfmd_numba.solvers.frictional_law_newton import FrictionalLawNewton
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.map_frictional_newton import MapFrictionalNewton
from gfmd_numba.solvers.map_newton import MapNewton
from gfmd_numba.solvers.minimal_residual import minimal_residual
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.preconditioners.profile_inverse import ProfileInverse
from gfmd_numba.solvers.stick_slip import StickSlip
from gfmd_numba.solvers.truncated_newton import TruncatedNewton

# tuned on half-spaces of 2^13 nodes at H = 0.3 and 0.8; other values cost slightly more transforms
_COARSENING, _COARSEST = 4, 256  # nodes over those of the grid the guess is made on; where that is frictionless
_COARSE_STEPS, _SETTLED = 8, 0.02  # there, at most; share of the contact that may still change
_INNER = 0.02  # error left by the linear solution of one step over that before it: with 0.1 guesses may cycle
_FALLS = 0.7  # share of the nodes changed by the last step beyond which the next is solved more exactly
_EXACT = 1e-4  # the most exact of these
_TIGHTEN = 0.1  # factor on that error, or on the last one, where it was not small enough
_PATIENCE = 4  # steps that may change no fewer nodes than any before; then one node alone is changed
_CLOSE = 1e3  # change of the tractions over the residual asked for below which a changing guess may hold too
_DIRECTIONS = 40  # of the linear solution, at most


def frictional_newton(batch: Batch, options: Options) -> "FrictionalNewton | MapFrictionalNewton | FrictionalLawNewton":
    """Begin the method for profiles or for maps, or for either with a law of the gap."""
    if batch.interface.normal_law is not None:
        return FrictionalLawNewton(batch, options)
    return FrictionalNewton(batch, options) if batch.punch.ndim == 2 else MapFrictionalNewton(batch, options)


def frictionless_newton(batch: Batch, options: Options) -> TruncatedNewton | ActiveSetNewton | DecayNewton | MapNewton:
    """Begin Newton's method where friction has no effect, with or without a law of the gap."""
    return TruncatedNewton(batch, options) if batch.interface.normal_law is not None else newton(batch, options)


class FrictionalNewton:
    """Tractions of a batch, found by guessing which nodes touch, stick and slip which way (Alart & Curnier 1991).

    The linear problem of a guess is solved by generalised minimal residuals, preconditioned by the inverses of both
    compliances on its nodes; their coupling is left to the iteration. Then nodes under tension leave and overlapping
    ones join, sticking nodes whose traction is above friction slip, and slipping ones that go along with their
    traction stick. Where that goes to and fro, one node alone changes until fewer want to (Judice & Pires 1994). The
    first guess comes from the waves that a coarser grid holds, there from the frictionless contact.

    A node slips from its anchor: where it was before this load, had it moved with the punch since. For a node that
    touched that is where the punch held it.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options) -> None:
        punch, stiffness, start = batch.punch, batch.coupled_stiffness, batch.start
        rows, n = punch.shape
        if batch.interface.friction is None:
            raise ValueError("this solver knows contacts with friction alone")
        self._friction = batch.interface.friction
        self._products = CoupledProducts(stiffness, rows, n, punch.dtype)
        self.field = self._products.field
        self.displacement, self.restoring = self._products.displacement, self._products.restoring
        self.load = batch.loads
        self.wall, self._anchor = (aligned_rows(rows, n, punch.dtype) for _ in range(2))
        self.wall[:, :n] = punch
        self._anchor[:, :n] = start.tangential + start.dragged
        self.certificate = Certificate(rows, rigid_mean=RigidMean.of(punch, stiffness.k33))
        self._free_mean = batch.load is not None
        self._drifts = stiffness.k11[0] == 0.0
        compliance = stiffness.compliance()
        self._inverses = ProfileInverse(compliance.s11, n), ProfileInverse(compliance.s33, n)
        self._rounding = np.finfo(punch.dtype).eps * np.ptp(punch, axis=1)
        self._asked = options.residual
        self._last = np.full(rows, options.residual)  # error of the linear solution once the guess stands
        self._inner = np.full(rows, _INNER)
        self._changed = np.full(rows, n)  # nodes that the last step found to be guessed wrong
        self._fewest = np.full(rows, n)  # and the fewest that any step did
        self._patience = np.full(rows, _PATIENCE)
        self._moved = np.full(rows, np.inf)  # change of the tractions in the last step over the largest pressure
        # nodes that stick where they touch down, free of traction, as an infinite friction has pulled them off before
        self._released = np.zeros((rows, n), dtype=np.bool_)
        self._guess = self._first_guess(batch, options)

    @property
    def tangential(self) -> tuple[Reals, Reals, Reals]:
        """Tangential displacement of the body, the traction that restores it, and from where it slips."""
        return self._products.tangential, self._products.tangential_restoring, self._anchor

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation, those of coarser grids in proportion to their cost."""
        return self._products.n_transforms + self._guess.transforms

    def advance(self, active: Indices) -> None:
        """Solve the linear problem of the guess of each active row, and revise the guess."""
        for i in active:
            self._step(int(i))

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the normal and tangential conditions `[active]`.

        Costs four transforms for each row whose guess hardly changes any more; others are measured by their last step.
        """
        n, products, certificate, guess = self.field.n, self._products, self.certificate, self._guess
        if certificate.rigid_mean is not None:  # the mean pressure is the multiplier of a zero mean
            self.load[active] = guess.pressure[active].mean(axis=1)
        stands = (self._changed[active] == 0) | (self._moved[active] < _CLOSE * self._asked)
        products.restore(active[stands])
        changing = active[~stands]
        products.tangential_restoring[changing, :n] = guess.shear[changing]
        self.restoring[changing, :n] = self.load[changing, np.newaxis] - guess.pressure[changing]
        certificate.look(self.displacement, self.restoring, self.wall, self.load, active, n)
        kernels.friction_violation(
            products.tangential, self._anchor, products.tangential_restoring, self.displacement, self.restoring,
            self.wall, self.load, self._friction, active, n, certificate.worst,
        )  # fmt: skip
        residual = certificate.residual(self.load, active)
        self._last[active[stands & (residual > self._asked)]] *= _TIGHTEN
        unsure = np.maximum(self._moved[active], 10.0 * self._asked)
        return np.where(stands, residual, np.maximum(residual, unsure))

    def _step(self, i: int) -> None:
        n, products, guess = self.field.n, self._products, self._guess
        total = self.load[i] * n if self._free_mean else None
        spent = self._spent
        contact, slip, released = guess.contact[i], guess.slip[i], self._released[i]
        problem = StickSlip(contact, slip, self._friction, total, self._drifts, self._inverses, released)
        asked = problem.restricted(self._anchor[i, :n], self.wall[i, :n])
        x = problem.unknowns(guess.pressure[i], guess.shear[i])
        u = products.deflect(i, *problem.tractions(x))
        change, _ = problem.correction(asked - problem.restricted(*u))
        peak, moved = float(np.abs(x).max(initial=0.0)), float(np.linalg.norm(change))
        aim = self._last[i] * peak
        if self._changed[i]:
            aim = max(aim, self._inner[i] * moved)
        self._moved[i] = moved / peak if peak > 0.0 else moved and np.inf
        found: list[Reals] = []

        def product(direction: Reals) -> Reals:
            found.append(products.deflect(i, *problem.tractions(direction)))
            return problem.correction(problem.restricted(*found[-1]))[0]

        basis, shares = minimal_residual(product, change, aim, min(_DIRECTIONS, change.size))
        x += shares @ basis
        for share, displaced in zip(shares, found, strict=False):
            u += share * displaced
        problem.level(u, problem.correction(asked - problem.restricted(*u))[1])
        guess.transforms[i] += self._spent - spent
        self._revise(i, u, *problem.tractions(x))

    def _revise(self, i: int, u: Reals, shear: Reals, pressure: Reals) -> None:
        """Revise the guess of a row, and store the displacement that is nearest to the conditions."""
        n, guess = self.field.n, self._guess
        wall, anchor, contact, slip = self.wall[i, :n], self._anchor[i, :n], guess.contact[i], guess.slip[i]
        middle = -1
        if self._drifts and contact.any() and not (contact & (slip == 0)).any():
            middle = middle_slip(u[0] - anchor, pressure, contact)
            u[0] -= u[0, middle] - anchor[middle]
        slid = u[0] - anchor
        if middle >= 0:
            slid[middle] = 0.0  # whatever rounding leaves of it
        bears = contact & (pressure > 0.0)
        self.displacement[i, :n] = np.where(bears, wall, np.minimum(u[1], wall))
        stays = bears & (slip * slid <= 0.0)
        better = revised(contact, slip, shear, pressure, wall - u[1], slid, self._friction, self._rounding[i])
        if middle >= 0:  # nothing held the body, so that all may have slipped the wrong way
            better[1][:] = np.sign(slid) * better[0]
        wrong = np.flatnonzero((better[0] != contact) | (better[1] != slip))
        other = self._to_change(i, wrong, whole=middle >= 0 or np.isinf(self._friction))
        if np.isinf(self._friction):
            self._released[i, other] |= contact[other] & ~better[0][other]
            anchor[:] = np.where(self._released[i], u[0], anchor)
        self._products.tangential[i, :n] = np.where(stays, anchor, u[0])
        contact[other], slip[other] = better[0][other], better[1][other]
        guess.pressure[i] = np.maximum(pressure, 0.0)
        most = bound(self._friction, guess.pressure[i])
        guess.shear[i] = np.clip(shear, -most, most)

    def _to_change(self, i: int, wrong: Indices, whole: bool) -> Indices:
        """Nodes of a row, of those guessed wrong, that are to change: the `whole`, or one where that leads nowhere."""
        if wrong.size > _FALLS * self._changed[i]:
            self._inner[i] = max(_TIGHTEN * self._inner[i], _EXACT)
        if wrong.size < self._fewest[i]:
            self._fewest[i], self._patience[i] = wrong.size, _PATIENCE
        else:
            self._patience[i] -= 1
        self._changed[i] = wrong.size
        return wrong if whole or self._patience[i] >= 0 else wrong[-1:]

    @property
    def _spent(self) -> int:
        """Transforms made so far by preconditioners."""
        return round(sum(inverse.transforms for inverse in self._inverses))

    def _first_guess(self, batch: Batch, options: Options) -> FrictionGuess:
        rows, n = batch.punch.shape
        if n <= _COARSEST:
            return FrictionGuess.without_friction(batch, options)
        coarse = FrictionalNewton(on_coarser_grid(batch, self._anchor[:, :n], -(-n // _COARSENING)), options)
        active = np.arange(rows)
        for _ in range(_COARSE_STEPS):
            coarse.advance(active)
            active = active[coarse._changed[active] > _SETTLED * coarse._guess.contact[active].sum(axis=1)]
        coarse._guess.transforms += coarse._products.n_transforms
        return coarse._guess.on_finer_grid(n, self._friction)
