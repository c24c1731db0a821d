"""Periodic Gaussian surfaces whose spectrum is a model with lengths of its own (thesis 3.2 and 3.5.2).

Waves are drawn by the power spectral density method or the Fourier filtering method. Both draw the amplitude of each
wave from (seed, realisation, wave): a finer grid samples the same surface, and a larger `largest_index` adds waves to
it. Periods are the same in all directions.
"""

from dataclasses import dataclass, replace
from functools import reduce
from typing import ClassVar, Literal, Self

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import spectra, statistics
from gfmd_numba.roughness.amplitudes import waves
from gfmd_numba.roughness.generators import Shape
from gfmd_numba.roughness.spectra import Anisotropic, Isotropic
from gfmd_numba.scene import surfaces as records
from gfmd_numba.scene.records import Discretisation

_ROUNDING = 1e-12  # of the largest power, below which a negative one is taken for zero


def psd_power(spectrum: Isotropic | Anisotropic, nx: int, largest_index: int, period: float = 1.0) -> Reals:
    """Mean power <|h~(q)|^2> / w^2 `[nx // 2 + 1]` or `[nx, nx // 2 + 1]` of the power spectral density method.

    Raises ValueError for a spectrum that is negative or not finite somewhere, or zero everywhere.
    """
    index = grid.wave_indices((nx,) * spectrum.dimension)
    size = np.sqrt(sum(k**2 for k in index))
    kept = (size > 0) & (size <= largest_index)
    step = 2.0 * np.pi / period
    if spectrum.isotropic:
        q, place = np.unique(step * size[kept], return_inverse=True)
        density = spectrum.psd(q)[place]
    else:
        q_y, q_x = (np.broadcast_to(step * k, kept.shape)[kept] for k in index)
        density = spectrum.psd(q_x, q_y)
    power = np.zeros(kept.shape)
    power[kept] = density * step ** len(index)
    return _usable(power)


def filter_power(model: Isotropic | Anisotropic, nx: int, largest_index: int, period: float = 1.0) -> Reals:
    """Mean power <|h~(q)|^2> / w^2, laid out like that of `psd_power`, of the Fourier filtering method.

    It is the discrete transform of the autocorrelation at the 2 `largest_index` + 1 points that hold these waves. The
    power of shorter waves is folded into them, so that the last octave has too much.
    (3.26) filters with the transform itself, whose surfaces have the autocorrelation R * R; R takes its square root.
    Raises ValueError like `psd_power`, where the period is too short for the correlation.
    """
    dimension, points = model.dimension, 2 * largest_index + 1
    nearest = grid.shifts(points, period)  # on the periodic surface, where the origin has images
    if model.isotropic:
        along = np.meshgrid(*[nearest] * dimension, sparse=True)
        correlation = model.autocorrelation(reduce(np.hypot, along, np.zeros(1)))
    else:
        correlation = model.autocorrelation(nearest[np.newaxis], nearest[:, np.newaxis])
    found = grid.coefficients(correlation, dimension).real
    found[(0,) * dimension] = 0.0
    power = np.zeros([nx] * (dimension - 1) + [nx // 2 + 1])
    if 2 * largest_index < nx:
        rows = [np.arange(-largest_index, largest_index + 1)] * (dimension - 1)
        columns = np.arange(largest_index + 1)
        power[np.ix_(*rows, columns)] = found[np.ix_(*rows, columns)]
    return _usable(power)


def surfaces(power: Reals, nx: int, largest_index: int, seed: int, realisations: range) -> Reals:
    """Heights `[realisation, nx]` or `[realisation, nx, nx]` of zero mean and rms height w = 1 in the ensemble (3.27).

    `power` is that of `psd_power` or `filter_power` on the same grid.
    """
    shape = (nx,) * len(power.shape)
    envelope = np.sqrt(power)
    heights = np.empty((len(realisations), *shape))
    for row, realisation in zip(heights, realisations, strict=True):
        amplitudes = envelope * waves(seed, realisation, shape, largest_index)
        row[...] = grid.signal(amplitudes, *shape)
    return heights


@dataclass(frozen=True)
class ModelWaves:
    """Waves of a model up to a largest index, drawn from its spectrum (thesis 3.5.2.1) or autocorrelation (3.5.2)."""

    unit_gradient: ClassVar = False
    method: Literal["psd", "fourier_filter"]
    model: Isotropic | Anisotropic
    largest_index: int

    @classmethod
    def of(cls, model: Isotropic | Anisotropic, record: records.Spectral, nx: int) -> Self:
        """Waves of a model down to the cut-on wavelength of a record, or all below the Nyquist wave of its grid."""
        highest = (nx - 1) // 2
        largest = highest if record.cut_on is None else min(highest, int(1.0 / record.cut_on * (1.0 + 1e-9)))
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
        return surfaces(self.power(shape), shape[0], self.largest_index, seed, realisations)

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


def generator(record: records.Spectral, _: Discretisation | None, dimension: int, nx: int) -> ModelWaves:
    """Waves of the model of a record, perhaps with mounds."""
    model: Isotropic | Anisotropic
    match record:
        case records.Correlated():  # thesis (3.10) or (3.13)
            flat = _ISOTROPIC[record.model](dimension, record.hurst, record.correlation_length)
            mounds = record.mound_separation
            model = flat if mounds is None else spectra.Mounded(flat, mounds)
        case records.LengthAnisotropy():  # thesis (3.15)
            model = spectra.LengthAnisotropicSpectrum(record.hurst, _lengths(record))
        case records.ScalingAnisotropy():  # thesis (3.16)
            hursts = record.hurst_x, record.hurst_y
            model = spectra.ScalingAnisotropicSpectrum(hursts, _lengths(record))
    return ModelWaves.of(model, record, nx)


def _usable(power: Reals) -> Reals:
    if not np.isfinite(power).all():
        where = tuple(int(i[0]) for i in np.nonzero(~np.isfinite(power)))
        raise ValueError(f"a spectrum of {power[where]} at wave index {where}, not finite")
    if power.max() < np.finfo(np.float64).tiny:
        raise ValueError("a spectrum that is zero at all waves that fit the period")
    if power.min() < -_ROUNDING * power.max():
        where = tuple(int(i) for i in np.unravel_index(power.argmin(), power.shape))
        raise ValueError(f"a spectrum that is negative at wave index {where}")
    return np.maximum(power, 0.0)


_POWERS = {"psd": psd_power, "fourier_filter": filter_power}
_ISOTROPIC: dict[str, type[spectra.ExponentialSpectrum | spectra.KCorrelationSpectrum]] = {
    "exponential": spectra.ExponentialSpectrum,
    "k_correlation": spectra.KCorrelationSpectrum,
}


def _lengths(record: records.LengthAnisotropy | records.ScalingAnisotropy) -> tuple[float, float]:
    return record.correlation_length_x, record.correlation_length_y
