"""Running a campaign's tasks, in this process or on dask workers; a finished shard is the only proof of work."""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import islice
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any

from gfmd_numba.campaign import shards
from gfmd_numba.campaign.cases import Task
from gfmd_numba.contact import solve
from gfmd_numba.observables import measure
from gfmd_numba.problem import RandomSurface
from gfmd_numba.scene import InputError

Failures = dict[str, str]
Progress = Callable[[], None]

_THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")


def shard_path(directory: Path, task: Task) -> Path:
    """Where the shard of a task lies."""
    return directory / "shards" / f"{task.name}.shard"


def perform(task: Task, directory: Path) -> None:
    """Solve one task and store its measures, unless its shard is already there and sound."""
    path = shard_path(directory, task)
    if shards.read(path) is None:
        shards.write(path, measure(solve(task.problem, range(task.first, task.stop))))


def unfinished(tasks: list[Task], directory: Path) -> list[Task]:
    """Tasks without a sound shard."""
    return [task for task in tasks if shards.read(shard_path(directory, task)) is None]


def execute(tasks: list[Task], directory: Path, workers: int, scheduler: str | None, progress: Progress) -> Failures:
    """Perform tasks on `workers` local dask processes (0: here), or on an existing dask scheduler.

    Returns task name -> reason of those that failed; the others are finished all the same.
    """
    (directory / "shards").mkdir(exist_ok=True)
    if not tasks:
        return {}
    if workers == 0 and scheduler is None:
        return _execute_here(tasks, directory, progress)
    compile_kernels(tasks)
    with _client(workers, scheduler) as client:
        return _execute_on(client, tasks, directory.resolve(), progress)


def compile_kernels(tasks: list[Task]) -> None:
    """Run each solver on a tiny surface, so that workers find the compiled kernels in the cache."""
    solvers = {task.problem.numerics.solver: task.problem for task in tasks}
    for problem in solvers.values():
        measure(solve(replace(problem, surface=RandomSurface(0.5, 1, 4, 16, 0)), range(1)))


def _execute_here(tasks: list[Task], directory: Path, progress: Progress) -> Failures:
    failures = {}
    for task in tasks:
        try:
            perform(task, directory)
        except (ArithmeticError, MemoryError, RuntimeError, ValueError) as error:
            failures[task.name] = f"{type(error).__name__}: {error}"
        progress()
    return failures


def _execute_on(client: Any, tasks: list[Task], directory: Path, progress: Progress) -> Failures:
    from distributed import as_completed

    names = {f"perform-{task.name}": task.name for task in tasks}
    submissions = (
        client.submit(perform, task, directory, key=key, pure=False) for key, task in zip(names, tasks, strict=True)
    )
    in_flight = 2 * max(1, len(client.scheduler_info()["workers"]))
    futures = as_completed(list(islice(submissions, in_flight)), loop=client.loop)
    failures = {}
    for future in futures:
        error = future.exception()
        if error is not None:
            failures[names[future.key]] = f"{type(error).__name__}: {error}"
        progress()
        for following in islice(submissions, 1):
            futures.add(following)
    return failures


@contextmanager
def _client(workers: int, scheduler: str | None) -> Iterator[Any]:
    from distributed import Client, LocalCluster
    from distributed.comm.addressing import resolve_address

    if scheduler is not None:
        try:
            resolve_address(scheduler)  # a client of a malformed address would go on failing in the background
            client = Client(scheduler, timeout=10, set_as_default=False)  # or xarray writes through one that failed
        except (OSError, ValueError, KeyError) as error:
            raise InputError(
                f"--scheduler: given {scheduler} ({error}); "
                "allowed: the address of a running dask scheduler, like tcp://127.0.0.1:8786"
            ) from None
        with client:
            yield client
        return
    os.environ.update(dict.fromkeys(_THREADS, "1"))  # inherited: two workers never compete for a core
    with (
        _interrupts(False),  # inherited, too: Ctrl-C reaches every process, but only this one acts on it
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",  # any free port: None means 8787, which another run may hold
            silence_logs="CRITICAL",
        ) as cluster,
        Client(cluster) as client,
        _interrupts(True),
    ):
        yield client


@contextmanager
def _interrupts(allowed: bool) -> Iterator[None]:
    """Let Ctrl-C interrupt this thread, or make it wait; threads and processes begun inside inherit that."""
    if sys.platform == "win32":
        yield
        return
    resource_tracker.ensure_running()  # multiprocessing starts it on demand, and would let Ctrl-C through after that
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        signal.pthread_sigmask(signal.SIG_UNBLOCK if allowed else signal.SIG_BLOCK, {signal.SIGINT})
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
