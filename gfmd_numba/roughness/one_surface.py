"""One surface of a surface file: heights, periods and the spectrum of theory."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness import statistics
from gfmd_numba.roughness.generators import gradient_over_height, random_surface, rms_gradient
from gfmd_numba.roughness.measured import measured_surface
from gfmd_numba.scene.measured_record import Measured
from gfmd_numba.scene.surface_file import SurfaceFile
from gfmd_numba.scene.surfaces import Random

_ROUNDING = 1e-12  # of the largest height, below which a range of heights is rounding


@dataclass(frozen=True)
class Made:
    """Heights `[nx]` or `[ny, nx]` and their periods, in m or L_x; the mean power `[..., nx // 2 + 1]` of theory.

    `power` is None for a measured surface; `done` tells what was done to one, and `doubts` what makes it implausible.
    The `unit` is "m", or "1" for L_x.
    """

    heights: Reals
    lengths: tuple[float, ...]
    unit: Literal["m", "1"]
    power: Reals | None
    done: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()


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
    if record.scaling == "ensemble":
        asked = rms_gradient(record, surface, period) * period / gradient_over_height(surface.generator, surface.shape)
    else:
        asked = float(statistics.rms_height(heights, lengths))
    power *= asked**2 / statistics.moment_of_power(power, surface.shape, 0, lengths)
    return Made(heights, lengths, "1" if file.length is None else "m", power)


def _measured(file: SurfaceFile, record: Measured) -> Made:
    found = measured_surface(record, file.length)
    if np.ptp(found.heights) <= _ROUNDING * found.largest:
        raise ValueError("a flat surface once the trend is gone")
    return Made(found.heights, found.lengths, found.unit, None, found.done, found.doubts)
