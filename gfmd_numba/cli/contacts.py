"""Commands that make one contact or one surface."""

from __future__ import annotations

import json
import sys
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gfmd_numba.cli.arguments import file_argument, output_option
from gfmd_numba.cli.group import SOME_FAILED, main, without_collections
from gfmd_numba.cli.outputs import check_output, picture_path, write, write_picture
from gfmd_numba.cli.progress import waiting
from gfmd_numba.cli.quantities import column, line, readable
from gfmd_numba.cli.tables import endings
from gfmd_numba.cli.terminal import print_table, say, warn, warn_of_doubts

if TYPE_CHECKING:
    import xarray as xr

_SHOWN = (  # as far as a dataset has them: a loaded body has but the last
    "mean_pressure",
    "contact_area_fraction",
    "approach",
    "mean_gap",
    "peak_pressure",
    "n_segments",
    "elastic_energy",
    "kappa",
    "kappa_r",
    "plastic_area_fraction",
    "mean_plastic_depth",
    "mean_tangential_traction",
    "mean_tangential_traction_y",
    "stick_fraction",
    "energy_lost",
)
_PRESCRIBED = (
    *("reduced_pressure", "prescribed_pressure", "line_load", "force", "punch_displacement"),
    *("sliding", "sliding_y"),
)


@main.command()
@file_argument
@output_option
def solve(file: Path, output: Path) -> None:
    """Solve the contact or the loaded body in a scene FILE.

    The command writes height, pressure, displacement and gap over x. It also writes and prints contact area, mean gap
    and other numbers of the whole contact. If the run does not converge, its `status` says so and the command exits
    with 3.
    """
    with without_collections():
        from gfmd_numba.scene import SceneFile, input_files, load_scene
        from gfmd_numba.simulate import solve as solve_file

    described, document = load_scene(file)
    check_output(output, file, *input_files(described))
    # warnings are told below, in the words of the file
    with waiting("solving"), warnings.catch_warnings(action="ignore", category=UserWarning):
        dataset = solve_file(described, document)
    write(output, dataset)
    steps = dataset if "step" in dataset.dims else dataset.expand_dims("step")
    if "step" in dataset.dims:
        _show_steps(dataset)
    else:
        _show_one(dataset)
    warn_of_doubts(dataset)
    last = steps.isel(step=-1)  # a path ends at its first step that is not ok
    if int(last["status"]):
        number, n_steps = steps.sizes["step"] - 1, len(described.path) if isinstance(described, SceneFile) else 0
        where = f" in step {number} of {n_steps}, which ends the path" if n_steps else ""
        warn(f"the run ended as {_ending(last)}{where}: do not use its numbers")
        for _, sentence in endings(steps["status"]):
            warn(sentence)
        sys.exit(SOME_FAILED)


def _show_one(dataset: xr.Dataset) -> None:
    """Print what came of one loading, a line each."""
    prescribed = [name for name in _PRESCRIBED if name in dataset.coords]
    for name in (*prescribed, *(name for name in _SHOWN if name in dataset)):
        words, number, unit = line(dataset, name)
        click.echo(f"{words:24}{number:<14}{unit}".rstrip())
    click.echo(f"{'residual':24}{float(dataset['residual']):.1e}")


def _show_steps(dataset: xr.Dataset) -> None:
    """Print the steps of a path: what was prescribed, and what came of it."""
    prescribed = [name for name in _PRESCRIBED if name in dataset.coords and dataset[name].any()]
    steps = {"step": [str(step) for step in range(dataset.sizes["step"])]}
    view = _with_stiffness(dataset)
    found = dict(column(view, name) for name in (*_SHOWN[:4], "contact_stiffness", *_SHOWN[4:]) if name in view)
    found["residual"] = [f"{float(residual):.1e}" for residual in dataset["residual"]]
    print_table("steps of the path", steps | dict(column(dataset, name) for name in prescribed), found)


def _with_stiffness(dataset: xr.Dataset) -> xr.Dataset:
    """Return the dataset with the stiffness since the step before, if the hard wall alone acts and the load changed."""
    interface = json.loads(dataset.attrs["scene"])["scene"]["interface"]
    if [name for name, law in interface.items() if law is not None] != ["hard_wall"]:
        return dataset
    closed = dataset["approach"] if "approach" in dataset else -dataset["mean_gap"]
    rise, fall = dataset["mean_pressure"].diff("step"), closed.diff("step")
    stiffness = (rise / fall.where((rise != 0.0) & (fall != 0.0))).reindex(step=dataset["step"])
    return dataset.assign(contact_stiffness=stiffness)


def _ending(step: xr.Dataset) -> str:
    """Return how a run that is not ok ended, when, and by which wave."""
    meaning = step["status"].attrs["flag_meanings"].split()[int(step["status"])]
    ending = f"{meaning} after {int(step['n_iterations'])} iterations"
    if meaning in ("steps_used_up", "stagnated"):
        return f"{ending} at a residual of {float(step['residual']):.1e}"
    return ending if meaning != "unstable" else f"{ending} with wave {int(step['growing_wave'])} growing"


@main.command()
@file_argument
@output_option
def surface(file: Path, output: Path) -> None:
    """Make the rough surface described in FILE.

    The command writes and draws the heights, and their spectrum, autocorrelation and height distribution with
    those of theory. The picture (.png) has the name of the netCDF file.
    """
    from gfmd_numba.analysis import plot_surface
    from gfmd_numba.scene.measured_record import Measured
    from gfmd_numba.scene.surface_file import load_surface
    from gfmd_numba.simulate.surface import surface_dataset

    picture = picture_path(output)
    described, document = load_surface(file)
    measured = described.surface
    check_output(output, file, *([Path(measured.file)] if isinstance(measured, Measured) and measured.file else []))
    # warnings are told below, in the words of the file
    with waiting("making the surface"), warnings.catch_warnings(action="ignore", category=UserWarning):
        dataset = surface_dataset(described, document)
    write(output, dataset, "surface")
    write_picture(picture, lambda: plot_surface(dataset))
    for name, variable in dataset.data_vars.items():
        if not variable.dims:
            figures, unit = readable(float(variable), _surface_unit(str(name), variable.attrs["units"]))
            click.echo(f"{name!s:24}{figures} {unit}".rstrip())
    for sentence in filter(None, dataset.attrs["processing"].split("\n")):
        say("done", sentence)
    warn_of_doubts(dataset)


def _surface_unit(name: str, unit: str) -> str:
    return {"rms_height": "L_x", "rms_curvature": "1/L_x"}.get(name, "") if unit == "1" else unit
