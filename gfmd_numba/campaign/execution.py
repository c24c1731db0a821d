"""Solving a campaign's blocks, in this process or on dask workers; a finished shard is the only proof of work."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from numbers import Integral
from pathlib import Path
from typing import Any

from gfmd_numba.campaign import shards
from gfmd_numba.campaign.block_work import Task, perform
from gfmd_numba.campaign.cases import Range
from gfmd_numba.campaign.cluster import check_workers, connected, frozen_replaced, is_client, local
from gfmd_numba.campaign.cluster_file import Cluster, load_cluster
from gfmd_numba.campaign.queue_state import QueueTold
from gfmd_numba.campaign.submission import Submission, Told
from gfmd_numba.contact.path_measures import measured
from gfmd_numba.contact.problem import Problem
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.scene import InputError
from gfmd_numba.storage.atomic_file import make_folder
from gfmd_numba.text.input_error import brief

_MOST_FILES = 1000  # about, in which the blocks of a run are finished: so many small ones share a file


@dataclass(frozen=True)
class Workers:
    """Who does the work: `count` local dask workers (0: this process), or a dask cluster.

    The cluster is that of a scheduler at `address`, which beyond this machine has to use TLS or be allowed as
    `insecure`, that of a dask `client`, or that of jobs as a `cluster` file describes them, with whose state in the
    queue `queue_told` is called. Workers `at_home` were started here, and store their blocks in the output directory
    themselves; others hand them back.
    """

    count: int = 2
    address: str | None = None
    insecure: bool = False
    client: Any = None
    cluster: Cluster | None = None
    queue_told: QueueTold | None = None
    at_home: bool = False

    @property
    def in_this_process(self) -> bool:
        """Whether this process does all the work."""
        return self.count == 0 and not self.elsewhere

    @property
    def elsewhere(self) -> bool:
        """Whether the work is done by a dask cluster that this run did not start on this machine."""
        return not ((self.address is None and self.client is None and self.cluster is None) or self.at_home)

    @property
    def most(self) -> int:
        """Number of workers to divide the work for."""
        return self.count if self.cluster is None else self.cluster.most_workers


def workers_of(given: object) -> Workers:
    """Workers of a number of processes, a dask client, or a cluster file or its content; raises InputError."""
    if isinstance(given, Integral) and not isinstance(given, bool) and int(given) >= 0:
        return Workers(int(given))
    if is_client(given):
        return Workers(client=given)
    if isinstance(given, str | Path | Mapping) and not str(given).isdecimal():
        return Workers(cluster=load_cluster(given))
    raise InputError(
        f"workers: you gave {brief(given)}; gfmd allows a number of processes from 0, a dask.distributed.Client, or a "
        "cluster file"
    )


def check(workers: Workers, directory: Path) -> None:
    """Raise InputError unless workers can do their work for an output directory, which need not exist yet."""
    if workers.cluster is not None:
        from gfmd_numba.campaign.job_queue import check_queue

        check_queue(workers.cluster, directory)
    elif workers.elsewhere:
        with connected(workers.address, workers.client, workers.insecure) as client:
            check_workers(client, "workers" if workers.address is None else "--scheduler")


@contextmanager
def started(workers: Workers, directory: Path) -> Iterator[Workers]:
    """Workers with a client, for as long as they are needed: local ones and jobs are started, a cluster connected."""
    if workers.client is not None or workers.in_this_process:
        yield workers
    elif workers.cluster is not None:
        from gfmd_numba.campaign.job_queue import jobs

        with jobs(workers.cluster, directory.resolve(), workers.queue_told) as client:
            yield replace(workers, client=client)
    elif workers.address is not None:
        with connected(workers.address, None, workers.insecure) as client:
            yield replace(workers, client=client)
    else:
        with local(workers.count) as client:
            yield replace(workers, client=client, at_home=True)


def held(finished: shards.Finished) -> dict[str, list[Range]]:
    """Ranges of realisations that finished blocks are named after, by identity of the problem."""
    ranges: dict[str, list[Range]] = {}
    for name in finished:
        identity, *numbers = name.rsplit("-", 2)
        if len(numbers) == 2 and all(number.isdecimal() for number in numbers):
            ranges.setdefault(identity, []).append((int(numbers[0]), int(numbers[1])))
    return ranges


def execute(tasks: list[Task], directory: Path, workers: Workers, timeout: float | None, finished: Told) -> None:
    """Perform tasks until all are done or `finished` says to stop.

    Raises OSError where shards cannot be written, ConnectionError when the scheduler is lost; whatever was finished
    then is kept.
    """
    make_folder(directory / shards.FOLDER)
    shards.remove_unreadable(directory)  # their blocks are among the tasks
    if not tasks:
        return
    together = -(-sum(len(task) for task in tasks) // _MOST_FILES)
    if workers.in_this_process:
        for task in tasks:
            if not finished(len(task), perform(task, directory, timeout, together, mortal=False)):
                return
        return
    with started(workers, directory) as begun, frozen_replaced(begun.client, timeout):
        Submission(begun.client, directory.resolve(), timeout, together, finished, begun.at_home, begun.most).all(tasks)


def compile_kernels(problems: Iterable[Problem]) -> None:
    """Run each kind of problem on a tiny surface, so that workers find the compiled kernels in the cache."""
    kinds = {
        (problem.numerics.solver, problem.interface, problem.mean_pressure is None): problem for problem in problems
    }
    for problem in kinds.values():
        surface = RandomSurface(SelfAffineWaves(0.5, 1, 4), 16, 0, len(problem.surface.shape))
        tiny = replace(problem, surface=surface, path=problem.path[:1], rough=None, tractions=None)
        measured(replace(tiny, numerics=replace(problem.numerics, max_iterations=100)), range(1))
