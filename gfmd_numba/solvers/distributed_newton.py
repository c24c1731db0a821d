"""Active-set Newton method for a hard wall that meets a map whose rows processes share, by conjugate gradients.

As in `tiles/newton.py` a step closes the gap on the nodes in contact and then revises the contact, and the first guess
comes from coarser grids. Displacements are exact throughout, so that only rows of the map and sums are exchanged.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.arrays.processes import Slab
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.distributed import SlabTransform
from gfmd_numba.solvers.certificate import Certificate
from gfmd_numba.solvers.iteration import HARD_WALL
from gfmd_numba.solvers.status import Status, certified
from gfmd_numba.solvers.table import Options

REACH = 2  # nodes each way whose tractions the preconditioner knows
_FEW = 32  # nodes of the grid that tells these
_COARSEST = 64  # nodes along the shorter side of the coarsest grid, at least half of it
_SETTLED = 0.03  # relative error of the pressure with which a coarser grid is left
_LOOSE, _TIGHTEN, _AHEAD = 0.2, 0.5, 0.1  # errors allowed in the linear problems, as in `tiles/newton.py`
_STEPS, _ITERATIONS = 50, 100  # at most, in one Newton iteration and in one linear problem
_ATTEMPTS = 3  # to reach the residual, each by a smaller error of the pressure
_EXACT_ENOUGH = 0.1  # error of the pressure aimed at, over the residual asked for

Stiffness = Callable[[Reals], Reals]  # of waves of some numbers


@dataclass(frozen=True)
class SlabEquilibrium:
    """Displacement and pressure `[row, x]` of the rows of this process, and how all were reached."""

    displacement: Reals
    pressure: Reals
    status: Status
    residual: float
    n_iterations: int
    n_transforms: int


def halvings(ny: int, nx: int, processes: int) -> int:
    """How often a grid is halved for a first guess, so that each process keeps rows enough."""
    found = 0
    while min(ny, nx) > _COARSEST and ny % 2 == nx % 2 == 0 and ny // 2 >= 2 * REACH * processes:
        ny, nx, found = ny // 2, nx // 2, found + 1
    return found


class SlabNewton:
    """Pressure on the nodes in contact of a slab `[node]`, and the gap `[row, x]` that it leaves."""

    def __init__(self, slab: Slab, wall: Reals, stiffness: Stiffness, load: float, coarser: int) -> None:
        self.slab, self.wall, self._load = slab, wall, load
        self.field = SlabTransform(slab, wall.shape[1], lambda q: _without_mean(stiffness, q))
        few = _without_mean(stiffness, grid.magnitudes((_FEW, _FEW)) * (wall.shape[1] / _FEW))
        near = np.roll(grid.influence(few, _FEW, _FEW), (REACH, REACH), (0, 1))
        self._stencil = np.ascontiguousarray(near[: 2 * REACH + 1, : 2 * REACH + 1])
        self._total = load * wall.shape[1] * slab.bounds[-1]
        low, high = slab.largest(-float(wall.min()), float(wall.max()))
        self._rounding = np.finfo(np.float64).eps * (low + high)
        self.iterations, self._spent = 0, 0.0
        self._with_edges = np.full((slab.rows + 2 * REACH, wall.shape[1]), load)
        self._map, self._gap = self._with_edges[REACH:-REACH], np.empty(wall.shape)
        if coarser > 0:
            self._guess(stiffness, coarser)
        self._contact = self._map > 0.0
        self._list()

    @property
    def n_transforms(self) -> float:
        """Transforms made so far, those of coarser grids in proportion to their cost."""
        return self.field.transforms + self._spent

    def _guess(self, stiffness: Stiffness, coarser: int) -> None:
        """Begin with the pressure that meets means of 2 x 2 nodes."""
        rows, nx = self.wall.shape
        means = self.wall.reshape(rows // 2, 2, nx // 2, 2).mean(axis=(1, 3))
        coarse = SlabNewton(self.slab.halved, means, stiffness, self._load, coarser - 1)
        coarse.settle(_SETTLED, _STEPS * _ITERATIONS)
        self._map.reshape(rows // 2, 2, nx // 2, 2)[:] = coarse.pressed()[:, np.newaxis, :, np.newaxis]
        self._spent = coarse.n_transforms * grid.relative_cost(means.size, self.wall.size)

    @property
    def displacement(self) -> Reals:
        """Displacement `[row, x]`, once the `violation` is known."""
        return self._gap

    @property
    def pressure(self) -> Reals:
        """Pressure of the wall `[row, x]`, once the `violation` is known."""
        return self._map

    def settle(self, target: float, most: int) -> None:
        """Solve for pressure and contact down to a relative error, in so many conjugate gradients at most."""
        tolerance = _LOOSE
        self._open()
        for _ in range(_STEPS):
            before = self.iterations
            self._close(tolerance, most)
            changed, count = self._revise()
            if changed:
                self._open()
            if self.iterations >= most or (tolerance <= target and (not changed or self.iterations == before)):
                return
            tolerance = max(target, min(_TIGHTEN * tolerance, _AHEAD * changed / count))

    def pressed(self) -> Reals:
        """Pressure `[row, x]` of the slab, in memory that the next step overwrites."""
        self._map.fill(0.0)
        self._map.reshape(-1)[self._nodes] = self._pressure
        return self._map

    def violation(self, certificate: Certificate) -> float:
        """Relative violation of the contact conditions, as `PressureIterate.residual` has it.

        The `displacement` takes the place of the gap.
        """
        u, ku, active = self._gap, self._map, np.zeros(1, dtype=np.int64)
        u_flat, ku_flat, wall = (each.reshape(1, -1) for each in (u, self.pressed(), self.wall))
        kernels.close_gap(ku_flat, u_flat, wall, active, u.size, u_flat)
        ku[:] = u
        self.field.apply_stiffness(ku)
        state = kernels.SurfaceState.of_normal(u_flat, ku_flat, wall, np.array([self._load]))
        certificate.look(state, active, u.size)
        tractions = self._load - ku.mean(axis=1)
        kernels.wall_pressure(state, np.inf, active, u.size)
        unbalanced = self.slab.total(tractions - ku.mean(axis=1)) / self.slab.bounds[-1]
        certificate.violation[0], certificate.peak[0] = self.slab.largest(certificate.violation[0], certificate.peak[0])
        certificate.imbalance[0] = abs(unbalanced)
        return float(certificate.residual(state.load, active)[0])

    def _list(self) -> None:
        """List the nodes in contact, with the pressure on the map."""
        self._nodes = np.flatnonzero(self._contact)
        self._row_of = self._nodes // self.wall.shape[1]
        self._pressure = self._map.reshape(-1)[self._nodes]

    def _sums(self, *values: Reals) -> Reals:
        """Sums over all nodes in contact of values on them."""
        rows = self.slab.rows
        return self.slab.total(np.stack([np.bincount(self._row_of, each, rows) for each in values], axis=1))

    def _open(self) -> None:
        """Find the gap, up to the approach."""
        self._gap[:] = self.pressed()
        self.field.apply_compliance(self._gap)
        self._gap += self.wall

    def _displaced(self, pressure: Reals) -> Reals:
        """Displacement on the nodes in contact that a pressure there causes."""
        self._map.fill(0.0)
        self._map.reshape(-1)[self._nodes] = pressure
        self.field.apply_compliance(self._map)
        return self._map.reshape(-1)[self._nodes]

    def _near(self, displacement: Reals, found: Reals) -> None:
        """Fill the tractions of near neighbours that restore a displacement on the nodes in contact."""
        self._map.fill(0.0)
        self._map.reshape(-1)[self._nodes] = displacement
        self.slab.fill_edges(self._with_edges, REACH)
        kernels.near_tractions(self._stencil, self._with_edges, self._nodes, found)

    def _close(self, tolerance: float, most: int) -> None:
        """Close the gap on the nodes in contact by preconditioned conjugate gradients, down to a relative error."""
        r, z = -self._gap.reshape(-1)[self._nodes], np.empty(self._nodes.size)
        ones = np.ones(self._nodes.size)
        direction = displaced = np.zeros(self._nodes.size)
        missing, count = self._sums(r, ones)
        r -= missing / count
        last = step = moved = 0.0
        for _ in range(_ITERATIONS):
            self._near(r, z)
            total, energy, conjugate = self._sums(z, r * z, z * displaced)
            z -= total / count
            change, peak = self.slab.largest(float(abs(z).max(initial=0.0)), float(self._pressure.max(initial=0.0)))
            if not (energy > 0.0 and change > tolerance * peak) or self.iterations >= most:
                return
            share = (total / count * moved - conjugate) * step / last if last > 0.0 else 0.0
            direction = z + share * direction
            displaced = self._displaced(direction)
            curvature, moved = self._sums(direction * displaced, displaced)
            step, last = energy / curvature, energy
            self._pressure += step * direction
            r -= step * (displaced - moved / count)
            self.iterations += 1

    def _revise(self) -> tuple[int, float]:
        """Nodes under tension leave the contact and lose it, nodes that overlap join; how many of all did.

        The gap is that of the pressure, less the approach that the nodes in contact fix.
        """
        self._open()
        missing, count = self._sums(self._gap.reshape(-1)[self._nodes], np.ones(self._nodes.size))
        self._gap -= missing / count
        joining = (self._gap < -self._rounding) & ~self._contact
        leaving = self._pressure <= 0.0
        changed = int(sum(self.slab.communicator.allgather(np.count_nonzero(joining) + np.count_nonzero(leaving))))
        if changed:
            self._pressure[leaving] = 0.0
            self._contact.reshape(-1)[self._nodes[leaving]] = False
            self.pressed()
            self._contact |= joining
            self._list()
            self._pressure *= self._total / self._sums(self._pressure)[0]
        return changed, count


def _without_mean(stiffness: Stiffness, q: Reals) -> Reals:
    """Stiffness of waves, 0 for the mean, which the load holds."""
    found = stiffness(q)
    found[q == 0.0] = 0.0
    return found


def press_slab(slab: Slab, wall: Reals, stiffness: Stiffness, load: float, options: Options) -> SlabEquilibrium:
    """Press an elastic body against the rows `[row, x]` of a wall that this process has, as `equilibrate` does."""
    coarser = halvings(slab.bounds[-1], wall.shape[1], slab.communicator.size)
    contact, certificate = SlabNewton(slab, wall, stiffness, load, coarser), Certificate(1, HARD_WALL.limits)
    target, most, residual = _EXACT_ENOUGH * options.residual, options.max_iterations, np.inf
    for _ in range(_ATTEMPTS):
        contact.settle(target, most)
        residual, target = contact.violation(certificate), _EXACT_ENOUGH * target
        if residual <= options.residual or contact.iterations >= most:
            break
    otherwise = Status.steps_used_up if contact.iterations >= most else Status.stagnated
    status = Status(int(certified(residual, options.residual, otherwise)))
    made = contact.iterations, int(np.ceil(contact.n_transforms))
    return SlabEquilibrium(contact.displacement, contact.pressure, status, residual, *made)
