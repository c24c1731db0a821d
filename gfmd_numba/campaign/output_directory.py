"""An output directory belongs to one campaign, and to one run of it at a time."""

import codecs
import hashlib
import os
import re
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from errno import EDQUOT, ENOSPC
from pathlib import Path
from typing import IO

from gfmd_numba.scene import InputError
from gfmd_numba.storage import json_file
from gfmd_numba.storage.atomic_file import TEMPORARY, replace
from gfmd_numba.text.input_error import brief

LABEL = "campaign.yaml"  # copy of the campaign file
MARK = ".gfmd-campaign"  # written by us alone: whose directory it is, digests of the labels put there, and
_HOME = "folder"  # the folder that names of files in the label are relative to
_LOCK = ".lock"
_LEFTOVER = re.compile(rf"{TEMPORARY}|.*\.late\.tmp")


@contextmanager
def claimed(directory: Path, name: str, text: str, folder: Path = Path()) -> Iterator[None]:
    """Hold the output directory for a campaign, labelled with its text; raises InputError if it is not to be had.

    Names of files in the text are relative to the `folder`.
    """
    _check_content(directory)
    _make(directory)
    with open(directory / _LOCK, "ab") as lock:
        for attempt in range(5):  # a look at the status holds the lock for a moment
            try:
                _lock(lock, exclusive=True)
                break
            except (BlockingIOError, PermissionError):
                if attempt == 4:
                    raise InputError(
                        f"{directory}: given an output directory in which another run is at work; "
                        "allowed: one run at a time (wait for it, or choose another with --output)"
                    ) from None
                time.sleep(0.05)
        _check_owner(directory, name)
        _label(directory, name, text, folder)
        for leftover in (*directory.glob("*.tmp"), *directory.glob("shards/*.tmp")):
            if _LEFTOVER.fullmatch(leftover.name):
                leftover.unlink(missing_ok=True)
        yield


def at_work(directory: Path) -> bool:
    """Whether a run is at work in an output directory, which need not be writable."""
    if not (directory / _LOCK).exists():
        return False
    with open(directory / _LOCK, "rb") as lock:
        try:
            _lock(lock, exclusive=False)
        except (BlockingIOError, PermissionError):
            return True
    return False


def home_of(file: Path) -> Path | None:
    """Folder that names of files in a campaign file are relative to, if it is the copy in an output directory."""
    folder = json_file.read(file.parent / MARK).get(_HOME) if file.name == LABEL else None
    return Path(folder) if isinstance(folder, str) else None


def check_label(directory: Path) -> None:
    """Raise InputError unless a run made this directory and its copy of the campaign file is as the run left it."""
    label = directory / LABEL
    if not (directory / MARK).is_file():
        raise InputError(f"{directory}: given a directory without {MARK}; allowed: one that `gfmd run` made")
    if not label.is_file():
        raise InputError(f"{directory}: given a directory without {LABEL}; allowed: one that `gfmd run` made")
    if _digest(label.read_bytes()) not in _labels(directory):
        raise InputError(
            f"{label}: given a copy of the campaign file that somebody has changed since; allowed: the copy that "
            f"`gfmd run` left (`gfmd run {label} --output {directory}` runs the changed one)"
        )


def _check_content(directory: Path) -> None:
    """Raise InputError for a directory that holds something and is not ours."""
    if not directory.exists() or (directory / MARK).is_file():
        return
    if not directory.is_dir() or any(
        entry.name != _LOCK and not _LEFTOVER.fullmatch(entry.name) for entry in directory.iterdir()
    ):
        raise InputError(
            f"{directory}: given a path that holds something else; allowed: a new or empty directory, "
            f"or one that `gfmd run` made and marked with a file {MARK} (choose with --output)"
        )


def _make(directory: Path) -> None:
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        if error.errno in (ENOSPC, EDQUOT):
            raise
        reason = error.strerror
    else:
        reason = "" if os.access(directory, os.W_OK) else "it may not be written"
    if reason:
        raise InputError(f"--output: given {directory} ({reason}); allowed: a directory that may be made and written")


def _check_owner(directory: Path, name: str) -> None:
    owner = json_file.read(directory / MARK).get("campaign", name)
    if owner != name:
        raise InputError(
            f"{directory}: given the output directory of campaign {brief(owner)}; allowed: a new directory "
            f"or one of campaign '{name}' (choose with --output)"
        )


def _label(directory: Path, name: str, text: str, folder: Path) -> None:
    """Put the text of the campaign into its directory, but not in place of what somebody wrote there."""
    label, content = directory / LABEL, text.encode()
    present = label.read_bytes() if label.is_file() else None
    equal = present is not None and present.removeprefix(codecs.BOM_UTF8) == content
    ours = not label.is_symlink() and present is not None and _digest(present) in _labels(directory)
    if os.path.lexists(label) and not (equal or ours):
        raise InputError(
            f"{label}: given a copy of the campaign file that somebody has changed, and that differs from the "
            f"file to run; allowed: the copy that `gfmd run` left (`gfmd run {label} --output {directory}` runs the "
            "changed one; or move it away)"
        )
    known = {_digest(text) for text in (present, content) if text is not None}  # a kill leaves either
    mark = {"campaign": name, "labels": sorted(known), _HOME: os.path.abspath(folder)}
    json_file.write(directory / MARK, mark)
    if not equal:
        replace(label, content)


def _labels(directory: Path) -> list[str]:
    """Digests of the copies of the campaign file that runs have put into their directory."""
    known = json_file.read(directory / MARK).get("labels")
    return known if isinstance(known, list) else []


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


if sys.platform == "win32":
    import msvcrt

    def _lock(file: IO[bytes], exclusive: bool) -> None:
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _lock(file: IO[bytes], exclusive: bool) -> None:
        fcntl.flock(file, (fcntl.LOCK_EX if exclusive else fcntl.LOCK_SH) | fcntl.LOCK_NB)
