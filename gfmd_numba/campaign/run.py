"""A campaign from its file to one netCDF file, resumable at any point."""

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from gfmd_numba.campaign import failures, rounds, shards
from gfmd_numba.campaign.block_work import Failures, unfinished
from gfmd_numba.campaign.cases import Block
from gfmd_numba.campaign.collection import NOTES, collect, note, results_path
from gfmd_numba.campaign.execution import Workers, check, compile_kernels, execute
from gfmd_numba.campaign.file import Campaign
from gfmd_numba.campaign.output_directory import claimed
from gfmd_numba.campaign.plan import Plan, check_memory, check_memory_of_jobs, plan, tasks
from gfmd_numba.scene.document import Source
from gfmd_numba.storage import mark
from gfmd_numba.storage.atomic_file import check as check_file

_PILOT_SECONDS = 2.0  # of a run, where nothing was planned before

Progress = Callable[[int], None]  # told of blocks that ended
Watch = Callable[[int, int], Progress]  # told of blocks in all and those finished before


class StoppedError(Exception):
    """The disk or the cluster stopped a run; finished work is kept."""


@dataclass(frozen=True)
class Choice:
    """Which blocks to run, and when to stop.

    `only` gives coordinates of the cases, `limit` the most blocks. `retry_failed` runs blocks again that failed before,
    and `fail_fast` stops after the first failure.
    """

    only: Mapping[str, str] = field(default_factory=dict)
    limit: int | None = None
    retry_failed: bool = False
    fail_fast: bool = False


TWO_WORKERS, ALL = Workers(), Choice()


def run(
    source: Source | Campaign,
    output: str | Path | None = None,
    workers: Workers = TWO_WORKERS,
    watch: Watch | None = None,
    choice: Choice = ALL,
) -> tuple[Path, Failures]:
    """Run what is unfinished of a campaign and write its netCDF file into the output directory.

    Returns the file and the blocks that failed. Raises InputError for a bad campaign, for workers that cannot do it, or
    for a directory that holds something else or another run, and StoppedError if the disk or the cluster gives up.
    """
    planned = plan(source)
    cases = planned.only(choice.only) if choice.only else planned.cases
    directory = directory_of(planned, output)
    check(workers, directory)
    with (
        stopped_by_errors_of_the_system(),
        claimed(directory, planned.campaign.name, planned.document.text, planned.document.folder),
    ):
        rounds.forget(directory)
        chosen = replace(planned, cases=cases).blocks_in(directory)
        left = unfinished(chosen, directory)
        progress = watch(len(chosen), len(chosen) - len(left)) if watch else None
        finish(planned, to_do(left, directory, choice), directory, workers, progress, choice)
        return collect(planned, directory), failures.of_all(directory, [block.name for block in chosen])


def directory_of(planned: Plan, output: str | Path | None) -> Path:
    """Return the output directory of a campaign: the one that is given, or one of its name."""
    return Path(output if output is not None else planned.campaign.name)


@contextmanager
def stopped_by_errors_of_the_system() -> Iterator[None]:
    """Raise StoppedError if the disk or the cluster gives up."""
    try:
        yield
    except OSError as error:
        raise StoppedError(f"{error}; finished work is kept, the same command resumes") from error


def finish(
    planned: Plan, todo: list[Block], directory: Path, workers: Workers, progress: Progress | None, choice: Choice
) -> bool:
    """Perform blocks in a directory that is claimed, and record what fails; False if a failure stopped them.

    Raises InputError if the memory is too small, OSError if the disk or the cluster gives up.
    """
    _check_names(planned, todo, directory)
    if not todo:
        return True
    check_room(todo, workers)
    begun = time.perf_counter()
    compile_kernels(planned.problems)
    predicted = planned.predicted_cost(_PILOT_SECONDS)
    note(
        directory,
        predicted_cpu_seconds_p50=predicted.quantile(0.5),
        predicted_cpu_seconds_p90=predicted.quantile(0.9),
    )
    timeout, well = planned.campaign.case_timeout, True
    with closing(execute(tasks(todo, predicted, workers.most), directory, workers, timeout)) as ended:
        for blocks, reasons in ended:
            for name, failure in reasons.items():
                failures.record(directory, name, failure)
            if progress is not None:
                progress(blocks)
            well = well and not reasons
            if choice.fail_fast and not well:
                break
    note(directory, last_run_blocks=len(todo), last_run_seconds=time.perf_counter() - begun)
    return well or not choice.fail_fast


def check_room(todo: list[Block], workers: Workers) -> None:
    """Raise InputError unless the memory of workers is large enough for blocks."""
    if workers.cluster is not None:
        check_memory_of_jobs(todo, workers.cluster)
    elif not workers.elsewhere:
        check_memory(todo, workers.count)


def _check_names(planned: Plan, todo: list[Block], directory: Path) -> None:
    """Raise InputError if somebody else's file has the name of a file that a run is going to write."""
    check_file(results_path(planned, directory), mark.is_product)
    for note_of_run in (directory / NOTES, *(failures.path_of(directory, block.name) for block in todo)):
        check_file(note_of_run, mark.is_note)
    shards.check_names(directory, [block.name for block in todo])


def to_do(left: list[Block], directory: Path, choice: Choice) -> list[Block]:
    """Return the blocks to run of those without a shard: all but failed ones, unless these are to be tried again."""
    if choice.retry_failed:
        for block in left:
            failures.forget(directory, block.name)
    return [block for block in left if failures.of(directory, block.name) is None][: choice.limit]
