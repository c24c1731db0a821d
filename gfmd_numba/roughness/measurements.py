"""Measured profiles and maps, which are still to be made periodic: heights, with the spacing if the file tells it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness.measured import check_finite, header_units, height_of, load_netcdf, read_npy, read_table
from gfmd_numba.scene.quantities import LARGEST
from gfmd_numba.scene.regular_file import check_regular, most_numbers

_UNEVEN = 1e-3  # of the spacing, by which positions in a file may be rounded


@dataclass(frozen=True)
class Measurement:
    """Heights `[nx]` or `[ny, nx]` and the sizes of the measured field (L_x,) or (L_y, L_x), None if not told.

    Their `unit` is "m", or "1" for L_x; None if the file does not tell it.
    """

    heights: Reals
    lengths: tuple[float, ...] | None
    unit: Literal["m", "1"] | None = None


def read_measurement(path: Path) -> Measurement:
    """Profile or map of a .npy, .csv or .nc file, or of any format of SurfaceTopography if that is installed.

    A .csv holds heights in one column, positions and heights in two, or a map in four or more. Raises ValueError for
    anything but at least 4 finite heights in each direction, at equal spacing, and for positions without a unit.
    """
    found = _READERS.get(path.suffix, _read_instrument)(path)
    if found.heights.ndim not in (1, 2) or found.heights.dtype.kind not in "fiu":
        kind = f"an array of shape {found.heights.shape} and type {found.heights.dtype}"
        raise ValueError(f"{kind}, not a row or a table of numbers")
    return replace(found, heights=_checked(found.heights))


def _checked(heights: npt.NDArray[Any]) -> Reals:
    with np.errstate(over="ignore"):  # of more than double precision
        heights = np.asarray(heights, dtype=np.float64)
    if min(heights.shape) < 4:
        raise ValueError(f"{' x '.join(map(str, heights.shape))} heights, not at least 4")
    check_finite(heights)
    return heights


def _size(positions: npt.NDArray[Any], name: str) -> float:
    """Length of the field of equidistant positions, one spacing for each."""
    if positions.dtype.kind not in "fiu" or not (abs(positions) <= LARGEST).all():
        raise ValueError(f"positions {name} that are not all finite numbers")
    steps = np.diff(np.asarray(positions, dtype=np.float64))
    mean = steps.mean() if steps.size else np.nan
    if not mean > 0.0:
        raise ValueError(f"positions {name} that do not increase")
    worst = int(np.argmax(abs(steps / mean - 1.0)))
    if not abs(steps[worst] / mean - 1.0) <= _UNEVEN:
        raise ValueError(
            f"a spacing of {steps[worst]:g} in {name} at index {worst}, where {mean:g} is the mean: not equidistant"
        )
    return float(mean * positions.size)


def _read_npy(path: Path) -> Measurement:
    return Measurement(read_npy(path), None)


def _metres(units: Iterable[object]) -> Literal["m"] | None:
    """Whether the units that a file states are metres, None if it states none; raises ValueError for others."""
    stated = dict.fromkeys(units)
    if stated and list(stated) != ["m"]:
        raise ValueError(f"numbers in units {', '.join(map(repr, stated))}, not all in m: convert them first")
    return "m" if stated else None


def _read_csv(path: Path) -> Measurement:
    table, unit = read_table(path), _metres(header_units(path))
    match table.shape[1]:
        case 0 | 1:
            return Measurement(table.ravel(), None, unit)
        case 2:
            length = _size(table[:, 0], "x")
            if unit is None:
                raise ValueError(
                    "two columns without a unit: begin the file with the line `# x [m], height [m]` if that is what "
                    "they are, or leave the heights alone, in m with `length` and in L_x without"
                )
            return Measurement(table[:, 1], (length,), unit)
        case 3:
            raise ValueError("3 columns, not one of heights, two of positions and heights, or a map")
    return Measurement(table, None, unit)


def _read_netcdf(path: Path) -> Measurement:
    heights = height_of(load_netcdf(path))
    positions = [heights[dim] for dim in heights.dims if dim in heights.coords]
    units = [each.attrs["units"] for each in (heights, *positions) if "units" in each.attrs]
    unit: Literal["m", "1"] | None = "1" if set(map(str, units)) == {"1"} else _metres(map(str, units))
    if len(positions) < heights.ndim:
        return Measurement(heights.values, None, unit)
    lengths = tuple(_size(each.values, str(each.name)) for each in positions)
    if unit is None:
        raise ValueError("positions and heights without units: give both the attribute units, m or 1 (of the period)")
    return Measurement(heights.values, lengths, unit)


def _read_instrument(path: Path) -> Measurement:
    try:
        from SurfaceTopography import read_topography
        from SurfaceTopography.Exceptions import CannotDetectFileFormat
    except ImportError:
        needs = "SurfaceTopography, which `pip install 'gfmd-numba[instruments]'` adds"
        raise ValueError(f"a format {path.suffix} that is read only with {needs}") from None
    check_regular(path, most_numbers())
    try:
        topography = read_topography(str(path))
        if topography.unit is not None:
            topography = topography.to_unit("m")
        heights = topography.heights()
    except CannotDetectFileFormat:
        raise ValueError("no format that SurfaceTopography knows") from None
    except Exception:  # a damaged file may end in any error of its readers
        raise ValueError("a file that SurfaceTopography cannot read") from None
    if topography.unit is None:
        raise ValueError("a file that does not tell its unit of length: write the heights in m to a .csv or .npy file")
    if topography.dim == 1 and not topography.is_uniform:
        return Measurement(np.asarray(heights), (_size(topography.positions(), "x"),), "m")
    heights = np.ma.filled(np.ma.asarray(heights, dtype=np.float64), np.nan)
    # its maps are laid out [x, y]
    return Measurement(np.asarray(heights.T), tuple(float(size) for size in topography.physical_sizes[::-1]), "m")


_READERS: dict[str, Callable[[Path], Measurement]] = {".npy": _read_npy, ".csv": _read_csv, ".nc": _read_netcdf}
