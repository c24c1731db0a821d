"""A campaign from its file to one netCDF file, resumable at any point.

With a goal it runs until its limit is known to a relative error: a pilot, then rounds decided by the results.
"""

import time
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import xarray as xr

from gfmd_numba.analysis import fit_tfc
from gfmd_numba.analysis.selection import steps_of
from gfmd_numba.campaign import failures, rounds, shards
from gfmd_numba.campaign.cases import Block, groups
from gfmd_numba.campaign.collection import NOTES, collect, described, note, results_path
from gfmd_numba.campaign.coordinates import meeting
from gfmd_numba.campaign.execution import Failures, compile_kernels, execute, unfinished
from gfmd_numba.campaign.file import Campaign
from gfmd_numba.campaign.goal import Goal
from gfmd_numba.campaign.next_round import REACHED, Known, after
from gfmd_numba.campaign.output_directory import claimed
from gfmd_numba.campaign.plan import Plan, check_memory, check_memory_of_jobs, plan, tasks
from gfmd_numba.campaign.results import read_results
from gfmd_numba.campaign.rounds import Round, Rounds, in_round, levels_of, with_realisations
from gfmd_numba.campaign.status import finished, seconds_per_price
from gfmd_numba.campaign.workers import Workers, begin_loading, check, started
from gfmd_numba.scene import InputError
from gfmd_numba.scene.document import Source
from gfmd_numba.storage import mark
from gfmd_numba.storage.atomic_file import check as check_file

_KEPT = "finished work is kept, the same command resumes"
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
    begin_loading(workers)
    planned = plan(source)
    cases = meeting(planned.cases, choice.only) if choice.only else planned.cases
    directory = Path(planned.campaign.name if output is None else output)
    check(workers, directory)
    with _at_work(planned, directory):
        rounds.forget(directory)
        chosen = replace(planned, cases=cases).blocks_in(directory)
        left = unfinished(chosen, directory)
        progress = watch(len(chosen), len(chosen) - len(left)) if watch else None
        todo = to_do(left, directory, choice)
        check_room(todo, workers)
        finish(planned, todo, directory, workers, progress, choice)
        return collect(planned, directory), failures.of_all(directory, [block.name for block in chosen])


@contextmanager
def _at_work(planned: Plan, directory: Path) -> Iterator[None]:
    """Hold the output directory of a campaign for a run; raises StoppedError if the disk or the cluster gives up."""
    document = planned.document
    try:
        with claimed(directory, planned.campaign.name, document.text, document.folder):
            yield
    except OSError as error:
        raise StoppedError(f"{error}; {_KEPT}") from error
    except KeyboardInterrupt as interrupt:
        if any(True for _ in shards.Finished(directory)):
            interrupt.args = (_KEPT,)  # which the command line tells
        raise


def finish(
    planned: Plan, todo: list[Block], directory: Path, workers: Workers, progress: Progress | None, choice: Choice
) -> bool:
    """Perform blocks in a directory that is claimed, and record what fails; False if a failure stopped them.

    Raises InputError if a file of somebody else is in the way, OSError if the disk or the cluster gives up.
    """
    check_file(results_path(planned, directory), mark.is_product)
    check_file(directory / NOTES, mark.is_note)
    if not todo:
        return True
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
    """Raise InputError unless the memory of workers is large enough for blocks, if there are any."""
    if todo and workers.cluster is not None:
        check_memory_of_jobs(todo, workers.cluster)
    elif todo and not workers.elsewhere:
        check_memory(todo, workers.count)


def to_do(left: list[Block], directory: Path, choice: Choice) -> list[Block]:
    """Return the blocks to run of those without a shard: all but failed ones, unless these are to be tried again."""
    if choice.retry_failed:
        for block in left:
            failures.forget(directory, block.name)
    return [block for block in left if failures.of(directory, block.name) is None][: choice.limit]


Fits = Mapping[str, xr.Dataset]  # by variable
Told = Callable[[Rounds, Plan, int], None]  # of a round that begins, its plan, and how many simulations it has left


@dataclass(frozen=True)
class Outcome:
    """The outcome of a run: its file, what failed, the rounds, and the fit of each target to all of these results.

    There are no fits if the run stopped before the results were fitted.
    """

    results: Path
    failures: Failures
    rounds: Rounds
    fits: Fits = field(default_factory=dict)

    @property
    def reached(self) -> bool:
        """Whether every group has the error that was asked for."""
        return self.rounds.ended == REACHED


