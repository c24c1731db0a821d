"""What analysis asks of a solved contact: its fields over all nodes of a period, in numbers, of a run that is ok."""

from collections.abc import Collection

import numpy as np
import xarray as xr

from gfmd_numba.analysis.forms import UnusableDataError

_FIELDS = ("height", "pressure", "gap")
_POINTS, _POINTS_OF_WINDOW = "points_per_period", "points_per_window"


def is_periodic(dataset: xr.Dataset) -> bool:
    """Return whether the two ends of the fields meet, or they are those of a window that has no period."""
    return _POINTS_OF_WINDOW not in dataset["x"].attrs


def check_fields(dataset: xr.Dataset, needed: Collection[str], maps_only: bool = False) -> list[str]:
    """Return the dims of the nodes, `[x]` or `[y, x]`; raises UnusableDataError for what is no solved contact."""
    kind = "a map's contact" if maps_only else "a contact"
    if not {"x", "status", *needed} <= dataset.variables.keys():
        raise UnusableDataError(f"you gave no results of {kind}; gfmd allows what `gfmd solve` leaves of one")
    if maps_only and "y" not in dataset.dims:
        raise UnusableDataError(
            "you gave the contact of a profile, in which no channel leads around the contacts; gfmd allows that of a "
            "map "
            "(solve a scene with `dimension: 2`, whose surface is random or a measured map)"
        )
    nodes = ["y", "x"] if "y" in dataset.dims else ["x"]
    fields = [dataset[name] for name in _FIELDS if name in needed]
    names = ("x", "status", *needed)
    numbers = all(dataset[name].dtype.kind in "fiu" for name in names)
    over_nodes = all(field.size and set(nodes) <= set(field.dims) for field in fields)
    enough = min(dataset.sizes.get(dim, 0) for dim in nodes) >= 4
    scalars = [dataset[name] for name in ("status", *needed) if name not in _FIELDS]
    alone = not any(set(scalar.dims) - (set(fields[-1].dims) - set(nodes)) for scalar in scalars)
    if not (numbers and over_nodes and enough and alone and {field.dims for field in fields} == {fields[-1].dims}):
        raise UnusableDataError(f"you gave altered results; gfmd allows what `gfmd solve` leaves of {kind}")
    if (dataset["status"] != 0).any():
        raise UnusableDataError("you gave a run that is not ok; gfmd allows contacts in equilibrium, whose status is 0")
    if not all(np.isfinite(field).all() for field in fields):
        raise UnusableDataError(f"you gave fields that are not finite; gfmd allows what `gfmd solve` leaves of {kind}")
    for dim in nodes if len(nodes) == 2 else ():  # clusters may go around the period
        points = dataset[dim].attrs.get(_POINTS, dataset.sizes[dim]) if dim in dataset.coords else "unknown"
        if str(points) != str(dataset.sizes[dim]):
            given = f"{dataset.sizes[dim]} of the {points} nodes along {dim}"
            raise UnusableDataError(f"you gave {given}; gfmd allows all nodes of the period of a map")
    return nodes
