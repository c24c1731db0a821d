"""Commands that plan and run campaigns."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from gfmd_numba.cli.arguments import LIMITS, file_argument
from gfmd_numba.cli.fits import draw, fit_options
from gfmd_numba.cli.group import SOME_FAILED, main
from gfmd_numba.cli.progress import progress_bar
from gfmd_numba.cli.tables import show_fit, show_means


@main.command()
@file_argument
def plan(file: Path) -> None:
    """Say what the campaign in FILE comes to, without running it."""
    from gfmd_numba.campaign.run import plan as plan_campaign

    planned = plan_campaign(file)
    n, distinct = len(planned.cases), planned.n_problems
    click.echo(f"campaign      {planned.campaign.name}")
    click.echo(f"cases         {n}, of which {distinct} distinct problems")
    click.echo(f"simulations   {distinct * planned.campaign.realisations} in {len(planned.tasks)} tasks")
    click.echo(f"largest grid  nx = {max(case.discretisation.nx for case in planned.cases)}")
    click.echo(f"memory        {planned.worker_bytes / 1e6:.0f} MB a worker, besides 200 MB for the program")
    click.echo(f"results       {planned.file_bytes / 1e6:.2f} MB")
    for effect in planned.effects:
        click.echo(f"{effect.state:13} {effect.name}: {effect.reason}")


@main.command()
@file_argument
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Output directory [name of the campaign]")
@click.option("--workers", default=2, show_default=True, type=click.IntRange(0), help="0: in this process")
@click.option("--scheduler", metavar="ADDRESS", help="Use an existing dask scheduler")
def run(file: Path, output: Path | None, workers: int, scheduler: str | None) -> None:
    """Run the campaign in FILE, or what is left of it, and fit its results."""
    import gfmd_numba
    from gfmd_numba.campaign.run import run as run_campaign

    with progress_bar() as watch:
        results, failures = run_campaign(file, output, workers, scheduler, watch)
    click.echo(f"results  {results}")
    dataset = gfmd_numba.open_campaign(results)
    options = fit_options(dataset, (), None, None)
    if LIMITS.keys() & set(dataset["limit"].values):
        fitted = gfmd_numba.fit_tfc(dataset, **options)
        show_fit(fitted)
        draw(dataset, fitted, results.with_suffix(".png"))
    else:
        show_means(dataset, options.get("variable", "kappa"))
    for task, reason in failures.items():
        click.echo(f"gfmd: task {task} crashed: {reason}", err=True)
    unfinished = int((dataset["status"] != 0).sum())
    if unfinished:
        click.echo(f"gfmd: {unfinished} of {dataset['status'].size} simulations are not ok, see `status`", err=True)
        sys.exit(SOME_FAILED)
