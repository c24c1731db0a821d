"""Notes of a program to itself: small JSON files with the mark of gfmd."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gfmd_numba.storage import atomic_file, mark

_MARK = "mark"


def write(path: Path, values: Mapping[str, Any]) -> None:
    """Write a mapping that is not empty as `atomic_file.replace` does."""
    atomic_file.replace(path, mark.marked(json.dumps(values).encode()), mark.is_note)


def read(path: Path) -> dict[str, Any]:
    """Return the mapping that a file holds as it was written; an empty one for anything else."""
    try:
        content = atomic_file.read(path)
    except OSError:
        return {}
    if content is None or not mark.is_note(content):
        return {}
    found: dict[str, Any] = json.loads(content)
    del found[_MARK]
    return found


def remove(path: Path) -> None:
    """Remove a file that `write` wrote; any other file stays."""
    atomic_file.remove(path, mark.is_note)
