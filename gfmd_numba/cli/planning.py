"""The commands that say what results cost: the plan of a campaign, also to an accuracy, and accuracy studies."""

from __future__ import annotations

import sys
from itertools import groupby
from math import isnan, nan
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gfmd_numba.cli import arguments
from gfmd_numba.cli.campaigns import goal_in, levels_of, rounds_shown
from gfmd_numba.cli.group import INTERRUPTED, SOME_FAILED, main
from gfmd_numba.cli.outputs import check_output, companion, write, write_picture
from gfmd_numba.cli.tables import MOST_ROWS, cells_of_parameters, dimensions, duration, said_of_error
from gfmd_numba.cli.terminal import print_table, say, waiting, warn
from gfmd_numba.text.numbers import counted

if TYPE_CHECKING:
    from gfmd_numba.campaign.execution import Failures
    from gfmd_numba.campaign.plan import Plan
    from gfmd_numba.campaign.rounds import Rounds


_OF_SOME = {
    "error of hysteresis": "hysteresis_error",
    "error of pull-off": "pull_off_pressure_error",
    "order error (L_x)": "next_order",
}
_ERRORS = {"relative error": "error"} | _OF_SOME


@main.command()
@arguments.file_argument
@arguments.workers_option("Number of local worker processes to plan for, which solve the pilot of a target")
@click.option(
    "--pilot",
    default=10.0,
    show_default=True,
    type=click.FloatRange(0),
    help="Seconds to spend on measuring the cost; 0 measures nothing",
)
@arguments.targets_option("--target", "Run the pilot of `gfmd run --until`, and say what the next round would take")
@arguments.budget_option
def plan(file: Path, workers: int, pilot: float, target: dict[str, str], budget: str | None) -> None:
    """Predict size and cost of the campaign in FILE.

    Without --target, the command plans for the realisations in FILE, or for the first round of a run that chooses them.

    With --target, it runs the pilot of `gfmd run --until`, keeps none of its results, and says what that run would do
    next: the levels, the realisations and the processor time of the next round. What the target takes in all depends
    on the results of later rounds, and is told only where the pilot can tell.
    """
    from gfmd_numba.campaign.file import target_of_run
    from gfmd_numba.campaign.plan import plan as plan_campaign
    from gfmd_numba.campaign.plan import refused_limits
    from gfmd_numba.campaign.rounds import pilot_plan
    from gfmd_numba.campaign.run import first_decision
    from gfmd_numba.campaign.workers import Workers

    _check_options(target, budget)
    goal = goal_in(file, target, budget, "--target") if target else None
    planned = plan_campaign(file, None if goal is None else goal.targets)
    distinct = len(planned.problems)
    click.echo(f"campaign      {planned.campaign.name}")
    click.echo(f"cases         {len(planned.cases)}, of which {distinct} distinct problems")
    for differing, count in planned.shared.items():
        whose = " and ".join(differing) or "nothing"
        say("shared", f"{count} cases differ from another case only in {whose}, which changes no number", width=14)
    of_file = None if goal is not None else target_of_run(file)
    if of_file:
        said = "what follows is the first round; from its results, the run chooses finer levels and more surfaces"
        bounds = "`gfmd run --budget TIME` bounds what it may take"
        say("levels", f"{said}; `gfmd plan --target` runs it and tells what comes next; {bounds}", width=14)
    told = dimensions(planned.campaign.scene, planned.campaign.grid)
    if told:
        say("scene", told, width=14)
    if planned.campaign.path:
        click.echo(f"path          {counted(len(planned.campaign.path), 'step')} after the first loading")
    for doubt in (*planned.validity.splitlines(), *refused_limits(planned.campaign, planned.cases)):
        warn(doubt)
    well = True
    if goal is not None:
        try:
            with rounds_shown("--target") as (watch, said_of_round):
                decided = first_decision(file, goal, Workers(workers), watch, said_of_round)
        except KeyboardInterrupt:
            warn("interrupted; a plan keeps no results")
            sys.exit(INTERRUPTED)
        well = _show_decision(*decided, workers)
    else:
        first = pilot_plan(planned, goal_in(file, of_file, None, "--target")) if of_file else planned
        _show_size(first, workers)
        if pilot:
            _show_cost(first, workers, pilot)
    alike: dict[tuple[str, str], list[str]] = {}
    for effect in planned.effects:
        alike.setdefault((effect.state, effect.reason), []).append(effect.name)
    for (state, reason), names in alike.items():
        say(state, f"{', '.join(names)}: {reason}", width=14)
    if not well:
        sys.exit(SOME_FAILED)


