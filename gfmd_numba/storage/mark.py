"""The mark in files that gfmd wrote, which may be written again; any other file is its owner's and stays.

A table is text that is easily edited by hand: its mark holds a digest of all that follows.
"""

import hashlib
import mmap
from pathlib import Path

IN_DATASETS = {"software": "written by gfmd-numba"}
_IN_PICTURES = {
    "png": {"Software": "gfmd-numba"},
    "pdf": {"Creator": "gfmd-numba"},
    "ps": {"Creator": "gfmd-numba"},
    "eps": {"Creator": "gfmd-numba"},
    "svg": {"Creator": "gfmd-numba"},
}
_IN_TABLES = b"# written by gfmd-numba, sha256 "
_BEGINNINGS = {  # of a kind of file, and the mark as it stands in one
    b"\x89HDF": b"written by gfmd-numba",
    b"\x89PNG": b"Software\0gfmd-numba",
    b"%PDF": b"/Creator (gfmd-numba)",
    b"%!PS": b"%%Creator: gfmd-numba",
    b"<?xml": b"<dc:title>gfmd-numba</dc:title>",
}


def in_picture(kind: str) -> dict[str, str] | None:
    """Return the metadata that mark a picture, None for kinds that have none: those are never written again."""
    return _IN_PICTURES.get(kind)


def marked_table(table: bytes) -> bytes:
    """Return the text of a table behind a line that marks it, by which any change is known."""
    return _IN_TABLES + hashlib.sha256(table).hexdigest().encode() + b"\n" + table


def may_be_replaced(file: Path) -> bool:
    """Whether there is no such file, nothing in it, or gfmd wrote it and, if it is a table, nobody changed it since."""
    try:
        if file.stat().st_size == 0:
            return True
    except FileNotFoundError:
        return True
    with open(file, "rb") as opened, mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as content:
        if content[: len(_IN_TABLES)] == _IN_TABLES:
            return content[:] == marked_table(content[content.find(b"\n") + 1 :])
        marks = [mark for beginning, mark in _BEGINNINGS.items() if content[: len(beginning)] == beginning]
        return any(content.find(mark) >= 0 for mark in marks)
