"""Commands on a campaign: run it, also round by round, see how far it is, and whether its files are sound."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gfmd_numba.cli import arguments
from gfmd_numba.cli.group import SOME_FAILED, main
from gfmd_numba.cli.outputs import pictures, say_written, write_picture
from gfmd_numba.cli.tables import duration, endings, fit_options, has_limits, of_results
from gfmd_numba.cli.terminal import progress_bar, say, say_command, say_doubts, show_queue, tell, waiting, warn
from gfmd_numba.text.printable import printable, word

if TYPE_CHECKING:
    import xarray as xr

    from gfmd_numba.campaign.execution import Failures
    from gfmd_numba.campaign.goal import Goal
    from gfmd_numba.campaign.plan import Plan
    from gfmd_numba.campaign.rounds import Round, Rounds
    from gfmd_numba.campaign.run import Told, Watch
    from gfmd_numba.campaign.workers import Workers


@main.command()
@arguments.file_argument
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Output directory [the name of the campaign]")
@arguments.workers_option("Number of local worker processes; 0 works in this process")
@click.option("--scheduler", metavar="ADDRESS", help="Use the dask scheduler at this address")
@click.option("--insecure", is_flag=True, help="Allow a scheduler on another machine without TLS")
@click.option(
    "--cluster",
    type=arguments.NEW_FILE,
    metavar="CLUSTER.yaml",
    help="Have jobs of a queueing system do the work, as this file describes them",
)
@arguments.conditions_option
@click.option("--limit", type=click.IntRange(1), metavar="N", help="Stop after N blocks of realisations")
@click.option("--retry-failed", is_flag=True, help="Run blocks again that crashed or timed out before")
@click.option("--fail-fast", is_flag=True, help="Stop at the first block that fails")
@arguments.targets_option(
    "--until",
    "Run until the limit has this error; may be given for several variables. gfmd chooses the numbers of "
    "realisations; those in FILE are not used",
)
@arguments.budget_option
def run(file: Path, output: Path | None, until: dict[str, Any], budget: str | None, **options: Any) -> None:
    """Run or resume the campaign in FILE and fit its results.

    If a run was interrupted, the same command resumes it and repeats no finished work.

    With --until, or with a target and no realisations in FILE, the campaign runs in rounds. The first round is a pilot.
    Each later round has finer levels, or more realisations, as the results so far ask for. The run ends when the fit
    says that the limit has the error you want.
    """
    from gfmd_numba.campaign.file import load_campaign, replaced, target_of_run
    from gfmd_numba.campaign.workers import begin_loading

    who = _workers(options)
    until = until or target_of_run(file) or {}
    _check_options(until, budget, options)
    goal = goal_in(file, until, budget, "--until") if until else None
    of_goal = None if goal is None else goal.targets
    campaign, _ = load_campaign(file, of_goal)
    begin_loading(who)  # while this process loads what it needs itself

    from gfmd_numba.campaign.run import Choice, InterruptedRunError, StoppedError, run_until
    from gfmd_numba.campaign.run import run as run_campaign

    choice = Choice(dict(options["only"]), *(options[name] for name in ("limit", "retry_failed", "fail_fast")))
    if note := replaced(output or Path(campaign.name), campaign, of_goal):
        say("note", printable(note))
    try:
        if goal is not None:
            with rounds_shown("--until") as (watched, told):
                outcome = run_until(file, goal, output, who, watched, choice, told)
            reached = show_results(outcome.results, outcome.failures, outcome.fits) and outcome.reached
        else:
            with progress_bar() as watch:
                results, failures = run_campaign(file, output, who, watch, choice)
            reached = show_results(results, failures, of_some=bool(choice.only))
    except InterruptedRunError as interrupted:  # the best estimate is shown first
        show_results(interrupted.outcome.results, interrupted.outcome.failures)
        raise
    except StoppedError as error:
        warn(str(error))
        reached = False
    if not reached:
        sys.exit(SOME_FAILED)


def _workers(options: dict[str, Any]) -> Workers:
    """Return the workers that the options name; raises a usage error for workers of two kinds."""
    from gfmd_numba.campaign.cluster import load_cluster
    from gfmd_numba.campaign.workers import Workers

    given = [name for name in ("workers", "scheduler", "cluster") if arguments.is_given(name)]
    if len(given) > 1:
        raise click.UsageError(
            f"--{given[1]}: you gave --{given[0]} as well; gfmd allows one of them, as it says who works"
        )
    if options["insecure"] and "scheduler" not in given:
        raise click.UsageError(
            "--insecure: you gave no --scheduler, and --insecure is about its address; give both, or none"
        )
    jobs = None if options["cluster"] is None else load_cluster(options["cluster"])
    local, address, insecure = (options[name] for name in ("workers", "scheduler", "insecure"))
    return Workers(local, address, insecure, cluster=jobs, queue_told=show_queue)


def show_results(
    results: Path, failures: Failures, fits: Mapping[str, xr.Dataset] | None = None, *, of_some: bool = False
) -> bool:
    """Print and draw the results of a run, `of_some` cases alone; return False if some are not ok, or undrawn.

    They are fitted unless `fits` holds the fit of their variable.
    """
    import gfmd_numba

    say_written("results", results)
    dataset = gfmd_numba.open_campaign(results)
    say_doubts(dataset)
    counts = {ending: int(which.sum()) for ending, which, _ in endings(dataset["status"])}
    to_do, asked = counts.get("unfinished", 0), dataset["status"].size - counts.pop("not_asked", 0)
    not_ok = sum(counts.values()) - to_do
    drawn = True
    if to_do:
        rest = "a run without --only takes the other cases" if of_some else "the same command resumes"
        of_all = f"{to_do} of the {asked} simulations of the whole campaign"
        say("note", f"{of_all} have not run yet: {rest}")
    elif has_limits(dataset):
        options = fit_options(dataset)
        fitted = (fits or {}).get(options["variable"])
        if fitted is None:
            from gfmd_numba.analysis import fit_tfc

            with waiting("fitting"):
                fitted = fit_tfc(dataset, **options)
        tell(of_results(dataset, fitted))
        drawn = _draw(dataset, fitted, results.with_suffix(".png"))
    else:
        tell(of_results(dataset, None))
    for block, failure in failures.items():
        warn(f"block {block} {failure.status}: {failure.reason}")
    for ending, which, sentence in endings(dataset["status"]):
        ended = dataset["n_iterations"].where(which)
        if ended.max() > 0:  # what has not run has no iterations
            first = f"the first after {int(ended.min())} iterations"
            warn(f"{int(ended.count())} ended as {ending}, {first}. {sentence}")
    if not_ok:
        warn(
            f"{not_ok} of {asked} simulations are not ok, see `status` in the file; "
            f"`gfmd status {word(results.parent)}` says how to run crashed ones again"
        )
    return drawn and not not_ok


def _draw(dataset: xr.Dataset, fitted: xr.Dataset, picture: Path) -> bool:
    """Draw the fit of a finished run, but not over somebody else's file; return False if the disk refuses it."""
    from gfmd_numba.storage.atomic_file import foreign

    try:
        for path, drawing in pictures(dataset, fitted, picture).items():
            if clause := foreign(path):
                click.echo(f"note     {path}, {clause}, stays as it is (`gfmd plot -o` draws elsewhere)")
            else:
                write_picture(path, drawing)
    except OSError as error:
        draws = f"`gfmd plot {word(picture.parent)}` draws them"
        click.echo(f"gfmd: {printable(error)}; the results are complete, and {draws}", err=True)
        return False
    return True


