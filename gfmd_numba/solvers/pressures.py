"""What the solvers that iterate on the pressure share: pressure, gap and certificate of profiles or maps, flat."""

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.arrays.threads import team
from gfmd_numba.fourier.grid import relative_cost
from gfmd_numba.fourier.transform import Transform, aligned_rows
from gfmd_numba.solvers.iteration import Batch


class PressureIterate:
    """Pressure of a batch, the gap it leaves and the certificate of both; the pressure begins uniform.

    Where the displacement of the punch is prescribed, the stiffness at q = 0 may be infinite (an incompressible slab).
    """

    def __init__(self, batch: Batch) -> None:
        rows, shape = len(batch.punch), batch.punch.shape[1:]
        punch, stiffness = batch.punch.reshape(rows, -1), batch.response.normal.ravel()
        self.free_mean = batch.load is not None
        self.field = Transform(rows, *shape, sources=3)
        n = self.field.n
        self.pressure, self.direction, self.displacement = self.field.sources
        self.wall = aligned_rows(rows, n)
        self.wall[:, :n] = punch
        self.load, start = batch.loads, batch.uniform_pressure
        self.hardness = np.inf if batch.interface.hardness is None else batch.interface.hardness
        # between its bounds, where every node is free to move
        if batch.load is None:
            start = np.minimum(start, 0.5 * self.hardness)
        self.pressure[:, :n] = start[:, np.newaxis]
        compliance = np.divide(1.0, stiffness, out=np.zeros_like(stiffness), where=stiffness != 0.0)
        self.compliance = self.field.symbol(compliance)
        self._stiffness = self.field.symbol(np.where(np.isfinite(stiffness), stiffness, 0.0))
        self.gap = aligned_rows(rows, n)
        self.iterate = kernels.Iterate(self.pressure, self.gap, self.direction, self.field.result)
        self.rows = [kernels.Iterate(*row) for row in zip(*self.iterate, strict=True)]
        self.state = kernels.State.of_normal(self.displacement, self.field.result, self.wall, self.load)
        self.certificate = batch.certificate()
        self.certificate.conditions = kernels.Conditions(self.hardness)
        self.rounding = np.finfo(np.float64).eps * np.ptp(punch, axis=1)
        self.elsewhere: Reals = np.zeros(rows)  # transforms on other grids, in those of this one

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation, those of coarser grids in proportion to their cost."""
        return self.field.n_transforms + np.ceil(self.elsewhere).astype(np.int64)

    def begin_at(self, coarse: "PressureIterate") -> None:
        """Begin with the pressure that was found on a coarser grid."""
        n, m, nx = self.field.n, coarse.field.n, self.field.shape[-1]
        for fine, p in zip(self.pressure, coarse.pressure, strict=True):
            refine(p[:m].reshape(-1, coarse.field.shape[-1]), fine[:n].reshape(-1, nx))
        self.elsewhere[:] = coarse.n_transforms * relative_cost(m, n)

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions by the nearest displacement that penetrates plastic nodes alone.

        Leaves it and its restoring traction in the state; costs two transforms a row.
        """
        field, n = self.field, self.field.n
        kernels.close_gap(self.pressure, self.gap, self.wall, active, n, self.displacement, self.hardness)
        field.apply(self._stiffness, active, source=2)
        if self.certificate.rigid_mean is not None:  # the mean pressure is the multiplier of a zero mean
            self.load[active] = self.pressure[active, :n].mean(axis=1)
        return self.certificate.look(self.state, active, n)


UPHILL_FROM_THE_START = 2  # of what `kernels.line_search` returns


class LastPressure:
    """Pressures between two bounds and their gaps `[realisation, x]`, up to the approach, as they last were."""

    def __init__(self, pressure: Reals) -> None:
        self.pressure, self.gap = np.zeros((2, *pressure.shape))
        self._known = np.zeros(len(pressure), dtype=np.bool_)

    def line_search(self, i: int, pressure: Reals, gap: Reals, n: int) -> int:
        """What `kernels.line_search` does and returns for row i; 0 for its first pressure."""
        if self._known[i]:
            return int(kernels.line_search(pressure, gap, self.pressure[i], self.gap[i], n))
        self.remember(i, pressure, gap)
        return 0

    def remember(self, i: int, pressure: Reals, gap: Reals) -> None:
        """Make a pressure the last one of row i."""
        self.pressure[i], self.gap[i], self._known[i] = pressure, gap, True


