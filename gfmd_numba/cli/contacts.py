"""Commands that make one contact or one surface."""

from __future__ import annotations

import sys
import warnings
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from gfmd_numba.cli.arguments import file_argument, output_option, threads_option
from gfmd_numba.cli.group import INTERRUPTED, SOME_FAILED, main, without_collections
from gfmd_numba.cli.outputs import check_output, companion, picture_path, say_written, write, write_picture
from gfmd_numba.cli.tables import endings, unit
from gfmd_numba.cli.terminal import say, tell, waiting, warn, warn_of_doubts
from gfmd_numba.cli.told import named, of_contact, of_curve, of_numbers, of_steps, over, prescribed

if TYPE_CHECKING:
    import xarray as xr

    from gfmd_numba.scene import BoundaryFile, Document, SceneFile
    from gfmd_numba.scene.units import Quantity
    from gfmd_numba.simulate.curve import Over

    File = TypeVar("File", SceneFile, BoundaryFile, SceneFile | BoundaryFile)


@main.command()
@file_argument
@threads_option
@output_option
def solve(file: Path, threads: int | None, output: Path) -> None:
    """Solve the contact or the loaded body in a scene FILE.

    The command writes height, pressure, displacement and gap over x. It also writes and prints contact area, mean gap
    and other numbers of the whole contact. If the run does not converge, its `status` says so and the command exits
    with 3.
    """
    with without_collections():
        from gfmd_numba.scene import SceneFile, input_files, load_scene
        from gfmd_numba.simulate import solve as solve_file

    described, document = load_scene(file)
    described, document = _with_threads(described, document, threads)
    check_output(output, file, *input_files(described))
    # warnings are told below, in the words of the file
    with waiting("solving"), warnings.catch_warnings(action="ignore", category=UserWarning):
        dataset = solve_file(described, document)
    write(output, dataset)
    steps = dataset if "step" in dataset.dims else dataset.expand_dims("step")
    if "step" in dataset.dims:
        tell(of_steps(dataset))
    else:
        tell(of_contact(dataset))
    warn_of_doubts(dataset)
    last = steps.isel(step=-1)  # a path ends at its first step that is not ok
    if int(last["status"]):
        number, n_steps = steps.sizes["step"] - 1, len(described.path) if isinstance(described, SceneFile) else 0
        where = f" in step {number} of {n_steps}, which ends the path" if n_steps else ""
        warn(f"the run ended as {_ending(last)}{where}: do not use its numbers")
        for _, sentence in endings(steps["status"]):
            warn(sentence)
        sys.exit(SOME_FAILED)


def _with_threads(described: File, document: Document, threads: int | None) -> tuple[File, Document]:
    """What a file describes, solved by so many threads if a number is given, as if it stood in the file."""
    if threads is None or not isinstance(document.data, dict):
        return described, document
    numerics = {**(document.data.get("numerics") or {}), "threads": threads}
    asked = described.model_copy(update={"numerics": described.numerics.model_copy(update={"threads": threads})})
    return asked, replace(document, data=document.data | {"numerics": numerics})


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
    tell(of_numbers(dataset))
    for sentence in filter(None, dataset.attrs["processing"].split("\n")):
        say("done", sentence)
    warn_of_doubts(dataset)


_MOST = 10_000