def _check_options(until: object, budget: str | None, options: dict[str, Any]) -> None:
    """Raise a usage error for options that do not go together."""
    if not until and budget is not None:
        raise click.UsageError(
            "--budget: you gave no --until, whose processor time it bounds, and FILE has no target; give both, or none"
        )
    if until and (options["only"] or options["limit"]):
        name = "--only" if options["only"] else "--limit"
        allowed = "one of the two, as the error of a limit needs all cases"
        raise click.UsageError(f"{name}: you gave --until, or a target in FILE, as well; gfmd allows {allowed}")


def goal_in(file: Path, until: dict[str, Any], budget: str | None, option: str) -> Goal:
    """Return the goal of a campaign in a file: without a name, an error of what the campaign fits.

    Errors name the `option` that gives it.
    """
    from gfmd_numba.campaign.file import fitted_variable
    from gfmd_numba.campaign.goal import goal_of

    with arguments.told_as({"until": option, "budget": "--budget"}):
        return goal_of({variable or fitted_variable(file): target for variable, target in until.items()}, budget)


@contextmanager
def rounds_shown(option: str) -> Iterator[tuple[Watch, Told]]:
    """Yield two functions that show the rounds of a run, each with its progress; errors name the option of its goal."""
    caption = ["blocks"]

    def told(rounds: Rounds, planned: Plan, left: int) -> None:
        caption[0] = _tell(rounds, planned, left)

    with arguments.told_as({"until": option, "budget": "--budget"}), progress_bar(lambda: caption[0]) as watch:
        yield watch, told


def levels_of(now: Round) -> str:
    """Return how fine the levels of a round are."""
    import numpy as np

    from gfmd_numba.analysis.selection import fractions
    from gfmd_numba.campaign.axes import DISCRETISATIONS

    finest = [min(level[i] for of_group in now.levels for level in of_group) for i in range(len(DISCRETISATIONS))]
    shown = [f"{name} to {fractions(np.array([eps]))}" for name, eps in zip(DISCRETISATIONS, finest, strict=True)]
    return f"{', '.join(shown)}: {len(now.realisations)} cases"


