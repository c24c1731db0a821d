"""Workers in jobs of a queueing system: submitted as long as there are blocks, and again when a job has ended."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from shlex import quote
from typing import Any
from uuid import uuid4

import psutil

from gfmd_numba.campaign.cluster import OF_A_RUN, ONE_THREAD
from gfmd_numba.campaign.cluster_file import NO_JOBQUEUE, Cluster
from gfmd_numba.campaign.job_supply import JobSupply
from gfmd_numba.campaign.queue_state import QueueTold
from gfmd_numba.scene import InputError
from gfmd_numba.storage import atomic_file
from gfmd_numba.text.input_error import brief

FOLDER = "jobs"  # in the output directory: what jobs print, and for the time of a run the certificates of its workers
_INTERVAL = "2s"  # between looks at how many jobs are wanted
_KEYS = "tls"  # what the folder of keys and certificates is temporary for, in that folder
_ROLES = ("scheduler", "worker", "client")
_COMMANDS = ("sbatch", "squeue", "scancel")
_ON_CLUSTER = OF_A_RUN | {
    "distributed.scheduler.allowed-failures": 10,  # jobs end when their time is up, and no block is to blame for it
}
_PATIENCE = 120.0  # s, with a controller that is busy
_UNREACHABLE = re.compile(r"configuration source|contact slurm controller", re.IGNORECASE)  # in sbatch's words
_PLAIN = re.compile(r"[A-Za-z0-9._/@+,:~-]+")  # a path that a job's script can hold as it is


def check_queue(cluster: Cluster, directory: Path) -> None:
    """Raise InputError unless jobs of a cluster can be submitted from here, for an output directory."""
    try:
        from dask_jobqueue.slurm import SLURMJob
    except ImportError:
        raise InputError(f"--cluster: {NO_JOBQUEUE}") from None
    for command in _COMMANDS:
        if shutil.which(command) is None:
            raise InputError(
                f"--cluster: this machine has no {command}; gfmd needs a machine that submits jobs to SLURM, as the "
                "login node of a cluster does"
            )
    if not _PLAIN.fullmatch(str(directory.resolve())):
        raise InputError(
            f"--output: you gave {brief(str(directory.resolve()))} with --cluster; gfmd allows a path of letters, "
            "digits and "
            "._/@+,:~- alone, as scripts of jobs name it"
        )
    if cluster.interface not in (None, *(here := psutil.net_if_addrs())):
        raise InputError(f"--cluster: you gave the interface {cluster.interface}; gfmd allows one of {', '.join(here)}")
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
        if _UNREACHABLE.search(said):
            raise InputError(f"--cluster: sbatch reaches no SLURM ({said}); gfmd needs a SLURM that is up")
        raise InputError(
            f"--cluster: you gave jobs that SLURM refuses ({said}); gfmd allows cores, memory, walltime, partition, "
            "account "
            "and directives that `sinfo` and your site's rules permit"
        )


@contextmanager
def jobs(cluster: Cluster, directory: Path, told: QueueTold | None = None) -> Iterator[Any]:
    """Client of the workers in jobs of a cluster, which print into an output directory.

    `told` is called with the numbers of jobs that wait and run, whenever they change.

    Scheduler and workers speak TLS, and accept only who has the key of this run. Raises ConnectionError where jobs end
    again and again before their workers come.
    """
    import dask
    from distributed import Client

    from gfmd_numba.campaign.slurm_jobs import JobsCluster

    folder = directory / FOLDER
    atomic_file.make_folder(folder)
    name = f"gfmd-{uuid4().hex[:8]}"
    with (
        dask.config.set(_ON_CLUSTER),
        _security(folder) as security,
        JobsCluster(
            n_workers=0,
            security=security,
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


@contextmanager
def _security(folder: Path) -> Iterator[Any]:
    """Key and certificate of a run, in files that nobody else can read and that do not outlive it."""
    from distributed.security import Security

    for left in folder.iterdir():
        if atomic_file.is_temporary(left.name) and atomic_file.is_folder(left):  # of a run that was killed
            shutil.rmtree(left, ignore_errors=True)
    private = atomic_file.temporary(folder / _KEYS)
    private.mkdir(mode=0o700)
    try:
        of_role = Security.temporary().get_tls_config_for_role("worker")
        files = {name: private / f"{name}.pem" for name in ("ca_file", "cert", "key")}
        for name, file in files.items():
            with open(file, "x", opener=_for_this_user) as new:  # what is there already may be read by others
                new.write(of_role[name])
        of_all = {f"tls_{role}_{name}": str(files[name]) for role in _ROLES for name in ("cert", "key")}
        yield Security(require_encryption=True, tls_ca_file=str(files["ca_file"]), **of_all)
    finally:
        shutil.rmtree(private, ignore_errors=True)


def _for_this_user(path: str, flags: int) -> int:
    return os.open(path, flags | os.O_EXCL, 0o600)


def _options(cluster: Cluster, name: str) -> dict[str, Any]:
    """Options of dask-jobqueue's jobs of a cluster."""
    return {
        "cores": cluster.cores,
        "processes": cluster.cores,
        "memory": f"{int(cluster.memory)}B",
        "walltime": cluster.slurm_walltime,
        "queue": cluster.partition,
        "account": cluster.account,
        "job_extra_directives": list(cluster.directives),
        "job_script_prologue": [*(f"export {key}={value}" for key, value in ONE_THREAD.items()), *cluster.setup],
        "python": cluster.python or quote(sys.executable),
        "interface": cluster.interface,
        "job_name": name,
        "worker_extra_args": ["--no-dashboard", "--lifetime", f"{cluster.lifetime}s"],
    }