def _values_given(ctx: click.Context, param: click.Parameter, option: str | None) -> list[float | str] | None:
    """Return the values of a list `a,b,c`, or of a range `A:B:N` of N values evenly spaced in their logarithm."""
    if option is None:
        return None
    name = str(param.name)
    ends, read = option.split(":"), {"loads": _load, "times": _time, "speeds": _speed}[name]
    if len(ends) == 1:
        loads = [read(text) for text in option.split(",")]
        if len({si for _, si in loads}) > 1:
            raise click.BadParameter(f"you gave {option!r}; gfmd allows {name} with units of one kind, or all without")
        return [_text(*load) for load in loads]
    count = ends[-1].strip()
    if len(ends) != 3 or not (count.isdecimal() and count.isascii() and len(count) < 6 and 2 <= int(count) <= _MOST):
        raise click.BadParameter(f"you gave {option!r}; gfmd allows A:B:N with N from 2 to {_MOST}, or a list a,b,c")
    (first, unit_of_first), (last, si), n = read(ends[0]), read(ends[1]), int(count)
    if unit_of_first != si:
        raise click.BadParameter(f"you gave {option!r}; gfmd allows two ends with units of one kind, or both without")
    if not (first > 0.0 and last > 0.0 and first != last):
        raise click.BadParameter(f"you gave {option!r}; gfmd allows two different ends above 0, or a list a,b,c")
    inner = [first * (last / first) ** (i / (n - 1)) for i in range(1, n - 1)]
    return [_text(load, si) for load in (first, *inner, last)]


def _load(text: str) -> tuple[float, str]:
    """Return one load and its SI unit; without a unit, a number in what the loading of the scene prescribes."""
    from gfmd_numba.scene.document import plain_scalar
    from gfmd_numba.scene.loading import Loading, control_of, load_meant
    from gfmd_numba.scene.units import quantities

    control, number, si = control_of(text), plain_scalar(text.strip()), ""
    if control is not None:
        quantity = quantities(Loading)[control]
        number, si = quantity.si_value(text), quantity.si
    if type(number) not in (int, float) or not -inf < float(number) < inf:  # type: ignore[arg-type]
        hint = load_meant(text)
        told = f"you gave {text!r}; gfmd allows a finite number, like 0.01 or 1 MPa"
        raise click.BadParameter(f"{told}; {hint}" if hint else told)
    return float(number), si  # type: ignore[arg-type]


def _time(text: str) -> tuple[float, str]:
    """Return one time in s and its SI unit; nothing without a unit."""
    from gfmd_numba.scene.units import TIME

    return _above_0(text, TIME, "a number of s above 0 or a time, like 10 or 5 min")


def _speed(text: str) -> tuple[float, str]:
    """Return one speed and its SI unit; nothing without a unit."""
    from gfmd_numba.scene.units import SPEED

    return _above_0(text, SPEED, "a number above 0 or a speed, like 1e-3 or 1 mm/s")


def _above_0(text: str, quantity: Quantity, allowed: str) -> tuple[float, str]:
    """Return a number above 0 and the SI unit of its quantity; nothing without a unit."""
    from gfmd_numba.scene.document import plain_scalar

    number = plain_scalar(text.strip())
    if type(number) in (int, float) and 0.0 < float(number) < inf:  # type: ignore[arg-type]
        return float(number), ""  # type: ignore[arg-type]
    try:
        value = quantity.si_value(text)
    except ValueError:
        value = None
    if value is None or not 0.0 < value < inf:
        raise click.BadParameter(f"you gave {text!r}; gfmd allows {allowed}")
    return value, quantity.si


def _text(load: float, si: str) -> float | str:
    return f"{load!r} {si}" if si else load


