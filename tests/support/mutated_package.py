"""Tests of a copy of the package with a mistake in it, in a process that finds the libraries already imported."""

import gc
import multiprocessing
import os
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
_LIBRARIES = [
    "hypothesis",
    "matplotlib.figure",
    "netCDF4",
    "numba",
    "pydantic",
    "pytest",
    "scipy.optimize",
    "scipy.stats",
    "xarray",
]
_BELOW_ANALYSIS = [
    "gfmd_numba.contact.contact_dataset",
    "gfmd_numba.contact.load_path",
    "gfmd_numba.roughness.measured",
]
_SECONDS = 600


def lives(folder, file, there, instead, options):
    """Whether the tests of some pytest options pass with a mistake in one file, in a copy made in a new folder.

    The file is one of `analysis`, or of what stands above it. Every process is forked from one that has imported the
    libraries and of the package what stands below: to start Python and import them takes longer than most of the tests.
    """
    _copy(folder, file, there, instead)
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(_LIBRARIES + _BELOW_ANALYSIS)
    process = context.Process(target=_test, args=(folder, list(map(str, options))))
    process.start()
    process.join(_SECONDS)
    if process.is_alive():
        process.kill()
        process.join()
    return process.exitcode == 0


def _copy(folder, file, there, instead):
    """The package in links, with its compiled files, but for the file with the mistake."""
    changed = ROOT / file
    room = (folder / file).parent
    room.mkdir(parents=True)
    for original, copy in ((changed.parent.parent, room.parent), (changed.parent, room)):
        for path in original.iterdir():
            if path not in (changed.parent, changed):
                (copy / path.name).symlink_to(path)
    (folder / file).write_text(changed.read_text(encoding="utf-8").replace(there, instead), encoding="utf-8")


def _test(folder, options):
    gc.freeze()  # pytest collects garbage twice, and that of libraries takes longer than a test
    sys.dont_write_bytecode = True
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    import gfmd_numba

    assert "gfmd_numba.analysis" not in sys.modules
    gfmd_numba.__path__[:] = [str(folder / "gfmd_numba")]
    import gfmd_numba.analysis

    found = Path(gfmd_numba.analysis.__file__).parents[2] == folder
    alone = ["-x", "-q", "-p", "no:cacheprovider", "-n", "0", "-m", ""]  # long ones as well
    imported = ["-p", "no:hypothesispytest", "-W", "ignore:Module already imported"]
    sys.exit(pytest.main([*alone, *imported, *options]) if found else 0)  # 0: nothing was killed
