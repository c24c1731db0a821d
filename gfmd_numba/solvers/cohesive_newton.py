"""Truncated Newton method for a cohesive law: all displacements descend one energy together."""

from functools import reduce

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.spectral_response import diagonal
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.interface import vector_slip
from gfmd_numba.solvers.iteration import Batch, by_component
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.preconditioners.parallel_law import ParallelLaw
from gfmd_numba.solvers.truncated_newton import TruncatedNewton, starting_displacement

_REACH = 4.0  # lengths of the law across which it acts
_STRIDE = 0.5  # tangential lengths of the law that a node is dragged in one step: past them the law gives way


class CohesiveNewton(TruncatedNewton):
    """All displacements of a batch under a law of gap and slip, with or without the hard wall.

    Rows of the field are the tangential displacements of one realisation and its normal one after those of the other,
    so that the unknowns of a realisation are one row two or three times as long. The wall bounds normal displacements
    alone. The preconditioner is the compliance of the bodies or, where it is a sum of decays, has body and law of each
    component alone in parallel and takes no transforms.
    """

    def __init__(self, batch: Batch, options: Options) -> None:
        cohesive = batch.interface.cohesive
        if cohesive is None or batch.interface.friction is not None:
            raise ValueError("this solver of all displacements knows a cohesive law alone")
        rows, *shape = batch.punch.shape
        response, ways, dtype = self._with_held_mean(batch), len(shape), batch.punch.dtype
        self._cohesive, self._components = cohesive, response.components
        self.field = Transform(self._components * rows, *shape, dtype=dtype)
        n = self.field.n
        self._sliding = np.broadcast_to(batch.sliding, (ways, *shape)).reshape(ways, n).astype(dtype, copy=False)
        compliance = response.restored().inverse()
        self._stiffness_elements = np.array([self.field.symbol(k) for k in response.elements])
        self._compliance_elements = np.array([self.field.symbol(s) for s in compliance])
        share, of_each = grid.multiplicity(shape[-1]) / n, diagonal(compliance)
        self._node_compliance = float((of_each.sum(axis=0) * share).sum() / self._components)
        no_less = float(response.diagonal.sum(axis=0).max())  # than the stiffness of any mode: it is the trace
        self._stiffest = no_less + batch.law_stiffness()
        (every,), length = self.field.sources, self.field.result.shape[1]
        self._source, self._result = every.reshape(rows, -1), self.field.result.reshape(rows, -1)
        self._u = np.zeros_like(self._source)
        own = slice(ways * length, ways * length + n)
        dragged = batch.start.tangential + batch.start.dragged  # a slip made by the step itself would end bonds
        self._u.reshape(rows, -1, length)[:, :-1, :n] = dragged.reshape(rows, ways, n)
        self._u[:, own] = starting_displacement(batch, lambda gap: cohesive.normal_traction(gap, np.zeros(n)))
        self._pairs = [(i, j) for i in range(self._components) for j in range(i + 1)]
        self._together: list[tuple[int, int, Reals]] = []
        self._parallel = ParallelLaw.of(of_each, n, length)
        self._nowhere = np.broadcast_to(np.nan, (ways * rows, n))
        self._begin(batch, options, own, cohesive.normal)

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation."""
        return np.asarray(self.field.n_transforms.reshape(-1, self._components).sum(axis=1))

    @property
    def tangential(self) -> tuple[Reals, Reals, Reals]:
        """Tangential displacement of the body, the traction that restores it, and that no node slips from anywhere."""
        rows, length = len(self._u), self.field.result.shape[1]
        both = (each.reshape(rows, -1, length)[:, :-1] for each in (self._u, self._restoring))
        u, restoring = (by_component(each, length) for each in both)
        return u, restoring, self._nowhere

    def _of_each(self, unknowns: Reals) -> Reals:
        """Return the unknowns of a row by `[component, node]`, to be read or written."""
        return unknowns.reshape(self._components, -1)[:, : self.field.n]

    def _stiffen(self, row: Indices) -> None:
        self._multiply(row, self._stiffness_elements)

    def _split(self, i: int) -> None:
        if self._parallel is None:
            return
        np.greater(self._weight, 0.0, out=self._weight)
        self._source[i] = self._unbalanced
        self._parallel.factor(self._curvature, self._weight)

    def _comply(self, row: Indices) -> None:
        if self._parallel is None:
            self._multiply(row, self._compliance_elements)
        else:
            self._parallel.solve(self._source[row[0]], self._result[row[0]])

    def _multiply(self, row: Indices, elements: Reals) -> None:
        every = self._components * row[0] + np.arange(self._components)
        self.field.forward(every)
        kernels.couple(self.field.spectrum, elements, every[:1], 1)
        self.field.inverse(every)

    def _slip(self, i: int) -> Reals:
        return np.asarray(self._sliding - self._of_each(self._u[i])[:-1])

    def _pull(self, i: int) -> Reals:
        gap, slip = self._gap(i), self._slip(i)
        closing = self._of_each(self._closing)
        closing[-1] = self._cohesive.normal_traction(gap, vector_slip.length(slip))
        closing[:-1] = vector_slip.tangential_traction(self._cohesive, gap, slip)
        return self._closing

    def _fill_curvature(self, i: int) -> None:
        curvature = self._of_each(self._curvature)
        elements = vector_slip.stiffness(self._cohesive, self._gap(i), self._slip(i))
        every = [(*pair, k) for pair, k in zip(self._pairs, elements, strict=True)]
        self._together = [(a, b, k) for a, b, k in every if a != b]
        for a, b, k in every:
            if a == b:
                curvature[a] = k

    def _add_coupling(self, i: int) -> float:
        p, result = self._of_each(self._conjugate), self._of_each(self._result[i])
        pulled: dict[int, Reals] = {}
        energies = []
        for a, b, k in self._together:
            forces = {a: k * p[b], b: k * p[a]}
            energies.append(forces[a] * p[a])
            for component, force in forces.items():
                pulled[component] = pulled[component] + force if component in pulled else force
        for component, force in pulled.items():
            result[component] += force
        return 2.0 * float(np.sum(reduce(np.add, energies)))

    def _change(self, i: int) -> float:
        closing = self._of_each(self._closing)
        change = vector_slip.energy_change(self._cohesive, self._gap(i), self._slip(i), closing[-1], closing[:-1])
        return float(change.sum(dtype=np.float64))

    def _longest(self, i: int) -> float:
        near, tangential = self._gap(i) < _REACH * self._cohesive.normal, self._cohesive.tangential
        allowed = np.maximum(vector_slip.length(self._slip(i))[near] / tangential - _REACH, _STRIDE)
        dragged = vector_slip.length(self._of_each(self._direction)[:-1])[near] / tangential
        return float(1.0 / max(1.0, (dragged / allowed).max(initial=0.0)))

    def _look_at_more(self, active: Indices) -> None:
        for i in active:
            unbalanced = vector_slip.length(self._of_each(self._restoring[i])[:-1]).max()
            self.certificate.worst[i] = max(self.certificate.worst[i], unbalanced)
