"""Truncated Newton method on the energy of a contact under a law, with or without the hard wall."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.elasticity.spectral_response import SpectralResponse, diagonal
from gfmd_numba.fourier import grid
from gfmd_numba.interface import vector_slip
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.normal_law import NormalLaw
from gfmd_numba.interface.patterned import PatternedLaw
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.solvers.certificate import Certificate, RigidMean
from gfmd_numba.solvers.iteration import Batch, Start, tangential_shape
from gfmd_numba.solvers.parallel_law import ParallelLaw
from gfmd_numba.solvers.pressures import refine
from gfmd_numba.solvers.products import Products
from gfmd_numba.solvers.table import Options

_ACROSS = 4.0  # lengths of a law of gap and slip across which it acts
_STRIDE = 0.5  # tangential lengths of the law that a node is dragged in one step at most
_NOTHING = ExponentialLaw(0.0, 1.0)  # stands for no law: a hard wall alone

Place = Callable[[], tuple[Reals, Reals]]  # gap and slip, where they are needed


class EnergyOfGap:
    """A law of the gap alone.

    `reach` is the largest closing of gaps in a step: a longer stride might pass the barrier of energy that keeps
    surfaces apart; 0 where nothing attracts. Gaps are `[node]`, slips of the punch over the body `[component, node]`.
    """

    def __init__(self, law: NormalLaw) -> None:
        self._law = law
        self.reach = law.reach
        self.normal_traction = law.traction

    def fill_traction(self, gap: Reals, slip: Reals, traction: Reals) -> None:
        """Fill the tractions that drag and pull the body."""
        traction[-1] = self._law.traction(gap)

    def fill_curvature(self, gap: Reals, slip: Reals, curvature: Reals) -> None:
        """Fill the curvature of the energy by each displacement alone."""
        curvature[-1] = self._law.stiffness(gap)

    def add_coupling(self, moved: Reals, restoring: Reals) -> float:
        """Add how the law couples the components of a node; return twice the energy of the coupling."""
        return 0.0

    def change(self, gap: Reals, slip: Reals, closing: Reals) -> float:
        """Change of the energy as all displacements change by `closing`."""
        return float(self._law.energy_change(gap, closing[-1]).sum(dtype=np.float64))

    def shorten(self, place: Place, u: Reals, trial: Reals) -> bool:
        """Shorten how far displacements change at once, up to a trial; whether any is."""
        return False


class EnergyOfSlip:
    """A law of gap and slip, with the methods of `EnergyOfGap`."""

    def __init__(self, law: XuNeedlemanLaw) -> None:
        self._law, self.reach = law, law.normal
        self._together: list[tuple[int, int, Reals]] = []

    def normal_traction(self, gap: Reals) -> Reals:
        """Traction that pulls the body towards the punch where nothing has slipped."""
        return self._law.normal_traction(gap, np.zeros(gap.shape[-1]))

    def fill_traction(self, gap: Reals, slip: Reals, traction: Reals) -> None:
        """Fill the tractions that drag and pull the body."""
        traction[-1] = self._law.normal_traction(gap, vector_slip.length(slip))
        traction[:-1] = vector_slip.tangential_traction(self._law, gap, slip)

    def fill_curvature(self, gap: Reals, slip: Reals, curvature: Reals) -> None:
        """Fill the curvature of the energy by each displacement alone."""
        pairs = [(a, b) for a in range(len(curvature)) for b in range(a + 1)]
        self._together = []
        for (a, b), k in zip(pairs, self._law.stiffness(gap, slip), strict=True):
            if a == b:
                curvature[a] = k
            else:
                self._together.append((a, b, k))

    def add_coupling(self, moved: Reals, restoring: Reals) -> float:
        """Add how the law couples the components of a node; return twice the energy of the coupling."""
        pulled: dict[int, Reals] = {}
        energies = []
        for a, b, k in self._together:
            forces = {a: k * moved[b], b: k * moved[a]}
            energies.append(forces[a] * moved[a])
            for component, force in forces.items():
                pulled[component] = pulled[component] + force if component in pulled else force
        for component, force in pulled.items():
            restoring[component] += force
        return 2.0 * float(np.sum(reduce(np.add, energies)))

    def change(self, gap: Reals, slip: Reals, closing: Reals) -> float:
        """Change of the energy as all displacements change by `closing`."""
        change = self._law.energy_change(gap, slip, closing[-1], closing[:-1])
        return float(change.sum(dtype=np.float64))

    def shorten(self, place: Place, u: Reals, trial: Reals) -> bool:
        """Shorten how far displacements change at once, up to a trial; past a stride in slip the law gives way."""
        gap, slip = place()
        tangential, dragged = self._law.tangential, vector_slip.length(trial[:-1] - u[:-1])
        allowed = np.maximum(vector_slip.length(slip) - _ACROSS * tangential, _STRIDE * tangential)
        far = (dragged > allowed) & (gap < _ACROSS * self._law.normal)
        trial[:-1, far] = u[:-1, far] + (trial[:-1, far] - u[:-1, far]) * (allowed[far] / dragged[far])
        return bool(far.any())


_LOOSE = 0.3  # largest part of the unbalanced traction that a Newton step may leave: the less, the smaller that is
_ENOUGH = 0.7  # unbalanced traction that it leaves at least, over what the residual that is asked for allows
_NEAR = 8.0  # times that: so near the end a step goes on, as it takes less than to begin another one
_INNER_ITERATIONS = 60  # of conjugate gradients in a Newton step
_CANCELLED = 1e-6  # restoring traction over the largest that went into its sum, below which it has lost too many digits
_FLAT = 1e-6  # curvature over that of the body alone below which a direction is one of a fold, or downhill for ever
_LONGEST = 8.0  # step along such a direction over that in which the body alone would come to rest
_SUFFICIENT = 1e-4  # least decrease of the energy over what its slope promises (Armijo)
_ROUNDING = 1e-14  # of a change of energy, over the sum of its parts, in double precision
_FAR = 3.0  # ranges of an attraction beyond which a gap closes freely, and below which by one range a step
_HELD = 10.0  # stiffness that holds a mean over the largest of the body, where no law softens
_SHORTEST = 1e-12  # step along a Newton direction that is tried before the gradient takes its place
_COARSEST = {1: math.inf, 2: 64}  # nodes along the shorter side up to which bodies begin at rest: on profiles all
_SETTLED = 1e-2  # residual with which a coarser grid is left
_COARSE_STEPS = 60  # Newton steps there, at most


@dataclass(frozen=True)
class HeldMean:
    """The condition that the mean displacement vanishes, and the stiffness that holds it, in E*/L_x.

    The mean pressure then takes over, as the condition's multiplier (Hestenes, J. Optim. Theory Appl. 4:303, 1969).

    If the stiffness were below the softening of the law over a single node, a contact would jump open and shut again as
    the mean pressure follows.
    """

    condition: RigidMean
    stiffness: float

    @classmethod
    def of(cls, batch: Batch) -> "HeldMean | None":
        """Return what holds the mean of a batch, None where the mean is free; only a hard wall may leave it no room."""
        condition = RigidMean.of(batch.punch, batch.response)
        if condition is None:
            return None
        if not batch.interface.hard_wall:
            condition = replace(condition, impossible=np.zeros_like(condition.impossible))
        softening = batch.interface.softening * batch.punch[0].size
        return cls(condition, _HELD * condition.stiffest + softening)

    def pressure(self, displacement: Reals) -> float:
        """Mean pressure, in E*, that holds a displacement `[node]` in place of that stiffness."""
        return -self.stiffness * float(displacement.mean())


def unless_hardness_alone(batch: Batch, options: Options) -> "TruncatedNewton | None":
    """Begin, unless under a hardness without a law, whose energy has many kinks and hardly any curvature."""
    alone = batch.interface.hardness is not None and batch.interface.normal_law is None
    return None if alone else TruncatedNewton(batch, options)


def under_a_law(batch: Batch, options: Options) -> "TruncatedNewton | None":
    """Begin where a law of the gap acts."""
    return None if batch.interface.normal_law is None else TruncatedNewton(batch, options)


class TruncatedNewton:
    """Displacements of a batch that descend its energy, elastic, of the law and of the load.

    The unknowns of a realisation are the normal displacement, under a law of gap and slip after the tangential ones.
    Each Newton step holds the nodes that press against the wall and frees the others, solves the linear problem that is
    left by preconditioned conjugate gradients (Steihaug, SIAM J. Numer. Anal. 20:626, 1983) up to a direction in which
    the energy curves down, stops nodes at the wall, and is cut short until the energy has decreased. So the energy
    never rises, and a contact on a stable branch stays on it. The preconditioner is body and law of each
    component in parallel, on ever coarser grids, which takes no transforms.

    A mean displacement that has to vanish is held by a large stiffness, and the mean pressure then takes over.

    A map at rest under a load begins with the equilibrium on a grid half as fine, and so on down. A later step of a
    path begins with the state that the last step has left, which is on the branch to follow.

    Under a hardness penetration adds the hardness times its depth to the energy, which has a kink where a node touches
    the wall. So each Newton step leaves every node on its side of the wall. Nodes yield that penetrate, or press on the
    wall by more than the hardness: the hardness pushes them back, and they stop at the wall from behind. The other
    nodes stop at the wall from before. A node at the wall that presses by less than the hardness is held. The law of a
    node that yields acts as at gap 0.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options) -> None:
        interface, (rows, *shape) = batch.interface, batch.punch.shape
        batch, self._coarse_transforms = _on_coarser_grids(batch, options)
        self._held_mean = held = HeldMean.of(batch)
        response = batch.response if held is None else batch.response.with_mean(held.stiffness)
        self.certificate = Certificate(rows, interface.limits, None if held is None else held.condition)
        of_gap, self._target = EnergyOfGap(interface.normal_law or _NOTHING), options.residual
        self._law = of_gap if interface.cohesive is None else EnergyOfSlip(interface.cohesive)
        self._products = products = Products(response, rows, tuple(shape))
        self.field, n = products.field, products.field.n
        self._source, self._result = products.displacement.reshape(rows, -1), products.restoring.reshape(rows, -1)
        self._prepare(response, batch.law_stiffness())
        self._load, self._elastic, self._restoring, self._wall, self._u = np.zeros((5, *self._source.shape))
        self._wall[:] = np.inf
        load = batch.loads.copy()
        u, wall, restoring = (self._components(each) for each in (self._u, self._wall, self._restoring))
        self._place(batch, u, wall[:, -1, :n])
        self._components(self._load)[:, -1, :n] = load[:, np.newaxis]
        np.minimum(self._u, self._wall, out=self._u)
        self._yields = None if interface.hardness is None else np.zeros((rows, n), dtype=np.bool_)
        self._ceiling = self._wall if self._yields is None else self._wall.copy()
        self._bound = self._ceiling.copy() if self._law.reach > 0.0 else self._ceiling
        # where neither the load nor a wall says where the punch is, a large mean displacement would cost digits
        self._floats, self._level = batch.load is not None and not interface.hard_wall, np.zeros(rows)
        anchor = np.full_like(u[:, :-1], np.nan)
        found = u.copy() if self._floats else u
        self.state = kernels.SurfaceState(found, restoring, np.ascontiguousarray(wall[:, -1]), load, anchor)
        self._strongest, self._residual = np.zeros(rows), np.ones(rows)
        self._drifts, self._is_summed = np.zeros((2, rows), dtype=np.bool_)
        self._largest_summed = np.zeros(rows)  # restoring traction since one was made anew
        rooms = np.zeros((7, self._u.shape[1]))
        self._curvature, self._weight, self._unbalanced, self._direction, self._lifted, self._conjugate = rooms[:6]
        self._closing: Reals = rooms[6]
        for row in np.arange(rows).reshape(-1, 1):
            self._source[row[0]] = self._u[row[0]]
            products.restore(row)
            self._accept(row[0])

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation, those of coarser grids in proportion to their cost."""
        return self._products.n_transforms + self._coarse_transforms

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions `[active]`, two transforms where it is small enough.

        It is measured by the largest pressure of the wall or traction of the law, whichever is larger. A restoring
        traction that was summed up over steps is made anew before it counts.
        """
        look, n = self.certificate, self.field.n
        found = look.look(self.state, active, n, self._strongest[active])
        for row in active[(found <= self._target) & self._is_summed[active]].reshape(-1, 1):
            i = row[0]
            self._source[i], self._is_summed[i] = self._u[i], False
            self._products.restore(row)
            self._restoring[i] += self._result[i] - self._elastic[i]
            self._elastic[i], self._largest_summed[i] = self._result[i], _largest(self._result[i])
            found[active == i] = look.look(self.state, row, n, self._strongest[row])
        if look.rigid_mean is not None:
            drift = look.rigid_mean.violation(self.state.u[:, -1], active, n)
            self._drifts[active] = (drift >= look.violation[active]) | (look.drift[active] >= found)
        self._residual[active] = found
        return found

    def advance(self, active: Indices) -> None:
        """Make one Newton step in the active rows."""
        for row in active.reshape(-1, 1):
            if self._drifts[row[0]]:
                self._shift_load(row[0])
            bends_down = self._find_direction(row)
            self._descend(row, bends_down)

    def _prepare(self, response: SpectralResponse, of_law: float) -> None:
        """Prepare the preconditioner, and how stiff a mode may be."""
        self._stiffest = float(response.diagonal.sum(axis=0).max()) + of_law  # or more: it is the trace of each wave
        self._parallel = ParallelLaw(diagonal(response.restored().inverse()), self.field.shape)

    def _place(self, batch: Batch, u: Reals, wall: Reals) -> None:
        """Fill the displacements that a batch begins with and its wall."""
        (rows, along, _), n, shape = u[:, :-1].shape, self.field.n, batch.punch.shape[1:]
        dragged = batch.start.tangential[:, :along] + batch.start.dragged  # a slip of the step's own would end bonds
        u[:, :-1, :n] = dragged.reshape(rows, along, n)
        sliding = np.broadcast_to(batch.sliding, (along, *shape)) if along else np.empty((0, n))
        self._sliding = np.ascontiguousarray(sliding.reshape(along, n))
        u[:, -1, :n] = starting_displacement(batch, self._law.normal_traction)
        if batch.interface.hard_wall:
            wall[:] = batch.punch.reshape(rows, n)
        self._punch = wall if batch.interface.hard_wall else batch.punch.reshape(rows, n).copy()

    def _components(self, unknowns: Reals) -> Reals:
        """Return unknowns `[..., component padded]` by component, to be read or written."""
        return unknowns.reshape(*unknowns.shape[:-1], self._products.components, -1)

    def _nodes(self, unknowns: Reals) -> Reals:
        """Return the unknowns of one row by `[component, node]`, to be read or written."""
        return self._components(unknowns)[:, : self.field.n]

    def _gap(self, i: int) -> Reals:
        gap = np.asarray(self._punch[i] - self._nodes(self._u[i])[-1])
        return gap if self._yields is None else np.maximum(gap, 0.0)

    def _slip(self, i: int) -> Reals:
        return np.asarray(self._sliding - self._nodes(self._u[i])[:-1])

    def _fill_curvature(self, i: int) -> None:
        """Fill the curvature of the law's energy for each unknown of a row alone."""
        curvature = self._nodes(self._curvature)
        self._law.fill_curvature(self._gap(i), self._slip(i), curvature)
        if self._yields is not None:
            curvature[-1, self._yields[i]] = 0.0

    def _change(self, i: int) -> float:
        """Change of the law's energy as a row moves; it goes on as its tangent at gap 0 where nodes penetrate."""
        closing, gap, along_tangent = self._nodes(self._closing), self._gap(i), 0.0
        if self._yields is not None:
            yields = self._yields[i]
            along_tangent = float(self._law.normal_traction(np.zeros(1))[0] * closing[-1, yields].sum())
            closing = np.where(yields, 0.0, closing)
        return self._law.change(gap, self._slip(i), closing) - along_tangent

    def _shift_load(self, i: int) -> None:
        """Let the mean pressure of a row take over what held its mean displacement."""
        if self._held_mean is not None:
            load = self.state.load
            load[i] += self._held_mean.pressure(self.state.u[i, -1, : self.field.n])
            self._nodes(self._load[i])[-1] = load[i] - self._borne(i)

    def _borne(self, i: int) -> Reals | float:
        """Pressure with which the hardness pushes back nodes that yield."""
        return 0.0 if self._yields is None else self.certificate.limits.hardness * self._yields[i]

    def _find_direction(self, row: Indices) -> bool:
        """Fill the direction of a row's Newton step; returns whether the energy curves down somewhere along it."""
        i, curvature, weight, r = row[0], self._curvature, self._weight, self._unbalanced
        p, source, result, pulled = self._conjugate, self._source[i], self._result[i], self._closing
        descent, of_nodes = kernels.Descent(self._direction, self._lifted, r), self._nodes(weight)
        self._fill_curvature(i)
        unknowns = kernels.Unknowns(self._u[i], self._restoring[i], self._ceiling[i], self._load[i])
        kernels.descent_start(unknowns, weight, descent)
        self._parallel.factor(self._nodes(curvature), of_nodes, self._nodes(pulled))
        p[:] = 0.0
        square, last, gains = min(_LOOSE**2, float(self._residual[i])), np.inf, []
        # where a mean is held, the load that holds it is off, too, and what is left here does not tell by how much
        allowed = self._target if self._held_mean is None else 0.0
        enough = _ENOUGH * allowed * max(float(self.certificate.peak[i]), float(self._strongest[i]))
        for _ in range(_INNER_ITERATIONS):
            self._parallel.solve(of_nodes, self._nodes(r), self._nodes(result))
            norm = kernels.descent_norm(r, weight, result)
            if not norm > 0.0:
                break
            kernels.descent_direction(result, norm / last, p, source)
            last = norm
            self._products.restore(row)
            curve, elastic = kernels.descent_curvature(p, result, curvature, pulled)
            curve += self._law.add_coupling(self._nodes(p), self._nodes(pulled))
            if not curve > _FLAT * elastic:
                kernels.descent_update(p, result, pulled, weight, last / max(elastic, _FLAT * last), descent)
                return True
            left = kernels.descent_update(p, result, pulled, weight, last / curve, descent)
            gains.append(last * last / curve)
            if not gains[-1] > 0.0:  # which is too small a number
                break
            falls = min(gains[-1] / gains[-2], 1.0) if gains[1:] else 1.0
            loose = falls * gains[-1] <= square * sum(gains)  # of what the next iteration would gain
            if left <= enough or (loose and not left < _NEAR * enough):
                break
        return False

    def _descend(self, row: Indices, bends_down: bool) -> None:
        """Go along the direction of a row, as far as the energy decreases."""
        i, step = row[0], 1.0
        change, slope = self._trial(row, step)
        while not _decreases(change, slope):
            step *= _shorter(change, slope)
            if step < _SHORTEST:
                self._direction[:] = (self._load[i] - self._restoring[i]) / self._stiffest
                change, slope = self._trial(row, 1.0, knows=False)
                if _decreases(change, slope):
                    self._accept(i)
                return
            change, slope = self._trial(row, step)
        self._accept(i)
        while bends_down and 1.0 <= step < _LONGEST and _decreases(*self._trial(row, step)):
            self._accept(i)
            step *= 2.0

    def _trial(self, row: Indices, step: float, knows: bool = True) -> tuple[float, float]:
        """Change of a row's energy by a step, and what its slope promises.

        Two transforms, unless it `knows` what restores the direction and no node stops on its way.
        """
        i = row[0]
        u, trial = self._u[i], self._source[i]
        stops = kernels.descent_trial(u, self._bound[i], self._direction, step, trial)
        stops |= self._law.shorten(lambda: (self._gap(i), self._slip(i)), self._nodes(u), self._nodes(trial))
        if self._yields is not None:  # which stop at the wall from behind
            stopped = self._nodes(trial)[-1]
            np.maximum(stopped, self._punch[i], out=stopped, where=self._yields[i])
        self._is_summed[i] = knows and not stops and self._yields is None
        if self._is_summed[i]:
            np.multiply(self._lifted, step, out=self._result[i])
            self._result[i] += self._elastic[i]
            self._is_summed[i] = _largest(self._result[i]) > _CANCELLED * self._largest_summed[i]
        if not self._is_summed[i]:
            self._products.restore(row)
        work, slope, scale = kernels.descent_work(
            u, trial, self._elastic[i], self._result[i], self._restoring[i], self._load[i], self._closing
        )
        with np.errstate(over="ignore", invalid="ignore"):  # too long a step, which is then cut short
            law = self._change(i)
        return work + law - _ROUNDING * scale, min(slope, 0.0)

    def _accept(self, i: int) -> None:
        """Make the last trial of a row, whose restoring traction was the last result, its displacement."""
        self._u[i] = self._source[i]
        u = self._nodes(self._u[i])[-1]
        if self._floats:
            mean = float(u.mean())
            u -= mean
            self._punch[i] -= mean
            self._level[i] += mean
        self._elastic[i], largest = self._result[i], _largest(self._result[i])
        self._largest_summed[i] = max(self._largest_summed[i], largest) if self._is_summed[i] else largest
        bound, ceiling = self._nodes(self._bound[i])[-1], self._nodes(self._ceiling[i])[-1]
        if self._law.reach > 0.0:
            near = np.asarray(self._punch[i] - u)
            near -= _FAR * self._law.reach
            np.maximum(near, self._law.reach, out=near)
            near += u
            np.minimum(ceiling, near, out=bound)
        pull = self._closing  # which is free between trials
        self._law.fill_traction(self._gap(i), self._slip(i), self._nodes(pull))
        np.subtract(self._elastic[i], pull, out=self._restoring[i])
        self._strongest[i] = _largest(pull)
        if self._floats:
            self.state.u[i] = self._components(self._u[i])
            self.state.u[i, -1] += self._level[i]
        if self._yields is not None:
            self._let_yield(i, u, (ceiling, bound), self._yields[i])

    def _let_yield(self, i: int, u: Reals, bounds: tuple[Reals, Reals], yields: Flags) -> None:
        """Tell which nodes of a row yield, and stop none of these at the wall."""
        punch, load = self._punch[i], self.state.load[i]
        presses = load - self._nodes(self._restoring[i])[-1] > self.certificate.limits.hardness
        yields[:] = (u > punch) | ((u == punch) & presses)
        self._nodes(self._load[i])[-1] = load - self._borne(i)
        for bound in bounds:
            bound[:] = np.where(yields, np.inf, np.minimum(bound, punch))


