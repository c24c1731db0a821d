"""The command that plans a campaign: its size, its cost, and the design that reaches an accuracy."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gfmd_numba.cli.arguments import budget_option, file_argument, target_option
from gfmd_numba.cli.group import main
from gfmd_numba.cli.progress import waiting
from gfmd_numba.cli.readable import dimensions
from gfmd_numba.cli.sentences import say
from gfmd_numba.cli.tables import duration
from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    from gfmd_numba.campaign.plan import Plan


@main.command()
@file_argument
@click.option(
    "--workers",
    default=2,
    show_default=True,
    type=click.IntRange(0),
    help="Number of local worker processes to plan for",
)
@click.option(
    "--pilot",
    default=10.0,
    show_default=True,
    type=click.FloatRange(0),
    help="Seconds to spend on measuring the cost; 0 measures nothing",
)
@target_option
@budget_option
@click.option("--write", type=click.Path(dir_okay=False, path_type=Path), help="New file for the planned campaign")
def plan(
    file: Path, workers: int, pilot: float, target: tuple[str, float] | None, budget: float | None, write: Path | None
) -> None:
    """Predict size and cost of the campaign in FILE.

    Without --target and --budget, the command plans for the realisations in FILE. With one of them, it chooses the
    numbers of realisations that reach the error, or that make the best of the time.
    """
    from gfmd_numba.campaign.file import is_without_levels
    from gfmd_numba.campaign.limits_beforehand import refused_limits
    from gfmd_numba.campaign.plan import plan as plan_campaign
    from gfmd_numba.scene import InputError

    planned = plan_campaign(file)
    distinct = len(planned.problems)
    click.echo(f"campaign      {planned.campaign.name}")
    click.echo(f"cases         {len(planned.cases)}, of which {distinct} distinct problems")
    for differing, count in planned.shared.items():
        whose = " and ".join(differing) or "nothing"
        say("shared", f"{count} cases differ from another case only in {whose}, which changes no number", width=14)
    chosen = is_without_levels(planned.document, planned.campaign)
    if chosen:
        first = "what follows is the first round; from its results, the run chooses finer levels and more surfaces"
        say("levels", f"{first}; `gfmd run --budget TIME` bounds what it may take", width=14)
    told = dimensions(planned.campaign.scene, planned.campaign.grid)
    if told:
        say("scene", told, width=14)
    if planned.campaign.path:
        click.echo(f"path          {len(planned.campaign.path)} steps after the first loading")
    for doubt in (*planned.validity.splitlines(), *refused_limits(planned)):
        say("gfmd:", doubt, width=6, err=True)
    if chosen and (target or budget):
        option = "--target" if target else "--budget"
        raise InputError(
            f"{option}: you gave a campaign without levels, which nobody can plan before there are results; gfmd "
            "allows `gfmd run --until`, which chooses them, or levels under `reference` and `limits`"
        )
    if target or budget:
        _check_target(planned, target[0] if target else "")
        _show_design(planned, target[1] if target else None, budget, workers, write)
    else:
        _show_size(planned, workers)
        if pilot:
            _show_cost(planned, workers, pilot)
    for effect in planned.effects[:_MOST_EFFECTS]:
        say(effect.state, f"{effect.name}: {effect.reason}", width=14)
    if len(planned.effects) > _MOST_EFFECTS:
        click.echo(f"              and {len(planned.effects) - _MOST_EFFECTS} more effects of that kind")


_MOST_EFFECTS = 50


def _show_size(planned: Plan, workers: int) -> None:
    from gfmd_numba.campaign.plan import PROGRAM_BYTES, check_memory

    click.echo(f"simulations   {planned.n_simulations} of {planned.n_asked} asked for")
    largest = max((case.problem.surface for case in planned.cases), key=lambda surface: surface.nodes)
    click.echo(f"largest grid  nx = {largest.nx}" + (" = ny" if len(largest.shape) == 2 else ""))
    program = f"{PROGRAM_BYTES / 1e6:.0f} MB for the program"
    click.echo(f"memory        {planned.worker_bytes / 1e6:.0f} MB a worker, besides {program}")
    click.echo(f"results       {planned.file_bytes / 1e6:.2f} MB, and as much again in shards")
    check_memory(planned.blocks, workers)


def _show_cost(planned: Plan, workers: int, pilot: float) -> None:
    with waiting("measuring what the problems cost"):
        predicted = planned.predicted_cost(pilot)
    contacts = predicted.quantile(0.5), predicted.quantile(0.9)
    walls = [planned.wall_time(predicted, seconds, workers) for seconds in contacts]
    _show_times(planned, workers, contacts, (walls[0], walls[1]))
    smaller = f", and {predicted.smaller} on smaller grids" if predicted.smaller else ""
    click.echo(f"measured      {predicted.pilot} of the {len(planned.problems)} problems on this machine{smaller}")


def _show_times(planned: Plan, workers: int, cpu: tuple[float, float], wall: tuple[float, float]) -> None:
    """Print what a run takes: likely times of the contacts, and those not exceeded, with all that is beside them."""
    from gfmd_numba.campaign.overhead import UNSURE, overhead

    beside = overhead(planned)
    for name, contacts, others in (
        ("CPU time", cpu, beside.cpu_seconds(workers)),
        ("wall time", wall, beside.wall_seconds(workers)),
    ):
        at_most = duration(contacts[1] + UNSURE * others)
        click.echo(f"{name:13} {duration(contacts[0] + others)}, with 90 % probability below {at_most}")
    parts = {"contacts": cpu[0], "start": beside.start, "workers": workers * beside.worker}
    parts |= {"results": beside.results, "fit and picture": beside.fit}
    shown = ", ".join(f"{name} {duration(seconds)}" for name, seconds in parts.items() if seconds)
    say("of CPU time", shown, width=14)


def _check_target(planned: Plan, name: str) -> None:
    from gfmd_numba.scene import InputError

    fitted = planned.campaign.fit.variable
    if name not in ("", fitted):
        raise InputError(
            f"--target: you gave {name}; gfmd allows {fitted}, as the campaign fits that (another: `fit: "
            f"{{variable: ...}}`)"
        )


def _show_design(planned: Plan, target: float | None, budget: float | None, workers: int, write: Path | None) -> None:
    from gfmd_numba.analysis import UnusableDataError
    from gfmd_numba.campaign import design as accuracy
    from gfmd_numba.campaign.cross_levels import added, with_cross_levels
    from gfmd_numba.campaign.overhead import UNSURE
    from gfmd_numba.scene import InputError
    from gfmd_numba.storage.atomic_file import create

    if write is not None and (os.path.lexists(write) or not write.parent.is_dir()):
        raise InputError(f"--write: you gave {printable(write)}; gfmd allows a new file in an existing folder")
    planned = with_cross_levels(planned)
    if crossed := added(planned):
        say("added", f"cross levels {crossed}, to see whether corrections add up", width=14)
    try:
        with waiting("planning from a pilot"):
            found = accuracy.pilot(planned)
            chosen = accuracy.design(planned, found, target, None if budget is None else budget * max(1, workers))
    except UnusableDataError as error:
        raise InputError(f"{'--target' if target else '--budget'}: {error}") from None
    variable = planned.campaign.fit.variable
    click.echo(f"realisations  {accuracy.asked(planned, chosen)}")
    parts = f"sampling {chosen.sampling:.2%}, exponents {chosen.exponents:.2%}"
    told = f"{chosen.error:.2%} of {variable} in the limit ({parts}), mostly from {chosen.limiting}"
    say("error", told, width=14)
    say("promised", accuracy.promise(found), width=14)
    designed = accuracy.designed(planned, chosen)
    _show_size(designed, workers)
    walls = chosen.seconds / max(1, workers), UNSURE * chosen.seconds / max(1, workers)
    _show_times(designed, workers, (chosen.seconds, UNSURE * chosen.seconds), walls)
    click.echo(f"residual      {accuracy.loosest_residual(planned, chosen.error):g} is enough for the solver")
    for goal in (0.1, 0.03, 0.01, 0.003):
        try:
            with waiting(f"planning for {goal:.1%}"):
                price = f"{duration(accuracy.design(planned, found, goal, None).seconds)} for the contacts"
        except UnusableDataError:
            price = "cannot be reached with these levels"
        click.echo(f"price         {goal:.1%}: {price}")
    if write is not None:
        text, name = accuracy.rewritten(planned, chosen, target)
        create(write, text.encode())
        say("campaign", f"{write}, named {name} (the results of {planned.campaign.name} stay)", width=14)
