"""The `gfmd` command; every import of weight happens inside the command that needs it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    import xarray as xr

BAD_INPUT, SOME_FAILED, INTERRUPTED = 2, 3, 130


class _Gfmd(click.Group):
    """Turns what the user can mend into one message and an exit code."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command; bad input exits with 2, an interrupt with 130."""
        from gfmd_numba.scene.document import InputError

        try:
            return super().invoke(ctx)
        except (InputError, OSError) as error:
            click.echo(f"gfmd: {error}", err=True)
            ctx.exit(BAD_INPUT)
        except KeyboardInterrupt:
            click.echo("gfmd: interrupted; finished work is kept, the same command resumes", err=True)
            ctx.exit(INTERRUPTED)


@click.group(cls=_Gfmd, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="gfmd-numba")
def main() -> None:
    """Contact of rough elastic bodies: a YAML campaign in, kappa with error bars out."""


_file = click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
_results = click.argument("results", type=click.Path(exists=True, path_type=Path))
_variable = click.option("--variable", help="kappa, kappa_counted or kappa_r [as the campaign says]")
_exponents = click.option("--exponents", type=click.Choice(["shared", "free"]), help="[as the campaign says]")
_fixed = click.option("--fixed", multiple=True, metavar="EPS=X[:Y]", help="Fix an exponent, or say its range")


@main.command()
@_file
def check(file: Path) -> None:
    """Check a campaign or scene FILE and say what is wrong with it."""
    from gfmd_numba.campaign.specification import Campaign, load_campaign
    from gfmd_numba.scene import load_scene, read_document

    data = read_document(file).data
    if isinstance(data, dict) and {"name", "realisations", "reference", "limits", "grid"} & data.keys():
        campaign: Campaign = load_campaign(file)[0]
        click.echo(f"{file}: a campaign of {campaign.n_cases} cases x {campaign.realisations} realisations")
    else:
        load_scene(file)
        click.echo(f"{file}: a scene")


@main.command()
@_file
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
@_file
@click.option("-o", "--output", type=click.Path(path_type=Path), help="Output directory [name of the campaign]")
@click.option("--workers", default=2, show_default=True, type=click.IntRange(0), help="0: in this process")
@click.option("--scheduler", metavar="ADDRESS", help="Use an existing dask scheduler")
def run(file: Path, output: Path | None, workers: int, scheduler: str | None) -> None:
    """Run the campaign in FILE, or what is left of it, and fit its results."""
    import gfmd_numba
    from gfmd_numba.campaign.run import run as run_campaign

    with _progress() as watch:
        results, failures = run_campaign(file, output, workers, scheduler, watch)
    click.echo(f"results  {results}")
    dataset = gfmd_numba.open_campaign(results)
    if {"eps_c", "eps_f", "eps_t"} & set(dataset["limit"].values):
        fitted = gfmd_numba.fit_tfc(dataset, **_options(dataset, (), None, None))
        _show(dataset, fitted)
        _draw(dataset, fitted, results.with_suffix(".png"))
    for task, reason in failures.items():
        click.echo(f"gfmd: task {task} crashed: {reason}", err=True)
    unfinished = int((dataset["status"] != 0).sum())
    if unfinished:
        click.echo(f"gfmd: {unfinished} of {dataset['status'].size} simulations are not ok, see `status`", err=True)
        sys.exit(SOME_FAILED)


@main.command()
@_results
@_variable
@_exponents
@_fixed
@click.option("-o", "--output", type=click.Path(dir_okay=False, path_type=Path), help="Write the fit as netCDF")
def fit(
    results: Path, variable: str | None, exponents: str | None, fixed: tuple[str, ...], output: Path | None
) -> None:
    """Fit kappa in RESULTS (a campaign's file or directory) to its limit."""
    import gfmd_numba

    dataset = gfmd_numba.open_campaign(results)
    fitted = gfmd_numba.fit_tfc(dataset, **_options(dataset, fixed, variable, exponents))
    _show(dataset, fitted)
    if output is not None:
        fitted.to_netcdf(output, engine="netcdf4")
        click.echo(f"fit      {output}")


@main.command()
@_results
@_variable
@_exponents
@_fixed
@click.option("-o", "--output", type=click.Path(dir_okay=False, path_type=Path), help="Picture [beside RESULTS]")
def plot(
    results: Path, variable: str | None, exponents: str | None, fixed: tuple[str, ...], output: Path | None
) -> None:
    """Draw RESULTS: kappa against the discretisations, or the fields of one contact."""
    import gfmd_numba

    dataset = gfmd_numba.open_campaign(results)
    fitted = None
    if "case" in dataset.dims:
        fitted = gfmd_numba.fit_tfc(dataset, **_options(dataset, fixed, variable, exponents))
    _draw(dataset, fitted, output or (results / "kappa.png" if results.is_dir() else results.with_suffix(".png")))


