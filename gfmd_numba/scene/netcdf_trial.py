"""A first reading of netCDF files of unknown origin by a process that may crash or never end, as HDF5 may on them."""

import os
import subprocess
import sys

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
