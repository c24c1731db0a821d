"""The compliance between tiles of a map, nearly: a kernel between near nodes, and a coarser grid for the rest."""

import math
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy  # its modules load with their first use

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.arrays.threads import team
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.kernels.tiles import TILE

_SAMPLES = 256  # nodes in each direction, of a grid on which the kernel between near tiles is what it is


class Split(NamedTuple):
    """How the compliance is split.

    `coarsening` is the number of nodes of the map over that of the coarser grid, along each side. The kernel is summed
    up over tiles up to a `distance`, and fades over distance / `sharp`. B-splines have an even `order`. The pressure is
    left with about the relative `error`. A `sharp` of 0 stands for a fitted stencil.
    """

    coarsening: int
    distance: int
    sharp: float
    order: int
    error: float


FEW_TILES, MANY_TILES = Split(8, 8, 2.7, 6, 2e-5), Split(4, 1, 0.0, 4, 5e-3)
_REACH = 5  # nodes in each direction that the stencil of MANY_TILES sees
_FITTED = 64  # waves in each direction on which that is fitted


def fits(shape: tuple[int, ...]) -> bool:
    """Whether tiles cover a map of this shape, and its coarser grid is wider than a tile's neighbourhood."""
    return all(n % TILE == 0 and n >= 8 * TILE for n in shape)


