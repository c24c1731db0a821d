"""The linear problem of friction with a law of the gap, once it is guessed which nodes touch, stick and slip.

Unknown are the pressure of the wall on touching nodes and minus the traction of the law on others, both tangential
tractions on sticking nodes, and on maps the traction of a slipping node across its slip, as in `map_stick_slip`. The
law is linear about the last gap: traction = given + slope (u - last u).
"""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.solvers.law_guess import LawGuess

# slope of a repulsion times the compliance of a node from which on it is told by its inverse, where not every law is
_STIFF = 0.3


class Preconditioner(Protocol):
    """Approximate inverse of the compliance on some nodes, of each component as if alone."""

    normal_of_a_node: float  # stiffness of a node among others that are held
    tangential_of_a_node: float
    takes_law: bool  # whether nodes may have a compliance of their own in addition, of either sign

    def order(self, flags: Flags) -> Indices:
        """Return the nodes in the order in which `factor` takes them."""
        ...

    def factor(self, nodes: Indices, dragged: Indices, own: Reals) -> None:
        """Prepare `solve` for some nodes, and for those of them with tangential tractions of their own.

        `own` `[node]` are the compliances that each node has in addition.
        """
        ...

    def solve(self, normal: Reals, tangential: Reals) -> tuple[Reals, Reals]:
        """Return the pressure `[node]` and tractions `[component, dragged]` that about cause displacements."""
        ...


