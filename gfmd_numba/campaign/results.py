"""The netCDF files of campaigns and contacts: which one a path means, and whether it can be read."""

from pathlib import Path

import xarray as xr

from gfmd_numba.scene.document import InputError, read_document


def results_file(path: Path) -> Path:
    """The file of results that a path means, itself or the one a run left in it; raises InputError."""
    if not path.is_dir():
        return path
    named = path / f"{campaign_name(path / 'campaign.yaml')}.nc"
    if named.is_file():
        return named
    files = sorted(path.glob("*.nc"))
    if len(files) != 1:
        raise InputError(
            f"{path}: given a directory with {len(files)} netCDF files; "
            "allowed: the output directory of a finished `gfmd run`, or a netCDF file"
        )
    return files[0]


def campaign_name(label: Path) -> str | None:
    """Name of the campaign whose file lies in its output directory, None if that cannot be read."""
    try:
        data = read_document(label).data
    except InputError:
        return None
    name = data.get("name") if isinstance(data, dict) else None
    return name if isinstance(name, str) else None


def read_results(path: Path) -> xr.Dataset:
    """Dataset of a path as in `results_file`; raises InputError."""
    file = results_file(path)
    try:
        with xr.open_dataset(file, engine="netcdf4") as dataset:
            return dataset.load()
    except (OSError, ValueError) as error:
        given = "no file" if isinstance(error, FileNotFoundError) else "a file that is not netCDF or is damaged"
        raise InputError(f"{file}: given {given}; allowed: a netCDF file that gfmd has written") from None
