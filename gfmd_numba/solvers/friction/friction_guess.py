"""Guess of a frictional contact in Newton's method: which nodes touch, which slip which way, and their tractions.

The law is implicit: p is the pressure at the end of the step. With the friction limit f(p) of
`kernels/contact_conditions.py`, a node that slips bears the traction f(p) against its slip since the anchor, and a node
that sticks at most f(p). The anchor is where the node was when the step began, moved with the punch.
`FrictionGuess.revise` makes the next guess: it scales tractions t with |t| > f(p) back onto the Coulomb cone,
t <- t f(p) / |t|.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.fourier.grid import resample
from gfmd_numba.interface.normal_law import NormalLaw
from gfmd_numba.interface.slip_rate import SlipRateFriction
from gfmd_numba.interface.vector_slip import length
from gfmd_numba.kernels import ContactLimits
from gfmd_numba.solvers.iteration import Batch, Start

FrictionLimits = ContactLimits | SlipRateFriction  # both have a `friction_limit`

_FAINT = 1e-6  # slope of the law times the largest compliance below which its traction is taken to be known


class Found(NamedTuple):
    """Solution of the linear problem of a guess, with the wall and anchors that it is judged by, of one row.

    Displacements `u` and `tractions` are `[component + 1, n]`, tangential ones and then normal ones; nodes slip from
    the `anchor` `[component, n]`.
    """

    u: Reals
    tractions: Reals
    wall: Reals
    anchor: Reals


@dataclass
class Revision:
    """Nodes `[n]` that leave the contact or join it, how all slip next, and the nodes that were guessed wrong."""

    leaves: Flags
    joins: Flags
    direction: Reals
    slip_compliance: Reals
    slid: Reals
    wrong: Indices

    def keep(self, guess: "FrictionGuess", nodes: Indices) -> None:
        """Leave some nodes as they were guessed."""
        self.leaves[nodes] = self.joins[nodes] = False
        self.direction[:, nodes] = guess.direction[:, nodes]
        self.slip_compliance[nodes] = 0.0
        self.slid[nodes] = guess.slid[nodes]


@dataclass
class FrictionGuess:
    """Guess of the contact of a row `[n]`, and the tractions found last.

    `contact` are the nodes that touch. `direction` `[component, n]` is the direction in which each of them slips, 0
    where it sticks. `slip_compliance` is the slip over the friction limit of a slipping node, `slid` the slip about
    which rate-dependent friction is linearised. `tractions` `[component + 1, n]` are the tangential ones, then the
    pressure on touching nodes and minus the traction of a law on others, which is linear about the displacement
    `normal`. Nodes that are `released` bear no tangential traction: an infinite friction has pulled them off, and they
    stick where they touch down again.
    """

    contact: Flags
    direction: Reals
    slip_compliance: Reals
    tractions: Reals
    normal: Reals
    released: Flags
    slid: Reals

    @classmethod
    def sticking(cls, contact: Flags, tractions: Reals, normal: Reals) -> Self:
        """Return a guess in which all nodes in contact stick."""
        n = contact.size
        still, none = np.zeros((len(tractions) - 1, n)), np.zeros(n, np.bool_)
        return cls(contact, still, np.zeros(n), tractions, normal, none, np.zeros(n))

    def revision(self, found: Found, friction: FrictionLimits, rounding: float, unsure: float) -> Revision:
        """Return how a solution changes the guess.

        Nodes without pressure leave, and nodes that overlap by more than `rounding` join. A node that joins sticks if
        it slid by less than friction times its overlap, and slips otherwise: as if its trial traction were as stiff
        along the surface as across. A sticking node gives way if its traction exceeds its limit by more than `unsure`.
        """
        pressure, shear = np.where(self.contact, found.tractions[-1], 0.0), found.tractions[:-1]
        slid, overlap = found.u[:-1] - found.anchor, found.u[-1] - found.wall
        size, strength = length(slid), length(shear)
        slips = self.contact & self.direction.any(axis=0)
        limit = friction.friction_limit(pressure, np.where(slips, size, 0.0))
        leaves = self.contact & ~(pressure > 0.0)
        joins = ~self.contact & (overlap > rounding)
        gives_way = self.contact & ~slips & ~leaves & (strength > limit + unsure)
        turns_back = slips & ~((self.direction * slid).sum(axis=0) > 0.0)
        goes_on = slips & ~turns_back & ~leaves
        starts = joins & (size > friction.friction * np.where(joins, overlap, 1.0))
        direction, slip_compliance = np.zeros_like(self.direction), np.zeros_like(size)
        for where, way, of in ((goes_on | starts, slid, size), (gives_way, -shear, strength)):
            direction[:, where] = way[:, where] / of[where]
        slip_compliance[goes_on] = size[goes_on] / limit[goes_on]
        wrong = leaves | joins | gives_way | turns_back
        if isinstance(friction, ContactLimits) and np.isfinite(friction.shear_strength):
            slope = friction.friction - friction.shear_rise
            before, now = slope * np.array([self.tractions[-1], pressure]) - friction.shear_strength
            wrong |= goes_on & ((before > 0.0) != (now > 0.0)) & (abs(now) > unsure)
        begun = np.where(goes_on | starts, size, 0.0)
        return Revision(leaves, joins, direction, slip_compliance, begun, np.flatnonzero(wrong))

    def revise(
        self, revision: Revision, found: Found, friction: FrictionLimits, law: NormalLaw | None
    ) -> Reals | float:
        """Follow a revision; return the traction `[n]` of the law on touching nodes."""
        before, wall = self.contact, found.wall
        self.contact = (before | revision.joins) & ~revision.leaves
        self.direction, self.slip_compliance = revision.direction, revision.slip_compliance
        self.slid = revision.slid
        pressure = np.where(before, np.maximum(found.tractions[-1], 0.0), 0.0)
        limit, strength = friction.friction_limit(pressure, self.slid), length(found.tractions[:-1])
        part = np.divide(limit, strength, out=np.ones_like(limit), where=strength > limit)
        self.tractions = np.array([*(part * found.tractions[:-1]), pressure])
        if law is None:
            self.normal = np.where(self.contact, wall, found.u[-1])
            return 0.0
        free = Tangent.next_normal(law, self.normal, wall, found.u[-1], -found.tractions[-1], ~before)
        self.normal = np.where(self.contact, wall, free)
        pull = law.traction(wall - self.normal)
        self.tractions[-1] = np.where(self.contact, pressure, -pull)
        return np.where(self.contact, pull, 0.0)

    def on_finer_grid(self, wall: Reals, friction: FrictionLimits) -> Self:
        """The same of a profile under a wall `[x]` on a finer grid."""
        n, m = wall.size, self.contact.size
        x = np.arange(n) * (m / n)
        nearest = np.round(x).astype(np.int64) % m
        tractions = np.array([np.interp(x, np.arange(m + 1), np.append(row, row[0])) for row in self.tractions])
        contact = self.contact[nearest] & (tractions[-1] > 0.0)
        tractions *= contact
        most = friction.friction_limit(tractions[-1], self.slid[nearest])
        tractions[:-1] = np.clip(tractions[:-1], -most, most)
        guess = self.sticking(contact, tractions, wall)
        guess.slid = self.slid[nearest] * contact
        guess.direction = self.direction[:, nearest] * contact
        return guess


def median_slip_node(slid: Reals, limit: Reals, contact: Flags) -> int:
    """Node whose slip has as much friction on either side: if it sticks, that of all nodes adds up to zero."""
    nodes = np.flatnonzero(contact)
    order = nodes[np.argsort(slid[nodes], kind="stable")]
    borne = np.cumsum(limit[order])
    return int(order[min(np.searchsorted(borne, 0.5 * borne[-1]), order.size - 1)])


def on_coarser_grid(batch: Batch, anchor: Reals, nx: int) -> Batch:
    """The problem of the waves that a grid of nx nodes holds; its nodes slip from the `anchor` `[realisation, x]`."""
    coarse = batch.coarsened((nx,))
    tangential = np.concatenate([resample(row[np.newaxis], (nx,)) for row in anchor])  # each whatever the others
    return replace(coarse, begun=replace(Start.at_rest(coarse.punch), tangential=tangential))


class Tangent(NamedTuple):
    """A law of the gap, linear about the last gaps: its traction `pull` `[n]`, and its `slope` as the gap closes.

    Where the `slope` `[n]` is 0 the traction is known.
    """

    pull: Reals
    slope: Reals

    @classmethod
    def of(cls, law: NormalLaw, gap: Reals, compliance: float) -> Self:
        """Return the tangent of a law at gaps `[n]`; `compliance` is the largest one of the body."""
        slope = -law.stiffness(gap)
        slope[np.abs(slope) * compliance < _FAINT] = 0.0
        return cls(law.traction(gap), slope)

    @staticmethod
    def next_normal(law: NormalLaw, last: Reals, wall: Reals, u: Reals, traction: Reals, free: Flags) -> Reals:
        """Displacement `[n]` about which the law is linear next, after a step to u in which it has found its traction.

        Where a repulsion rises on a free node that is where the law has the traction found: along its tangent a gap
        would close far beyond what the law allows.
        """
        pull, slope = law.traction(wall - last), -law.stiffness(wall - last)
        rises = free & (slope < 0.0) & (traction < pull) & (pull < 0.0)
        length = np.divide(pull, slope, out=np.zeros_like(pull), where=rises)
        with np.errstate(over="ignore"):
            ratio = np.divide(traction, pull, out=np.ones_like(pull), where=rises)
        return np.minimum(np.where(rises, last + length * np.log(ratio), u), wall)
