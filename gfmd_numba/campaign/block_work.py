"""A task of a run, done by one process: its blocks solved one after another, and stored or handed back."""

import ctypes
import faulthandler
import signal
import threading
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from tempfile import gettempdir
from typing import Any

import numpy as np

from gfmd_numba.campaign import shards
from gfmd_numba.campaign.cases import Block
from gfmd_numba.campaign.failures import Failure
from gfmd_numba.campaign.provenance import difference, versions
from gfmd_numba.contact.load_path import measured
from gfmd_numba.scene import InputError
from gfmd_numba.storage import atomic_file

# glibc's parameters of mallopt, and their values in bytes
_TRIM_THRESHOLD, _KEPT = -1, 2**30  # free memory that a process keeps
_MMAP_THRESHOLD, _LARGEST = -3, 2**25  # an array above it comes from the system and goes back; the most glibc allows
_AGAIN = 1.0  # s after which the alarm repeats: Python swallows an exception that is raised as it collects garbage
SECONDS = "seconds"  # what each realisation of a block took, stored with its measures
Task = tuple[Block, ...]  # what a worker does at a time
Failures = dict[str, Failure]
Measured = dict[str, shards.Arrays]  # by name of the block
_installed = cache(versions)


def perform(task: Task, directory: Path, timeout: float | None, together: int = 1) -> Failures:
    """Solve blocks in this process, store their measures, so many blocks `together`, and return what failed.

    Raises OSError, because a disk that fails one block fails them all.
    """
    failures: Failures = {}
    for first in range(0, len(task), together):
        finished: Measured = {}
        try:
            for block in task[first : first + together]:
                _solve(block, timeout, finished, failures)
        finally:  # also what an interrupt leaves
            shards.store(directory, finished)
    return failures


def compute(task: Task, run: str, expected: Mapping[str, str], timeout: float | None) -> tuple[Measured, Failures]:
    """Solve blocks on a worker and return their measures and what failed, without the output directory.

    A block that takes longer than `timeout` seconds ends the process, which leaves a trace in this machine's folder of
    temporary files, under the name of the `run`. A process that finds the trace does not try the block again. Raises
    InputError on a worker whose packages have other versions than `expected`.
    """
    if wrong := difference(_installed(), expected):
        raise InputError(f"cluster: you gave a worker with {wrong}")
    keep_freed_memory()
    finished: Measured = {}
    failures: Failures = {}
    for block in task:
        trace = _trace(run, block.name)
        if expired(trace):
            failures[block.name] = too_long(timeout)
        else:
            _solve(block, timeout, finished, failures, trace)
    return finished, failures


def _solve(
    block: Block, timeout: float | None, finished: Measured, failures: Failures, trace: Path | None = None
) -> None:
    """Add the measures of a block to those that are finished, or why there are none to the failures."""
    try:
        with watched(timeout, trace):
            begun = time.thread_time()
            measures = measured(block.problem, range(block.first, block.stop))
            seconds = np.full(block.size, (time.thread_time() - begun) / block.size)
            finished[block.name] = measures | {SECONDS: seconds}
    except TooLongError:
        failures[block.name] = too_long(timeout)
    except Exception as error:  # whatever it is, it concerns this block only
        failures[block.name] = Failure("crashed", f"{type(error).__name__}: {error}")


def too_long(timeout: float | None) -> Failure:
    """Return the failure of a block that took longer than `timeout` seconds."""
    return Failure("timeout", f"it took more than the campaign's case_timeout of {timeout:g} s")


def unfinished(blocks: Iterable[Block], directory: Path) -> list[Block]:
    """Return the blocks that are not stored, or not as they were written."""
    finished = shards.Finished(directory)
    return [block for block in blocks if not finished.is_sound(block.name)]


def expired_here(run: str, names: Iterable[str]) -> list[str]:
    """Return the blocks that took too long and so ended a process of this machine in `compute`, and forget them."""
    return [name for name in names if expired(_trace(run, name))]


def _trace(run: str, name: str) -> Path:
    return Path(gettempdir()) / f"gfmd-{run}-{name}.late.tmp"


class TooLongError(Exception):
    """A block took longer than the campaign's `case_timeout`."""


@contextmanager
def watched(timeout: float | None, trace: Path | None = None) -> Iterator[None]:
    """Stop what runs inside after `timeout` seconds.

    In the main thread, TooLongError is raised. In the thread of a dask worker, compiled code stops only with the whole
    process: the process ends itself and writes to `trace` where it was. Without a `trace` it goes on, and there is no
    time-out outside the main thread.
    """
    if timeout is None:
        yield
    elif threading.current_thread() is threading.main_thread() and hasattr(signal, "setitimer"):
        before = signal.signal(signal.SIGALRM, _expire)
        signal.setitimer(signal.ITIMER_REAL, timeout, _AGAIN)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, before)
    elif trace is None:
        yield
    else:
        with atomic_file.open_own(trace) as file:
            file.truncate()
            faulthandler.dump_traceback_later(timeout, exit=True, file=file)
            try:
                yield
            finally:
                faulthandler.cancel_dump_traceback_later()
                trace.unlink(missing_ok=True)


def _expire(*_: Any) -> None:
    raise TooLongError


def expired(trace: Path) -> bool:
    """Return whether a process ended itself and left this trace, and remove the trace."""
    try:
        return trace.stat().st_size > 0
    except FileNotFoundError:
        return False
    finally:
        trace.unlink(missing_ok=True)


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
