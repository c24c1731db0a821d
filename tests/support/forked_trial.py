"""The first reading of a netCDF file in a fork of a process that has imported netCDF4, in milliseconds."""

import os
import sys

import netCDF4  # noqa: F401  what every fork finds imported
import pytest

from gfmd_numba.campaign import results
from gfmd_numba.roughness import surface_files
from gfmd_numba.scene import regular_file


def can_be_read(path, most):
    """Return what the trial of the package does: the same script, under the same bounds but for the wall time."""
    child = os.fork()
    if child == 0:
        try:
            silence = os.open(os.devnull, os.O_WRONLY)
            os.dup2(silence, 1)
            os.dup2(silence, 2)
            sys.argv = ["-c", os.fspath(path), str(most), str(regular_file.START)]
            exec(regular_file._READ, {})
            os._exit(0)
        finally:
            os._exit(1)
    return os.waitpid(child, 0)[1] == 0


@pytest.fixture(scope="module", autouse=True)
def tried_in_a_fork():
    """NetCDF files are tried in a fork; elsewhere this may be unsafe, and takes a new process."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (surface_files, results) if sys.platform == "linux" else ():
            patch.setattr(module, "can_be_read", can_be_read)
        yield
