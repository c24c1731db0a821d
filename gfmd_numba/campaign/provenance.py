"""Where results come from, and a digest of what they say."""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:  # a worker has no use for it, and would take a third of its start to import it
    import xarray as xr

_PACKAGES = ("gfmd-numba", "numpy", "numba", "pyfftw", "scipy", "xarray", "netCDF4", "dask", "distributed")
_OF_THE_RUN = ("wall_time", "case_seconds", "round_cpu_seconds")  # differ from run to run


def versions() -> dict[str, str]:
    """Versions of Python and of the packages that make a result."""
    return {"python": platform.python_version()} | {name: version(name) for name in _PACKAGES}


def difference(installed: Mapping[str, str], expected: Mapping[str, str]) -> str:
    """First package whose version is not that expected, in words; empty if there is none."""
    for name, here in expected.items():
        if installed.get(name) != here:
            return f"{name} {installed.get(name)}; allowed: {here}, as here"
    return ""


def machine() -> str:
    """What the results were computed on."""
    return f"{platform.system()} {platform.machine()}, {os.cpu_count()} CPUs"


def git_commit() -> str:
    """Commit of the sources if they lie in a git repository, with `-modified` if they differ; else empty."""
    if not any((folder / ".git").exists() for folder in list(Path(__file__).parents)[:3]):
        return ""
    command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty=-modified", "--abbrev=40"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True, timeout=10).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return ""


def content_digest(dataset: xr.Dataset) -> str:
    """SHA-256 of all numbers of a campaign but those of time, whoever computed them."""
    digest = hashlib.sha256()
    for name in sorted(map(str, dataset.variables)):
        if name in _OF_THE_RUN:
            continue
        variable = dataset[name].transpose(*sorted(map(str, dataset[name].dims)))
        values = variable.values
        digest.update(f"{name} {variable.dims} {values.shape}".encode())
        if values.dtype.kind in "OUS":
            digest.update("\0".join(map(str, values.ravel())).encode())
        else:
            digest.update(np.ascontiguousarray(values, dtype=np.float64).tobytes())
    return digest.hexdigest()
