"""Commands on a solved contact: the fields in its body, its distributions, what leaks and what it conducts."""

from __future__ import annotations

import json
from collections.abc import Callable
from contextlib import contextmanager, suppress
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gfmd_numba.cli.arguments import NEW_FILE, file_argument, json_option, output_option
from gfmd_numba.cli.fits import naming
from gfmd_numba.cli.group import main
from gfmd_numba.cli.outputs import check_output, picture_path, pictures, write, write_picture
from gfmd_numba.cli.tables import readable
from gfmd_numba.cli.terminal import say, tell, waiting, warn_of_doubts
from gfmd_numba.cli.told import of_measures
from gfmd_numba.text.input_error import InputError
from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    from collections.abc import Iterator

    import xarray as xr


_files_option = click.option(
    "-o",
    "--output",
    type=NEW_FILE,
    help="netCDF file to write, with a picture (.png) of the same name",
)


@main.command()
@file_argument
@output_option
@click.option("--body", default="body", show_default=True, help="Body to look into: body or counter_body")
@click.option("--x", metavar="LENGTH", help="Below a map: the vertical section at this x, like 20um")
@click.option("--y", metavar="LENGTH", help="Below a map: the section at this y  [through the largest stress]")
@click.option("--plane", metavar="Z", multiple=True, help="Below a map: the horizontal plane at this z, like -5um")
def fields(file: Path, output: Path, body: str, x: str | None, y: str | None, plane: tuple[str, ...]) -> None:
    """Compute displacement, strain and stress inside a body.

    FILE is a contact that `gfmd solve` wrote. In addition to the netCDF file, the command writes a picture (.png) of
    the same name. Below a map, the fields are on a vertical section, or on horizontal planes.
    """
    import gfmd_numba
    from gfmd_numba.analysis import plot_body
    from gfmd_numba.campaign.results import read_results

    picture = picture_path(output)
    check_output(output, file)
    contact = read_results(file)
    at_x, at_y = (None if given is None else place(contact, name, given) for name, given in (("x", x), ("y", y)))
    planes = [place(contact, "plane", given) for given in plane] or None
    with in_words_of_options(file), waiting("computing the fields"):
        dataset = gfmd_numba.body_fields(contact, body=body, x=at_x, y=at_y, planes=planes)
    write(output, dataset, "fields")
    with naming(file):
        write_picture(picture, lambda: plot_body(dataset))
    if "peak_von_mises" in dataset:
        say("largest", largest_stress(dataset), width=9)


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
    """Compute something of the contact in a file, write and draw it if an output is given, and print its numbers."""
    from gfmd_numba.campaign.results import read_results

    picture = None if output is None else picture_path(output)
    if output is not None:
        check_output(output, file)
    contact = read_results(file)
    with in_words_of_options(file), naming(file), waiting(doing):
        dataset = compute(contact)
    if output is not None and picture is not None:
        write(output, dataset, err=as_json)
        for path, drawing in pictures(dataset, None, picture).items():
            write_picture(path, drawing, err=as_json)
    if as_json:
        fields = {"x", "y"} & set(map(str, dataset.dims))
        click.echo(json.dumps(_for_programs(dataset.drop_dims(fields).to_dict()), default=str))
    else:
        tell(of_measures(dataset))
    warn_of_doubts(dataset)


def _for_programs(value: Any) -> Any:
    """Return a value of a dictionary as JSON takes it; numbers that are not finite become null."""
    if isinstance(value, dict):
        return {str(key): _for_programs(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_for_programs(inner) for inner in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def place(contact: xr.Dataset, option: str, text: str) -> float:
    """Return a length like `-5um` or `-5e-6` in the unit of x of a contact; raises InputError for anything else."""
    from pydantic_core import PydanticCustomError

    from gfmd_numba.scene.document import plain_scalar
    from gfmd_numba.scene.units import LENGTH

    in_metres = "x" not in contact.variables or contact["x"].attrs.get("units") != "1"
    allowed = "a length like 5um, or a number in m" if in_metres else "a number in L_x, as the scene has no length"
    number: object = plain_scalar(text.strip())
    with suppress(PydanticCustomError):
        if in_metres and not isinstance(number, (int, float)):
            number = LENGTH.si_value(text)
    if not isinstance(number, (int, float)) or isinstance(number, bool) or not isfinite(number):
        raise InputError(f"--{option}: you gave {text!r}; gfmd allows {allowed}")
    return float(number)


@contextmanager
def in_words_of_options(file: Path) -> Iterator[None]:
    """Name the file, and the options, in errors about the arguments of `gfmd_numba.body_fields`."""
    wheres = {"contact": printable(file), "body": "--body", "x": "--x", "y": "--y", "planes": "--plane"}
    try:
        yield
    except InputError as error:
        argument, colon, said = str(error).partition(": ")
        raise InputError(f"{wheres.get(argument, argument)}{colon}{said}") from None


def largest_stress(dataset: xr.Dataset) -> str:
    """Return the largest von Mises stress below a map and its place, in the last step of a path."""
    last, when = (dataset.isel(step=-1), ", in the last step,") if "step" in dataset.dims else (dataset, "")
    peaks = last["peak_von_mises"].values
    if not all(map(isfinite, peaks.ravel().tolist())):
        return "unknown, as the run is not ok"
    level = last.isel(z=int(peaks.argmax()))
    stress = " ".join(readable(float(peaks.max()), _unit(level["peak_von_mises"], "E*")))
    places = {"x": level["peak_x"], "y": level["peak_y"], "z": level["z"]}
    at = ", ".join(f"{name} = {' '.join(readable(float(v), _unit(v, 'L_x')))}" for name, v in places.items())
    return f"von Mises stress of these depths{when} {stress} at {at}"


def _unit(variable: xr.DataArray, natural: str) -> str:
    unit = str(variable.attrs["units"])
    return natural if unit == "1" else unit
