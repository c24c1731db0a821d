"""The command that takes a scene through loads."""

from __future__ import annotations

import sys
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gfmd_numba.cli.arguments import check_output, companion, file_argument, output_option, picture_path
from gfmd_numba.cli.curve_table import columns, show
from gfmd_numba.cli.group import INTERRUPTED, SOME_FAILED, main
from gfmd_numba.cli.imports import without_collections
from gfmd_numba.cli.progress import counting, waiting
from gfmd_numba.cli.sentences import say
from gfmd_numba.cli.tables import endings
from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    import xarray as xr

_MOST = 10_000


def _load(text: str) -> tuple[float, str]:
    """Return one load and its SI unit; without a unit, a number in what the loading of the scene prescribes."""
    from gfmd_numba.scene.document import plain_scalar
    from gfmd_numba.scene.loading import Loading, control_of, load_meant
    from gfmd_numba.scene.reduced_units import quantities

    control, number, si = control_of(text), plain_scalar(text.strip()), ""
    if control is not None:
        quantity = quantities(Loading)[control]
        number, si = quantity.si_value(text), quantity.si
    if type(number) not in (int, float) or not -inf < float(number) < inf:  # type: ignore[arg-type]
        hint = load_meant(text)
        told = f"you gave {text!r}; gfmd allows a finite number, like 0.01 or 1 MPa"
        raise click.BadParameter(f"{told}; {hint}" if hint else told)
    return float(number), si  # type: ignore[arg-type]


def _loads_given(ctx: click.Context, param: click.Parameter, option: str) -> list[float | str]:
    """Return the loads of a list `a,b,c`, or of a range `A:B:N` of N loads evenly spaced in their logarithm."""
    ends = option.split(":")
    if len(ends) == 1:
        loads = [_load(text) for text in option.split(",")]
        if len({si for _, si in loads}) > 1:
            raise click.BadParameter(f"you gave {option!r}; gfmd allows loads with units of one kind, or all without")
        return [_text(*load) for load in loads]
    count = ends[-1].strip()
    if len(ends) != 3 or not (count.isdecimal() and count.isascii() and len(count) < 6 and 2 <= int(count) <= _MOST):
        raise click.BadParameter(f"you gave {option!r}; gfmd allows A:B:N with N from 2 to {_MOST}, or a list a,b,c")
    (first, unit_of_first), (last, si), n = _load(ends[0]), _load(ends[1]), int(count)
    if unit_of_first != si:
        raise click.BadParameter(f"you gave {option!r}; gfmd allows two ends with units of one kind, or both without")
    if not (first > 0.0 and last > 0.0 and first != last):
        raise click.BadParameter(f"you gave {option!r}; gfmd allows two different ends above 0, or a list a,b,c")
    inner = [first * (last / first) ** (i / (n - 1)) for i in range(1, n - 1)]
    return [_text(load, si) for load in (first, *inner, last)]


def _text(load: float, si: str) -> float | str:
    return f"{load!r} {si}" if si else load


@main.command()
@file_argument
@click.option(
    "--loads",
    required=True,
    callback=_loads_given,
    metavar="A:B:N",
    help="N loads from A to B, evenly spaced in their logarithm, like 1MPa:1GPa:20; or a list a,b,c",
)
@click.option("--realisations", default=1, show_default=True, help="Number of random surfaces to average over")
@output_option
def curve(file: Path, loads: list[float | str], realisations: int, output: Path) -> None:
    """Solve the scene in FILE at one load after another.

    The command prints and draws contact area, mean gap, stiffness and peak pressure over the load. A load without a
    unit is what the loading of the scene prescribes, like a reduced pressure p/(g E*) or a displacement of the punch.
    In addition to the netCDF file, the command writes a table (.csv) and a picture (.png) of the same name.
    """
    with without_collections():
        from gfmd_numba.scene import input_files, load_scene
        from gfmd_numba.simulate.curve import curve_dataset, read_curve, solve_curve
        from gfmd_numba.storage.atomic_file import write_dataset, write_table

    picture, table = picture_path(output), companion(output, "table", ".csv")
    described, document = load_scene(file)
    check_output(output, file, *input_files(described))
    for path in (picture, table):
        check_output(path, file, *input_files(described), suffixes=[path.suffix])
    asked = read_curve(described, document, loads, realisations)
    solved: list[xr.Dataset] = []
    try:
        with counting("solving loads", len(loads) * realisations) as advance:
            for step in solve_curve(asked):
                solved.append(step)
                advance()
    except KeyboardInterrupt:
        if not solved:
            say("gfmd:", "interrupted before the first load was solved; nothing is written", width=6, err=True)
            sys.exit(INTERRUPTED)
    dataset = curve_dataset(asked, solved)
    write_dataset(output, dataset)
    click.echo(f"results  {printable(output)}")
    write_table(table, columns(dataset))
    click.echo(f"table    {printable(table)}")
    _draw(dataset, picture)
    show(dataset)
    for doubt in dataset.attrs["validity"].splitlines():
        say("gfmd:", doubt, width=6, err=True)
    _end(dataset, realisations)


def _draw(dataset: xr.Dataset, picture: Path) -> None:
    from gfmd_numba.analysis import plot_curve
    from gfmd_numba.storage.atomic_file import remove, write_picture
    from gfmd_numba.storage.mark import is_product

    if not (dataset["n_realisations"] > 0).any():
        remove(picture, is_product)  # that of an earlier curve
        say("gfmd:", "no load has a result that could be drawn", width=6, err=True)
        return
    with waiting("drawing"):
        write_picture(picture, plot_curve(dataset), dpi=150)
    click.echo(f"picture  {printable(picture)}")


def _end(dataset: xr.Dataset, realisations: int) -> None:
    """Say which loads are not to be used, or that there would be more; exits with 3 or 130 then."""
    failed = dataset["status"].values != 0
    if failed.any():
        loads = ", ".join(f"{load:.4g}" for load in dataset["prescribed_load"].values[failed])
        left = "they are left out" if realisations == 1 else "the surfaces that failed are left out there"
        say("gfmd:", f"not ok at load {loads}: {left}", width=6, err=True)
        for _, sentence in endings(dataset["status"]):
            say("gfmd:", sentence, width=6, err=True)
    if "interrupted" in dataset.attrs:
        told = f"interrupted {dataset.attrs['interrupted']}; the files hold these loads; the same command begins again"
        say("gfmd:", told, width=6, err=True)
        sys.exit(INTERRUPTED)
    if failed.any():
        sys.exit(SOME_FAILED)
