"""What all contacts of a map do to each other, on a grid too coarse to see any of them."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.solvers.preconditioners.blocks import Blocks
from gfmd_numba.solvers.preconditioners.near_field import NearField

_SIDE = 8  # nodes along each side of a block


class FarField:
    """Preconditioner of the compliance on some nodes: near neighbours, softened by what they cannot see.

    `NearField` A treats each contact as if it were isolated. Pressures far away add a smooth displacement, Q S Q^T of
    their sums over blocks Q^T p, with the compliance S of the waves that blocks hold. By Woodbury's identity the
    inverse with both is A - D Q (S^-1 + Q^T D Q)^-1 Q^T D, up to the pressure D of a uniform displacement for A
    itself; as A - D is positive, so is this. `stiffness` is `[ny, nx // 2 + 1]`; at q = 0 zero or infinite if it does
    not count.
    """

    is_positive = True  # whatever the nodes

    def __init__(self, stiffness: Reals, shape: tuple[int, ...]) -> None:
        self._near, self._blocks, self._shape = NearField(stiffness, shape), Blocks(stiffness, shape, _SIDE), shape
        self._uniform, self._stiff, self._place, self._count = np.empty(0), np.empty(0), np.empty(0, dtype=np.int64), 0

    @property
    def transforms(self) -> float:
        """Transforms of blocks made so far, in proportion to the cost of one of nodes."""
        return self._blocks.transforms

    def factor(self, nodes: Indices, count: int) -> None:
        """Prepare `solve` for the first `count` of the nodes."""
        self._near.factor(nodes, count)
        if not self._blocks.useful:
            return
        y, x = np.divmod(nodes[:count], self._shape[1])
        (rows, columns), (ny, nx) = self._blocks.shape, self._shape
        self._place, self._count = y * rows // ny * columns + x * columns // nx, count
        self._uniform = np.empty(count)
        self._near.solve(np.ones(count), self._uniform)
        self._stiff = self._sums(self._uniform)

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes that about causes the displacement there."""
        self._near.solve(displacement, pressure)
        if self._blocks.useful:
            shared = self._blocks.shared(self._sums(self._uniform * displacement[: self._count]), self._stiff)
            pressure[: self._count] -= self._uniform * shared.ravel()[self._place]

    def _sums(self, values: Reals) -> Reals:
        sums = np.bincount(self._place, values, self._blocks.shape[0] * self._blocks.shape[1])
        return np.asarray(sums, dtype=np.float64).reshape(self._blocks.shape)
