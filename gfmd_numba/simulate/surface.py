"""One rough surface from its description to a dataset: heights, statistics, and the curves of theory."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from scipy import stats

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.contact_dataset import CONVENTIONS, cf_attributes
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import statistics
from gfmd_numba.roughness.generators import gradient_over_height, random_surface
from gfmd_numba.roughness.measured import MeasuredSurface, measured_surface, usable
from gfmd_numba.scene import Document
from gfmd_numba.scene.measured_record import AXES, Measured
from gfmd_numba.scene.plausible_numbers import implausible
from gfmd_numba.scene.surface_file import HurstRange, SurfaceFile
from gfmd_numba.scene.units import given_with_units, in_reduced_units

_LEVELS = np.linspace(-5.0, 5.0, 81)  # bin edges of the height distribution, in rms heights


@dataclass(frozen=True)
class Made(MeasuredSurface):
    """Surface with the mean power `[..., nx // 2 + 1]` of theory, None for a measured one."""

    power: Reals | None = None


def make(file: SurfaceFile) -> Made:
    """Surface of a checked record; ValueError for a measured file, or a spectrum, that cannot be used."""
    record = file.surface
    if isinstance(record, Measured):
        return Made(**vars(measured_surface(record, file.length)))
    period, dimension = file.length or 1.0, file.dimension or 1
    surface, gradient = random_surface(in_reduced_units(record, period, 1.0), None, dimension, file.seed)
    drawn = surface.heights(range(file.realisation, file.realisation + 1))[0]
    heights = gradient * period * drawn
    lengths = (period,) * dimension
    power = surface.generator.power(surface.shape)
    if record.scaling == "ensemble":
        asked = gradient * period / gradient_over_height(surface.generator, surface.shape)
    else:
        asked = float(statistics.rms_height(heights, lengths))
    power *= asked**2 / statistics.moment_of_power(power, surface.shape, 0, lengths)
    return Made(heights, lengths, "1" if file.length is None else "m", "", (), (), power=power)


def surface_dataset(file: SurfaceFile, document: Document) -> xr.Dataset:
    """Heights of one surface with its statistics and the curves of theory, in m or L_x.

    `processing` tells what was done to a measured surface; `validity` what makes it implausible. Raises InputError for
    a description that makes no sense or a measured file that cannot be used.
    """
    made = made_surface(file, document)
    dataset = _described(made)
    if file.hurst_range is not None:
        if made.unit == "1" and any(given_with_units(file.hurst_range)):
            allowed = "wavelengths without a unit, as neither the file nor a length tells the period in m"
            raise document.refused(("hurst_range",), allowed)
        try:
            _add_hurst_exponent(dataset, file.hurst_range, made)
        except ValueError as error:
            allowed = f"a range that holds waves, not {error}"
            raise document.refused(("hurst_range",), allowed) from None
    dataset.attrs["validity"] = "\n".join([*implausible(file), *made.doubts])
    dataset.attrs |= {"yaml": document.written, "surface": file.model_dump_json()}
    return dataset


def made_surface(file: SurfaceFile, document: Document) -> Made:
    """Surface of a file; raises InputError for a description that makes no sense or a file that cannot be used."""
    with usable(document, ("surface",), file.surface if isinstance(file.surface, Measured) else None):
        return make(file)


def _described(made: Made) -> xr.Dataset:
    heights, lengths = made.heights, made.lengths
    dims = AXES[-len(lengths) :]
    dataset = xr.Dataset(attrs={"Conventions": CONVENTIONS, "title": "rough surface"})
    for dim, n, length in zip(dims, heights.shape, lengths, strict=True):
        dataset.coords[dim] = (dim, np.arange(n) / n * length, cf_attributes(f"position along {dim}", made.unit))
    dataset["height"] = (dims, heights, cf_attributes("height, peaks towards the body", made.unit))
    dataset.attrs["processing"] = "\n".join(made.done)
    _add_scalars(dataset, made)
    _add_spectrum(dataset, made)
    _add_correlation(dataset, made)
    _add_distribution(dataset, made)
    return dataset


def _power(unit: str, exponent: int) -> str:
    """Name of a power of a unit of length, m or 1."""
    return f"{unit}{exponent}" if unit != "1" else unit


def _add_scalars(dataset: xr.Dataset, made: Made) -> None:
    heights, lengths = made.heights, made.lengths
    slope = statistics.typical_slope(heights, lengths[-1]).mean()
    per_length, curvature = _power(made.unit, -1), statistics.rms_curvature(heights, lengths)
    distance = stats.kstest(stats.zscore(heights, axis=None).ravel(), "norm", method="asymp").statistic
    off = "largest difference of the cumulative height distribution from a Gaussian one"
    for name, value, units, long_name in (
        ("rms_height", statistics.rms_height(heights, lengths), made.unit, "rms height"),
        ("rms_gradient", statistics.rms_gradient(heights, lengths), "1", "rms gradient"),
        ("rms_curvature", curvature, per_length, "rms second derivative or Laplacian"),
        ("nayak", statistics.nayak(heights, lengths), "1", "Nayak's parameter m0 m4 / m2^2"),
        ("typical_slope", slope, "rad", "standard deviation of the slope angle along x"),
        ("skewness", stats.skew(heights, axis=None), "1", "skewness of the heights"),
        ("kurtosis", stats.kurtosis(heights, axis=None, fisher=False), "1", "kurtosis of the heights, 3 if Gaussian"),
        ("gaussian_distance", distance, "1", off),
    ):
        dataset[name] = ((), float(value), cf_attributes(long_name, units))


def _add_hurst_exponent(dataset: xr.Dataset, wavelengths: HurstRange, made: Made) -> None:
    ends = (2.0 * np.pi / wavelengths.longest, 2.0 * np.pi / wavelengths.shortest)
    hurst, error = statistics.hurst_exponent(made.heights, *ends, made.lengths)
    dataset["hurst_exponent"] = ((), hurst, cf_attributes("Hurst exponent of the most likely power law"))
    dataset["hurst_exponent_error"] = ((), error, cf_attributes("standard error of the Hurst exponent"))


def _add_spectrum(dataset: xr.Dataset, made: Made) -> None:
    q, density, waves = statistics.spectral_density(made.heights, made.lengths)
    attributes = cf_attributes("two-sided spectral density", _power(made.unit, len(made.lengths) + 2))
    dataset.coords["wavenumber"] = ("wavenumber", q, cf_attributes("wave number", _power(made.unit, -1)))
    dataset["spectral_density"] = ("wavenumber", density, attributes)
    dataset["waves"] = ("wavenumber", waves, cf_attributes("independent waves in the bin"))
    if made.power is not None:
        even = grid.signal(np.sqrt(made.power), *made.heights.shape)  # a surface of exactly the mean power
        theory = statistics.spectral_density(even, made.lengths)[1]
        dataset["spectral_density_theory"] = ("wavenumber", theory, attributes)


def _add_correlation(dataset: xr.Dataset, made: Made) -> None:
    distance, found = statistics.radial_mean(statistics.autocorrelation(made.heights, made.lengths), made.lengths)
    variance = statistics.rms_height(made.heights, made.lengths) ** 2
    attributes = cf_attributes("autocorrelation")
    squares = cf_attributes("mean square height difference", _power(made.unit, 2))
    dataset.coords["distance"] = ("distance", distance, cf_attributes("distance", made.unit))
    dataset["autocorrelation"] = ("distance", found, attributes)
    dataset["height_height_correlation"] = ("distance", 2.0 * variance * (1.0 - found), squares)
    if made.power is not None:
        periodic = grid.signal(made.power, *made.heights.shape)
        total = periodic.flat[0]
        _, theory = statistics.radial_mean(periodic / total, made.lengths)
        dataset["autocorrelation_theory"] = ("distance", theory, attributes)
        dataset["height_height_correlation_theory"] = ("distance", 2.0 * total * (1.0 - theory), squares)


def _add_distribution(dataset: xr.Dataset, made: Made) -> None:
    unit = stats.zscore(made.heights, axis=None)
    density = np.histogram(unit, _LEVELS)[0] / unit.size / np.diff(_LEVELS)
    centre = 0.5 * (_LEVELS[1:] + _LEVELS[:-1])
    attributes = cf_attributes("density of heights over the rms height")
    dataset.coords["level"] = ("level", centre, cf_attributes("height over the rms height"))
    dataset["height_density"] = ("level", density, attributes)
    dataset["height_density_gaussian"] = ("level", stats.norm.pdf(centre), attributes)
