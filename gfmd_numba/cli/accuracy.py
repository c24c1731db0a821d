"""The command that shows what accuracy costs in time."""

from __future__ import annotations

from itertools import groupby
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gfmd_numba.cli.arguments import NEW_FILE, file_argument
from gfmd_numba.cli.group import main
from gfmd_numba.cli.outputs import check_output, picture_path, write, write_picture
from gfmd_numba.cli.tables import duration
from gfmd_numba.cli.terminal import print_table

if TYPE_CHECKING:
    from gfmd_numba.campaign.work_precision import Point

_OF_SOME = {
    "error of hysteresis": "hysteresis_error",
    "error of pull-off": "pull_off_pressure_error",
    "order error (L_x)": "next_order",
}
_ERRORS = {"relative error": "error"} | _OF_SOME


@main.command()
@file_argument
@click.option("-o", "--output", type=NEW_FILE, help="netCDF file to write [NAME-accuracy.nc]")
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
    picture = picture_path(results)
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
        _show_study(study, list(group))


def _show_study(study: str, points: list[Point]) -> None:
    """Print what one setting costs, and how far off kappa is."""
    settings = {"curve": [point.curve for point in points], "setting": [f"{point.setting:g}" for point in points]}
    names = _ERRORS if points[0].variable == "kappa" else {"error of area": "error"} | _OF_SOME
    found = {
        heading: ["-" if isnan(value := getattr(point, name)) else f"{value:.2g}" for point in points]
        for heading, name in names.items()
        if name == "error" or not all(isnan(getattr(point, name)) for point in points)
    }
    found |= {
        "processor time": [duration(point.seconds) for point in points],
        "transforms": ["-" if isnan(point.transforms) else f"{point.transforms:.0f}" for point in points],
    }
    if any(point.failed for point in points):
        found["failed"] = [str(point.failed) for point in points]
    print_table(f"what accuracy costs: {study}", settings, found)
