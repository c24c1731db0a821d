"""The `gfmd` command; every import of weight happens inside the command that needs it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import inf, isnan
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    import xarray as xr

BAD_INPUT, SOME_FAILED, INTERRUPTED = 2, 3, 130

_Fixed = tuple[str, float | tuple[float, float]]


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
_variables = click.Choice(["kappa", "kappa_counted", "kappa_r"])
_variable = click.option("--variable", type=_variables, help="[as the campaign says]")
_exponents = click.option("--exponents", type=click.Choice(["shared", "free"]), help="[as the campaign says]")


def _exponents_given(ctx: click.Context, param: click.Parameter, options: tuple[str, ...]) -> tuple[_Fixed, ...]:
    """Return the exponents of the fit as `eps_c=1` or `eps_c=0.5:1` give them."""
    return tuple(map(_exponent, options))


def _exponent(option: str) -> _Fixed:
    from gfmd_numba.scene.document import plain_scalar

    name, _, given = option.partition("=")
    ends: list[Any] = [plain_scalar(end) for end in given.split(":")]
    numbers = len(ends) <= 2 and all(type(end) in (int, float) for end in ends)
    if name not in _LIMITS or not numbers or not 0 < ends[0] <= ends[-1] < inf:
        allowed = f"{', '.join(_LIMITS)} with a number above 0 or a range, like eps_t=1 or eps_f=0.5:1"
        raise click.BadParameter(f"given {option!r}; allowed: {allowed}")
    return name, float(ends[0]) if len(ends) == 1 else (float(ends[0]), float(ends[1]))


_LIMITS = {"eps_c": "continuum", "eps_f": "fractal", "eps_t": "thermodynamic"}
_fixed = click.option(
    "--fixed", multiple=True, callback=_exponents_given, metavar="EPS=X[:Y]", help="Fix an exponent, or say its range"
)


@main.command()
@_file
def check(file: Path) -> None:
    """Check a campaign, scene or surface FILE and say what is wrong with it."""
    from gfmd_numba.campaign.specification import Campaign, load_campaign
    from gfmd_numba.scene import load_scene, read_document
    from gfmd_numba.scene.surface_file import load_surface

    data = read_document(file).data
    if isinstance(data, dict) and {"name", "realisations", "reference", "limits", "grid"} & data.keys():
        campaign: Campaign = load_campaign(file)[0]
        click.echo(f"{file}: a campaign of {campaign.n_cases} cases x {campaign.realisations} realisations")
    elif isinstance(data, dict) and "surface" in data:
        load_surface(file)
        click.echo(f"{file}: a surface")
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
    options = _options(dataset, (), None, None)
    if _LIMITS.keys() & set(dataset["limit"].values):
        fitted = gfmd_numba.fit_tfc(dataset, **options)
        _show(fitted)
        _draw(dataset, fitted, results.with_suffix(".png"))
    else:
        _show_means(dataset, options.get("variable", "kappa"))
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
    results: Path, variable: str | None, exponents: str | None, fixed: tuple[_Fixed, ...], output: Path | None
) -> None:
    """Fit kappa in RESULTS (a campaign's file or directory) to its limit."""
    from gfmd_numba.campaign.results import read_results, results_file

    file = results_file(results)
    if output is not None:
        _check_output(output, file, file.parent / "campaign.yaml")
    dataset = read_results(file)
    with _naming(file):
        fitted = _fit(dataset, fixed, variable, exponents)
    _show(fitted)
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
    results: Path, variable: str | None, exponents: str | None, fixed: tuple[_Fixed, ...], output: Path | None
) -> None:
    """Draw RESULTS: kappa against the discretisations, or the fields of one contact."""
    from gfmd_numba.campaign.results import read_results, results_file

    file = results_file(results)
    picture = output or file.with_suffix(".png")
    _check_output(picture, file, file.parent / "campaign.yaml")
    _check_picture(picture)
    dataset = read_results(file)
    with _naming(file):
        fitted = None if "x" in dataset.dims else _fit(dataset, fixed, variable, exponents)
        _draw(dataset, fitted, picture)