@main.command()
@file_argument
@click.option(
    "--loads",
    callback=_values_given,
    metavar="A:B:N",
    help="N loads from A to B, evenly spaced in their logarithm, like 1MPa:1GPa:20; or a list a,b,c",
)
@click.option(
    "--times",
    callback=_values_given,
    metavar="A:B:N",
    help="In place of loads, N times from A to B under the load of the scene, like 1s:1h:20, for a viscoelastic body",
)
@click.option(
    "--speeds",
    callback=_values_given,
    metavar="A:B:N",
    help="In place of loads, N sliding speeds from A to B, like 1um/s:1m/s:30, of a punch on a viscoelastic body",
)
@click.option("--realisations", default=1, show_default=True, help="Number of random surfaces to average over")
@threads_option
@output_option
def curve(
    file: Path,
    loads: list[float | str] | None,
    times: list[float | str] | None,
    speeds: list[float | str] | None,
    realisations: int,
    threads: int | None,
    output: Path,
) -> None:
    """Solve the scene in FILE at one load, time or speed after another.

    The command prints and draws contact area, mean gap, stiffness and peak pressure over the load. A load without a
    unit is what the loading of the scene prescribes, like a reduced pressure p/(g E*) or a displacement of the punch.
    In addition to the netCDF file, the command writes a table (.csv) and a picture (.png) of the same name.
    """
    with without_collections():
        from gfmd_numba.scene import input_files, load_scene
        from gfmd_numba.simulate.curve import curve_dataset, read_curve, solve_curve
        from gfmd_numba.storage.atomic_file import write_table

    options: dict[Over, list[float | str] | None] = {"loads": loads, "times": times, "speeds": speeds}
    asked_for = {name: each for name, each in options.items() if each}
    if len(asked_for) != 1:
        given = " and ".join(f"--{name}" for name in asked_for) or "none"
        raise click.UsageError(f"you gave {given} of --loads, --times and --speeds; gfmd allows one of them")
    ((what, values),) = asked_for.items()
    picture, table = picture_path(output), companion(output, "table", ".csv")
    described, document = load_scene(file)
    described, document = _with_threads(described, document, threads)
    check_output(output, file, *input_files(described))
    for path in (picture, table):
        check_output(path, file, *input_files(described), suffixes=[path.suffix])
    asked = read_curve(described, document, what, values, realisations)
    solved: list[xr.Dataset] = []
    try:
        with waiting(f"solving {what}", len(asked.loads) * realisations) as advance:
            for step in solve_curve(asked):
                solved.append(step)
                advance()
    except KeyboardInterrupt:
        if not solved:
            warn("interrupted before the first load was solved; nothing is written")
            sys.exit(INTERRUPTED)
    dataset = curve_dataset(asked, solved)
    write(output, dataset)
    write_table(table, columns(dataset))
    say_written("table", table)
    _draw(dataset, picture)
    tell(of_curve(dataset))
    warn_of_doubts(dataset)
    _end(dataset, realisations)


def _draw(dataset: xr.Dataset, picture: Path) -> None:
    from gfmd_numba.analysis import plot_creep, plot_curve, plot_friction
    from gfmd_numba.storage.atomic_file import remove
    from gfmd_numba.storage.mark import is_product

    if not (dataset["n_realisations"] > 0).any():
        remove(picture, is_product)  # that of an earlier curve
        warn("no load has a result that could be drawn")
        return
    draw = {"time": plot_creep, "speed": plot_friction}.get(over(dataset), plot_curve)
    write_picture(picture, lambda: draw(dataset))


def _end(dataset: xr.Dataset, realisations: int) -> None:
    """Say which loads are not to be used, or that the curve was interrupted; exit with 3 or 130 then."""
    failed = dataset["status"].values != 0
    if failed.any():
        loads = ", ".join(f"{load:.4g}" for load in dataset[over(dataset)].values[failed])
        left = "they are left out" if realisations == 1 else "the surfaces that failed are left out there"
        warn(f"not ok at {over(dataset).removeprefix('prescribed_')} {loads}: {left}")
        for _, sentence in endings(dataset["status"]):
            warn(sentence)
    if "interrupted" in dataset.attrs:
        told = f"interrupted {dataset.attrs['interrupted']}; the files hold these loads; the same command begins again"
        warn(told)
        sys.exit(INTERRUPTED)
    if failed.any():
        sys.exit(SOME_FAILED)


def columns(dataset: xr.Dataset) -> dict[str, list[object]]:
    """Return the columns of the table as in the netCDF file, by name and unit."""
    view = named(dataset)
    load = over(dataset)
    names = [str(name) for name in (load, *dataset.data_vars)]
    units = {
        name: unit(view, prescribed(dataset) if name == load else name.removesuffix("_standard_error"))
        for name in names
    }
    return {f"{name} ({units[name] or '1'})": dataset[name].values.tolist() for name in names}
