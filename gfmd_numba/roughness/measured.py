"""The user's own profiles, taken as they are: equidistant heights over one period."""

import re
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness.processing import process
from gfmd_numba.scene.netcdf_trial import can_be_read
from gfmd_numba.scene.quantities import LARGEST
from gfmd_numba.scene.regular_file import check_regular, most_numbers
from gfmd_numba.scene.surfaces import Measured

if TYPE_CHECKING:
    import xarray as xr


_BRACKETED = re.compile(r"[\[(]\s*(\w{1,10})\s*[\])]")
_LENGTHS = frozenset(["m", "km", "dm", "cm", "mm", "um", "µm", "μm", "micron", "nm", "pm", "Å", "in", "inch", "mil"])


def read_profile(path: Path, length: float | None = None) -> Reals:
    """Heights `[nx]` of a .npy array, a .csv with one column or a .nc file with one variable, over one period.

    Heights and the .nc file's x are in m beside a period in m, in units of the period without one. Raises
    ValueError, saying what is wrong and where, unless there are at least 4 finite numbers in one dimension.
    """
    heights = read_column(path, length)
    if path.suffix == ".csv":
        for unit in header_units(path):
            _check_unit("heights", unit, length)
    check_finite(heights)
    return heights


def measured_profile(record: Measured, length: float | None) -> Reals:
    """Heights `[nx]` of a record over one period, in L_x: read, then made periodic as it asks; raises ValueError.

    The period `length` is that of the result: of a profile that is mirrored, the file holds one half. Heights are in
    m beside a period in m, in units of the period without one.
    """
    measured = None if length is None else length / (2.0 if record.periodic == "mirror" else 1.0)
    heights = read_profile(Path(record.file), measured) / (length or 1.0)
    if (record.detrend, record.periodic, record.points) == ("none", "none", None):
        return heights
    return process(heights, (1.0,), record.detrend, record.periodic, record.points).heights


def check_finite(heights: Reals) -> None:
    """Raise ValueError unless all heights are finite numbers whose squares and gradients are finite, too."""
    outside = np.argwhere(~(abs(heights) <= LARGEST))
    if len(outside):
        where, more = ", ".join(map(str, outside[0])), f" and {len(outside) - 1} more" if len(outside) > 1 else ""
        allowed = "a finite number" if not np.isfinite(heights[tuple(outside[0])]) else f"at most {LARGEST:g} in size"
        raise ValueError(f"height {heights[tuple(outside[0])]} at index {where}{more}, not {allowed}")


def read_column(path: Path, length: float | None = None) -> Reals:
    """Values `[nx]` of such a file, of which any may be not-a-number; raises ValueError otherwise likewise."""
    values = _read_netcdf(path, length) if path.suffix == ".nc" else _READERS[path.suffix](path)
    if values.ndim != 1 or values.dtype.kind not in "fiu":
        raise ValueError(f"an array of shape {values.shape} and type {values.dtype}, not one row of numbers")
    if len(values) < 4:
        raise ValueError(f"{len(values)} values, not at least 4")
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


def read_table(path: Path) -> npt.NDArray[Any]:
    """Rows and columns of numbers of a .csv file; raises ValueError for anything else."""
    check_regular(path, most_numbers())
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # of an empty file, which has 0 heights
        return np.loadtxt(path, delimiter=",", ndmin=2, encoding="utf-8-sig")


def header_units(path: Path) -> list[str]:
    """Units of length that stand in brackets in the lines before the numbers of a .csv file, as in `# x [mm]`."""
    found: list[str] = []
    with open(path, encoding="utf-8-sig") as lines:
        for line in lines:
            if line.strip() and not line.startswith("#"):
                break
            found += [unit for unit in _BRACKETED.findall(line) if unit in _LENGTHS]
    return found


def _read_csv(path: Path) -> npt.NDArray[Any]:
    table = read_table(path)
    if table.shape[1] > 1:
        raise ValueError(f"{table.shape[1]} columns, not one column of equidistant values")
    return table.ravel()


def _read_netcdf(path: Path, length: float | None) -> npt.NDArray[Any]:
    dataset = load_netcdf(path)
    height = height_of(dataset)
    positions = {"x", *height.coords} & {str(name) for name in dataset.variables}
    along = [dataset[name] for name in positions if dataset[name].dims == height.dims]
    _check_units(height, length)
    for position in along if height.ndim == 1 else []:
        _check_units(position, length)
        period = 1.0 if length is None and position.attrs.get("units") == "1" else length
        _check_positions(str(position.name), position.values, period, "m" if length else "")
    return np.asarray(height)


def load_netcdf(path: Path) -> "xr.Dataset":
    """All of a netCDF file; raises ValueError for anything else and for one that is larger than it looks."""
    import xarray as xr

    check_regular(path, most_numbers())
    if not can_be_read(path, most_numbers()):
        raise ValueError("no netCDF file, or a damaged one")
    try:
        with xr.open_dataset(path, engine="netcdf4", decode_times=False) as dataset:
            size = dataset.nbytes  # compressed, or never written, it may be any
            if size <= most_numbers():
                return dataset.load()
    except Exception:  # a damaged file may end in any error of HDF5, netCDF or xarray
        raise ValueError("no netCDF file, or a damaged one") from None
    raise ValueError(f"{size / 1e6:.4g} MB of numbers, more than {most_numbers() / 1e6:.4g} MB")


def height_of(dataset: "xr.Dataset") -> "xr.DataArray":
    """The one variable of a file, or that named height; raises ValueError."""
    names = [str(name) for name in dataset.data_vars]
    if "height" not in names and len(names) != 1:
        raise ValueError(f"variables {', '.join(names)}, not one named height")
    return dataset["height" if "height" in names else names[0]]


def _check_units(variable: "xr.DataArray", length: float | None) -> None:
    if "units" in variable.attrs:
        _check_unit(str(variable.name), variable.attrs["units"], length)


def _check_unit(what: str, given: object, length: float | None) -> None:
    if given != ("1" if length is None else "m"):
        allowed = "1, as the scene has no length" if length is None else "m, as the scene's length"
        raise ValueError(f"{what} in units {given!r}, not in {allowed}")


def _check_positions(name: str, x: npt.NDArray[Any], period: float | None, unit: str) -> None:
    """Raise ValueError unless positions ascend in equal steps that make up the period, if that is known."""
    if x.dtype.kind not in "fiu" or len(x) < 2 or not (abs(x) <= LARGEST).all():
        raise ValueError(f"{name} without finite numbers")
    rounding = 4 * np.finfo(x.dtype).eps * abs(x).max() if x.dtype.kind == "f" else 0.0
    x = x.astype(np.float64)
    spacing = (x[-1] - x[0]) / (len(x) - 1)
    uneven = abs(np.diff(x) - spacing) > 1e-6 * abs(spacing) + rounding
    if spacing <= 0 or uneven.any():
        where = int(uneven.argmax())
        raise ValueError(f"{name} of {x[where]:g} and {x[where + 1]:g} at index {where}, not equidistant and ascending")
    if period is not None and abs(len(x) * spacing - period) > 1e-6 * period + rounding:
        allowed = f"the scene's length of {period:.7g} m" if unit else "1, the period"
        raise ValueError(f"{name} over {f'{len(x) * spacing:.7g} {unit}'.strip()}, not over {allowed}")


_READERS = {".npy": read_npy, ".csv": _read_csv}
