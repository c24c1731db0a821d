"""What stands in the file of a surface, whatever its format: heights, positions or sizes, and the units of them."""

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness.measurements import Content, on_a_grid, split_axes
from gfmd_numba.roughness.surface_text import (
    BYTE_ORDER_MARKS,
    TextTable,
    check_upwards,
    read_rows,
    read_table,
    stated_mark,
)
from gfmd_numba.scene.measured_record import AXES, Heights, grow_downwards
from gfmd_numba.scene.regular_file import UNWRITABLE, can_be_read, check_regular, most_numbers
from gfmd_numba.scene.units import PERIOD, length_unit
from gfmd_numba.storage.netcdf_file import TooLargeError, read_dataset

if TYPE_CHECKING:
    import xarray as xr

_SINGLE = float(np.finfo(np.float32).eps)


def read_content(path: Path) -> Content:
    """Content of a .npy, .nc or text file, or of any format of SurfaceTopography if that is installed.

    Text, whatever its name, holds heights in one column, positions and heights in two, positions along x and y and
    heights in three, or a map in four or more, perhaps with positions in its first row and column. Raises ValueError,
    saying what is wrong and where, for anything else.
    """
    return _READERS.get(path.suffix.lower(), _read_by_content)(path)


def content_of(given: Heights) -> Content:
    """Content of heights that a record holds itself; raises ValueError for those of which only the digest is left."""
    if given.values is None:
        raise ValueError("an array that was not kept: give it again")
    units = {axis: _named(unit) for axis, unit in given.units.items()}
    return Content(given.values, given.positions, units=units)


def read_values(path: Path, dimension: int) -> Reals:
    """Values `[(ny,) nx]` of a .npy or text file, those of a profile in one column or row; raises ValueError.

    Any of them may be not-a-number.
    """
    values = _VALUES[path.suffix](path)
    if path.suffix != ".npy" and 1 in values.shape:
        values = values.ravel()
    if values.ndim != dimension or values.dtype.kind not in "fiu":
        rows = {1: "one row", 2: "rows"}[dimension]
        raise ValueError(f"an array of shape {values.shape} and type {values.dtype}, not {rows} of numbers")
    if min(values.shape) < 4:
        given, least = (" x ".join(map(str, each)) for each in (values.shape, (4,) * dimension))
        raise ValueError(f"{given} values, not at least {least}")
    with np.errstate(over="ignore"):  # of more than double precision
        return np.asarray(values, dtype=np.float64)


def read_npy(path: Path) -> npt.NDArray[Any]:
    """Array of a .npy file; raises ValueError for anything else."""
    check_regular(path, most_numbers())
    try:
        with open(path, "rb") as file:
            return np.asarray(np.lib.format.read_array(file, allow_pickle=False))
    except Exception:  # the header is evaluated as Python: an altered one may end in any of its errors
        raise ValueError("no .npy array of numbers") from None


def load_netcdf(path: Path) -> "xr.Dataset":
    """All of a netCDF file; raises ValueError for anything else and for one that is larger than it looks."""
    check_regular(path, most_numbers())
    try:
        os.fspath(path).encode()
    except UnicodeError:  # netCDF takes no path with bytes of another encoding
        raise ValueError(UNWRITABLE) from None
    if not can_be_read(path, most_numbers()):
        raise ValueError("no netCDF file, or a damaged one")
    try:
        return read_dataset(path, most_numbers(), decode_times=False)
    except TooLargeError:
        raise
    except Exception:  # a damaged file may end in any error of HDF5, netCDF or xarray
        raise ValueError("no netCDF file, or a damaged one") from None


def _values_of_text(path: Path) -> Reals:
    rows = read_rows(path)
    return _without_marks(rows.values, stated_mark(rows.header))


def _without_marks(values: Reals, mark: float | None) -> Reals:
    """Values of which those that are the mark of missing ones, to single precision, are not-a-number."""
    if mark is None:
        return values
    return np.where(np.isclose(values, mark, rtol=_SINGLE, atol=0.0), np.nan, values)


def _read_text(path: Path) -> Content:
    table = read_table(path)
    content = _laid_out(table)
    heights = _without_marks(content.heights, table.mark)
    if np.isnan(heights).sum() == np.isnan(content.heights).sum():
        return content
    done = (*content.done, f"took {table.mark:g} for a missing height, as the header says")
    return replace(content, heights=heights, done=done)


def _laid_out(table: TextTable) -> Content:
    match table.values.shape[1]:
        case 1:
            return _sized(table, table.values.T)
        case 2:
            present = ~np.isnan(table.values).all(axis=1)  # an empty line between rows is no position
            x, heights = table.values[present].T
            units = _stated(x=table.units[0], z=table.units[1])
            return Content(heights, {"x": x}, units=units, done=table.done)
        case 3:
            heights, positions = on_a_grid(*table.values.T)
            units = _stated(**dict(zip("xyz", table.units, strict=True)))
            return Content(heights, positions, units=units, done=table.done)
    heights, positions = split_axes(table.values, table.line)
    if not positions:
        return _sized(table, heights)
    done = (*table.done, "read the first row as positions along x, and the first column as positions along y")
    return Content(heights, positions, units=_stated(z=table.units[0], **table.axis_units), done=done)


