"""What may be read of a path that a user names: regular files, no more of them than is sensible, and netCDF that ends.

HDF5 may crash or never end on a netCDF file of unknown origin: another process reads it first.
"""

import errno
import os
import stat
import subprocess
import sys
from functools import lru_cache

UNWRITABLE = "a path with letters that the locale does not know: set PYTHONUTF8=1, or another LC_ALL"
MOST_TEXT = 2**20  # bytes of a YAML file, which takes ten seconds to read
_PARTS = 16  # of memory, of which the numbers of one file may fill one: solving takes the others
START = 10  # seconds of processor time that a process may take to start
_SLOWEST = 5e6  # bytes that it reads in a second, at least
_PATIENCE = 30  # wall time over processor time on a machine with much else to do
_READ = """
import sys
try:
    import resource
    resource.setrlimit(resource.RLIMIT_CPU, (int(sys.argv[3]),) * 2)
except ImportError:
    pass
from netCDF4 import Dataset
with Dataset(sys.argv[1]) as dataset:
    for variable in dataset.variables.values():
        for name in variable.ncattrs():
            variable.getncattr(name)
        if variable.size * 8 <= int(sys.argv[2]):
            variable[...]
"""


def check_regular(path: str | os.PathLike[str], most: int) -> None:
    """Raise ValueError unless a path is a regular file of at most so many bytes; it is not opened, as pipes wait."""
    try:
        found = os.stat(path)
    except OSError as error:
        raise ValueError(f"a path that cannot be read ({error.strerror})") from None
    except UnicodeError:
        raise ValueError(UNWRITABLE) from None
    except ValueError:
        raise ValueError("a path with a zero byte") from None
    if stat.S_ISDIR(found.st_mode):
        raise ValueError(f"a path that cannot be read ({os.strerror(errno.EISDIR)})")
    if not stat.S_ISREG(found.st_mode):
        raise ValueError("a device, pipe or socket, not a regular file")
    if found.st_size > most:
        raise ValueError(f"a file of {found.st_size / 1e6:.4g} MB, more than {most / 1e6:.4g} MB")


def read_regular(path: str | os.PathLike[str], most: int) -> bytes:
    """Content of a regular file of at most so many bytes; raises ValueError, saying what it is, for anything else."""
    check_regular(path, most)
    try:
        with open(path, "rb") as file:
            content = file.read(most + 1)
    except OSError as error:
        raise ValueError(f"a path that cannot be read ({error.strerror})") from None
    if len(content) > most:  # it grew, or told no size, as in /proc
        raise ValueError(f"a file of more than {most / 1e6:.4g} MB")
    return content


@lru_cache
def most_numbers() -> int:
    """Bytes that a file of numbers may have on this machine."""
    import psutil

    return int(psutil.virtual_memory().total) // _PARTS


def can_be_read(path: str | os.PathLike[str], most: int) -> bool:
    """Whether another process reads all variables of a netCDF file, of at most so many bytes each, to an end."""
    seconds = START + int(os.stat(path).st_size / _SLOWEST)
    # -P: no module of the folder that the user happens to be in
    command = [sys.executable, "-P", "-c", _READ, os.fspath(path), str(most), str(seconds)]
    nothing = subprocess.DEVNULL
    try:
        done = subprocess.run(command, stdin=nothing, stdout=nothing, stderr=nothing, timeout=_PATIENCE * seconds)
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0
