"""From the record of a surface to its heights and to the spectrum they were drawn from."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness import recursive, spectral, statistics
from gfmd_numba.roughness.anisotropy import Anisotropic, LengthAnisotropy, ScalingAnisotropy
from gfmd_numba.roughness.measurements import read_measurement
from gfmd_numba.roughness.processing import process
from gfmd_numba.roughness.spectra import Exponential, KCorrelation, Model, Mounded, SelfAffine
from gfmd_numba.scene.surface_records import (
    Correlated,
    ExponentialModel,
    FourierFilter,
    LengthAnisotropyModel,
    MeasuredField,
    ScalingAnisotropyModel,
    SelfAffineModel,
    SpectralDensity,
    SurfaceFile,
)

_ROUNDING = 1e-12  # of the largest height, below which a range of heights is rounding


@dataclass(frozen=True)
class Made:
    """Heights `[nx]` or `[ny, nx]` and their periods, in m or L_x; the mean power `[..., nx // 2 + 1]` of theory.

    `power` is None for a measured field; `done` tells what was done to one. The `unit` is "m", or "1" for L_x, which
    is the size of a measured field along x.
    """

    heights: Reals
    lengths: tuple[float, ...]
    unit: Literal["m", "1"]
    power: Reals | None
    done: tuple[str, ...] = ()


def make(file: SurfaceFile) -> Made:
    """Surface of a checked record; ValueError for a measured file, or a spectrum, that cannot be used."""
    surface = file.surface
    if isinstance(surface, MeasuredField):
        return _measured(file, surface)
    assert file.points is not None  # the record's promise
    nx, period, dimension = file.points, file.length or 1.0, file.dimension or 1
    realisations = range(file.realisation, file.realisation + 1)
    lengths = (period,) * dimension
    if isinstance(surface, SpectralDensity | FourierFilter):
        cut_on, highest = surface.spectrum.cut_on, (nx - 1) // 2
        largest = highest if cut_on is None else min(highest, int(period / cut_on * (1.0 + 1e-9)))
        if isinstance(surface.spectrum, SelfAffineModel):
            power = spectral.psd_power(_self_affine(surface.spectrum, dimension, period), nx, largest, period)
        else:
            power_of = spectral.psd_power if isinstance(surface, SpectralDensity) else spectral.filter_power
            power = power_of(_model(surface.spectrum, dimension), nx, largest, period)
        heights = spectral.surfaces(power, nx, largest, file.seed, realisations)
    else:
        recursion = recursive.Recursion(
            surface.method, dimension, surface.hurst, surface.cut_on / period, surface.roll_off / period
        )
        asked = SelfAffine(dimension, surface.hurst, surface.cut_on, surface.roll_off, period)
        power = spectral.psd_power(asked, nx, (nx - 1) // 2, period)
        heights = recursive.surfaces(recursion, nx, file.seed, realisations)
    scaled = statistics.scaled(heights, lengths, surface.rms_height, surface.rms_gradient)
    factor = statistics.rms_height(scaled[0], lengths) / statistics.rms_height(heights[0], lengths)
    return Made(scaled[0], lengths, "1" if file.length is None else "m", power * factor**2)


def _self_affine(record: SelfAffineModel, dimension: int, period: float) -> SelfAffine:
    longest = period if record.plateau else record.roll_off
    return SelfAffine(dimension, record.hurst, record.cut_on, record.roll_off, longest)


def _model(record: Correlated, dimension: int) -> Model | Anisotropic:
    match record:
        case LengthAnisotropyModel():
            return LengthAnisotropy(record.hurst, (record.correlation_length_x, record.correlation_length_y))
        case ScalingAnisotropyModel():
            lengths = record.correlation_length_x, record.correlation_length_y
            return ScalingAnisotropy((record.hurst_x, record.hurst_y), lengths)
    kind = Exponential if isinstance(record, ExponentialModel) else KCorrelation
    model = kind(dimension, record.hurst, record.correlation_length)
    return model if record.mound_separation is None else Mounded(model, record.mound_separation)


def _measured(file: SurfaceFile, surface: MeasuredField) -> Made:
    measurement = read_measurement(Path(surface.file))
    shape = measurement.heights.shape
    lengths = measurement.lengths
    if lengths is not None and file.length is not None:
        raise ValueError("positions of its own, so that length has to be left out")
    if measurement.unit == "m" and lengths is None and file.length is None:
        raise ValueError("heights in m without positions, so that length is needed, the size along x in m")
    if measurement.unit == "1" and file.length is not None:
        raise ValueError("heights in units of the period, so that length has to be left out")
    unit: Literal["m", "1"] = "m" if file.length is not None else measurement.unit or "1"
    if lengths is None:
        spacing = (file.length or 1.0) / shape[-1]
        lengths = tuple(n * spacing for n in shape)
    processed = process(measurement.heights, lengths, surface.detrend, surface.periodic, file.points)
    if np.ptp(processed.heights) <= _ROUNDING * abs(measurement.heights).max():
        raise ValueError("a flat surface once the trend is gone")
    return Made(processed.heights, processed.lengths, unit, None, processed.done)
