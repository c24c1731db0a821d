"""One map in contact: the exact gap under its pressure, and the pressure that closes it on the tiles it may reach."""

import math
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.kernels.tiles import TILE
from gfmd_numba.solvers.preconditioners.tile_field import TileField
from gfmd_numba.solvers.split_compliance import SplitCompliance

T = TypeVar("T", bound=np.generic)

_NEAR = 0.5  # gaps that may close, over the root-mean-square gap to be closed on the contact
_EXACT = 5e-3  # of the error before is left by the compliance between tiles, which is as inexact
_LOOSE = 0.2  # relative error allowed in the first pressure on a contact that is not yet known
_TIGHTEN, _AHEAD = 0.5, 0.1  # largest factor on it after a step that changed the contact; over the share of changes
_DENSE = 0.4  # share of tiles in contact beyond which the exact compliance costs less than that between tiles
_STEPS, _ITERATIONS = 12, 60  # at most, between two exact gaps and in one linear problem


@dataclass
class Level:
    """A grid that maps are pressed on: `stiffness` `[ny, nx // 2 + 1]`, and what is made of it."""

    shape: tuple[int, ...]
    stiffness: Reals
    compliance: SplitCompliance
    inverse: TileField

    def transforms_since(self, before: tuple[int, int]) -> float:
        """Transforms of coarser grids made since some were counted, in proportion to the cost of one of this grid."""
        n = math.prod(self.shape)
        near = (self.compliance.transforms - before[0]) * grid.relative_cost(self.compliance.nodes, n)
        return near + (self.inverse.transforms - before[1]) * grid.relative_cost(self.inverse.nodes, n)

    def count_transforms(self) -> tuple[int, int]:
        """Transforms of coarser grids made so far."""
        return self.compliance.transforms, self.inverse.transforms

    @classmethod
    def of(cls, stiffness: Reals, shape: tuple[int, ...]) -> "Level":
        """Prepare a grid."""
        return cls(shape, stiffness, SplitCompliance(stiffness, shape), TileField(stiffness, shape))


