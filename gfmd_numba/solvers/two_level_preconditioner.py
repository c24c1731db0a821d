"""Preconditioners of the compliance on some nodes of a map, in one and in two levels, and on tiles.

The first level is a stencil, the stiffness between near neighbours. The second level is a coarse grid of blocks, whose
pressures move each other. The solvers of a hard wall, with or without friction, take one of the three classes on maps:

    TiledTwoLevelPreconditioner   tiles/newton.py: active_set_newton on maps that tiles cover, without a hardness
    TwoLevelPreconditioner        active_set_newton.py: all other maps on a hard wall, without friction
    StencilPreconditioner         friction/linear_problem.py: one for each displacement component of a map

`preconditioners.py` gives the last two to their solvers, and the preconditioner of profiles to all. Laws
(`parallel_law.py`), steady sliding (`sliding_newton.py`) and a map that processes share (`distributed_newton.py`) have
preconditioners of their own.
"""

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.arrays.threads import team
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.kernels.tiles import TILE
from gfmd_numba.solvers.exponential_sums.exponential_sum import Tuning

_REACH = 1  # nodes in each direction: more saves a transform in twenty, and costs more than that

_SAMPLES = 64  # nodes in each direction, of a grid on which the stiffness between neighbours is what it is


class StencilPreconditioner:
    """First level alone: the stiffness between near neighbours.

    In two dimensions stiffness decays with the cube of the distance, so that the rest is small. `stiffness` is
    `[ny, nx // 2 + 1]`; at q = 0 zero or infinite if it does not count.
    """

    transforms = 0.0  # it takes none
    takes_own = False  # whether `factor` takes compliances that nodes have in addition

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
    # otherwise the stencil may not be positive definite, nor stiffer than its row sum: take the node itself alone
    if np.abs(others).sum() >= stencil[_REACH, _REACH] or others.max() > 0.0:
        stencil -= others
    return np.ascontiguousarray(stencil)


_FEWEST = 256  # nodes of the map in each direction: on smaller ones blocks save less than they cost
_TOLERANCE, _ITERATIONS = 1e-2, 50  # of the coarse problem: ten times that shows in the conjugate gradients
_PAIRS = 8  # of loaded blocks, for each block, up to which to sum them takes less time than transforms
_ONE = np.zeros(1, dtype=np.int64)


