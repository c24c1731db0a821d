"""Generators of random surfaces, and the ensembles they draw: lengths are in periods, wave indices count them."""

import math
from dataclasses import dataclass, replace
from typing import Literal, Protocol, Self

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import recursive, self_affine, spectral, statistics
from gfmd_numba.roughness.anisotropy import Anisotropic
from gfmd_numba.roughness.recursive import Recursion
from gfmd_numba.roughness.spectra import Model, SelfAffine

Shape = tuple[int, ...]


class Generator(Protocol):
    """A way to draw surfaces whose random numbers belong to (seed, realisation, wave)."""

    @property
    def hurst(self) -> float:
        """Hurst exponent."""

    @property
    def band(self) -> tuple[float, float]:
        """Wave indices between which the spectrum falls as a power law: below it rolls off, above it ends."""

    def heights(self, shape: Shape, seed: int, realisations: range) -> Reals:
        """Heights `[realisation, (y,) x]` of period 1 and zero mean, on no particular scale."""

    def power(self, shape: Shape) -> Reals:
        """Mean power `[(y,) nx // 2 + 1]` of the coefficients that theory expects, on no particular scale."""

    def without_shortest(self, halvings: int) -> Self | None:
        """The same with its largest wave index halved so often, or None where no waves would be left."""


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

    @property
    def band(self) -> tuple[float, float]:
        """Wave indices of the longest and the shortest wavelength of the power law."""
        return self.cut_on_index, self.cut_off_index

    def heights(self, shape: Shape, seed: int, realisations: range) -> Reals:
        """Heights `[realisation, (y,) x]` of period 1, zero mean and unit rms gradient."""
        waves = self.hurst, self.cut_on_index, self.cut_off_index, shape[0], seed, realisations
        if len(shape) == 1:
            return self_affine.profiles(*waves, self.plateau)
        return self_affine.maps(*waves, self.anisotropy, self.plateau)

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


@dataclass(frozen=True)
class ModelWaves:
    """Waves of a model up to a largest index, drawn from its spectrum (thesis 3.5.2.1) or autocorrelation (3.5.2)."""

    method: Literal["psd", "fourier_filter"]
    model: Model | Anisotropic
    largest_index: int

    @property
    def hurst(self) -> float:
        """Hurst exponent of the model, the mean of both directions where they differ."""
        return self.model.hurst

    @property
    def band(self) -> tuple[float, float]:
        """Wave indices of the correlation length and of the shortest wave."""
        return 1.0 / self.model.correlation_length, self.largest_index

    def heights(self, shape: Shape, seed: int, realisations: range) -> Reals:
        """Heights `[realisation, (y,) x]` of period 1, zero mean and unit rms height in the ensemble."""
        return spectral.surfaces(self.power(shape), shape[0], self.largest_index, seed, realisations)

    def without_shortest(self, halvings: int) -> Self | None:
        """The same up to half its largest index, so often."""
        largest = self.largest_index >> halvings
        return None if largest == 0 else replace(self, largest_index=largest)

    def power(self, shape: Shape) -> Reals:
        """Mean power per mean square height; raises ValueError where grid or period do not fit the model."""
        return _POWERS[self.method](self.model, shape[0], self.largest_index)


_POWERS = {"psd": spectral.psd_power, "fourier_filter": spectral.filter_power}


@dataclass(frozen=True)
class RecursiveSubdivision:
    """Random midpoint displacement or successive random addition (thesis 3.5.1)."""

    recursion: Recursion

    @property
    def hurst(self) -> float:
        """Hurst exponent."""
        return self.recursion.hurst

    @property
    def band(self) -> tuple[float, float]:
        """Wave indices of the roll-off and of the cut-on wavelength."""
        return 1.0 / self.recursion.roll_off, 1.0 / self.recursion.cut_on

    def heights(self, shape: Shape, seed: int, realisations: range) -> Reals:
        """Heights `[realisation, (y,) x]` of period 1 and unit rms height in the ensemble."""
        return recursive.surfaces(self.recursion, shape[0], seed, realisations)

    def without_shortest(self, halvings: int) -> Self | None:
        """The same from twice its cut-on wavelength, so often."""
        cut_on = self.recursion.cut_on * 2**halvings
        too_long = 2.0 * cut_on > self.recursion.roll_off
        return None if too_long else replace(self, recursion=replace(self.recursion, cut_on=cut_on))

    def power(self, shape: Shape) -> Reals:
        """Mean power that is asked for, a power law with a plateau; `recursive.power` is that of the recursion."""
        asked = SelfAffine(len(shape), self.hurst, self.recursion.cut_on, self.recursion.roll_off, 1.0)
        return spectral.psd_power(asked, shape[0], (shape[0] - 1) // 2)


@dataclass(frozen=True)
class RandomSurface:
    """An ensemble of periodic surfaces `[nx]` or `[nx, nx]` in units of their period and their rms gradient.

    Each surface is scaled to the same rms gradient, 1, or, where `by_height`, to the same rms height: that of an
    ensemble whose rms gradient is 1 in theory.
    """

    generator: Generator
    nx: int
    seed: int
    dimension: int = 1
    by_height: bool = False

    @property
    def shape(self) -> Shape:
        """Shape of a surface, (nx,) or (ny, nx)."""
        return (self.nx,) * self.dimension

    @property
    def nodes(self) -> int:
        """Number of its nodes."""
        return math.prod(self.shape)

    def heights(self, realisations: range) -> Reals:
        """Heights `[realisation, (y,) x]` of zero mean; raises ValueError for a grid that cannot hold the waves."""
        drawn = self.generator.heights(self.shape, self.seed, realisations)
        periods = (1.0,) * self.dimension
        if self.by_height:
            return statistics.scaled(drawn, periods, rms_height=1.0 / gradient_over_height(self.generator, self.shape))
        if isinstance(self.generator, SelfAffineWaves):  # which has it by construction
            return drawn
        return statistics.scaled(drawn, periods, rms_gradient=1.0)


def gradient_over_height(generator: Generator, shape: Shape) -> float:
    """Rms gradient that theory expects of surfaces of unit rms height, per period."""
    power, periods = generator.power(shape), (1.0,) * len(shape)
    second, zeroth = (statistics.moment_of_power(power, shape, order, periods) for order in (2, 0))
    return float(np.sqrt(second / zeroth))