class MapContact:
    """Pressure of one map on the tiles that its contact may reach, and the gap it leaves everywhere.

    `wall` and `gap` are `[y, x]`; the latter is memory to be filled, as is that of the `transform`, which holds the
    first pressure. `load` is the mean pressure, or None where the position of the punch prescribes the displacement.
    Values on m tiles are `[m + 1, TILE, TILE]`; the last one is empty.
    """

    def __init__(self, level: Level, wall: Reals, gap: Reals, transform: Transform, load: float | None) -> None:
        self._level, self.wall, self.gap, self.transform, self._load = level, wall, gap, transform, load
        self.rows = transform.memory[0]
        self.free_mean = load is not None
        self._rounding = float(np.finfo(wall.dtype).eps * np.ptp(wall))
        down, across = (n // TILE for n in wall.shape)
        self._marks = np.zeros(down * across, dtype=np.bool_)
        self._places = np.empty(down * across, dtype=np.int64)
        kernels.mark_loaded(self.rows, wall.shape[1], self._marks)
        self.tiles = self._listed()
        self.pressure = self._zeros()
        kernels.take_tiles(self.rows, self.tiles, wall.shape[1], self.pressure)
        self.contact: Flags = self.pressure > 0.0
        self.count, self.coarse_transforms = 0, 0.0  # the latter in proportion to the cost of one of the map
        self._fresh = True  # the transform holds the pressure

    def look(self) -> float:
        """Find the exact gap and the tiles that the contact may reach; relative error of the pressure."""
        nx, level = self.wall.shape[1], self._level
        rows = self.rows
        if not self._fresh:
            kernels.put_tiles(self.pressure, self.tiles, rows, nx)
        self._fresh = False
        self.transform.soften(level.stiffness)
        self.count, approach, spread = kernels.level_of_contact(self.wall, rows, self.contact, self.tiles, nx)
        if not self.free_mean:
            approach, spread = 0.0, math.hypot(approach, spread)
        self._marks[:] = False
        kernels.open_map(self.wall, rows, approach, _NEAR * spread, self.gap, self._marks)
        kernels.mark_contact(self.contact, self.tiles, self._marks)
        self._retile()
        kernels.take_tiles(self.gap, self.tiles, nx, self._gap)
        self._exact = self.tiles.size > _DENSE * self._marks.size
        before = level.count_transforms()
        level.inverse.place(self.tiles, self._around)
        error = self._error()
        self.coarse_transforms += level.transforms_since(before)
        return error

    def settle(self, error: float, target: float) -> None:
        """Solve for pressure and contact on the tiles, as well as the compliance between them is known.

        `error` is that of the pressure now; below the relative error `target` nothing is gained.
        """
        goal = target if self._exact else max(_EXACT * min(error, 1.0), target)
        tolerance = goal if error < _LOOSE else max(goal, _LOOSE)
        level, before, gap = self._level, self.pressure.copy(), self._gap.copy()
        counted = level.count_transforms()
        level.compliance.place(self.tiles, self._around)  # other maps share the level
        level.inverse.place(self.tiles, self._around)
        for _ in range(_STEPS):
            iterations = self._close_gap(tolerance)
            changed, self.count = kernels.revise_tiles(
                _flat(self.pressure), _flat(self._gap), _flat(self.contact), self.count,
                0.0 if self._load is None else self._load * self.wall.size, self._rounding, self.free_mean,
            )  # fmt: skip
            if tolerance <= goal and (not changed or not iterations):
                break
            if changed:
                np.add(gap, self._softened(self.pressure - before), out=self._gap)
            tighter = min(_TIGHTEN * tolerance, _AHEAD * changed / max(self.count, 1))
            tolerance = max(tighter, goal)
        self.coarse_transforms += level.transforms_since(counted)

    def _close_gap(self, tolerance: float) -> int:
        """Conjugate gradients for the pressure that closes the gap on the nodes in contact; how many."""
        if self.count == 0:
            return 0
        level = self._level
        residual, change, direction = self._zeros(), self._zeros(), self._zeros()
        p, gap, r, z, t = (_flat(values) for values in (self.pressure, self._gap, residual, change, direction))
        st = np.zeros_like(t)
        contact = _flat(self.contact)
        level.inverse.factor(self.contact)
        kernels.closing_residual(gap, contact, r, self.count, self.free_mean)
        last = step = 0.0
        for iteration in range(_ITERATIONS):
            level.inverse.solve(residual, change)
            energy, error = kernels.tile_error(r, z, p, contact, self.count, self._rounding, self.free_mean)
            if not error > tolerance:
                return iteration
            kernels.tile_direction(z, st, t, step, last)
            last = energy
            st = _flat(self._softened(direction))
            step = kernels.tile_update(kernels.Iterate(p, gap, t, st), energy, contact, self.count, r, self.free_mean)
        return _ITERATIONS

    def _softened(self, pressure: Reals) -> Reals:
        """Displacement that a pressure on the tiles causes there."""
        displacement = self._zeros()
        if not self._exact:
            self._level.compliance.apply(pressure, displacement)
            return displacement
        rows, nx = self.rows, self.wall.shape[1]
        kernels.put_tiles(pressure, self.tiles, rows, nx)
        self.transform.soften(self._level.stiffness)
        kernels.take_tiles(rows, self.tiles, nx, displacement)
        return displacement

    def _error(self) -> float:
        """Relative error of the pressure, of nodes that overlap without being in contact too."""
        overlap = -float(self._gap[:-1][~self.contact[:-1]].min(initial=0.0))
        if self.count == 0:
            return np.inf if overlap > self._rounding else 0.0
        residual, change = self._zeros(), self._zeros()
        r, z, p, contact = _flat(residual), _flat(change), _flat(self.pressure), _flat(self.contact)
        self._level.inverse.factor(self.contact)
        kernels.closing_residual(_flat(self._gap), contact, r, self.count, self.free_mean)
        self._level.inverse.solve(residual, change)
        error = kernels.tile_error(r, z, p, contact, self.count, self._rounding, self.free_mean)[1]
        return float(max(error, overlap * self._level.inverse.stiffest / p.max()))

    def _zeros(self) -> Reals:
        return np.zeros((self.tiles.size + 1, TILE, TILE))

    def _listed(self) -> Indices:
        """Marked tiles, whose places are then known."""
        tiles = np.empty(int(self._marks.sum()), dtype=np.int64)
        kernels.list_tiles(self._marks, tiles, self._places)
        return tiles

    def _retile(self) -> None:
        """Take pressure and contact to the tiles now marked."""
        places, pressure, contact = self._places.copy(), self.pressure, self.contact
        self.tiles = self._listed()
        self._around = np.empty((self.tiles.size, 9), dtype=np.int64)
        kernels.surround(self.tiles, self._places, *(n // TILE for n in self.wall.shape), self._around)
        self.pressure, self._gap = self._zeros(), self._zeros()
        self.contact = np.zeros(self.pressure.shape, dtype=np.bool_)
        kernels.move_tiles(pressure, places, self.tiles, self.pressure)
        kernels.move_tiles(contact, places, self.tiles, self.contact)


def _flat(values: npt.NDArray[T]) -> npt.NDArray[T]:
    """Values on the listed tiles, without the empty one."""
    return values[:-1].reshape(-1)
