"""Input of a solver (`Batch`, `Start`), its interface (`Iteration`), and how it begins."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pkgutil import resolve_name
from typing import Protocol, Self

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.certificate import Certificate, RigidMean
from gfmd_numba.solvers.table import OF_CORNERS, ONLY_IN, SOLVERS, Options

HARD_WALL = Interactions(hard_wall=True)


def tangential_shape(punch: Reals) -> tuple[int, ...]:
    """Shape `[realisation, component, (y,) x]` of tangential quantities under punches, along x and on maps along y."""
    return len(punch), len(punch.shape) - 1, *punch.shape[1:]


@dataclass(frozen=True)
class Start:
    """Initial displacements of a batch `[realisation, (y,) x]`, normal and tangential.

    Tangential quantities have the `tangential_shape`. `dragged` is how far the punch has moved sideways since, ready to
    broadcast with `[component, (y,) x]`.
    """

    displacement: Reals
    tangential: Reals
    dragged: Reals | float = 0.0

    @property
    def anchor(self) -> Reals:
        """Where each node slips from: where it was, had it moved with the punch since."""
        return np.asarray(self.tangential + self.dragged)

    @classmethod
    def at_rest(cls, punch: Reals) -> Self:
        """The undeformed body, pushed back where the punch penetrates it."""
        return cls(np.minimum(punch, 0.0), np.broadcast_to(0.0, tangential_shape(punch)))

    def rows(self, some: slice | Indices) -> "Start":
        """Start of some rows alone."""
        return Start(self.displacement[some], self.tangential[some], self.dragged)


@dataclass(frozen=True)
class Batch:
    """Elastic bodies under rigid punches `[realisation, (y,) x]` (L_x, E*), as a solver is given them.

    `response` is that of the normal displacement alone or of all. `load` is the mean pressure `[realisation]`, which no
    mean displacement balances, or None where the position of the punch prescribes the displacement. `sliding` is the
    tangential displacement of the punch, ready to broadcast with `[component, (y,) x]`; with a cohesive law, less other
    shifts of each node. No pressure is expected to exceed the `largest_pressure`. A solver may begin with the state
    `begun`, None for bodies at rest. The punch may fill a corner of the grid of the response alone, and be flat
    `around` it `[realisation, (1,) 1]`. A solver may keep displacements in the `room` `[realisation, (y,) x]` for them,
    and pressures in that `room_of_pressure`, which is zero.
    """

    punch: Reals
    response: SpectralResponse
    load: Reals | None
    interface: Interactions
    begun: Start | None = None
    sliding: Reals | float = 0.0
    largest_pressure: float = np.inf
    around: Reals | None = None
    room: Reals | None = None
    room_of_pressure: Reals | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Nodes (ny,) nx of the grid."""
        return self.punch.shape[1:] if self.response.window is None else self.response.window.padded

    @cached_property
    def whole(self) -> "Batch":
        """The same with the punch on all nodes of the grid."""
        return self if self.around is None else replace(self, punch=self.within(self.shape), around=None)

    def within(self, shape: tuple[int, ...]) -> Reals:
        """Punch `[realisation, (y,) x]` on more of the grid, from its corner on."""
        assert self.around is not None
        made = np.empty((len(self.punch), *shape))
        made[:] = self.around
        made[grid.corner(self.punch.shape[1:])] = self.punch
        return made

    def coarsened(self, shape: tuple[int, ...]) -> "Batch":
        """The same at rest on a coarser grid of a shape, with the waves that this grid holds."""
        smooth = np.concatenate([grid.resample(row[np.newaxis], shape) for row in self.punch])  # whatever the others
        return replace(self, punch=smooth, response=self.response.coarsened(shape), begun=None, room=None)

    @cached_property
    def start(self) -> Start:
        """Initial state, which not every solver asks for: it takes as much memory as the punch."""
        return Start.at_rest(self.punch) if self.begun is None else self.begun

    @property
    def loads(self) -> Reals:
        """Mean pressure `[realisation]` that pushes the body, 0 where the displacement is prescribed."""
        return np.zeros(len(self.punch)) if self.load is None else self.load

    @property
    def uniform_pressure(self) -> Reals:
        """Pressure `[realisation]` of the load, or one under which the softest wave gives way to the whole punch."""
        if self.load is not None:
            return self.load
        softest = abs(self.response.normal.flat[int(self.response.is_rigid)])
        return np.asarray(softest * np.maximum(-self.punch.reshape(len(self.punch), -1).min(axis=1), 0.0))

    def certificate(self) -> Certificate:
        """Return what measures how far a solver is from equilibrium."""
        rigid_mean = RigidMean.of(self.punch, self.response)
        return Certificate(len(self.punch), self.interface.limits, rigid_mean)

    def law_stiffness(self) -> float:
        """Bound of the stiffness that the laws add to that of the bodies."""
        laws = (self.interface.normal_law, self.interface.cohesive)
        return sum(law.stiffest(self.largest_pressure, self.interface.hard_wall) for law in laws if law is not None)


class Samples(Protocol):
    """What is known of the transforms of a solver: how many nodes a row has, and their shape."""

    n: int
    shape: tuple[int, ...]


class Iteration(Protocol):
    """A solver at work on a batch: after `residual`, the state has displacements and what restores them."""

    check_every: int  # iterations between two looks at the certificate
    state: kernels.SurfaceState
    certificate: Certificate

    @property
    def field(self) -> Samples:
        """Shape of a row."""
        ...

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation."""
        ...

    def advance(self, active: Indices) -> None:
        """Make one iteration in the active rows."""
        ...

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions `[active]`."""
        ...


def begin(batch: Batch, options: Options) -> Iteration:
    """Begin a solver on a batch; raises ValueError for one that cannot do what its displacements and laws ask for."""
    solver = SOLVERS[options.solver]
    asked = *batch.interface.abilities, *(("speed",) if batch.response.lags else ())
    lacks = [ability for ability in asked if ability not in solver.can]
    if lacks:
        raise ValueError(f"the solver {options.solver} knows no {lacks[0]}")
    for path in solver.condensed if batch.response.components == 1 else solver.coupled:
        if ONLY_IN.get(path, len(batch.shape)) == len(batch.shape):
            iteration = _implementation(path)(batch if path in OF_CORNERS else batch.whole, options)
            if iteration is not None:
                return iteration
    raise ValueError(f"the solver {options.solver} follows the normal displacement alone")


@cache
def _implementation(path: str) -> Callable[[Batch, Options], Iteration | None]:
    found: Callable[[Batch, Options], Iteration | None] = resolve_name(path)
    return found


def leave_pressures(solver: Iteration, rows: Indices) -> None:
    """Replace what restores normal displacements by the pressures of the wall, unless the solver has, in ended rows."""
    bears, limits = solver.certificate.bears, solver.certificate.limits
    restored = rows if bears is None else rows[~bears[rows]]
    kernels.wall_pressure(solver.state, limits.hardness, restored, solver.field.n)
