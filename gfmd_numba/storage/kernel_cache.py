"""Compiled kernels on disk: each in a sealed file, in a folder for the state of their sources and their compiler."""

import hashlib
import os
import sys
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path

from gfmd_numba.storage import cache as user_cache
from gfmd_numba.storage import mark
from gfmd_numba.storage.atomic_file import opened, replace
from gfmd_numba.text.input_error import InputError

_SOURCES = Path(__file__).parent.parent / "kernels"
_MAGIC = b"\x89gfmd kernel 1\n"
_HEAD = len(_MAGIC) + hashlib.sha256().digest_size


@cache
def folder() -> Path | None:
    """Return the folder of the present kernels, None if there is no place for one."""
    state = hashlib.sha256(_MAGIC)
    state.update(f"{version('numba')} {version('llvmlite')} {sys.implementation.cache_tag}".encode())
    for source in sorted(_SOURCES.glob("*.py")):
        state.update(source.read_bytes())
    try:
        path = user_cache.directory() / "kernels" / state.hexdigest()[:16]
        user_cache.make(path)
    except OSError:
        return None
    return path


def save(name: str, code: bytes) -> None:
    """Keep the code of a kernel under a name, or do nothing if that is impossible."""
    path = folder()
    if path is not None:
        with suppress(OSError, InputError):  # it is compiled again next time
            replace(path / name, [_seal(name, code), code], mark.begins_with(_MAGIC), mode=0o600)


def load(name: str) -> bytes | None:
    """Return the code kept under a name; None if there is none, it is damaged, or somebody else may have written it."""
    path = folder()
    try:
        file = None if path is None else opened(path / name)
        if file is None:
            return None
        with file:
            content = file.read() if user_cache.is_private(os.fstat(file.fileno())) else b""
    except OSError:
        return None
    code = content[_HEAD:]
    return code if content[:_HEAD] == _seal(name, code) else None


def _seal(name: str, code: bytes) -> bytes:
    return _MAGIC + hashlib.sha256(name.encode() + code).digest()
