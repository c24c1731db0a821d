"""Standard streams that are closed, full or nobody's: none of them may stop a command, or end up in a file."""

from __future__ import annotations

import io
import os
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


class UntoldError(Exception):
    """Standard output cannot be written."""


class _Output(io.FileIO):
    """Standard output whose failures cannot be taken for those of another file."""

    def write(self, data: ReadableBuffer, /) -> int:
        """Write, or raise UntoldError; a reader who has seen enough is none."""
        try:
            return super().write(data)
        except BrokenPipeError:
            raise
        except OSError as error:
            raise UntoldError(error.strerror) from None


def open_streams() -> None:
    """Let closed standard streams lead nowhere: else the next file opened would take their place, and their text."""
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # it takes the lowest number that is free: this one
    sys.stderr = sys.stderr or _text(io.FileIO(2, "w", closefd=False), "utf-8", "backslashreplace")
    own = sys.stdout is not None and sys.stdout is not sys.__stdout__
    if not own:  # else somebody has taken its place, and looks after it
        encoding = "utf-8" if sys.stdout is None else sys.stdout.encoding
        sys.stdout = _text(_Output(1, "w", closefd=False), encoding, "backslashreplace")


def drop_output() -> None:
    """Let what is still to be written to a full standard output lead nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.close(nowhere)


def _text(stream: io.FileIO, encoding: str, errors: str) -> io.TextIOWrapper:
    return io.TextIOWrapper(io.BufferedWriter(stream), encoding, errors, line_buffering=True)
