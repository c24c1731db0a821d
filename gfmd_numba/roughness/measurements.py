"""Measured profiles and maps, which are still to be made periodic: heights, with the spacing if the file tells it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gfmd_numba.roughness.measured import read_npy, read_table

Reals = npt.NDArray[np.float64]

_UNEVEN = 1e-3  # of the spacing, by which positions in a file may be rounded


@dataclass(frozen=True)
class Measurement:
    """Heights `[nx]` or `[ny, nx]` and the sizes of the measured field (L_x,) or (L_y, L_x), None if not told.

    Both are in the file's unit of length, or in m if the file names its unit.
    """

    heights: Reals
    lengths: tuple[float, ...] | None


def read_measurement(path: Path) -> Measurement:
    """Profile or map of a .npy, .csv or .nc file, or of any format of SurfaceTopography if that is installed.

    A .csv holds heights in one column, positions and heights in two, or a map in four or more. Raises ValueError for
    anything but at least 4 finite heights in each direction, at equal spacing.
    """
    found = _READERS.get(path.suffix, _read_instrument)(path)
    if found.heights.ndim not in (1, 2) or found.heights.dtype.kind not in "fiu":
        kind = f"an array of shape {found.heights.shape} and type {found.heights.dtype}"
        raise ValueError(f"{kind}, not a row or a table of numbers")
    return Measurement(_checked(found.heights), found.lengths)


def _checked(heights: npt.NDArray[Any]) -> Reals:
    heights = np.asarray(heights, dtype=np.float64)
    if min(heights.shape) < 4:
        raise ValueError(f"{' x '.join(map(str, heights.shape))} heights, not at least 4")
    if not np.isfinite(heights).all():
        gaps = np.argwhere(~np.isfinite(heights))
        where = ", ".join(map(str, gaps[0]))
        more = f" and {len(gaps) - 1} more gaps" if len(gaps) > 1 else ""
        raise ValueError(f"height {heights[tuple(gaps[0])]} at index {where}{more}, not a finite number")
    return heights


def _size(positions: npt.NDArray[Any], name: str) -> float:
    """Length of the field of equidistant positions, one spacing for each."""
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


def _read_csv(path: Path) -> Measurement:
    table = read_table(path)
    match table.shape[1]:
        case 0 | 1:
            return Measurement(table.ravel(), None)
        case 2:
            return Measurement(table[:, 1], (_size(table[:, 0], "x"),))
        case 3:
            raise ValueError("3 columns, not one of heights, two of positions and heights, or a map")
    return Measurement(table, None)


def _read_netcdf(path: Path) -> Measurement:
    import xarray as xr

    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            names = [str(name) for name in dataset.data_vars]
            if "height" not in names and len(names) != 1:
                raise ValueError(f"variables {', '.join(names)}, not one named height")
            heights = dataset["height" if "height" in names else names[0]]
            told = all(dim in heights.coords for dim in heights.dims)
            lengths = tuple(_size(heights[dim].values, str(dim)) for dim in heights.dims) if told else None
            return Measurement(heights.values, lengths or None)
    except OSError:
        raise ValueError("no netCDF file") from None


def _read_instrument(path: Path) -> Measurement:
    try:
        from SurfaceTopography import read_topography
        from SurfaceTopography.Exceptions import CannotDetectFileFormat
    except ImportError:
        needs = "SurfaceTopography, which `pip install 'gfmd-numba[instruments]'` adds"
        raise ValueError(f"a format {path.suffix} that is read only with {needs}") from None
    try:
        topography = read_topography(str(path))
    except CannotDetectFileFormat:
        raise ValueError("no format that SurfaceTopography knows") from None
    if topography.unit is not None:
        topography = topography.to_unit("m")
    heights = topography.heights()
    if topography.dim == 1 and not topography.is_uniform:
        return Measurement(np.asarray(heights), (_size(topography.positions(), "x"),))
    heights = np.ma.filled(np.ma.asarray(heights, dtype=np.float64), np.nan)
    # its maps are laid out [x, y]
    return Measurement(np.asarray(heights.T), tuple(float(size) for size in topography.physical_sizes[::-1]))


_READERS: dict[str, Callable[[Path], Measurement]] = {".npy": _read_npy, ".csv": _read_csv, ".nc": _read_netcdf}
