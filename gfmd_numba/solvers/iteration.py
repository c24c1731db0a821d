"""What a solver is given, and what is asked of it: the same of every solver."""

from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.certificate import Certificate

HARD_WALL = Interactions(hard_wall=True)


def tangential_shape(punch: Reals) -> tuple[int, ...]:
    """Shape `[realisation, component, (y,) x]` of tangential quantities under punches, along x and on maps along y."""
    return len(punch), len(punch.shape) - 1, *punch.shape[1:]


def by_component(tangential: Reals, n: int) -> Reals:
    """Tangential quantity of that shape as flat rows of n nodes, on maps the x components and then the y components."""
    return np.asarray(tangential.swapaxes(0, 1).reshape(-1, n))


@dataclass(frozen=True)
class Start:
    """What a batch begins with `[realisation, (y,) x]`: displacements, and where the punch holds nodes it touched.

    Tangential quantities have the `tangential_shape`. The `anchor` is one of them, and not-a-number for nodes that did
    not touch. `dragged` is how far the punch has moved sideways since, ready to broadcast with `[component, (y,) x]`.
    """

    displacement: Reals
    tangential: Reals
    anchor: Reals
    dragged: Reals | float = 0.0

    @classmethod
    def at_rest(cls, punch: Reals) -> Self:
        """The undeformed body, pushed back where the punch penetrates it."""
        shape = tangential_shape(punch)
        return cls(np.minimum(punch, 0.0), np.broadcast_to(0.0, shape), np.broadcast_to(np.nan, shape))

    def rows(self, some: slice | Indices) -> "Start":
        """Start of some rows alone."""
        return Start(self.displacement[some], self.tangential[some], self.anchor[some], self.dragged)


@dataclass(frozen=True)
class Batch:
    """Elastic bodies under rigid punches `[realisation, (y,) x]` (L_x, E*), as a solver is given them.

    `response` is that of the normal displacement alone or of all; `load` the mean pressure `[realisation]`, which
    nothing else holds, or None where the position of the punch prescribes the displacement. `sliding` is the tangential
    displacement of the punch, ready to broadcast with `[component, (y,) x]`, with a cohesive law less what else moves
    each node. `largest_pressure` is what no pressure is expected to exceed.
    """

    punch: Reals
    response: SpectralResponse
    load: Reals | None
    interface: Interactions
    start: Start
    sliding: Reals | float = 0.0
    largest_pressure: float = np.inf

    @property
    def loads(self) -> Reals:
        """Mean pressure `[realisation]` that pushes the body, 0 where the displacement is prescribed."""
        return np.zeros(len(self.punch)) if self.load is None else self.load

    def law_stiffness(self) -> float:
        """Bound of the stiffness that the laws add to that of the bodies."""
        laws = (self.interface.normal_law, self.interface.cohesive)
        return sum(law.stiffest(self.largest_pressure, self.interface.hard_wall) for law in laws if law is not None)


class Samples(Protocol):
    """What is known of the transforms of a solver: how many nodes a row has, and their shape."""

    n: int
    shape: tuple[int, ...]


class Iteration(Protocol):
    """A solver at work on a batch: after `residual`, `restoring` is the traction of `displacement`, flat rows both."""

    check_every: int  # iterations between two looks at the certificate
    displacement: Reals
    restoring: Reals
    wall: Reals
    load: Reals
    certificate: Certificate

    @property
    def field(self) -> Samples:
        """Shape of a row."""
        ...

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation."""
        ...

    @property
    def tangential(self) -> tuple[Reals, Reals, Reals] | None:
        """Tangential displacement, the traction that restores it, and from where it slips, all flat rows.

        On maps rows are the x components, then the y components. None where only the normal one is followed.
        """
        ...

    def advance(self, active: Indices) -> None:
        """Make one iteration in the active rows."""
        ...

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions `[active]`."""
        ...
