"""Finished work on disk: one file per task, complete and verified or not there at all."""

import hashlib
import io
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gfmd_numba.storage.atomic_file import replace

Arrays = dict[str, npt.NDArray[Any]]
_MAGIC = b"gfmd shard 1\n"
_DIGEST_BYTES = hashlib.sha256().digest_size


def write(path: Path, arrays: Arrays) -> None:
    """Store arrays under a path so that a kill at any moment leaves either all of them or nothing."""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    payload = buffer.getvalue()
    replace(path, _seal(path, payload) + payload)


def read(path: Path) -> Arrays | None:
    """Arrays of a shard; None if it is missing, truncated, altered, renamed or no shard."""
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        return None
    start = len(_MAGIC) + _DIGEST_BYTES
    payload = content[start:]
    if content[:start] != _seal(path, payload):
        return None
    with np.load(io.BytesIO(payload), allow_pickle=False) as stored:
        return dict(stored)


def _seal(path: Path, payload: bytes) -> bytes:
    """What a shard begins with; its name is the identity of the work, so the digest covers it too."""
    return _MAGIC + hashlib.sha256(path.name.encode() + payload).digest()
