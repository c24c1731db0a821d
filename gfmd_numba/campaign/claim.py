"""An output directory belongs to one campaign, and to one run of it at a time."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from fnmatch import fnmatch
from pathlib import Path
from typing import IO

from gfmd_numba.campaign import shards
from gfmd_numba.campaign.results import campaign_name
from gfmd_numba.scene import InputError

LABEL = "campaign.yaml"  # copy of the campaign file
_LOCK = ".lock"


@contextmanager
def claimed(directory: Path, name: str, text: str) -> Iterator[None]:
    """Hold the output directory for a campaign, labelled with its text; raises InputError if it is not to be had."""
    if directory.exists():
        _check_content(directory, name)
    directory.mkdir(parents=True, exist_ok=True)
    with open(directory / _LOCK, "ab") as lock:
        for attempt in range(5):  # a look at the status holds the lock for a moment
            try:
                _lock(lock)
                break
            except (BlockingIOError, PermissionError):
                if attempt == 4:
                    raise InputError(
                        f"{directory}: given an output directory in which another run is at work; "
                        "allowed: one run at a time (wait for it, or choose another with --output)"
                    ) from None
                time.sleep(0.05)
        _check_owner(directory, name)
        for leftover in (*directory.glob("*.tmp"), *directory.glob("shards/*.tmp")):
            leftover.unlink(missing_ok=True)
        shards.replace(directory / LABEL, text.encode())
        yield


def at_work(directory: Path) -> bool:
    """Whether a run is at work in an output directory."""
    try:
        with open(directory / _LOCK, "rb+") as lock:
            _lock(lock)
    except FileNotFoundError:
        return False
    except (BlockingIOError, PermissionError):
        return True
    return False


def _check_content(directory: Path, name: str) -> None:
    ours = (LABEL, _LOCK, "shards", "run.json", "*.tmp", f"{name}.nc", f"{name}.png")
    if not directory.is_dir() or not (
        (directory / LABEL).exists()
        or all(any(fnmatch(entry.name, pattern) for pattern in ours) for entry in directory.iterdir())
    ):
        raise InputError(
            f"{directory}: given a path that holds something else; allowed: a new or empty directory, "
            "or one that `gfmd run` made (choose with --output)"
        )


def _check_owner(directory: Path, name: str) -> None:
    label = directory / LABEL
    if not label.exists():
        return
    owner = campaign_name(label)
    if owner is None:
        raise InputError(
            f"{label}: given a damaged copy of the campaign file, which says whose output {directory} is; "
            f"allowed: a whole one (delete the copy if the directory belongs to campaign '{name}', "
            "or choose another with --output)"
        )
    if owner != name:
        raise InputError(
            f"{directory}: given the output directory of campaign '{owner}'; allowed: a new directory "
            f"or one of campaign '{name}' (choose with --output)"
        )


if sys.platform == "win32":
    import msvcrt

    def _lock(file: IO[bytes]) -> None:
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _lock(file: IO[bytes]) -> None:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
