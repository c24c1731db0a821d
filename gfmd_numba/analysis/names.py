"""Values of a parameter as text: numbers, or the names that they stand for."""

import json
from collections.abc import Iterable

import xarray as xr

from gfmd_numba.text.printable import printable


def has_names(parameter: xr.DataArray) -> bool:
    """Whether the values of a parameter are numbers of names, which its attribute `names` lists."""
    return "names" in parameter.attrs


def plain(name: str) -> str:
    """Return a name that no text of a figure takes for a formula."""
    return name.replace("$", r"\$")


def shown(parameter: xr.DataArray, values: Iterable[float]) -> list[str]:
    """Return each value of a parameter as text: the name that it stands for, or the number with six digits."""
    names = json.loads(parameter.attrs["names"]) if has_names(parameter) else None
    return [f"{value:g}" if names is None else printable(names[int(value)]) for value in values]
