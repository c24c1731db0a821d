"""From tractions to displacements and back, all components at once: the transforms of a contact with friction."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier.transform import Transform


class CoupledProducts:
    """Products of a batch with its stiffness and with the compliance; two transforms a component and row each.

    Rows of the field are tangential components, on maps along x and then along y, then normal ones. A mean displacement
    that nothing restores, or that is rigid, has no stiffness and no compliance here.
    """

    def __init__(
        self, response: SpectralResponse, rows: int, shape: tuple[int, ...], dtype: npt.DTypeLike = np.float64
    ) -> None:
        self._components = response.components
        self.field = Transform(self._components * rows, *shape, sources=2, dtype=dtype)
        every, self._traction = self.field.sources
        self.tangential, self.displacement = every[:-rows], every[-rows:]
        self.tangential_restoring, self.restoring = self.field.result[:-rows], self.field.result[-rows:]
        held = (np.where(np.isfinite(element), element, 0.0) for element in response.elements)
        self._stiffness = np.array([self.field.symbol(element) for element in held])
        self._compliance = np.array([self.field.symbol(element) for element in response.inverse()])
        self._rows = rows

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each row."""
        return np.asarray(self.field.n_transforms.reshape(self._components, self._rows).sum(axis=0))

    def restore(self, active: Indices) -> None:
        """Fill the restoring tractions of the displacements in the active rows."""
        self._multiply(active, self._stiffness, source=0)

    def deflect(self, i: int, traction: Reals) -> Reals:
        """Displacements `[component, n]` of row i under tangential tractions and a pressure `[component, n]`."""
        n, own = self.field.n, slice(i, None, self._rows)
        self._traction[own, :n] = traction
        np.negative(traction[-1], out=self._traction[-self._rows + i, :n])
        self._multiply(np.array([i]), self._compliance, source=1)
        return np.array(self.field.result[own, :n], dtype=np.float64)

    def _multiply(self, active: Indices, elements: Reals, source: int) -> None:
        every = np.concatenate([active + component * self._rows for component in range(self._components)])
        self.field.forward(every, source)
        kernels.couple(self.field.spectrum, elements, active, self._rows)
        self.field.inverse(every)
