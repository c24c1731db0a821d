"""The linear problem that is left once it is guessed which nodes touch, which of them stick, and which way others slip.

Unknown are the pressure on the nodes in contact and the tangential traction on those that stick; a slipping node bears
the friction coefficient times its pressure, against the way it slips.
"""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.solvers.preconditioners.profile_inverse import ProfileInverse


class StickSlip:
    """Nodes and loads of one guess, and an approximate inverse of its compliance.

    `contact` and `slip` are `[n]`; slip is the sign of the distance slid, 0 for a node that sticks. `total` is the sum
    of the pressure that the load prescribes, None under a prescribed displacement. `drifts`: no traction restores the
    mean tangential displacement, so that the tangential tractions add up to zero. Nodes that are `released` `[n]`
    neither slip nor bear a tangential traction.
    """

    def __init__(
        self,
        contact: Flags,
        slip: Indices,
        friction: float,
        total: float | None,
        drifts: bool,
        inverses: tuple[ProfileInverse, ProfileInverse],
        released: Flags | None = None,
    ) -> None:
        sticks = slip == 0 if released is None else (slip == 0) & ~released
        self.touching, self.stuck = _ordered(contact), _ordered(contact & sticks)
        sliding = slip[self.touching]
        # tangential traction over pressure; sticking nodes have their own
        self.drag = np.multiply(-friction, sliding, out=np.zeros(sliding.size), where=sliding != 0)
        self._n, self._touches, self._sticks = contact.size, len(self.touching), len(self.stuck)
        self._tangential, self._normal = inverses
        self._normal.factor(self.touching, self._touches)
        if self._sticks:
            self._tangential.factor(self.stuck, self._sticks)
        rows, sums = [], []
        if total is not None and self._touches:
            rows.append((self._join(1.0, 0.0), self._join(1.0, 0.0)))
            sums.append(total)
        if drifts and self._sticks:
            rows.append((self._join(0.0, 1.0), self._join(self.drag, 1.0)))
            sums.append(0.0)
        self._normal_is_free, self._drifts = total is not None and self._touches > 0, drifts and self._sticks > 0
        shape = len(rows), self._touches + self._sticks
        self._sums = np.array([row[1] for row in rows]).reshape(shape)
        self._uniform = np.array([self._inverse(row[0]) for row in rows]).reshape(shape)
        self._prescribed = np.array(sums)
        # uniform displacements that sums of the tractions take: two unknowns at most, and nothing to factor
        self._taken = np.linalg.inv(self._sums @ self._uniform.T)

    def unknowns(self, pressure: Reals, tangential: Reals) -> Reals:
        """Unknowns `[unknown]` nearest to tractions `[n]` that have the prescribed sums."""
        x = np.concatenate((pressure[self.touching], tangential[self.stuck]))
        return np.asarray(x + self._solved(self._prescribed - self._sums @ x) @ self._uniform)

    def tractions(self, x: Reals) -> tuple[Reals, Reals]:
        """Tangential traction and pressure `[n]` of the unknowns."""
        tangential, pressure = np.zeros((2, self._n))
        pressure[self.touching] = x[: self._touches]
        tangential[self.touching] = self.drag * x[: self._touches]
        tangential[self.stuck] = x[self._touches :]
        return tangential, pressure

    def restricted(self, tangential: Reals, normal: Reals) -> Reals:
        """Displacements `[n]` where they are prescribed, into the body and along it `[unknown]`."""
        return np.concatenate((-normal[self.touching], tangential[self.stuck]))

    def correction(self, misfit: Reals) -> tuple[Reals, Reals]:
        """Change of the unknowns that about mends a misfit of displacements and changes no sum.

        Also returns the uniform displacements left over, normal and tangential ones as far as these are free.
        """
        x = self._inverse(misfit)
        uniform = self._solved(self._sums @ x)
        return x - uniform @ self._uniform, uniform

    def level(self, u: Reals, uniform: Reals) -> None:
        """Take uniform displacements left over off the displacements (tangential, normal) `[2, n]`."""
        if self._normal_is_free:
            u[1] -= uniform[0]
        if self._drifts:
            u[0] += uniform[-1]

    def _solved(self, sums: Reals) -> Reals:
        return np.asarray(self._taken @ sums)

    def _inverse(self, displacement: Reals) -> Reals:
        x = np.empty_like(displacement)
        self._normal.solve(displacement[: self._touches], x[: self._touches])
        if self._sticks:
            self._tangential.solve(displacement[self._touches :], x[self._touches :])
        return x

    def _join(self, pressure: npt.ArrayLike, tangential: float) -> Reals:
        return np.concatenate((np.broadcast_to(pressure, self._touches), np.broadcast_to(tangential, self._sticks)))


def _ordered(flags: Flags) -> Indices:
    """Nodes in their order around the period, from behind the widest gap."""
    nodes = np.empty(flags.size, dtype=np.int64)
    return nodes[: kernels.contact_nodes(flags, flags.size, nodes)]
