"""An output directory belongs to one campaign, and to one run of it at a time."""

import codecs
import hashlib
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from errno import EDQUOT, ENOSPC
from pathlib import Path
from typing import IO

from gfmd_numba.scene import InputError
from gfmd_numba.storage import atomic_file, json_file
from gfmd_numba.storage.mark import Content, is_note
from gfmd_numba.text.input_error import brief
from gfmd_numba.text.printable import word

LABEL = "campaign.yaml"  # copy of the campaign file
MARK = ".gfmd-campaign"  # written by us alone: whose directory it is, digests of the labels put there, and
_HOME = "folder"  # the folder that names of files in the label are relative to
_LOCK = ".lock"


class AlteredError(InputError):
    """A file of an output directory is not as a run left it."""


@contextmanager
def claimed(directory: Path, name: str, text: str, folder: Path = Path()) -> Iterator[None]:
    """Hold the output directory for a campaign, labelled with its text; raises InputError if that cannot be done.

    Names of files in the text are relative to the `folder`.
    """
    from gfmd_numba.campaign import shards  # which need numpy, and a look at a directory does not

    _check_content(directory, text.encode())
    try:
        directory.mkdir(parents=True, exist_ok=True)
        atomic_file.sync(directory.parent)
        reason = "" if os.access(directory, os.W_OK) else "it may not be written"
    except OSError as error:
        if error.errno in (ENOSPC, EDQUOT):
            raise
        reason = str(error.strerror)
    if reason:
        raise InputError.of("--output", f"{directory} ({reason})", "a directory that may be made and written")
    with atomic_file.open_own(directory / _LOCK) as lock:
        for attempt in range(5):  # a look at the status holds the lock for a moment
            try:
                _lock(lock, exclusive=True)
                break
            except (BlockingIOError, PermissionError):
                if attempt == 4:
                    raise InputError.of(
                        directory,
                        "an output directory in which another run is at work",
                        "one run at a time (wait for it, or choose another with --output)",
                    ) from None
                time.sleep(0.05)
        owner = json_file.read(directory / MARK).get("campaign", name)
        if owner != name:
            raise InputError.of(
                directory,
                f"the output directory of campaign {brief(owner)}",
                f"a new directory or one of campaign '{name}' (choose with --output)",
            )
        _label(directory, name, text, folder)
        for left_in in (directory, directory / shards.FOLDER):
            if atomic_file.is_folder(left_in):
                for leftover in filter(_is_leftover, list(left_in.iterdir())):
                    leftover.unlink(missing_ok=True)
        yield


def at_work(directory: Path) -> bool:
    """Whether a run is at work in an output directory, which need not be writable."""
    lock = atomic_file.opened(directory / _LOCK)
    if lock is None:
        return False
    with lock:
        try:
            _lock(lock, exclusive=False)
        except (BlockingIOError, PermissionError):
            return True
    return False


def home_of(file: Path) -> Path | None:
    """Return the folder that names of files are relative to in the copy of a campaign file in an output directory."""
    folder = json_file.read(file.parent / MARK).get(_HOME) if file.name == LABEL else None
    return None if folder is None else Path(folder)


def check_label(directory: Path) -> None:
    """Raise InputError unless a run made this directory, AlteredError unless its mark and campaign file are as then."""
    mark, label = directory / MARK, directory / LABEL
    for file in (mark, label):
        if not os.path.lexists(file):
            raise InputError.of(directory, f"a directory without {file.name}", "one that `gfmd run` made")
    _check_mark(directory)
    present = atomic_file.read(label)
    if present is None or _digest(present) not in _labels(directory):
        raise AlteredError(
            f"{label}: you gave a copy of the campaign file that somebody has changed since; gfmd allows the copy that "
            f"`gfmd run` left (`gfmd run {word(label)} --output {word(directory)}` runs the changed one)"
        )


def _check_mark(directory: Path) -> None:
    """Raise AlteredError for a mark that is not as a run left it."""
    if clause := atomic_file.foreign(directory / MARK, is_note):
        raise AlteredError(
            f"{directory / MARK}: you gave a path {clause}; gfmd allows the mark that `gfmd run` left (move it away: "
            f"`gfmd run {word(directory / LABEL)} --output {word(directory)}` makes it again)"
        )


def _check_content(directory: Path, text: bytes) -> None:
    """Raise InputError for a directory that holds something and is not ours.

    One that has lost its mark is ours if it holds this text as its label, and finished work.
    """
    from gfmd_numba.campaign import shards

    if not os.path.exists(directory):  # also for a path that no file can have
        return
    if directory.is_dir():
        _check_mark(directory)
        others = [entry for entry in directory.iterdir() if not _is_leftover(entry)]
        empty = (each.name in (_LOCK, MARK) and atomic_file.read(each) == b"" for each in others)
        if json_file.read(directory / MARK) or all(empty):
            return
        if _is_text(atomic_file.read(directory / LABEL), text):
            found = shards.Finished(directory)
            if any(map(found.is_sound, found)):
                return
    raise InputError.of(
        directory,
        "a path that holds something else",
        f"a new or empty directory, or one that `gfmd run` made and marked with a file {MARK} (choose with --output)",
    )


def _is_leftover(entry: Path) -> bool:
    return atomic_file.is_temporary(entry.name) and entry.is_file() and not entry.is_symlink()


def _is_text(content: bytes | None, text: bytes) -> bool:
    return content is not None and content.removeprefix(codecs.BOM_UTF8) == text


def _label(directory: Path, name: str, text: str, folder: Path) -> None:
    """Put the text of the campaign into its directory, but not in place of what somebody wrote there."""
    label, content, labels = directory / LABEL, text.encode(), _labels(directory)

    def ours(present: Content) -> bool:
        return _digest(present) in labels

    present = atomic_file.read(label)
    equal = _is_text(present, content)
    if not equal and atomic_file.foreign(label, ours):
        raise InputError.of(
            label,
            "a copy of the campaign file that somebody has changed, and that differs from the file to run",
            f"the copy that `gfmd run` left (`gfmd run {word(label)} --output {word(directory)}` runs the changed one; "
            "or move it away)",
        )
    known = {_digest(text) for text in (present, content) if text is not None}  # a kill leaves either
    mark = {"campaign": name, "labels": sorted(known), _HOME: os.path.abspath(folder)}
    json_file.write(directory / MARK, mark)
    if not equal:
        atomic_file.replace(label, [content], ours)


def _labels(directory: Path) -> list[str]:
    """Return the digests of the copies of the campaign file that runs have put into their directory."""
    known: list[str] = json_file.read(directory / MARK).get("labels", [])
    return known


def _digest(content: Content) -> str:
    return hashlib.sha256(content).hexdigest()


if sys.platform == "win32":
    import msvcrt

    def _lock(file: IO[bytes], exclusive: bool) -> None:
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _lock(file: IO[bytes], exclusive: bool) -> None:
        fcntl.flock(file, (fcntl.LOCK_EX if exclusive else fcntl.LOCK_SH) | fcntl.LOCK_NB)
