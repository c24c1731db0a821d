"""Damped dynamics of all displacements where tractions are prescribed at some nodes, displacements at the others.

Without a punch this is a linear boundary-value problem: no node may be touched or let go.
"""

import time
from dataclasses import dataclass

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.solvers.dynamics import Verlet, position_verlet
from gfmd_numba.solvers.products import Products
from gfmd_numba.solvers.status import Status, certified
from gfmd_numba.solvers.table import Options

_CHECK_EVERY = 10  # iterations between two looks at the residual
_ROW = np.zeros(1, dtype=np.int64)


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

    `displacement` is not-a-number at free nodes; `traction` is read at free nodes alone. The mean traction of a
    component without any prescribed displacement must be 0 if its mean stiffness is 0. The mean normal stiffness of an
    incompressible slab is infinite: its mean normal displacement is 0, and it needs at least one free node.
    """
    started = time.perf_counter()
    problem = _BoundaryValueProblem(response, traction, displacement, options)
    iterations, residual = 0, problem.residual()
    while residual > options.residual and iterations < options.max_iterations:
        steps = min(_CHECK_EVERY, options.max_iterations - iterations)
        for _ in range(steps):
            problem.advance()
        iterations += steps
        residual = problem.residual()
    return Deformed(
        displacement=problem.displacement.reshape(displacement.shape).copy(),
        traction=problem.traction.reshape(displacement.shape).copy(),
        status=Status(int(certified(residual, options.residual, Status.steps_used_up))),
        residual=residual,
        n_iterations=iterations,
        n_transforms=int(problem.field.n_transforms.sum()),
        wall_time=time.perf_counter() - started,
    )


class _BoundaryValueProblem:
    """All displacements and the tractions that restore them; a transform pair of each a step.

    Tractions count the uniform pressure of an incompressible slab, the multiplier of its mean normal displacement, 0.
    """

    def __init__(self, response: SpectralResponse, traction: Reals, displacement: Reals, options: Options) -> None:
        components, *shape = displacement.shape
        self._free, self._rigid = np.isnan(displacement).reshape(components, -1), response.is_rigid
        prescribed = np.where(np.isnan(displacement), traction, 0.0)
        displacement = displacement.reshape(components, -1)
        elastic = response.with_mean(0.0) if self._rigid else response
        softest, stiffest = elastic.extremes()
        self._least_peak = softest * float(np.nan_to_num(abs(displacement)).max())
        self._products = products = Products(elastic, 1, tuple(shape))
        self.field, n = products.field, products.field.n
        u, ku = products.displacement, products.restoring
        self.displacement, self.traction = u[0, :, :n], ku[0, :, :n]
        self._prescribed: Reals = prescribed.reshape(components, n)
        self.displacement[:] = self._held = self._start(elastic, prescribed, displacement)
        self._state = kernels.SurfaceState(u, ku, np.full_like(u[:, -1], np.inf), np.zeros(1), u[:, :0])
        settings = options.number("time_step"), options.number("damping")
        self._step = Verlet(u, *position_verlet(softest, stiffest, *settings))
        self._restore()

    def advance(self) -> None:
        """Make one time step of the free nodes."""
        self.traction -= self._prescribed
        self._step.step(self._state, kernels.ContactLimits(), _ROW, self.field.n)
        np.copyto(self.displacement, self._held, where=~self._free)
        self._restore()

    def residual(self) -> float:
        """Largest unbalanced traction over the largest traction; costs no transform."""
        worst = np.abs(self._prescribed - self.traction)[self._free].max(initial=0.0)
        if worst == 0.0:
            return 0.0
        peak = max(float(np.abs(self.traction).max()), self._least_peak)
        return np.inf if peak == 0.0 else float(worst / peak)

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
        self._products.restore(_ROW)
        if self._rigid:
            self.traction[-1] += (self._prescribed - self.traction)[-1, self._free[-1]].mean()