def _show_size(planned: Plan, workers: int) -> None:
    from gfmd_numba.campaign.plan import PROGRAM_BYTES, check_memory

    distinct, asked = sum(planned.demand.values()), sum(case.realisations for case in planned.cases)
    click.echo(f"simulations   {distinct} of {asked} asked for")
    largest = max((case.problem.surface for case in planned.cases), key=lambda surface: surface.nodes)
    click.echo(f"largest grid  {' x '.join(map(str, largest.shape))} nodes")
    program = f"{PROGRAM_BYTES / 1e6:.0f} MB for the program"
    click.echo(f"memory        {planned.worker_bytes / 1e6:.0f} MB a worker, besides {program}")
    click.echo(f"results       {planned.file_bytes / 1e6:.2f} MB, and as much again in shards")
    check_memory(planned.blocks, workers)


def _show_cost(planned: Plan, workers: int, pilot: float) -> None:
    """Print how long a run takes, likely and at most, with its contacts and everything else."""
    from gfmd_numba.campaign.overhead import UNSURE, overhead

    with waiting("measuring what the problems cost"):
        predicted = planned.predicted_cost(pilot)
    cpu = [predicted.quantile(probability) for probability in (0.5, 0.9)]
    wall = [planned.wall_time(predicted, seconds, workers) for seconds in cpu]
    parts = overhead(planned, workers)
    extra, of_workers = sum(parts.values()), parts["workers"]
    at_once = of_workers / max(1, workers)  # they start together, on a core each
    for name, (likely, most), others in (("CPU time", cpu, extra), ("wall time", wall, extra - of_workers + at_once)):
        at_most = duration(most + UNSURE * others)
        click.echo(f"{name:13} {duration(likely + others)}, with 90 % probability below {at_most}")
    shown = ", ".join(f"{name} {duration(spent)}" for name, spent in {"contacts": cpu[0], **parts}.items() if spent)
    say("of CPU time", shown, width=14)
    smaller = f", and {predicted.smaller} on smaller grids" if predicted.smaller else ""
    click.echo(f"measured      {predicted.pilot} of the {len(planned.problems)} problems on this machine{smaller}")


def _check_options(target: object, budget: str | None) -> None:
    """Raise a usage error for options that do not go together."""
    if not target and budget is not None:
        raise click.UsageError(
            "--budget: you gave no --target, whose processor time it bounds; give both, or none (`gfmd run --budget` "
            "bounds a run)"
        )
    if target and arguments.is_given("pilot"):
        raise click.UsageError("--pilot: you gave --target as well, which runs a pilot of its own; give one of them")


def _show_decision(state: Rounds, planned: Plan, failures: Failures, workers: int) -> bool:
    """Print what a pilot found and what follows; return False if the target is out of reach, or some blocks failed."""
    from gfmd_numba.campaign.next_round import REACHED

    pilot = state.rounds[0]
    spent = f"{duration(pilot.cpu_seconds or 0.0)} of processor time for the contacts"
    for name, target in state.goal.targets.items():
        told, error = pilot.told_of(name), pilot.errors.get(name)
        found = said_of_error(told["error"] or nan, told["error_factor"] or nan)
        say("pilot", f"{name} in the limit: {found}; {spent}", width=14)
        how = state.ended or "not reached by the pilot"
        if error is not None and error.reached:
            how = "reached by the pilot"
        if state.ended == REACHED:
            how += ", after which `gfmd run --until` ends"
        say("target", f"{target:.2%}: {how}", width=14)
    if not state.ended:
        _show_next_round(state, planned)
        _show_size(planned, workers)
    for block, failure in failures.items():
        warn(f"block {block} {failure.status}: {failure.reason}")
    return state.ended in ("", REACHED) and not failures


