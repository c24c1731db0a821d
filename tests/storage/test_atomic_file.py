"""Files written whole: what they may be read by, when they are safe, and what is taken for a leftover."""

import os
import stat
import uuid

import pytest

from gfmd_numba.scene import InputError
from gfmd_numba.storage import atomic_file, json_file, mark
from gfmd_numba.storage.atomic_file import is_temporary, opened, read, replace, temporary


def anything(content):
    return True


def test_files_follow_the_umask(tmp_path):
    before = os.umask(0o027)
    try:
        replace(tmp_path / "file", [b""], anything)
    finally:
        os.umask(before)
    assert (tmp_path / "file").stat().st_mode & 0o777 == 0o640


def test_a_new_name_is_forced_to_disk_as_well_as_the_content(tmp_path, monkeypatch):
    """A power cut after a rename may lose the name, and with it a file that was said to be there."""
    done = []
    monkeypatch.setattr(os, "replace", lambda *names, real=os.replace: (done.append("rename"), real(*names)))

    def fsync(file, real=os.fsync):
        done.append("folder" if stat.S_ISDIR(os.fstat(file).st_mode) else "content")
        real(file)

    monkeypatch.setattr(os, "fsync", fsync)
    replace(tmp_path / "file", [b"new"], anything)
    assert done == ["content", "rename", "folder"]
    done.clear()
    atomic_file.make_folder(tmp_path / "shards")
    assert done == ["folder"]


def test_only_our_names_are_those_of_leftovers(tmp_path):
    for name in ("small.nc", ".gfmd-campaign", "a b\nc", "\udcff"):
        ours = temporary(tmp_path / name)
        assert is_temporary(ours.name)
        assert not is_temporary(f"x{ours.name}")
        assert not is_temporary(f"{name}.{uuid.uuid4().hex}.tmp")
    assert not is_temporary("notes.late.tmp")


def test_what_is_no_regular_file_is_neither_read_nor_replaced(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("precious")
    (tmp_path / "link").symlink_to(tmp_path / "file")
    (tmp_path / "broken link").symlink_to(tmp_path / "nothing")
    for path in list(tmp_path.iterdir()):
        if path.name == "file":
            continue
        assert read(path) is None
        assert opened(path) is None
        assert json_file.read(path) == {}
        for write in (lambda path=path: replace(path, [b""], anything), lambda path=path: atomic_file.open_own(path)):
            with pytest.raises(
                InputError, match=r"you gave a path which is (a link|not a regular file); gfmd allows no"
            ):
                write()
        atomic_file.remove(path, anything)
        assert os.path.lexists(path)
    assert (tmp_path / "file").read_text() == "precious"
    assert not (tmp_path / "nothing").exists()


def test_a_link_to_a_folder_is_none_of_ours(tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "shards").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="you gave a link or a file; gfmd allows a folder of that name"):
        atomic_file.make_folder(tmp_path / "shards")


def test_an_interrupt_while_a_mark_is_compared_stays_an_interrupt(tmp_path, monkeypatch):
    def interrupted(content):
        raise KeyboardInterrupt

    path = tmp_path / "results.nc"
    path.write_bytes(b"".join(mark.marked(b"\x89HDF\r\n\x1a\n" + bytes(100))))
    monkeypatch.setattr(mark, "_digest", interrupted)
    with pytest.raises(KeyboardInterrupt):
        atomic_file.foreign(path)
