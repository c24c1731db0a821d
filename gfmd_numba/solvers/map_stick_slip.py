"""The linear problem of a map once it is guessed which nodes touch, which of them stick, and which way others slip.

Unknown are the pressure p on the nodes in contact, both tangential tractions on those that stick, and on a slipping
node the traction t across the direction e in which it slips: along e it bears -mu p. The traction of a slip s turns by
as much as the slip does, t / (mu p) = -ds / s across e, so that the node gives way by t s / (mu p) (Alart & Curnier,
Comput. Methods Appl. Mech. Eng. 92:353, 1991).
"""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Flags, Reals
from gfmd_numba.solvers.map_products import MapProducts
from gfmd_numba.solvers.preconditioners.near_tractions import NearTractions


@dataclass
class MapGuess:
    """Nodes in contact `[n]`, directions of slip `[2, n]` (0 where they stick), and tractions found last.

    `slip_compliance` is the slip over the friction of a slipping node `[n]`. `tractions` are the tangential ones and
    the pressure `[3, n]`. Nodes that are `released` `[n]` neither slip nor bear a tangential traction.
    """

    contact: Flags
    direction: Reals
    slip_compliance: Reals
    tractions: Reals
    released: Flags


class MapStickSlip:
    """Nodes and loads of one guess of row i, its compliance, and an approximate inverse of that.

    `total` is the sum of the pressure that the load prescribes, None under a prescribed displacement. `drifts`: no
    traction restores the mean tangential displacement, so that the tangential tractions add up to zero.
    """

    def __init__(
        self,
        guess: MapGuess,
        friction: float,
        total: float | None,
        drifts: bool,
        products: MapProducts,
        near: NearTractions,
        i: int,
    ) -> None:
        self._products, self._near, self._i, self._shape = products, near, i, guess.tractions.shape
        self.touching = np.flatnonzero(guess.contact)
        slips = guess.direction[:, self.touching].any(axis=0)
        sticks = ~(slips | guess.released[self.touching])
        self.stuck, self.slipping = self.touching[sticks], self.touching[slips]
        self._of_stuck, self._of_slipping = np.flatnonzero(sticks), np.flatnonzero(slips)  # among those that touch
        near.factor(self.touching)
        towards = guess.direction[:, self.touching]
        # tangential traction over pressure
        self._drag = np.multiply(-friction, towards, out=np.zeros_like(towards), where=towards != 0.0)
        along = guess.direction[:, self.slipping]
        self._across = np.array([-along[1], along[0]])
        self._slip_compliance = guess.slip_compliance[self.slipping]
        self._soften = 1.0 / np.sqrt(1.0 + self._slip_compliance * near.of_a_node)
        sizes = self.touching.size, 2 * self.stuck.size, self.slipping.size
        self._parts: list[int] = np.cumsum(sizes[:-1]).tolist()
        self._normal_is_free = total is not None and self.touching.size > 0
        self._drifts = drifts and self.touching.size > 0
        sums, takers, prescribed = [], [], []
        if self._normal_is_free:
            sums.append(self._join(np.ones(sizes[0]), np.zeros((2, self.stuck.size)), np.zeros(sizes[2])))
            takers.append(sums[0])
            prescribed.append(total)
        for component in (0, 1) if self._drifts else ():
            unit = np.zeros((2, self.stuck.size))
            unit[component] = 1.0
            sums.append(self._join(self._drag[component], unit, self._across[component]))
            takers.append(self._join(np.zeros(sizes[0]), unit, self._across[component]))
            prescribed.append(0.0)
        rows = len(sums), sum(sizes)
        self._sums = np.array(sums).reshape(rows)
        self._takers = np.array(takers).reshape(rows)
        self._uniform = np.array([self._inverse(each) for each in takers]).reshape(rows)
        self._prescribed = np.array(prescribed, dtype=np.float64)
        # of uniform displacements that hardly any node takes, least squares take none
        self._taken = np.linalg.pinv(self._sums @ self._uniform.T, rcond=1e-10)

    def unknowns(self, tractions: Reals) -> Reals:
        """Return the unknowns `[unknown]` with the prescribed sums that are nearest to tractions `[3, n]`."""
        across = (self._across * tractions[:2, self.slipping]).sum(axis=0)
        x = self._join(tractions[2, self.touching], tractions[:2, self.stuck], across)
        return np.asarray(x + (self._taken @ (self._prescribed - self._sums @ x)) @ self._uniform)

    def tractions(self, x: Reals) -> Reals:
        """Tangential tractions and pressure `[3, n]` of the unknowns."""
        pressure, sticking, across = np.split(x, self._parts)
        found = np.zeros(self._shape)
        found[2, self.touching] = pressure
        found[:2, self.touching] = self._drag * pressure
        found[:2, self.stuck] = sticking.reshape(2, -1)
        found[:2, self.slipping] += self._across * across
        return found

    def deflected(self, x: Reals) -> Reals:
        """Displacements `[3, n]` that the unknowns cause."""
        tractions = self.tractions(x)
        np.negative(tractions[2], out=tractions[2])
        return self._products.deflect(self._i, tractions)

    def prescribed(self, anchor: Reals, wall: Reals) -> Reals:
        """Return the prescribed displacements: into the body, along it, and across the slip `[unknown]`."""
        across = (self._across * anchor[:, self.slipping]).sum(axis=0)
        return self._join(-wall[self.touching], anchor[:, self.stuck], across)

    def restricted(self, u: Reals, x: Reals) -> Reals:
        """Return displacements `[3, n]` where they are prescribed, plus how far slipping nodes give way `[unknown]`."""
        across = (self._across * u[:2, self.slipping]).sum(axis=0) + self._slip_compliance * x[self._parts[1] :]
        return self._join(-u[2, self.touching], u[:2, self.stuck], across)

    def correction(self, misfit: Reals) -> Reals:
        """Return a change of the unknowns that approximately removes a misfit of displacements and keeps every sum."""
        x = self._inverse(misfit)
        return np.asarray(x - (self._taken @ (self._sums @ x)) @ self._uniform)

    def level(self, u: Reals, misfit: Reals) -> None:
        """Subtract the uniform part of a misfit from the displacements `[3, n]`, in the directions that are free."""
        uniform = np.linalg.pinv(self._takers @ self._takers.T, rcond=1e-10) @ (self._takers @ misfit)
        if self._normal_is_free:
            u[2] -= uniform[0]
        if self._drifts:
            u[:2] += uniform[-2:, np.newaxis]

    def _inverse(self, misfit: Reals) -> Reals:
        down, sticking, across = np.split(misfit, self._parts)
        u = np.zeros((3, self.touching.size))
        u[2] = down
        u[:2, self._of_stuck] = sticking.reshape(2, -1)
        u[:2, self._of_slipping] = self._across * (self._soften * across)
        t = self._near.solve(u)
        across = self._soften * (self._across * t[:2, self._of_slipping]).sum(axis=0)
        return self._join(t[2], t[:2, self._of_stuck], across)

    @staticmethod
    def _join(pressure: Reals, sticking: Reals, across: Reals) -> Reals:
        return np.concatenate((pressure, sticking.ravel(), across))
