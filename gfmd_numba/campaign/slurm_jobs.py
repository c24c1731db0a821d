"""SLURM jobs whose end their cluster knows of."""

from dask_jobqueue.slurm import SLURMCluster, SLURMJob
from distributed.core import Status


class ClosingJob(SLURMJob):
    """A job that says that it is closed: dask-jobqueue leaves it running, and a cluster does not close before it is."""

    async def close(self) -> None:
        """Cancel the job."""
        self.status = Status.closing
        await super().close()  # type: ignore[no-untyped-call]
        self.status = Status.closed


class JobsCluster(SLURMCluster):
    """A cluster of such jobs."""

    job_cls = ClosingJob
