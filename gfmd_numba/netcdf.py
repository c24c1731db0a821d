"""Datasets as netCDF files."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr


def netcdf(dataset: xr.Dataset) -> memoryview:
    """Content of the netCDF-4 file of a dataset, as `Dataset.to_netcdf` makes it.

    That imports all of dask.distributed, to ask whether a cluster is going to write the file.
    """
    import netCDF4
    from xarray.backends import NetCDF4DataStore

    file = netCDF4.Dataset("in memory", "w", memory=1)
    try:
        dataset.dump_to_store(NetCDF4DataStore(file))  # type: ignore[no-untyped-call]
    finally:
        content: memoryview = file.close()
    return content