@main.command()
@_file
@click.option("-o", "--output", required=True, type=click.Path(dir_okay=False, path_type=Path))
def solve(file: Path, output: Path) -> None:
    """Solve the one contact in the scene FILE and write its fields and scalars."""
    import gfmd_numba

    dataset = gfmd_numba.solve(file)
    dataset.to_netcdf(output, engine="netcdf4")
    click.echo(f"results  {output}")
    for name in ("kappa", "kappa_r", "contact_area_fraction", "mean_pressure", "residual"):
        click.echo(f"{name:24}{float(dataset[name]):.6g} {dataset[name].units.replace('1', '')}")
    if int(dataset["status"]) != 0:
        meaning = dataset["status"].attrs["flag_meanings"].split()[int(dataset["status"])]
        click.echo(f"gfmd: the run is {meaning}, its numbers are not to be used", err=True)
        sys.exit(SOME_FAILED)


def _options(
    dataset: xr.Dataset, fixed: tuple[str, ...], variable: str | None, exponents: str | None
) -> dict[str, Any]:
    """Options of the fit: the campaign's own, overridden by those of the command line."""
    import json

    options: dict[str, Any] = json.loads(dataset.attrs.get("fit", "{}"))
    options["fixed"] = options.get("fixed", {}) | dict(map(_exponent, fixed))
    if variable is not None:
        options["variable"] = variable
    if exponents is not None:
        options["exponents"] = exponents
    return options


def _exponent(option: str) -> tuple[str, float | tuple[float, float]]:
    name, _, value = option.partition("=")
    low, _, high = value.partition(":")
    try:
        return name, (float(low), float(high)) if high else float(low)
    except ValueError:
        raise click.BadParameter(f"{option!r}; give it like eps_t=1 or eps_f=0.5:1", param_hint="--fixed") from None


def _draw(dataset: xr.Dataset, fitted: xr.Dataset | None, path: Path) -> None:
    from gfmd_numba.analysis import plot_campaign, plot_contact

    figure = plot_contact(dataset) if fitted is None else plot_campaign(dataset, fitted, fitted.attrs["variable"])
    figure.savefig(path, dpi=150)
    click.echo(f"picture  {path}")


def _show(dataset: xr.Dataset, fitted: xr.Dataset) -> None:
    """Print kappa at the reference and in the limit, and what separates the two."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from gfmd_numba.analysis import ensemble_mean

    variable = fitted.attrs["variable"]
    table = Table(box=box.SIMPLE_HEAD, title=f"{variable} and its limit eps_c, eps_f, eps_t -> 0 (one standard error)")
    parameters = {"H": "hurst", "nu": "poissons_ratio", "a": "aspect_ratio", "p*": "reduced_pressure"}
    limits = {"eps_c": "continuum", "eps_f": "fractal", "eps_t": "thermodynamic"}
    for column in (*parameters, "reference", "limit", *limits.values()):
        table.add_column(column, justify="right", no_wrap=True)
    means, errors = ensemble_mean(dataset.isel(case=dataset["is_reference"].values), variable)
    for i in range(fitted.sizes["group"]):
        group = fitted.isel(group=i)
        corrections = [
            _with_error(group["correction"].sel(limit=limit), group["correction_error"].sel(limit=limit))
            for limit in limits
        ]
        table.add_row(
            *(f"{float(group[name]):g}" for name in parameters.values()),
            _with_error(means[i], errors[i]),
            _with_error(group["kappa_tfc"], group["kappa_tfc_error"]),
            *corrections,
        )
    Console(width=120).print(table)
    for limit, kind in limits.items():
        click.echo(f"exponent {limit} {_exponent_found(fitted, limit):16} ({kind})")
    for message in dict.fromkeys(str(m) for m in fitted["message"].values if m):
        click.echo(f"note     {message}")
    if (fitted["fit_status"] != "ok").any():
        click.echo("note     exponents are fixed with `gfmd fit --fixed eps_f=0.5:1`, or in the campaign's block `fit`")


def _exponent_found(fitted: xr.Dataset, limit: str) -> str:
    """Return the exponent of a limit, or one for each group if they differ."""
    found = {
        _with_error(value, error)
        for value, error in zip(
            fitted["alpha"].sel(limit=limit).values, fitted["alpha_error"].sel(limit=limit).values, strict=True
        )
    }
    return ", ".join(sorted(found))


def _with_error(value: Any, error: Any) -> str:
    if isnan(float(value)):
        return "-"
    return f"{float(value):.3f} ± {float(error):.3f}"


@contextmanager
def _progress() -> Iterator[Callable[[int, int], Callable[[], None]]]:
    """Progress bar on a terminal, a line for every tenth of the tasks otherwise."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("tasks"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    with Progress(*columns, disable=not sys.stderr.isatty()) as bars:

        def watch(total: int, done: int) -> Callable[[], None]:
            bar = bars.add_task("tasks", total=total, completed=done)
            shown = done

            def advance() -> None:
                nonlocal shown
                bars.advance(bar)
                finished = int(bars.tasks[bar].completed)
                if bars.disable and (finished == total or finished >= shown + max(1, total // 10)):
                    click.echo(f"tasks    {finished} of {total}", err=True)
                    shown = finished

            return advance

        yield watch


if __name__ == "__main__":
    main()
