"""The command that says more of a solved contact: distributions, and percolation, leakage, conductance where asked."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from gfmd_numba.cli.arguments import check_output, file_argument, picture_beside
from gfmd_numba.cli.columns import print_table
from gfmd_numba.cli.fits import naming
from gfmd_numba.cli.group import main
from gfmd_numba.cli.progress import waiting
from gfmd_numba.cli.readable import readable
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


@main.command()
@file_argument
@click.option(
    "-o", "--output", required=True, type=click.Path(dir_okay=False, path_type=Path), help="netCDF file to write"
)
@click.option(
    "--percolation", is_flag=True, help="Find out whether channels connect the sides of a map, and how narrow they are"
)
@click.option("--leakage", is_flag=True, help="Compute the flow through the gap of a map by the Reynolds equation")
@click.option("--conductance", is_flag=True, help="Compute the electrical or thermal conductance of the contact")
def statistics(file: Path, output: Path, percolation: bool, leakage: bool, conductance: bool) -> None:
    """Compute distributions of pressure, gap and contacts.

    FILE is a contact that `gfmd solve` wrote. The command writes and draws the distributions. The picture (.png) has
    the name of the netCDF file.
    """
    import gfmd_numba
    from gfmd_numba.analysis import plot_statistics
    from gfmd_numba.campaign.results import read_results
    from gfmd_numba.storage.atomic_file import write_dataset, write_picture

    picture = picture_beside(output)
    check_output(output, file)
    contact = read_results(file)
    asked = {
        gfmd_numba.gap_percolation: percolation,
        gfmd_numba.leakage: leakage,
        gfmd_numba.contact_conductance: conductance,
    }
    with naming(file), waiting("computing the statistics"):
        dataset = gfmd_numba.contact_statistics(contact)
        for function in (function for function, wanted in asked.items() if wanted):
            dataset = dataset.assign(function(contact).variables)
    write_dataset(output, dataset)
    click.echo(f"results  {printable(output)}")
    with waiting("drawing"):
        write_picture(picture, plot_statistics(dataset), dpi=150)
    click.echo(f"picture  {printable(picture)}")
    _show(dataset)


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
