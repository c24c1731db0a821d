"""Near neighbours of a map, and what all contacts do to each other on a grid too coarse to see any of them."""

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.solvers.exponential_sums.exponential_sum import Tuning

_REACH = 1  # nodes in each direction: more saves a transform in twenty, and costs more than that

_SAMPLES = 64  # nodes in each direction, of a grid on which the stiffness between neighbours is what it is


class NearField:
    """Preconditioner of the compliance on some nodes: the stiffness between those that are near neighbours.

    In two dimensions stiffness decays with the cube of the distance, so that the rest is small. `stiffness` is
    `[ny, nx // 2 + 1]`; at q = 0 zero or infinite if it does not count.
    """

    transforms = 0.0  # it takes none
    takes_own = False  # compliances that nodes have in addition

    def __init__(self, stiffness: Reals, shape: tuple[int, ...]) -> None:
        self._stencil = near_stencil(stiffness, shape)
        self._with_edges = np.zeros((shape[0] + 2 * _REACH, shape[1]))
        self._nodes = np.empty(0, dtype=np.int64)

    def factor(self, nodes: Indices, count: int, own: Reals | None = None) -> None:
        """Prepare `solve` for the first `count` of the nodes; compliances of their `own` do not count."""
        self._nodes = nodes[:count]

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes that about causes the displacement there."""
        whole, nodes = self._with_edges, self._nodes
        flat = whole[_REACH:-_REACH].reshape(-1)
        flat[nodes] = displacement[: nodes.size]
        whole[:_REACH], whole[-_REACH:] = whole[-2 * _REACH : -_REACH], whole[_REACH : 2 * _REACH]
        kernels.near_tractions(self._stencil, whole, nodes, pressure)
        flat[nodes] = 0.0


def near_stencil(stiffness: Reals, shape: tuple[int, ...]) -> Reals:
    """Stiffness between near neighbours `[2 m + 1, 2 m + 1]`, positive definite on any nodes."""
    few = tuple(min(n, _SAMPLES) for n in shape)
    symbol = stiffness[grid.some_waves(shape, few)]
    if not 0.0 < symbol[0, 0] < np.inf:
        symbol[0, 0] = stiffness[0, 1]
    near = np.roll(grid.influence(symbol, *few), (_REACH, _REACH), axis=(0, 1))
    stencil = near[: 2 * _REACH + 1, : 2 * _REACH + 1]
    others = stencil.copy()
    others[_REACH, _REACH] = 0.0
    # otherwise it may not be positive definite, nor stiffer than its own sum of rows: the node alone is
    if np.abs(others).sum() >= stencil[_REACH, _REACH] or others.max() > 0.0:
        stencil -= others
    return np.ascontiguousarray(stencil)


_FEWEST = 256  # nodes of the map in each direction: on smaller ones blocks save less than they cost
_TOLERANCE, _ITERATIONS = 1e-2, 50  # of the coarse problem: ten times that shows in the conjugate gradients
_PAIRS = 8  # of loaded blocks, for each block, up to which to sum them takes less time than transforms
_ONE = np.zeros(1, dtype=np.int64)


class Blocks:
    """Compliance S between blocks of a map: the sum of pressures is all that is far away felt of a block.

    `stiffness` is `[ny, nx // 2 + 1]` of a map of the shape `nodes`, at q = 0 zero or infinite if it does not count;
    `side` the number of nodes along each side of a block, `shape` that of the grid of blocks.
    """

    def __init__(self, stiffness: Reals, nodes: tuple[int, ...], side: int) -> None:
        self.shape = tuple(-(-n // side) for n in nodes)
        self.useful = min(nodes) >= _FEWEST
        if not self.useful:
            return
        self._nodes = math.prod(nodes)
        self._field = Transform(1, *self.shape)
        coarse = stiffness[grid.wave_indices(self.shape)]
        with np.errstate(divide="ignore"):
            compliance = np.where(coarse > 0.0, 1.0 / coarse, 0.0) * self._field.n / self._nodes
        self._compliance = self._field.symbol(compliance)

    @property
    def made(self) -> int:
        """Transforms made so far."""
        return int(self._field.n_transforms[0]) if self.useful else 0

    @property
    def transforms(self) -> float:
        """Transforms made so far, in proportion to the cost of one of the map."""
        if not self.useful:
            return 0.0
        return self.made * grid.relative_cost(self._field.n, self._nodes)

    def shared(self, load: Reals, stiff: Reals) -> Reals:
        """Displacement y of blocks with S^-1 y + stiff y = load."""
        where, n = np.flatnonzero(stiff), self._field.n
        if where.size**2 < _PAIRS * stiff.size:  # the others need not be known
            few, found, (r, z) = np.divmod(where, self.shape[1]), np.zeros(n), np.empty((2, where.size))
            r[:] = load.reshape(-1)[where]
            found[where] = _solved(
                lambda: kernels.convolve_few(r, *few, self._kernel, z), r, z, stiff.reshape(-1)[where]
            )
            return found.reshape(self.shape)
        r, z = self._field.sources[0][0, :n], self._field.result[0, :n]
        r[:] = load.ravel()
        return _solved(self._soften, r, z, stiff.ravel()).reshape(self.shape)

    def _soften(self) -> None:
        self._field.apply(self._compliance, _ONE, source=0)

    @cached_property
    def _kernel(self) -> Reals:
        """Displacement of all blocks under the pressure of the first one."""
        one = self._field.sources[0][0]
        one[:] = 0.0
        one[0] = 1.0
        self._soften()
        return self._field.result[0, : self._field.n].reshape(self.shape).copy()


def _solved(soften: Callable[[], None], r: Reals, z: Reals, stiff: Reals) -> Reals:
    """Displacement y of blocks with S^-1 y + stiff y = r, by conjugate gradients preconditioned by S.

    `soften` makes z that of the load r, which is lost. S^-1 of a direction is the sum that the direction is of the
    residuals, so it is never applied.
    """
    y, direction, unsmoothed = np.zeros((3, r.size))
    first = energy = 0.0
    for iteration in range(_ITERATIONS):
        soften()
        energy = kernels.block_direction(r, z, energy, direction, unsmoothed)
        first = first if iteration else energy
        if energy <= _TOLERANCE**2 * first:
            break
        kernels.block_step(y, r, energy, stiff, direction, unsmoothed)
    return y


_SIDE = 8  # nodes along each side of a block


class FarField:
    """Preconditioner of the compliance on some nodes: near neighbours, softened by what they cannot see.

    `NearField` A treats each contact as if it were isolated. Pressures far away add a smooth displacement, Q S Q^T of
    their sums over blocks Q^T p, with the compliance S of the waves that blocks hold. By Woodbury's identity the
    inverse with both is A - D Q (S^-1 + Q^T D Q)^-1 Q^T D, up to the pressure D of a uniform displacement for A
    itself; as A - D is positive, so is this. `stiffness` is `[ny, nx // 2 + 1]`; at q = 0 zero or infinite if it does
    not count.
    """

    tuning = Tuning(coarsening=2, loose=0.2, tighten=0.5, ahead=0.1)
    iterations = 40  # of conjugate gradients at most

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
