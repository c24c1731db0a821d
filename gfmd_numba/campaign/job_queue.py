"""Workers in jobs of a queueing system: submitted as long as there are blocks, and again when a job has ended."""

import asyncio
import re
import shutil
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from shlex import quote
from time import monotonic
from typing import Any, Self
from uuid import uuid4

import dask
import psutil
from dask_jobqueue.slurm import SLURMCluster, SLURMJob
from distributed import Client, Future
from distributed.core import Status
from distributed.deploy.adaptive import Adaptive
from distributed.diagnostics.plugin import SchedulerPlugin
from distributed.security import Security

from gfmd_numba.campaign.cluster import Cluster
from gfmd_numba.campaign.workers import OF_A_RUN, OF_WORKERS
from gfmd_numba.scene import InputError
from gfmd_numba.storage import atomic_file
from gfmd_numba.text.input_error import brief

FOLDER = "jobs"  # in the output directory: what jobs print, and for the time of a run the certificates of its workers
_INTERVAL = "2s"  # between looks at how many jobs are wanted
_COMMANDS = ("sbatch", "squeue", "scancel")
_ON_CLUSTER = OF_A_RUN | {
    "distributed.scheduler.allowed-failures": 10  # jobs end when their time is up, and no block is to blame for it
}
_PATIENCE = 120.0  # s, with a controller that is busy
_PLAIN = re.compile(r"[A-Za-z0-9._/@+,:~-]+")  # a path that a job's script can hold as it is
_SECONDS_BETWEEN_LOOKS = 10.0  # at the queue, whose controller others ask, too
_SECONDS_TO_FIRST_LOOK = 3.0
_MOST_IN_VAIN = 5  # jobs that end before a worker comes
_TO_DO = {"queued", "no-worker", "waiting", "processing"}
FORMAT = "%A %t %r"  # of squeue: number, compact state, and the reason for it
_AT_WORK, _ENDING = "R", "CG"  # states; a job in any other has not begun


@dataclass(frozen=True)
class QueueState:
    """How many jobs wait, why most of them do in the words of the queueing system, and how many run."""

    waiting: int = 0
    reason: str = ""
    running: int = 0

    @classmethod
    def of(cls, jobs: list[list[str]]) -> Self:
        """Count jobs, each given as the columns of `FORMAT`."""
        reasons = Counter(reason for _, state, reason in jobs if state not in (_AT_WORK, _ENDING))
        most = reasons.most_common(1)
        return cls(reasons.total(), most[0][0] if most else "", sum(state == _AT_WORK for _, state, _ in jobs))


def columns_of(printed: str) -> list[list[str]]:
    """Return the columns of every job that squeue has printed."""
    return [line.split(maxsplit=2) for line in printed.strip().splitlines()]


QueueTold = Callable[[QueueState], None]


def check_queue(cluster: Cluster, directory: Path) -> None:
    """Raise InputError unless jobs of a cluster can be submitted from here, for an output directory."""
    for command in _COMMANDS:
        if shutil.which(command) is None:
            raise InputError(
                f"--cluster: this machine has no {command}; gfmd needs a machine that submits jobs to SLURM, as the "
                "login node of a cluster does"
            )
    if not _PLAIN.fullmatch(str(directory.resolve())):
        raise InputError.of(
            "--output",
            f"{brief(str(directory.resolve()))} with --cluster",
            "a path of letters, digits and ._/@+,:~- alone, as scripts of jobs name it",
        )
    if cluster.interface not in (None, *(here := psutil.net_if_addrs())):
        raise InputError.of("--cluster", f"the interface {cluster.interface}", f"one of {', '.join(here)}")
    job = SLURMJob("tls://192.0.2.1:8786", name="test", **_options(cluster, "gfmd-test"))
    with job.job_file() as script:
        try:
            tested = subprocess.run(
                ["sbatch", "--test-only", script], capture_output=True, text=True, timeout=_PATIENCE
            )
        except subprocess.TimeoutExpired:
            raise InputError(
                f"--cluster: sbatch did not answer in {_PATIENCE:g} s; gfmd needs a SLURM that is up"
            ) from None
    if tested.returncode != 0:
        said = " ".join(tested.stderr.split()) or f"exit code {tested.returncode}"
        raise InputError.of(
            "--cluster",
            f"jobs that SLURM does not take ({said})",
            "a SLURM that is up, and cores, memory, walltime, partition, account and directives that `sinfo` and your "
            "site's rules permit",
        )


