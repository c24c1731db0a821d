"""What all contacts of a map do to each other, on a grid too coarse to see any of them."""

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.convolution import Convolution
from gfmd_numba.solvers.preconditioners.near_field import NearField

Rows = npt.NDArray[np.int64]

_BLOCK = 8  # nodes along each side of a block, whose sum is all that is far away felt of it
_FEWEST = 32  # blocks in each direction: fewer save less than they cost
_TOLERANCE, _ITERATIONS = 1e-2, 50  # of the coarse problem: ten times that shows in the conjugate gradients
_ONE = np.zeros(1, dtype=np.int64)


class FarField:
    """Preconditioner of the compliance on some nodes: near neighbours, softened by what they cannot see.

    `NearField` A treats each contact as if it were isolated. Pressures far away add a smooth displacement, Q S Q^T of
    their sums over blocks Q^T p, with the compliance S of the waves that blocks hold. By Woodbury's identity the
    inverse with both is A - D Q (S^-1 + Q^T D Q)^-1 Q^T D, up to the pressure D of a uniform displacement for A
    itself; as A - D is positive, so is this. `stiffness` is `[ny, nx // 2 + 1]`; at q = 0 zero or infinite if it does
    not count.
    """

    def __init__(self, stiffness: Reals, shape: tuple[int, ...]) -> None:
        self._near = NearField(stiffness, shape)
        self._shape, self._blocks = shape, tuple(n // _BLOCK for n in shape)
        self._none = min(self._blocks) < _FEWEST
        self._uniform, self._stiff, self._place, self._count = np.empty(0), np.empty(0), np.empty(0, dtype=np.int64), 0
        if self._none:
            return
        coarse = stiffness[grid.wave_indices(self._blocks)]
        self._field = Convolution(1, *self._blocks)
        with np.errstate(divide="ignore"):
            compliance = np.where(coarse > 0.0, 1.0 / coarse, 0.0) * np.prod(self._blocks) / np.prod(shape)
        self._compliance = self._field.symbol(compliance)

    @property
    def transforms(self) -> float:
        """Transforms of blocks made so far, in proportion to the cost of one of nodes."""
        if self._none:
            return 0.0
        n, blocks = float(np.prod(self._shape)), self._field.n
        return float(self._field.n_transforms[0] * blocks * np.log(blocks) / (n * np.log(n)))

    def factor(self, nodes: Rows, count: int) -> None:
        """Prepare `solve` for the first `count` of the nodes."""
        self._near.factor(nodes, count)
        if self._none:
            return
        y, x = np.divmod(nodes[:count], self._shape[1])
        (rows, columns), (ny, nx) = self._blocks, self._shape
        self._place, self._count = y * rows // ny * columns + x * columns // nx, count
        self._uniform = np.empty(count)
        self._near.solve(np.ones(count), self._uniform)
        self._stiff = self._sums(self._uniform)

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes that about causes the displacement there."""
        self._near.solve(displacement, pressure)
        if not self._none:
            shared = self._shared(self._sums(self._uniform * displacement[: self._count]))
            pressure[: self._count] -= self._uniform * shared.ravel()[self._place]

    def _sums(self, values: Reals) -> Reals:
        sums = np.bincount(self._place, values, self._blocks[0] * self._blocks[1])
        return np.asarray(sums, dtype=np.float64).reshape(self._blocks)

    def _shared(self, load: Reals) -> Reals:
        """Displacement y of blocks with S^-1 y + D y = load, by conjugate gradients preconditioned by S.

        S^-1 of a direction is the sum that the direction is of the residuals, so it is never applied.
        """
        y, r = np.zeros_like(load), load
        z = self._soft(r)
        energy = first = float((r * z).sum())
        direction, unsmoothed = z, r
        for _ in range(_ITERATIONS):
            if energy <= _TOLERANCE**2 * first:
                break
            reaction = unsmoothed + self._stiff * direction
            step = energy / float((direction * reaction).sum())
            y, r = y + step * direction, r - step * reaction
            z, last = self._soft(r), energy
            energy = float((r * z).sum())
            direction, unsmoothed = z + energy / last * direction, r + energy / last * unsmoothed
        return y

    def _soft(self, load: Reals) -> Reals:
        field = self._field
        field.sources[0][0, : field.n] = load.ravel()
        field.apply(self._compliance, _ONE, source=0)
        return field.result[0, : field.n].reshape(self._blocks).copy()
