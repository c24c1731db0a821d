"""Static equilibrium of a batch: begin a solver of the table, iterate until the certificate holds, give a status."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.arrays.threads import team
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface import vector_slip
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.certificate import pressure_scale
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Iteration, Start, begin, leave_pressures, tangential_shape
from gfmd_numba.solvers.status import Stagnation, Status, certified
from gfmd_numba.solvers.table import SOLVERS, Options

_BLOWN_UP = 1e12  # tractions over load and fluctuation of full contact, above which a run is called unstable
_SURELY_YIELDS = 2.0  # peak pressure of an elastic contact over the hardness, judged at
_RESIDUAL_TO_JUDGE = 1e-2
_FLUCTUATIONS = 6.0  # of full contact, beyond the load: no pressure is expected to exceed that


@dataclass(frozen=True)
class Tangential:
    """Tangential displacement of the body and the traction of the punch on it (L_x, E*).

    All are `[realisation, component, (y,) x]`, along x and on maps then along y. `slip` is how far a touching node has
    slid since the state that the solver began with, exactly 0 where it sticks. `sliding` is the tangential displacement
    of the punch, ready to broadcast with `[component, (y,) x]`.
    """

    displacement: Reals
    traction: Reals
    slip: Reals
    sliding: Reals | float

    @classmethod
    def zero(cls, punch: Reals, sliding: Reals | float) -> "Tangential":
        """Nothing yet, to be filled."""
        displacement, traction, slip = np.zeros((3, *tangential_shape(punch)))
        return cls(displacement, traction, slip, sliding)


@dataclass(frozen=True)
class Equilibrium:
    """Displacement and pressure `[realisation, (y,) x]` (L_x, E*), and per realisation how they were reached.

    The pressure is the whole normal traction of the interface, of the hard wall and of the law. Nodes are `touching`
    where the wall presses; in results, nodes without a gap (`arrays.regions.on_wall`).

    Nodes at the hardness are `plastic`, and those alone may penetrate; None without a hardness.

    The displacement is positive towards the punch; under a prescribed load its mean is arbitrary. `residual` is that of
    `Certificate.residual`. `full_contact_rms_pressure` is the rms fluctuation of the pressure were the punch in full
    contact. `growing_wave` is the index of the wave that grew most in each unstable realisation, -1 in the others; None
    unless there is one. If the punch fills a corner of the grid, fields have the nodes of the corner. Then
    `mean_displacement` is the mean over the whole grid, and `touching_around` says whether anything touches beyond the
    corner.
    """

    displacement: Reals
    pressure: Reals
    touching: Flags
    tangential: Tangential | None
    status: npt.NDArray[np.int8]
    residual: Reals
    n_iterations: npt.NDArray[np.int64]
    n_transforms: npt.NDArray[np.int64]
    wall_time: Reals
    full_contact_rms_pressure: Reals
    growing_wave: Indices | None = None
    plastic: Flags | None = None
    mean_displacement: Reals | None = None
    touching_around: Flags | None = None

    @classmethod
    def empty(
        cls, punch: Reals, scale: Reals, interface: Interactions, sliding: Reals | float, is_corner: bool = False
    ) -> "Equilibrium":
        """Nothing yet, to be filled; `scale` is the rms pressure of full contact."""
        rows = len(punch)
        return cls(
            displacement=np.empty_like(punch),
            pressure=np.zeros(punch.shape),  # which takes memory where it is touched, as `zeros_like` does not
            touching=np.empty(punch.shape, dtype=np.bool_),
            tangential=Tangential.zero(punch, sliding) if interface.couples else None,
            status=np.full(rows, Status.steps_used_up, dtype=np.int8),
            residual=np.full(rows, np.nan),
            n_iterations=np.zeros(rows, dtype=np.int64),
            n_transforms=np.zeros(rows, dtype=np.int64),
            wall_time=np.zeros(rows),
            full_contact_rms_pressure=scale,
            plastic=None if interface.hardness is None else np.zeros(punch.shape, dtype=np.bool_),
            mean_displacement=np.zeros(rows) if is_corner else None,
            touching_around=np.zeros(rows, dtype=np.bool_) if is_corner else None,
        )

    @property
    def corner(self) -> Any:
        """Index of the nodes in the corner, or of all, in fields `[..., (y,) x]` on the grid."""
        return grid.corner(self.pressure.shape[1:])


def following(before: Equilibrium, punch: Reals, sliding: Reals | float) -> Start:
    """Initial state for the next load: the equilibrium before, whose touching nodes move with the punch, also sideways.

    A gap torn open by the step itself would break an adhesive contact early.
    """
    displacement = np.where(before.touching, punch, before.displacement)
    if before.tangential is None:
        return replace(Start.at_rest(punch), displacement=displacement)
    return Start(displacement, before.tangential.displacement, sliding - before.tangential.sliding)


def equilibrate(
    punch: Reals,
    response: SpectralResponse,
    load: float | None,
    options: Options,
    interface: Interactions = HARD_WALL,
    start: Start | None = None,
    sliding: Reals | float = 0.0,
    around: Reals | None = None,
) -> Equilibrium:
    """Press elastic bodies against rigid punches `[realisation, (y,) x]` (L_x, the wall u <= punch).

    `response` is that of the normal displacement alone for frictionless interfaces and of all otherwise; `load` the
    mean pressure in E*, or None if the position of the punch prescribes the displacement (then K(0) counts); `sliding`
    the tangential displacement of the punch, ready to broadcast with `[component, (y,) x]`. The punch may fill a
    corner of the grid of the response alone, and be flat `around` it `[realisation, (1,) 1]`. Under a hardness the
    elastic contact comes first, and is the result where it stays below. Raises ValueError for a load that the hardness
    cannot carry.
    """
    _check_hardness(load, interface)
    hardness, realisations, n = interface.hardness, len(punch), punch[0].size
    bounds = (interface.normal_law, interface.cohesive, hardness) != (None, None, None)  # of pressures, needed at once
    scale = pressure_scale(punch, response) if bounds else np.full(realisations, np.nan)
    result = Equilibrium.empty(punch, scale, interface, sliding, around is not None)
    if load is not None:
        response = response.with_mean(0.0)
    borne = (load or 0.0) + (hardness or 0.0)  # also by punches that have been flattened
    block = max(1, SOLVERS[options.solver].block_samples // n)
    for first in range(0, realisations, block):
        rows = np.arange(first, min(first + block, realisations))
        started = time.perf_counter()
        largest = borne + _FLUCTUATIONS * float(np.where(np.isnan(scale[rows]), np.inf, scale[rows]).max())

        def batch(rows: Indices, laws: Interactions, largest: float = largest) -> Batch:
            some = slice(rows[0], rows[-1] + 1) if rows[-1] - rows[0] == rows.size - 1 else rows
            given = None if load is None else np.full(rows.size, load)
            begun = None if start is None else start.rows(some)
            beyond = None if around is None else around[some]
            room = (result.displacement[some], result.pressure[some]) if isinstance(some, slice) else (None, None)
            return Batch(punch[some], response, given, laws, begun, sliding, largest, beyond, *room)

        if hardness is None:
            _solve(batch, interface, rows, borne, options, result)
        else:
            _solve(batch, replace(interface, hardness=None), rows, borne, options, result, hardness)
            most = hardness * (1.0 + options.residual)
            yielding = rows[(result.status[rows] != Status.ok) | _above(most, result, rows)]
            for row in np.setdiff1d(rows, yielding):  # loaded again up to where it has yielded, but for the residual
                overshoot = float(result.pressure[row].max()) / hardness - 1.0
                result.residual[row] = max(result.residual[row], overshoot)
            if yielding.size:
                _solve(batch, interface, yielding, borne, options, result)
        share = result.n_transforms[rows] / result.n_transforms[rows].sum()
        result.wall_time[rows] = (time.perf_counter() - started) * share
    with np.errstate(over="ignore", invalid="ignore"):  # of runs that diverge, as their status says
        _add_tractions_of_laws(result, interface, punch, sliding)
    unstable = result.status == Status.unstable
    if load is None and response.is_rigid and "time_step" not in SOLVERS[options.solver].options:
        result.status[unstable], unstable = Status.no_equilibrium, np.zeros_like(unstable)
    return replace(result, growing_wave=_growing_waves(result, unstable, response)) if unstable.any() else result


def _check_hardness(load: float | None, interface: Interactions) -> None:
    """Raise ValueError for a load that the hardness cannot carry."""
    if load is None or interface.hardness is None:
        return
    law = interface.normal_law
    most = interface.hardness - (0.0 if law is None else float(law.traction(np.zeros(1))[0]))
    if load >= most:
        raise ValueError(f"a mean pressure of {load:g} at or above the {most:g} that the hardness bears")


def _add_tractions_of_laws(result: Equilibrium, interface: Interactions, punch: Reals, sliding: Reals | float) -> None:
    """Add the tractions of the laws to those of the wall, in place."""
    if interface.normal_law is not None:
        gap = punch - result.displacement
        result.pressure[:] -= interface.normal_law.traction(gap if interface.hardness is None else np.maximum(gap, 0.0))
    if interface.cohesive is not None and result.tangential is not None:
        gap, slip = punch - result.displacement, sliding - result.tangential.displacement
        for of_realisation in zip(gap, slip, result.pressure, result.tangential.traction, strict=True):
            own_gap, own_slip, pressure, traction = of_realisation
            pressure -= interface.cohesive.normal_traction(own_gap, vector_slip.length(own_slip))
            traction += vector_slip.tangential_traction(interface.cohesive, own_gap, own_slip)


def _solve(
    batch: Callable[[Indices, Interactions], Batch],
    laws: Interactions,
    rows: Indices,
    borne: float,
    options: Options,
    result: Equilibrium,
    hardness: float = np.inf,
) -> None:
    """Run the solver of the options, and its successor on the rows that it gives up.

    An elastic run stops once its peak pressure is far above the hardness: that contact surely yields.
    """
    solver, whole = SOLVERS[options.solver], batch(rows, laws)
    iteration = begin(whole, options)
    unknown = np.isnan(result.full_contact_rms_pressure[rows])
    if unknown.any():
        found = iteration.certificate.full_contact
        result.full_contact_rms_pressure[rows] = pressure_scale(whole.punch, whole.response) if found is None else found
    _iterate(iteration, rows, borne, options, result, hardness)
    asked = {*laws.abilities, *(("rigid mean",) if whole.response.is_rigid else ())}
    if solver.successor is None or not asked <= SOLVERS[solver.successor].can:
        return
    stuck = rows[(result.status[rows] != Status.ok) & ~_above(_SURELY_YIELDS * hardness, result, rows)]
    if stuck.size and options.max_iterations > (solver.gives_up_after or 0):
        other = replace(options, solver=solver.successor)
        _iterate(begin(batch(stuck, laws), other), stuck, borne, other, result, hardness)


def _fill(result: Equilibrium, row: int, displacement: Reals, pressure: Reals) -> None:
    """Fill a row of the result, shared by threads: new memory takes longer than what is written there."""
    pairs = (displacement, result.displacement[row]), (pressure, result.pressure[row])
    moved = [pair for pair in pairs if not np.may_share_memory(*pair)]  # or the solver has worked there

    def some(part: slice) -> None:
        for found, kept in moved:
            kept[part] = found[part]
        np.greater(pressure[part], 0.0, out=result.touching[row][part])

    team().by_rows(some, pressure.shape)


def _store(result: Equilibrium, solver: Iteration, done: Indices, where: Indices) -> None:
    """Store rows of a solver that have ended; their normal tractions are pressures."""
    state, n, shape, corner = solver.state, solver.field.n, solver.field.shape, result.corner
    mean = solver.certificate.mean_displacement
    for i, row in zip(done, where, strict=True):  # one by one: a map may fill a good part of the memory
        u, p = (each[i, -1, :n].reshape(shape) for each in (state.u, state.restoring))
        _fill(result, row, u[corner], p[corner])
        if result.mean_displacement is not None and result.touching_around is not None:
            result.mean_displacement[row] = u.mean() if mean is None else mean[i]
            result.touching_around[row] = np.count_nonzero(p > 0.0) > np.count_nonzero(result.touching[row])
    found = result.tangential
    if not done.size or found is None or not state.anchor.size:
        return
    along = found.slip.shape[1]
    displacement, traction, anchor = (
        each[done, :along, :n].reshape(-1, along, *shape)[corner] for each in (state.u, state.restoring, state.anchor)
    )
    found.displacement[where], found.traction[where] = displacement, traction
    touching = result.touching[where][:, np.newaxis]
    found.slip[where] = np.where(touching & ~np.isnan(anchor), displacement - anchor, 0.0)


def _above(pressure: float, result: Equilibrium, rows: Indices) -> Flags:
    """Whether any node of each row bears more than a pressure."""
    if pressure == np.inf:
        return np.zeros(rows.size, dtype=np.bool_)
    return np.asarray((result.pressure[rows] > pressure).reshape(rows.size, -1).any(axis=1))


def _iterate(
    solver: Iteration, rows: Indices, borne: float, options: Options, result: Equilibrium, hardness: float
) -> None:
    """Advance all rows until each is certified, stagnates, gives up or will surely yield; store each as it ends."""
    limit = min(options.max_iterations, SOLVERS[options.solver].gives_up_after or options.max_iterations)
    active, stagnation = np.arange(rows.size), Stagnation(rows.size)
    blown_up = _BLOWN_UP * (result.full_contact_rms_pressure[rows] + borne)
    iterations = 0
    while active.size:
        steps = min(solver.check_every, limit - iterations)
        for _ in range(steps):
            solver.advance(active)
        iterations += steps
        residual = solver.residual(active)
        stays = stagnation.look(residual, active)
        status = certified(residual, options.residual, np.where(stays, Status.stagnated, Status.steps_used_up))
        status[(solver.certificate.violation[active] > blown_up[active]) & ~np.isnan(residual)] = Status.unstable
        ended = (status != Status.steps_used_up) | (iterations >= limit)
        ended |= (residual <= _RESIDUAL_TO_JUDGE) & (solver.certificate.peak[active] > _SURELY_YIELDS * hardness)
        done = active[ended]
        where = rows[done]
        leave_pressures(solver, done)
        _store(result, solver, done, where)
        if result.plastic is not None:
            result.plastic[where] = result.pressure[where] >= solver.certificate.limits.hardness
        result.status[where] = status[ended]
        result.residual[where] = residual[ended]
        result.n_iterations[where] += iterations
        active = active[~ended]
    result.n_transforms[rows] += solver.n_transforms


def _growing_waves(result: Equilibrium, unstable: Flags, response: SpectralResponse) -> Indices:
    """Return the index `[realisation]` of the wave with the largest restoring traction: the run blew up from nothing.

    It is -1 in realisations that are not `unstable`. The `response` is the one that the run has had.
    """
    moved, found = result.displacement[unstable][:, np.newaxis], np.full(unstable.size, -1, dtype=np.int64)
    rows, shape = len(moved), moved.shape[2:]
    if result.tangential is not None:
        moved = np.concatenate((result.tangential.displacement[unstable].reshape(rows, -1, *shape), moved), axis=1)
    stiffness = response.diagonal[-moved.shape[1] :]
    wider = [m // n for m, n in zip(stiffness.shape[1:-1], shape, strict=False)]  # of a grid around the displacement
    wider.append((stiffness.shape[-1] - 1) // (shape[-1] // 2))
    held = stiffness[(..., *(m * k for m, k in zip(wider, grid.wave_indices(shape), strict=True)))]
    tractions = (np.abs(grid.coefficients(moved, len(shape))) * held).max(axis=1)
    index = grid.magnitudes(shape).ravel() / (2.0 * np.pi)
    found[unstable] = np.round(index[tractions.reshape(rows, -1).argmax(axis=1)])
    return found
