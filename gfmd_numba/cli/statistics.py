"""The commands that say more of a solved contact: its distributions, what leaks through it, and what it conducts."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gfmd_numba.cli.arguments import check_output, file_argument, json_option, output_option, picture_path
from gfmd_numba.cli.columns import print_table
from gfmd_numba.cli.fits import draw, naming
from gfmd_numba.cli.group import main
from gfmd_numba.cli.progress import waiting
from gfmd_numba.cli.readable import readable
from gfmd_numba.cli.sentences import say
from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    import xarray as xr

_SHOWN = {  # words, and the unit of a contact without units
    "contact_area_fraction_persson": ("Persson's contact area", ""),
    "mean_gap": ("mean gap over rms height", ""),
    "perimeter": ("perimeter", "L_x"),
    "gap_connects": ("channel", ""),
    "contact_connects": ("contact bridges", ""),
    "critical_gap": ("critical gap", "L_x"),
    "largest_gap_fraction": ("largest connected gap", ""),
    "largest_contact_fraction": ("largest contact cluster", ""),
    "n_gaps": ("separate gaps", ""),
    "hydraulic_gap": ("hydraulic gap", "L_x"),
    "flow_factor": ("flow factor", ""),
    "conductance": ("conductance", "1/L_x"),
}


_files_option = click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    help="netCDF file to write, with a picture (.png) of the same name",
)


@main.command()
@file_argument
@output_option
@click.option(
    "--percolation", is_flag=True, help="Find out whether channels connect the sides of a map, and how narrow they are"
)
def statistics(file: Path, output: Path, percolation: bool) -> None:
    """Compute distributions of pressure, gap and contacts.

    FILE is a contact that `gfmd solve` wrote. The command writes and draws the distributions. The picture (.png) has
    the name of the netCDF file.
    """
    import gfmd_numba

    def compute(contact: xr.Dataset) -> xr.Dataset:
        found = gfmd_numba.contact_statistics(contact)
        return found.assign(gfmd_numba.gap_percolation(contact).variables) if percolation else found

    _measure(file, output, compute, "computing the statistics")


@main.command()
@file_argument
@_files_option
@json_option
def leakage(file: Path, output: Path | None, as_json: bool) -> None:
    """Compute how much leaks through the gap of a map.

    FILE is a contact that `gfmd solve` wrote of a scene with `dimension: 2`. The command solves the Reynolds equation
    along x and along y, and prints hydraulic gap and flow factor. The picture shows the channels.
    """
    from gfmd_numba.analysis import leakage as leakage_of

    _measure(file, output, leakage_of, "computing the flow", as_json)


@main.command()
@file_argument
@_files_option
@json_option
def conductance(file: Path, output: Path | None, as_json: bool) -> None:
    """Compute the electrical or thermal conductance of a contact.

    FILE is a contact that `gfmd solve` wrote. The command prints the conductance of the touching spots per nominal area
    over the conductivity of the bodies. The picture shows the current.
    """
    from gfmd_numba.simulate.contact_conductance import contact_conductance

    _measure(file, output, contact_conductance, "computing the current", as_json)


def _measure(
    file: Path, output: Path | None, compute: Callable[[xr.Dataset], xr.Dataset], doing: str, as_json: bool = False
) -> None:
    """Compute something of the contact in a file, write and draw it where an output is given, and print its numbers."""
    from gfmd_numba.campaign.results import read_results
    from gfmd_numba.cli.places import in_words_of_options
    from gfmd_numba.storage.atomic_file import write_dataset

    picture = None if output is None else picture_path(output)
    if output is not None:
        check_output(output, file)
    contact = read_results(file)
    with in_words_of_options(file), naming(file), waiting(doing):
        dataset = compute(contact)
    if output is not None and picture is not None:
        write_dataset(output, dataset)
        click.echo(f"results  {printable(output)}", err=as_json)
        draw(dataset, None, picture, err=as_json)
    if as_json:
        fields = {"x", "y"} & set(map(str, dataset.dims))
        click.echo(json.dumps(_for_programs(dataset.drop_dims(fields).to_dict()), default=str))
    else:
        _show(dataset)
    for doubt in filter(None, dataset.attrs.get("validity", "").splitlines()):
        say("gfmd:", doubt, width=6, err=True)


def _for_programs(value: Any) -> Any:
    """Value of a dictionary as JSON takes it, which knows no numbers but finite ones: others become null."""
    if isinstance(value, dict):
        return {str(key): _for_programs(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_for_programs(inner) for inner in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def _show(dataset: xr.Dataset) -> None:
    """Print what is one number a contact, or one for each step of a path."""
    cells = {words: values for name in _SHOWN if name in dataset for words, values in _cells(dataset, name)}
    if "step" in dataset.dims:
        print_table("steps of the path", {"step": [str(step) for step in range(dataset.sizes["step"])]}, cells)
        return
    for words, (value,) in cells.items():
        click.echo(printable(f"{words:28}{value}"))


def _cells(dataset: xr.Dataset, name: str) -> list[tuple[str, list[str]]]:
    """Words and cells of a variable, by direction where it has one."""
    words, free = _SHOWN[name]
    variable = dataset[name]
    unit = variable.attrs["units"].replace("m-1", "1/m") if variable.attrs["units"] != "1" else free
    if "direction" in variable.dims:
        parts = [(f"{words} along {each}", variable.sel(direction=each)) for each in ("x", "y")]
    else:
        parts = [(words, variable)]
    return [(text, [_cell(name, value, unit) for value in part.values.ravel().tolist()]) for text, part in parts]


def _cell(name: str, value: float, unit: str) -> str:
    if name.endswith("_connects"):
        return "yes" if value else "no"
    number, shown = readable(value, unit)
    return f"{float(number):.5g} {shown}".rstrip()
