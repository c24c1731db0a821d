"""One surface of a surface file: heights, periods and the spectrum of theory beside them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness import statistics
from gfmd_numba.roughness.measurements import read_measurement
from gfmd_numba.roughness.processing import process
from gfmd_numba.roughness.recipe import random_surface, rms_gradient
from gfmd_numba.scene.surface_file import SurfaceFile
from gfmd_numba.scene.surfaces import Measured, Random

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
    return _measured(file, file.surface) if isinstance(file.surface, Measured) else _random(file, file.surface)


def _random(file: SurfaceFile, record: Random) -> Made:
    period, dimension = file.length or 1.0, file.dimension or 1
    surface = random_surface(record, None, period, dimension, file.seed)
    drawn = surface.heights(range(file.realisation, file.realisation + 1))[0]
    heights = rms_gradient(record, surface, period) * period * drawn
    lengths = (period,) * dimension
    power = surface.generator.power(surface.shape)
    power *= statistics.rms_height(heights, lengths) ** 2 / statistics.moment_of_power(power, surface.shape, 0, lengths)
    return Made(heights, lengths, "1" if file.length is None else "m", power)


def _measured(file: SurfaceFile, surface: Measured) -> Made:
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
    processed = process(measurement.heights, lengths, surface.detrend, surface.periodic, surface.points)
    if np.ptp(processed.heights) <= _ROUNDING * abs(measurement.heights).max():
        raise ValueError("a flat surface once the trend is gone")
    return Made(processed.heights, processed.lengths, unit, None, processed.done)
