"""Static equilibrium of a batch: pick a solver, iterate until the certificate holds, say how it ended."""

import time
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Protocol

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.elasticity.coupled_stiffness import CoupledStiffness
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.convolution import Convolution
from gfmd_numba.interface.laws import Interface
from gfmd_numba.scene import Numerics
from gfmd_numba.solvers.active_set_newton import ActiveSetNewton
from gfmd_numba.solvers.certificate import Certificate, pressure_scale
from gfmd_numba.solvers.conjugate_gradients import ConjugateGradients
from gfmd_numba.solvers.coupled_dynamics import CoupledRelaxation
from gfmd_numba.solvers.damped_dynamics import Integrator, Relaxation
from gfmd_numba.solvers.integrators import Fire, gronbech_jensen, position_verlet

Reals = npt.NDArray[np.float64]
Rows = npt.NDArray[np.int64]

HARD_WALL = Interface(hard_wall=True)

_NEWTON_STEPS = 50  # usually below 10: with more, conjugate gradients take over
_BLOCK_SAMPLES = 2**15  # samples a block of rows may hold: its arrays then stay in the second-level cache
_BATCH_SAMPLES = 2**18  # the same for a solver that finishes one row before the next
_BLOWN_UP = 1e12  # tractions over load and fluctuation of full contact beyond which a run is unstable, not slow


class Status(IntEnum):
    """How a run ended; only `ok` results are used. Of a campaign some may be `unfinished` or `not_asked`."""

    ok = 0
    not_converged = 1
    unstable = 2
    nonfinite = 3
    timeout = 4
    crashed = 5
    unfinished = 6
    not_asked = 7


class Solver(Protocol):
    """What `equilibrate` asks of a solver: after `residual`, `restoring` is the traction of `displacement`."""

    check_every: int  # iterations between two looks at the certificate
    field: Convolution
    displacement: Reals
    restoring: Reals
    wall: Reals
    load: Reals
    certificate: Certificate

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]: ...  # noqa: D102
    def advance(self, active: Rows) -> None: ...  # noqa: D102
    def residual(self, active: Rows) -> Reals: ...  # noqa: D102


@dataclass(frozen=True)
class Tangential:
    """Tangential displacement of the body and the traction of the punch on it `[realisation, x]` (L_x, E*).

    `sliding` is the tangential displacement of the punch.
    """

    displacement: Reals
    traction: Reals
    sliding: float


@dataclass(frozen=True)
class Equilibrium:
    """Displacement and pressure `[realisation, x]` (L_x, E*), and per realisation how they were reached.

    The pressure is what the interface transmits, of the hard wall (on the nodes `touching` it) and of the law.

    The displacement is positive towards the punch; under a prescribed load its mean is arbitrary. `residual` is the
    largest traction on free nodes or tension on touching ones over the largest pressure (or traction of the law at
    zero gap), or the load imbalance over the load, whichever is larger. `full_contact_pressure` is the rms fluctuation
    of the pressure were the punch in full contact. `growing_wave` is the index of the wave that
    grew most in each unstable realisation, -1 in the others; None unless there is one.
    """

    displacement: Reals
    pressure: Reals
    touching: npt.NDArray[np.bool_]
    tangential: Tangential | None
    status: npt.NDArray[np.int8]
    residual: Reals
    n_iterations: npt.NDArray[np.int64]
    n_transforms: npt.NDArray[np.int64]
    wall_time: Reals
    full_contact_pressure: Reals
    growing_wave: Rows | None = None


@dataclass(frozen=True)
class Start:
    """What a batch begins with `[realisation, x]`: displacements, and where the punch holds the nodes it touched.

    The `anchor` is tangential, and not-a-number for nodes that did not touch.
    """

    displacement: Reals
    tangential: Reals
    anchor: Reals

    @classmethod
    def at_rest(cls, punch: Reals) -> "Start":
        """The undeformed body, pushed back where the punch penetrates it."""
        return cls(np.minimum(punch, 0.0), np.broadcast_to(0.0, punch.shape), np.broadcast_to(np.nan, punch.shape))

    @classmethod
    def after(cls, before: Equilibrium, punch: Reals, sliding: float) -> "Start":
        """An equilibrium whose touching nodes follow the punch, also sideways.

        A gap torn open by the step itself would break an adhesive contact early.
        """
        displacement = np.where(before.touching, punch, before.displacement)
        if before.tangential is None:
            return replace(cls.at_rest(punch), displacement=displacement)
        moved = before.tangential.displacement + sliding - before.tangential.sliding
        anchor = np.where(before.touching, moved, np.nan)
        return cls(displacement, before.tangential.displacement, anchor)


