"""What may stand in an output directory that a run did not put there, or did not leave so, at random."""

import os
import shutil
import socket
import stat

from gfmd_numba.storage.mark import is_note, is_product


def link_to_file(path, outside, others):
    path.symlink_to(outside / "thesis.tex")


def link_to_dataset(path, outside, others):
    path.symlink_to(outside / "contact.nc")


def link_to_nothing(path, outside, others):
    path.symlink_to(outside / "nothing")


def link_to_folder(path, outside, others):
    path.symlink_to(outside / "folder")


def pipe(path, outside, others):
    os.mkfifo(path)


def folder(path, outside, others):
    path.mkdir()
    (path / "thesis.tex").write_text("precious")


def text(path, outside, others):
    path.write_text("precious\n")


def read_only(path, outside, others):
    path.write_text("precious\n")
    path.chmod(0o400)


def listening_socket(path, outside, others):
    here = os.getcwd()
    os.chdir(path.parent)  # the name of a socket has to be short
    try:
        with socket.socket(socket.AF_UNIX) as listening:
            listening.bind(path.name)
    finally:
        os.chdir(here)


def another_campaigns(path, outside, others):
    theirs = others / path.parent.name / path.name if path.parent.name == "shards" else others / path.name
    if theirs.is_file():
        shutil.copy2(theirs, path)
    else:
        path.write_bytes(b"\x89HDF of another program")


KINDS = (
    link_to_file,
    link_to_dataset,
    link_to_nothing,
    link_to_folder,
    pipe,
    folder,
    text,
    read_only,
    listening_socket,
    another_campaigns,
)


def put(path, kind, outside, others):
    """Put a thing of a kind in the place of whatever has that name."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    elif os.path.lexists(path):
        path.unlink()
    path.parent.mkdir(exist_ok=True)
    kind(path, outside, others)


def damage(path, pick):
    """Cut a file, or flip one of its bits."""
    content = bytearray(path.read_bytes())
    at = pick.randrange(len(content))
    if pick.random() < 0.5:
        del content[at:]
    else:
        content[at] ^= 1 << pick.randrange(8)
    path.write_bytes(content)


def state(top):
    """What lies below a folder, and what it is, without opening what is no file."""
    found = {}
    for path in top.rglob("*"):
        mode = path.lstat().st_mode
        is_file = stat.S_ISREG(mode)
        content = path.read_bytes() if is_file else os.readlink(path) if path.is_symlink() else b""
        found[path] = (stat.S_IFMT(mode), stat.S_IMODE(mode) if is_file else 0, content)
    return found


_OF_SHARDS = (b"\x89gfmd shard 1\n", b"\x89gfmd bundle 1\n")


def is_ours(entry):
    """Whether something in an output directory may be written again: it proves to be of gfmd, or is a damaged shard."""
    kind, _, content = entry
    if not stat.S_ISREG(kind):
        return False
    shard = any(content[: len(magic)] == magic[: len(content)] for magic in _OF_SHARDS)
    return not content or is_product(content) or is_note(content) or shard
