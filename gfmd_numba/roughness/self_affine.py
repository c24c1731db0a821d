"""Periodic self-affine profiles and maps by the power spectral density method (thesis 3.5.2.1).

A wave q has the Fourier coefficient A |q|^-(d/2 + H) z in d dimensions. Each z is a complex Gaussian of its own, which
belongs to the seed, the realisation and the wave (`amplitudes.py`). Below the longest wavelength |q| is that of this
wavelength, or the coefficient is zero. The factor A makes the rms gradient of each surface 1, or, scaled as an
ensemble, that of the mean spectrum.
"""

import math
from dataclasses import dataclass, field, replace
from functools import reduce
from typing import Self

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import statistics
from gfmd_numba.roughness.amplitudes import complex_gaussian, waves, waves_of_columns
from gfmd_numba.roughness.generators import Shape, band, gradient_over_height, power_law
from gfmd_numba.scene.records import Discretisation
from gfmd_numba.scene.surfaces import SelfAffine


@dataclass(frozen=True)
class SelfAffineWaves:
    """Power law of the amplitudes between two wave indices, drawn from its power spectral density (thesis 3.5.2.1).

    Below `longest_wave_index` the spectrum is constant, or zero without `plateau`. `anisotropy` is the ratio of the
    correlation lengths of a map, y over x.
    """

    hurst: float
    longest_wave_index: float
    shortest_wave_index: int
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
        return self.longest_wave_index, self.shortest_wave_index

    def heights(self, shape: Shape, seed: int, realisations: range) -> Reals:
        """Heights `[realisation, (y,) x]` of period 1, zero mean and unit rms gradient, or that `by_theory`.

        Of a wave at Nyquist (eps_c = 1) the nodes hold the cosine alone, so that their own gradient differs a little.
        Amplitudes fall as |q|^-(d/2 + H) (3.28) up to the cut-off and are zero above. With an `anisotropy` of 1 or
        more, q is (q_x, anisotropy q_y): correlation lengths, and both cut-off wavelengths, are that much longer along
        y. Random numbers belong to (seed, realisation, wave): a finer grid samples the same surface, a larger
        `shortest_wave_index` adds waves to it.
        """
        nx = shape[0]
        if len(shape) == 2:
            heights = np.empty((len(realisations), nx, nx))
            for row, realisation in zip(heights, realisations, strict=True):
                drawn = waves(seed, realisation, (2 * self.shortest_wave_index + 1,) * 2, self.shortest_wave_index)
                spectrum, squares = self._columns_of(drawn, nx, slice(0, self.shortest_wave_index + 1))
                spectrum /= np.sqrt(squares.sum())
                row[...] = grid.signal(spectrum, nx, nx)
            return heights
        index = np.arange(1, self.shortest_wave_index + 1)
        envelope = power_law(index, 0.5 + self.hurst, self.band, self.plateau)
        spectrum = np.zeros((len(realisations), nx // 2 + 1), dtype=np.complex128)
        for row, realisation in zip(spectrum, realisations, strict=True):
            amplitudes = envelope * complex_gaussian(seed, realisation, self.shortest_wave_index)
            power = 2.0 * envelope**2 if self.by_theory else np.abs(amplitudes) ** 2
            amplitudes /= np.sqrt(2.0 * np.sum((2.0 * np.pi * index) ** 2 * power))
            row[index] = amplitudes
        if 2 * self.shortest_wave_index == nx:  # at Nyquist both signs of q share one real coefficient
            spectrum[:, -1] = 2.0 * spectrum[:, -1].real
        return grid.signal(spectrum, nx)

    def columns(self, nx: int, seed: int, realisation: int, columns: slice) -> tuple[Complexes, Reals]:
        """Coefficients `[k_y, k_x]` of some columns of a map, on no scale, and its mean-square gradient by columns.

        They are made without the other columns.
        """
        own = slice(columns.start, max(columns.start, min(columns.stop, self.shortest_wave_index + 1)))
        return self._columns_of(waves_of_columns(seed, realisation, self.shortest_wave_index, own), nx, columns)

    def _columns_of(self, drawn: Complexes, nx: int, columns: slice) -> tuple[Complexes, Reals]:
        """Columns as above, of waves that were `drawn` for those up to the cut-off."""
        smallest = (2 * self.shortest_wave_index + 1,) * 2  # the grid that just holds the waves
        own = slice(columns.start, columns.start + drawn.shape[1])
        q_y, q_x = grid.wavevectors(smallest, (1.0, 1.0))
        q_x = q_x[:, own]
        index = np.hypot(self.anisotropy * q_y, q_x) / (2.0 * np.pi)
        envelope = power_law(index, 1.0 + self.hurst, self.band, self.plateau)
        amplitudes = envelope * drawn
        power = envelope**2 if self.by_theory else np.abs(amplitudes) ** 2
        squares = (grid.multiplicity(smallest[1])[own] * np.hypot(q_y, q_x) ** 2 * power).sum(axis=0)
        spectrum = np.zeros((nx, columns.stop - columns.start), dtype=np.complex128)
        np.add.at(spectrum, (grid.wave_indices(smallest)[0] % nx, np.arange(drawn.shape[1])), amplitudes)
        if 2 * self.shortest_wave_index == nx and columns.stop > self.shortest_wave_index:
            # at Nyquist both signs of q share one real coefficient; along y they add up
            spectrum[:, -1] = 2.0 * spectrum[:, -1].real
        return spectrum, squares

    def mean_square_height(self, shape: Shape) -> float:
        """Mean square height of an ensemble of unit rms gradient."""
        return gradient_over_height(self, shape) ** -2

    def without_shortest(self, halvings: int) -> Self | None:
        """The same up to half its largest index, so often; a power law keeps at least an octave if it can."""
        shortest = self.shortest_wave_index >> halvings
        longest = min(self.longest_wave_index, float(max(math.ceil(self.anisotropy), shortest // 2)))
        return None if longest > shortest else replace(self, longest_wave_index=longest, shortest_wave_index=shortest)

    def power(self, shape: Shape) -> Reals:
        """Mean power per mean square height (3.28)."""
        *q_y, q_x = grid.wavevectors(shape, (1.0,) * len(shape))
        index = reduce(np.hypot, (*(self.anisotropy * q for q in q_y), q_x)) / (2.0 * np.pi)
        power = power_law(index, len(shape) + 2.0 * self.hurst, self.band, self.plateau)
        return np.asarray(power / statistics.moment_of_power(power, shape, 0, (1.0,) * len(shape)))


def generator(record: SelfAffine, discretisation: Discretisation | None, dimension: int, nx: int) -> SelfAffineWaves:
    """Waves of a record between its wavelengths, or those of the discretisation."""
    longest, shortest = band(record, discretisation)
    anisotropy = record.anisotropy or 1.0
    cut_off, by_theory = int(shortest * (1.0 + 1e-9)), record.scaling == "ensemble"
    return SelfAffineWaves(record.hurst, longest, cut_off, anisotropy, record.plateau, by_theory)
