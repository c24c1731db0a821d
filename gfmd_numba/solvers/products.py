"""From displacements to tractions and back, all components at once: the transforms of a batch."""

from typing import Any

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier.transform import Transform


class Products:
    """Products of a batch with its stiffness and its compliance; two transforms a component and row each.

    Arrays are `[realisation, component, node]`: tangential components, on maps along x and along y, then the normal
    one. With a second of the `sources`, `deflect` leaves the displacements as they are.
    """

    def __init__(self, response: SpectralResponse, rows: int, shape: tuple[int, ...], sources: int = 1) -> None:
        self.components = response.components
        self.field = Transform(self.components * rows, *shape, sources=sources)
        self.displacement, *self._others = (self._by_row(each) for each in self.field.sources)
        self.restoring, self._spectrum = self._by_row(self.field.result), self._by_row(self.field.spectrum)
        self.stiffness = self.symbols(response.elements)
        self._compliance = self.symbols(response.inverse()) if self._others else self.stiffness[:0]

    @property
    def n_transforms(self) -> Indices:
        """Transforms made so far for each realisation."""
        return np.asarray(self.field.n_transforms.reshape(-1, self.components).sum(axis=1))

    def symbols(self, elements: Reals) -> Reals:
        """Elements `[element, (ny,) nx // 2 + 1]` of a matrix for each wave, ready for `apply`."""
        return np.array([self.field.symbol(element) for element in elements])

    def restore(self, active: Indices) -> None:
        """Fill the restoring tractions of the displacements in the active rows."""
        self.apply(self.stiffness, active)

    def apply(self, symbols: Reals, active: Indices, source: int = 0) -> None:
        """Fill the restoring tractions in the active rows with the product of a source with a matrix for each wave."""
        if self.components == 1:
            self.field.apply(symbols[0], active, source)
            return
        every = (active[:, np.newaxis] * self.components + np.arange(self.components)).ravel()
        self.field.forward(every, source)
        kernels.couple(self._spectrum, symbols, active)
        self.field.inverse(every)

    def deflect(self, i: int, traction: Reals) -> Reals:
        """Displacements `[component, n]` of row i under tangential tractions and a pressure `[component, n]`."""
        (source,), n = self._others, self.field.n
        source[i, :, :n] = traction
        np.negative(traction[-1], out=source[i, -1, :n])
        self.apply(self._compliance, np.array([i]), source=1)
        return self.restoring[i, :, :n].copy()

    def _by_row(self, values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        return values.reshape(-1, self.components, values.shape[-1])