class SplitCompliance:
    """Displacement on some tiles of a map from the pressure on them, to about the error of a split.

    As in particle-mesh Ewald sums, the compliance is split in two. Within some tiles, displacements are summed up node
    by node, with a kernel that fades fast. The rest is found on a coarser grid: B-splines distribute each pressure
    among the coarse nodes around it, and interpolate the displacement back (Essmann et al., J. Chem. Phys. 103:8577,
    1995). As waves end at Nyquist, the exact displacement has an alternating part along x and y, which fades with the
    square of the distance only; far away this part is missing. `stiffness` is `[ny, nx // 2 + 1]`; waves of zero or
    infinite stiffness have no displacement. There are (y, x) `tiles_each_way`, which may end along either.
    """

    def __init__(
        self,
        stiffness: Reals,
        shape: tuple[int, ...],
        tiles_each_way: tuple[int, int],
        ends: tuple[bool, bool] = (False, False),
        split: Split = MANY_TILES,
    ) -> None:
        self.error, coarsening = split.error, split.coarsening
        self._tiles_each_way, self._ends = tiles_each_way, ends
        self._tiles = self._places = np.empty(0, dtype=np.int64)
        self._coarse_shape = tuple(n // coarsening for n in shape)
        self._per_tile = TILE // coarsening
        self._field = Transform(1, *self._coarse_shape, in_place=True)
        before, spline = split.order // 2, _spline(split.order)
        first, last = 1 - before, self._per_tile + before
        self._weights = np.ascontiguousarray(
            spline(np.arange(TILE)[:, np.newaxis] / coarsening - np.arange(first, last))
        )
        distance = min(split.distance, *((n // TILE - 1) // 2 for n in shape))
        self._reach = (distance + 1) * TILE - 1
        if split.sharp:
            self._kernel = _near_kernel(stiffness, shape, distance, split.sharp)
        else:
            few = tuple(min(n, _FITTED) for n in shape)
            stencil = _fitted(shape, _compliance(stiffness[grid.some_waves(shape, few)]).tobytes())
            self._kernel, self._reach = np.pad(stencil, self._reach - _REACH), _REACH
        waves = grid.wave_indices(self._coarse_shape)
        angles = _angles(waves, shape)
        nodes = np.arange(-before * coarsening, before * coarsening + 1)
        shared = [
            (np.cos(angle[..., np.newaxis] * nodes) * spline(nodes / coarsening)).sum(axis=-1) for angle in angles
        ]
        left = _compliance(stiffness[waves]) - _transform(self._kernel, *angles)
        self._far = left * (coarsening / (shared[0] * shared[1])) ** 2

    @property
    def transforms(self) -> int:
        """Transforms of the coarser grid made so far."""
        return int(self._field.n_transforms[0])

    @property
    def nodes(self) -> int:
        """Number of nodes of the coarser grid."""
        return self._field.n

    def place(self, tiles: Indices, places: Indices) -> None:
        """Prepare `apply` for some tiles, and the place of each tile among them."""
        self._tiles, self._places = tiles, places

    def apply(self, pressure: Reals, displacement: Reals) -> None:
        """Fill the displacement `[m + 1, TILE, TILE]` of the m tiles from the pressure on them."""
        (_, across), per_tile, weights = self._tiles_each_way, self._per_tile, self._weights
        loaded = (
            np.empty(len(pressure) + 1, dtype=np.int64),
            np.empty(pressure.size, dtype=np.int64),
            np.empty(pressure.size),
        )
        kernels.list_loaded(pressure, *loaded)
        coarse = self._field.memory[0]

        def far() -> None:
            kernels.spread(pressure, self._tiles, across, per_tile, weights, coarse, *self._coarse_shape)
            self._field.apply_stiffness(self._far)

        def near(_: int, first: int, last: int) -> None:
            each = self._tiles[first:last], self._places, self._tiles_each_way, self._ends
            kernels.convolve_loaded(loaded, *each, self._kernel, self._reach, displacement[first:last])

        def back(_: int, first: int, last: int) -> None:
            tiles, found = self._tiles[first:last], displacement[first:last]
            kernels.gather_back(coarse, tiles, across, per_tile, weights, *self._coarse_shape, found)

        reached = self._kernel.size // TILE**2  # tiles, by each loaded node
        team().share(near, self._tiles.size, max(displacement.size, int(loaded[0][-1]) * reached), far)
        team().share(back, self._tiles.size, displacement.size)


def _spline(order: int) -> Callable[[Reals], Reals]:
    """B-spline of an order and of unit integral, of the distance in nodes from its middle."""

    def at(x: Reals) -> Reals:
        # the divided difference of truncated powers, each of which grows from a knot on
        knots = np.arange(order + 1)
        weights = [(-1) ** k * math.comb(order, k) / math.factorial(order - 1) for k in knots]
        from_end = order / 2.0 - abs(x[..., np.newaxis]) - knots  # from the nearer end, where few grow
        return np.asarray((np.clip(from_end, 0.0, None) ** (order - 1)) @ weights)

    return at


def _compliance(stiffness: Reals) -> Reals:
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


def _near_kernel(stiffness: Reals, shape: tuple[int, ...], distance: int, sharp: float) -> Reals:
    """Kernel `[2 r + 1, 2 r + 1]` that fades within some tiles of distance, r = (distance + 1) TILE - 1.

    It is that of erf(K / a) / K, which is as smooth in q = 0 as K^2 is for all bodies. Short waves set a.
    """
    few = tuple(min(n, _SAMPLES) for n in shape)
    waves = grid.some_waves(shape, few)
    stiff = stiffness[waves]
    (along_y, along_x), (ny, nx) = _angles(waves, shape), few
    steep = max(stiff[ny // 2, 0] / abs(along_y[ny // 2, 0]), stiff[0, nx // 2] / along_x[0, nx // 2])
    fades = 2.0 * sharp / (distance * TILE) * steep
    with np.errstate(divide="ignore", invalid="ignore"):
        near = np.where(stiff > 0.0, scipy.special.erf(stiff / fades) / stiff, 2.0 / (math.sqrt(math.pi) * fades))
    reach = (distance + 1) * TILE - 1
    nodes = np.arange(-reach, reach + 1)
    return np.ascontiguousarray(grid.influence(near, *few)[np.ix_(nodes % few[0], nodes % few[1])])


@lru_cache(maxsize=64)  # maps of one size on one body, one block after another
def _fitted(shape: tuple[int, ...], compliance: bytes) -> Reals:
    """Even stencil whose relative error is least where the coarser grid cannot make up for it, of some waves.

    A wave on the coarser grid is taken for another one, the more so the shorter it is: its error counts as much.
    """
    few = tuple(min(n, _FITTED) for n in shape)
    along_y, along_x = _angles(grid.some_waves(shape, few), shape)
    soft = np.frombuffer(compliance).reshape(along_y.size, along_x.size)
    kept = np.abs(along_y) / (2.0 * np.pi) * MANY_TILES.coarsening, along_x / (2.0 * np.pi) * MANY_TILES.coarsening
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
