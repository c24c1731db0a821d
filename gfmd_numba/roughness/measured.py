"""The user's own profiles, taken as they are: equidistant heights over one period."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

Reals = npt.NDArray[np.float64]


def read_profile(path: Path, length: float | None = None) -> Reals:
    """Heights `[nx]` of a .npy array, a .csv with one column or a .nc file with one variable, over one period.

    Heights and the .nc file's x are in m beside a period in m, in units of the period without one. Raises
    ValueError, saying what is wrong and where, unless there are at least 4 finite numbers in one dimension.
    """
    heights = read_column(path, length)
    if not np.isfinite(heights).all():
        where = int(np.flatnonzero(~np.isfinite(heights))[0])
        raise ValueError(f"height {heights[where]} at index {where}, not a finite number")
    return heights


def read_column(path: Path, length: float | None = None) -> Reals:
    """Values `[nx]` of such a file, of which any may be not-a-number; raises ValueError otherwise likewise."""
    values = _read_netcdf(path, length) if path.suffix == ".nc" else _READERS[path.suffix](path)
    if values.ndim != 1 or values.dtype.kind not in "fiu":
        raise ValueError(f"an array of shape {values.shape} and type {values.dtype}, not one row of numbers")
    if len(values) < 4:
        raise ValueError(f"{len(values)} values, not at least 4")
    return np.asarray(values, dtype=np.float64)


def read_npy(path: Path) -> npt.NDArray[Any]:
    """Array of a .npy file; raises ValueError for anything else."""
    try:
        return np.asarray(np.load(path, allow_pickle=False))
    except (ValueError, EOFError):
        raise ValueError("no .npy array of numbers") from None


def read_table(path: Path) -> npt.NDArray[Any]:
    """Rows and columns of numbers of a .csv file; raises ValueError for anything else."""
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # of an empty file, which has 0 heights
        return np.loadtxt(path, delimiter=",", ndmin=2, encoding="utf-8-sig")


def _read_csv(path: Path) -> npt.NDArray[Any]:
    table = read_table(path)
    if table.shape[1] > 1:
        raise ValueError(f"{table.shape[1]} columns, not one column of equidistant values")
    return table.ravel()


def _read_netcdf(path: Path, length: float | None) -> npt.NDArray[Any]:
    import xarray as xr

    try:
        with xr.open_dataset(path, engine="netcdf4", decode_times=False) as dataset:
            names = [str(name) for name in dataset.data_vars]
            if "height" not in names and len(names) != 1:
                raise ValueError(f"variables {', '.join(names)}, not one named height")
            height = dataset["height" if "height" in names else names[0]].load()
            positions = {"x", *height.coords} & {str(name) for name in dataset.variables}
            along = [dataset[name].load() for name in positions if dataset[name].dims == height.dims]
    except (OSError, RuntimeError):
        raise ValueError("no netCDF file, or a damaged one") from None
    _check_units(height, length)
    for position in along if height.ndim == 1 else []:
        _check_units(position, length)
        _check_positions(str(position.name), position.values, length)
    return np.asarray(height)


def _check_units(variable: Any, length: float | None) -> None:
    given = variable.attrs.get("units")
    if given not in (None, "1" if length is None else "m"):
        allowed = "1, as the scene has no length" if length is None else "m, as the scene's length"
        raise ValueError(f"{variable.name} in units {given!r}, not in {allowed}")


def _check_positions(name: str, x: npt.NDArray[Any], length: float | None) -> None:
    """Raise ValueError unless positions ascend in equal steps that make up the period."""
    if x.dtype.kind not in "fiu" or len(x) < 2 or not np.isfinite(x).all():
        raise ValueError(f"{name} without finite numbers")
    rounding = 4 * np.finfo(x.dtype).eps * abs(x).max() if x.dtype.kind == "f" else 0.0
    x = x.astype(np.float64)
    spacing = (x[-1] - x[0]) / (len(x) - 1)
    uneven = abs(np.diff(x) - spacing) > 1e-6 * abs(spacing) + rounding
    if spacing <= 0 or uneven.any():
        where = int(uneven.argmax())
        raise ValueError(f"{name} of {x[where]:g} and {x[where + 1]:g} at index {where}, not equidistant and ascending")
    if length is not None and abs(len(x) * spacing - length) > 1e-6 * length + rounding:
        raise ValueError(f"{name} over {len(x) * spacing:.7g} m, not over the scene's length of {length:.7g} m")


_READERS = {".npy": read_npy, ".csv": _read_csv}
