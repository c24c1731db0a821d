"""Solving a campaign's blocks, in this process or on dask workers; a finished shard is the only proof of work."""

import time
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from itertools import islice
from numbers import Integral
from pathlib import Path
from typing import Any

import numpy as np

from gfmd_numba.campaign import shards
from gfmd_numba.campaign.cases import Block, Range
from gfmd_numba.campaign.cluster import check_workers, connected, frozen_replaced, is_client, local
from gfmd_numba.campaign.failures import Failure
from gfmd_numba.campaign.kept_memory import keep_freed_memory
from gfmd_numba.campaign.watchdog import TooLongError, expired, watched
from gfmd_numba.contact.evaluation import measure
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import solve
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine_waves import SelfAffineWaves
from gfmd_numba.scene import InputError
from gfmd_numba.text.input_error import brief

SECONDS = "seconds"  # what each realisation of a block took, stored beside its measures
_MOST_FILES = 1000  # about, in which the blocks of a run are finished: so many small ones share a file
_LOST = "its worker died or froze, even when nothing else was running"

Task = tuple[Block, ...]  # what a worker does at a time
Failures = dict[str, Failure]
Told = Callable[[int, Failures], bool]  # told of blocks that ended and how many failed; False: stop


@dataclass(frozen=True)
class Workers:
    """Who does the work: `count` local dask workers (0: this process), or a dask cluster.

    The cluster is that of a scheduler at `address`, which beyond this machine has to use TLS or be allowed as
    `insecure`, or that of a dask `client`.
    """

    count: int = 2
    address: str | None = None
    insecure: bool = False
    client: Any = None

    @property
    def on_cluster(self) -> bool:
        """Whether a dask cluster does the work."""
        return self.address is not None or self.client is not None


def workers_of(given: object) -> Workers:
    """Workers of a number of processes or a dask client; raises InputError."""
    if isinstance(given, Integral) and not isinstance(given, bool) and int(given) >= 0:
        return Workers(int(given))
    if is_client(given):
        return Workers(client=given)
    raise InputError(
        f"workers: given {brief(given)}; allowed: a number of processes from 0, or a dask.distributed.Client"
    )


def check(workers: Workers, directory: Path) -> None:
    """Raise InputError unless workers can do their work for an output directory, which need not exist yet."""
    if workers.on_cluster:
        with connected(workers.address, workers.client, workers.insecure) as client:
            check_workers(client, directory, "workers" if workers.address is None else "--scheduler")


def held(finished: shards.Finished) -> dict[str, list[Range]]:
    """Ranges of realisations that finished blocks are named after, by identity of the problem."""
    ranges: dict[str, list[Range]] = {}
    for name in finished:
        identity, *numbers = name.rsplit("-", 2)
        if len(numbers) == 2 and all(number.isdecimal() for number in numbers):
            ranges.setdefault(identity, []).append((int(numbers[0]), int(numbers[1])))
    return ranges


def perform(task: Task, directory: Path, timeout: float | None, together: int = 1, mortal: bool = True) -> Failures:
    """Solve blocks one after another and store their measures, so many `together`; returns what failed.

    Blocks that are stored and sound are left alone. A `mortal` process ends itself if nothing else stops a block after
    `timeout` seconds. An OSError is raised: a disk that fails one block fails them all.
    """
    if mortal:
        keep_freed_memory()
    failures: Failures = {}
    for first in range(0, len(task), together):
        some = task[first : first + together]
        if shards.are_stored(directory, [block.name for block in some]):
            continue
        measured: dict[str, shards.Arrays] = {}
        try:
            for block in some:
                outcome = _outcome(block, directory, timeout, mortal)
                if isinstance(outcome, Failure):
                    failures[block.name] = outcome
                else:
                    measured[block.name] = outcome
        finally:  # also what an interrupt leaves
            shards.store(directory, measured)
    return failures


def _outcome(block: Block, directory: Path, timeout: float | None, mortal: bool) -> shards.Arrays | Failure:
    """Measures of a block, or why there are none."""
    try:
        with watched(timeout, _trace(directory, block.name) if mortal else None):
            begun = time.thread_time()
            measures = measure(solve(block.problem, range(block.first, block.stop)))
            count = block.stop - block.first
            return measures | {SECONDS: np.full(count, (time.thread_time() - begun) / count)}
    except TooLongError:
        return _too_long(timeout)
    except Exception as error:  # whatever it is, it concerns this block only
        return Failure("crashed", f"{type(error).__name__}: {error}")


