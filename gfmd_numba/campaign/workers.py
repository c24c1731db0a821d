"""Who does the work of a run: this process, local dask workers, or a dask cluster."""

import os
import signal
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from multiprocessing import forkserver, resource_tracker
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gfmd_numba.campaign import cluster
from gfmd_numba.campaign.cluster import Cluster
from gfmd_numba.scene import InputError
from gfmd_numba.storage import cache
from gfmd_numba.text.input_error import brief

if TYPE_CHECKING:
    from gfmd_numba.campaign.job_queue import QueueTold

_LONGEST_START = "1h"  # of a worker in place of another that died, on a machine with much else to do
OF_WORKERS = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1") | {
    # bytes of freed memory that the C library keeps: dask's 64 KiB would make nearly every array of new pages
    "MALLOC_TRIM_THRESHOLD_": str(2**30),
    "MALLOC_MMAP_THRESHOLD_": str(2**25),  # the most that glibc allows
}
OF_A_RUN = {
    "distributed.scheduler.allowed-failures": 0,  # who died with its worker is told at once
    # a worker that says nothing is replaced; kernels and transforms let it speak, so that only a frozen one is silent
    "distributed.scheduler.worker-ttl": os.environ.get("DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL", "2 minutes"),
    # the web servers of scheduler and workers cannot be switched off, but they need not say anything
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    "distributed.worker.profile.enabled": False,  # of which nobody sees anything, a hundred times a second
}


@dataclass(frozen=True)
class Workers:
    """Who does the work: `count` local dask workers (0: this process), or a dask cluster.

    The cluster is that of a scheduler at `address`, of a dask `client`, or of the jobs that a `cluster` file describes.
    A scheduler on another machine must use TLS, unless `insecure` allows it not to. `queue_told` is called with the
    state of the jobs in the queue.
    """

    count: int = 2
    address: str | None = None
    insecure: bool = False
    client: Any = None
    cluster: Cluster | None = None
    queue_told: "QueueTold | None" = None

    @property
    def in_this_process(self) -> bool:
        """Whether this process does all the work."""
        return self.count == 0 and not self.elsewhere

    @property
    def elsewhere(self) -> bool:
        """Whether the work is done by a dask cluster that this run did not start on this machine."""
        return not (self.address is None and self.client is None and self.cluster is None)

    @property
    def most(self) -> int:
        """Number of workers to divide the work for."""
        return self.count if self.cluster is None else self.cluster.most_workers


def workers_of(given: object) -> Workers:
    """Return the workers meant by a number, a dask client, or a cluster file or its content; raises InputError."""
    if isinstance(given, Integral) and not isinstance(given, bool) and int(given) >= 0:
        return Workers(int(given))
    distributed = sys.modules.get("distributed")  # without it nobody has a client
    if distributed is not None and isinstance(given, distributed.Client):
        return Workers(client=given)
    if isinstance(given, str | Path | Mapping) and not str(given).isdecimal():
        return Workers(cluster=cluster.load_cluster(given))
    raise InputError.of(
        "workers", brief(given), "a number of processes from 0, a dask.distributed.Client, or a cluster file"
    )


def check(workers: Workers, directory: Path) -> None:
    """Raise InputError unless workers can do their work for an output directory, which need not exist yet."""
    if workers.cluster is not None:
        try:
            from gfmd_numba.campaign.job_queue import check_queue
        except ImportError:
            raise InputError(f"--cluster: {cluster.NO_JOBQUEUE}") from None
        check_queue(workers.cluster, directory)
    elif workers.elsewhere:
        with cluster.connected(workers.address, workers.client, workers.insecure) as client:
            cluster.check_workers(client, "workers" if workers.address is None else "--scheduler")


def begin_loading(workers: Workers) -> None:
    """Have local workers load what they need, if there are any, while this process does something else."""
    if not workers.in_this_process and not workers.elsewhere:
        _start_method()


def _start_method() -> str:
    """Return how local workers start: as copies of a process that has loaded what they need, or each on its own.

    That process is started unless it runs. Elsewhere than on Linux, libraries of the system do not survive in a copy.
    """
    os.environ.update(OF_WORKERS)  # inherited: two workers never compete for a core
    cache.directory()  # inherited, too, if it is a temporary one
    if sys.platform != "linux":
        return "spawn"
    try:
        with _imports_as_here(), _interrupts(False):
            forkserver.set_forkserver_preload(["distributed.nanny", "gfmd_numba.campaign.execution"])
            forkserver.ensure_running()
    except OSError:  # there is no socket, as in a temporary folder with a long name
        return "spawn"
    return "forkserver"


@contextmanager
def started(workers: Workers, directory: Path) -> Iterator[Workers]:
    """Yield the workers with a client for as long as they are needed: start them, or connect to a cluster."""
    if workers.client is not None or workers.in_this_process:
        yield workers
        return
    if workers.cluster is not None:
        from gfmd_numba.campaign.job_queue import jobs

        begun = jobs(workers.cluster, directory.resolve(), workers.queue_told)
    elif workers.address is not None:
        begun = cluster.connected(workers.address, None, workers.insecure)
    else:
        begun = local(workers.count)
    with begun as client:
        yield replace(workers, client=client)


@contextmanager
def local(count: int) -> Iterator[Any]:
    """Yield a client of `count` local workers of one thread each.

    Scheduler and workers listen on loopback, where every user of the machine can connect. They accept only a process
    that has the TLS key of this run, and the key never leaves the memory of these processes.
    """
    import dask
    from distributed import Client, LocalCluster
    from distributed.security import Security

    of_local = {
        "distributed.worker.multiprocessing-method": _start_method(),
        # one that takes longer to start again would be given up for good: by default after 15 s
        "distributed.deploy.lost-worker-timeout": _LONGEST_START,
    }
    with (
        dask.config.set(OF_A_RUN | of_local),
        _interrupts(False),  # inherited: Ctrl-C reaches every process, but only this one acts on it
        LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            host="127.0.0.1",
            security=Security.temporary(),
            scheduler_kwargs={"dashboard": False},
            dashboard_address="127.0.0.1:0",  # any free port: None means 8787, which another run may hold
            silence_logs="CRITICAL",
        ) as cluster,
        Client(cluster) as client,
        _interrupts(True),
    ):
        yield client


@contextmanager
def _imports_as_here() -> Iterator[None]:
    """Have processes begun inside import from where this one does, and not from the working directory."""
    here = {"PYTHONPATH": os.pathsep.join(sys.path), "PYTHONSAFEPATH": "1"}
    before = {name: os.environ.get(name) for name in here}
    os.environ.update(here)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


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