class InterruptedRunError(KeyboardInterrupt):
    """Ctrl-C, after which the finished work has been collected."""

    def __init__(self, outcome: Outcome) -> None:
        super().__init__()
        self.outcome = outcome


def run_until(
    source: Source | Campaign,
    goal: Goal,
    output: str | Path | None = None,
    workers: Workers = TWO_WORKERS,
    watch: Watch | None = None,
    choice: Choice = ALL,
    told: Told | None = None,
) -> Outcome:
    """Run a campaign round after round until its limit has a relative error, with as many realisations as needed.

    Raises as `run` does; also InputError for a campaign without limits or a budget that its pilot exceeds, and
    InterruptedRunError for Ctrl-C after the contacts of the pilot.
    """
    run = _prepared(source, goal, output, workers, watch=watch, choice=choice, told=told)
    with _at_work(run.planned, run.directory):
        return run.all_rounds()


def each_round(
    source: Source | Campaign, goal: Goal, output: str | Path | None = None, workers: Workers = TWO_WORKERS
) -> Generator[Outcome, None, None]:
    """Run a campaign as `run_until` does, and yield the outcome after each round, before the next one begins.

    If you take no more rounds, the run stops there, and a later one goes on from it. Raises as `run_until` does.
    """
    return _prepared(source, goal, output, workers).each_round()


def first_decision(
    source: Source, goal: Goal, workers: Workers, watch: Watch | None = None, told: Told | None = None
) -> tuple[Rounds, Plan, Failures]:
    """Run the pilot of a campaign, as `run_until` does, and return what it would do next; no file is left.

    The rounds are returned, the last of which has not run unless they ended, its plan, and what failed. Raises as
    `run_until` does. If the disk or the cluster gives up it raises OSError, because nothing is kept.
    """
    with TemporaryDirectory(prefix="gfmd-") as folder:
        run = _prepared(source, goal, folder, workers, watch=watch, told=told)
        document = run.planned.document
        owned = claimed(run.directory, run.planned.campaign.name, document.text, document.folder)
        with owned, closing(run.states()) as states:
            next(states)
            state, _ = next(states)
        return state, in_round(run.planned, state.now), run.failed(run.planned)


def _prepared(
    source: Source | Campaign, goal: Goal, output: str | Path | None, workers: Workers, **others: Any
) -> "_Run":
    """Return a run with `others` of its fields; raises InputError for a goal, a budget or workers that cannot be."""
    begin_loading(workers)
    planned = rounds.pilot_plan(plan(source, goal.targets), goal)
    directory = Path(planned.campaign.name if output is None else output)
    if all(case.limit == "reference" for case in planned.cases):
        raise InputError.of("until", "a campaign without a limit", "one with levels under `limits`")
    if goal.budget is not None and rounds.read(directory) is None:
        pilot = planned.predicted_cost(_PILOT_SECONDS).quantile(0.5)
        number = min(case.realisations for case in planned.cases)
        if pilot > goal.budget:
            raise InputError.of(
                "budget",
                f"{goal.budget:.3g} s of processor time, where the pilot of {number} realisations of the finest level, "
                f"and more of the others, takes about {pilot:.3g} s",
                "more, or a campaign with fewer or coarser levels",
            )
    check(workers, directory)
    return _Run(planned, goal, directory, workers, **others)