class BlockCompliance:
    """Compliance S between blocks of a map: far away, a block acts by the sum of its pressures.

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
        if where.size**2 < _PAIRS * stiff.size:  # the displacement of blocks without contact need not be known
            few, found, (r, z) = np.divmod(where, self.shape[1]), np.zeros(n), np.empty((2, where.size))
            r[:] = load.reshape(-1)[where]
            found[where] = _solved(
                lambda: kernels.convolve_few(r, *few, self._kernel, z), r, z, stiff.reshape(-1)[where]
            )
            return found.reshape(self.shape)
        r, z = self._field.sources[0][0, :n], self._field.result[0, :n]
        r[:] = load.ravel()
        return _solved(self._apply_compliance, r, z, stiff.ravel()).reshape(self.shape)

    def _apply_compliance(self) -> None:
        self._field.apply(self._compliance, _ONE, source=0)

    @cached_property
    def _kernel(self) -> Reals:
        """Displacement of all blocks under the pressure of the first one."""
        one = self._field.sources[0][0]
        one[:] = 0.0
        one[0] = 1.0
        self._apply_compliance()
        return self._field.result[0, : self._field.n].reshape(self.shape).copy()


def _solved(apply_compliance: Callable[[], None], r: Reals, z: Reals, stiff: Reals) -> Reals:
    """Displacement y of blocks with S^-1 y + stiff y = r, by conjugate gradients preconditioned by S.

    `apply_compliance` makes z = S r; r is overwritten by the residual. Directions are sums of S r, and S^-1 of a
    direction is the same sum of the residuals r, so that S^-1 is never applied.
    """
    y, direction, unsmoothed = np.zeros((3, r.size))
    first = energy = 0.0
    for iteration in range(_ITERATIONS):
        apply_compliance()
        energy = kernels.block_direction(r, z, energy, direction, unsmoothed)
        first = first if iteration else energy
        if energy <= _TOLERANCE**2 * first:
            break
        kernels.block_step(y, r, energy, stiff, direction, unsmoothed)
    return y


_SIDE = 8  # nodes along each side of a block


class TwoLevelPreconditioner:
    """Both levels: near neighbours, made softer by the displacement that far pressures cause.

    The stencil A treats each contact as if it were isolated. Let Q spread a value of each block over its nodes. The
    pressures p add the smooth displacement Q S Q^T p, with the compliance S of the waves that blocks hold. By
    Woodbury's identity the inverse with both levels is

        A - D Q (S^-1 + Q^T D Q)^-1 Q^T D,

    where the diagonal D, the pressure that A gives a uniform displacement, stands for A next to Q. As A - D is
    positive, so is this inverse. `stiffness` is `[ny, nx // 2 + 1]`; at q = 0 zero or infinite if it does not count.
    """

    tuning = Tuning(coarsening=2, loose=0.2, tighten=0.5, ahead=0.1)
    iterations = 40  # of conjugate gradients at most

    def __init__(self, stiffness: Reals, shape: tuple[int, ...]) -> None:
        self._near, self._blocks, self._shape = (
            StencilPreconditioner(stiffness, shape),
            BlockCompliance(stiffness, shape, _SIDE),
            shape,
        )
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


_SIDE_OF_TILES = (
    16  # nodes along each side of a block, two tiles: larger blocks cost iterations, smaller ones do not pay
)


class TiledTwoLevelPreconditioner:
    """The `TwoLevelPreconditioner` on the nodes in contact of some tiles of a map, whose work threads share.

    `stiffness` is `[ny, nx // 2 + 1]`; at q = 0 zero or infinite if it does not count. Tiles are listed row by row,
    `tiles_across` of them.
    """

    def __init__(self, stiffness: Reals, shape: tuple[int, ...], tiles_across: int) -> None:
        self._stencil, self._blocks = near_stencil(stiffness, shape), BlockCompliance(stiffness, shape, _SIDE_OF_TILES)
        self.stiffest = float(self._stencil.max())  # of a node between its neighbours
        self._across = tiles_across
        self._nodes = self._tiles = np.empty(0, dtype=np.int64)
        self._image = np.zeros((1, TILE, TILE))
        self._isolated = np.empty(0)  # pressure D of a uniform displacement under the stencil

    @property
    def transforms(self) -> int:
        """Transforms of blocks made so far."""
        return self._blocks.made

    @property
    def nodes(self) -> int:
        """Number of blocks."""
        return math.prod(self._blocks.shape)

    def factor(self, nodes: Indices, tiles: Indices, around: Indices) -> None:
        """Prepare `solve` for the nodes in contact of some tiles, and the places of the tiles around each."""
        if np.array_equal(tiles, self._tiles):
            if np.array_equal(nodes, self._nodes):
                return
            self._image.reshape(-1)[self._nodes] = 0.0
        else:
            self._image = np.zeros((tiles.size + 1, TILE, TILE))
        self._nodes, self._tiles, (down, across) = nodes, tiles, self._blocks.shape
        self._ends = np.searchsorted(tiles, 2 * self._across * np.arange(down + 1))  # tiles of rows of blocks
        self._of_tiles = around, tiles // self._across // 2 * across + tiles % self._across // 2
        self._isolated = np.empty(nodes.size)
        self._stiff = self._near(np.ones(nodes.size), self._isolated)  # what is summed up is filled just before

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes in contact that about causes the displacement there."""
        sums = self._near(displacement, pressure)
        if self._blocks.useful:
            shared = self._blocks.shared(sums, self._stiff).reshape(-1)
            nodes, isolated, blocks = self._nodes, self._isolated, self._of_tiles[1]

            def some(_: int, a: int, b: int) -> None:
                kernels.subtract_far_pressure(pressure[a:b], nodes[a:b], isolated[a:b], blocks, shared)

            team().share(some, nodes.size, nodes.size)

    def _near(self, displacement: Reals, pressure: Reals) -> Reals:
        """Fill the pressure by near neighbours, and return the sums of it over blocks."""
        sums = np.zeros(self._blocks.shape)
        image, nodes = self._image.reshape(-1), self._nodes
        team().in_pieces(lambda some: kernels.put_nodes(displacement[some], nodes[some], image), nodes.size)

        def some(_: int, first: int, last: int) -> None:
            tiles = self._ends[first], self._ends[last]
            each = self._of_tiles, self._stencil, self._isolated
            kernels.near_pressure(self._image, self._nodes, tiles, *each, pressure, sums.reshape(-1))

        team().share(some, self._blocks.shape[0], self._image.size)
        return sums
