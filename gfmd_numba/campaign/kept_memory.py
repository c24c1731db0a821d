"""Memory that a worker keeps between its blocks, whose arrays would otherwise be new pages of the system each time."""

import ctypes
from functools import cache

# glibc's parameters of mallopt, and their values in bytes
_TRIM_THRESHOLD, _KEPT = -1, 2**30  # free memory that a process keeps
_MMAP_THRESHOLD, _LARGEST = -3, 2**25  # an array above it comes from the system and goes back; the most glibc allows


@cache
def keep_freed_memory() -> None:
    """Keep up to 1 GiB of freed memory for the next arrays of this process, where the C library is glibc.

    A dask nanny starts its workers with a threshold of 64 KiB, under which nearly every array is made of new pages:
    a quarter of a worker's processor time is then the system's.
    """
    try:
        library = ctypes.CDLL(None)
        library.gnu_get_libc_version  # noqa: B018 - AttributeError in any other library
        set_parameter = library.mallopt
    except (AttributeError, OSError, TypeError):  # the last on Windows
        return
    set_parameter(_TRIM_THRESHOLD, _KEPT)
    set_parameter(_MMAP_THRESHOLD, _LARGEST)
