"""Commands that make one contact, the fields in its body, or one surface."""

from __future__ import annotations

import sys
import warnings
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gfmd_numba.cli.arguments import check_output, file_argument
from gfmd_numba.cli.group import SOME_FAILED, main
from gfmd_numba.cli.imports import without_collections

if TYPE_CHECKING:
    import xarray as xr


@main.command()
@file_argument
@click.option("-o", "--output", required=True, type=click.Path(dir_okay=False, path_type=Path))
def solve(file: Path, output: Path) -> None:
    """Solve the one contact or loaded body in the scene FILE and write its fields and scalars."""
    with without_collections():
        import gfmd_numba
        import gfmd_numba.single
        from gfmd_numba.scene import input_files

    check_output(output, file, *input_files(file))
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # told below, in the words of the file
        dataset = gfmd_numba.solve(file)
    dataset.to_netcdf(output, engine="netcdf4")
    click.echo(f"results  {output}")
    steps = dataset if "step" in dataset.dims else dataset.expand_dims("step")
    shown = ("kappa", "kappa_r", "contact_area_fraction", "mean_pressure", "residual")
    for name in (name for name in shown if name in dataset):  # a loaded body has but the last
        values = "".join(
            f"{'-' if isnan(value) else format(value, '.6g'):<14}" for value in steps[name].values.tolist()
        )
        click.echo(f"{name:24}{values}{dataset[name].units.replace('1', '')}".rstrip())
    if dataset.attrs.get("validity"):
        click.echo(f"gfmd: {dataset.attrs['validity']}", err=True)
    failed = [f"{_ending(steps.isel(step=i))} in step {i}" for i, status in enumerate(steps["status"]) if int(status)]
    if failed:
        click.echo(f"gfmd: the run is {', '.join(failed)}: those numbers are not to be used", err=True)
        sys.exit(SOME_FAILED)


def _ending(step: xr.Dataset) -> str:
    """How a run that is not ok ended, when, and by which wave."""
    meaning = step["status"].attrs["flag_meanings"].split()[int(step["status"])]
    ending = f"{meaning} after {int(step['n_iterations'])} iterations"
    if meaning != "unstable":
        return ending
    return f"{ending} with wave {int(step['growing_wave'])} growing (lower numerics.time_step)"


@main.command()
@file_argument
@click.option("-o", "--output", required=True, type=click.Path(dir_okay=False, path_type=Path))
@click.option("--body", default="body", show_default=True, help="Which of two bodies: body or counter_body")
def fields(file: Path, output: Path, body: str) -> None:
    """Write and draw displacement, strain and stress inside a body of the contact in FILE, left by `gfmd solve`."""
    import gfmd_numba
    from gfmd_numba.analysis import plot_body
    from gfmd_numba.campaign.results import read_results
    from gfmd_numba.cli.fits import naming

    picture = _picture(output)
    check_output(output, file)
    dataset = gfmd_numba.body_fields(read_results(file), body=body)
    dataset.to_netcdf(output, engine="netcdf4")
    click.echo(f"fields   {output}")
    with naming(file):
        plot_body(dataset).savefig(picture, dpi=150)
    click.echo(f"picture  {picture}")


def _picture(output: Path) -> Path:
    picture = output.with_suffix(".png")
    if picture == output:
        raise click.BadParameter("the picture takes the name with .png; give one like steel.nc", param_hint="--output")
    return picture


@main.command()
@file_argument
@click.option("-o", "--output", required=True, type=click.Path(dir_okay=False, path_type=Path))
def surface(file: Path, output: Path) -> None:
    """Make the rough surface described in FILE, with its statistics and a picture."""
    import gfmd_numba
    from gfmd_numba.analysis import plot_surface

    picture = _picture(output)
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
