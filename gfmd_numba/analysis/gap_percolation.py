"""Percolation of the gap of a map: whether a channel leads from one side to the other, and how narrow it gets."""

from collections.abc import Callable
from typing import Annotated

import numpy as np
import xarray as xr

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.connected_regions import connects, regions, sizes
from gfmd_numba.analysis.forms import CONTACT
from gfmd_numba.analysis.solved_fields import check_fields, is_periodic
from gfmd_numba.arrays import Flags, Reals

_DIRECTIONS = {"x": 1, "y": 0}  # to the axis of [y, x] that a channel follows
_LONG_NAMES = {
    "gap_connects": "whether an open channel connects the two sides",
    "contact_connects": "whether a contact cluster connects the two sides",
    "critical_gap": "largest gap that some channel between the two sides nowhere falls below",
    "largest_gap_fraction": "nodes of the largest connected gap over all nodes",
    "largest_contact_fraction": "nodes of the largest contact cluster over all nodes",
    "n_gaps": "number of separate gaps",
}


@checked
def gap_percolation(dataset: Annotated[xr.Dataset, CONTACT]) -> xr.Dataset:
    """Percolation of the gap on maps as `gfmd solve` leaves them, `[..., direction]`, by direction x and y.

    `gap_connects` and `contact_connects` are 1 where open nodes, or touching ones, lead from one side of the period to
    the other; across that direction a periodic map goes around. `critical_gap` has the unit of the gap and is 0 without
    a channel. Regions, which may go around both periods, connect through the sides of nodes, not through corners: where
    two contacts meet at a corner, neither they nor the gaps next to it are connected. Raises UnusableDataError for a
    dataset without these fields or a run that is not ok.
    """
    nodes = check_fields(dataset, ("pressure", "gap"), maps_only=True)
    touching, around = dataset["gap"] <= 0.0, {"around": is_periodic(dataset)}
    result = xr.Dataset(coords={"direction": list(_DIRECTIONS)}, attrs={"title": "percolation of the gap of a contact"})
    result["gap_connects"] = _by_direction(_connects, ~touching, nodes, around)
    result["contact_connects"] = _by_direction(_connects, touching, nodes, around)
    result["critical_gap"] = _by_direction(_critical_gap, dataset["gap"], nodes, around)
    for name, flags in (("gap", ~touching), ("contact", touching)):
        result[f"largest_{name}_fraction"] = xr.apply_ufunc(
            _largest, flags, kwargs=around, input_core_dims=[nodes], vectorize=True
        )
    result["n_gaps"] = xr.apply_ufunc(_count, ~touching, kwargs=around, input_core_dims=[nodes], vectorize=True)
    for name, long_name in _LONG_NAMES.items():
        unit = str(dataset["gap"].attrs.get("units", "1")) if name == "critical_gap" else "1"
        result[name].attrs = {"long_name": long_name, "units": unit}
    result["direction"].attrs = {"long_name": "direction from one side to the other", "units": "1"}
    return result


def _by_direction(
    function: Callable[..., Reals], values: xr.DataArray, nodes: list[str], around: dict[str, bool]
) -> xr.DataArray:
    found: xr.DataArray = xr.apply_ufunc(
        function, values, kwargs=around, input_core_dims=[nodes], output_core_dims=[["direction"]], vectorize=True
    )
    return found


def _connects(flags: Flags, around: bool) -> Reals:
    return np.array([connects(flags, axis, around) for axis in _DIRECTIONS.values()], dtype=np.int8)


def _critical_gap(gap: Reals, around: bool) -> Reals:
    return np.array([_narrowest(gap, axis, around) for axis in _DIRECTIONS.values()])


def _narrowest(gap: Reals, axis: int, around: bool) -> float:
    """Largest level at which the nodes of at least that gap still connect the two sides, by bisection."""
    levels = np.unique(gap[gap > 0.0])
    fewest, most = 0, len(levels)  # levels below the first connect, those from the second on do not
    while fewest < most:
        middle = (fewest + most) // 2
        if connects(gap >= levels[middle], axis, around):
            fewest = middle + 1
        else:
            most = middle
    return float(levels[fewest - 1]) if fewest else 0.0


def _largest(flags: Flags, around: bool) -> float:
    return float(sizes(regions(flags, around, around)).max(initial=0) / flags.size)


def _count(flags: Flags, around: bool) -> int:
    return len(sizes(regions(flags, around, around)))
