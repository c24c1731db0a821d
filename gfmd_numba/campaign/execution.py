"""Running a campaign's tasks, in this process or on dask workers; a finished shard is the only proof of work."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from gfmd_numba.campaign import shards
from gfmd_numba.campaign.cases import Task
from gfmd_numba.contact import solve
from gfmd_numba.observables import measure

Failures = dict[str, str]
Progress = Callable[[], None]


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


def execute(
    tasks: list[Task], directory: Path, workers: int, scheduler: str | None, progress: Progress
) -> Failures:
    """Perform tasks on `workers` local dask processes (0: here), or on an existing dask scheduler.

    Returns task name -> reason of those that failed; the others are finished all the same.
    """
    (directory / "shards").mkdir(exist_ok=True)
    if not tasks:
        return {}
    if workers == 0 and scheduler is None:
        return _execute_here(tasks, directory, progress)
    perform_once_here(tasks, directory)
    with _client(workers, scheduler) as client:
        return _execute_on(client, tasks, directory, progress)


def perform_once_here(tasks: list[Task], directory: Path) -> None:
    """Compile the kernels before the workers start, so that they find them in the cache."""
    from dataclasses import replace

    from gfmd_numba.problem import RandomSurface

    for solver in sorted({task.problem.numerics.solver for task in tasks}):
        problem = next(task.problem for task in tasks if task.problem.numerics.solver == solver)
        tiny = replace(problem, surface=RandomSurface(0.5, 1, 4, 16, 0))
        measure(solve(tiny, range(1)))


def _execute_here(tasks: list[Task], directory: Path, progress: Progress) -> Failures:
    failures = {}
    for task in tasks:
        try:
            perform(task, directory)
        except (ArithmeticError, MemoryError, RuntimeError, ValueError) as error:
            failures[task.name] = f"{type(error).__name__}: {error}"
        progress()
    return failures


def _execute_on(client, tasks: list[Task], directory: Path, progress: Progress) -> Failures:
    from distributed import as_completed

    failures = {}
    waiting = iter(tasks)
    names = {}

    def submit() -> Iterator:
        for task in waiting:
            future = client.submit(perform, task, directory, key=f"perform-{task.name}", pure=False)
            names[future.key] = task.name
            yield future

    in_flight = 2 * max(1, len(client.scheduler_info()["workers"]))
    more = submit()
    futures = as_completed([future for _, future in zip(range(in_flight), more, strict=False)])
    for future in futures:
        if future.status != "finished":
            error = future.exception()
            failures[names[future.key]] = f"{type(error).__name__}: {error}"
        progress()
        following = next(more, None)
        if following is not None:
            futures.add(following)
    return failures


@contextmanager
def _client(workers: int, scheduler: str | None):
    from distributed import Client, LocalCluster

    if scheduler is not None:
        with Client(scheduler) as client:
            yield client
        return
    for variable in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
        os.environ[variable] = "1"  # inherited by the workers: one thread each, two solves never share a core
    with (
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address=None,
            silence_logs="ERROR",
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client
