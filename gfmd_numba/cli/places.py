"""Places inside a body, as options give them and as the terminal tells them."""

from __future__ import annotations

from contextlib import contextmanager, suppress
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from gfmd_numba.cli.readable import readable
from gfmd_numba.text.input_error import InputError
from gfmd_numba.text.printable import printable

if TYPE_CHECKING:
    from collections.abc import Iterator

    import xarray as xr


def place(contact: xr.Dataset, option: str, text: str) -> float:
    """Return a length like `-5um` or `-5e-6` in the unit of x of a contact; raises InputError for what is none."""
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
    """Return the largest von Mises stress below a map and its place, of a path that of the last step."""
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
