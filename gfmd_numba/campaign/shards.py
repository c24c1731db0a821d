"""Finished work on disk. A block is there complete and verified, or it is not there at all.

A shard is a file of one block and has its name. Where blocks are many and small, a bundle is a file of many shards,
with their names and lengths at its head.
"""

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from gfmd_numba.campaign.provenance import versions_of_numbers
from gfmd_numba.storage import atomic_file, mark

Arrays = dict[str, npt.NDArray[Any]]
FOLDER, _SHARD, _BUNDLE = "shards", ".shard", ".bundle"
_MAGIC, _MAGIC_OF_BUNDLE = b"\x89gfmd shard 1\n", b"\x89gfmd bundle 1\n"
_OURS = {_SHARD: mark.begins_with(_MAGIC), _BUNDLE: mark.begins_with(_MAGIC_OF_BUNDLE)}
_DIGEST_BYTES = hashlib.sha256().digest_size
_LENGTH_BYTES = 8
_HEADS = 1024  # of tables that are remembered: parsed anew for each block they take a fifth of what a campaign costs


class _Place(NamedTuple):
    """Where the content of a shard lies; the `length` is None for a file of its own."""

    file: Path
    start: int
    length: int | None

    def content(self) -> bytes:
        """Return the content of the shard, or less; nothing if the file is gone."""
        file = atomic_file.opened(self.file)
        if file is None:
            return b""
        with file:
            file.seek(self.start)
            return file.read(-1 if self.length is None else self.length)


class Finished(dict[str, list[_Place]]):
    """The blocks that are there in an output directory at this moment, sound or not, by name.

    A block that was damaged may be there again.
    """

    def __init__(self, directory: Path) -> None:
        super().__init__()
        self.unreadable: list[Path] = []  # bundles that do not tell what they hold
        self.foreign: list[Path] = []  # that have names of such files, and are none
        folder = directory / FOLDER
        for file in sorted(folder.iterdir()) if atomic_file.is_folder(folder) else ():
            if file.suffix not in _OURS:
                continue
            if atomic_file.foreign(file, _OURS[file.suffix]):
                self.foreign.append(file)
                continue
            held = _held(file) if file.suffix == _BUNDLE else [(file.stem, 0, None)]
            if held is None:
                self.unreadable.append(file)
            for name, start, length in held or ():
                self.setdefault(name, []).append(_Place(file, start, length))

    def ranges(self) -> dict[str, list[tuple[int, int]]]:
        """Return the ranges of realisations in the names of the blocks, by identity of the problem."""
        found: dict[str, list[tuple[int, int]]] = {}
        for name in self:
            identity, *numbers = name.rsplit("-", 2)
            if len(numbers) == 2 and all(number.isdecimal() for number in numbers):
                found.setdefault(identity, []).append((int(numbers[0]), int(numbers[1])))
        return found

    def is_sound(self, name: str) -> bool:
        """Return whether a block is there and as it was written."""
        return self._sound(name) is not None

    def read(self, name: str) -> Arrays | None:
        """Return the arrays of a block; None if it is missing, truncated, altered or renamed."""
        sound = self._sound(name)
        return None if sound is None else _arrays(sound)

    def made_with(self, name: str) -> dict[str, str]:
        """Return the versions of what made a block; nothing if it is missing, truncated, altered or renamed."""
        sound = self._sound(name)
        return {} if sound is None else _described(sound.partition(b"\n")[0])[0]

    def written(self, name: str) -> float:
        """Return the time at which a block was written, by the clock of the disk; raises FileNotFoundError."""
        return max((place.file.stat().st_mtime for place in self[name]), default=0.0)

    def _sound(self, name: str) -> bytes | None:
        """Return the payload of a block as it was written, None if there is none."""
        start = len(_MAGIC) + _DIGEST_BYTES
        for content in (place.content() for place in self.get(name, ())):
            if content[:start] == _seal(name, content[start:]):
                return content[start:]
        return None


def path_of(directory: Path, names: Sequence[str]) -> Path:
    """Return the file in which blocks of these names are stored together."""
    if len(names) == 1:
        return directory / FOLDER / f"{names[0]}{_SHARD}"
    return directory / FOLDER / f"{hashlib.sha256(' '.join(names).encode()).hexdigest()[:24]}{_BUNDLE}"


def store(directory: Path, blocks: Mapping[str, Arrays]) -> None:
    """Store the arrays of blocks, by name, so that a kill at any moment leaves either all of them or nothing."""
    contents = [_content(name, arrays) for name, arrays in blocks.items()]
    if len(contents) > 1:
        head = json.dumps(list(zip(blocks, map(len, contents), strict=True))).encode()
        length = len(head).to_bytes(_LENGTH_BYTES, "big")
        contents.insert(0, _MAGIC_OF_BUNDLE + hashlib.sha256(head).digest() + length + head)
    if contents:
        path = path_of(directory, list(blocks))
        atomic_file.replace(path, contents, _OURS[path.suffix])


def remove_unreadable(directory: Path) -> None:
    """Remove bundles whose head is damaged."""
    for bundle in Finished(directory).unreadable:
        atomic_file.remove(bundle, _OURS[_BUNDLE])


def _held(bundle: Path) -> list[tuple[str, int, int | None]] | None:
    """Return name, start and length of each shard in a bundle; None if its head is damaged."""
    file = atomic_file.opened(bundle)
    if file is None:
        return None
    with file:
        magic, digest = file.read(len(_MAGIC_OF_BUNDLE)), file.read(_DIGEST_BYTES)
        size = int.from_bytes(file.read(_LENGTH_BYTES), "big")
        head = file.read(min(size, os.fstat(file.fileno()).st_size))
    if magic != _MAGIC_OF_BUNDLE or hashlib.sha256(head).digest() != digest:
        return None
    held: list[tuple[str, int, int | None]] = []
    start = len(magic) + len(digest) + _LENGTH_BYTES + len(head)
    for name, length in json.loads(head):
        held.append((name, start, length))
        start += length
    return held


def _content(name: str, arrays: Arrays) -> bytes:
    """Return the shard of a block: the versions of what made it, and its arrays [realisation, ...] as one table.

    A table is read ten times as fast as each array alone.
    """
    fields = [(field, values.dtype.str, values.shape[1:]) for field, values in arrays.items()]
    table = np.empty(len(next(iter(arrays.values()))), fields)
    for field, values in arrays.items():
        table[field] = values
    payload = json.dumps([dict(versions_of_numbers()), fields]).encode() + b"\n" + table.tobytes()
    return _seal(name, payload) + payload


@lru_cache(_HEADS)
def _described(head: bytes) -> tuple[dict[str, str], np.dtype[Any]]:
    """Return the versions of what made a table and the type of its rows, from the line that it begins with."""
    versions, fields = json.loads(head)
    return versions, np.dtype([(name, dtype, tuple(shape)) for name, dtype, shape in fields])


def _arrays(payload: bytes) -> Arrays:
    head, _, table = payload.partition(b"\n")
    stored = np.frombuffer(table, _described(head)[1])
    return {field: np.array(stored[field]) for field in stored.dtype.names or ()}


def _seal(name: str, payload: bytes) -> bytes:
    """Return what a shard begins with. Its name is the identity of the work, so the digest covers the name too."""
    return _MAGIC + hashlib.sha256(f"{name}{_SHARD}".encode() + payload).digest()
