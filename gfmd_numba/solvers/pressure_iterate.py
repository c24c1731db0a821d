"""What the solvers that iterate on the pressure share: pressure, gap and certificate of profiles or maps, flat."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier.transform import Transform, aligned_rows
from gfmd_numba.solvers.certificate import Certificate, RigidMean
from gfmd_numba.solvers.iteration import Batch


class PressureIterate:
    """Pressure of a batch, the gap it leaves and the certificate of both; the pressure begins uniform.

    Where the displacement of the punch is prescribed, the stiffness at q = 0 may be infinite (an incompressible slab).
    """

    def __init__(self, batch: Batch) -> None:
        rows, shape = len(batch.punch), batch.punch.shape[1:]
        punch, stiffness = batch.punch.reshape(rows, -1), batch.response.normal.ravel()
        self.free_mean = batch.load is not None
        rigid_mean = RigidMean.of(punch, batch.response)
        self.field = Transform(rows, *shape, sources=3, dtype=punch.dtype)
        n = self.field.n
        self.pressure, self.direction, self.displacement = self.field.sources
        self.wall = aligned_rows(rows, n, punch.dtype)
        self.wall[:, :n] = punch
        softest = stiffness[1] if self.free_mean or rigid_mean else stiffness[0]
        start = softest * np.maximum(-punch.min(axis=1), 0.0) if batch.load is None else batch.load
        self.load = batch.loads
        hardness = np.inf if batch.interface.hardness is None else batch.interface.hardness
        self.hardness = float(np.asarray(hardness, dtype=punch.dtype))
        # between its bounds, where every node is free to move
        if batch.load is None:
            start = np.minimum(start, 0.5 * self.hardness)
        self.pressure[:, :n] = start[:, np.newaxis]
        with np.errstate(divide="ignore"):
            compliance = np.where(stiffness > 0.0, 1.0 / stiffness, 0.0)
        self.compliance = self.field.symbol(compliance)
        self._stiffness = self.field.symbol(np.where(np.isfinite(stiffness), stiffness, 0.0))
        self.gap = aligned_rows(rows, n, punch.dtype)
        self.iterate = kernels.Iterate(self.pressure, self.gap, self.direction, self.field.result)
        self.rows = [kernels.Iterate(*row) for row in zip(*self.iterate, strict=True)]
        self.state = kernels.State.of_normal(self.displacement, self.field.result, self.wall, self.load)
        self.certificate = Certificate(rows, kernels.Conditions(self.hardness), rigid_mean)
        self.rounding = np.finfo(punch.dtype).eps * np.ptp(punch, axis=1)

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation."""
        return self.field.n_transforms

    def violation(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions by the nearest displacement that penetrates plastic nodes alone.

        Leaves it and its restoring traction in the state; costs two transforms a row.
        """
        field, n = self.field, self.field.n
        kernels.close_gap(self.pressure, self.gap, self.wall, active, n, self.displacement, self.hardness)
        field.apply(self._stiffness, active, source=2)
        if self.certificate.rigid_mean is not None:  # the mean pressure is the multiplier of a zero mean
            self.load[active] = self.pressure[active, :n].mean(axis=1)
        self.certificate.look(self.state, active, n)
        return self.certificate.residual(self.load, active)
