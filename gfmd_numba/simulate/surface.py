"""One rough surface from its description to a dataset: heights, statistics, and the curves of theory."""

import warnings
from typing import Any

import numpy as np
import xarray as xr
from scipy.stats import norm

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.dataset import CONVENTIONS
from gfmd_numba.contact.plausible_numbers import implausible
from gfmd_numba.roughness import correlation, distribution, spectral, statistics
from gfmd_numba.roughness.one_surface import Made, make
from gfmd_numba.scene import Document, InputError
from gfmd_numba.scene.measured_record import AXES, Measured
from gfmd_numba.scene.surface_file import HurstRange, SurfaceFile
from gfmd_numba.scene.units import given_with_units

_LEVELS = np.linspace(-5.0, 5.0, 81)  # bin edges of the height distribution, in rms heights


def surface_dataset(file: SurfaceFile, document: Document) -> xr.Dataset:
    """Heights of one surface with its statistics and the curves of theory, in m or L_x.

    `processing` tells what was done to a measured surface; `validity`, and a warning, what makes it implausible. Raises
    InputError for a description that makes no sense or a measured file that cannot be used.
    """
    made = made_surface(file, document)
    dataset = _described(made)
    if file.hurst_range is not None:
        if made.unit == "1" and any(given_with_units(file.hurst_range)):
            allowed = "wavelengths without a unit, as neither the file nor a length tells the period in m"
            raise document.error(("hurst_range",), document.value(("hurst_range",)), allowed)
        try:
            _add_hurst_exponent(dataset, file.hurst_range, made)
        except ValueError as error:
            allowed = f"a range that holds waves, not {error}"
            raise document.error(("hurst_range",), document.value(("hurst_range",)), allowed) from None
    sentences = [*implausible(file), *made.doubts]
    for sentence in sentences:
        warnings.warn(sentence, stacklevel=2)
    dataset.attrs["validity"] = "\n".join(sentences)
    dataset.attrs["surface"] = file.model_dump_json()
    return dataset


def made_surface(file: SurfaceFile, document: Document) -> Made:
    """Surface of a file; raises InputError for a description that makes no sense or a file that cannot be used."""
    try:
        return make(file)
    except ValueError as error:
        if isinstance(file.surface, Measured):
            given = f"{file.surface.shown} ({error})"
            allowed = "at least 4 equidistant finite heights in each direction, in units that are stated, not all equal"
            raise InputError(document.line(("surface", file.surface.key), given, allowed)) from None
        raise document.error(("surface",), document.value(("surface",)), f"a usable surface, not {error}") from None


def _described(made: Made) -> xr.Dataset:
    unit = made.unit
    heights, lengths, dimension = made.heights, made.lengths, len(made.lengths)
    dims = AXES[-dimension:]
    dataset = xr.Dataset(attrs={"Conventions": CONVENTIONS, "title": "rough surface"})
    for dim, n, length in zip(dims, heights.shape, lengths, strict=True):
        dataset.coords[dim] = (dim, np.arange(n) / n * length, {"long_name": f"position along {dim}", "units": unit})
    dataset["height"] = (dims, heights, {"long_name": "height, peaks towards the body", "units": unit})
    dataset.attrs["processing"] = "\n".join(made.done)
    _add_scalars(dataset, made, unit)
    _add_spectrum(dataset, made, unit)
    _add_correlation(dataset, made, unit)
    _add_distribution(dataset, made)
    return dataset


def _add_scalars(dataset: xr.Dataset, made: Made, unit: str) -> None:
    heights, lengths, dimension = made.heights, made.lengths, len(made.lengths)
    per_length = "m-1" if unit == "m" else "1"
    scalars: dict[str, tuple[Any, str, str]] = {
        "rms_height": (statistics.rms_height(heights, lengths), unit, "rms height"),
        "rms_gradient": (statistics.rms_gradient(heights, lengths), "1", "rms gradient"),
        "rms_curvature": (statistics.rms_curvature(heights, lengths), per_length, "rms second derivative or Laplacian"),
        "nayak": (statistics.nayak(heights, lengths), "1", "Nayak's parameter m0 m4 / m2^2"),
        "typical_slope": (
            statistics.typical_slope(heights, lengths[-1]).mean(),
            "rad",
            "standard deviation of the slope angle along x",
        ),
        "skewness": (distribution.skewness(heights, dimension), "1", "skewness of the heights"),
        "kurtosis": (distribution.kurtosis(heights, dimension), "1", "kurtosis of the heights, 3 if Gaussian"),
        "gaussian_distance": (
            distribution.gaussian_distance(heights, dimension),
            "1",
            "largest difference of the cumulative height distribution from a Gaussian one",
        ),
    }
    for name, (value, units, long_name) in scalars.items():
        dataset[name] = ((), float(value), {"long_name": long_name, "units": units})


