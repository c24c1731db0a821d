"""The dask workers of a run: local processes, or an existing cluster that has to be fit for it."""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from ipaddress import ip_address
from multiprocessing import resource_tracker
from pathlib import Path
from typing import Any
from uuid import uuid4

from gfmd_numba.campaign.provenance import versions
from gfmd_numba.scene import InputError

_THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")


@contextmanager
def connected(count: int, address: str | None, insecure: bool, directory: Path) -> Iterator[Any]:
    """Client of `count` local workers, or of the scheduler at an address; raises InputError."""
    if address is None:
        with _local(count) as client:
            yield client
        return
    with _existing(address, insecure) as client:
        _check_workers(client, directory)
        yield client


@contextmanager
def _local(count: int) -> Iterator[Any]:
    import dask
    from distributed import Client, LocalCluster

    os.environ.update(dict.fromkeys(_THREADS, "1"))  # inherited: two workers never compete for a core
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),  # who died with its worker is told at once
        _interrupts(False),  # inherited, too: Ctrl-C reaches every process, but only this one acts on it
        LocalCluster(
            n_workers=count,
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
def _existing(address: str, insecure: bool) -> Iterator[Any]:
    from distributed import Client
    from distributed.comm.addressing import get_address_host, parse_address, resolve_address

    try:
        resolved = resolve_address(address)  # a client of a malformed address would go on failing in the background
        private = parse_address(resolved)[0] != "tcp" or ip_address(get_address_host(resolved)).is_loopback
        if not (private or insecure):
            raise InputError(
                f"--scheduler: given {address}, on which anyone on the way can read and change the work; "
                "allowed: a tls:// address, one of this machine, or --insecure beside it"
            )
        client = Client(address, timeout=10, set_as_default=False)  # or xarray writes through one that failed
    except (OSError, ValueError, KeyError) as error:
        raise InputError(
            f"--scheduler: given {address} ({error}); "
            "allowed: the address of a running dask scheduler, like tcp://127.0.0.1:8786"
        ) from None
    with client:
        yield client


def _check_workers(client: Any, directory: Path) -> None:
    """Raise InputError unless there are workers, with the same packages, that see the output directory."""
    if not client.scheduler_info()["workers"]:
        raise InputError("--scheduler: given one without workers; allowed: one with `dask worker`s connected to it")
    ours = versions()
    try:
        theirs = client.run(versions)
    except ImportError as error:
        raise InputError(
            f"--scheduler: given workers without gfmd-numba ({error}); allowed: the same installation as here"
        ) from None
    for worker, installed in theirs.items():
        for name, here in ours.items():
            if installed.get(name) != here:
                raise InputError(
                    f"--scheduler: given {worker} with {name} {installed.get(name)}; allowed: {here}, as here"
                )
    token = directory / f".{uuid4().hex}.tmp"
    token.touch()
    try:
        seeing = client.run(os.path.exists, str(token.resolve()))
    finally:
        token.unlink()
    for worker, sees in seeing.items():
        if not sees:
            raise InputError(
                f"--scheduler: given {worker}, which does not see {directory.resolve()}; "
                "allowed: an --output that all workers share under the same path"
            )


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
