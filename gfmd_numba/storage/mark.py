"""The mark in files that gfmd wrote, which may be written again; any other file is its owner's and stays."""

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
IN_TABLES = "# written by gfmd-numba"
_BEGINNINGS = {  # of a kind of file, and the mark as it stands in one
    b"\x89HDF": b"written by gfmd-numba",
    b"\x89PNG": b"Software\0gfmd-numba",
    b"%PDF": b"/Creator (gfmd-numba)",
    b"%!PS": b"%%Creator: gfmd-numba",
    IN_TABLES.encode(): IN_TABLES.encode(),
    b"<?xml": b"<dc:title>gfmd-numba</dc:title>",
}


def in_picture(kind: str) -> dict[str, str] | None:
    """Return the metadata that mark a picture, None for kinds that have none: those are never written again."""
    return _IN_PICTURES.get(kind)


def may_be_replaced(file: Path) -> bool:
    """Whether there is no such file, nothing in it, or gfmd wrote it."""
    try:
        if file.stat().st_size == 0:
            return True
    except FileNotFoundError:
        return True
    with open(file, "rb") as opened, mmap.mmap(opened.fileno(), 0, access=mmap.ACCESS_READ) as content:
        marks = [mark for beginning, mark in _BEGINNINGS.items() if content[: len(beginning)] == beginning]
        return any(content.find(mark) >= 0 for mark in marks)
