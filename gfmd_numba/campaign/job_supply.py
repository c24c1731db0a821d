"""How many jobs a run has in a queueing system: as many as its blocks can use, and new ones for those that ended."""

import asyncio
from collections import defaultdict
from time import monotonic
from typing import Any

from distributed import Future
from distributed.deploy.adaptive import Adaptive
from distributed.diagnostics.plugin import SchedulerPlugin

from gfmd_numba.campaign.queue_state import FORMAT, QueueState, QueueTold, columns_of

_SECONDS_BETWEEN_LOOKS = 10.0  # at the queue, whose controller others ask, too
_SECONDS_TO_FIRST_LOOK = 3.0
_MOST_IN_VAIN = 5  # jobs that end before a worker comes
_TO_DO = {"queued", "no-worker", "waiting", "processing"}


class _Arrivals(SchedulerPlugin):
    """Count of the workers that ever came."""

    def __init__(self) -> None:
        self.count = 0

    def add_worker(self, scheduler: Any, worker: str) -> None:
        """Count a worker that registers with the scheduler."""
        self.count += 1


class JobSupply(Adaptive):
    """Dask's adaptive scaling with demand counted in blocks, which ends idle jobs only and forgets jobs that ended.

    Where jobs end again and again before a worker of theirs comes, it sets `fault` and cancels the tasks of its client.
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
        """Names of the workers of jobs that are idle as a whole, so many as are too many."""
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
        command = ("squeue", "--noheader", f"--format={FORMAT}", f"--name={self._job_name}")
        process = await asyncio.create_subprocess_exec(
            *command, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.DEVNULL
        )
        printed, _ = await process.communicate()
        if process.returncode != 0:
            return None
        jobs = columns_of(printed.decode())
        state = QueueState.of(jobs)
        if state != self._last and self._told is not None:
            self._told(state)
        self._last = state
        return {number for number, *_ in jobs}