def _sized(table: TextTable, heights: Reals) -> Content:
    """Content of heights `[ny, nx]` alone, with the sizes that the header states; of one row, those of points."""
    (ny, nx), along_x, along_y = heights.shape, table.sizes.get("x"), table.sizes.get("y")
    if along_x is None or (ny == 1 and not along_x.of_points):
        about = table.about_lengths
        return Content(heights, units=_stated(z=table.units[0]), done=table.done, about_lengths=about)
    along_y = along_y or along_x._replace(number=along_x.of_field(nx) * (ny / nx), of_points=False)
    return Content(
        heights,
        sizes={"x": along_x.of_field(nx), "y": along_y.of_field(ny)},
        units=_stated(x=along_x.unit, y=along_y.unit, z=table.units[0]),
        done=table.done,
        rounded=True,
    )


def _stated(**units: str | None) -> dict[str, str]:
    return {axis: unit for axis, unit in units.items() if unit is not None}


def _read_by_content(path: Path) -> Content:
    """Text, or a binary format of an instrument."""
    check_regular(path, most_numbers())
    if path.suffix.lower() in _OF_NO_SURFACES:
        raise ValueError(f"a {path.suffix.lower()} file, which gfmd does not open: export the heights as text")
    with open(path, "rb") as file:
        begin = file.read(2**16)
    is_text = begin[:2] in BYTE_ORDER_MARKS or not (_CONTROL.intersection(begin) or begin.startswith(_SDF))
    return _read_text(path) if begin and is_text else _read_instrument(path)


def _read_netcdf(path: Path) -> Content:
    dataset = load_netcdf(path)
    names = [str(name) for name in dataset.data_vars]
    if "height" not in names and len([name for name in names if name != "x"]) != 1:
        raise ValueError(f"variables {', '.join(names)}, not one named height")
    height = dataset["height" if "height" in names else next(name for name in names if name != "x")]
    if set(height.dims) == set(AXES):
        height = height.transpose(*AXES)
    positions = {
        axis: dataset[name]
        for axis, dim in zip(AXES[-height.ndim :], height.dims, strict=False)
        for name in (axis, dim)
        if name in dataset.variables and dataset[name].dims == (dim,)
    }
    units = {"z": height, **positions}
    turned = grow_downwards(height.attrs)
    if not turned and "positive" not in height.attrs:
        check_upwards(str(height.name))
    return Content(
        0.0 - height.values if turned else height.values,
        {axis: each.values for axis, each in positions.items()},
        done=("turned the heights upside down, as the file calls them positive: down",) if turned else (),
        units={axis: _named(each.attrs["units"]) for axis, each in units.items() if "units" in each.attrs},
    )


def _named(attribute: object) -> str:
    """Name of the unit of an attribute, in which 1 is the period."""
    text = str(attribute)
    return PERIOD if text == "1" else length_unit(text) or text


def _read_instrument(path: Path) -> Content:
    try:
        from SurfaceTopography import read_topography
        from SurfaceTopography.Exceptions import CannotDetectFileFormat
    except ImportError:
        needs = "SurfaceTopography, which `pip install 'gfmd-numba[instruments]'` adds"
        raise ValueError(f"no text, but perhaps a format of {needs}: or export the heights as text") from None
    try:
        topography = read_topography(str(path))
        heights = np.ma.filled(np.ma.asarray(topography.heights(), dtype=np.float64), np.nan)
        positions = {} if topography.is_uniform else {"x": np.asarray(topography.positions())}
        # its arrays and sizes are laid out [x, y]
        sizes = dict(zip("xy", map(float, topography.physical_sizes), strict=False)) if topography.is_uniform else {}
        units = {} if topography.unit is None else dict.fromkeys((*sizes, *positions, "z"), _named(topography.unit))
    except CannotDetectFileFormat:
        raise ValueError("no format that SurfaceTopography knows") from None
    except Exception:  # a damaged file may end in any error of its readers
        raise ValueError("a file that SurfaceTopography cannot read") from None
    return Content(heights.T, positions, sizes, units)


_SDF = b"aBCR-"  # begins files of ISO 25178-71 in letters
_CONTROL = {*range(32)} - {*b"\t\n\v\f\r\x1a"}  # characters that no text has
_OF_NO_SURFACES = {
    *(".zip", ".gz", ".bz2", ".xz", ".7z", ".npz", ".xls", ".xlsx", ".ods", ".doc", ".docx", ".pdf", ".html"),
    *(".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".gif"),
}
_READERS: dict[str, Callable[[Path], Content]] = {
    ".npy": lambda path: Content(read_npy(path)),
    ".csv": _read_text,
    ".txt": _read_text,
    ".nc": _read_netcdf,
}
_VALUES: dict[str, Callable[[Path], npt.NDArray[Any]]] = {".npy": read_npy, ".csv": _values_of_text}
