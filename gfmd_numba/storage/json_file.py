"""Small JSON files in which a program remembers something, and which anybody may have damaged."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gfmd_numba.storage.atomic_file import replace


def write(path: Path, values: Mapping[str, Any]) -> None:
    """Write a mapping as `atomic_file.replace` does."""
    replace(path, json.dumps(values).encode())


def read(path: Path) -> dict[str, Any]:
    """Mapping that a file holds; an empty one if there is no such file, or something else in it."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}
