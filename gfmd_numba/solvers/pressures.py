"""Base of the solvers that iterate on the pressure: pressure, gap and certificate of profiles or maps, flat."""

from collections.abc import Callable, Iterable
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.arrays.threads import is_one_piece, team
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
        self.state = kernels.SurfaceState.of_normal(self.displacement, self.field.result, self.wall, self.load)
        self.certificate = batch.certificate()
        self.certificate.limits = kernels.ContactLimits(self.hardness)
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
    """Approximate inverse of the compliance on some nodes."""

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes that about causes the displacement there."""
        ...


class Closing(NamedTuple):
    """The linear problem of the pressure that closes the gap of a row on its `nodes` in contact.

    `apply_compliance` fills the displacement of the iterate under its direction. Under a prescribed load (`free_mean`)
    a change of pressure may not change the load: a multiple of the pressure of a `uniform` displacement is subtracted.
    Gaps within `rounding` are closed. The `room` `[2, node]` is free, and may be longer.
    """

    iterate: kernels.Iterate
    nodes: Indices
    inverse: Inverse
    apply_compliance: Callable[[], None]
    uniform: Reals
    rounding: float
    free_mean: bool
    room: Reals

    @property
    def change(self) -> Reals:
        """Change of the pressure `[node]` that is next, after `error` or after `solve` has reached its tolerance."""
        return self.room[1, : self.nodes.size]

    @property
    def remainder(self) -> Reals:
        """Displacement `[node]` that is left to be closed."""
        return self.room[0, : self.nodes.size]

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
        self._begin()
        last = step = 0.0
        for iteration in range(most):
            energy, error = self._change()
            if not error > tolerance:
                return iteration
            self._direct(step, last)
            last = energy
            self.apply_compliance()
            step = self._update(energy)
            self.open(step)
        return most

    def open(self, step: float) -> None:
        """Add what a step along the direction opens to the gap."""
        gap, opened = self.iterate.gap, self.iterate.st
        team().share(lambda _, a, b: kernels.add_displacement(gap[a:b], opened[a:b], step), gap.size, gap.size)

    def revise(self, contact: Flags, load: float) -> int:
        """Nodes under tension leave the `contact` and lose it, nodes that overlap join; return how many did.

        Under a prescribed load (the sum of all pressures) the nodes in contact fix the approach, which is subtracted
        from the gap, and the nodes that stay carry the pressure of those that left. If all have left, full contact
        begins anew.
        """
        (p, gap, _, _), nodes, rounding, approach = self.iterate, self.nodes, self.rounding, 0.0
        if self.free_mean and nodes.size:
            first = float(gap[nodes[0]])  # as differences: a sum of gaps almost alike would lose digits
            approach = first + self._sum(lambda some: kernels.sum_from(gap, first, nodes[some])) / nodes.size
        found = team().in_pieces(
            lambda some: kernels.revise_contact(p[some], gap[some], contact[some], approach, rounding), p.size
        )
        changed = sum(each for each, _ in found)
        if not self.free_mean or not changed:
            return int(changed)
        total = _added(each for _, each in found)
        if total > 0.0:
            scale = load / total
            team().in_pieces(lambda some: np.multiply(p[some], scale, out=p[some]), p.size)
        else:  # no node kept any: where digits were lost the pressure is no number
            p[:], contact[:] = load / p.size, True
        return int(changed)

    def _sum(self, work: Callable[[slice], float]) -> float:
        """Sum of what some work makes of some nodes after others."""
        return _added(team().in_pieces(work, self.nodes.size))

    def _begin(self) -> None:
        """Fill what is to be closed."""
        gap, r, nodes = self.iterate.gap, self.remainder, self.nodes
        if is_one_piece(nodes.size):
            kernels.close_few(gap, nodes, r, self.free_mean)
            return
        self._take_off(self._sum(lambda some: kernels.closing_displacement(gap, nodes[some], r[some])))

    def _change(self) -> tuple[float, float]:
        """Fill the next change of the pressure; its energy and the relative error that it tells."""
        r, z, uniform, p, nodes, share = self.remainder, self.change, self.uniform, self.iterate.p, self.nodes, 0.0
        self.inverse.solve(r, z)
        if is_one_piece(nodes.size):
            energy, error = kernels.change_few(r, z, uniform[: nodes.size], p, nodes, self.rounding, self.free_mean)
            return float(energy), float(error)
        if self.free_mean:
            totals = team().in_pieces(lambda some: kernels.sums_of(z[some], uniform[some]), nodes.size)
            share = kernels.quotient(*(_added(each) for each in zip(*totals, strict=True)))
        found = team().in_pieces(
            lambda some: kernels.newton_change(r[some], z[some], uniform[some], share, p, nodes[some]), nodes.size
        )
        energies, *largest, moved, carried = zip(*found, strict=True)
        sizes = _added(energies), *(max(each) for each in largest), _added(moved), _added(carried)
        return sizes[0], float(kernels.newton_error(sizes, self.rounding))

    def _direct(self, step: float, last: float) -> None:
        """Make the direction the next change, conjugate to the last one; the energy `last` is zero if there was none.

        Polak and Ribiere's formula, as a preconditioner may not be exactly the same from one iteration to the next.
        """
        z, nodes, t, st = self.change, self.nodes, self.iterate.t, self.iterate.st
        if is_one_piece(nodes.size):
            kernels.direct_few(z, step, last, nodes, self.iterate)
            return
        beta = 0.0
        if last > 0.0:
            beta = -step / last * self._sum(lambda some: kernels.work_done(z[some], st, nodes[some]))
        else:
            team().share(lambda _, a, b: t[a:b].fill(0.0), t.size, t.size)
        team().in_pieces(lambda some: kernels.newton_direction(z[some], beta, nodes[some], t), nodes.size)

    def _update(self, energy: float) -> float:
        """Line search along the direction, of all but the gap; the step."""
        iterate, r, nodes = self.iterate, self.remainder, self.nodes
        if is_one_piece(nodes.size):
            return float(kernels.update_few(iterate, energy, nodes, r, self.free_mean))
        curvature = self._sum(lambda some: kernels.curvature(iterate.t, iterate.st, nodes[some]))
        step = float(kernels.quotient(energy, curvature))
        self._take_off(self._sum(lambda some: kernels.newton_update(iterate, step, nodes[some], r[some])))
        return step

    def _take_off(self, total: float) -> None:
        """Take the mean off what is to be closed, which adds up to a total, if the gap is known up to a constant."""
        if self.free_mean:
            r, mean = self.remainder, total / self.nodes.size
            team().in_pieces(lambda some: kernels.take_off(r[some], mean), r.size)


def _added(values: Iterable[float]) -> float:
    """Sum in this order, and to the same last bit: `sum` keeps more digits from Python 3.12 on."""
    total = 0.0
    for value in values:
        total += value
    return total


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
