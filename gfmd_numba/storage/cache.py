"""The cache of this user, which holds what can be made again: compiled kernels and measured run times."""

import atexit
import os
import shutil
import stat
import sys
import tempfile
import warnings
from functools import cache
from pathlib import Path

import platformdirs


@cache
def directory() -> Path:
    """Return a folder that only this user can write; GFMD_CACHE_DIR names another.

    If there is no home, or it cannot be written, or others may write it, the folder is a temporary one for this process
    and those that it starts. Raises OSError if not even that can be made.
    """
    asked = os.environ.get("GFMD_CACHE_DIR")
    try:
        folder = Path(asked) if asked else platformdirs.user_cache_path("gfmd-numba")
        make(folder)
        folder = folder.resolve()  # a link may lead elsewhere once it was looked at
        with tempfile.TemporaryFile(dir=folder):
            pass
        if is_private(folder.stat()):
            return folder
    except (OSError, RuntimeError):
        pass
    else:
        warnings.warn(
            f"the cache {folder} is not used: it belongs to somebody else, or others may write to it; kernels are "
            "compiled again (delete that folder, or name one of your own in GFMD_CACHE_DIR)",
            RuntimeWarning,
            stacklevel=2,
        )
    folder = Path(tempfile.mkdtemp(prefix="gfmd-numba-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    os.environ["GFMD_CACHE_DIR"] = str(folder)
    return folder


def make(folder: Path) -> None:
    """Make a folder, and those above it that are missing, for this user alone."""
    for missing in reversed([level for level in (folder, *folder.parents) if not level.exists()]):
        missing.mkdir(mode=0o700, exist_ok=True)


def is_private(state: os.stat_result) -> bool:
    """Return whether what has this state belongs to this user, and nobody else may write it."""
    if sys.platform == "win32":
        return True  # folders of users are their own there
    return state.st_uid == os.geteuid() and not state.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
