"""Tests of a copy of the package with a mistake in it, in a process that finds the libraries already imported."""

import multiprocessing
import os
import shutil
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
_LIBRARIES = ["matplotlib.figure", "netCDF4", "numba", "pydantic", "pytest", "scipy.optimize", "scipy.stats", "xarray"]
_SECONDS = 600


def lives(folder, file, there, instead, options):
    """Whether the tests of some pytest options pass with a mistake in one file, in a copy made in a new folder.

    Every process is forked from one that has imported the libraries and nothing of the package: to start Python and
    import them takes longer than most of the tests.
    """
    _copy(folder, file, there, instead)
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(_LIBRARIES)
    process = context.Process(target=_test, args=(folder, list(map(str, options))))
    process.start()
    process.join(_SECONDS)
    if process.is_alive():
        process.kill()
        process.join()
    return process.exitcode == 0


def _copy(folder, file, there, instead):
    """The package in links, but for the room with the mistake."""
    changed = Path(file)
    (folder / changed.parts[0]).mkdir(parents=True)
    for path in (ROOT / changed.parts[0]).iterdir():
        if path.name == changed.parts[1]:
            shutil.copytree(path, folder / changed.parts[0] / path.name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            (folder / changed.parts[0] / path.name).symlink_to(path)
    text = (folder / file).read_text(encoding="utf-8")
    (folder / file).write_text(text.replace(there, instead), encoding="utf-8")


def _test(folder, options):
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(folder))
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    import gfmd_numba

    found = Path(gfmd_numba.__file__).parents[1] == folder
    alone = ["-x", "-q", "-p", "no:cacheprovider", "-n", "0", "-m", ""]  # long ones as well
    sys.exit(pytest.main([*alone, *options]) if found else 0)  # 0: nothing was killed