def unfinished(blocks: Iterable[Block], directory: Path) -> list[Block]:
    """Blocks that are not stored, or not as they were written."""
    finished = shards.Finished(directory)
    return [block for block in blocks if not finished.is_sound(block.name)]


def execute(tasks: list[Task], directory: Path, workers: Workers, timeout: float | None, finished: Told) -> None:
    """Perform tasks until all are done or `finished` says to stop.

    Raises OSError where shards cannot be written, ConnectionError when the scheduler is lost; whatever was finished
    then is kept.
    """
    (directory / "shards").mkdir(exist_ok=True)
    for bundle in shards.Finished(directory).unreadable:
        bundle.unlink()  # its blocks are among the tasks
    if not tasks:
        return
    together = -(-sum(len(task) for task in tasks) // _MOST_FILES)
    if workers.count == 0 and not workers.on_cluster:
        for task in tasks:
            if not finished(len(task), perform(task, directory, timeout, together, mortal=False)):
                return
        return
    cluster = (
        connected(workers.address, workers.client, workers.insecure) if workers.on_cluster else local(workers.count)
    )
    with cluster as client, frozen_replaced(client, timeout):
        _Submission(client, directory.resolve(), timeout, together, finished).all(tasks)


def compile_kernels(problems: Iterable[Problem]) -> None:
    """Run each kind of problem on a tiny surface, so that workers find the compiled kernels in the cache."""
    kinds = {
        (problem.numerics.solver, problem.interface, problem.mean_pressure is None): problem for problem in problems
    }
    for problem in kinds.values():
        tiny = replace(problem, surface=RandomSurface(SelfAffineWaves(0.5, 1, 4), 16, 0, len(problem.surface.shape)))
        measure(solve(replace(tiny, numerics=replace(problem.numerics, max_iterations=100)), range(1)))


@dataclass(frozen=True)
class _Submission:
    """Tasks on the workers of a dask client."""

    client: Any
    directory: Path
    timeout: float | None
    together: int
    finished: Told

    def all(self, tasks: list[Task]) -> None:
        """Perform tasks, a few in flight; the blocks of those that lost their worker then once more, alone.

        A worker that is lost takes innocent blocks with it: only what loses its worker alone is to blame, or was late.
        """
        for alone in (False, True):
            suspects: list[Task] = []
            with closing(self._outcomes(tasks, alone)) as outcomes:
                for task, outcome in outcomes:
                    left = [] if outcome is not None else unfinished(task, self.directory)
                    failures = outcome or {}
                    for block in left:
                        if expired(_trace(self.directory, block.name)):
                            failures[block.name] = _too_long(self.timeout)
                        elif alone:
                            failures[block.name] = Failure("crashed", _LOST)
                    again = [block for block in left if block.name not in failures]
                    if not self.finished(len(task) - len(again), failures):
                        return
                    suspects += [(block,) for block in again]
            tasks = suspects

    def _outcomes(self, tasks: list[Task], alone: bool) -> Generator[tuple[Task, Failures | None]]:
        """Each task with its failures as it ends, None if it lost its worker; one at a time if `alone`."""
        from distributed import KilledWorker, as_completed
        from distributed.client import FutureCancelledError

        in_flight = 1 if alone else 2 * max(1, len(self.client.nthreads()))
        at_work: dict[str, Task] = {}

        def submitted() -> Iterator[Any]:
            for task in tasks:
                # its key is nobody else's, also on a scheduler that others use
                future = self.client.submit(perform, task, self.directory, self.timeout, self.together, pure=False)
                at_work[future.key] = task
                yield future

        submissions = submitted()
        futures = as_completed(list(islice(submissions, in_flight)), loop=self.client.loop)
        for future in futures:
            failures: Failures | None
            try:
                failures = future.result()
            except KilledWorker:
                failures = None
            except FutureCancelledError:
                raise ConnectionError("the dask scheduler is lost") from None
            yield at_work.pop(future.key), failures
            for following in islice(submissions, 1):
                futures.add(following)


def _trace(directory: Path, name: str) -> Path:
    return directory / "shards" / f"{name}.late.tmp"


def _too_long(timeout: float | None) -> Failure:
    return Failure("timeout", f"it took more than the campaign's case_timeout of {timeout:g} s")
