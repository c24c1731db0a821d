"""Solving a campaign's blocks, in this process or on dask workers; a finished shard is the only proof of work."""

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from gfmd_numba.campaign import shards
from gfmd_numba.campaign.cases import Block
from gfmd_numba.campaign.cluster import connected
from gfmd_numba.campaign.failures import Failure
from gfmd_numba.campaign.watchdog import TooLongError, expired, watched
from gfmd_numba.contact import solve
from gfmd_numba.observables import measure
from gfmd_numba.problem import Problem, RandomSurface

SECONDS = "seconds"  # what a block took, stored beside its measures

Task = tuple[Block, ...]  # what a worker does at a time
Failures = dict[str, Failure]
Finished = Callable[[int, Failures], bool]  # told of blocks that ended and how many failed; False: stop


@dataclass(frozen=True)
class Workers:
    """Who does the work: `count` local dask processes (0: this one), or those of a dask scheduler at `address`.

    An address beyond this machine without TLS has to be allowed as `insecure`.
    """

    count: int = 2
    address: str | None = None
    insecure: bool = False


def shard_path(directory: Path, block: Block) -> Path:
    """Where the shard of a block lies."""
    return directory / "shards" / f"{block.name}.shard"


def perform(task: Task, directory: Path, timeout: float | None, mortal: bool = True) -> Failures:
    """Solve blocks one after another and store their measures, unless a sound shard is there; returns what failed.

    A `mortal` process ends itself if nothing else stops a block after `timeout` seconds. An OSError is raised: a disk
    that fails one block fails them all.
    """
    failures = {}
    for block in task:
        path = shard_path(directory, block)
        if shards.read(path) is not None:
            continue
        try:
            with watched(timeout, _trace(directory, block.name) if mortal else None):
                begun = time.thread_time()
                measures = measure(solve(block.problem, range(block.first, block.stop)))
                measures[SECONDS] = np.array([time.thread_time() - begun])
        except TooLongError:
            failures[block.name] = _too_long(timeout)
        except Exception as error:  # whatever it is, it concerns this block only
            failures[block.name] = Failure("crashed", f"{type(error).__name__}: {error}")
        else:
            shards.write(path, measures)
    return failures


def unfinished(blocks: Iterable[Block], directory: Path) -> list[Block]:
    """Blocks without a sound shard."""
    return [block for block in blocks if shards.read(shard_path(directory, block)) is None]


def execute(tasks: list[Task], directory: Path, workers: Workers, timeout: float | None, finished: Finished) -> None:
    """Perform tasks until all are done or `finished` says to stop.

    Raises OSError where shards cannot be written, ConnectionError when the scheduler is lost; whatever was finished
    then is kept.
    """
    (directory / "shards").mkdir(exist_ok=True)
    if not tasks:
        return
    if workers.count == 0 and workers.address is None:
        for task in tasks:
            if not finished(len(task), perform(task, directory, timeout, mortal=False)):
                return
        return
    with connected(workers.count, workers.address, workers.insecure, directory) as client:
        _Submission(client, directory.resolve(), timeout, finished).all(tasks)


def compile_kernels(problems: Iterable[Problem]) -> None:
    """Run each kind of problem on a tiny surface, so that workers find the compiled kernels in the cache."""
    kinds = {
        (problem.numerics.solver, problem.interface, problem.mean_pressure is None): problem for problem in problems
    }
    for problem in kinds.values():
        tiny = replace(problem, surface=RandomSurface(0.5, 1, 4, 16, 0, len(problem.surface.shape)))
        measure(solve(replace(tiny, numerics=problem.numerics.model_copy(update={"max_iterations": 100})), range(1)))


@dataclass(frozen=True)
class _Submission:
    """Tasks on the workers of a dask client."""

    client: Any
    directory: Path
    timeout: float | None
    finished: Finished

    def all(self, tasks: list[Task]) -> None:
        """Perform tasks, a few in flight; the blocks of those that took a worker with them then once more, alone.

        A worker that dies takes innocent tasks with it: only who dies alone is to blame.
        """
        in_flight = 2 * max(1, len(self.client.scheduler_info()["workers"]))
        suspects: list[Block] = []
        for task, failures in self._results(tasks, "perform", in_flight):
            if failures is None:
                suspects += unfinished(task, self.directory)
                failures = {}
                ended = len(task) - len(unfinished(task, self.directory))
            else:
                ended = len(task)
            if not self.finished(ended, failures):
                return
        alone: list[Task] = []
        for block in suspects:
            if expired(_trace(self.directory, block.name)):
                if not self.finished(1, {block.name: _too_long(self.timeout)}):
                    return
            else:
                alone.append((block,))
        for task, failures in self._results(alone, "alone", 1):
            if failures is None:
                late = expired(_trace(self.directory, task[0].name))
                died = Failure("crashed", "its worker died, also with nothing else at work")
                failures = {task[0].name: _too_long(self.timeout) if late else died}
            if not self.finished(1, failures):
                return

    def _results(self, tasks: list[Task], verb: str, in_flight: int) -> Iterator[tuple[Task, Failures | None]]:
        """Each task with its failures as it ends, None if it took its worker with it.

        The scheduler remembers a task by `verb` and name: done again it needs another verb.
        """
        from distributed import KilledWorker, as_completed
        from distributed.client import FutureCancelledError

        by_key = {f"{verb}-{task[0].name}": task for task in tasks}
        submissions = (
            self.client.submit(perform, task, self.directory, self.timeout, key=key, pure=False)
            for key, task in by_key.items()
        )
        futures = as_completed(list(islice(submissions, in_flight)), loop=self.client.loop)
        for future in futures:
            failures: Failures | None
            try:
                failures = future.result()
            except KilledWorker:
                failures = None
            except FutureCancelledError:
                raise ConnectionError("the dask scheduler is lost") from None
            yield by_key[future.key], failures
            for following in islice(submissions, 1):
                futures.add(following)


def _trace(directory: Path, name: str) -> Path:
    return directory / "shards" / f"{name}.late.tmp"


def _too_long(timeout: float | None) -> Failure:
    return Failure("timeout", f"it took more than the campaign's case_timeout of {timeout:g} s")
