"""Damped dynamics of all displacements where tractions are prescribed at some nodes, displacements at the others.

Without a punch this is a linear boundary-value problem: no node may be touched or let go.
"""

import time
from dataclasses import dataclass

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.stagnation import Stagnation
from gfmd_numba.solvers.status import Status
from gfmd_numba.theory.damping import critical_damping, stability_limit

_CHECK_EVERY = 10  # iterations between two looks at the residual
_SMALL = 1e-2  # residual in single precision below which rounding may keep it where it is


@dataclass(frozen=True)
class Deformed:
    """Displacements and tractions `[component, (y,) x]`, tangential, then normal (L_x, E*), and how they were reached.

    `residual` is the largest unbalanced traction of a free node over the largest traction of any, or over that of
    the softest wave with the amplitude of the prescribed displacement if that is more.
    """

    displacement: Reals
    traction: Reals
    status: Status
    residual: float
    n_iterations: int
    n_transforms: int
    wall_time: float


def deform(response: SpectralResponse, traction: Reals, displacement: Reals, options: Options) -> Deformed:
    """Displace and load the surface of a body node by node `[component, (y,) x]`, tangential, then normal (L_x, E*).

    `displacement` is not-a-number at free nodes, the others' `traction` is not read. The mean traction of a
    component without any prescribed displacement must be 0 if its mean stiffness is 0; that of an incompressible
    slab, which is infinite, makes the mean normal displacement 0 and asks for at least one free node.
    """
    started = time.perf_counter()
    problem = _BoundaryValueProblem(response, traction, displacement, options)
    iterations, residual = 0, problem.residual()
    is_single, stagnation, stands = options.precision == "single", Stagnation(1, _SMALL), False
    while residual > options.residual and iterations < options.max_iterations and not stands:
        steps = min(_CHECK_EVERY, options.max_iterations - iterations)
        for _ in range(steps):
            problem.advance()
        iterations += steps
        residual = problem.residual()
        stands = is_single and bool(stagnation.look(np.array([residual]), np.zeros(1, dtype=np.int64))[0])
    status = Status.stagnated if stands else Status.steps_used_up
    status = Status.ok if residual <= options.residual else status
    field, n = problem.field, problem.field.n
    return Deformed(
        displacement=problem.displacement[:, :n].reshape(displacement.shape).copy(),
        traction=(field.result[:, :n] + problem.excess[:, np.newaxis]).reshape(displacement.shape),
        status=status if np.isfinite(residual) else Status.nonfinite,
        residual=residual,
        n_iterations=iterations,
        n_transforms=int(field.n_transforms.sum()),
        wall_time=time.perf_counter() - started,
    )


class _BoundaryValueProblem:
    """All displacements and the tractions that restore them; a transform pair of each a step.

    `excess` is the uniform pressure of an incompressible slab: the multiplier of its mean normal displacement, 0.
    """

    def __init__(self, response: SpectralResponse, traction: Reals, displacement: Reals, options: Options) -> None:
        components, *shape = displacement.shape
        start = np.where(np.isnan(displacement), traction, 0.0)
        displacement = displacement.reshape(components, -1)
        n = displacement.shape[1]
        self.excess = np.zeros(components)
        self._free = np.isnan(displacement)
        self._boundary = kernels.Boundary(start.reshape(components, n), self._free, self.excess)
        self._rigid = response.is_rigid
        elastic = response.with_mean(0.0) if self._rigid else response
        softest, stiffest = elastic.extremes()
        self._least_peak = softest * float(np.nan_to_num(abs(displacement)).max())
        damping = options.number("damping")
        dt = options.number("time_step") * stability_limit(softest, stiffest, damping)
        self._push = dt * dt
        self._memory = 1.0 - damping * critical_damping(softest, dt) * dt * dt
        self.field = Transform(components, *shape, dtype=np.float32 if options.precision == "single" else np.float64)
        self._symbols = np.array([self.field.symbol(k) for k in elastic.elements])
        (self.displacement,) = self.field.sources
        self.displacement[:, :n] = self._start(elastic, start, displacement)
        self._last = self.displacement.copy()
        self._rows = np.arange(components)
        self._restore()

    def advance(self) -> None:
        """Make one time step."""
        kernels.prescribed_step(
            self.displacement, self._last, self.field.result, self._boundary, self.field.n, self._memory, self._push
        )
        self._restore()

    def residual(self) -> float:
        """Largest unbalanced traction over the largest traction; costs no transform."""
        worst, peak = kernels.prescribed_violation(self.field.result, self._boundary, self.field.n)
        if worst == 0.0:
            return 0.0
        peak = max(peak, self._least_peak)
        return float(worst / peak) if peak > 0.0 else np.inf

    def _start(self, elastic: SpectralResponse, traction: Reals, displacement: Reals) -> Reals:
        """The response to the tractions alone `[component, node]`, moved to where the displacement is prescribed."""
        start = elastic.apply(traction).reshape(displacement.shape)
        for u, given, free in zip(start, displacement, self._free, strict=True):
            if not free.all():
                u += (given - u)[~free].mean()
                u[~free] = given[~free]
        if self._rigid:
            start[-1, self._free[-1]] -= start[-1].sum() / self._free[-1].sum()
        return start

    def _restore(self) -> None:
        rows = self._rows
        self.field.forward(rows)
        kernels.couple(self.field.spectrum, self._symbols, rows[:1], 1)
        self.field.inverse(rows)
        if self._rigid:
            normal = rows.size - 1
            self.excess[normal] = kernels.free_mean(self.field.result, self._boundary, normal, self.field.n)