@contextmanager
def jobs(cluster: Cluster, directory: Path, told: QueueTold | None = None) -> Iterator[Any]:
    """Yield a client of the workers in jobs of a cluster, which print into an output directory.

    `told` is called with the numbers of jobs that wait and run, whenever they change. Scheduler and workers speak TLS
    and accept only a process that has the key of this run. Raises ConnectionError if jobs end again and again before
    their workers come.
    """
    folder = directory / FOLDER
    atomic_file.make_folder(folder)
    name = f"gfmd-{uuid4().hex[:8]}"
    with (
        dask.config.set(_ON_CLUSTER),
        SLURMCluster(
            n_workers=0,
            job_cls=ClosingJob,  # type: ignore[arg-type]  # which names the class so
            security=Security.temporary(),
            shared_temp_directory=str(folder),  # of its key, in files that nobody else can read
            scheduler_options={"dashboard": False, "dashboard_address": "127.0.0.1:0"},
            silence_logs="CRITICAL",
            log_directory=str(folder),
            **_options(cluster, name),
        ) as queue,
        Client(queue, set_as_default=False) as client,
    ):
        supply = queue.adapt(
            Adaptive=JobSupply,
            minimum_jobs=cluster.jobs.min,
            maximum_jobs=cluster.jobs.max,
            interval=_INTERVAL,
            client=client,
            job_name=name,
            cores=cluster.cores,
            told=told,
        )
        try:
            yield client
        except ConnectionError:
            if supply.fault:
                raise ConnectionError(f"{supply.fault}; what they printed is in {folder}") from None
            raise
        finally:
            for name in ("ca_file", "cert", "key"):  # temporary files, gone when they are closed
                getattr(queue, f"_job_{name}").close()


def _options(cluster: Cluster, name: str) -> dict[str, Any]:
    """Options of dask-jobqueue's jobs of a cluster."""
    return {
        "cores": cluster.cores,
        "processes": cluster.cores,
        "memory": f"{int(cluster.memory)}B",
        "walltime": str(ceil(cluster.walltime / 60.0)),  # in minutes
        "queue": cluster.partition,
        "account": cluster.account,
        "job_extra_directives": list(cluster.directives),
        "job_script_prologue": [*(f"export {key}={value}" for key, value in OF_WORKERS.items()), *cluster.setup],
        "python": cluster.python or quote(sys.executable),
        "interface": cluster.interface,
        "job_name": name,
        "worker_extra_args": ["--no-dashboard", "--lifetime", f"{cluster.lifetime}s"],
    }


async def _done(*command: str) -> subprocess.CompletedProcess[str]:
    """Return a command that has ended, in a thread: a pipe of asyncio fails if its event loop is closed before it."""
    return await asyncio.to_thread(subprocess.run, command, capture_output=True, text=True)


