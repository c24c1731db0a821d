"""The compliance between tiles of a map, nearly, and a preconditioner of it on the nodes in contact."""

import math
from functools import lru_cache

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.arrays.threads import team
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.kernels.tiles import TILE
from gfmd_numba.solvers.tiles.near_field import Blocks, near_stencil

_COARSENING = 4  # nodes of the map over those of the coarser grid, along each side
_REACH = 5  # nodes in each direction that the stencil sees
_SAMPLES = 64  # waves in each direction on which the stencil is fitted
_SHARES = TILE // _COARSENING + 3  # coarse nodes in each direction that a tile's values are shared among


def fits(shape: tuple[int, ...]) -> bool:
    """Whether tiles cover a map of this shape, and its coarser grid is wider than a tile's neighbourhood."""
    return len(shape) == 2 and all(n % TILE == 0 and n >= 8 * TILE for n in shape)


class SplitCompliance:
    """Displacement on some tiles of a map from the pressure on them, to about a hundredth of each wave.

    The stencil is fitted to the compliance of the waves that the coarser grid cannot hold, and the coarser grid has
    what the stencil leaves of the others. Cubic B-splines share each pressure among the coarse nodes around it, and
    read the displacement back, as in particle-mesh Ewald sums (Essmann et al., J. Chem. Phys. 103:8577, 1995).
    `stiffness` is `[ny, nx // 2 + 1]`; waves of zero or infinite stiffness have no displacement. Tiles are listed row
    by row, `tiles_across` of them.
    """

    def __init__(self, stiffness: Reals, shape: tuple[int, ...], tiles_across: int) -> None:
        self._across = tiles_across
        self._tiles = self._around = np.empty(0, dtype=np.int64)
        self._coarse_shape = tuple(n // _COARSENING for n in shape)
        self._field = Transform(1, *self._coarse_shape, in_place=True)
        nodes = np.arange(TILE) / _COARSENING - np.arange(-1, _SHARES - 1)[:, np.newaxis]
        self._weights = np.ascontiguousarray(_cubic_spline(nodes).T)
        self.stencil = _fitted(shape, _soft(stiffness[grid.some_waves(shape, _few(shape))]).tobytes())
        waves = grid.wave_indices(self._coarse_shape)
        left = _soft(stiffness[waves]) - _transform(self.stencil, *_angles(waves, shape))
        spline = np.arange(-2 * _COARSENING, 2 * _COARSENING + 1)
        shared = [
            (np.cos(angle[..., np.newaxis] * spline) * _cubic_spline(spline / _COARSENING)).sum(axis=-1)
            for angle in _angles(waves, shape)
        ]
        self._far = left * (_COARSENING / (shared[0] * shared[1])) ** 2

    @property
    def transforms(self) -> int:
        """Transforms of the coarser grid made so far."""
        return int(self._field.n_transforms[0])

    @property
    def nodes(self) -> int:
        """Number of nodes of the coarser grid."""
        return self._field.n

    def place(self, tiles: Indices, around: Indices) -> None:
        """Prepare `apply` for some tiles and the places of those around them."""
        self._tiles, self._around = tiles, around

    def apply(self, pressure: Reals, displacement: Reals) -> None:
        """Fill the displacement `[m + 1, TILE, TILE]` of the m tiles from the pressure on them."""
        convolve(pressure, self._around, self.stencil, displacement)
        coarse = self._field.memory[0]
        kernels.spread(pressure, self._tiles, self._across, self._weights, coarse, *self._coarse_shape)
        self._field.stiffen(self._far)

        def some(_: int, first: int, last: int) -> None:
            tiles = self._tiles[first:last]
            kernels.gather_back(
                coarse, tiles, self._across, self._weights, *self._coarse_shape, displacement[first:last]
            )

        team().share(some, self._tiles.size, displacement.size)


def convolve(values: Reals, around: Indices, stencil: Reals, product: Reals) -> None:
    """Fill the product on tiles with the convolution of the values with a stencil; the work is shared by tiles."""

    def some(_: int, first: int, last: int) -> None:
        kernels.tile_stencil(values, around[first:last], stencil, product[first:last])

    team().share(some, len(around), product.size)


def _cubic_spline(x: Reals) -> Reals:
    """Cubic B-spline of unit integral, of the distance in nodes."""
    x = np.abs(x)
    return np.where(x < 1.0, 2.0 / 3.0 - x**2 + 0.5 * x**3, np.clip(2.0 - x, 0.0, None) ** 3 / 6.0)


def _soft(stiffness: Reals) -> Reals:
    with np.errstate(divide="ignore"):
        return np.where(stiffness > 0.0, 1.0 / stiffness, 0.0)


def _angles(waves: tuple[Indices, ...], shape: tuple[int, ...]) -> tuple[Reals, ...]:
    """Phases of the waves from node to node, along each direction."""
    return tuple(np.asarray(k * (2.0 * np.pi / n), dtype=np.float64) for k, n in zip(waves, shape, strict=True))


def _transform(stencil: Reals, along_y: Reals, along_x: Reals) -> Reals:
    """Fourier transform of an even stencil at the phases `[ny, 1]` and `[1, nx]`."""
    offsets = np.arange(stencil.shape[0]) - stencil.shape[0] // 2
    rows, columns = np.cos(along_y * offsets), np.cos(along_x.T * offsets)
    return np.asarray(rows @ stencil @ columns.T)


def _few(shape: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(min(n, _SAMPLES) for n in shape)


@lru_cache(maxsize=64)  # maps of one size on one body, one block after another
def _fitted(shape: tuple[int, ...], compliance: bytes) -> Reals:
    """Even stencil whose relative error is least where the coarser grid cannot make up for it, of some waves.

    A wave on the coarser grid is taken for another one, the more so the shorter it is: its error counts as much.
    """
    along_y, along_x = _angles(grid.some_waves(shape, _few(shape)), shape)
    soft = np.frombuffer(compliance).reshape(along_y.size, along_x.size)
    kept = np.abs(along_y) / (2.0 * np.pi) * _COARSENING, along_x / (2.0 * np.pi) * _COARSENING
    with np.errstate(divide="ignore"):
        mistaken = [np.where(x < 0.5, (x / (1.0 - x)) ** 4, 1.0) for x in kept]
    weight = np.minimum(mistaken[0] + mistaken[1], 1.0)
    relative = np.divide(weight, soft, out=np.zeros_like(soft), where=soft > 0.0)
    number = np.arange(_REACH + 1)
    rows, columns = np.cos(along_y * number), np.cos(along_x.T * number)
    basis = np.einsum("yj,xi,yx->yxji", rows, columns, relative).reshape(soft.size, -1)
    quarter = np.linalg.lstsq(basis, (weight * (soft > 0.0)).ravel())[0].reshape(_REACH + 1, _REACH + 1)
    quarter[1:] /= 2.0
    quarter[:, 1:] /= 2.0
    return np.ascontiguousarray(
        quarter[np.ix_(abs(np.arange(-_REACH, _REACH + 1)), abs(np.arange(-_REACH, _REACH + 1)))]
    )


_SIDE = (
    16  # nodes along each side of a block, two tiles: larger blocks cost iterations, smaller ones more than they save
)


class TileField:
    """Preconditioner of the compliance on the nodes in contact of some tiles: near neighbours and blocks.

    Values on m tiles are `[m + 1, TILE, TILE]`. `stiffness` is `[ny, nx // 2 + 1]`; at q = 0 zero or infinite if it
    does not count. Tiles are listed row by row, `tiles_across` of them.
    """

    def __init__(self, stiffness: Reals, shape: tuple[int, ...], tiles_across: int) -> None:
        self._stencil, self._blocks = near_stencil(stiffness, shape), Blocks(stiffness, shape, _SIDE)
        self.stiffest = float(self._stencil.max())  # of a node between its neighbours
        self._across = tiles_across
        self._tiles = self._around = np.empty(0, dtype=np.int64)
        self._nodes, self._isolated, self._stiff = self._tiles, np.empty(0), np.empty(0)

    @property
    def transforms(self) -> int:
        """Transforms of blocks made so far."""
        return self._blocks.made

    @property
    def nodes(self) -> int:
        """Number of blocks."""
        return math.prod(self._blocks.shape)

    def place(self, tiles: Indices, around: Indices) -> None:
        """Prepare `factor` for some tiles and the places of those around them."""
        self._tiles, self._around = tiles, around

    def factor(self, nodes: Indices, contact: Flags) -> None:
        """Prepare `solve` for the nodes in contact, which are listed and marked."""
        self._nodes, (self._values, self._near) = nodes, np.zeros((2, *contact.shape))
        if self._blocks.useful:
            self._sums, self._stiff = np.zeros((2, *self._blocks.shape))
            self._isolated = np.zeros(contact.shape)
            convolve(contact.astype(np.float64), self._around, self._stencil, self._isolated)
            kernels.sum_tiles(self._isolated, contact, self._tiles, self._across, self._stiff)

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes in contact that about causes the displacement there."""
        self._values.reshape(-1)[self._nodes] = displacement
        convolve(self._values, self._around, self._stencil, self._near)
        if self._blocks.useful:
            kernels.sum_tiles(self._isolated, self._values, self._tiles, self._across, self._sums)
            shared = self._blocks.shared(self._sums, self._stiff)
            kernels.soften_tiles(self._near, self._isolated, shared, self._tiles, self._across)
        np.take(self._near.reshape(-1), self._nodes, out=pressure)
