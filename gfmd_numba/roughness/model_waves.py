"""Generators of surfaces whose spectrum is a model with lengths of its own (thesis 3.2 and 3.5.2)."""

from dataclasses import dataclass, replace
from typing import ClassVar, Literal, Self

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness import anisotropy, spectra, spectral, statistics
from gfmd_numba.roughness.generators import Shape
from gfmd_numba.scene import surfaces as records
from gfmd_numba.scene.records import Discretisation


@dataclass(frozen=True)
class ModelWaves:
    """Waves of a model up to a largest index, drawn from its spectrum (thesis 3.5.2.1) or autocorrelation (3.5.2)."""

    unit_gradient: ClassVar = False
    method: Literal["psd", "fourier_filter"]
    model: spectra.Model | anisotropy.AnisotropicModel
    largest_index: int

    @classmethod
    def of(
        cls, model: spectra.Model | anisotropy.AnisotropicModel, record: records.Spectral, period: float, nx: int
    ) -> Self:
        """Waves of a model down to the cut-on wavelength of a record, or all below the Nyquist wave of its grid."""
        highest = (nx - 1) // 2
        largest = highest if record.cut_on is None else min(highest, int(period / record.cut_on * (1.0 + 1e-9)))
        return cls(record.method, model, largest)

    @property
    def hurst(self) -> float:
        """Hurst exponent of the model, the mean of both directions where they differ."""
        return self.model.hurst

    @property
    def band(self) -> tuple[float, float]:
        """Wave indices of the correlation length and of the shortest wave."""
        return 1.0 / self.model.correlation_length, self.largest_index

    def heights(self, shape: Shape, seed: int, realisations: range) -> Reals:
        """Heights `[realisation, (y,) x]` of period 1, zero mean, whose mean power is that of theory."""
        return spectral.surfaces(self.power(shape), shape[0], self.largest_index, seed, realisations)

    def mean_square_height(self, shape: Shape) -> float:
        """Sum of the mean powers of the waves that fit the period and the grid."""
        return float(statistics.moment_of_power(self.power(shape), shape, 0))

    def without_shortest(self, halvings: int) -> Self | None:
        """The same up to half its largest index, so often."""
        largest = self.largest_index >> halvings
        return None if largest == 0 else replace(self, largest_index=largest)

    def power(self, shape: Shape) -> Reals:
        """Mean power per mean square height; raises ValueError where grid or period do not fit the model."""
        return _POWERS[self.method](self.model, shape[0], self.largest_index)


_POWERS = {"psd": spectral.psd_power, "fourier_filter": spectral.filter_power}


def exponential(
    record: records.ExponentialCorrelation, _: Discretisation | None, period: float, dimension: int, nx: int
) -> ModelWaves:
    """Waves of the exponential correlation model, thesis (3.10), perhaps with mounds."""
    model = spectra.ExponentialSpectrum(dimension, record.hurst, record.correlation_length / period)
    return ModelWaves.of(_with_mounds(model, record, period), record, period, nx)


def k_correlation(
    record: records.KCorrelation, _: Discretisation | None, period: float, dimension: int, nx: int
) -> ModelWaves:
    """Waves of the K-correlation model, thesis (3.13), perhaps with mounds."""
    model = spectra.KCorrelationSpectrum(dimension, record.hurst, record.correlation_length / period)
    return ModelWaves.of(_with_mounds(model, record, period), record, period, nx)


def length_anisotropy(
    record: records.LengthAnisotropy, _: Discretisation | None, period: float, dimension: int, nx: int
) -> ModelWaves:
    """Waves of the model with two correlation lengths, thesis (3.15)."""
    return ModelWaves.of(
        anisotropy.LengthAnisotropicSpectrum(record.hurst, _lengths(record, period)), record, period, nx
    )


def scaling_anisotropy(
    record: records.ScalingAnisotropy, _: Discretisation | None, period: float, dimension: int, nx: int
) -> ModelWaves:
    """Waves of the model with two Hurst exponents and correlation lengths, thesis (3.16)."""
    hursts = record.hurst_x, record.hurst_y
    return ModelWaves.of(anisotropy.ScalingAnisotropicSpectrum(hursts, _lengths(record, period)), record, period, nx)


def _with_mounds(
    model: spectra.ExponentialSpectrum | spectra.KCorrelationSpectrum, record: records.Correlated, period: float
) -> spectra.Model:
    return model if record.mound_separation is None else spectra.Mounded(model, record.mound_separation / period)


def _lengths(record: records.LengthAnisotropy | records.ScalingAnisotropy, period: float) -> tuple[float, float]:
    return record.correlation_length_x / period, record.correlation_length_y / period
