"""Active-set Newton method for a hard wall that meets maps: exact displacements now and then, near ones in between."""

import math
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.arrays.threads import team
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.kernels.tiles import TILE
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.pressures import Closing, refine
from gfmd_numba.solvers.table import SOLVERS, Options
from gfmd_numba.solvers.tiles.compliance import SplitCompliance, TileField, fits

T = TypeVar("T", bound=np.generic)

_NEAR = 0.5  # gaps that may close, over the root-mean-square gap to be closed on the contact
_EXACT = 5e-3  # of the error before is left by the compliance between tiles, which is as inexact
_LOOSE = 0.2  # relative error allowed in the first pressure on a contact that is not yet known
_TIGHTEN, _AHEAD = 0.5, 0.1  # largest factor on it after a step that changed the contact; over the share of changes
_DENSE = 0.25  # share of tiles of a period beyond which the exact compliance costs less than that between tiles
_STEPS, _ITERATIONS = 12, 60  # at most, between two exact gaps and in one linear problem


@dataclass
class Level:
    """A grid that maps are pressed on: `stiffness` `[ny, nx // 2 + 1]`, and what is made of it.

    `held` are the nodes (y, x) in a corner, in whole tiles, which alone are ever in contact.
    """

    shape: tuple[int, ...]
    stiffness: Reals
    compliance: SplitCompliance
    inverse: TileField
    held: tuple[int, ...]

    @property
    def ends(self) -> tuple[bool, bool]:
        """Whether what is held ends along y and x, and is no period."""
        return self.held[0] < self.shape[0], self.held[1] < self.shape[1]

    @property
    def is_filled_in_part(self) -> bool:
        """Whether some rows never hold a pressure."""
        return self.ends[0]

    def transform(self, rows: int = 1) -> Transform:
        """Transform in place of maps on this grid."""
        return Transform(rows, *self.shape, in_place=True, filled=self.held[0] if self.is_filled_in_part else None)

    def transforms_since(self, before: tuple[int, int]) -> float:
        """Transforms of coarser grids made since some were counted, in proportion to the cost of one of this grid."""
        n = math.prod(self.shape)
        near = (self.compliance.transforms - before[0]) * grid.relative_cost(self.compliance.nodes, n)
        return near + (self.inverse.transforms - before[1]) * grid.relative_cost(self.inverse.nodes, n)

    def count_transforms(self) -> tuple[int, int]:
        """Transforms of coarser grids made so far."""
        return self.compliance.transforms, self.inverse.transforms

    @classmethod
    def of(cls, stiffness: Reals, shape: tuple[int, ...], share: tuple[float, ...]) -> "Level":
        """Prepare a grid of which contacts stay in a corner, a share of it in each direction."""
        held = tuple(TILE * math.ceil(n * part / TILE) for n, part in zip(shape, share, strict=True))
        across = held[1] // TILE
        return cls(
            shape, stiffness, SplitCompliance(stiffness, shape, across), TileField(stiffness, shape, across), held
        )