def _show_next_round(state: Rounds, planned: Plan) -> None:
    """Print what was decided for the round after the pilot, and what is known of later ones."""
    pilot, now = state.rounds
    refined = now.levels != pilot.levels
    say("round 1", f"finer levels, {levels_of(now)}" if refined else "more realisations of the same levels", width=14)
    expected = "no error is predicted for levels without results"
    if now.predicted_error is not None:
        expected = f"{now.predicted_error:.2%} of {now.variable} in the limit is expected after round 1"
    say("error", expected, width=14)
    if state.seconds_per_price is not None and now.price is not None:
        so_far = duration(now.price * state.seconds_per_price)
        say("CPU time", f"about {so_far} for the contacts of the pilot and of round 1", width=14)
        in_all = "nobody can know yet what the target takes, because what follows depends on the results of round 1"
        if now.target_price is not None:
            seconds = duration(now.target_price * state.seconds_per_price)
            in_all = f"about {seconds} for all contacts until the target is reached, as far as the pilot can tell"
        say("", in_all, width=14)
    _show_realisations(state, planned)


def _show_realisations(state: Rounds, planned: Plan) -> None:
    """Print how many realisations each level of each group has in the pilot, and in the round after it."""
    import numpy as np
    import xarray as xr

    from gfmd_numba.analysis.selection import fractions
    from gfmd_numba.campaign.coordinates import described_coordinates

    pilot, now = state.rounds
    dataset = xr.Dataset(coords=described_coordinates(planned.cases[0].scene, planned.cases))
    shown = dataset.isel(case=slice(MOST_ROWS))
    parameters = cells_of_parameters(shown, dataset)
    for name in arguments.LIMITS.keys() & parameters.keys():
        parameters[name] = [fractions(np.array([eps])) for eps in shown[name].values]
    before = dict(zip(pilot.cases, pilot.realisations, strict=True))
    realisations = {
        "pilot": [str(before.get(case, 0)) for case in now.cases[:MOST_ROWS]],
        "round 1": list(map(str, now.realisations[:MOST_ROWS])),
    }
    print_table("realisations of each level", parameters, realisations)
    if len(now.cases) > MOST_ROWS:
        say("note", f"{len(now.cases) - MOST_ROWS} more levels are not shown", width=14)


@main.command()
@arguments.file_argument
@click.option("-o", "--output", type=arguments.NEW_FILE, help="netCDF file to write [NAME-accuracy.nc]")
@click.option(
    "--realisations", type=click.IntRange(2), help="Random surfaces in each study [16, 4 to 15 on large grids or paths]"
)
def accuracy(file: Path, output: Path | None, realisations: int | None) -> None:
    """Measure on this machine what accuracy costs.

    The studies start from the reference case of the campaign in FILE. Each varies one setting and measures error and
    processor time: solver and residual, time step and damping, each discretisation, the number of surfaces,
    the length of the steps of a loading path, and the order in the slope of rough bodies. `gfmd plan --target` tells
    what an error of the limit costs.
    """
    from gfmd_numba.analysis import plot_accuracy
    from gfmd_numba.campaign import work_precision
    from gfmd_numba.campaign.plan import plan

    planned = plan(file)
    results = output if output is not None else Path(f"{planned.campaign.name}-accuracy.nc")
    picture = companion(results, "picture", ".png")
    check_output(results, file)
    points: list[work_precision.Point] = []
    for point in work_precision.studies(planned, realisations):
        if not points or points[-1].study != point.study:
            click.echo(f"study    {point.study}", err=True)
        points.append(point)
    dataset = work_precision.dataset(points)
    write(results, dataset)
    write_picture(picture, lambda: plot_accuracy(dataset))
    for study, group in groupby(points, key=lambda point: point.study):
        some = list(group)
        settings = {"curve": [point.curve for point in some], "setting": [f"{point.setting:g}" for point in some]}
        names = _ERRORS if some[0].variable == "kappa" else {"error of area": "error"} | _OF_SOME
        found = {
            heading: ["-" if isnan(value := getattr(point, name)) else f"{value:.2g}" for point in some]
            for heading, name in names.items()
            if name == "error" or not all(isnan(getattr(point, name)) for point in some)
        }
        found |= {
            "processor time": [duration(point.seconds) for point in some],
            "transforms": ["-" if isnan(point.transforms) else f"{point.transforms:.0f}" for point in some],
        }
        if any(point.failed for point in some):
            found["failed"] = [str(point.failed) for point in some]
        print_table(f"what accuracy costs: {study}", settings, found)
