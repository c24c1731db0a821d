"""Commands that make one contact or one surface, and those on a solved contact: fields, distributions, leakage."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from math import inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from gfmd_numba.cli import arguments
from gfmd_numba.cli.fits import naming
from gfmd_numba.cli.group import INTERRUPTED, SOME_FAILED, main
from gfmd_numba.cli.mpi import mpi_option, of_the_first
from gfmd_numba.cli.outputs import check_output, companion, pictures, say_written, write, write_picture
from gfmd_numba.cli.tables import columns_of_measures, endings, named, of_results, over, states, unit, unit_of
from gfmd_numba.cli.terminal import say, say_doubts, tell, waiting, warn
from gfmd_numba.text.input_error import InputError
from gfmd_numba.text.numbers import with_prefix
from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    import xarray as xr

    from gfmd_numba.arrays.processes import Communicator
    from gfmd_numba.scene import Document, SceneFile

_MOST = 10_000
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_DECIMAL_COMMA = re.compile(r"\s*\d+,\d+\s*[^\d\s,.:eE][^,:]*")  # or two values, of which the second has a unit
_NUMBER_AND_UNIT = re.compile(rf"{_NUMBER.pattern}\s*(?P<unit>[^\d\s,.].*)")
_ARGUMENTS = {"body": "--body", "x": "--x", "y": "--y", "planes": "--plane"}  # of `gfmd_numba.body_fields`
_ARGUMENTS |= {name: f"--{name}" for name in ("viscosity", "pressure", "seal", "conductivity")}
_ARGUMENTS |= {name: f"--{name}" for name in ("loads", "times", "speeds", "realisations")}


@main.command()
@arguments.file_argument
@arguments.threads_option
@mpi_option
@arguments.output_option
def solve(file: Path, threads: int | None, mpi: Communicator | None, output: Path) -> None:
    """Solve the contact or the loaded body in a scene FILE.

    The command writes height, pressure, displacement and gap over x. It also writes and prints contact area, mean gap
    and other numbers of the whole contact. If the run does not converge, its `status` says so and the command exits
    with 3.
    """
    from gfmd_numba.scene import input_files, load_scene
    from gfmd_numba.simulate import solve as solve_file
    from gfmd_numba.simulate import solve_in_processes

    def read() -> tuple[SceneFile, Document]:
        described, document = _with_threads(*load_scene(file), threads)
        check_output(output, file, *input_files(described))
        return described, document

    described, document = read() if mpi is None else of_the_first(mpi, read)
    tells = described.path or described.scene.body.plasticity
    total = 1 + len(described.path) if tells else None
    with waiting("solving", total) as told:
        found = solve_file(described, document, told) if mpi is None else solve_in_processes(described, document, mpi)
    if found is None:  # the first process has it
        return
    write(output, found)
    _tell(found)
    steps = found if "step" in found.dims else found.expand_dims("step")
    last = steps.isel(step=-1)  # a path ends at its first step that is not ok
    if int(last["status"]):
        number, n_steps = steps.sizes["step"] - 1, len(described.path)
        where = f" in step {number} of {n_steps}, which ends the path" if n_steps else ""
        meaning = states(last["status"])[int(last["status"])]
        ending = f"{meaning} after {int(last['n_iterations'])} iterations"
        if meaning in ("steps_used_up", "stagnated"):
            ending += f" at a residual of {float(last['residual']):.1e}"
        elif meaning == "unstable":
            ending += f" with wave {int(last['growing_wave'])} growing"
        warn(f"the run ended as {ending}{where}: do not use its numbers")
        _explain(steps)
        sys.exit(SOME_FAILED)


def _tell(dataset: xr.Dataset) -> None:
    """Print what came out, what was done to measured surfaces, and the reasons to doubt it."""
    tell(of_results(dataset, None))
    _say_done(dataset)


def _say_done(dataset: xr.Dataset) -> None:
    for sentence in dataset.attrs.get("processing", "").splitlines():
        say("done", sentence)
    say_doubts(dataset)


def _explain(dataset: xr.Dataset) -> None:
    """Print what it means that runs are not ok."""
    for _, _, sentence in endings(dataset["status"]):
        warn(sentence)


def _with_threads(described: SceneFile, document: Document, threads: int | None) -> tuple[SceneFile, Document]:
    """What a file describes, solved by so many threads if a number is given, as if it stood in the file."""
    if threads is None or not isinstance(document.data, dict):
        return described, document
    numerics = {**(document.data.get("numerics") or {}), "threads": threads}
    asked = described.model_copy(update={"numerics": described.numerics.model_copy(update={"threads": threads})})
    return asked, replace(document, data=document.data | {"numerics": numerics})


@main.command()
@arguments.file_argument
@arguments.output_option
def surface(file: Path, output: Path) -> None:
    """Make the rough surface described in FILE.

    The command writes and draws the heights, and their spectrum, autocorrelation and height distribution with
    those of theory. The picture (.png) has the name of the netCDF file.
    """
    from gfmd_numba.analysis import plot_surface
    from gfmd_numba.scene.measured_record import Measured
    from gfmd_numba.scene.surface_file import load_surface
    from gfmd_numba.simulate.surface import surface_dataset

    picture = companion(output, "picture", ".png")
    described, document = load_surface(file)
    measured = described.surface
    check_output(output, file, *([Path(measured.file)] if isinstance(measured, Measured) and measured.file else []))
    with waiting("making the surface"):
        dataset = surface_dataset(described, document)
    write(output, dataset, "surface")
    write_picture(picture, lambda: plot_surface(dataset))
    _tell(dataset)


def _values_given(ctx: click.Context, param: click.Parameter, option: str | None) -> list[object] | None:
    """Return the values of a list `a,b,c`, or of a range `A:B:N` of N values evenly spaced in their logarithm.

    A unit of the last alone is that of all. Whatever is no number with a unit or without is returned as it is: the
    curve refuses it.
    """
    from gfmd_numba.scene.document import plain_scalar

    if option is None:
        return None
    if _DECIMAL_COMMA.fullmatch(option):
        written = option.replace(",", "."), option.replace(",", ", ")
        raise arguments.not_allowed(repr(option), "{}, or two values with a blank between them: '{}'".format(*written))
    *ends, count = option.split(":")
    if not ends and not re.search(r"\d\s*-\s*\d", option):
        return [plain_scalar(text) for text in _with_unit_of_last(option.split(","))]
    many = count.strip()
    if len(ends) != 2 or not (many.isdecimal() and many.isascii() and len(many) < 6 and 2 <= int(many) <= _MOST):
        raise arguments.not_allowed(repr(option), f"A:B:N with N from 2 to {_MOST}, or a list a,b,c")
    ends = _with_unit_of_last(ends)
    (first, unit_of_first), (last, si), n = *map(_with_si_unit, ends), int(many)
    if first is None or last is None:
        return list(ends)
    if unit_of_first != si:
        raise arguments.not_allowed(repr(option), "two ends with units of one kind, or both without")
    if not (0.0 < first < inf and 0.0 < last < inf and first != last):
        logarithm = "two different ends above 0, as steps are even in the logarithm, or a list a,b,c"
        raise arguments.not_allowed(repr(option), logarithm)
    inner = [first * (last / first) ** (i / (n - 1)) for i in range(1, n - 1)]
    return [*ends[:1], *(with_prefix(value, si, 12) for value in inner), ends[1]] if si else [first, *inner, last]


def _with_unit_of_last(values: list[str]) -> list[str]:
    """Return the values, with the unit of the last one if the others are numbers alone."""
    *others, last = (value.strip() for value in values)
    found = _NUMBER_AND_UNIT.fullmatch(last)
    if found is None or _NUMBER.fullmatch(last) or not all(map(_NUMBER.fullmatch, others)):
        return [*others, last]
    return [*(f"{other} {found['unit']}" for other in others), last]


def _values_option(name: str, what: str) -> Callable[[Any], Any]:
    return click.option(name, callback=_values_given, metavar="A:B:N", help=what)


def _with_si_unit(text: str) -> tuple[float | None, str]:
    """Return a number and its SI unit, empty without one; None for a text that is no number."""
    from pydantic_core import PydanticCustomError

    from gfmd_numba.scene.document import plain_scalar
    from gfmd_numba.scene.units import QUANTITIES

    number = plain_scalar(text.strip())
    if type(number) in (int, float):
        return float(number), ""  # type: ignore[arg-type]
    for quantity in QUANTITIES:
        with suppress(PydanticCustomError):  # a unit of another quantity, or of none
            return quantity.si_value(text), quantity.si
    return None, ""


@main.command()
@arguments.file_argument
@_values_option("--loads", "N loads from A to B, evenly spaced in their logarithm, like 1MPa:1GPa:20; or a list a,b,c")
@_values_option(
    "--times",
    "In place of loads, N times from A to B under the load of the scene, like 1s:1h:20, for a viscoelastic body",
)
@_values_option(
    "--speeds", "In place of loads, N sliding speeds from A to B, like 1um/s:1m/s:30, of a punch on a viscoelastic body"
)
@click.option("--realisations", default=1, show_default=True, help="Number of random surfaces to average over")
@arguments.threads_option
@arguments.output_option
def curve(
    file: Path,
    loads: list[object] | None,
    times: list[object] | None,
    speeds: list[object] | None,
    realisations: int,
    threads: int | None,
    output: Path,
) -> None:
    """Solve the scene in FILE at one load, time or speed after another.

    The command prints and draws contact area, mean gap, stiffness and peak pressure over the load. A load without a
    unit is what the loading of the scene prescribes, like a reduced pressure p/(g E*) or a displacement of the punch.
    In addition to the netCDF file, the command writes a table (.csv) and a picture (.png) of the same name.
    """
    from gfmd_numba.scene import input_files, load_scene
    from gfmd_numba.scene.units import given_with_units
    from gfmd_numba.simulate.curve import curve_dataset, one_of, read_curve, solve_curve
    from gfmd_numba.storage.atomic_file import write_table

    what, values = one_of({"loads": loads, "times": times, "speeds": speeds})
    picture, table = companion(output, "picture", ".png"), companion(output, "table", ".csv")
    described, document = _with_threads(*load_scene(file), threads)
    loading = described.scene.loading
    unit = next((value.unit for place, value in given_with_units(loading) if place[-1] == loading.control), "")
    if unit and loads and all(isinstance(load, int | float) for load in loads):
        written = ", ".join(f"{load:.6g}{unit}" for load in loads[:2])
        raise arguments.not_allowed("--loads without a unit", f"units, as loading has one in {file}: {written}, ...")
    check_output(output, file, *input_files(described))
    for path in (picture, table):
        check_output(path, file, *input_files(described), suffixes=[path.suffix])
    with arguments.told_as(_ARGUMENTS):
        asked = read_curve(described, document, what, values, realisations)
    solved: list[xr.Dataset] = []
    try:
        with waiting(f"solving {what}", len(asked.loads) * realisations) as advance:
            for step in solve_curve(asked, advance):
                solved.append(step)
    except KeyboardInterrupt:
        if not solved:
            warn("interrupted before the first load was solved; nothing is written")
            sys.exit(INTERRUPTED)
    dataset = curve_dataset(asked, solved)
    write(output, dataset)
    write_table(table, columns(dataset))
    say_written("table", table)
    _draw(dataset, picture)
    _tell(dataset)
    _end(dataset, realisations)


def _draw(dataset: xr.Dataset, picture: Path) -> None:
    from gfmd_numba.analysis import plot_curve
    from gfmd_numba.storage.atomic_file import remove
    from gfmd_numba.storage.mark import is_product

    if not (dataset["n_realisations"] > 0).any():
        remove(picture, is_product)  # that of an earlier curve
        warn("no load has a result that could be drawn")
        return
    write_picture(picture, lambda: plot_curve(dataset))


def _end(dataset: xr.Dataset, realisations: int) -> None:
    """Say which loads are not to be used, or that the curve was interrupted; exit with 3 or 130 then."""
    failed = dataset["status"].values != 0
    if failed.any():
        loads = ", ".join(f"{load:.4g}" for load in dataset[over(dataset)].values[failed])
        left = "they are left out" if realisations == 1 else "the surfaces that failed are left out there"
        warn(f"not ok at {over(dataset).removeprefix('prescribed_')} {loads}: {left}")
        _explain(dataset)
    if "interrupted" in dataset.attrs:
        told = f"interrupted {dataset.attrs['interrupted']}; the files hold these loads; the same command begins again"
        warn(told)
        sys.exit(INTERRUPTED)
    if failed.any():
        sys.exit(SOME_FAILED)


def columns(dataset: xr.Dataset) -> dict[str, list[object]]:
    """Return the columns of the table as in the netCDF file, by name and unit."""
    (prescribed, view), load = named(dataset), over(dataset)
    names = [str(name) for name in (load, *dataset.data_vars)]
    units = {name: unit(view, name.removesuffix("_standard_error")) for name in names} | {load: unit(view, prescribed)}
    return {f"{name} ({units[name] or '1'})": dataset[name].values.tolist() for name in names}


_files_option = click.option(
    "-o",
    "--output",
    type=arguments.NEW_FILE,
    help="netCDF file to write, with a picture (.png) and for a path a table (.csv) of the same name",
)


@main.command()
@arguments.file_argument
@arguments.output_option
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
    from gfmd_numba.analysis.forms import by_layer

    picture = companion(output, "picture", ".png")
    check_output(output, file)
    contact = _contact(file)
    at_x, at_y = (None if given is None else place(contact, name, given) for name, given in (("x", x), ("y", y)))
    planes = [place(contact, "plane", given) for given in plane] or None
    with arguments.told_as(_ARGUMENTS | {"contact": printable(file)}), waiting("computing the fields"):
        dataset = gfmd_numba.body_fields(contact, body=body, x=at_x, y=at_y, planes=planes)
    write(output, dataset, "fields")
    with naming(file):
        write_picture(picture, lambda: plot_body(dataset))
    layers = by_layer(dataset["z"].values)
    for number, layer in enumerate(layers, 1):
        name = "largest" if len(layers) == 1 else f"layer {number}"
        say(name, largest_stress(dataset.isel(z=layer)), width=9)


@main.command()
@arguments.file_argument
@arguments.output_option
@click.option(
    "--percolation", is_flag=True, help="Find out whether channels lead across a map, and how narrow they are"
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
@arguments.file_argument
@_files_option
@arguments.json_option
@click.option("--viscosity", metavar="ETA", help="Viscosity of the fluid, like '1 mPa s': prints the flow")
@click.option("--pressure", metavar="P", help="How much the pressure of the fluid falls, like '2 bar'")
@click.option(
    "--seal", nargs=2, metavar="L W", help="Length of a seal along the flow, and its width  [those of the map]"
)
def leakage(file: Path, output: Path | None, as_json: bool, **fluid: Any) -> None:
    """Compute how much leaks through the gap of a contact.

    FILE is a contact that `gfmd solve` wrote. The command solves the Reynolds equation along x and along y, and prints
    hydraulic gap and flow factor. The picture shows the channels. The grooves of a profile go on without end along y.
    """
    from gfmd_numba.scene.document import plain_scalar
    from gfmd_numba.simulate.transport import leakage as leakage_of

    given = {name: value for name, value in fluid.items() if value}
    for name, value in given.items():
        for text in value if isinstance(value, tuple) else (value,):
            if isinstance(plain_scalar(text), int | float):
                raise arguments.not_allowed(
                    f"{text} for --{name}", "a value with its unit, like '1 mPa s', '2 bar', 1mm"
                )

    _measure(file, output, lambda contact: leakage_of(contact, **given), "computing the flow", as_json)


@main.command()
@arguments.file_argument
@_files_option
@arguments.json_option
@click.option(
    "--conductivity",
    multiple=True,
    metavar="SIGMA",
    help="Conductivity of both bodies, or twice for one each, like '60 MS/m' or '16 W/m/K': prints the resistance",
)
def conductance(file: Path, output: Path | None, as_json: bool, conductivity: tuple[str, ...]) -> None:
    """Compute the electrical or thermal conductance of a contact.

    FILE is a contact that `gfmd solve` wrote. The command prints the conductance of the touching spots per nominal area
    over the conductivity of the bodies. The picture shows the current.
    """
    from gfmd_numba.simulate.transport import contact_conductance

    def compute(contact: xr.Dataset) -> xr.Dataset:
        return contact_conductance(contact, conductivity or None)

    _measure(file, output, compute, "computing the current", as_json)


def _contact(file: Path) -> xr.Dataset:
    """Return the contact in a file; raises InputError for a curve, which has no fields."""
    from gfmd_numba.campaign.results import read_results

    found = read_results(file)
    if "prescribed" in found.attrs:
        what = f"{file}, a curve, which has no fields"
        told = "results of `gfmd solve`: for several loads, give its scene a path: [{pressure: 2 MPa}, ...]"
        raise InputError.of("FILE", what, told)
    return found


def _measure(
    file: Path, output: Path | None, compute: Callable[[xr.Dataset], xr.Dataset], doing: str, as_json: bool = False
) -> None:
    """Compute something of the contact in a file, write and draw it if an output is given, and print its numbers."""
    from pydantic_core import to_jsonable_python

    from gfmd_numba.storage.atomic_file import write_table

    if output is not None:
        picture = companion(output, "picture", ".png")
        check_output(output, file)
    contact = _contact(file)
    if has_table := output is not None and "step" in contact.dims:
        table = companion(output, "table", ".csv")
    with arguments.told_as(_ARGUMENTS | {"contact": printable(file)}), naming(file), waiting(doing):
        dataset = compute(contact)
    if output is not None:
        write(output, dataset, err=as_json)
        for path, drawing in pictures(dataset, None, picture).items():
            write_picture(path, drawing, err=as_json)
    if has_table:
        write_table(table, columns_of_measures(dataset))
        say_written("table", table, err=as_json)
    if as_json:
        fields = {"x", "y"} & set(map(str, dataset.dims))
        found = to_jsonable_python(dataset.drop_dims(fields).to_dict(), inf_nan_mode="null", fallback=str)
        click.echo(json.dumps(found))  # null stands for numbers that are not finite
        _say_done(dataset)
    else:
        _tell(dataset)


def place(contact: xr.Dataset, option: str, text: str) -> float:
    """Return a length like `-5um` in the unit of x of a contact; raises InputError for anything else."""
    in_metres = "x" not in contact.variables or contact["x"].attrs.get("units") != "1"
    number, unit = _with_si_unit(text)
    if number is None or unit != ("m" if in_metres else "") or not isfinite(number):
        allowed = "a length with its unit, like 5um" if in_metres else "a number in L_x, as the scene has no length"
        raise InputError.of(f"--{option}", repr(text), allowed)
    return number


def largest_stress(dataset: xr.Dataset) -> str:
    """Return the largest von Mises stress below a contact and its place, in the last step of a path."""
    last, when = (dataset.isel(step=-1), ", in the last step,") if "step" in dataset.dims else (dataset, "")
    places = {"x": "peak_x", "y": "peak_y", "z": "z"}
    if "peak_von_mises" not in last:  # of a profile
        along = last["von_mises"].fillna(0.0).argmax("x")
        last = last.assign(
            peak_von_mises=last["von_mises"].max("x", skipna=False, keep_attrs=True), peak_x=last["x"][along]
        )
        del places["y"]
    peaks = last["peak_von_mises"].values
    if not all(map(isfinite, peaks.ravel().tolist())):
        return "unknown, as the run is not ok"
    level = last.isel(z=int(peaks.argmax()))
    stress = with_prefix(float(peaks.max()), unit_of(level, "peak_von_mises", "E*"), 6)
    at = (f"{axis} = {with_prefix(float(level[v]), unit_of(level, v, 'L_x'), 6)}" for axis, v in places.items())
    return f"von Mises stress of these depths{when} {stress} at {', '.join(at)}"
