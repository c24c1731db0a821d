"""Active-set Newton method for a hard wall that meets a map: exact displacements everywhere, near ones in between."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.fourier.in_place import InPlaceTransform, storage
from gfmd_numba.solvers import map_guess
from gfmd_numba.solvers.certificate import Certificate
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.map_contact import MapContact
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.table import SOLVERS

Rows = npt.NDArray[np.int64]


class MapNewton:
    check_every = 1
    tangential: tuple[Reals, Reals] | None = None

    def __init__(self, batch: Batch, options: Options) -> None:
        punch, rows = batch.punch, len(batch.punch)
        shape, stiffness = punch.shape[1:], batch.normal_stiffness
        memory = storage(rows, shape, punch.dtype)
        self._transforms = [InPlaceTransform(shape, each) for each in memory]
        self.field = self._transforms[0]
        n = self.field.n
        self.wall = punch.reshape(rows, n)
        self.displacement = np.empty((rows, n), dtype=punch.dtype)
        self.restoring = memory.view(punch.dtype).reshape(rows, -1)
        self.load = batch.loads
        self.certificate = Certificate(rows)
        self._stiffness, self._residual = stiffness, options.residual
        self._rigid_mean = not np.isfinite(stiffness[0, 0])
        self._stiffest = float(stiffness[np.isfinite(stiffness)].max())
        # an incompressible slab keeps its volume: below the mean of the punch there is no room for it
        self._impossible = self._rigid_mean & (punch.mean(axis=(1, 2)) < 0.0)
        gives_up = SOLVERS[options.solver].gives_up_after or options.max_iterations
        self._left = np.full(rows, min(options.max_iterations, gives_up))
        self._error, self._coarse = np.zeros((2, rows))
        grids = map_guess.levels(stiffness, shape)
        self._level = grids[0]
        self._contacts = []
        for i, transform in enumerate(self._transforms):
            load = None if batch.load is None else float(batch.load[i])
            softest = stiffness[0, 1] if load is not None or self._rigid_mean else stiffness[0, 0]
            start = load if load is not None else max(-float(softest * punch[i].min()), 0.0)
            self._coarse[i] = map_guess.guess(grids, punch[i], transform, load, start)
            gap = self.displacement[i].reshape(shape)
            self._contacts.append(MapContact(self._level, punch[i], gap, transform, load))

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        made = np.array([each.n_transforms for each in self._transforms])
        return made + np.ceil(self._coarse).astype(np.int64)

    def advance(self, active: Rows) -> None:
        for i in active:
            contact = self._contacts[i]
            if contact.count:
                contact.settle(self._error[i], 0.1 * self._residual)
            self._error[i] = contact.look()
            self._left[i] -= 1

    def residual(self, active: Rows) -> Reals:
        return np.array([self._certified(i) for i in active])

    def _certified(self, i: int) -> float:
        error = float(self._error[i])
        if error > self._residual and self._left[i] > 0:
            return error
        contact, transform, row = self._contacts[i], self._transforms[i], np.array([i])
        kernels.close_map(contact.wall, contact.gap, contact.contact, contact.tiles, transform.rows)
        transform.stiffen(self._stiffness)
        kernels.pack_rows(transform.rows, self.field.shape[1])
        n = self.field.n
        if self._rigid_mean:
            self.load[i] = contact.pressure.sum() / n
        self.certificate.look(self.displacement, self.restoring, self.wall, self.load, row, n)
        if self._rigid_mean:
            drift = self._stiffest * abs(float(self.displacement[i].mean()))
            self.certificate.worst[i] = np.inf if self._impossible[i] else max(self.certificate.worst[i], drift)
        residual = float(self.certificate.residual(self.load, row)[0])
        return np.inf if self._impossible[i] else residual