@main.command()
@_file
@click.option("-o", "--output", required=True, type=click.Path(dir_okay=False, path_type=Path))
def solve(file: Path, output: Path) -> None:
    """Solve the one contact in the scene FILE and write its fields and scalars."""
    import gfmd_numba
    from gfmd_numba.scene import Measured, load_scene

    roughness = load_scene(file).scene.roughness
    _check_output(output, file, *([Path(roughness.file)] if isinstance(roughness, Measured) else []))
    dataset = gfmd_numba.solve(file)
    dataset.to_netcdf(output, engine="netcdf4")
    click.echo(f"results  {output}")
    steps = dataset if "step" in dataset.dims else dataset.expand_dims("step")
    for name in ("kappa", "kappa_r", "contact_area_fraction", "mean_pressure", "residual"):
        values = "".join(f"{float(value):<14.6g}" for value in steps[name])
        click.echo(f"{name:24}{values}{dataset[name].units.replace('1', '')}".rstrip())
    meanings = dataset["status"].attrs["flag_meanings"].split()
    failed = [f"{meanings[int(s)]} in step {i}" for i, s in enumerate(steps["status"]) if int(s) != 0]
    if failed:
        click.echo(f"gfmd: the run is {', '.join(failed)}: those numbers are not to be used", err=True)
        sys.exit(SOME_FAILED)


@main.command()
@_file
@click.option("-o", "--output", required=True, type=click.Path(dir_okay=False, path_type=Path))
def surface(file: Path, output: Path) -> None:
    """Make the rough surface described in FILE, with its statistics and a picture."""
    import gfmd_numba
    from gfmd_numba.analysis import plot_surface

    picture = output.with_suffix(".png")
    if picture == output:
        raise click.BadParameter("the picture takes the name with .png; give one like steel.nc", param_hint="--output")
    dataset = gfmd_numba.make_surface(file)
    dataset.to_netcdf(output, engine="netcdf4")
    click.echo(f"surface  {output}")
    plot_surface(dataset).savefig(picture, dpi=150)
    click.echo(f"picture  {picture}")
    for name, variable in dataset.data_vars.items():
        if not variable.dims:
            unit = variable.attrs["units"]
            click.echo(f"{name!s:24}{float(variable):.6g} {'' if unit == '1' else unit}")
    for sentence in filter(None, dataset.attrs["processing"].split("\n")):
        click.echo(f"done     {sentence}")


def _check_output(output: Path, *inputs: Path) -> None:
    """Raise InputError unless a file can be written that is none of the inputs."""
    import os

    from gfmd_numba.scene.document import InputError

    for file in inputs:
        if output.exists() and file.exists() and output.samefile(file):
            raise InputError(f"--output: given {output}, which is an input; allowed: another file")
    if not output.parent.is_dir():
        raise InputError(f"--output: given {output}; allowed: a file in an existing folder, unlike {output.parent}")
    if not os.access(output if output.exists() else output.parent, os.W_OK):
        raise InputError(f"--output: given {output}, which may not be written; allowed: a file that may be")


def _check_picture(path: Path) -> None:
    """Raise InputError for a picture of unknown kind."""
    from matplotlib.backend_bases import FigureCanvasBase

    from gfmd_numba.scene.document import InputError

    kinds = [f".{kind}" for kind in sorted(FigureCanvasBase.get_supported_filetypes())]
    if path.suffix.lower() not in kinds:
        raise InputError(f"--output: given {path}; allowed: a picture ending in {', '.join(kinds)}")


@contextmanager
def _naming(file: Path) -> Iterator[None]:
    """Put the name of the file into what its data lack."""
    from gfmd_numba.analysis import UnusableDataError
    from gfmd_numba.scene.document import InputError

    try:
        yield
    except UnusableDataError as error:
        raise InputError(f"{file}: {error}") from None


def _fit(dataset: xr.Dataset, fixed: tuple[_Fixed, ...], variable: str | None, exponents: str | None) -> xr.Dataset:
    from gfmd_numba.analysis import fit_tfc

    return fit_tfc(dataset, **_options(dataset, fixed, variable, exponents))


def _options(
    dataset: xr.Dataset, fixed: tuple[_Fixed, ...], variable: str | None, exponents: str | None
) -> dict[str, Any]:
    """Options of the fit: the campaign's own, overridden by those of the command line."""
    import json

    options: dict[str, Any] = json.loads(dataset.attrs.get("fit", "{}"))
    options["fixed"] = options.get("fixed", {}) | dict(fixed)
    if variable is not None:
        options["variable"] = variable
    if exponents is not None:
        options["exponents"] = exponents
    return options


