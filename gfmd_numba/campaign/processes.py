"""Local worker processes, joined to this one by pipes: none of them listens, and one that hangs is killed."""

import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager, suppress
from enum import Enum
from itertools import islice
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from threading import Thread
from typing import Any, TypeVar

import psutil

_LOOK = 0.5  # s between two looks at the processes
_FROZEN = 300.0  # s without processor time, as for dask's workers; start-up and slow disks need a few of them
_STARTS = 3  # in a row without success: then it is no accident
_SPAWN = multiprocessing.get_context("spawn")  # forked threads of FFTW and Numba would not work
_NOTHING = object()

Task = TypeVar("Task")


class Lost(Enum):
    """How a process was lost that still owed an answer."""

    died = "died"
    frozen = "froze"
    late = "took too long"


def answers(
    function: Callable[[Task], Any], tasks: Iterable[Task], count: int, timeout: float | None
) -> Generator[tuple[Task, Any]]:
    """Yield each task with the function's answer from one of `count` processes, or with how that process was lost.

    A process is killed if a task takes it longer than `timeout` seconds, or if it uses no processor time for five
    minutes. Raises what the function raises, and ChildProcessError if no process can start.
    """
    waiting = iter(tasks)
    processes: list[_Process] = []
    failed_starts = 0
    looked = time.monotonic()
    try:
        for task in islice(waiting, count):
            processes.append(_Process(function, task))
        while processes:
            speaking = wait([process.pipe for process in processes], _LOOK)
            elapsed = time.monotonic() - looked
            look = elapsed >= _LOOK
            if look:
                looked += elapsed
                elapsed = min(elapsed, 2.0 * _LOOK)  # time in which this process was stopped counts for nobody
            for process in list(processes):
                if process.pipe in speaking:
                    answer = process.heard()
                elif look:
                    answer = process.hangs(elapsed, timeout)
                else:
                    continue
                if answer is _NOTHING:
                    continue
                if isinstance(answer, Exception):
                    raise answer
                task, lost = process.task, isinstance(answer, Lost)
                begun = process.begun
                failed_starts = 0 if begun else failed_starts + 1
                if failed_starts == _STARTS:
                    raise ChildProcessError(
                        "worker processes end while they start (a script that starts them needs "
                        '`if __name__ == "__main__":` around the call)'
                    )
                following = list(islice(waiting, 1)) if begun else [task]
                if lost or not following:
                    process.end()
                    processes.remove(process)
                    processes += [_Process(function, next_task) for next_task in following]
                else:
                    process.give(following[0])
                if begun:
                    yield task, answer
    finally:
        for process in processes:
            process.end()


class _Process:
    """A process, the pipe to it, and the task it is at; `begun` once it has started up."""

    def __init__(self, function: Callable[[Any], Any], task: Any) -> None:
        self.pipe, theirs = _SPAWN.Pipe()
        self._process = _SPAWN.Process(target=_serve, args=(theirs, function), daemon=True)
        with _uninterrupted():  # inherited: Ctrl-C reaches every process, but only this one acts on it
            self._process.start()
        theirs.close()
        self.begun = False
        self._used = 0.0
        self.give(task)

    def give(self, task: Any) -> None:
        """Send a task, the clock of which begins."""
        self.task, self._at_work, self._idle = task, 0.0, 0.0
        with suppress(OSError):  # it has died, as the pipe will tell
            self.pipe.send(task)

    def heard(self) -> Any:
        """Return the answer, nothing if it has only started up, or that it died."""
        try:
            answer = self.pipe.recv()
        except (EOFError, OSError):
            return Lost.died
        if self.begun:
            return answer
        self.begun = True
        return _NOTHING

    def hangs(self, elapsed: float, timeout: float | None) -> object:
        """Return how it is lost, or nothing if it is not, `elapsed` seconds after the last look."""
        try:
            of_system = psutil.Process(self._process.pid)
            times = of_system.cpu_times()
            stopped = of_system.status() == psutil.STATUS_STOPPED
        except psutil.Error:  # it is gone, as the pipe will tell
            return _NOTHING
        self._idle = self._idle + elapsed if times.user + times.system == self._used else 0.0
        self._used = times.user + times.system
        if self.begun:
            self._at_work += elapsed
        if timeout is not None and self._at_work > timeout:
            return Lost.frozen if stopped else Lost.late
        patience = _FROZEN if timeout is None else min(_FROZEN, timeout + 10.0)
        return Lost.frozen if self._idle > patience else _NOTHING

    def end(self) -> None:
        """Kill it, whatever it is at: what it has stored is whole, and a stopped process heeds nothing else."""
        self._process.kill()
        self._process.join()
        self.pipe.close()


def _serve(pipe: "Connection[Any, Any]", function: Callable[[Any], Any]) -> None:
    Thread(target=_end_with_parent, daemon=True).start()
    pipe.send(None)
    while True:
        try:
            task = pipe.recv()
        except EOFError:
            return
        answer: Any
        try:
            answer = function(task)
        except Exception as error:
            answer = error
        pipe.send(answer)


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Make Ctrl-C wait; processes begun inside never see it."""
    if sys.platform == "win32":
        yield
        return
    resource_tracker.ensure_running()  # multiprocessing starts it on demand, and would let Ctrl-C through after that
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
