"""Damped dynamics of normal and tangential displacements together, with sticking or Coulomb friction (thesis 2.4)."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier.transform import Transform, aligned_rows
from gfmd_numba.interface import vector_slip
from gfmd_numba.solvers.certificate import Certificate
from gfmd_numba.solvers.iteration import Batch, by_component
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.truncated_newton import starting_displacement
from gfmd_numba.theory.damping import critical_damping, stability_limit


class CoupledDynamics:
    """All displacements of a batch and the tractions that restore them; a transform pair of each a step.

    Rows of the field are tangential displacements, on maps first along x and then along y, then normal ones. `anchor`
    is where the punch holds a node that touched it before, not-a-number for the others; `sliding` the tangential
    displacement of the punch over each node.
    """

    check_every = 10

    def __init__(self, batch: Batch, options: Options) -> None:
        punch, response, interface, start = batch.punch, batch.response, batch.interface, batch.start
        rows, shape = len(punch), punch.shape[1:]
        self._rows, self._components = rows, response.components
        self._friction = interface.friction or 0.0
        self._law = interface.normal_law
        self._cohesion = interface.cohesive
        self.certificate = Certificate(rows)
        self.load = batch.loads
        self.field = Transform(self._components * rows, *shape, dtype=punch.dtype)
        n, ways = self.field.n, len(shape)
        if self._cohesion is not None:
            sliding = np.broadcast_to(batch.sliding, (ways, *shape)).reshape(ways, n)
            self._sliding = np.ascontiguousarray(sliding, dtype=punch.dtype)
        self._punch = aligned_rows(rows, n, punch.dtype)
        self._punch[:, :n] = punch.reshape(rows, n)
        self.wall = self._punch if interface.hard_wall else np.full_like(self._punch, np.inf)
        (both,) = self.field.sources
        self._tangential, self.displacement = both[:-rows], both[-rows:]
        self._tangential[:, :n] = by_component(start.tangential, n)
        self.displacement[:, :n] = self._without_overlap(batch).reshape(rows, n)
        self._last = both.copy()
        self._anchor = np.full_like(self._tangential, np.nan)
        self._anchor[:, :n] = by_component(start.anchor, n)
        self._tangential_restoring, self.restoring = self.field.result[:-rows], self.field.result[-rows:]
        self._state = kernels.CoupledState(
            self._tangential, self._anchor, self._tangential_restoring, self.displacement, self.restoring, self.wall,
            self.load,
        )  # fmt: skip
        self._elements = np.array([self.field.symbol(k) for k in response.elements])
        softest, stiffest = response.extremes()
        stiffest += batch.law_stiffness()
        time_step, damping = options.number("time_step"), options.number("damping")
        dt = time_step * stability_limit(softest, stiffest, damping)
        self._push = dt * dt
        self._memory = 1.0 - damping * critical_damping(softest, dt) * dt * dt
        self._restore(np.arange(rows))

    @property
    def tangential(self) -> tuple[Reals, Reals, Reals]:
        """Tangential displacement of the body, the traction that restores it, and from where it slips."""
        return self._tangential, self._tangential_restoring, self._anchor

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation."""
        return np.asarray(self.field.n_transforms.reshape(self._components, self._rows).sum(axis=0))

    def advance(self, active: Indices) -> None:
        """Make one time step in the active rows."""
        last_tangential, last_normal = self._last[: -self._rows], self._last[-self._rows :]
        kernels.coupled_step(
            self._state, last_tangential, last_normal, self._friction, active, self.field.n, self._memory, self._push
        )
        self._restore(active)

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the normal and tangential conditions `[active]`; costs no transform."""
        n, certificate = self.field.n, self.certificate
        certificate.look(kernels.State(self.displacement, self.restoring, self.wall, self.load), active, n)
        kernels.friction_violation(self._state, self._friction, active, n, certificate.worst)
        return certificate.residual(self.load, active, self._strongest(active))

    def _strongest(self, active: Indices) -> Reals:
        """Largest traction of a law on each active row."""
        n = self.field.n
        gap, strongest = self._punch[active, :n] - self.displacement[active, :n], np.zeros(active.size)
        tractions: list[Reals] = []
        if self._law is not None:
            tractions.append(self._law.traction(gap))
        if self._cohesion is not None:
            slip = self._slip(active)
            with np.errstate(over="ignore", invalid="ignore"):  # of a run that diverges, as its status says
                tractions += [self._cohesion.normal_traction(gap, slip), self._cohesion.tangential_traction(gap, slip)]
        for traction in tractions:
            strongest = np.maximum(strongest, np.abs(traction).max(axis=1))
        return strongest

    def _without_overlap(self, batch: Batch) -> Reals:
        """Normal displacement to begin with: not beyond a wall, nor where the law repels by more than any pressure."""
        if batch.interface.hard_wall or self._cohesion is None:
            return np.minimum(batch.start.displacement, batch.punch)
        law, none = self._cohesion, np.zeros(batch.punch[0].size)
        return starting_displacement(batch, lambda gap: law.normal_traction(gap, none))

    def _slip(self, active: Indices) -> Reals:
        """Length of the slip of the punch over each node of the active rows."""
        n = self.field.n
        tangential = self._tangential[:, :n].reshape(-1, self._rows, n)
        return vector_slip.length(self._sliding[:, np.newaxis] - tangential[:, active])

    def _restore(self, active: Indices) -> None:
        every = np.concatenate([active + i * self._rows for i in range(self._components)])
        self.field.forward(every)
        kernels.couple(self.field.spectrum, self._elements, active, self._rows)
        self.field.inverse(every)
        if self._law is not None:
            self._law.pull(self.displacement, self.restoring, self._punch, active, self.field.n)
        if self._cohesion is not None:
            self._cohesion.pull(self._state, self._punch, tuple(self._sliding), active, self.field.n)
