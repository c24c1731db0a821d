"""Compiled kernels on disk: one folder for each state of their sources and compiler, discarded when damaged."""

import atexit
import hashlib
import json
import os
import shutil
import sys
from functools import cache
from importlib.metadata import version
from pathlib import Path

from gfmd_numba.cache import directory

_SEAL = "seal.json"
_SOURCES = Path(__file__).parent / "kernels"


@cache
def folder() -> Path:
    """Folder of the present kernels, checked; what is compiled until this process ends is sealed then."""
    state = hashlib.sha256(f"{version('numba')} {version('llvmlite')} {sys.implementation.cache_tag}".encode())
    for source in sorted(_SOURCES.glob("*.py")):
        state.update(source.read_bytes())
    path = directory() / "kernels" / state.hexdigest()[:16]
    discard_damaged(path)
    atexit.register(seal, path)
    return path


def seal(path: Path) -> None:
    """Write down the digests of all files in a folder."""
    digests = _digests(path)
    if digests and digests != _sealed(path):
        try:
            temporary = path / f"{_SEAL}.{os.getpid()}.tmp"
            temporary.write_text(json.dumps(digests))
            os.replace(temporary, path / _SEAL)
        except OSError:
            pass  # unsealed kernels work all the same


def discard_damaged(path: Path) -> None:
    """Remove a folder in which a sealed file has changed."""
    digests, sealed = _digests(path), _sealed(path)
    if sealed and any(digests.get(name) != digest for name, digest in sealed.items()):
        shutil.rmtree(path, ignore_errors=True)


def _sealed(path: Path) -> dict[str, str]:
    try:
        content = json.loads((path / _SEAL).read_text())
    except FileNotFoundError:
        return {}
    except (OSError, ValueError):
        content = None
    return content if isinstance(content, dict) else {_SEAL: "damaged"}


def _digests(path: Path) -> dict[str, str]:
    files = sorted(file for file in path.rglob("*.nb[ic]") if file.is_file())
    return {str(file.relative_to(path)): hashlib.sha256(file.read_bytes()).hexdigest() for file in files}
