"""What may be read of a path that a user names: regular files, and no more of them than is sensible."""

import errno
import os
import stat
from functools import lru_cache

MOST_TEXT = 2**20  # bytes of a YAML file, which takes ten seconds to read
_PARTS = 16  # of memory, of which the numbers of one file may fill one: solving takes the others


def check_regular(path: str | os.PathLike[str], most: int) -> None:
    """Raise ValueError unless a path is a regular file of at most so many bytes; it is not opened, as pipes wait."""
    try:
        found = os.stat(path)
    except OSError as error:
        raise ValueError(f"a path that cannot be read ({error.strerror})") from None
    except ValueError:
        raise ValueError("a path with a zero byte") from None
    if stat.S_ISDIR(found.st_mode):
        raise ValueError(f"a path that cannot be read ({os.strerror(errno.EISDIR)})")
    if not stat.S_ISREG(found.st_mode):
        raise ValueError("a device, pipe or socket, not a regular file")
    if found.st_size > most:
        raise ValueError(f"a file of {found.st_size / 1e6:.4g} MB, more than {most / 1e6:.4g} MB")


def read_regular(path: str | os.PathLike[str], most: int) -> bytes:
    """Content of a regular file of at most so many bytes; raises ValueError, saying what it is, for anything else."""
    check_regular(path, most)
    try:
        with open(path, "rb") as file:
            content = file.read(most + 1)
    except OSError as error:
        raise ValueError(f"a path that cannot be read ({error.strerror})") from None
    if len(content) > most:  # it grew, or told no size, as in /proc
        raise ValueError(f"a file of more than {most / 1e6:.4g} MB")
    return content


@lru_cache
def most_numbers() -> int:
    """Bytes that a file of numbers may have on this machine."""
    import psutil

    return int(psutil.virtual_memory().total) // _PARTS
