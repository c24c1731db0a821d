"""Commands that plan and run campaigns."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gfmd_numba.cli.arguments import LIMITS, budget_option, conditions_option, file_argument, target_option
from gfmd_numba.cli.fits import draw, fit_options
from gfmd_numba.cli.group import SOME_FAILED, main
from gfmd_numba.cli.progress import progress_bar, waiting
from gfmd_numba.cli.sentences import say, say_command
from gfmd_numba.cli.tables import duration, endings, show_fit, show_means, show_target
from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    import xarray as xr

    from gfmd_numba.campaign.plan import Plan


@main.command()
@file_argument
@click.option("--workers", default=2, show_default=True, type=click.IntRange(0), help="That would run it")
@click.option("--pilot", default=10.0, show_default=True, type=click.FloatRange(0), help="Seconds to measure with")
@target_option
@budget_option
@click.option("--write", type=click.Path(dir_okay=False, path_type=Path), help="Campaign file of that design")
def plan(
    file: Path, workers: int, pilot: float, target: tuple[str, float] | None, budget: float | None, write: Path | None
) -> None:
    """Say what the campaign in FILE comes to and costs, without running it."""
    from gfmd_numba.campaign.plan import plan as plan_campaign

    planned = plan_campaign(file)
    distinct = len(planned.problems)
    click.echo(f"campaign      {planned.campaign.name}")
    click.echo(f"cases         {len(planned.cases)}, of which {distinct} distinct problems")
    for differing, count in planned.shared.items():
        whose = " and ".join(differing) or "nothing"
        say("shared", f"{count} cases differ from another one in {whose} alone, which changes no number", width=14)
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
        click.echo(f"              and {len(planned.effects) - _MOST_EFFECTS} more of that kind")


_MOST_EFFECTS = 50


def _show_size(planned: Plan, workers: int) -> None:
    from gfmd_numba.campaign.plan import PROGRAM_BYTES, check_memory

    click.echo(f"simulations   {planned.n_simulations} of {planned.n_asked} asked for")
    largest = max(case.problem.surface.nx for case in planned.cases)
    click.echo(f"largest grid  nx = {largest}" + (" = ny" if planned.campaign.scene.dimension == 2 else ""))
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
            f"--target: given {name}; allowed: {fitted}, as the campaign fits that (another: `fit: {{variable: ...}}`)"
        )


def _show_design(planned: Plan, target: float | None, budget: float | None, workers: int, write: Path | None) -> None:
    from gfmd_numba.analysis import UnusableDataError
    from gfmd_numba.campaign import design as accuracy
    from gfmd_numba.campaign.overhead import UNSURE
    from gfmd_numba.scene import InputError
    from gfmd_numba.storage.atomic_file import create

    if write is not None and (os.path.lexists(write) or not write.parent.is_dir()):
        raise InputError(f"--write: given {printable(write)}; allowed: a new file in an existing folder")
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
            price = "not to be had with these levels"
        click.echo(f"price         {goal:.1%}: {price}")
    if write is not None:
        text, name = accuracy.rewritten(planned, chosen, target)
        create(write, text.encode())
        say("campaign", f"{write}, named {name} (the results of {planned.campaign.name} stay)", width=14)


@main.command()
@file_argument
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Output directory [name of the campaign]")
@click.option("--workers", default=2, show_default=True, type=click.IntRange(0), help="0: in this process")
@click.option("--scheduler", metavar="ADDRESS", help="Use an existing dask scheduler")
@click.option("--insecure", is_flag=True, help="Allow one beyond this machine without TLS")
@conditions_option
@click.option("--limit", type=click.IntRange(1), metavar="N", help="Stop after N blocks of realisations")
@click.option("--retry-failed", is_flag=True, help="Try again what crashed or timed out before")
@click.option("--fail-fast", is_flag=True, help="Stop at the first block that fails")
def run(
    file: Path,
    output: Path | None,
    workers: int,
    scheduler: str | None,
    insecure: bool,
    only: tuple[tuple[str, str], ...],
    limit: int | None,
    retry_failed: bool,
    fail_fast: bool,
) -> None:
    """Run the campaign in FILE, or what is left of it, and fit its results."""
    import gfmd_numba
    from gfmd_numba.campaign.execution import Workers
    from gfmd_numba.campaign.run import Choice, StoppedError
    from gfmd_numba.campaign.run import run as run_campaign

    choice = Choice(dict(only), limit, retry_failed, fail_fast)
    try:
        with progress_bar() as watch:
            results, failures = run_campaign(file, output, Workers(workers, scheduler, insecure), watch, choice)
    except StoppedError as error:
        say("gfmd:", str(error), width=6, err=True)
        sys.exit(SOME_FAILED)
    click.echo(f"results  {printable(results)}")
    dataset = gfmd_numba.open_campaign(results)
    if dataset.attrs.get("validity"):
        click.echo(f"gfmd: {dataset.attrs['validity']}", err=True)
    status = dataset["status"]
    meanings = status.attrs["flag_meanings"].split()
    to_do = int((status == meanings.index("unfinished")).sum())
    asked = int((status != meanings.index("not_asked")).sum())
    not_ok = asked - to_do - int((status == 0).sum())
    drawn = True
    if to_do:
        say("note", f"{to_do} of {asked} simulations are not run yet: the same command resumes")
    elif LIMITS.keys() & set(dataset["limit"].values):
        with waiting("fitting"):
            fitted = gfmd_numba.fit_tfc(dataset, **fit_options(dataset, (), None, None))
        show_fit(fitted)
        if "target" in dataset.attrs:
            show_target(fitted, dataset.attrs["target"])
        drawn = _draw(dataset, fitted, results.with_suffix(".png"))
    else:
        show_means(dataset, fit_options(dataset, (), None, None).get("variable", "kappa"))
    for block, failure in failures.items():
        say("gfmd:", f"block {block} {failure.status}: {failure.reason}", width=6, err=True)
    for ending, sentence in endings(status):
        ended = dataset["n_iterations"].where(status == meanings.index(ending))
        if ended.max() > 0:  # what has not run has no iterations
            first = f"the first after {int(ended.min())} iterations"
            say("gfmd:", f"{int(ended.count())} are {ending}, {first}. {sentence}", width=6, err=True)
    if not_ok:
        say(
            "gfmd:",
            f"{not_ok} of {asked} simulations are not ok, see `status` in the file; "
            f"`gfmd status {results.parent}` says how to run crashed ones again",
            width=6,
            err=True,
        )
    if not_ok or not drawn:
        sys.exit(SOME_FAILED)


def _draw(dataset: xr.Dataset, fitted: xr.Dataset, picture: Path) -> bool:
    """Draw the fit of a finished run unless a file that is not ours is there; False if the disk refuses it."""
    from gfmd_numba.storage.atomic_file import is_ours

    try:
        if picture.exists() and not is_ours(picture):
            click.echo(f"note     {picture} is not of gfmd and stays as it is (`gfmd plot -o` draws elsewhere)")
        else:
            draw(dataset, fitted, picture)
    except OSError as error:
        click.echo(f"gfmd: {error}; the results are whole, `gfmd plot {picture.parent}` draws them", err=True)
        return False
    return True


_directory = click.argument("directory", type=click.Path(exists=True, file_okay=False, path_type=Path))


@main.command()
@_directory
@click.option("--json", "as_json", is_flag=True, help="For programs")
@click.option("--watch", is_flag=True, help="Look again every two seconds until it has ended")
def status(directory: Path, as_json: bool, watch: bool) -> None:
    """Say how far the campaign is whose output DIRECTORY this is."""
    import json
    import time
    from dataclasses import asdict

    from gfmd_numba.campaign.status import progress

    while True:
        now = progress(directory)
        if as_json:
            click.echo(json.dumps(asdict(now)))
        else:
            left = "" if now.seconds_left is None or not now.running else f", about {duration(now.seconds_left)} left"
            state = "running" if now.running else "finished" if now.done == now.blocks else "not running"
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
    """Write what is finished in an output DIRECTORY to its netCDF file, also during a run."""
    from gfmd_numba.campaign.collection import collect as collect_campaign
    from gfmd_numba.campaign.status import campaign_in

    click.echo(f"results  {printable(collect_campaign(campaign_in(directory), directory))}")


@main.command()
@_directory
def verify(directory: Path) -> None:
    """Check every shard in an output DIRECTORY, and its netCDF file, against their digests."""
    from gfmd_numba.campaign.collection import is_altered
    from gfmd_numba.campaign.results import read_results
    from gfmd_numba.campaign.status import campaign_in
    from gfmd_numba.campaign.status import verify as verify_shards

    verdict = verify_shards(directory)
    click.echo(f"shards   {verdict.sound} sound, {len(verdict.damaged)} damaged, {verdict.missing} not there")
    for name in verdict.damaged:
        say("damaged", f"{name}: `gfmd run` computes it again")
    for name in verdict.foreign:
        say("foreign", f"{name}: of no case of this campaign; it is not used")
    planned = campaign_in(directory)
    file = directory / f"{planned.campaign.name}.nc"
    altered = False
    if file.exists():
        altered = is_altered(read_results(file), planned)
        state = "differs from its digest: `gfmd collect` writes it again" if altered else "sound"
        say("results", f"{file} {state}")
    if verdict.damaged or altered:
        sys.exit(SOME_FAILED)
