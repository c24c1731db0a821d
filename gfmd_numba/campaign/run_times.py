"""Run times measured on this machine, which later plans need not measure again."""

import platform
from importlib.metadata import version
from pathlib import Path

from gfmd_numba.storage import cache, json_file
from gfmd_numba.text.input_error import InputError


def remembered() -> dict[str, float]:
    """Return seconds by what took them, none if they cannot be read."""
    try:
        return {identity: float(seconds) for identity, seconds in json_file.read(_memory()).items()}
    except (OSError, ValueError, TypeError):
        return {}  # none, or a damaged one: it is measured again


def remember(seconds: dict[str, float]) -> None:
    """Keep seconds for later plans, where the disk lets us."""
    try:
        path = _memory()
        path.parent.mkdir(mode=0o700, exist_ok=True)
        json_file.write(path, seconds)
    except (OSError, InputError):
        pass  # the next plan measures again


def _memory() -> Path:
    """File of what this version took on this machine."""
    name = f"{version('gfmd-numba')}-{version('numba')}-{platform.node()}-{platform.machine()}"
    return cache.directory() / "times" / f"{name}.json"