def _tell(rounds: Rounds, planned: Plan, left: int) -> str:
    """Say what a round is about to do, and return the caption of its progress bar."""
    from gfmd_numba.campaign.file import is_without_levels
    from gfmd_numba.campaign.rounds import added

    number, now = len(rounds.rounds) - 1, rounds.now
    chosen = is_without_levels(planned.document, planned.campaign)
    if left and now.levels != (rounds.rounds[-2].levels if number else ()) and (number or chosen):
        say("levels", levels_of(now), err=True)
    if number == 0:
        if left and not chosen and (crossed := added(planned)):
            say("added", f"cross levels {crossed}, to see whether corrections add up", err=True)
        if left:
            say("round", f"0, the pilot: {left} simulations", err=True)
        return "pilot"
    before, targets = rounds.rounds[-2], rounds.goal.targets
    aims = []
    for name, target in targets.items():
        found = before.told_of(name)["error"]
        error = "unknown" if found is None else f"{found:.2%}"
        aims.append(f"{f'{name} ' if len(targets) > 1 else ''}error {error}, target {target:.2%}")
    of_which = f" of {now.variable}" if len(targets) > 1 else ""
    expected = "" if now.predicted_error is None else f", {now.predicted_error:.2%}{of_which} expected"
    cost = [
        f"{duration(max(0.0, price - before.price) * rounds.seconds_per_price)} {what}"
        for price, what in (
            (now.price, "of processor time"),
            (now.target_price, f"until the target{of_which} is reached"),
        )
        if price is not None and before.price is not None and rounds.seconds_per_price is not None
    ]
    takes = f"; about {', '.join(cost)}" if cost else ""
    if left:
        say("round", f"{number}: {', '.join(aims)}; {left} simulations more{expected}{takes}", err=True)
    return f"round {number}, {', '.join(aims)}"


_directory = click.argument("directory", type=click.Path(exists=True, file_okay=False, path_type=Path))


@main.command()
@_directory
@arguments.json_option
@click.option("--watch", is_flag=True, help="Repeat every two seconds until the run has ended")
def status(directory: Path, as_json: bool, watch: bool) -> None:
    """Show how far the campaign in an output DIRECTORY is.

    If blocks have failed, the command prints the reason of each, and the command that runs it again.
    """
    from gfmd_numba.campaign.next_round import REACHED
    from gfmd_numba.campaign.status import progress

    while True:
        now = progress(directory)
        if as_json:
            click.echo(json.dumps(asdict(now)))
        else:
            left = "" if now.seconds_left is None or not now.running else f", about {duration(now.seconds_left)} left"
            state = "finished" if now.done == now.blocks and now.ended != "" else "not running"
            if now.ended and now.ended != REACHED:  # blocks that are done are no target that is reached
                state = now.ended
            state = "running" if now.running else state
            failed = f", {len(now.failed)} failed" if now.failed else ""
            say("", f"{now.campaign}: {now.done} of {now.blocks} blocks done{failed}; {state}{left}", width=0)
        if not watch or not now.running:
            break
        time.sleep(2.0)
    if not as_json:
        for block, failure in now.failed.items():
            say(failure.status, f"{block}: {failure.reason}", width=10)
            say_command(now.retry[block], width=10)


@main.command()
@_directory
def collect(directory: Path) -> None:
    """Write the finished work in a DIRECTORY to its netCDF file.

    You can do this while the campaign runs. DIRECTORY is the output directory of a campaign.
    """
    from gfmd_numba.campaign.collection import collect as collect_campaign
    from gfmd_numba.campaign.results import read_results
    from gfmd_numba.campaign.status import campaign_in

    results = collect_campaign(campaign_in(directory)[0], directory)
    say_written("results", results)
    say_doubts(read_results(results))


@main.command()
@_directory
def verify(directory: Path) -> None:
    """Compare the files of an output DIRECTORY with their digests.

    These are the shards, the results, the notes of the run, its mark and its copy of the campaign file. The command
    exits with 3 if one of them is damaged or was changed.
    """
    from gfmd_numba.campaign.output_directory import AlteredError
    from gfmd_numba.campaign.status import verify as verify_files

    try:
        verdict = verify_files(directory)
    except AlteredError as error:
        warn(f"{error}; nothing else was looked at")
        sys.exit(SOME_FAILED)
    click.echo(f"shards   {verdict.sound} sound, {len(verdict.damaged)} damaged, {verdict.missing} missing")
    for name in verdict.damaged:
        say("damaged", f"{name}: `gfmd run` computes it again")
    for name in verdict.foreign:
        say("foreign", f"{name}: belongs to no case of this campaign and is not used")
    for file, state in verdict.altered.items():
        say("damaged", f"{file}, {state}")
    if not verdict.altered:
        click.echo("others   sound")
    if verdict.damaged or verdict.altered:
        sys.exit(SOME_FAILED)
