"""Where results come from, and a digest of their numbers."""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # a worker has no use for it, and would take a third of its start to import it
    import xarray as xr

_OF_NUMBERS = ("gfmd-numba", "numpy", "numba", "llvmlite", "pyfftw", "scipy")
_OTHERS = ("xarray", "netCDF4", "dask", "distributed")
_BETWEEN = " and "
_OF_THE_RUN = ("wall_time", "case_seconds", "round_cpu_seconds")  # differ from run to run


@cache
def versions_of_numbers() -> Mapping[str, str]:
    """Return the versions of Python and of the packages and the library that make the numbers of a block."""
    from gfmd_numba.fourier.transform import library_version  # which `gfmd check` does not need

    packages = {name: version(name) for name in _OF_NUMBERS}
    return {"python": platform.python_version(), **packages, "fftw": library_version()}


def versions() -> dict[str, str]:
    """Return the versions of all that makes a result."""
    return {**versions_of_numbers(), **{name: version(name) for name in _OTHERS}}


def joined(made_with: Iterable[Mapping[str, str]]) -> dict[str, str]:
    """Return the versions with which parts of a result were made, joined where they differ."""
    found: dict[str, list[str]] = {}
    for each in made_with:
        for name, one in each.items():
            found.setdefault(name, []).append(one)
    return {name: _BETWEEN.join(sorted(set(all_of_it))) for name, all_of_it in found.items()}


def doubt(of_all: Mapping[str, str]) -> str:
    """Return a warning about parts that were made with different versions; empty if there are none.

    Another version of gfmd does not matter: its code that makes numbers is the same, or shards would have other names.
    """
    different = [f"{name} {of_all[name]}" for name in of_all if _BETWEEN in of_all[name] and name != "gfmd-numba"]
    if not different:
        return ""
    return (
        f"parts of these results were computed with different versions ({'; '.join(different)}), so numbers may differ "
        "in their last digits from those of a run with one version: run into a new directory for that"
    )


def difference(installed: Mapping[str, str], expected: Mapping[str, str]) -> str:
    """Return the first package whose version is not the expected one, in words; empty if there is none."""
    for name, here in expected.items():
        if installed.get(name) != here:
            return f"{name} {installed.get(name)}; gfmd allows {here}, as here"
    return ""


def machine() -> str:
    """Return the machine on which results are computed."""
    return f"{platform.system()} {platform.machine()}, {os.cpu_count()} CPUs"


@cache
def git_commit() -> str:
    """Return the commit of the sources if they lie in a git repository, with `-modified` if they differ; else empty."""
    if not any((folder / ".git").exists() for folder in list(Path(__file__).parents)[:3]):
        return ""

    def git(*words: str) -> str:
        # `describe --dirty` would write the index, and with a full disk leave its lock behind
        command = ["git", "--no-optional-locks", "-C", str(Path(__file__).parent), *words]
        return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10).stdout.strip()

    try:
        differs = git("status", "--porcelain", "--untracked-files=no")
        return git("describe", "--always", "--abbrev=40") + ("-modified" if differs else "")
    except (OSError, subprocess.SubprocessError):
        return ""


def content_digest(dataset: xr.Dataset) -> str:
    """Return the SHA-256 of all numbers of a campaign except times."""
    digest = hashlib.sha256()
    for name in sorted(map(str, dataset.variables)):
        if name in _OF_THE_RUN:
            continue
        variable = dataset.variables[name]
        variable = variable.transpose(*sorted(map(str, variable.dims)))
        values = variable.values
        digest.update(f"{name} {variable.dims} {values.shape}".encode())
        if values.dtype.kind in "OUS":
            digest.update("\0".join(map(str, values.ravel())).encode())
        else:
            digest.update(values.astype("float64", order="C").tobytes())
    return digest.hexdigest()
