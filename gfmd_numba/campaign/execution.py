"""Blocks of a campaign solved in this process or on dask workers. Only a finished shard counts as done.

A task is done by one process: its blocks are solved one after another, and stored or handed back.
"""

import faulthandler
import signal
import threading
import time
from collections.abc import Generator, Iterable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import islice
from math import inf
from pathlib import Path
from tempfile import gettempdir
from time import monotonic
from typing import Any
from uuid import uuid4

import numpy as np

from gfmd_numba.arrays.threads import shared_by
from gfmd_numba.campaign import shards
from gfmd_numba.campaign.cases import Block
from gfmd_numba.campaign.failures import Failure
from gfmd_numba.campaign.provenance import difference, versions
from gfmd_numba.campaign.workers import Workers, started
from gfmd_numba.contact import load_path
from gfmd_numba.contact.load_path import measured
from gfmd_numba.contact.problem import Problem
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.scene import InputError
from gfmd_numba.storage import atomic_file
from gfmd_numba.storage.atomic_file import make_folder

_AGAIN = 1.0  # s after which the alarm repeats: Python swallows an exception that is raised as it collects garbage
SECONDS = "seconds"  # what each realisation of a block took, stored with its measures
Task = tuple[Block, ...]  # what a worker does at a time
Failures = dict[str, Failure]
Measured = dict[str, shards.Arrays]  # by name of the block
_installed = cache(versions)
_LOST = "its worker died or froze, even when nothing else was running"
_SECONDS_BETWEEN_COUNTS = 5.0  # of the workers, which may come and go
_NO_SCHEDULER = "the dask scheduler is lost"
_MOST_FILES = 1000  # about, in which the blocks of a run are finished: so many small ones share a file


@shared_by(1)
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


@shared_by(1)
def compute(task: Task, run: str, expected: Mapping[str, str], timeout: float | None) -> tuple[Measured, Failures]:
    """Solve blocks on a worker and return their measures and what failed, without the output directory.

    A block that takes longer than `timeout` seconds ends the process, which leaves a trace in this machine's folder of
    temporary files, under the name of the `run`. A process that finds the trace does not try the block again. Raises
    InputError on a worker whose packages have other versions than `expected`.
    """
    if wrong := difference(_installed(), expected):
        raise InputError(f"cluster: you gave a worker with {wrong}")
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


Ended = Generator[tuple[int, Failures]]  # numbers of blocks that ended, with those that failed


def execute(tasks: list[Task], directory: Path, workers: Workers, timeout: float | None) -> Ended:
    """Perform tasks, and yield how many blocks ended and which of them failed, each time that some have.

    Raises OSError where shards cannot be written, ConnectionError when the scheduler is lost; whatever was finished
    then is kept, as it is if the generator is closed early.
    """
    make_folder(directory / shards.FOLDER)
    shards.remove_unreadable(directory)  # their blocks are among the tasks
    if not tasks:
        return
    together = -(-sum(len(task) for task in tasks) // _MOST_FILES)
    if workers.in_this_process:
        for task in tasks:
            yield len(task), perform(task, directory, timeout, together)
        return
    with started(workers, directory) as begun:
        submission = Submission(begun.client, directory.resolve(), timeout, together, begun.most)
        with closing(submission.ended(tasks)) as ended:
            yield from ended


@dataclass(frozen=True)
class Submission:
    """Tasks on the workers of a dask client, which hand their blocks back, so that they need no output directory.

    Up to `most` workers are kept busy, or more if there are more.
    """

    client: Any
    directory: Path
    timeout: float | None
    together: int
    most: int
    run: str = field(default_factory=lambda: uuid4().hex)

    def ended(self, tasks: Iterable[Task]) -> Ended:
        """Perform tasks, a few at a time, and then once more, alone, each block of tasks that lost their worker.

        A lost worker takes innocent blocks with it. A block has failed only if it was late, or if it loses its worker
        again when it runs alone.
        """
        for alone in (False, True):
            suspects: list[Task] = []
            with closing(self._outcomes(iter(tasks), alone)) as outcomes:
                for task, outcome in outcomes:
                    left = [] if outcome is not None else unfinished(task, self.directory)
                    names = [block.name for block in left]
                    late: set[str] = set()  # those that took longer than the timeout
                    if names and self.timeout is not None:
                        late = set(expired_here(self.run, names))  # before a worker that may die forgets them
                        told = self.client.run(expired_here, self.run, names, on_error="ignore")
                        late.update(*told.values())
                    failures = outcome or {}
                    for block in left:
                        if block.name in late:
                            failures[block.name] = too_long(self.timeout)
                        elif alone:
                            failures[block.name] = Failure("crashed", _LOST)
                    again = [block for block in left if block.name not in failures]
                    yield len(task) - len(again), failures
                    suspects += [(block,) for block in again]
            tasks = suspects

    def _outcomes(self, tasks: Iterator[Task], alone: bool) -> Generator[tuple[Task, Failures | None]]:
        """Yield each task with its failures as it ends, None if it lost its worker; one at a time if `alone`."""
        from distributed import KilledWorker, as_completed
        from distributed.client import FutureCancelledError

        at_work: dict[str, Task] = {}
        wanted, counted = 1, -inf
        of_all = self.run, versions(), self.timeout

        def submitted() -> list[Any]:
            """Return futures of the next tasks, as many as the workers have room for."""
            nonlocal wanted, counted
            if not alone and monotonic() - counted > _SECONDS_BETWEEN_COUNTS:
                try:
                    wanted, counted = 2 * max(1, self.most, len(self.client.nthreads())), monotonic()
                except OSError:
                    raise ConnectionError(_NO_SCHEDULER) from None
            some = list(islice(tasks, max(0, wanted - len(at_work))))
            new = [self.client.submit(compute, task, *of_all, pure=False) for task in some]  # keys are nobody else's
            at_work.update((future.key, task) for future, task in zip(new, some, strict=True))
            return new

        futures = as_completed(submitted(), loop=self.client.loop)
        for future in futures:
            failures: Failures | None
            try:
                finished, failures = future.result()
                names = list(finished)
                for first in range(0, len(names), self.together):
                    some = names[first : first + self.together]
                    shards.store(self.directory, {name: finished[name] for name in some})
            except KilledWorker:
                failures = None
            except FutureCancelledError:
                raise ConnectionError(_NO_SCHEDULER) from None
            yield at_work.pop(future.key), failures
            futures.update(submitted())


def compile_kernels(problems: Iterable[Problem]) -> None:
    """Run each kind of problem on a tiny surface, so that workers find the compiled kernels in the cache."""
    kinds = {
        (problem.numerics.solver, problem.interface.everywhere, problem.mean_pressure is None): problem
        for problem in problems
    }
    for (_, interface, _), problem in kinds.items():
        surface = RandomSurface(SelfAffineWaves(0.5, 1, 4), 16, 0, len(problem.surface.shape))
        tiny = replace(problem, surface=surface, interface=interface, path=problem.path[:1], rough=None, tractions=None)
        load_path.measured(replace(tiny, numerics=replace(problem.numerics, max_iterations=100)), range(1))
