"""Percolation of the gap of a map: connected regions, whether a channel leads across, and how narrow it gets."""

from collections.abc import Callable
from typing import Annotated

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.ndimage import label
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.forms import CONTACT, check_fields, goes_around
from gfmd_numba.arrays import Flags, Reals


def regions(flags: Flags, around_y: bool = True, around_x: bool = True) -> npt.NDArray[np.int32]:
    """Label of each node `[y, x]`, from 1 on, and 0 where the flag is not set.

    Nodes of one region share sides; corners do not connect. `around_y` and `around_x` join the two ends of a period.
    """
    labels, count = label(flags)
    ends = [
        ends
        for ends, joined in (((labels[0], labels[-1]), around_y), ((labels.T[0], labels.T[-1]), around_x))
        if joined
    ]
    if not ends or count == 0:
        return np.asarray(labels)
    one, other = (np.concatenate(side) for side in zip(*ends, strict=True))
    both = (one > 0) & (other > 0)
    graph = coo_array((np.ones(int(both.sum())), (one[both], other[both])), shape=(count + 1, count + 1))
    joined = connected_components(graph, directed=False)[1]
    # the background is a component of its own, as no pair holds label 0
    number = np.unique(np.delete(joined, 0), return_inverse=True)[1] + 1
    return np.asarray(np.concatenate([[0], number])[labels], dtype=np.int32)


def sizes(labels: npt.NDArray[np.int32]) -> npt.NDArray[np.int64]:
    """Number of nodes of each region `[region]`."""
    return np.bincount(labels.ravel())[1:].astype(np.int64)


def connects(flags: Flags, axis: int, around: tuple[bool, ...] = (True, True)) -> bool:
    """Whether a region touches both ends of `axis`; it may go `around` the other axis if its ends are one."""
    labels = np.moveaxis(regions(flags, around[0] and axis != 0, around[1] and axis != 1), axis, 0)
    shared = np.intersect1d(labels[0], labels[-1])
    return bool((shared > 0).any())


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
    touching, around = dataset["gap"] <= 0.0, {"around": goes_around(dataset)}
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
    function: Callable[..., Reals], values: xr.DataArray, nodes: list[str], around: dict[str, tuple[bool, ...]]
) -> xr.DataArray:
    found: xr.DataArray = xr.apply_ufunc(
        function, values, kwargs=around, input_core_dims=[nodes], output_core_dims=[["direction"]], vectorize=True
    )
    return found


def _connects(flags: Flags, around: tuple[bool, ...]) -> Reals:
    return np.array([connects(flags, axis, around) for axis in _DIRECTIONS.values()], dtype=np.int8)


def _critical_gap(gap: Reals, around: tuple[bool, ...]) -> Reals:
    return np.array([_narrowest(gap, axis, around) for axis in _DIRECTIONS.values()])


def _narrowest(gap: Reals, axis: int, around: tuple[bool, ...]) -> float:
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


def _largest(flags: Flags, around: tuple[bool, ...]) -> float:
    return float(sizes(regions(flags, *around)).max(initial=0) / flags.size)


def _count(flags: Flags, around: tuple[bool, ...]) -> int:
    return len(sizes(regions(flags, *around)))
