"""The netCDF files of campaigns and contacts: which one a path means, and whether it can be read."""

import os
from contextlib import suppress
from math import inf
from pathlib import Path

import xarray as xr

from gfmd_numba.scene.document import read_document
from gfmd_numba.scene.regular_file import can_be_read, check_regular, most_numbers
from gfmd_numba.storage import mark
from gfmd_numba.storage.netcdf_file import read_dataset
from gfmd_numba.text.input_error import InputError

_SHARE = 4  # of what a file of one surface may have: nothing is solved with it


def results_file(path: Path) -> Path:
    """Return the file of results that a path means, itself or the one that a run left in it; raises InputError."""
    if not os.path.isdir(path):  # also of a path that no file can have
        return path
    with suppress(InputError):
        data = read_document(path / "campaign.yaml").data
        name = data.get("name") if isinstance(data, dict) else None
        if isinstance(name, str) and (path / f"{name}.nc").is_file():
            return path / f"{name}.nc"
    files = sorted(path.glob("*.nc"))
    if len(files) != 1:
        raise InputError.of(
            path,
            f"a directory with {len(files)} netCDF files",
            "the output directory of a finished `gfmd run`, or a netCDF file",
        )
    return files[0]


def read_results(path: Path) -> xr.Dataset:
    """Return the dataset of a path as in `results_file`; raises InputError."""
    file = results_file(path)
    try:
        check_regular(file, most_numbers() * _SHARE)
    except ValueError as error:
        raise InputError.of(file, error, "a netCDF file that gfmd has written") from None
    try:
        content = file.read_bytes()
        if not (mark.is_product(content) if mark.has_mark(content) else can_be_read(file, most_numbers())):
            raise ValueError  # the HDF5 library would find wrong numbers in it, or no end
        dataset = read_dataset(file, inf)
        return dataset.assign({name: each.astype(str) for name, each in dataset.variables.items() if each.dtype == "O"})
    except (OSError, ValueError, RuntimeError):
        given = "a file that is not netCDF or is damaged"
        raise InputError.of(file, given, "a netCDF file that gfmd has written") from None