class MapContact:
    """Pressure of one map on the tiles that its contact may reach, and the gap it leaves wherever a level is held.

    `wall` and `gap` are `[y, x]` there; the latter is memory to be filled, as is that of the `transform`, which holds
    the first pressure. `load` is the mean pressure, or None where the position of the punch prescribes the
    displacement. Values on m tiles are `[m + 1, TILE, TILE]`; the last one is empty.
    """

    def __init__(self, level: Level, wall: Reals, gap: Reals, transform: Transform, load: float | None) -> None:
        self._level, self.wall, self.gap, self.transform, self._load = level, wall, gap, transform, load
        self.rows = transform.memory[0, : wall.shape[0]]
        self.free_mean, self.approach = load is not None, 0.0
        self._rounding = float(np.finfo(np.float64).eps * np.ptp(wall))
        self._tiles_each_way = tuple(n // TILE for n in wall.shape)
        self._marks: Flags = (tiles_of(self.rows, wall.shape[1]).max(axis=(2, 3)) > 0.0).ravel()
        self.tiles, self._places = listed(self._marks)
        self.pressure = self._zeros()
        kernels.take_tiles(self.rows, self.tiles, wall.shape[1], self.pressure)
        self.contact: Flags = self.pressure > 0.0
        self.count, self.coarse_transforms = 0, 0.0  # the latter in proportion to the cost of one of the map
        self._fresh = True  # the transform holds the pressure

    def look(self) -> float:
        """Find the exact gap and the tiles that the contact may reach; relative error of the pressure."""
        nx, level, rows = self.wall.shape[1], self._level, self.rows
        if not self._fresh:
            put_tiles(self.pressure, self.tiles, rows, nx)
        self._fresh = False
        self.transform.soften(level.stiffness, level.is_filled_in_part)
        gaps = self._gaps_in_contact()
        self.count, approach, spread = gaps.size, 0.0, 0.0
        if gaps.size:
            approach = float(gaps.mean()) if self.free_mean else 0.0
            spread = math.sqrt(((gaps - approach) ** 2).mean())
        self.approach, self._marks[:] = approach, False
        self._open(approach, _NEAR * spread)
        self._marks[self.tiles[self.contact[:-1].any(axis=(1, 2))]] = True
        self._retile()
        kernels.take_tiles(self.gap, self.tiles, nx, self._gap)
        self._exact = not any(level.ends) and self.tiles.size > _DENSE * self._marks.size
        before = level.count_transforms()
        level.inverse.place(self.tiles, self._around)
        error = self._error()
        self.coarse_transforms += level.transforms_since(before)
        return error

    def _gaps_in_contact(self) -> Reals:
        """Gaps `[node]` on the nodes in contact, up to the approach."""
        gaps, displacement = self._zeros(), self._zeros()
        kernels.take_tiles(self.wall, self.tiles, self.wall.shape[1], gaps)
        kernels.take_tiles(self.rows, self.tiles, self.wall.shape[1], displacement)
        gaps += displacement
        return gaps[self.contact]

    def _open(self, approach: float, near: float) -> None:
        """Find the gap and mark the tiles where it is anywhere below `near`."""
        across = self._tiles_each_way[1]

        def some(_: int, first: int, last: int) -> None:
            nodes, tiles = slice(first * TILE, last * TILE), slice(first * across, last * across)
            each = self.wall[nodes], self.rows[nodes], approach, near, self.gap[nodes], self._marks[tiles]
            kernels.open_map(*each)

        team().share(some, self._tiles_each_way[0], self.wall.size)

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
        total = 0.0 if self._load is None else self._load * self.transform.n
        for _ in range(_STEPS):
            closing = self._closing()
            iterations = closing.solve(tolerance, _ITERATIONS) if closing.nodes.size else 0
            iterate, contact = closing.iterate, _flat(self.contact)
            changed = kernels.revise_contact(
                iterate, contact, closing.nodes, closing.nodes.size, contact.size, total, self._rounding, self.free_mean
            )
            self.count = int(np.count_nonzero(contact))
            if tolerance <= goal and (not changed or not iterations):
                break
            if changed:
                self._soften(self.pressure - before, self._gap)
                self._gap += gap
            tighter = min(_TIGHTEN * tolerance, _AHEAD * changed / max(self.count, 1))
            tolerance = max(tighter, goal)
        self.coarse_transforms += level.transforms_since(counted)

    def _closing(self) -> Closing:
        """Problem of the pressure that closes the gap on the nodes in contact."""
        nodes, inverse = np.flatnonzero(_flat(self.contact)), self._level.inverse
        inverse.factor(nodes, self.contact)
        direction, displacement = self._zeros(), self._zeros()
        iterate = kernels.Iterate(*(_flat(each) for each in (self.pressure, self._gap, direction, displacement)))
        soften, room = partial(self._soften, direction, displacement), np.empty((2, nodes.size))
        # uniform pressures take off what changes the load
        return Closing(iterate, nodes, inverse, soften, np.ones(nodes.size), self._rounding, self.free_mean, room)

    def _soften(self, pressure: Reals, displacement: Reals) -> None:
        """Fill the displacement that a pressure on the tiles causes there."""
        if not self._exact:
            self._level.compliance.apply(pressure, displacement)
            return
        rows, nx = self.rows, self.wall.shape[1]
        put_tiles(pressure, self.tiles, rows, nx)
        self.transform.soften(self._level.stiffness, self._level.is_filled_in_part)
        kernels.take_tiles(rows, self.tiles, nx, displacement)

    def _error(self) -> float:
        """Relative error of the pressure, of nodes that overlap without being in contact too."""
        overlap = -float(self._gap[:-1][~self.contact[:-1]].min(initial=0.0))
        if self.count == 0:
            return np.inf if overlap > self._rounding else 0.0
        return max(self._closing().error(), overlap * self._level.inverse.stiffest / float(self.pressure.max()))

    def _zeros(self) -> Reals:
        return np.zeros((self.tiles.size + 1, TILE, TILE))

    def _retile(self) -> None:
        """Take pressure and contact to the tiles now marked."""
        before, pressure, contact = self._places, self.pressure, self.contact
        self.tiles, self._places = listed(self._marks)
        self._around = np.empty((self.tiles.size, 9), dtype=np.int64)
        kernels.surround(self.tiles, self._places, *self._tiles_each_way, self._level.ends, self._around)
        self.pressure, self._gap = self._zeros(), self._zeros()
        self.contact = np.zeros(self.pressure.shape, dtype=np.bool_)
        self.pressure[:-1], self.contact[:-1] = pressure[before[self.tiles]], contact[before[self.tiles]]


def tiles_of(rows: Reals, nx: int) -> Reals:
    """View `[y, x, TILE, TILE]` of the tiles of a map of nx columns, whose rows may be longer."""
    return rows[:, :nx].reshape(-1, TILE, nx // TILE, TILE).swapaxes(1, 2)


def listed(marks: Flags) -> tuple[Indices, Indices]:
    """Marked tiles, and the place of each tile among them; of those that are not marked it is their number."""
    tiles = np.flatnonzero(marks)
    places = np.full(marks.size, tiles.size)
    places[tiles] = np.arange(tiles.size)
    return tiles, places


def put_tiles(values: Reals, tiles: Indices, rows: Reals, nx: int) -> None:
    """Fill rows of a map, nx nodes wide, with the values on the listed tiles, and zeros elsewhere."""
    team().by_rows(lambda some: rows[some].fill(0.0), rows.shape)
    kernels.put_tiles(values, tiles, rows, nx)


def _flat(values: npt.NDArray[T]) -> npt.NDArray[T]:
    """Values on the listed tiles, without the empty one."""
    return values[:-1].reshape(-1)


_COARSEST = 64  # nodes along the shorter side up to which the first guess is full contact
_SETTLED = 0.03  # relative error of the pressure with which a coarser grid is left


def levels(stiffness: Reals, shape: tuple[int, ...], held: tuple[int, ...]) -> list[Level]:
    """Grids from the given one down, each about half as fine as the one before; punches are `held` in a corner."""
    share = tuple(m / n for m, n in zip(held, shape, strict=True))
    made = [Level.of(stiffness, shape, share)]
    while min(shape) > _COARSEST:
        shape = tuple(TILE * -(-n // (2 * TILE)) for n in shape)
        stiffness = stiffness[grid.wave_indices(shape)]
        made.append(Level.of(stiffness, shape, share))
    return made


def guess(
    grids: list[Level], wall: Reals, around: float, transform: Transform, load: float | None, start: float
) -> float:
    """Fill the transform of the first grid with a pressure; transforms of coarser grids, by their cost on this one.

    `start` is the uniform pressure that the coarsest grid begins with. The wall is flat `around` where it is held.
    """
    ny, nx = grids[0].held
    if len(grids) == 1:
        transform.samples[0] = 0.0
        transform.samples[0, :ny, :nx] = start * (1.0 if load is None else transform.n / (ny * nx))
        return 0.0
    coarse = grids[1]
    own = coarse.transform()

    def begin(some: slice) -> None:
        transform.samples[0, some, nx:] = 0.0
        np.subtract(wall[some], around, out=transform.samples[0, some, :nx])

    team().by_rows(begin, wall.shape)
    transform.coarsen(own, grids[0].is_filled_in_part)
    smooth = own.samples[0, : coarse.held[0], : coarse.held[1]] + around
    spent = guess(grids[1:], smooth, around, own, load, start)
    contact = MapContact(coarse, smooth, np.empty(coarse.held), own, load)
    contact.settle(contact.look(), _SETTLED)
    put_tiles(contact.pressure, contact.tiles, own.memory[0], coarse.held[1])
    samples = transform.samples[0, :ny]
    refine(own.samples[0], samples, transform.shape[0])
    samples[:, nx:] = 0.0
    if load is not None:
        factor = load * (transform.n / samples.size) / samples.mean()
        team().by_rows(lambda some: np.multiply(samples[some], factor, out=samples[some]), samples.shape)
    return (spent + int(own.n_transforms[0]) + contact.coarse_transforms) * grid.relative_cost(own.n, transform.n)


_EXACT_ENOUGH = 0.1  # error of the pressure aimed at, over the residual asked for


def tile_newton(batch: Batch, options: Options) -> "TileNewton | None":
    """Begin on maps that tiles cover, without a hardness."""
    takes = batch.interface.hardness is None and fits(batch.shape)
    return TileNewton(batch, options) if takes else None


class TileNewton:
    """Pressures of a batch of maps, each found by guessing its contact, as in `active_set_newton.py`.

    An iteration closes the gap on the tiles of the map that the contact may reach, by a compliance between them that
    is nearly right, and then finds the exact gap everywhere: two transforms of the map, which leave about a hundredth
    of the error. Where tiles are too many to gain from that, the exact compliance closes the gap. The first guess comes
    from a cascade of coarser grids. The certificate costs two transforms more, and is looked at once the error of the
    pressure is that small; until then `residual` is that error. What restores the displacement that a pressure causes
    is that pressure, so that only what closing the gap adds to it is transformed.

    Of the size of the map are the displacement, which is the gap until the certificate needs it, and the memory of the
    transform, which is the restoring traction afterwards; pressures live on tiles. Without a period the map is the
    window of the punch, and only the transform is larger.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options) -> None:
        rows, stiffness = len(batch.punch), batch.response.normal
        grids = levels(stiffness, batch.shape, batch.punch.shape[1:])
        held = grids[0].held
        wall = batch.punch if batch.punch.shape[1:] == held else batch.within(held)
        self.field = Held(math.prod(held), held)
        room = batch.room if batch.room is not None and batch.room.shape == wall.shape else np.empty(wall.shape)
        self.wall, self.displacement = wall.reshape(rows, -1), room.reshape(rows, -1)
        self.load, self._transform = batch.loads, grids[0].transform(rows)
        self.state = kernels.State.of_normal(self.displacement, self._transform.result, self.wall, self.load)
        self.certificate = batch.certificate()
        if batch.around is not None:
            self.certificate.mean_displacement = np.zeros(rows)
        self._stiffness, self._residual = stiffness, options.residual
        # the certificate of the last iteration is looked at whatever the error
        self._left = np.full(rows, min(options.max_iterations, SOLVERS[options.solver].gives_up_after or np.inf))
        self._error = np.full(rows, np.nan)
        self._coarse_transforms = np.zeros(rows)
        self._contacts: list[MapContact] = []
        for i in range(rows):
            transform = self._transform.row(i)
            load = None if batch.load is None else float(batch.load[i])
            around = 0.0 if batch.around is None else float(batch.around[i].item())
            start = float(batch.uniform_pressure[i])
            self._coarse_transforms[i] = guess(grids, wall[i], around, transform, load, start)
            self._contacts.append(MapContact(grids[0], wall[i], self.displacement[i].reshape(held), transform, load))

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation, those of coarser grids in proportion to their cost."""
        others = self._coarse_transforms + np.array([contact.coarse_transforms for contact in self._contacts])
        return np.asarray(self._transform.n_transforms + np.ceil(others).astype(np.int64))

    def advance(self, active: Indices) -> None:
        """Close the gap of each active row as it is known, and find the exact one."""
        for i in active:
            contact = self._contacts[i]
            if not np.isnan(self._error[i]):
                contact.settle(self._error[i], _EXACT_ENOUGH * self._residual)
            self._error[i] = contact.look()
            self._left[i] -= 1

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions, or the error of a pressure too far off to look at that."""
        return np.array([self._violation(i) for i in active])

    def _violation(self, i: int) -> float:
        error = float(self._error[i])
        if error > self._residual and self._left[i] > 0:
            return error
        contact, row, (ny, nx) = self._contacts[i], np.array([i]), self.field.shape
        transform, memory, stiffest = contact.transform, contact.transform.memory[0], float(self._stiffness[0, 0])
        held = 0.0 < stiffest < np.inf
        mean = float(contact.pressure.sum()) / transform.n
        kernels.close_map(contact.wall, contact.gap, contact.contact, contact.tiles, memory)
        if self.certificate.mean_displacement is not None:
            added = float(memory[:ny, :nx].sum()) / transform.n
            self.certificate.mean_displacement[i] = contact.approach + added - (mean / stiffest if held else 0.0)
        transform.stiffen(self._stiffness)
        shift = 0.0 if held else mean  # nothing restores a mean displacement, or it is rigid
        if self.certificate.rigid_mean is not None:  # the mean pressure is the multiplier of a zero mean
            self.load[i] = mean
        largest, total = kernels.tractions_around(memory, ny, nx, transform.shape[1], float(self.load[i]) - shift)
        kernels.restore_map(contact.pressure, contact.tiles, nx, shift, contact.rows)
        kernels.pack_rows(contact.rows, nx)
        self.certificate.look(self.state, row, self.field.n)
        share = self.field.n / transform.n
        return self.certificate.with_surroundings(i, self.load, largest, total / transform.n, share)


class Held(NamedTuple):
    """The nodes that the state of a solver has, and their shape (y, x)."""

    n: int
    shape: tuple[int, ...]