def equilibrate(
    punch: Reals,
    stiffness: Reals | CoupledStiffness,
    load: float | None,
    numerics: Numerics,
    interface: Interface = HARD_WALL,
    start: Start | None = None,
    sliding: float = 0.0,
) -> Equilibrium:
    """Press elastic bodies against rigid punches `[realisation, (y,) x]` (L_x, the wall u <= punch).

    `stiffness` is K(q) `[(ny,) nx // 2 + 1]` in E*/L_x, condensed for frictionless interfaces and coupled otherwise;
    `load` the mean pressure in E*, or None if the position of the punch prescribes the displacement (then K(0)
    counts); `sliding` the tangential displacement of the punch.
    """
    realisations, n = len(punch), punch[0].size
    condensed = stiffness.condensed() if isinstance(stiffness, CoupledStiffness) else stiffness
    scale = pressure_scale(punch, condensed)
    result = Equilibrium(
        displacement=np.empty_like(punch),
        pressure=np.empty_like(punch),
        touching=np.empty(punch.shape, dtype=np.bool_),
        tangential=None if not interface.couples else Tangential(np.zeros_like(punch), np.zeros_like(punch), sliding),
        status=np.full(realisations, Status.not_converged, dtype=np.int8),
        residual=np.full(realisations, np.nan),
        n_iterations=np.zeros(realisations, dtype=np.int64),
        n_transforms=np.zeros(realisations, dtype=np.int64),
        wall_time=np.zeros(realisations),
        full_contact_pressure=scale,
    )
    start = Start.at_rest(punch) if start is None else start
    block = max(1, (_BATCH_SAMPLES if numerics.solver == "active_set_newton" else _BLOCK_SAMPLES) // n)
    for first in range(0, realisations, block):
        rows = np.arange(first, min(first + block, realisations))
        some = slice(first, first + block)
        started = time.perf_counter()
        largest = float(scale[rows].max())
        if isinstance(stiffness, CoupledStiffness):
            starts = start.displacement[some], start.tangential[some], start.anchor[some]
            solver: Solver = _coupled_solver(
                punch[some], stiffness, load, numerics, interface, sliding, starts, largest
            )
        else:
            solver = _solver(punch[some], stiffness, load, numerics, interface, start.displacement[some], largest)
        blown_up = _BLOWN_UP * (scale + (load or 0.0))
        _iterate(solver, rows, blown_up, numerics, result)
        stuck = rows[result.status[rows] != Status.ok]
        if numerics.solver == "active_set_newton" and stuck.size and numerics.max_iterations > _NEWTON_STEPS:
            other = numerics.model_copy(update={"solver": "conjugate_gradients"})
            solver = _solver(punch[stuck], condensed, load, other, interface, start.displacement[stuck], largest)
            _iterate(solver, stuck, blown_up, other, result)
        share = result.n_transforms[rows] / result.n_transforms[rows].sum()
        result.wall_time[rows] = (time.perf_counter() - started) * share
    if interface.law is not None:
        result.pressure[:] -= interface.law.traction(punch - result.displacement)
    if interface.cohesion is not None and result.tangential is not None:
        gap, slip = punch - result.displacement, sliding - result.tangential.displacement
        result.pressure[:] -= interface.cohesion.normal_traction(gap, slip)
        result.tangential.traction[:] += interface.cohesion.tangential_traction(gap, slip)
    if (result.status == Status.unstable).any():
        return replace(result, growing_wave=_growing_wave(result, stiffness, load is not None))
    return result


def _growing_wave(result: Equilibrium, stiffness: Reals | CoupledStiffness, free_mean: bool) -> Rows:
    """Index of the wave of the largest restoring tractions where a run ended unstable: it blew up from nothing."""
    unstable = result.status == Status.unstable
    normal = stiffness.k33 if isinstance(stiffness, CoupledStiffness) else stiffness
    tractions = np.abs(grid.coefficients(result.displacement[unstable], normal.ndim)) * normal
    if free_mean:
        tractions.reshape(len(tractions), -1)[:, 0] = 0.0
    if isinstance(stiffness, CoupledStiffness) and result.tangential is not None:
        sideways = np.abs(grid.coefficients(result.tangential.displacement[unstable])) * stiffness.k11
        tractions = np.maximum(tractions, sideways)
    growing = np.full(len(unstable), -1, dtype=np.int64)
    index = grid.magnitudes(result.displacement.shape[1:]).ravel() / (2.0 * np.pi)
    growing[unstable] = np.round(index[tractions.reshape(len(tractions), -1).argmax(axis=1)])
    return growing


def _solver(
    punch: Reals,
    stiffness: Reals,
    load: float | None,
    numerics: Numerics,
    interface: Interface,
    start: Reals,
    scale: float,
) -> Solver:
    if load is not None:  # the mean displacement is free: it follows the load without restoring force
        stiffness = stiffness.copy()
        stiffness.flat[0] = 0.0
    if numerics.solver in ("active_set_newton", "conjugate_gradients"):
        given = None if load is None else np.full(len(punch), load)
        if numerics.solver == "active_set_newton":
            return ActiveSetNewton(punch, stiffness, given, numerics.residual)
        return ConjugateGradients(punch, stiffness, given)
    loads = np.full(len(punch), 0.0 if load is None else load)
    elastic = stiffness[stiffness > 0.0]
    softest, stiffest = float(elastic.min()), float(elastic.max())
    if interface.law is not None:  # no pressure is expected far beyond the fluctuation of full contact
        stiffest += interface.law.stiffest(float(loads[0]) + 6.0 * scale, interface.hard_wall)

    def integrator(displacement: Reals) -> Integrator:
        if numerics.solver == "fire":
            return Fire(displacement, stiffest, numerics.time_step)
        scheme = {"verlet": position_verlet, "gronbech_jensen": gronbech_jensen}[numerics.solver]
        return scheme(displacement, softest, stiffest, numerics.time_step, numerics.damping)

    return Relaxation(punch, stiffness, loads, interface, start, integrator)


def _coupled_solver(
    punch: Reals,
    stiffness: CoupledStiffness,
    load: float | None,
    numerics: Numerics,
    interface: Interface,
    sliding: float,
    starts: tuple[Reals, Reals, Reals],
    scale: float,
) -> CoupledRelaxation:
    if load is not None:
        stiffness = stiffness.with_free_mean()
    loads = np.full(len(punch), 0.0 if load is None else load)
    largest = float(loads[0]) + 6.0 * scale  # no pressure is expected far beyond the fluctuation of full contact
    return CoupledRelaxation(
        punch, stiffness, loads, interface, sliding, *starts, numerics.time_step, numerics.damping, largest
    )


def _iterate(solver: Solver, rows: Rows, blown_up: Reals, numerics: Numerics, result: Equilibrium) -> None:
    """Advance all rows until each is certified or gives up, and store each as it ends."""
    n = solver.field.n
    limit = numerics.max_iterations
    if numerics.solver == "active_set_newton":
        limit = min(limit, _NEWTON_STEPS)
    active = np.arange(rows.size)
    iterations = 0
    while active.size:
        steps = min(solver.check_every, limit - iterations)
        for _ in range(steps):
            solver.advance(active)
        iterations += steps
        residual = solver.residual(active)
        status = np.full(active.size, Status.not_converged, dtype=np.int8)
        status[residual <= numerics.residual] = Status.ok
        status[solver.certificate.worst[active] > blown_up[rows[active]]] = Status.unstable
        status[np.isnan(residual)] = Status.nonfinite
        ended = (status != Status.not_converged) | (iterations >= limit)
        done = active[ended]
        pressure = solver.restoring  # of rows that have ended, which need it no more
        kernels.wall_pressure(solver.displacement, pressure, solver.wall, solver.load, done, n, pressure)
        where = rows[done]
        shape = (len(done), *solver.field.shape)
        result.displacement[where] = solver.displacement[done, :n].reshape(shape)
        result.pressure[where] = pressure[done, :n].reshape(shape)
        result.touching[where] = result.pressure[where] > 0.0
        if result.tangential is not None:
            assert isinstance(solver, CoupledRelaxation)
            result.tangential.displacement[where] = solver.tangential[done, :n]
            result.tangential.traction[where] = solver.tangential_restoring[done, :n]
        result.status[where] = status[ended]
        result.residual[where] = residual[ended]
        result.n_iterations[where] += iterations
        active = active[~ended]
    result.n_transforms[rows] += solver.n_transforms
