"""A campaign from its file to one netCDF file, resumable at any point."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from gfmd_numba.campaign import failures
from gfmd_numba.campaign.cases import Block, split
from gfmd_numba.campaign.collection import collect, note
from gfmd_numba.campaign.execution import Failures, Workers, check, compile_kernels, execute, held, unfinished
from gfmd_numba.campaign.file import Campaign
from gfmd_numba.campaign.output_directory import claimed
from gfmd_numba.campaign.plan import check_memory, plan, tasks
from gfmd_numba.scene.source import Source

_PILOT_SECONDS = 2.0  # of a run, where nothing was planned before

Progress = Callable[[int], None]  # told of blocks that ended
Watch = Callable[[int, int], Progress]  # told of blocks in all and those finished before


class StoppedError(Exception):
    """A run that something from outside stopped; finished work is kept."""


@dataclass(frozen=True)
class Choice:
    """Which blocks to run, and when to stop.

    `only` the cases with these coordinates, at most `limit` blocks, those that failed before if `retry_failed`, and
    nothing more after the first failure if `fail_fast`.
    """

    only: Mapping[str, str] = field(default_factory=dict)
    limit: int | None = None
    retry_failed: bool = False
    fail_fast: bool = False


_TWO_WORKERS, _ALL = Workers(), Choice()


def run(
    source: Source | Campaign,
    output: str | Path | None = None,
    workers: Workers = _TWO_WORKERS,
    watch: Watch | None = None,
    choice: Choice = _ALL,
) -> tuple[Path, Failures]:
    """Run what is unfinished of a campaign and write its netCDF file into the output directory.

    Returns the file and the blocks that failed; raises InputError for a bad campaign, for workers that cannot do it, or
    for a directory that holds something else or another run, StoppedError where the disk or the cluster gives up.
    """
    planned = plan(source)
    cases = planned.only(choice.only) if choice.only else planned.cases
    directory = Path(output if output is not None else planned.campaign.name)
    check(workers, directory)
    failed: Failures = {}
    try:
        with claimed(directory, planned.campaign.name, planned.document.text, planned.document.folder):
            chosen = list(split(cases, held(directory)))
            todo = _todo(chosen, directory, choice)
            progress = watch(len(chosen), len(chosen) - len(todo)) if watch else lambda blocks: None

            def finished(blocks: int, reasons: Failures) -> bool:
                for name, failure in reasons.items():
                    failures.record(directory, name, failure)
                failed.update(reasons)
                progress(blocks)
                return not (failed and choice.fail_fast)

            if todo:
                if workers.address is None:
                    check_memory(todo, workers.count)
                begun = time.perf_counter()
                compile_kernels(planned.problems)
                predicted = planned.predicted_cost(_PILOT_SECONDS)
                note(
                    directory,
                    predicted_cpu_seconds_p50=predicted.quantile(0.5),
                    predicted_cpu_seconds_p90=predicted.quantile(0.9),
                )
                timeout = planned.campaign.case_timeout
                execute(tasks(todo, predicted, workers.count), directory, workers, timeout, finished)
                note(directory, last_run_blocks=len(todo), last_run_seconds=time.perf_counter() - begun)
            results = collect(planned, directory)
    except OSError as error:
        raise StoppedError(f"{error}; finished work is kept, the same command resumes") from error
    earlier = {block.name: failures.of(directory, block.name) for block in chosen}
    return results, {name: failure for name, failure in earlier.items() if failure is not None}


def _todo(chosen: list[Block], directory: Path, choice: Choice) -> list[Block]:
    """Blocks to run: without a shard, and without a known failure unless it is to be tried again."""
    todo = unfinished(chosen, directory)
    if choice.retry_failed:
        for block in todo:
            failures.forget(directory, block.name)
    todo = [block for block in todo if failures.of(directory, block.name) is None]
    return todo[: choice.limit]
