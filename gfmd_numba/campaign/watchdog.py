"""An end to a block that takes too long."""

import faulthandler
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gfmd_numba.storage import atomic_file

_AGAIN = 1.0  # s after which the alarm repeats: Python swallows an exception that is raised as it collects garbage


class TooLongError(Exception):
    """A block took longer than the campaign's `case_timeout`."""


@contextmanager
def watched(timeout: float | None, trace: Path | None = None) -> Iterator[None]:
    """Stop what runs inside after `timeout` seconds.

    In the main thread by TooLongError. In that of a dask worker nothing short of the process's end stops compiled
    code: where it was is then written to `trace`. A process that is not to be ended has no trace, and no time-out
    outside its main thread.
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


def expired(trace: Path) -> bool:
    """Whether a process was ended here; forgets it."""
    try:
        return trace.stat().st_size > 0
    except FileNotFoundError:
        return False
    finally:
        trace.unlink(missing_ok=True)


def _expire(*_: Any) -> None:
    raise TooLongError