def _draw(dataset: xr.Dataset, fitted: xr.Dataset | None, path: Path) -> None:
    from gfmd_numba.analysis import plot_campaign, plot_contact

    figure = plot_contact(dataset) if fitted is None else plot_campaign(dataset, fitted, fitted.attrs["variable"])
    figure.savefig(path, dpi=150)
    click.echo(f"picture  {path}")


_PARAMETERS = {
    "H": "hurst",
    "nu": "poissons_ratio",
    "a": "aspect_ratio",
    "p*": "reduced_pressure",
    "g": "rms_gradient_target",
}
_MOST_ROWS = 200


def _show(fitted: xr.Dataset) -> None:
    """Print kappa at the reference and in the limit, and what separates the two."""
    parameters = _shown_parameters(fitted)
    title = f"{fitted.attrs['variable']} and its limit eps_c, eps_f, eps_t -> 0 (one standard error)"
    rows = []
    for i in range(fitted.sizes["group"]):
        group = fitted.isel(group=i)
        corrections = [
            _with_error(group["correction"].sel(limit=limit), group["correction_error"].sel(limit=limit))
            for limit in _LIMITS
        ]
        rows.append(
            [
                *(_number(group[name]) for name in parameters.values()),
                _with_error(group["reference"], group["reference_error"]),
                _with_error(group["kappa_tfc"], group["kappa_tfc_error"]),
                *corrections,
            ]
        )
    _print_table(title, [*parameters, "reference", "limit", *_LIMITS.values()], rows)
    for limit, kind in _LIMITS.items():
        if fitted["alpha"].sel(limit=limit).notnull().any():
            click.echo(f"exponent {limit} {_exponent_found(fitted, limit):16} ({kind})")
    messages = [str(message).splitlines() for message in fitted["message"].values]
    for line in dict.fromkeys(line for lines in messages for line in lines):
        having = [i for i, lines in enumerate(messages) if line in lines]
        whose = "" if len(having) == len(messages) else _whose(fitted, having)
        click.echo(f"note     {whose}{line}")


def _show_means(dataset: xr.Dataset, variable: str) -> None:
    """Print the ensemble mean of every case, for a campaign without limits."""
    from gfmd_numba.analysis import ensemble_mean

    shown = dataset.isel(case=slice(_MOST_ROWS))
    parameters = _shown_parameters(dataset) | {limit: limit for limit in _LIMITS}
    columns = [shown[name].values for name in parameters.values()]
    rows = [
        [*map(_number, values), _with_error(mean, error)]
        for *values, mean, error in zip(*columns, *ensemble_mean(shown, variable), strict=True)
    ]
    _print_table(f"{variable}, mean of the realisations (one standard error)", [*parameters, variable], rows)
    if dataset.sizes["case"] > _MOST_ROWS:
        click.echo(f"note     {dataset.sizes['case'] - _MOST_ROWS} more cases are in the file")


def _print_table(title: str, columns: list[str], rows: list[list[str]]) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, title=title)
    for column in columns:
        table.add_column(column, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(*row)
    Console(width=120).print(table)


def _shown_parameters(dataset: xr.Dataset) -> dict[str, str]:
    """Return heading and name of each parameter; the gradient only if it differs, as kappa does not know it."""
    gradients = set(dataset["rms_gradient_target"].values.tolist())
    return {heading: name for heading, name in _PARAMETERS.items() if heading != "g" or len(gradients) > 1}


def _whose(fitted: xr.Dataset, having: list[int]) -> str:
    """Return which of several groups a note is about."""
    if len(having) > 3:
        return f"{len(having)} of {fitted.sizes['group']} groups: "
    varied = {h: name for h, name in _PARAMETERS.items() if len(set(map(_number, fitted[name].values))) > 1}
    groups = [
        ", ".join(f"{heading} = {_number(fitted[name].values[i])}" for heading, name in varied.items()) for i in having
    ]
    return " and ".join(groups) + ": "


def _exponent_found(fitted: xr.Dataset, limit: str) -> str:
    """Return the exponent of a limit, or one for each group if they differ."""
    found = {
        _with_error(value, error)
        for value, error in zip(
            fitted["alpha"].sel(limit=limit).values, fitted["alpha_error"].sel(limit=limit).values, strict=True
        )
    }
    return ", ".join(sorted(found))


def _number(value: Any) -> str:
    return "-" if isnan(float(value)) else f"{float(value):g}"


def _with_error(value: Any, error: Any) -> str:
    if isnan(float(value)):
        return "-"
    return f"{float(value):.3f}" + ("" if isnan(float(error)) else f" ± {float(error):.3f}")


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