class Inverse(Protocol):
    """What is close to the inverse of the compliance on some nodes."""

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes that about causes the displacement there."""
        ...


class Closing(NamedTuple):
    """The linear problem of the pressure that closes the gap of a row on its `nodes` in contact.

    `soften` fills the displacement of the iterate under its direction. Under a prescribed load (`free_mean`) a change
    of pressure loses what changes the load, by means of the pressure that a `uniform` displacement takes. Gaps within
    `rounding` are closed. The `room` `[2, node]` is free, and may be longer.
    """

    iterate: kernels.Iterate
    nodes: Indices
    inverse: Inverse
    soften: Callable[[], None]
    uniform: Reals
    rounding: float
    free_mean: bool
    room: Reals

    @property
    def change(self) -> Reals:
        """Change of the pressure `[node]` that is next, after `error` or after `solve` has reached its tolerance."""
        return self.room[1, : self.nodes.size]

    @property
    def changed(self) -> Reals:
        """Pressure `[node]` after that change, in the part of the room that no error is kept in."""
        changed = self.room[0, : self.nodes.size]
        np.take(self.iterate.p, self.nodes, out=changed, mode="clip")  # which is not buffered, as no index is out
        changed += self.change
        return changed

    def error(self) -> float:
        """Relative error of the pressure."""
        self._begin()
        return self._change()[1]

    def solve(self, tolerance: float, most: int) -> int:
        """Go on by preconditioned conjugate gradients until the error is that small; how many, at most `most`."""
        iterate, nodes, count, (r, z) = self.iterate, self.nodes, self.nodes.size, self.room
        self._begin()
        last = step = 0.0
        for iteration in range(most):
            energy, error = self._change()
            if not error > tolerance:
                return iteration
            kernels.newton_direction(z, step, last, nodes, count, iterate)
            last = energy
            self.soften()
            step = kernels.newton_update(iterate, energy, nodes, count, r, self.free_mean)
            self.open(step)
        return most

    def open(self, step: float) -> None:
        """Add what a step along the direction opens to the gap."""
        gap, opened = self.iterate.gap, self.iterate.st
        team().share(lambda _, a, b: kernels.add_displacement(gap[a:b], opened[a:b], step), gap.size, gap.size)

    def _begin(self) -> None:
        kernels.closing_displacement(self.iterate.gap, self.nodes, self.nodes.size, self.room[0], self.free_mean)

    def _change(self) -> tuple[float, float]:
        """Fill the next change of the pressure; its energy and the relative error that it tells."""
        r, z = self.room
        self.inverse.solve(r, z)
        energy, error = kernels.newton_error(
            r, z, self.uniform, self.iterate.p, self.nodes, self.nodes.size, self.rounding, self.free_mean
        )
        return float(energy), float(error)


def between(coarse: tuple[int, ...], fine: tuple[int, ...]) -> list[tuple[Indices, Reals]]:
    """Node of a coarse grid before each one of a finer grid, and the share of the way to the next, along each axis."""
    places = (np.divmod(np.arange(n) * m, n) for n, m in zip(fine, coarse, strict=True))
    return [(first, rest / n) for (first, rest), n in zip(places, fine, strict=True)]


def refine(pressure: Reals, fine: Reals) -> None:
    """Fill a finer grid with a periodic pressure `[y, x]`, linearly; a profile is a map of one row.

    Of nodes next to the contact, which interpolation would load too, those nearer to a contact node keep their load.
    """
    (above, down), (left, right) = between(pressure.shape, fine.shape)

    def some(part: slice) -> None:
        kernels.refine_pressure(pressure, above[part], down[part], left, right, fine[part])

    team().by_rows(some, fine.shape)
