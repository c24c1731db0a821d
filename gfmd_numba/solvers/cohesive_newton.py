"""Truncated Newton method for a cohesive law: both displacements of a profile descend one energy together."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.convolution import Convolution
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.preconditioners.parallel_law import ParallelLaw
from gfmd_numba.solvers.truncated_newton import TruncatedNewton, starting_displacement

_REACH = 4.0  # lengths of the law across which it acts
_STRIDE = 0.5  # tangential lengths of the law that a node is dragged in one step: past them the law gives way


class CohesiveNewton(TruncatedNewton):
    """Both displacements of a batch under a law of gap and slip, with or without the hard wall.

    Rows of the field are the tangential and the normal displacement of one realisation after those of the other, so
    that the unknowns of a realisation are one row twice as long. The wall bounds normal displacements alone. The
    preconditioner has body and law in parallel for each component alone; with a sum of decays it takes no transforms.
    """

    def __init__(self, batch: Batch, options: Options) -> None:
        cohesive = batch.interface.cohesive
        if cohesive is None or batch.interface.friction is not None:
            raise ValueError("this solver of both displacements knows a cohesive law alone")
        rows, n = batch.punch.shape
        self._cohesive, self._sliding = cohesive, batch.sliding
        self.field = Convolution(2 * rows, n, dtype=batch.punch.dtype)
        response = self._with_held_mean(batch)
        compliance = response.inverse()
        for s, k in zip(compliance[::2], response.diagonal, strict=True):
            if not k[0] > 0.0:  # a mean that moves freely is as stiff as contact makes it
                s[0] = 1.0 / k[1:].min()
        self._stiffness_elements = np.array([self.field.symbol(k) for k in response.elements])
        self._compliance_elements = np.array([self.field.symbol(s) for s in compliance])
        share = grid.multiplicity(n) / n
        self._node_compliance = float(0.5 * ((compliance[0] + compliance[2]) * share).sum())
        self._stiffest = response.extremes()[1] + batch.law_stiffness()
        (both,), length = self.field.sources, self.field.result.shape[1]
        self._source, self._result = both.reshape(rows, -1), self.field.result.reshape(rows, -1)
        self._sideways, self._together = slice(0, n), np.zeros(n)
        self._u = np.zeros_like(self._source)
        self._u[:, :n] = batch.start.tangential + batch.start.dragged  # a slip made by the step itself would end bonds
        self._u[:, length : length + n] = starting_displacement(
            batch, lambda gap: cohesive.normal_traction(gap, np.zeros(n))
        )
        self._parallel = ParallelLaw((compliance[0], compliance[2]), n, length)
        self._nowhere = np.broadcast_to(np.nan, (rows, n))
        self._begin(batch, options, slice(length, length + n), cohesive.normal)

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation."""
        return self.field.n_transforms[0::2] + self.field.n_transforms[1::2]

    @property
    def tangential(self) -> tuple[Reals, Reals, Reals]:
        """Tangential displacement of the body, the traction that restores it, and that no node slips from anywhere."""
        return self._u, self._restoring, self._nowhere

    def _stiffen(self, row: Indices) -> None:
        self._multiply(row, self._stiffness_elements)

    def _split(self, i: int) -> None:
        if not self._parallel.is_safe:
            return
        np.greater(self._weight, 0.0, out=self._weight)
        self._source[i] = self._unbalanced
        self._parallel.factor(self._curvature, self._weight)

    def _comply(self, row: Indices) -> None:
        if self._parallel.is_safe:
            self._parallel.solve(self._source[row[0]], self._result[row[0]])
        else:
            self._multiply(row, self._compliance_elements)

    def _multiply(self, row: Indices, elements: Reals) -> None:
        both = np.array([2 * row[0], 2 * row[0] + 1])
        self.field.forward(both)
        kernels.couple(self.field.spectrum, elements, both[:1], 1)
        self.field.inverse(both)

    def _slip(self, i: int) -> Reals:
        return np.asarray(self._sliding - self._u[i, self._sideways])

    def _pull(self, i: int) -> Reals:
        gap, slip = self._gap(i), self._slip(i)
        self._closing[self._normal] = self._cohesive.normal_traction(gap, slip)
        self._closing[self._sideways] = self._cohesive.tangential_traction(gap, slip)
        return self._closing

    def _fill_curvature(self, i: int) -> None:
        tangential, self._together, normal = self._cohesive.stiffness(self._gap(i), self._slip(i))
        self._curvature[self._sideways], self._curvature[self._normal] = tangential, normal

    def _add_coupling(self, i: int) -> float:
        sideways, normal = self._conjugate[self._sideways], self._conjugate[self._normal]
        self._result[i, self._sideways] += self._together * normal
        self._result[i, self._normal] += self._together * sideways
        return 2.0 * float(np.sum(sideways * self._together * normal))

    def _change(self, i: int) -> float:
        closing, dragged = self._closing[self._normal], self._closing[self._sideways]
        return float(self._cohesive.energy_change(self._gap(i), self._slip(i), closing, dragged).sum(dtype=np.float64))

    def _longest(self, i: int) -> float:
        near = self._gap(i) < _REACH * self._cohesive.normal
        allowed = np.maximum(np.abs(self._slip(i)[near]) / self._cohesive.tangential - _REACH, _STRIDE)
        dragged = np.abs(self._direction[self._sideways][near]) / self._cohesive.tangential
        return float(1.0 / max(1.0, (dragged / allowed).max(initial=0.0)))

    def _look_at_more(self, active: Indices) -> None:
        unbalanced = np.abs(self._restoring[active, self._sideways]).max(axis=1)
        self.certificate.worst[active] = np.maximum(self.certificate.worst[active], unbalanced)
