"""Cases of a campaign that meet conditions, as `--only` gives them: `hurst=0.8`, `pressure=50 MPa`, `file=worn.csv`."""

from collections.abc import Mapping
from math import isclose
from typing import Any

from pydantic_core import PydanticCustomError

from gfmd_numba.campaign.axes import AXES
from gfmd_numba.campaign.cases import Case
from gfmd_numba.campaign.coordinates import coordinates
from gfmd_numba.campaign.grid import Grid
from gfmd_numba.contact.dataset import Units
from gfmd_numba.scene import InputError
from gfmd_numba.scene.document import plain_scalar
from gfmd_numba.scene.reduced_units import quantities
from gfmd_numba.scene.units import WithUnit
from gfmd_numba.scene.validation import nearest
from gfmd_numba.text.si_prefix import si_prefix

_ROUNDING = 5e-6  # relative, of a number that was read off a table
_MOST_VALUES = 10


def meeting(cases: list[Case], conditions: Mapping[str, str]) -> list[Case]:
    """Cases that meet all conditions, name -> value; raises InputError.

    A name is a key of the grid or a coordinate of the results. A number may have a unit where the scene has units.
    """
    columns = coordinates(cases)
    keys = {axis.name: axis for axis in AXES if axis.coordinate in columns}
    chosen = list(range(len(cases)))
    for name, given in conditions.items():
        column = columns.get(keys[name].coordinate if name in keys else name)
        if column is None:
            named = {axis.coordinate: key for key, axis in keys.items()}
            names = [named.get(coordinate, coordinate) for coordinate in columns]
            hint = nearest(name, names)
            raise InputError(f"--only: you gave {name}; gfmd allows {', '.join(names)}{f'; {hint}' if hint else ''}")
        axis = next((axis for axis in keys.values() if name in (axis.name, axis.coordinate)), None)
        unit = "1" if axis is None else Units.of(cases[0].scene).names[axis.unit]
        value = given if isinstance(column[0], str) else _number(name, given, axis.name if axis else "", unit)
        found = {i for i, held in enumerate(column) if held == value}
        if not found and isinstance(value, float):
            found = {i for i, held in enumerate(column) if isclose(held, value, rel_tol=_ROUNDING)}
        if not found:
            there = ", ".join(_readable(list(dict.fromkeys(column))[:_MOST_VALUES], unit))
            raise InputError(f"--only: you gave {name}={given}; gfmd allows a value of the campaign, like {there}")
        chosen = [i for i in chosen if i in found]
    if not chosen:
        given = " ".join(f"--only {name}={value}" for name, value in conditions.items())
        allowed = "conditions that at least one case meets"
        raise InputError(f"--only: you gave {given}, and no case meets all of these; gfmd allows {allowed}")
    return [cases[i] for i in chosen]


def _number(name: str, given: str, key: str, unit: str) -> Any:
    """Number of a text, in the unit of the results; any other value, or the text itself, if it is none."""
    quantity = quantities(Grid).get(key)
    value: Any = plain_scalar(given.strip())
    try:
        value = value if quantity is None else quantity.read(value)
    except PydanticCustomError as error:
        said = {"allowed": "", "suggestion": "", **(error.context or {})}
        hint = f"; {said['suggestion']}" if said["suggestion"] else ""
        raise InputError(f"--only: you gave {name}={given}; gfmd allows {said['allowed']}{hint}") from None
    if isinstance(value, WithUnit) and unit == "1":
        raise InputError(f"--only: you gave {name}={given}; gfmd allows a number without a unit, as the scene has none")
    try:
        return value if isinstance(value, bool) or value is None else float(value)
    except ValueError:
        return value


def _readable(values: list[Any], unit: str) -> list[str]:
    """Values as a condition may give them."""
    if unit == "1":
        return [f"{value:.6g}" if isinstance(value, float) else str(value) for value in values]
    factor, named = si_prefix(max(map(abs, values)), unit)
    return [f"{factor * value:.6g} {named}" for value in values]
