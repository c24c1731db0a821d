"""From tractions to displacements of a map and back, all three components at once."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.map_stiffness import MapStiffness
from gfmd_numba.fourier.convolution import Convolution


class MapProducts:
    """Products of a batch of maps with its stiffness and with the compliance; six transforms a row each.

    Rows of the field are the components along x, then those along y, then the normal ones. A mean displacement that
    nothing restores, or that is rigid, has no stiffness and no compliance here.
    """

    def __init__(
        self, stiffness: MapStiffness, rows: int, shape: tuple[int, ...], dtype: npt.DTypeLike = np.float64
    ) -> None:
        self.field = Convolution(3 * rows, *shape, sources=2, dtype=dtype)
        both, self._traction = self.field.sources
        self.tangential, self.displacement = both[:-rows], both[-rows:]
        self.tangential_restoring, self.restoring = self.field.result[:-rows], self.field.result[-rows:]
        self._compliance = [self.field.symbol(element) for element in stiffness.compliance()]
        held = np.where(np.isfinite(stiffness.elements), stiffness.elements, 0.0)
        self._stiffness = [self.field.symbol(element) for element in held]
        self._rows = rows

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each row."""
        return np.asarray(self.field.n_transforms.reshape(3, self._rows).sum(axis=0))

    def restore(self, active: Indices) -> None:
        """Fill the restoring tractions of the displacements in the active rows."""
        self._multiply(active, self._stiffness, source=0)

    def deflect(self, i: int, traction: Reals) -> Reals:
        """Displacements (x, y, z) `[3, n]` of row i under tractions `[3, n]` on the body."""
        n, rows = self.field.n, self._rows
        own = [i, rows + i, 2 * rows + i]
        self._traction[own, :n] = traction
        self._multiply(np.array([i]), self._compliance, source=1)
        return np.asarray(self.field.result[own, :n], dtype=np.float64)

    def _multiply(self, active: Indices, elements: list[Reals], source: int) -> None:
        every = np.concatenate([active + k * self._rows for k in range(3)])
        self.field.forward(every, source)
        kernels.couple_map(self.field.spectrum, *elements, active, self._rows)
        self.field.inverse(every)
