"""Active-set Newton method for maps on a hard wall, whose linear problems have an approximate compliance between tiles.

The exact displacement is found once in each iteration.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.arrays.threads import team
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import OnRows, Transform
from gfmd_numba.kernels.tiles import TILE
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.pressures import Closing, between
from gfmd_numba.solvers.table import SOLVERS, Options
from gfmd_numba.solvers.tiles.compliance import FEW_TILES, MANY_TILES, SplitCompliance, fits
from gfmd_numba.solvers.two_level_preconditioner import TiledTwoLevelPreconditioner

T = TypeVar("T", bound=np.generic)

_MAY_CLOSE = 0.5  # gaps that may close, over the root-mean-square gap to be closed on the contact
_MOST_LEFT = 0.1  # of the error before, by a step that goes on as the last one did
_LOOSE = 0.2  # relative error allowed in the first pressure on a contact that is not yet known
_TIGHTEN, _AHEAD = 0.5, 0.1  # largest factor on it after a step that changed the contact; over the share of changes
_DILUTE = 1 / 64  # share of tiles up to which the closer compliance `of_few_tiles` costs little
_DENSE = 0.25  # share of tiles of a period beyond which the exact compliance costs less than that between tiles
_LARGE, _DENSE_NODES, _DENSE_NODES_OF_LARGE = 2**20, 1 / 24, 1 / 10  # share of nodes in contact for the same
_SAMPLES, _MORE = 256, 1.1  # nodes in each direction of a half-space that feel one; all feel less than this times more
_SAME = 1e-6  # relative difference of stiffness over wavenumber up to which a body is a half-space
_STEPS, _ITERATIONS = 12, 60  # at most, between two exact gaps and in one linear problem


@dataclass
class TileLevel:
    """A grid that maps are pressed on: `stiffness` `[ny, nx // 2 + 1]`, and operators made of it with their first use.

    `held` are the nodes (y, x) in a corner, in whole tiles, which alone are ever in contact.
    """

    shape: tuple[int, ...]
    stiffness: Reals
    held: tuple[int, ...]

    @property
    def ends(self) -> tuple[bool, bool]:
        """Whether what is held ends along y and x, and is no period."""
        return self.held[0] < self.shape[0], self.held[1] < self.shape[1]

    @property
    def tiles_each_way(self) -> tuple[int, int]:
        """Tiles (y, x) of what is held."""
        return self.held[0] // TILE, self.held[1] // TILE

    @cached_property
    def inverse(self) -> TiledTwoLevelPreconditioner:
        """Preconditioner of the compliance."""
        return TiledTwoLevelPreconditioner(self.stiffness, self.shape, self.tiles_each_way[1])

    @cached_property
    def of_many_tiles(self) -> SplitCompliance:
        """Compliance between tiles."""
        return SplitCompliance(self.stiffness, self.shape, self.tiles_each_way, self.ends, MANY_TILES)

    @cached_property
    def of_few_tiles(self) -> SplitCompliance:
        """Compliance between few tiles, which is closer to the exact one."""
        return SplitCompliance(self.stiffness, self.shape, self.tiles_each_way, self.ends, FEW_TILES)

    @cached_property
    def largest_traction(self) -> float:
        """Bound of the restoring tractions of displacements of at most 1: sum of |K| between a node and all others.

        It is the same on any grid for a half-space, so that a few of its waves suffice. For other bodies on large maps
        it is infinite: to find it would take as much time as transforms of the displacement, and more memory.
        """
        few = tuple(min(n, _SAMPLES) for n in self.shape)
        sides = self.stiffness[0, 1:], self.stiffness[1 : self.shape[0] // 2, 0]
        slopes = [side / np.arange(1, side.size + 1) for side in sides]
        if few != self.shape and any(np.ptp(slope) > _SAME * slope[0] for slope in slopes):
            return np.inf
        return _MORE * _sum_of_influences(self.stiffness[grid.some_waves(self.shape, few)].tobytes(), few)

    def transform(self, rows: int = 1) -> Transform:
        """Transform in place of maps on this grid."""
        return Transform(rows, *self.shape, in_place=True, filled=self.held[0] if self.ends[0] else None)

    def transforms(self) -> float:
        """Transforms of coarser grids made so far, in proportion to the cost of one of this grid."""
        made = (self.__dict__.get(name) for name in ("inverse", "of_many_tiles", "of_few_tiles"))
        n = math.prod(self.shape)
        return float(sum(each.transforms * grid.relative_cost(each.nodes, n) for each in made if each is not None))

    @classmethod
    def of(cls, stiffness: Reals, shape: tuple[int, ...], share: tuple[float, ...]) -> "TileLevel":
        """Prepare a grid of which contacts stay in a corner, a share of it in each direction."""
        held = tuple(TILE * math.ceil(n * part / TILE) for n, part in zip(shape, share, strict=True))
        return cls(shape, stiffness, held)


class MapContact:
    """Pressure of one map on the tiles that its contact may reach, its relative error, and the gap there.

    The `wall` is `[y, x]` on the nodes that the level holds. `load` is the mean pressure, or None where the position of
    the punch prescribes the displacement. Values on m tiles are `[m + 1, TILE, TILE]`; the last one is empty.
    """

    def __init__(self, level: TileLevel, wall: Reals, transform: Transform, load: float | None) -> None:
        self._level, self.wall, self.transform, self._load = level, wall, transform, load
        self.rows = transform.memory[0, : wall.shape[0]]
        self.free_mean, self.approach, self.error = load is not None, 0.0, np.inf
        self._left, self.full_contact = 0.0, 0.0  # of the error, by the last step; rms pressure, or 0 if not known
        self._rounding = float(np.finfo(np.float64).eps * np.ptp(wall))
        self._marks: Flags = np.zeros(math.prod(level.tiles_each_way), dtype=np.bool_)
        self.tiles, self._places = listed(self._marks)
        self._around = np.empty((0, 9), dtype=np.int64)
        self.pressure, self._gap, self._direction, self._moved = self._zeros()
        self.contact: Flags = self.pressure > 0.0
        self.count, self.coarse_transforms = 0, 0.0  # the latter in proportion to the cost of one of the map

    def begin(self, pressure: float) -> None:
        """Begin with a uniform pressure on all nodes."""
        self._marks[:] = True
        self._retile()
        self.pressure[:-1], self.contact[:-1] = pressure, pressure > 0.0
        self.count = int(np.count_nonzero(self.contact))
        self._begin_on_tiles()

    def follow(self, coarse: "MapContact", gap: Reals) -> None:
        """Begin with the contact of a coarser grid, and fill the `gap` `[y, x]` with the displacement there."""
        shape, coarse_shape, across = self.wall.shape, coarse.transform.shape, self._level.tiles_each_way[1]
        places = between(coarse_shape, self.transform.shape)
        (above, down), (left, right) = ((at[:n], part[:n]) for (at, part), n in zip(places, shape, strict=True))
        loaded = coarse.loaded_tiles()
        for axis, at in enumerate((above, left)):  # the tiles that a tile lies on
            ends = at[::TILE], (at[TILE - 1 :: TILE] + 1) % coarse_shape[axis]
            first, last = (np.minimum(each // TILE, loaded.shape[axis] - 1) for each in ends)
            loaded = loaded.take(first, axis) | loaded.take(last, axis)
        self._marks[:] = loaded.ravel()
        self._retile()
        samples = coarse.transform.samples[0, : coarse.wall.shape[0]]
        coarse.put()
        pressure, tiles = self.pressure, self.tiles

        def onto(_: int, a: int, b: int) -> None:
            kernels.refine_tiles(samples, above, down, left, right, tiles[a:b], across, pressure[a:b])

        team().share(onto, tiles.size, pressure.size)
        total = float(self.pressure.sum())
        if self._load is not None and total > 0.0:
            self.pressure *= self._load * self.transform.n / total
        np.greater(self.pressure, 0.0, out=self.contact)
        coarse.displace()

        def some(rows: slice) -> None:
            kernels.refine_map(samples, above[rows], down[rows], left, right, gap[rows])

        team().by_rows(some, gap.shape)

    def sharpen(self, gap: Reals) -> None:
        """Go on where the `gap` `[y, x]` is yet the displacement of a coarser grid, which is not needed any more."""
        self._open(gap, gap)
        self._take(gap, self._gap)
        self._close_on_tiles()
        self._begin_on_tiles()

    def loaded_tiles(self) -> Flags:
        """Whether each tile `[y, x]` is in contact."""
        loaded = np.zeros(self._marks.size, dtype=np.bool_)
        loaded[self.tiles] = self.contact[:-1].reshape(-1, TILE**2).any(axis=1)
        return loaded.reshape(self._level.tiles_each_way)

    def put(self) -> None:
        """Put the pressure on the map into the transform."""
        put, rows = self._on_rows(kernels.put_on_rows, self.pressure), self.rows

        def some(_: int, first: int, last: int) -> None:
            put(first * TILE, rows[first * TILE : last * TILE])

        team().share(some, self._level.tiles_each_way[0], rows.size)

    def displace(self, load: OnRows | None = None) -> None:
        """Replace what is in the transform, or what `load` puts there, by the displacement that it causes."""
        self.transform.apply_compliance(
            self._level.stiffness, self._level.ends[0], load
        )  # some rows are then never loaded

    def _on_rows(self, kernel: Callable[[Reals, Indices, int, int, Reals], None], values: Reals) -> OnRows:
        """Function that puts values of the tiles on some rows of the map, or takes them from there."""
        return partial(kernel, values, self.tiles, self.wall.shape[1])

    def look(self, gap: Reals) -> None:
        """Fill the exact gap `[y, x]`, up to the approach, and find the tiles that the contact may reach."""
        self.displace(self._on_rows(kernels.put_on_rows, self.pressure))
        self._open(self.rows, gap)
        self._take(gap, self._gap)
        before, error = self._level.transforms(), self.error
        self._choose()
        self.error = self._error()
        self._left = min(self.error / error, _MOST_LEFT) if error > 0.0 else 0.0
        self.coarse_transforms += self._level.transforms() - before

    def _open(self, displacement: Reals, gap: Reals) -> None:
        """Fill the gap of a displacement, and list the tiles where it may close."""
        across = self._level.tiles_each_way[1]
        self.count, mean, variance = kernels.gaps_in_contact(self.wall, displacement, self.tiles, self.contact)
        self.approach = mean if self.free_mean else 0.0
        near = _MAY_CLOSE * math.sqrt(variance + (mean - self.approach) ** 2)
        self._marks[:] = self.loaded_tiles().ravel()

        def some(_: int, first: int, last: int) -> None:
            nodes, tiles = slice(first * TILE, last * TILE), slice(first * across, last * across)
            each = self.wall[nodes], displacement[nodes], self.approach, near, gap[nodes], self._marks[tiles]
            kernels.open_map(*each)

        team().share(some, self._level.tiles_each_way[0], self.wall.size)
        self._retile()

    def _take(self, image: Reals, values: Reals) -> None:
        nx, tiles = self.wall.shape[1], self.tiles
        team().share(lambda _, a, b: kernels.take_tiles(image, tiles[a:b], nx, values[a:b]), tiles.size, values.size)

    def _begin_on_tiles(self) -> None:
        """Find the gap on the tiles as well as the compliance between them is known."""
        before = self._level.transforms()
        self._choose()
        self._apply_compliance(self.pressure, self._gap)
        self._take(self.wall, self._moved)
        self._gap += self._moved
        self.error = self._error()
        self.coarse_transforms += self._level.transforms() - before

    def _close_on_tiles(self) -> None:
        """Correct the pressure on the contact of a coarser grid for the shorter waves; nodes under tension leave."""
        before = self._level.transforms()
        if self.count:
            closing = self._closing()
            closing.error()
            pressure = _flat(self.pressure)
            changed = closing.changed
            pressure[closing.nodes] = np.maximum(changed, 0.0, out=changed)
            np.greater(self.pressure, 0.0, out=self.contact)
            self.count = int(np.count_nonzero(self.contact))
            if self._load is not None:
                pressure *= self._load * self.transform.n / pressure.sum()
        self.coarse_transforms += self._level.transforms() - before

    def _choose(self) -> None:
        """Choose the compliance between the tiles."""
        share, nodes = self.tiles.size / self._marks.size, self.wall.size
        most = nodes * (_DENSE_NODES if nodes < _LARGE else _DENSE_NODES_OF_LARGE)
        self._exact = not any(self._level.ends) and (share > _DENSE or self.count > most)
        if not self._exact:
            self._compliance = self._level.of_few_tiles if share < _DILUTE else self._level.of_many_tiles

    def settle(self, target: float) -> None:
        """Solve for pressure and contact on the tiles, as well as the compliance between them is known.

        Below the relative error `target` nothing is gained.
        """
        error = self.error
        goal = target if self._exact else max(max(self._compliance.error, self._left) * min(error, 1.0), target)
        tolerance = goal if error < _LOOSE else max(goal, _LOOSE)
        counted = self._level.transforms()
        for _ in range(_STEPS):
            iterations, changed = self._revise(tolerance, tolerance > goal)
            if tolerance <= goal and (not changed or not iterations):
                break
            tighter = min(_TIGHTEN * tolerance, _AHEAD * changed / max(self.count, 1))
            tolerance = max(tighter, goal)
        self.coarse_transforms += self._level.transforms() - counted

    def _revise(self, tolerance: float, loosely: bool) -> tuple[int, int]:
        """Close the gap on the contact, and revise the contact; return iterations and changed nodes.

        After the last iteration the next change of the pressure is known. If it need not be exact (`loosely`), it is
        added before the contact is revised, and costs nothing.
        """
        closing, contact = self._closing(), _flat(self.contact)
        iterate, nodes = closing.iterate, closing.nodes
        iterations = closing.solve(tolerance, _ITERATIONS) if nodes.size else 0
        ahead = loosely and 0 < iterations < _ITERATIONS
        before, p = iterate.t, iterate.p
        team().in_pieces(lambda some: np.copyto(before[some], p[some]), p.size)
        if ahead:
            p[nodes] = closing.changed
        changed = closing.revise(contact, 0.0 if self._load is None else self._load * self.transform.n)
        if changed:
            team().in_pieces(lambda some: np.subtract(p[some], before[some], out=before[some]), p.size)
            closing.apply_compliance()
            closing.open(1.0)
        elif ahead:
            iterate.p[nodes] -= closing.change
        self.count = int(np.count_nonzero(contact))
        return iterations, int(changed)

    def _closing(self) -> Closing:
        """Problem of the pressure that closes the gap on the nodes in contact."""
        nodes, inverse = np.flatnonzero(_flat(self.contact)), self._level.inverse
        inverse.factor(nodes, self.tiles, self._around)
        iterate = kernels.Iterate(*map(_flat, (self.pressure, self._gap, self._direction, self._moved)))
        apply_compliance, room = (
            partial(self._apply_compliance, self._direction, self._moved),
            np.empty((2, nodes.size)),
        )
        # uniform pressures take off what changes the load
        uniform = np.broadcast_to(1.0, nodes.size)
        return Closing(iterate, nodes, inverse, apply_compliance, uniform, self._rounding, self.free_mean, room)

    def _apply_compliance(self, pressure: Reals, displacement: Reals) -> None:
        """Fill the displacement that a pressure on the tiles causes there."""
        if not self._exact:
            self._compliance.place(self.tiles, self._places)  # which other maps use too
            self._compliance.apply(pressure, displacement)
            return
        ways = (kernels.put_on_rows, pressure), (kernels.take_from_rows, displacement)
        self.transform.apply_compliance(self._level.stiffness, False, *(self._on_rows(*way) for way in ways))

    def _error(self) -> float:
        """Relative error of the pressure, of nodes that overlap without being in contact too."""
        overlap = float(kernels.wrong_gaps_of_tiles(self._gap[:-1], self.contact[:-1])[1])
        if self.count == 0:
            return np.inf if overlap > self._rounding else 0.0
        return max(self._closing().error(), overlap * self._level.inverse.stiffest / float(self.pressure.max()))

    def bound(self) -> float:
        """Bound of the tractions K du that closing the gap by du adds anywhere, over the largest pressure."""
        wrong = float(max(kernels.wrong_gaps_of_tiles(self._gap[:-1], self.contact[:-1])))
        return wrong * self._level.largest_traction / max(float(self.pressure.max()), np.finfo(np.float64).tiny)

    def _zeros(self) -> Reals:
        """Room on the tiles for pressure, gap, and what an iteration moves: memory is taken where it is touched."""
        return np.zeros((4, self.tiles.size + 1, TILE, TILE))

    def _retile(self) -> None:
        """Take pressure and contact to the tiles now marked."""
        tiles, places = listed(self._marks)
        if np.array_equal(tiles, self.tiles):
            return
        before = self._places[tiles]
        pressure, contact = self.pressure[before], self.contact[before]
        self.pressure = self._gap = self._direction = self._moved = pressure  # which frees what they were
        self.tiles, self._places = tiles, places
        self._around = np.empty((tiles.size, 9), dtype=np.int64)
        kernels.surround(tiles, places, *self._level.tiles_each_way, self._level.ends, self._around)
        self.pressure, self._gap, self._direction, self._moved = self._zeros()
        self.contact = np.zeros(self.pressure.shape, dtype=np.bool_)
        self.pressure[:-1], self.contact[:-1] = pressure, contact


@lru_cache(maxsize=16)  # bodies and grids
def _sum_of_influences(stiffness: bytes, shape: tuple[int, ...]) -> float:
    return float(abs(grid.influence(np.frombuffer(stiffness).reshape(shape[0], -1), *shape)).sum())


def listed(marks: Flags) -> tuple[Indices, Indices]:
    """Marked tiles, and the place of each tile among them; of those that are not marked it is their number."""
    tiles = np.flatnonzero(marks)
    places = np.full(marks.size, tiles.size)
    places[tiles] = np.arange(tiles.size)
    return tiles, places


def _flat(values: npt.NDArray[T]) -> npt.NDArray[T]:
    """Values on the listed tiles, without the empty one."""
    return values[:-1].reshape(-1)


_COARSEST = 64  # nodes along the shorter side up to which the first guess is full contact
_SETTLED = 0.03  # relative error of the pressure with which a coarser grid is left


def levels(stiffness: Reals, shape: tuple[int, ...], held: tuple[int, ...]) -> list[TileLevel]:
    """Grids from the given one down, each about half as fine as the one before; punches are `held` in a corner."""
    share = tuple(m / n for m, n in zip(held, shape, strict=True))
    made = [TileLevel.of(stiffness, shape, share)]
    while min(shape) > _COARSEST:
        shape = tuple(TILE * -(-n // (2 * TILE)) for n in shape)
        stiffness = stiffness[grid.wave_indices(shape)]
        made.append(TileLevel.of(stiffness, shape, share))
    return made


def guess(
    grids: list[TileLevel],
    wall: Reals,
    around: float,
    transform: Transform,
    load: float | None,
    start: float,
    gap: Reals,
    finest: bool,
) -> MapContact:
    """Begin a contact on the first grid with what is found on coarser ones.

    `start` is the uniform pressure that the coarsest grid begins with. The wall is flat `around` where it is held. The
    `gap` `[y, x]` is room. On the `finest` grid the pressure of full contact is found on the way.
    """
    contact, (ny, nx) = MapContact(grids[0], wall, transform, load), grids[0].held
    if len(grids) == 1:
        contact.begin(start * (1.0 if load is None else transform.n / (ny * nx)))
        return contact
    coarse = grids[1]
    own = coarse.transform()

    def begin(top: int, rows: Reals) -> None:
        rows[:, nx:] = 0.0
        np.subtract(wall[top : top + len(rows)], around, out=rows[:, :nx])

    stiffness = grids[0].stiffness if finest and not any(grids[0].ends) else None
    contact.full_contact = transform.coarsen(own, grids[0].ends[0], stiffness, begin)
    smooth = own.samples[0, : coarse.held[0], : coarse.held[1]] + around
    before = guess(grids[1:], smooth, around, own, load, start, np.empty(coarse.held), False)
    before.settle(_SETTLED)
    contact.follow(before, gap)
    spent = int(own.n_transforms[0]) + before.coarse_transforms
    contact.coarse_transforms += spent * grid.relative_cost(own.n, transform.n)
    del before, own, smooth  # as this is where memory peaks
    contact.sharpen(gap)
    return contact


_EXACT_ENOUGH = 0.1  # error of the pressure aimed at, over the residual asked for


def tile_newton(batch: Batch, options: Options) -> "TileNewton | None":
    """Begin on maps that tiles cover, without a hardness."""
    takes = batch.interface.hardness is None and fits(batch.shape)
    return TileNewton(batch, options) if takes else None


class TileNewton:
    """Pressures of a batch of maps, each found by guessing its contact, as in `active_set_newton.py`.

    An iteration closes the gap on the tiles that the contact may reach, by an approximate compliance between them
    (`SplitCompliance`), and then finds the exact gap everywhere: two transforms of the map, which leave about a
    hundredth of the error. On too many tiles this gains nothing, and the exact compliance closes the gap. The first
    guess comes from a cascade of coarser grids.

    Until the error of the pressure p is below the residual asked for, `residual` is this error; then the certificate is
    evaluated. The displacement is u = S p + du, where du closes the gaps that are left. Its restoring tractions are
    K u = p + K du, so that K du alone violates the contact conditions. A bound of |K du| costs nothing
    (`MapContact.bound`); only if it is too large, du is transformed.

    Three arrays have the size of the map: the displacement, which is the gap until the certificate needs it, the memory
    of the transform, and the pressure, which takes memory only where it has been touched. Without a period the map is
    the window of the punch, and only the transform is larger.
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
        borne = batch.room_of_pressure
        borne = borne if borne is not None and borne.shape == wall.shape else np.zeros(wall.shape)
        self.load, self._transform, self._pressure = batch.loads, grids[0].transform(rows), borne.reshape(rows, -1)
        self.state = kernels.SurfaceState.of_normal(self.displacement, self._pressure, self.wall, self.load)
        self.certificate = batch.certificate()
        self._bears = self.certificate.bears = np.zeros(rows, dtype=np.bool_)
        if batch.around is not None:
            self.certificate.mean_displacement = np.zeros(rows)
        self._stiffness, self._residual = stiffness, options.residual
        # the certificate of the last iteration is looked at whatever the error
        self._left = np.full(rows, min(options.max_iterations, SOLVERS[options.solver].gives_up_after or np.inf))
        self._contacts: list[MapContact] = []
        for i in range(rows):
            load = None if batch.load is None else float(batch.load[i])
            around = 0.0 if batch.around is None else float(batch.around[i].item())
            start, gap = float(batch.uniform_pressure[i]), self.displacement[i].reshape(held)
            self._contacts.append(guess(grids, wall[i], around, self._transform.row(i), load, start, gap, True))
        if len(grids) > 1 and not any(grids[0].ends):
            self.certificate.full_contact = np.array([contact.full_contact for contact in self._contacts])

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation, those of coarser grids in proportion to their cost."""
        others = np.array([contact.coarse_transforms for contact in self._contacts])
        return np.asarray(self._transform.n_transforms + np.ceil(others).astype(np.int64))

    def advance(self, active: Indices) -> None:
        """Close the gap of each active row as it is known, and find the exact one."""
        for i in active:
            self._contacts[i].settle(_EXACT_ENOUGH * self._residual)
            self._contacts[i].look(self.displacement[i].reshape(self.field.shape))
            self._left[i] -= 1

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions, or the error of a pressure too far off to look at that."""
        return np.array([self._violation(i) for i in active])

    def _violation(self, i: int) -> float:
        contact, (ny, nx) = self._contacts[i], self.field.shape
        if contact.error > self._residual and self._left[i] > 0:
            return contact.error
        gap = self.displacement[i].reshape(ny, nx)
        transform, memory, stiffest = contact.transform, contact.transform.memory[0], float(self._stiffness[0, 0])
        held = 0.0 < stiffest < np.inf
        mean = float(contact.pressure.sum()) / transform.n
        bound = np.inf if self.certificate.rigid_mean is not None else contact.bound()
        kernels.close_map(contact.wall, gap, contact.contact, contact.tiles, memory)
        if self.certificate.mean_displacement is not None:
            added = float(memory[:ny, :nx].sum()) / transform.n
            self.certificate.mean_displacement[i] = contact.approach + added - (mean / stiffest if held else 0.0)
        borne = self._pressure[i].reshape(ny, nx)
        if bound <= self._residual:
            kernels.put_tiles(contact.pressure, contact.tiles, borne, nx)
            self._bears[i] = True
            imbalance = 0.0 if held else abs(mean - float(self.load[i]))
            return self.certificate.bounded(i, self.load, bound, float(contact.pressure.max(initial=0.0)), imbalance)
        transform.apply_stiffness(self._stiffness)
        shift = 0.0 if held else mean  # nothing restores a mean displacement, or it is rigid
        if self.certificate.rigid_mean is not None:  # the mean pressure is the multiplier of a zero mean
            self.load[i] = mean
        largest, total = kernels.tractions_around(memory, ny, nx, transform.shape[1], float(self.load[i]) - shift)
        kernels.restore_map(contact.pressure, contact.tiles, contact.rows, shift, borne)
        look, row = self.certificate, np.array([i])
        look.look(self.state, row, self.field.n)  # in the corner, which is a share of the grid
        look.violation[i] = max(look.violation[i], largest)
        look.imbalance[i] = (self.field.n * look.imbalance[i] + abs(total)) / transform.n
        return float(look.residual(self.load, row)[0])


class Held(NamedTuple):
    """The nodes that the state of a solver has, and their shape (y, x)."""

    n: int
    shape: tuple[int, ...]
