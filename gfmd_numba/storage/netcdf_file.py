"""NetCDF files as xarray reads and writes them, by one thread of the process at a time.

The HDF5 library ends the process where two threads are in it. xarray guards the numbers of a file, but not its making,
opening and closing, nor attributes.
"""

from __future__ import annotations

import os
from threading import RLock
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

_ONE_THREAD = RLock()


class TooLargeError(ValueError):
    """A file has more numbers than fit."""


def read_dataset(path: str | os.PathLike[str], most: float, decode_times: bool = True) -> xr.Dataset:
    """Return all of a netCDF file; raises TooLargeError for more than `most` bytes, and any error of the library.

    Compressed, or never written, the numbers of a small file may be many.
    """
    import xarray as xr

    with _ONE_THREAD, xr.open_dataset(path, engine="netcdf4", decode_times=decode_times) as dataset:
        if dataset.nbytes > most:
            raise TooLargeError(f"{dataset.nbytes / 1e6:.4g} MB of numbers, more than {most / 1e6:.4g} MB")
        return dataset.load()


class _Written:
    """The numbers of variables, written when all of these are defined: a file changes between the two at a cost."""

    def __init__(self) -> None:
        self._pairs: list[tuple[Any, Any]] = []

    def add(self, source: Any, target: Any, region: None = None) -> None:
        """Remember the numbers of a variable."""
        self._pairs.append((source, target))

    def sync(self) -> None:
        """Write all numbers."""
        for source, target in self._pairs:
            target[...] = source


def content_of(dataset: xr.Dataset) -> memoryview:
    """Return the content of the netCDF-4 file of a dataset, as `Dataset.to_netcdf` makes it.

    It is made in memory, because the netCDF library does not say why a disk refused it. `Dataset.to_netcdf` would
    import all of dask.distributed, only to ask whether a cluster is going to write the file. Texts are arrays of
    characters: a process ends in a segmentation fault when it opens a file with strings of variable length again
    before it has closed it (HDF5 issue 5359).
    """
    import netCDF4
    from xarray.backends import NetCDF4DataStore

    dataset, numbers = dataset.copy(), _Written()
    for variable in dataset.variables.values():
        if variable.dtype.kind in "UO":
            variable.encoding = {"dtype": "S1"}
    with _ONE_THREAD:
        file = netCDF4.Dataset("in memory", "w", memory=1)
        try:
            dataset.dump_to_store(NetCDF4DataStore(file), writer=numbers)
            numbers.sync()
        finally:
            content: memoryview = file.close()
    return content
