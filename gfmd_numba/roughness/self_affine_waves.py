"""Generator of self-affine surfaces by the power spectral density method (thesis 3.5.2.1)."""

import math
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine, statistics
from gfmd_numba.roughness.generators import Shape, gradient_over_height
from gfmd_numba.roughness.power_law import band
from gfmd_numba.scene.records import Discretisation
from gfmd_numba.scene.surfaces import SelfAffine


@dataclass(frozen=True)
class SelfAffineWaves:
    """Power law of the amplitudes between two wave indices, drawn from its power spectral density (thesis 3.5.2.1).

    Below `cut_on_index` the spectrum is constant, or zero without `plateau`. `anisotropy` is the ratio of the
    correlation lengths of a map, y over x.
    """

    hurst: float
    cut_on_index: float
    cut_off_index: int
    anisotropy: float = 1.0
    plateau: bool = True
    by_theory: bool = field(default=False, repr=False)  # as the surface that has these waves says

    @property
    def unit_gradient(self) -> bool:
        """Whether each surface has an rms gradient of 1, and not only the ensemble."""
        return not self.by_theory

    @property
    def band(self) -> tuple[float, float]:
        """Wave indices of the longest and the shortest wavelength of the power law."""
        return self.cut_on_index, self.cut_off_index

    def heights(self, shape: Shape, seed: int, realisations: range) -> Reals:
        """Heights `[realisation, (y,) x]` of period 1, zero mean and unit rms gradient, or that `by_theory`."""
        waves = self.hurst, self.cut_on_index, self.cut_off_index, shape[0], seed, realisations
        form = self_affine.Form(self.plateau, self.by_theory)
        if len(shape) == 1:
            return self_affine.profiles(*waves, form)
        return self_affine.maps(*waves, self.anisotropy, form)

    def mean_square_height(self, shape: Shape) -> float:
        """Mean square height of an ensemble of unit rms gradient."""
        return gradient_over_height(self, shape) ** -2

    def without_shortest(self, halvings: int) -> Self | None:
        """The same up to half its largest index, so often; a power law keeps at least an octave if it can."""
        cut_off = self.cut_off_index >> halvings
        cut_on = min(self.cut_on_index, float(max(math.ceil(self.anisotropy), cut_off // 2)))
        return None if cut_on > cut_off else replace(self, cut_on_index=cut_on, cut_off_index=cut_off)

    def power(self, shape: Shape) -> Reals:
        """Mean power per mean square height (3.28)."""
        vectors = grid.wavevectors(shape, (1.0,) * len(shape))
        index = np.hypot(self.anisotropy * vectors[0], vectors[-1]) if len(shape) == 2 else vectors[0]
        index = index / (2.0 * np.pi)
        longest = 0.5 if self.plateau else self.cut_on_index
        kept = (index >= longest * (1.0 - 1e-12)) & (index <= self.cut_off_index * (1.0 + 1e-12))
        law = np.maximum(index, self.cut_on_index) ** -(len(shape) + 2.0 * self.hurst)
        power = np.where(kept, law, 0.0)
        return np.asarray(power / statistics.moment_of_power(power, shape, 0, (1.0,) * len(shape)))


def generator(
    record: SelfAffine, discretisation: Discretisation | None, period: float, dimension: int, nx: int
) -> SelfAffineWaves:
    """Waves of a record between its wavelengths, or those of the discretisation."""
    longest, shortest = band(record, discretisation, period)
    anisotropy = record.anisotropy or 1.0
    cut_off, by_theory = int(shortest * (1.0 + 1e-9)), record.scaling == "ensemble"
    return SelfAffineWaves(record.hurst, longest, cut_off, anisotropy, record.plateau, by_theory)
