"""Where this machine keeps what can be made again: compiled kernels and measured run times."""

import atexit
import os
import shutil
import tempfile
from functools import cache
from pathlib import Path

import platformdirs


@cache
def directory() -> Path:
    """A folder of this user's own that can be written; GFMD_CACHE_DIR names another.

    Without home, or where it may not be written, a temporary one for this process and those it starts.
    """
    asked = os.environ.get("GFMD_CACHE_DIR")
    try:
        folder = Path(asked) if asked else platformdirs.user_cache_path("gfmd-numba")
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except (OSError, RuntimeError):
        folder = Path(tempfile.mkdtemp(prefix="gfmd-numba-"))
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        os.environ["GFMD_CACHE_DIR"] = str(folder)
        return folder