@dataclass(frozen=True)
class _Run:
    """A run with a goal in a directory, whose rounds run once that is claimed; its plan is that of the pilot."""

    planned: Plan
    goal: Goal
    directory: Path
    workers: Workers
    watch: Watch | None = None
    choice: Choice = ALL
    told: Told | None = None

    def all_rounds(self) -> Outcome:
        """Run rounds until they end."""
        states = self.states()
        latest = next(states)
        try:
            for following in states:
                latest = following
            return self.collected(*latest)
        except KeyboardInterrupt:
            state, _ = latest
            now = in_round(self.planned, state.now)
            earlier: dict[Any, int] = {}
            for last in state.rounds[-2:-1]:
                earlier = dict(zip(last.cases, last.realisations, strict=True))
            counts = finished(now, self.directory, [earlier.get(case, 0) for case in state.now.cases])
            if not earlier and counts != [case.realisations for case in now.cases]:
                raise  # in the pilot: there is nothing to extrapolate from
            partial: Plan | None = with_realisations(now, counts)
            if min(counts) < 1:  # a new level has no results yet
                state, partial = state.without_last(), None
            interrupted = state.ending(f"not {REACHED}: the run was interrupted")
            raise InterruptedRunError(self.collected(interrupted, {}, partial)) from None

    def each_round(self) -> Generator[Outcome, None, None]:
        """Run rounds until they end, and yield the outcome of each."""
        with _at_work(self.planned, self.directory), closing(self.states()) as states:
            next(states)
            for state, fits in states:
                if not state.ended:  # its last round has not run
                    done = state.without_last()
                    state = done.ending(f"not {REACHED}: the run stopped before its next round")
                yield self.collected(state, fits)

    def states(self) -> Generator[tuple[Rounds, Fits], None, None]:
        """Run round after round. Yield the rounds with each new one before it runs, and all of them at the end.

        With them go the fits of the targets to all results so far. Raises InputError for a pilot that does not fit the
        memory.
        """
        state, choice, workers = _begun(self.planned, self.goal, self.directory), self.choice, self.workers
        fits: Fits = {}
        with ExitStack() as stack:
            while not state.ended:
                planned = in_round(self.planned, state.now)
                blocks = planned.blocks_in(self.directory)
                todo = to_do(unfinished(blocks, self.directory), self.directory, choice)
                try:
                    check_room(todo, self.workers)
                except InputError as error:
                    if len(state.rounds) == 1:
                        raise
                    told = f"not {REACHED}: finer levels do not fit the memory ({error})"
                    state = state.without_last().ending(told)
                    break
                yield state, fits
                rounds.write(self.directory, state)  # what is decided stands before it is done
                if todo:
                    workers = stack.enter_context(started(workers, self.directory))
                if self.told is not None:
                    self.told(state, planned, sum(block.size for block in todo))
                progress = self.watch(len(blocks), len(blocks) - len(todo)) if self.watch else None
                if finish(planned, todo, self.directory, workers, progress, choice):
                    state, fits = self._judged(state, planned)
                else:
                    fits = {}
                    state = state.ending(f"not {REACHED}: the run stopped at the first failure")
                choice = replace(choice, retry_failed=False)  # once is enough
        yield state, fits

    def _judged(self, state: Rounds, planned: Plan) -> tuple[Rounds, Fits]:
        """Return the rounds with what the last one has found, and with one more or ended, and the fits that tell it."""
        if state.seconds_per_price is None:
            state = state.model_copy(update={"seconds_per_price": seconds_per_price(planned, self.directory)})
        results = read_results(collect(planned, self.directory))
        of_variable = {fit.variable: fit for fit, _ in planned.campaign.fits()}
        fits = []
        for variable in self.goal.targets:
            fit = of_variable[variable]
            judged = results if fit.step is None else steps_of(results, variable, fit.step)[0]
            fits.append(Known(judged, fit_tfc(results, **fit.options), variable, fit.options["fixed"]))
        may_refine = planned.campaign.levels != "only" and bool(state.now.levels)
        return after(state, fits, may_refine), {known.variable: known.fitted for known in fits}

    def failed(self, planned: Plan) -> Failures:
        """Return which blocks of a round have failed."""
        return failures.of_all(self.directory, [block.name for block in planned.blocks_in(self.directory)])

    def collected(self, state: Rounds, fits: Fits, planned: Plan | None = None) -> Outcome:
        """Collect the results of the last round, or of what a plan has of it."""
        planned = planned or in_round(self.planned, state.now)
        rounds.write(self.directory, state)
        results = collect(planned, self.directory)
        return Outcome(results, self.failed(planned), state, fits)


def _begun(planned: Plan, goal: Goal, directory: Path) -> Rounds:
    """Return the rounds of an earlier run with the same goal, which go on; else those of a new run, its pilot."""
    campaign = described(planned)["campaign_sha256"]
    found = rounds.read(directory)
    same = found is not None and (found.goal, found.campaign_sha256) == (goal, campaign)
    if found is not None and same and found.of(groups(planned.cases)):
        return found.ending("")
    counts = tuple(case.realisations for case in planned.cases)
    first = Round(realisations=counts, levels=levels_of(planned), is_last=False)
    return Rounds(goal=goal, campaign_sha256=campaign, rounds=(first,))
