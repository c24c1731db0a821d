"""The mark in files that gfmd wrote: a digest of all else in them. A file without a mark is its owner's and stays.

Whoever changes a file makes it his own, because the digest no longer fits. Files of binary formats that gfmd alone
writes and reads are recognised by how they begin, so that damaged ones may be written again.
"""

import hashlib
import mmap
import zlib
from collections.abc import Callable
from typing import NamedTuple

Content = bytes | memoryview | mmap.mmap

_WORDS = b"written by gfmd-numba, sha256 "
_HEX_DIGITS = 64
_IN_TABLES = b"# " + _WORDS


class _Form(NamedTuple):
    """How the mark stands in content of one kind: before the `ending`, in what readers of the kind skip."""

    beginning: bytes
    ending: bytes
    around: Callable[[bytes], bytes]

    def mark(self, digest: bytes) -> bytes:
        """Mark with a digest in hex."""
        return self.around(_WORDS + digest)

    def length(self) -> int:
        """Length of the mark and the ending."""
        return len(self.mark(b"0" * _HEX_DIGITS)) + len(self.ending)


def _png_chunk(text: bytes) -> bytes:
    data = b"tEXtComment\0" + text
    return (len(data) - 4).to_bytes(4, "big") + data + zlib.crc32(data).to_bytes(4, "big")


_PRODUCTS = (
    _Form(b"\x89HDF", b"", lambda text: b"\n" + text + b"\n"),  # netCDF readers do not look behind the last block
    _Form(b"\x89PNG", b"\0\0\0\0IEND\xaeB`\x82", _png_chunk),
    _Form(b"%PDF", b"", lambda text: b"% " + text + b"\n"),
    _Form(b"%!PS", b"", lambda text: b"% " + text + b"\n"),
    _Form(b"<?xml", b"", lambda text: b"<!-- " + text + b" -->\n"),
    _Form(b"<!doctype html>", b"", lambda text: b"<!-- " + text + b" -->\n"),
)
_NOTE = _Form(b"{", b"}", lambda text: b', "mark": "' + text + b'"')


def marked(content: bytes | memoryview) -> list[bytes | memoryview]:
    """Return the parts of the content of a dataset, picture, page or note with its mark, which other kinds do not have.

    The content itself is not copied, as it may fill a good part of the memory.
    """
    for form in (*_PRODUCTS, _NOTE):
        if content[: len(form.beginning)] == form.beginning:
            body = memoryview(content)[: len(content) - len(form.ending)]
            return [body, form.mark(_digest(body)), form.ending]
    return [content]


def marked_table(table: bytes) -> bytes:
    """Return the text of a table after a line that marks it, which reveals any change."""
    return _IN_TABLES + _digest(table) + b"\n" + table


def has_mark(content: Content) -> bool:
    """Return whether there is a mark in a dataset, whatever its digest says."""
    form = _PRODUCTS[0]
    tail, blank = content[len(content) - form.length() :], form.mark(b"")
    return len(content) > form.length() and tail[: len(blank) - 1] == blank[:-1]


def is_product(content: Content) -> bool:
    """Return whether this is a dataset, picture, page or table as gfmd wrote it."""
    if content[: len(_IN_TABLES)] == _IN_TABLES:
        return content[:] == marked_table(bytes(content[len(_IN_TABLES) + _HEX_DIGITS + 1 :]))
    return any(_is_marked(content, form) for form in _PRODUCTS)


def is_note(content: Content) -> bool:
    """Return whether this is a note of a run, in JSON, as gfmd wrote it."""
    return _is_marked(content, _NOTE)


def begins_with(magic: bytes) -> Callable[[Content], bool]:
    """Return a test whether content begins as a format of gfmd does; content that is cut off there passes, too."""
    return lambda content: content[: len(magic)] == magic[: len(content)]


def _is_marked(content: Content, form: _Form) -> bool:
    end = len(content) - form.length()
    if end < 0 or content[: len(form.beginning)] != form.beginning:
        return False
    tail = content[end:]
    with memoryview(content) as whole, whole[:end] as part:  # an interrupt leaves no view of a file that is closed
        return bytes(tail) == form.mark(_digest(part)) + form.ending


def _digest(content: bytes | memoryview) -> bytes:
    return hashlib.sha256(content).hexdigest().encode()