def _add_hurst_exponent(dataset: xr.Dataset, wavelengths: HurstRange, made: Made) -> None:
    ends = (2.0 * np.pi / wavelengths.longest, 2.0 * np.pi / wavelengths.shortest)
    hurst, error = correlation.hurst_exponent(made.heights, *ends, made.lengths)
    attributes = {"long_name": "Hurst exponent of the most likely power law", "units": "1"}
    dataset["hurst_exponent"] = ((), hurst, attributes)
    dataset["hurst_exponent_error"] = ((), error, {"long_name": "standard error of the Hurst exponent", "units": "1"})


def _add_spectrum(dataset: xr.Dataset, made: Made, unit: str) -> None:
    dimension = len(made.lengths)
    q, density, waves = correlation.spectral_density(made.heights, made.lengths)
    attributes = {"long_name": "two-sided spectral density", "units": f"m{dimension + 2}" if unit == "m" else "1"}
    dataset.coords["wavenumber"] = (
        "wavenumber",
        q,
        {"long_name": "wave number", "units": "m-1" if unit == "m" else "1"},
    )
    dataset["spectral_density"] = ("wavenumber", density, attributes)
    dataset["waves"] = ("wavenumber", waves, {"long_name": "independent waves in the bin", "units": "1"})
    if made.power is not None:
        even = spectral.periodic_autocorrelation(np.sqrt(made.power), made.heights.shape[-1])
        theory = correlation.spectral_density(even, made.lengths)[1]
        dataset["spectral_density_theory"] = ("wavenumber", theory, attributes)


def _add_correlation(dataset: xr.Dataset, made: Made, unit: str) -> None:
    distance, found = _along_distance(correlation.autocorrelation(made.heights, made.lengths), made.lengths)
    variance = statistics.rms_height(made.heights, made.lengths) ** 2
    attributes = {"long_name": "autocorrelation", "units": "1"}
    squares = {"long_name": "mean square height difference", "units": "m2" if unit == "m" else "1"}
    dataset.coords["distance"] = ("distance", distance, {"long_name": "distance", "units": unit})
    dataset["autocorrelation"] = ("distance", found, attributes)
    dataset["height_height_correlation"] = ("distance", 2.0 * variance * (1.0 - found), squares)
    if made.power is not None:
        periodic = spectral.periodic_autocorrelation(made.power, made.heights.shape[-1])
        _, theory = _along_distance(periodic / periodic.flat[0], made.lengths)
        dataset["autocorrelation_theory"] = ("distance", theory, attributes)
        total = periodic.flat[0]
        dataset["height_height_correlation_theory"] = ("distance", 2.0 * total * (1.0 - theory), squares)


def _along_distance(correlated: Reals, lengths: tuple[float, ...]) -> tuple[Reals, Reals]:
    if len(lengths) == 2:
        return correlation.radial_mean(correlated, (lengths[0], lengths[1]))
    n = correlated.size
    return np.arange(n // 2 + 1) / n * lengths[0], correlated[: n // 2 + 1]


def _add_distribution(dataset: xr.Dataset, made: Made) -> None:
    unit = distribution.standardised(made.heights, len(made.lengths)).ravel()
    density = np.histogram(unit, _LEVELS)[0] / unit.size / np.diff(_LEVELS)
    centre = 0.5 * (_LEVELS[1:] + _LEVELS[:-1])
    attributes = {"long_name": "density of heights over the rms height", "units": "1"}
    dataset.coords["level"] = ("level", centre, {"long_name": "height over the rms height", "units": "1"})
    dataset["height_density"] = ("level", density, attributes)
    dataset["height_density_gaussian"] = ("level", norm.pdf(centre), attributes)
