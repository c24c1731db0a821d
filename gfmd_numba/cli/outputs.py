"""Files that a command writes: whether it may write them, and how it says so."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from gfmd_numba.cli.terminal import waiting
from gfmd_numba.text.input_error import InputError
from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from gfmd_numba.analysis.plots.style import Width

_NETCDF = (".nc", ".nc4")


def check_output(output: Path, *inputs: Path, suffixes: Sequence[str] = _NETCDF) -> None:
    """Raise InputError unless a file of this kind can be written that is none of the inputs and nobody else's."""
    from gfmd_numba.storage.atomic_file import foreign

    for file in inputs:
        if output.exists() and file.exists() and output.samefile(file):
            raise InputError.of("--output", f"{output}, which is an input", "another file")
    if not output.parent.is_dir():
        raise InputError.of("--output", output, f"a file in a folder that exists, unlike {output.parent}")
    if not os.access(output.parent, os.W_OK) or (output.exists() and not os.access(output, os.W_OK)):
        raise InputError.of("--output", f"{output}, which you may not write", "a file that you may write")
    if output.suffix.lower() not in suffixes:
        kind = {".nc": "netCDF file", ".html": "page"}.get(suffixes[0], "picture")
        kind += " or a table" * (".csv" in suffixes)
        raise InputError.of("--output", output, f"a {kind}, ending in {', '.join(suffixes)}")
    if clause := foreign(output):
        raise InputError.of(
            "--output",
            f"{output}, {clause}",
            "a new file, or one as gfmd wrote it (move the file away, or choose another name)",
        )


def companion(output: Path, kind: str, suffix: str) -> Path:
    """Return the name of a file that goes with a netCDF file; raises InputError if somebody else's file has it."""
    from gfmd_numba.storage.atomic_file import foreign

    if not output.name:
        raise click.BadParameter("you gave no name; gfmd allows a file, like steel.nc", param_hint="--output")
    file = output.with_suffix(suffix)
    if file == output:
        raise click.BadParameter(
            f"the {kind} takes the name with {suffix}; give one like steel.nc", param_hint="--output"
        )
    if clause := foreign(file):
        raise InputError(
            f"{file}: the {kind} would go here, {clause}; gfmd allows another --output, or to move the file away"
        )
    return file


def picture_suffixes() -> list[str]:
    """Return what the names of pictures may end in."""
    from matplotlib.backend_bases import FigureCanvasBase

    return [f".{kind}" for kind in sorted(FigureCanvasBase.get_supported_filetypes())]


def write(path: Path, dataset: xr.Dataset, label: str = "results", *, err: bool = False) -> None:
    """Write a netCDF file and say so."""
    from gfmd_numba.storage.atomic_file import write_dataset

    write_dataset(path, dataset)
    say_written(label, path, err=err)


def write_picture(path: Path, drawing: Callable[[], Figure], *, err: bool = False) -> None:
    """Draw a picture, write it and say so."""
    from gfmd_numba.storage import atomic_file

    with waiting("drawing"):
        atomic_file.write_picture(path, drawing())
    say_written("picture", path, err=err)


def say_written(label: str, path: Path, *, err: bool = False) -> None:
    """Say which file was written."""
    click.echo(f"{label:<9}{printable(path)}", err=err)


def pictures(
    dataset: xr.Dataset, fitted: xr.Dataset | None, path: Path, width: Width | None = None
) -> dict[Path, Callable[[], Figure]]:
    """Return what draws a campaign with its fit, or anything else without, by path; some have a second picture."""
    from gfmd_numba.analysis import plot_campaign
    from gfmd_numba.analysis.plots.kinds import picture_of, second_picture_of

    own, second = picture_of(dataset), second_picture_of(dataset)
    found: dict[Path, Callable[[], Figure]] = {path: partial(own or plot_campaign, dataset, width=width)}
    if own is None and fitted is not None:
        found[path] = partial(plot_campaign, dataset, fitted, fitted.attrs["variable"], width)
    if second is not None:
        found[path.with_stem(f"{path.stem}-{second[0]}")] = partial(second[1], dataset, width=width)
    return found
