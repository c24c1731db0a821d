"""Commands that fit and draw results."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gfmd_numba.cli import outputs
from gfmd_numba.cli.arguments import (
    NEW_FILE,
    exponents_option,
    fixed_option,
    results_argument,
    told_as,
    variable_option,
)
from gfmd_numba.cli.group import main
from gfmd_numba.cli.tables import fit_options, of_fit, of_goal
from gfmd_numba.cli.terminal import say, tell, waiting
from gfmd_numba.text.input_error import InputError
from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    import xarray as xr

    from gfmd_numba.analysis.plots.style import Width


_TABLES = [".nc", ".nc4", ".csv"]


@main.command()
@results_argument
@variable_option
@exponents_option
@fixed_option
@click.option("-o", "--output", type=NEW_FILE, help="File to write the fit to (.nc), or the limits as a table (.csv)")
@click.option(
    "--function",
    type=NEW_FILE,
    help="File (.nc or .csv) for the limit as a smooth function of the parameters of the grid, with its error",
)
def fit(results: Path, output: Path | None, function: Path | None, **asked: Any) -> None:
    """Extrapolate kappa in RESULTS to its limit.

    RESULTS is the netCDF file of a campaign, or its output directory.
    """
    from gfmd_numba.analysis.arguments import targets_of
    from gfmd_numba.campaign.results import read_results, results_file
    from gfmd_numba.storage.atomic_file import write_table

    file = results_file(results)
    for path in filter(None, (output, function)):
        outputs.check_output(path, file, file.parent / "campaign.yaml", suffixes=_TABLES)
    dataset = read_results(file)
    with naming(file):
        fitted = _fit(dataset, **asked)
    tell(of_fit(fitted))
    variable, own = fitted.attrs["variable"], fit_options(dataset)
    is_own = fit_options(dataset, **asked) == fit_options(dataset, variable=variable)
    if is_own and variable in {own.get("variable"), *targets_of(dataset)}:
        tell(of_goal(dataset, fitted))
    if output is not None and output.suffix == ".csv":
        limit, of_group = f"{variable}_tfc", (name for name in fitted.coords if name != "group")
        names = [str(name) for name in of_group if fitted[name].dims == ("group",)]  # the parameters
        names += [limit, f"{limit}_error", f"{limit}_low", f"{limit}_high", "fit_status"]
        units = {name: fitted[name].attrs.get("units", "1") for name in names}
        write_table(output, {f"{name} ({units[name]})": fitted[name].values.tolist() for name in names})
        outputs.say_written("fit", output)
    elif output is not None:
        outputs.write(output, fitted, "fit")
    if function is not None:
        with naming(file):
            _write_function(fitted, function)


def _write_function(fitted: xr.Dataset, path: Path) -> None:
    """Write the limit as a function of the parameters, and say how certain it is."""
    import numpy as np

    from gfmd_numba.analysis.smooth_function import smooth_function
    from gfmd_numba.storage.atomic_file import write_dataset, write_table

    try:
        with waiting("looking for a smooth function"):
            found = smooth_function(fitted)
    except ModuleNotFoundError:
        needs = "`pip install 'gfmd-numba[functions]'`"
        raise InputError(
            f"--function: you have no scikit-learn, which it needs; gfmd allows it after {needs}"
        ) from None
    name = f"{found.attrs['variable']}_tfc"
    if path.suffix == ".csv":
        table = found[[name, f"{name}_error"]].to_dataframe().reset_index()
        write_table(path, {f"{each} ({found[each].attrs['units']})": table[each].tolist() for each in table})
    else:
        write_dataset(path, found)
    click.echo(f"function {printable(path)}: {name} over {', '.join(map(str, found[name].dims))}")
    share = abs(found[f"{name}_error"] / found[name])
    where = share.isel(share.argmax(...))
    place = ", ".join(f"{each} = {float(where[each]):.3g}" for each in found[name].dims)
    say("error", f"at most {float(where):.2%}, at {place}")
    joint = abs(found["held_out"] / found["held_out_error"])
    worst = found.isel(point=int(np.argmax(joint.values)))
    place = ", ".join(f"{each} = {float(worst[f'point_{each}']):.3g}" for each in found[name].dims)
    off = float(abs(worst["held_out"] / worst["limit"]))
    say(
        "held out",
        f"the worst limit is {off:.2%}, {float(joint.max()):.1f} errors, off the function without it, at {place}",
    )


@main.command()
@results_argument
@variable_option
@exponents_option
@fixed_option
@click.option("-o", "--output", type=NEW_FILE, help="Picture to write, like kappa.pdf, .svg or .png [next to RESULTS]")
@click.option(
    "--width", type=click.Choice(["single", "double"]), help="Column of a journal: 3.4 or 7 in wide, text of 8 points"
)
def plot(results: Path, output: Path | None, width: Width | None, **asked: Any) -> None:
    """Draw RESULTS, whatever command of gfmd wrote them.

    RESULTS is the output directory of a campaign, or the netCDF file of a campaign, a fit, a contact, a load curve, a
    surface, a loaded body, an accuracy study, or the fields inside a body. If a campaign ran --until an error, a
    second picture, NAME-rounds, shows the error against processor time. The picture of a loading path shows its loop,
    and of one contact a second one, NAME-last-step, shows where it ends.
    """
    from gfmd_numba.analysis.plots.kinds import picture_of
    from gfmd_numba.campaign.results import read_results, results_file

    file = results_file(results)
    picture = output or outputs.companion(file, "picture", ".png")
    outputs.check_output(picture, file, file.parent / "campaign.yaml", suffixes=outputs.picture_suffixes())
    dataset = read_results(file)
    for path in outputs.pictures(dataset, None, picture):
        outputs.check_output(path, file, file.parent / "campaign.yaml", suffixes=[path.suffix.lower()])
    with naming(file):
        has_fit = picture_of(dataset) is None
        for name in ("variable", "exponents", "fixed"):
            if asked[name] and not has_fit:
                raise click.UsageError(f"--{name}: the picture of {file} has no fit; leave the option out")
        fitted = _fit(dataset, **asked) if has_fit else None
        for path, drawing in outputs.pictures(dataset, fitted, picture, width).items():
            outputs.write_picture(path, drawing)


@contextmanager
def naming(file: Path) -> Iterator[None]:
    """Name the file in errors about its data."""
    from gfmd_numba.analysis import UnusableDataError

    try:
        yield
    except UnusableDataError as error:
        raise InputError(f"{file}: {error}") from None


def _fit(dataset: xr.Dataset, **asked: Any) -> xr.Dataset:
    from gfmd_numba.analysis import fit_tfc
    from gfmd_numba.analysis.extrapolation import check_effect

    options = fit_options(dataset, **asked)
    if asked["fixed"]:
        with told_as({"fixed": "--fixed"}):
            check_effect(dataset, **options | {"fixed": dict(asked["fixed"])})
    with waiting("fitting"):
        return fit_tfc(dataset, **options)
