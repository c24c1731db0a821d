"""Run times measured on this machine, which later plans need not measure again."""

import json
import platform
from importlib.metadata import version
from pathlib import Path

from gfmd_numba import cache
from gfmd_numba.campaign import shards


def remembered() -> dict[str, float]:
    """Return seconds by what took them, none if they cannot be read."""
    try:
        times = json.loads(_memory().read_text())
        return {str(identity): float(seconds) for identity, seconds in times.items()}
    except (OSError, ValueError, AttributeError, TypeError):
        return {}  # none, or a damaged one: it is measured again


def remember(seconds: dict[str, float]) -> None:
    """Keep seconds for later plans, where the disk lets us."""
    path = _memory()
    try:
        path.parent.mkdir(exist_ok=True)
        shards.replace(path, json.dumps(seconds).encode())
    except OSError:
        pass  # the next plan measures again


def _memory() -> Path:
    """File of what this version took on this machine."""
    name = f"{version('gfmd-numba')}-{version('numba')}-{platform.node()}-{platform.machine()}"
    return cache.directory() / "run-times" / f"{name}.json"
