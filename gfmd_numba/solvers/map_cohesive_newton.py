"""Truncated Newton method for a cohesive law on maps: all three displacements descend one energy together."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.convolution import Convolution
from gfmd_numba.interface import vector_slip
from gfmd_numba.solvers.cohesive_newton import CohesiveNewton
from gfmd_numba.solvers.iteration import Batch, by_component
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.truncated_newton import TruncatedNewton, starting_displacement

_REACH = 4.0  # lengths of the law across which it acts
_STRIDE = 0.5  # tangential lengths of the law that a node is dragged in one step: past them the law gives way


def cohesive_newton(batch: Batch, options: Options) -> "CohesiveNewton | MapCohesiveNewton":
    """Begin the method for profiles or for maps."""
    return CohesiveNewton(batch, options) if batch.punch.ndim == 2 else MapCohesiveNewton(batch, options)


class MapCohesiveNewton(TruncatedNewton):
    """All displacements of a batch of maps under a law of gap and slip, with or without the hard wall.

    Rows of the field are the displacements of one realisation along x, along y and normal, after those of the other, so
    that the unknowns of a realisation are one row three times as long. The wall bounds normal displacements alone.
    """

    def __init__(self, batch: Batch, options: Options) -> None:
        cohesive = batch.interface.cohesive
        if cohesive is None or batch.interface.friction is not None:
            raise ValueError("this solver of all displacements of maps knows a cohesive law alone")
        rows, shape = len(batch.punch), batch.punch.shape[1:]
        self._cohesive = cohesive
        dtype = batch.punch.dtype
        self._sliding = np.broadcast_to(batch.sliding, (2, *shape)).reshape(2, -1).astype(dtype, copy=False)
        self.field = Convolution(3 * rows, *shape, dtype=dtype)
        n = self.field.n
        response = self._with_held_mean(batch)
        compliance = response.inverse()
        diagonal = response.diagonal.reshape(3, -1)
        for element, k in zip((0, 2, 5), diagonal, strict=True):
            if not k[0] > 0.0:  # a mean that moves freely is as stiff as contact makes it
                compliance[element, 0, 0] = 1.0 / k[1:].min()
        self._stiffness_elements = np.array([self.field.symbol(k) for k in response.elements])
        self._compliance_elements = np.array([self.field.symbol(s) for s in compliance])
        share = grid.multiplicity(shape[-1]) / n
        self._node_compliance = float((compliance[[0, 2, 5]] * share).sum() / 3.0)
        self._stiffest = float(diagonal.sum(axis=0).max()) + batch.law_stiffness()  # no mode is stiffer than the trace
        (every,), length = self.field.sources, self.field.result.shape[1]
        self._source, self._result = every.reshape(rows, -1), self.field.result.reshape(rows, -1)
        self._x, self._y = slice(0, n), slice(length, length + n)
        self._together = np.zeros((3, n))
        self._u = np.zeros_like(self._source)
        self._u[:, self._x], self._u[:, self._y] = by_component(batch.start.tangential, n).reshape(2, rows, n)
        own = slice(2 * length, 2 * length + n)
        self._u[:, own] = starting_displacement(batch, lambda gap: cohesive.normal_traction(gap, np.zeros(n)))
        self._nowhere = np.broadcast_to(np.nan, (2 * rows, n))
        self._begin(batch, options, own, cohesive.normal)

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation."""
        return np.asarray(self.field.n_transforms.reshape(-1, 3).sum(axis=1))

    @property
    def tangential(self) -> tuple[Reals, Reals, Reals]:
        """Tangential displacement of the body, the traction that restores it, and that no node slips from anywhere."""
        return self._by_component(self._u), self._by_component(self._restoring), self._nowhere

    def _by_component(self, unknowns: Reals) -> Reals:
        return np.concatenate((unknowns[:, self._x], unknowns[:, self._y]))

    def _both(self, unknowns: Reals) -> Reals:
        """Return the tangential part `[component, node]` of the unknowns of a row."""
        return np.stack((unknowns[self._x], unknowns[self._y]))

    def _stiffen(self, row: Indices) -> None:
        self._multiply(row, self._stiffness_elements)

    def _comply(self, row: Indices) -> None:
        self._multiply(row, self._compliance_elements)

    def _multiply(self, row: Indices, elements: Reals) -> None:
        every = 3 * row[0] + np.arange(3)
        self.field.forward(every)
        kernels.couple(self.field.spectrum, elements, every[:1], 1)
        self.field.inverse(every)

    def _slip(self, i: int) -> Reals:
        return np.asarray(self._sliding - self._both(self._u[i]))

    def _pull(self, i: int) -> Reals:
        gap, slip = self._gap(i), self._slip(i)
        self._closing[self._normal] = self._cohesive.normal_traction(gap, vector_slip.length(slip))
        drag = vector_slip.tangential_traction(self._cohesive, gap, slip)
        self._closing[self._x], self._closing[self._y] = drag
        return self._closing

    def _fill_curvature(self, i: int) -> None:
        xx, xy, yy, xz, yz, zz = vector_slip.stiffness(self._cohesive, self._gap(i), self._slip(i))
        self._curvature[self._x], self._curvature[self._y], self._curvature[self._normal] = xx, yy, zz
        self._together[:] = xy, xz, yz

    def _add_coupling(self, i: int) -> float:
        xy, xz, yz = self._together
        p, result = self._conjugate, self._result[i]
        x, y, z = p[self._x], p[self._y], p[self._normal]
        result[self._x] += xy * y + xz * z
        result[self._y] += xy * x + yz * z
        result[self._normal] += xz * x + yz * y
        return 2.0 * float((xy * x * y + xz * x * z + yz * y * z).sum())

    def _change(self, i: int) -> float:
        closing, dragged = self._closing[self._normal], self._both(self._closing)
        change = vector_slip.energy_change(self._cohesive, self._gap(i), self._slip(i), closing, dragged)
        return float(change.sum(dtype=np.float64))

    def _longest(self, i: int) -> float:
        near, tangential = self._gap(i) < _REACH * self._cohesive.normal, self._cohesive.tangential
        allowed = np.maximum(vector_slip.length(self._slip(i))[near] / tangential - _REACH, _STRIDE)
        dragged = vector_slip.length(self._both(self._direction))[near] / tangential
        return float(1.0 / max(1.0, (dragged / allowed).max(initial=0.0)))

    def _look_at_more(self, active: Indices) -> None:
        for i in active:
            unbalanced = vector_slip.length(self._both(self._restoring[i])).max()
            self.certificate.worst[i] = max(self.certificate.worst[i], unbalanced)
