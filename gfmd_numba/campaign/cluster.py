"""The dask workers of a cluster: that of a scheduler, which is checked first, or jobs of a queueing system.

The cluster file says which jobs do the work.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from ipaddress import ip_address
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, Field, model_validator

from gfmd_numba.campaign.provenance import difference, versions
from gfmd_numba.scene import InputError
from gfmd_numba.scene.document import Source, document_of, validate
from gfmd_numba.scene.quantities import RECORD, broken_rule
from gfmd_numba.scene.units import MEMORY, TIME

_LONGEST_WALLTIME = 365 * 86_400.0  # s
_LONGEST_MARGIN = 120.0  # s
NO_JOBQUEUE = (
    "dask-jobqueue, which submits the jobs, is not installed; install it by `pip install 'gfmd-numba[cluster]'`"
)
_MOST_CORES, _MOST_JOBS = 4096, 100_000
_OF_A_LINE = r"[^\x00-\x08\x0A-\x1F\x7F\x{85}\x{2028}\x{2029}]"  # nothing that ends a line, or that no script can hold


def _text(pattern: str, most: int, allowed: str) -> Any:
    """Constraint on a text, with the words for what it allows."""
    return Field(pattern=pattern, max_length=most, json_schema_extra={"allowed": allowed})


Word = Annotated[
    str,
    _text(
        r"^[A-Za-z0-9._][A-Za-z0-9._:@,+-]*$", 100, "up to 100 letters, digits and '.', '_', ':', '@', ',', '+', '-'"
    ),
]
Directive = Annotated[str, _text(rf"^-{_OF_A_LINE}+$", 1000, "an option of sbatch, like `--constraint=skylake`")]
Line = Annotated[str, _text(rf"^{_OF_A_LINE}+$", 1000, "one line of shell, like module load python")]


class Jobs(BaseModel):
    """How many jobs a run keeps in the queue: as many as have blocks to do, between two bounds."""

    model_config = RECORD
    min: int = Field(0, ge=0, le=_MOST_JOBS, description="Jobs kept as long as the run lasts (dimensionless)")
    max: int = Field(ge=1, le=_MOST_JOBS, description="Jobs at most, waiting or at work (dimensionless)")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.min > self.max:
            raise broken_rule(("min",), f"at most jobs.max, {self.max}")
        return self


class Cluster(BaseModel):
    """Jobs that SLURM starts and ends, each with one worker process a core."""

    model_config = RECORD
    system: Literal["slurm"] = Field("slurm", description="Queueing system that starts the jobs")
    cores: int = Field(ge=1, le=_MOST_CORES, description="Cores of a job, each with one worker (dimensionless)")
    memory: Annotated[float, Field(ge=1e8, le=1e15), MEMORY] = Field(
        description="Memory of a job in bytes, which its workers share"
    )
    walltime: Annotated[float, Field(ge=60.0, le=_LONGEST_WALLTIME), TIME] = Field(
        description="Time in s after which the queueing system ends a job"
    )
    jobs: Jobs = Field(description="How many jobs there may be")
    partition: Word | None = Field(None, description="Partition (queue) of the jobs; None: the default of the system")
    account: Word | None = Field(None, description="Account that the jobs are charged to; None: the default")
    directives: tuple[Directive, ...] = Field(
        (), strict=False, description="More options of sbatch for each job, without `#SBATCH`"
    )
    setup: tuple[Line, ...] = Field((), strict=False, description="Shell lines that a job runs before its workers")
    python: Line | None = Field(
        None, description="Command that starts Python in a job; None: the Python of this process"
    )
    interface: Word | None = Field(
        None, description="Network interface by which workers reach this process; None: that of the default route"
    )

    @property
    def most_workers(self) -> int:
        """Number of workers of all jobs there may be."""
        return self.cores * self.jobs.max

    @property
    def lifetime(self) -> int:
        """Time in s after which a worker ends, so that it does so before the queueing system ends its job."""
        return int(self.walltime - min(_LONGEST_MARGIN, self.walltime / 4))


def load_cluster(source: Source) -> Cluster:
    """Return the checked cluster of a YAML file or a mapping; raises InputError."""
    return validate(document_of(source, "cluster"), Cluster)


@contextmanager
def connected(address: str | None, client: Any, insecure: bool) -> Iterator[Any]:
    """Yield a client of the scheduler at an address, or without an address the given client; raises InputError."""
    if address is None:
        if client.asynchronous or client.status != "running":
            given = "asynchronous" if client.asynchronous else client.status
            raise InputError.of("workers", f"a dask client that is {given}", "a connected, synchronous one")
        yield client
        return
    from distributed import Client
    from distributed.comm.addressing import get_address_host, parse_address, resolve_address

    try:
        resolved = resolve_address(address)  # a client of a malformed address would go on failing in the background
        private = parse_address(resolved)[0] != "tcp" or ip_address(get_address_host(resolved)).is_loopback
        # not the default client, or xarray writes through one that failed
        own = Client(address, timeout=10, set_as_default=False) if private or insecure else None
    except (OSError, ValueError, KeyError) as error:
        allowed = "the address of a running dask scheduler, like tcp://127.0.0.1:8786"
        raise InputError.of("--scheduler", f"{address} ({error})", allowed) from None
    if own is None:
        raise InputError.of(
            "--scheduler",
            f"{address}, on which anyone on the way can read and change the work",
            "a tls:// address, one of this machine, or --insecure with it",
        )
    with own:
        yield own


def check_workers(client: Any, option: str) -> None:
    """Raise InputError unless there are workers, with the same packages as here."""
    if not client.nthreads():
        raise InputError.of(option, "a cluster without workers", "one with `dask worker`s connected to it")
    ours = versions()
    try:
        theirs = client.run(versions)
    except ImportError as error:
        raise InputError.of(option, f"workers without gfmd-numba ({error})", "the same installation as here") from None
    for worker, installed in theirs.items():
        if wrong := difference(installed, ours):
            raise InputError(f"{option}: you gave {worker} with {wrong}")
