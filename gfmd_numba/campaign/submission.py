"""Tasks on the workers of a dask cluster: a few in flight, and again what was lost with its worker."""

from collections.abc import Callable, Generator, Iterator
from contextlib import closing
from dataclasses import dataclass, field
from itertools import islice
from math import inf
from pathlib import Path
from time import monotonic
from typing import Any
from uuid import uuid4

from gfmd_numba.campaign import shards
from gfmd_numba.campaign.block_work import Failures, Task, compute, expired_here, perform, too_long, trace, unfinished
from gfmd_numba.campaign.cases import Block
from gfmd_numba.campaign.failures import Failure
from gfmd_numba.campaign.provenance import versions
from gfmd_numba.campaign.watchdog import expired

Told = Callable[[int, Failures], bool]  # told of blocks that ended and how many failed; False: stop

_LOST = "its worker died or froze, even when nothing else was running"
_SECONDS_BETWEEN_COUNTS = 5.0  # of the workers, which may come and go
_NO_SCHEDULER = "the dask scheduler is lost"


@dataclass(frozen=True)
class Submission:
    """Tasks on the workers of a dask client, which store their blocks themselves or hand them back.

    Up to `most` workers are kept busy, or more if there are more.
    """

    client: Any
    directory: Path
    timeout: float | None
    together: int
    finished: Told
    workers_store: bool
    most: int
    run: str = field(default_factory=lambda: uuid4().hex)

    def all(self, tasks: list[Task]) -> None:
        """Perform tasks, a few in flight; the blocks of those that lost their worker then once more, alone.

        A lost worker takes innocent blocks with it: to blame is only a block that was late, or that loses its worker
        again when it runs alone.
        """
        for alone in (False, True):
            suspects: list[Task] = []
            with closing(self._outcomes(tasks, alone)) as outcomes:
                for task, outcome in outcomes:
                    left = [] if outcome is not None else unfinished(task, self.directory)
                    late = self._late(left)
                    failures = outcome or {}
                    for block in left:
                        if block.name in late:
                            failures[block.name] = too_long(self.timeout)
                        elif alone:
                            failures[block.name] = Failure("crashed", _LOST)
                    again = [block for block in left if block.name not in failures]
                    if not self.finished(len(task) - len(again), failures):
                        return
                    suspects += [(block,) for block in again]
            tasks = suspects

    def _late(self, blocks: list[Block]) -> set[str]:
        """Names of those blocks that took longer than the timeout."""
        names = [block.name for block in blocks]
        if self.workers_store:
            return {name for name in names if expired(trace(self.directory, name))}
        if not names or self.timeout is None:
            return set()
        told = self.client.run(expired_here, self.run, names, on_error="ignore")
        return {name for found in told.values() for name in found}

    def _submitted(self, task: Task) -> Any:
        """Future of a task; its key is nobody else's, also on a scheduler that others use."""
        if self.workers_store:
            return self.client.submit(perform, task, self.directory, self.timeout, self.together, pure=False)
        return self.client.submit(compute, task, self.run, versions(), self.timeout, pure=False)

    def _stored(self, result: Any) -> Failures:
        """What failed of a task that ended; what it handed back is then on disk."""
        if self.workers_store:
            failures: Failures = result
            return failures
        measured, failures = result
        names = list(measured)
        for first in range(0, len(names), self.together):
            shards.store(self.directory, {name: measured[name] for name in names[first : first + self.together]})
        return failures

    def _outcomes(self, tasks: list[Task], alone: bool) -> Generator[tuple[Task, Failures | None]]:
        """Each task with its failures as it ends, None if it lost its worker; one at a time if `alone`."""
        from distributed import KilledWorker, as_completed
        from distributed.client import FutureCancelledError

        at_work: dict[str, Task] = {}

        def submitted() -> Iterator[Any]:
            for task in tasks:
                future = self._submitted(task)
                at_work[future.key] = task
                yield future

        wanted, counted = 1, -inf

        def missing() -> int:
            nonlocal wanted, counted
            if not alone and monotonic() - counted > _SECONDS_BETWEEN_COUNTS:
                try:
                    wanted, counted = 2 * max(1, self.most, len(self.client.nthreads())), monotonic()
                except OSError:
                    raise ConnectionError(_NO_SCHEDULER) from None
            return max(0, wanted - len(at_work))

        submissions = submitted()
        futures = as_completed(list(islice(submissions, missing())), loop=self.client.loop)
        for future in futures:
            failures: Failures | None
            try:
                failures = self._stored(future.result())
            except KilledWorker:
                failures = None
            except FutureCancelledError:
                raise ConnectionError(_NO_SCHEDULER) from None
            yield at_work.pop(future.key), failures
            for following in islice(submissions, missing()):
                futures.add(following)
