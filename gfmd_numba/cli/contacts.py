"""Commands that make one contact, the fields in its body, or one surface."""

from __future__ import annotations

import sys
import warnings
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gfmd_numba.cli.arguments import check_output, file_argument, picture_beside
from gfmd_numba.cli.columns import print_table
from gfmd_numba.cli.group import SOME_FAILED, main
from gfmd_numba.cli.imports import without_collections
from gfmd_numba.cli.progress import waiting
from gfmd_numba.cli.readable import readable
from gfmd_numba.cli.sentences import say
from gfmd_numba.cli.tables import endings
from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    import xarray as xr


@main.command()
@file_argument
@click.option("-o", "--output", required=True, type=click.Path(dir_okay=False, path_type=Path))
def solve(file: Path, output: Path) -> None:
    """Solve the one contact or loaded body in the scene FILE and write its fields and scalars."""
    with without_collections():
        from gfmd_numba.scene import input_files, load_scene
        from gfmd_numba.simulate import solve as solve_file
        from gfmd_numba.storage.atomic_file import write_dataset

    described, document = load_scene(file)
    check_output(output, file, *input_files(described))
    # warnings are told below, in the words of the file
    with waiting("solving"), warnings.catch_warnings(action="ignore", category=UserWarning):
        dataset = solve_file(described, document)
    write_dataset(output, dataset)
    click.echo(f"results  {printable(output)}")
    steps = dataset if "step" in dataset.dims else dataset.expand_dims("step")
    shown = [name for name in _SHOWN if name in dataset]  # a loaded body has but the last
    if "step" in dataset.dims:
        _show_steps(dataset, shown)
    else:
        for name in shown:
            value = dataset[name].item()
            figures, unit = ("-", "") if isnan(value) else readable(value, _unit(dataset, name))
            click.echo(f"{name:24}{figures:<14}{unit}".rstrip())
    for doubt in dataset.attrs.get("validity", "").splitlines():
        say("gfmd:", doubt, width=6, err=True)
    failed = [f"{_ending(steps.isel(step=i))} in step {i}" for i, status in enumerate(steps["status"]) if int(status)]
    if failed:
        say("gfmd:", f"the run is {', '.join(failed)}: those numbers are not to be used", width=6, err=True)
        for _, sentence in endings(steps["status"]):
            say("gfmd:", sentence, width=6, err=True)
        sys.exit(SOME_FAILED)


_SHOWN = {
    "kappa": "kappa",
    "kappa_r": "kappa_r",
    "contact_area_fraction": "contact area fraction",
    "mean_pressure": "mean pressure",
    "residual": "residual",
}
_PRESCRIBED = {
    "reduced_pressure": "p*",
    "prescribed_pressure": "p",
    "line_load": "F/l",
    "force": "F",
    "punch_displacement": "punch displacement",
    "sliding": "sliding",
}
_FREE_UNITS = {"mean_pressure": "E*", "punch_displacement": "L_x", "sliding": "L_x"}


def _show_steps(dataset: xr.Dataset, shown: list[str]) -> None:
    """Print the steps of a path: what was prescribed, and what came of it."""
    prescribed = [name for name in _PRESCRIBED if name in dataset.coords and dataset[name].any()]
    steps = {"step": [str(step) for step in range(dataset.sizes["step"])]}
    parameters = {_heading(dataset, name, _PRESCRIBED[name]): _figures(dataset[name]) for name in prescribed}
    found = {_heading(dataset, name, _SHOWN[name]): _figures(dataset[name]) for name in shown}
    found["residual"] = [f"{float(residual):.1e}" for residual in dataset["residual"]]
    print_table("steps of the path", steps | parameters, found)


def _heading(dataset: xr.Dataset, name: str, words: str) -> str:
    unit = _unit(dataset, name)
    return f"{words} ({unit})" if unit else words


def _unit(dataset: xr.Dataset, name: str) -> str:
    """Unit of a scalar: E* or L_x, which count as 1 in the file, where the scene leaves them open."""
    unit = dataset[name].attrs.get("units") or dataset["x"].attrs["units"]  # a prescribed length is in that of x
    return _FREE_UNITS.get(name, "") if unit == "1" else str(unit)


def _figures(values: xr.DataArray) -> list[str]:
    return ["-" if isnan(value) else f"{value:.6g}" for value in values.values.ravel().tolist()]


def _ending(step: xr.Dataset) -> str:
    """How a run that is not ok ended, when, and by which wave."""
    meaning = step["status"].attrs["flag_meanings"].split()[int(step["status"])]
    ending = f"{meaning} after {int(step['n_iterations'])} iterations"
    return ending if meaning != "unstable" else f"{ending} with wave {int(step['growing_wave'])} growing"


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
    from gfmd_numba.storage.atomic_file import write_dataset, write_picture

    picture = picture_beside(output)
    check_output(output, file)
    with waiting("computing the fields"):
        dataset = gfmd_numba.body_fields(read_results(file), body=body)
    write_dataset(output, dataset)
    click.echo(f"fields   {printable(output)}")
    with naming(file), waiting("drawing"):
        write_picture(picture, plot_body(dataset), dpi=150)
    click.echo(f"picture  {printable(picture)}")


@main.command()
@file_argument
@click.option("-o", "--output", required=True, type=click.Path(dir_okay=False, path_type=Path))
def surface(file: Path, output: Path) -> None:
    """Make the rough surface described in FILE, with its statistics and a picture."""
    from gfmd_numba.analysis import plot_surface
    from gfmd_numba.scene.surface_file import load_surface
    from gfmd_numba.scene.surfaces import Measured
    from gfmd_numba.simulate.surface import surface_dataset
    from gfmd_numba.storage.atomic_file import write_dataset, write_picture

    picture = picture_beside(output)
    described, document = load_surface(file)
    measured = described.surface
    check_output(output, file, *([Path(measured.file)] if isinstance(measured, Measured) else []))
    with waiting("making the surface"):
        dataset = surface_dataset(described, document)
    write_dataset(output, dataset)
    click.echo(f"surface  {printable(output)}")
    with waiting("drawing"):
        write_picture(picture, plot_surface(dataset), dpi=150)
    click.echo(f"picture  {printable(picture)}")
    for name, variable in dataset.data_vars.items():
        if not variable.dims:
            figures, unit = readable(float(variable), _surface_unit(str(name), variable.attrs["units"]))
            click.echo(f"{name!s:24}{figures} {unit}".rstrip())
    for sentence in filter(None, dataset.attrs["processing"].split("\n")):
        say("done", sentence)


def _surface_unit(name: str, unit: str) -> str:
    return {"rms_height": "L_x", "rms_curvature": "1/L_x"}.get(name, "") if unit == "1" else unit
