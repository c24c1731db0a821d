"""Files written whole: what they may be read by."""

import os

from gfmd_numba.storage.atomic_file import replace


def test_files_follow_the_umask(tmp_path):
    before = os.umask(0o027)
    try:
        replace(tmp_path / "file", b"")
    finally:
        os.umask(before)
    assert (tmp_path / "file").stat().st_mode & 0o777 == 0o640
