"""Active-set Newton method for a hard wall that meets maps: exact displacements now and then, near ones in between."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier.transform import Transform
from gfmd_numba.solvers import map_guess
from gfmd_numba.solvers.certificate import Certificate, RigidMean
from gfmd_numba.solvers.iteration import Batch
from gfmd_numba.solvers.map_contact import MapContact
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.split_compliance import fits
from gfmd_numba.solvers.table import SOLVERS

_AHEAD = 0.1  # error of the pressure aimed at, over the residual asked for


def map_newton(batch: Batch, options: Options) -> "MapNewton | None":
    """Begin on maps that tiles cover."""
    return MapNewton(batch, options) if fits(batch.punch.shape[1:]) else None


class MapNewton:
    """Pressures of a batch of maps, each found by guessing its contact, as in `active_set_newton.py`.

    An iteration closes the gap on the tiles of the map that the contact may reach, by a compliance between them that
    is nearly right, and then finds the exact gap everywhere: two transforms of the map, which leave about a hundredth
    of the error. Where tiles are too many to gain from that, the exact compliance closes the gap. The first guess comes
    from a cascade of coarser grids. The certificate costs two transforms more, and is looked at once the error of the
    pressure is that small; until then `residual` is that error.

    Of the size of the map are the displacement, which is the gap until the certificate needs it, and the memory of the
    transform, which is the restoring traction afterwards; pressures live on tiles.
    """

    check_every = 1

    def __init__(self, batch: Batch, options: Options) -> None:
        punch, stiffness = batch.punch, batch.response.normal
        rows, shape = len(punch), punch.shape[1:]
        self.field = Transform(rows, *shape, dtype=punch.dtype, in_place=True)
        self.wall = punch.reshape(rows, self.field.n)
        self.displacement = np.empty((rows, self.field.n), dtype=punch.dtype)
        self.load = batch.loads
        self.state = kernels.State.of_normal(self.displacement, self.field.result, self.wall, self.load)
        rigid_mean = RigidMean.of(punch, batch.response)
        self.certificate = Certificate(rows, batch.interface.conditions, rigid_mean)
        self._stiffness, self._residual = stiffness, options.residual
        # the certificate of the last iteration is looked at whatever the error
        self._left = np.full(rows, min(options.max_iterations, SOLVERS[options.solver].gives_up_after or np.inf))
        self._error = np.full(rows, np.nan)
        self._coarse_transforms = np.zeros(rows)
        grids = map_guess.levels(stiffness, shape)
        self._contacts: list[MapContact] = []
        for i in range(rows):
            transform = self.field.row(i)
            load = None if batch.load is None else float(batch.load[i])
            softest = stiffness[0, 1] if rigid_mean else stiffness[0, 0]
            start = max(-float(softest * punch[i].min()), 0.0) if load is None else load
            self._coarse_transforms[i] = map_guess.guess(grids, punch[i], transform, load, start)
            gap = self.displacement[i].reshape(shape)
            self._contacts.append(MapContact(grids[0], punch[i], gap, transform, load))

    @property
    def n_transforms(self) -> npt.NDArray[np.int64]:
        """Transforms made so far for each realisation, those of coarser grids in proportion to their cost."""
        others = self._coarse_transforms + np.array([contact.coarse_transforms for contact in self._contacts])
        return np.asarray(self.field.n_transforms + np.ceil(others).astype(np.int64))

    def advance(self, active: Indices) -> None:
        """Close the gap of each active row as it is known, and find the exact one."""
        for i in active:
            contact = self._contacts[i]
            if not np.isnan(self._error[i]):
                contact.settle(self._error[i], _AHEAD * self._residual)
            self._error[i] = contact.look()
            self._left[i] -= 1

    def residual(self, active: Indices) -> Reals:
        """Relative violation of the contact conditions, or the error of a pressure too far off to look at that."""
        return np.array([self._violation(i) for i in active])

    def _violation(self, i: int) -> float:
        error = float(self._error[i])
        if error > self._residual and self._left[i] > 0:
            return error
        contact, row, n = self._contacts[i], np.array([i]), self.field.n
        kernels.close_map(contact.wall, contact.gap, contact.contact, contact.tiles, contact.rows)
        contact.transform.stiffen(self._stiffness)
        kernels.pack_rows(contact.rows, self.field.shape[1])
        if self.certificate.rigid_mean is not None:  # the mean pressure is the multiplier of a zero mean
            self.load[i] = contact.pressure.sum() / n
        self.certificate.look(self.state, row, n)
        return float(self.certificate.residual(self.load, row)[0])
