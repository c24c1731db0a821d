"""The user's own profiles, taken as they are: equidistant heights over one period."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

Reals = npt.NDArray[np.float64]


def read_profile(path: Path) -> Reals:
    """Heights `[nx]` of a .npy array, a .csv with one column or a .nc file with one variable, in the file's unit.

    Raises ValueError, saying what is wrong and where, unless there are at least 4 finite numbers in one dimension.
    """
    heights = _READERS[path.suffix](path)
    if heights.ndim != 1 or heights.dtype.kind not in "fiu":
        raise ValueError(f"an array of shape {heights.shape} and type {heights.dtype}, not one row of numbers")
    heights = np.asarray(heights, dtype=np.float64)
    if len(heights) < 4:
        raise ValueError(f"{len(heights)} heights, not at least 4")
    if not np.isfinite(heights).all():
        where = int(np.flatnonzero(~np.isfinite(heights))[0])
        raise ValueError(f"height {heights[where]} at index {where}, not a finite number")
    return heights


def _read_npy(path: Path) -> npt.NDArray[Any]:
    try:
        return np.asarray(np.load(path, allow_pickle=False))
    except (ValueError, EOFError):
        raise ValueError("no .npy array of numbers") from None


def _read_csv(path: Path) -> npt.NDArray[Any]:
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # of an empty file, which has 0 heights
        table = np.loadtxt(path, delimiter=",", ndmin=2)
    if table.shape[1] > 1:
        raise ValueError(f"{table.shape[1]} columns, not one column of equidistant heights")
    return table.ravel()


def _read_netcdf(path: Path) -> npt.NDArray[Any]:
    import xarray as xr

    try:
        with xr.open_dataset(path, engine="netcdf4") as dataset:
            names = [str(name) for name in dataset.data_vars]
            if "height" not in names and len(names) != 1:
                raise ValueError(f"variables {', '.join(names)}, not one named height")
            return np.asarray(dataset["height" if "height" in names else names[0]])
    except OSError:
        raise ValueError("no netCDF file") from None


_READERS = {".npy": _read_npy, ".csv": _read_csv, ".nc": _read_netcdf}
