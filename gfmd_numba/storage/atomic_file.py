"""Files that are whole or not there, whatever ends the writing: a kill, a full disk, an error."""

from __future__ import annotations

import csv
import errno
import io
import os
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from uuid import uuid4

from gfmd_numba.storage import mark

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

TEMPORARY = r".*\.[0-9a-f]{32}\.tmp"  # names of what a kill may leave behind


def replace(path: Path, content: bytes | memoryview, mode: int = 0o666) -> None:
    """Write a file under a temporary name beside it, force it to disk, then give it its name.

    A link is followed, and a file that is there passes on its permissions; a new one has `mode` less the umask.
    Raises OSError with the name of the file; what stood there is then unharmed.
    """
    target = Path(os.path.realpath(path))
    temporary = target.with_name(f"{target.name}.{uuid4().hex}.tmp")
    try:
        if target.exists() and not target.is_file():  # a device would be lost
            raise FileExistsError(errno.EEXIST, "Not a regular file")
        with open(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | _BINARY, mode), "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if target.exists():
            shutil.copymode(target, temporary)
        os.replace(temporary, target)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise OSError(error.errno, error.strerror, str(path)) from error
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def create(path: Path, content: bytes) -> None:
    """Write a new file; raises FileExistsError for one that is there, OSError as `replace` does."""
    os.close(os.open(path, os.O_CREAT | os.O_EXCL, 0o666))
    try:
        replace(path, content)
    except BaseException:
        path.unlink()
        raise


def write_dataset(path: Path, dataset: xr.Dataset) -> None:
    """Write a netCDF file as `replace` does."""
    replace(path, netcdf(dataset))


def netcdf(dataset: xr.Dataset) -> memoryview:
    """Content of the netCDF-4 file of a dataset, as `Dataset.to_netcdf` makes it.

    Its attribute `software` says that gfmd wrote it. It is made in memory, as the netCDF library does not say why a
    disk refused it. `Dataset.to_netcdf` would import all of dask.distributed, to ask whether a cluster is going to
    write the file.
    """
    import netCDF4
    from xarray.backends import NetCDF4DataStore

    file = netCDF4.Dataset("in memory", "w", memory=1)
    try:
        dataset.assign_attrs(mark.IN_DATASETS).dump_to_store(NetCDF4DataStore(file))
    finally:
        content: memoryview = file.close()
    return content


def write_picture(path: Path, figure: Figure, dpi: int) -> None:
    """Write a picture of the kind that its suffix names as `replace` does."""
    content, kind = io.BytesIO(), path.suffix.removeprefix(".").lower()
    figure.savefig(content, format=kind, dpi=dpi, metadata=mark.in_picture(kind))
    replace(path, content.getvalue())


def write_table(path: Path, columns: Mapping[str, Sequence[object]]) -> None:
    """Write columns by heading as CSV as `replace` does: a line that says who wrote it, the headings, the rows.

    Floats stand with all digits that they need to be read again unchanged.
    """
    content = io.StringIO(newline="")
    table = csv.writer(content, lineterminator="\n")
    table.writerow(columns)
    table.writerows(zip(*columns.values(), strict=True))
    replace(path, mark.marked_table(content.getvalue().encode()))


_BINARY = getattr(os, "O_BINARY", 0)  # on Windows
