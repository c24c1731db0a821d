"""The one door through which gfmd writes files. They are whole or not there, and never replace somebody else's file.

A file may be replaced or removed if its content proves that gfmd wrote it (see `mark`). Links are not followed. Pipes,
devices and sockets are not opened.
"""

from __future__ import annotations

import csv
import errno
import hashlib
import io
import mmap
import os
import re
import stat
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import IO, TYPE_CHECKING
from uuid import uuid4

from gfmd_numba.storage import mark
from gfmd_numba.storage.netcdf_file import content_of
from gfmd_numba.text.input_error import InputError

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

Ours = Callable[[mark.Content], bool]  # whether content of a file is of gfmd, and may give way

_TEMPORARY = re.compile(r"(.*)\.([0-9a-f]{16})([0-9a-f]{16})\.tmp", re.DOTALL)
_PLAIN = getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)  # the first on Windows
_CAREFUL = _PLAIN | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)  # a pipe does not wait


def replace(path: Path, parts: Iterable[bytes | memoryview], ours: Ours, mode: int = 0o666) -> None:
    """Write a file of some parts under a temporary name in the same directory, force it to disk, then give it its name.

    A file that is there must be `ours`, and its permissions stay; a new file has `mode` less the umask. Raises
    InputError for a file that is not ours, and OSError with the name of the file; the old file is then unharmed.
    """
    check(path, ours)
    unfinished = temporary(path)
    try:
        before = os.lstat(path).st_mode if os.path.lexists(path) else None
        file = os.open(unfinished, os.O_WRONLY | os.O_CREAT | os.O_EXCL | _PLAIN, mode)
        try:
            for part in parts:
                rest = memoryview(part)
                while rest:
                    rest = rest[os.write(file, rest) :]
            if before is not None:
                os.chmod(unfinished, stat.S_IMODE(before))
            os.fsync(file)
        finally:
            os.close(file)
        os.replace(unfinished, path)
        sync(path.parent)
    except OSError as error:
        unfinished.unlink(missing_ok=True)
        raise OSError(error.errno, error.strerror, str(path)) from error
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise


def foreign(path: Path, ours: Ours = mark.is_product) -> str:
    """Return what stands at a path and must stay, as a clause; empty if it is nothing, an empty file, or `ours`."""
    try:
        found = os.lstat(path)
    except (FileNotFoundError, NotADirectoryError):
        return ""
    if stat.S_ISLNK(found.st_mode):
        return "which is a link"
    if not stat.S_ISREG(found.st_mode):
        return "which is not a regular file"
    if found.st_size == 0:
        return ""
    with (
        open(os.open(path, os.O_RDONLY | _CAREFUL), "rb") as file,
        mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content,
    ):
        return "" if ours(content) else "which gfmd did not write, or somebody has changed since"


def check(path: Path, ours: Ours) -> None:
    """Raise InputError if something that must stay has this name."""
    if clause := foreign(path, ours):
        raise InputError.of(path, f"a path {clause}", "no such file, or one as gfmd wrote it (move it away)")


def remove(path: Path, ours: Ours) -> None:
    """Remove a file if it is `ours`; anything else stays."""
    if not foreign(path, ours):
        path.unlink(missing_ok=True)


def opened(path: Path) -> IO[bytes] | None:
    """Return the regular file at a path, for reading; None for a link, a folder, a pipe, or nothing."""
    try:
        if not stat.S_ISREG(os.lstat(path).st_mode):
            return None
        return open(os.open(path, os.O_RDONLY | _CAREFUL), "rb")
    except (FileNotFoundError, NotADirectoryError):
        return None


def read(path: Path) -> bytes | None:
    """Return the content of a regular file, None for anything else."""
    file = opened(path)
    if file is None:
        return None
    with file:
        return file.read()


def open_own(path: Path) -> IO[bytes]:
    """Return a file whose name is gfmd's, new or as it is, for writing; raises InputError unless it is regular."""
    if os.path.lexists(path) and not stat.S_ISREG(os.lstat(path).st_mode):
        raise InputError.of(path, "a path which is not a regular file", "no such file (move it away)")
    return open(os.open(path, os.O_RDWR | os.O_CREAT | _CAREFUL, 0o666), "r+b")


def is_folder(path: Path) -> bool:
    """Return whether a folder is there, and no link to one."""
    return path.is_dir() and not path.is_symlink()


def make_folder(path: Path) -> None:
    """Make a folder, unless it is there; raises InputError for a link or a file."""
    if not os.path.lexists(path):
        os.mkdir(path)
        sync(path.parent)
    if not is_folder(path):
        raise InputError.of(path, "a link or a file", "a folder of that name, or nothing (move it away)")


def sync(folder: Path) -> None:
    """Force the names in a folder to disk, if the system can. Otherwise a rename may be lost when power fails."""
    if os.name == "nt":
        return
    try:
        found = os.open(folder, os.O_RDONLY | _PLAIN)
    except PermissionError:  # it may be written, and not read
        return
    try:
        os.fsync(found)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):  # a file system that has no such thing
            raise OSError(error.errno, error.strerror, str(folder)) from error
    finally:
        os.close(found)


def temporary(path: Path) -> Path:
    """Return a name next to a path for an unfinished file.

    Its last digits follow from the rest, so that no other program's file is mistaken for a leftover of a kill.
    """
    token = uuid4().hex[:16]
    return path.with_name(f"{path.name}.{token}{_proof(path.name, token)}.tmp")


def is_temporary(name: str) -> bool:
    """Return whether a name is one of `temporary`."""
    found = _TEMPORARY.fullmatch(name)
    return found is not None and _proof(found[1], found[2]) == found[3]


def _proof(name: str, token: str) -> str:
    return hashlib.sha256(os.fsencode(f"gfmd {name} {token}")).hexdigest()[:16]


def write_dataset(path: Path, dataset: xr.Dataset) -> None:
    """Write a netCDF file as `replace` does."""
    replace(path, mark.marked(content_of(dataset)), mark.is_product)


def write_picture(path: Path, figure: Figure) -> None:
    """Write a picture of the kind that its suffix names as `replace` does."""
    content = io.BytesIO()
    figure.savefig(content, format=path.suffix.removeprefix(".").lower())
    replace(path, mark.marked(content.getvalue()), mark.is_product)


def write_table(path: Path, columns: Mapping[str, Sequence[object]]) -> None:
    """Write columns by heading as CSV as `replace` does: a line that says who wrote it, the headings, the rows.

    Floats stand with all digits that they need to be read again unchanged.
    """
    content = io.StringIO(newline="")
    table = csv.writer(content, lineterminator="\n")
    table.writerow(columns)
    table.writerows(zip(*columns.values(), strict=True))
    replace(path, [mark.marked_table(content.getvalue().encode())], mark.is_product)