class LawStickSlip:
    """Nodes and loads of one guess, its compliance, and an approximate inverse of that.

    `pull` and `slope` `[n]` are the traction of the law and what it rises by as the gap closes; where the latter
    is 0 the traction is known. `total` is the sum of the tractions that the load prescribes, None under a prescribed
    displacement. `drifts`: no traction restores the mean tangential displacement.
    """

    def __init__(
        self,
        guess: LawGuess,
        pull: Reals,
        slope: Reals,
        friction: float,
        total: float | None,
        drifts: bool,
        deflect: Callable[[Reals], Reals],
        near: Preconditioner,
    ) -> None:
        self._deflect, self._near, self._shape = deflect, near, guess.tractions.shape
        contact, components = guess.contact, len(guess.direction)
        acts = ~contact & (slope != 0.0)
        stiff = acts if near.takes_law else acts & (-slope * _STIFF**-1 > near.normal_of_a_node)
        held = near.order(contact | stiff)
        self._pressed = np.concatenate((held, np.flatnonzero(acts & ~stiff)))
        self._held = held.size
        self._known = np.where(contact | ~acts, pull, 0.0)
        slope, touches = slope[self._pressed], contact[self._pressed]
        scale = np.where(stiff[self._pressed], -1.0 / np.where(slope == 0.0, 1.0, slope), 1.0)
        self._own = np.where(touches, 0.0, scale)  # of each row: own tractions - closing * displacements
        self._closing = np.where(touches, 1.0, -slope * scale)
        at = guess.normal[self._pressed]
        self._asked = np.where(touches, -at, -scale * pull[self._pressed] - self._closing * at)
        own = self._own[: self._held]
        self._soften = 1.0 if near.takes_law else 1.0 / np.sqrt(1.0 + own * near.normal_of_a_node)
        slips = np.asarray(guess.direction.any(axis=0))
        of_touching = np.flatnonzero(touches)
        of_slipping = of_touching[slips[self._pressed[of_touching]]]
        self._of_stuck = of_touching[~(slips | guess.released)[self._pressed[of_touching]]]
        self.stuck, self._of_slipping = self._pressed[self._of_stuck], of_slipping
        self.slipping = self._pressed[of_slipping]
        along = guess.direction[:, self.slipping]
        self._drag = -friction * along  # tangential traction over pressure
        self._turning = self.slipping if components == 2 else self.slipping[:0]
        self._across = np.array([-along[1], along[0]]) if components == 2 else along[:, :0]
        self._slip_compliance = guess.slip_compliance[self._turning]
        self._yield = 1.0 / np.sqrt(1.0 + self._slip_compliance * near.tangential_of_a_node)
        near.factor(held, np.concatenate((self._of_stuck, of_slipping[: self._turning.size])), own)
        sizes = self._pressed.size, components * self.stuck.size
        self._parts: list[int] = np.cumsum(sizes).tolist()
        self._normal_is_free = total is not None
        self._drifts = drifts and self.stuck.size + self._turning.size > 0
        sums, takers, prescribed = [], [], []
        turning = np.zeros(self._turning.size)
        none = np.zeros((components, self.stuck.size))
        if total is not None:
            sums.append(self._join(np.ones(sizes[0]), none, turning))
            takers.append(self._join(self._closing, none, turning))
            prescribed.append(total + self._known.sum())
        for component in range(components if self._drifts else 0):
            unit, dragged = none.copy(), np.zeros(sizes[0])
            unit[component] = 1.0
            dragged[of_slipping] = self._drag[component]
            sums.append(self._join(dragged, unit, self._across[component]))
            takers.append(self._join(np.zeros(sizes[0]), unit, self._across[component]))
            prescribed.append(0.0)
        rows = len(sums), self._parts[1] + self._turning.size
        self._sums = np.array(sums).reshape(rows)
        self._uniform = np.array([self._inverse(each) for each in takers]).reshape(rows)
        self._prescribed = np.array(prescribed, dtype=np.float64)
        self._taken = np.linalg.pinv(self._sums @ self._uniform.T, rcond=1e-10)

    def unknowns(self, tractions: Reals) -> Reals:
        """Return the unknowns `[unknown]` with the prescribed sums that are nearest to tractions `[component, n]`."""
        across = (self._across * tractions[:-1, self._turning]).sum(axis=0)
        x = self._join(tractions[-1, self._pressed], tractions[:-1, self.stuck], across)
        return np.asarray(x + (self._taken @ (self._prescribed - self._sums @ x)) @ self._uniform)

    def tractions(self, x: Reals) -> Reals:
        """Tangential tractions and pressures `[component, n]` of the unknowns."""
        pressure, sticking, across = np.split(x, self._parts)
        found = np.zeros(self._shape)
        found[-1, self._pressed] = pressure
        found[:-1, self.slipping] = self._drag * pressure[self._of_slipping]
        found[:-1, self.stuck] = sticking.reshape(self._shape[0] - 1, self.stuck.size)
        found[:-1, self._turning] += self._across * across
        return found

    def deflected(self, x: Reals, known: bool = False) -> Reals:
        """Displacements `[component, n]` that the unknowns cause, on request with the known tractions of the law."""
        tractions = self.tractions(x)
        np.negative(tractions[-1], out=tractions[-1])
        if known:
            tractions[-1] += self._known
        return self._deflect(tractions)

    def prescribed(self, anchor: Reals) -> Reals:
        """Right-hand side of the linear problem `[unknown]`."""
        across = (self._across * anchor[:, self._turning]).sum(axis=0)
        return self._join(self._asked, anchor[:, self.stuck], across)

    def restricted(self, u: Reals, x: Reals) -> Reals:
        """Left-hand side `[unknown]` of the unknowns, which cause displacements `[component, n]`."""
        pressure, _, turning = np.split(x, self._parts)
        across = (self._across * u[:-1, self._turning]).sum(axis=0) + self._slip_compliance * turning
        return self._join(self._own * pressure - self._closing * u[-1, self._pressed], u[:-1, self.stuck], across)

    def correction(self, misfit: Reals) -> tuple[Reals, Reals]:
        """Return a change of the unknowns that approximately removes a misfit and keeps every sum.

        Also returns the uniform displacements left over, normal and tangential ones as far as these are free.
        """
        x = self._inverse(misfit)
        uniform = self._taken @ (self._sums @ x)
        return np.asarray(x - uniform @ self._uniform), np.asarray(uniform)

    def level(self, u: Reals, uniform: Reals) -> None:
        """Take uniform displacements left over off the displacements `[component, n]`."""
        if self._normal_is_free:
            u[-1] -= uniform[0]
        if self._drifts:
            u[:-1] += uniform[-len(u) + 1 :, np.newaxis]

    def _inverse(self, misfit: Reals) -> Reals:
        down, sticking, across = np.split(misfit, self._parts)
        sideways = np.concatenate(
            (sticking.reshape(self._shape[0] - 1, self.stuck.size), self._across * (self._yield * across)), axis=1
        )
        pressure, tractions = self._near.solve(self._soften * down[: self._held], sideways)
        pressure *= self._soften
        turning = self._yield * (self._across * tractions[:, self.stuck.size :]).sum(axis=0)
        pressures = np.concatenate((pressure, down[self._held :]))
        return self._join(pressures, tractions[:, : self.stuck.size], turning)

    @staticmethod
    def _join(pressure: Reals, sticking: Reals, across: Reals) -> Reals:
        return np.concatenate((pressure, sticking.ravel(), across))
