"""From tractions to displacements and back, both components at once: the transforms of a contact with friction."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.coupled_stiffness import CoupledStiffness
from gfmd_numba.fourier.convolution import Convolution


class CoupledProducts:
    """Products of a batch with its coupled stiffness and with the compliance; four transforms a row each.

    Rows of the field are tangential components, then normal ones. A mean displacement that nothing restores, or that
    is rigid, has no stiffness and no compliance here.
    """

    def __init__(self, stiffness: CoupledStiffness, rows: int, n: int, dtype: npt.DTypeLike = np.float64) -> None:
        self.field = Convolution(2 * rows, n, sources=2, dtype=dtype)
        both, self._traction = self.field.sources
        self.tangential, self.displacement = both[:rows], both[rows:]
        self.tangential_restoring, self.restoring = self.field.result[:rows], self.field.result[rows:]
        compliance = stiffness.compliance()
        held = np.where(np.isfinite(stiffness.k33), stiffness.k33, 0.0)
        self._stiffness = [self.field.symbol(k) for k in (stiffness.k11, stiffness.k13, held)]
        self._compliance = [self.field.symbol(s) for s in (compliance.s11, -compliance.s13, compliance.s33)]
        self._rows = rows

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each row."""
        return self.field.n_transforms[: self._rows] + self.field.n_transforms[self._rows :]

    def restore(self, active: Indices) -> None:
        """Fill the restoring tractions of the displacements in the active rows."""
        self._multiply(active, self._stiffness, source=0)

    def deflect(self, i: int, tangential: Reals, pressure: Reals) -> Reals:
        """Displacements (tangential, normal) `[2, n]` of row i under a traction and a pressure `[n]` on the body."""
        n, rows = self.field.n, self._rows
        self._traction[i, :n] = tangential
        np.negative(pressure, out=self._traction[rows + i, :n])
        self._multiply(np.array([i]), self._compliance, source=1)
        return self.field.result[[i, rows + i], :n].astype(np.float64)

    def _multiply(self, active: Indices, elements: list[Reals], source: int) -> None:
        both = np.concatenate((active, active + self._rows))
        self.field.forward(both, source)
        kernels.couple(self.field.spectrum, *elements, active, self._rows)
        self.field.inverse(both)