class ClosingJob(SLURMJob):
    """A job that says when it is closed. In dask-jobqueue it stays `running`, and the cluster would wait for it."""

    @staticmethod
    async def _call(cmd: list[str], **options: object) -> str:
        done = await _done(*cmd)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(cmd)} ended with {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    async def close(self) -> None:
        """Cancel the job."""
        self.status = Status.closing
        await super().close()  # type: ignore[no-untyped-call]
        self.status = Status.closed


class _Arrivals(SchedulerPlugin):
    """Count of the workers that ever came."""

    def __init__(self) -> None:
        self.count = 0

    def add_worker(self, scheduler: Any, worker: str) -> None:
        """Count a worker that registers with the scheduler."""
        self.count += 1


class JobSupply(Adaptive):
    """Dask's adaptive scaling with demand counted in blocks, which ends idle jobs only and forgets jobs that ended.

    If jobs end again and again before any of their workers comes, `fault` says so and the client's tasks are cancelled.
    `told` is called with the numbers of jobs that wait and run, whenever they change.
    """

    def __init__(
        self, cluster: Any, client: Any, job_name: str, cores: int, told: QueueTold | None, **options: Any
    ) -> None:
        super().__init__(cluster, **options)
        self.fault = ""
        self._queue: Any = cluster
        self._client = client
        self._job_name, self._cores = job_name, cores
        self._looked = monotonic() + _SECONDS_TO_FIRST_LOOK - _SECONDS_BETWEEN_LOOKS
        self._told, self._last = told, QueueState()
        self._arrivals, self._arrived = _Arrivals(), 0
        self._in_vain = 0
        self._queue.scheduler.add_plugin(self._arrivals)

    async def target(self) -> int:
        """Number of workers that tasks can keep busy, in whole jobs."""
        tasks = sum(1 for task in self._queue.scheduler.tasks.values() if task.state in _TO_DO)
        return -(-tasks // self._cores) * self._cores

    async def workers_to_close(self, target: int) -> list[str]:
        """Names of the workers of those surplus jobs that are idle as a whole."""
        workers = defaultdict(list)
        for worker in self._queue.scheduler.workers.values():
            workers[self._job_of(str(worker.name))].append(worker)
        idle = [members for members in workers.values() if not any(worker.processing for worker in members)]
        spare = max(0, len(self.plan) - target) // self._cores
        return [worker.name for members in idle[:spare] for worker in members]

    async def adapt(self) -> None:
        """Forget jobs that ended, then submit what is missing or end what is too much."""
        if monotonic() - self._looked >= _SECONDS_BETWEEN_LOOKS:
            self._looked = monotonic()
            await self._forget_ended_jobs()
        await super().adapt()

    def _job_of(self, worker: str) -> str:
        """Name of a worker's job, which dask-jobqueue gives a suffix for each of several workers."""
        return worker.rpartition("-")[0] if self._cores > 1 else worker

    async def _forget_ended_jobs(self) -> None:
        """Drop jobs that are no longer in the queue: dask-jobqueue would wait for their workers for ever."""
        submitted = dict(self._queue.workers)  # before the queue is asked, so that each had its place there
        queued = await self._queued()
        if queued is None:
            return
        present = {self._job_of(str(worker.name)) for worker in self._queue.scheduler.workers.values()}
        if self._arrivals.count > self._arrived or present:
            self._arrived, self._in_vain = self._arrivals.count, 0
        for name, job in submitted.items():
            if job.job_id in queued or name in present:
                continue
            self._in_vain += 0 if present else 1
            self._queue.worker_spec.pop(name, None)
            if self._queue.workers.pop(name, None) is not None:
                await job.close()
        if self._in_vain >= _MOST_IN_VAIN:
            self.fault = f"{self._in_vain} jobs ended or were refused before any of their workers came"
            tasks: list[Any] = [Future(key, client=self._client) for key in list(self._client.futures)]
            await self._client.cancel(tasks, asynchronous=True, force=True)

    async def _queued(self) -> set[str] | None:
        """Numbers of this run's jobs that wait or run, None if the queue does not say."""
        asked = await _done("squeue", "--noheader", f"--format={FORMAT}", f"--name={self._job_name}")
        if asked.returncode != 0:
            return None
        jobs = columns_of(asked.stdout)
        state = QueueState.of(jobs)
        if state != self._last and self._told is not None:
            self._told(state)
        self._last = state
        return {number for number, *_ in jobs}
