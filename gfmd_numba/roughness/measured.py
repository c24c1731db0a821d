"""The user's own profiles, taken as they are: equidistant heights over one period."""

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

Reals = npt.NDArray[np.float64]


def read_profile(path: Path) -> Reals:
    """Heights `[nx]` of a .npy array, a .csv with one column or a .nc file with one variable, in the file's unit.

    Raises ValueError, saying what is wrong and where, unless there are at least 4 finite numbers in one dimension.
    """
    heights: npt.NDArray[Any] = _READERS[path.suffix](path)
    if heights.ndim != 1 or heights.dtype.kind not in "fiu":
        raise ValueError(f"an array of shape {heights.shape} and type {heights.dtype}, not one row of numbers")
    heights = np.asarray(heights, dtype=np.float64)
    if len(heights) < 4:
        raise ValueError(f"{len(heights)} heights, not at least 4")
    if not np.isfinite(heights).all():
        where = int(np.flatnonzero(~np.isfinite(heights))[0])
        raise ValueError(f"height {heights[where]} at index {where}, not a finite number")
    return heights


def _read_csv(path: Path) -> npt.NDArray[np.generic]:
    table = np.atleast_1d(np.genfromtxt(path, delimiter=",", comments="#", dtype=np.float64))
    if table.ndim == 2:
        raise ValueError(f"{table.shape[1]} columns, not one column of equidistant heights")
    return table


def _read_netcdf(path: Path) -> npt.NDArray[np.generic]:
    import xarray as xr

    with xr.open_dataset(path) as dataset:
        name = "height" if "height" in dataset.data_vars else None
        if name is None and len(dataset.data_vars) == 1:
            (name,) = map(str, dataset.data_vars)
        if name is None:
            raise ValueError(f"variables {', '.join(map(str, dataset.data_vars))}, not one named height")
        return np.asarray(dataset[name])


_READERS = {
    ".npy": lambda path: np.load(path, allow_pickle=False),
    ".csv": _read_csv,
    ".nc": _read_netcdf,
}