def _on_coarser_grids(batch: Batch, options: Options) -> tuple[Batch, Indices]:
    """Batch begun with its equilibrium on a coarser grid where that is known to help; the transforms that took."""
    (rows, *fine), slides = batch.punch.shape, np.shape(batch.sliding)
    at_rest = batch.begun is None and batch.load is not None and batch.response.window is None
    alike = batch.interface.hardness is None and not isinstance(batch.interface.normal_law, PatternedLaw)
    if not at_rest or not alike or math.prod(slides[1:]) > 1 or min(fine) <= _COARSEST[len(fine)]:
        return batch, np.zeros(rows, dtype=np.int64)
    shape, active = tuple(-(-nodes // 2) for nodes in fine), np.arange(rows)
    fewer = batch.coarsened(shape)
    coarse = TruncatedNewton(fewer, replace(options, residual=_SETTLED))
    for _ in range(_COARSE_STEPS):
        active = active[~(coarse.residual(active) <= _SETTLED)]
        if not active.size:
            break
        coarse.advance(active)
    u = coarse.state.u[..., : coarse.field.n].reshape(rows, -1, *shape)
    finer = np.concatenate([grid.resample(row[np.newaxis], tuple(fine)) for row in u])
    displacement, tangential = np.minimum(finer[:, -1], batch.punch), np.zeros(tangential_shape(batch.punch))
    tangential[:, : len(finer[0]) - 1] = finer[:, :-1]
    for of_row, wall, touches in zip(displacement, batch.punch, u[:, -1] >= fewer.punch, strict=True):
        share = np.empty(fine)
        refine(touches.astype(np.float64), share)
        np.copyto(of_row, wall, where=share == 1.0)  # between nodes that touch
    cost = grid.relative_cost(coarse.field.n, math.prod(fine))
    return replace(batch, begun=Start(displacement, tangential)), np.ceil(coarse.n_transforms * cost).astype(np.int64)


def starting_displacement(batch: Batch, traction: Callable[[Reals], Reals]) -> Reals:
    """Normal displacement `[realisation, node]` that a batch begins with, under a traction across gaps.

    Where a law repels by more than any pressure, a Newton step would be lost in its exponential.
    """
    punch = batch.punch.reshape(len(batch.punch), -1)
    start = batch.start.displacement.reshape(punch.shape)
    with np.errstate(over="ignore"):
        crushed = -traction(punch - start) > batch.largest_pressure
    return np.where(crushed, np.minimum(start, punch), start)


def _largest(values: Reals) -> float:
    return max(float(values.max()), -float(values.min()))


def _decreases(change: float, slope: float) -> bool:
    """Whether an energy changes by a sufficient part of what its slope promises."""
    return change <= _SUFFICIENT * slope


def _shorter(change: float, slope: float) -> float:
    """Part of a step after which a parabola of that slope and change is least, from a tenth to half."""
    if not (slope < 0.0 and math.isfinite(change)):
        return 0.1
    return min(max(-0.5 * slope / (change - slope), 0.1), 0.5)
