"""The gap of a map: whether a channel leads across, how narrow it gets, and what leaks through it.

Leakage follows from the Reynolds equation of a thin film, on the grid of the contact.
"""

from collections.abc import Iterator
from typing import Annotated

import numpy as np
import numpy.typing as npt
import scipy  # its modules load with their first use
import xarray as xr

from gfmd_numba.analysis.arguments import checked
from gfmd_numba.analysis.forms import CONTACT, UnusableDataError, check_fields, goes_around
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.arrays.regions import regions


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
    found = xr.apply_ufunc(
        _percolation,
        dataset["gap"],
        kwargs={"around": goes_around(dataset)},
        input_core_dims=[nodes],
        output_core_dims=[["direction"]] * 3 + [[]] * 3,
        vectorize=True,
    )
    result = xr.Dataset(coords={"direction": list(_DIRECTIONS)}, attrs={"title": "percolation of the gap of a contact"})
    result = result.assign(dict(zip(_LONG_NAMES, found, strict=True)))
    for name, long_name in _LONG_NAMES.items():
        unit = str(dataset["gap"].attrs.get("units", "1")) if name == "critical_gap" else "1"
        result[name].attrs = {"long_name": long_name, "units": unit}
    result["direction"].attrs = {"long_name": "direction from one side to the other", "units": "1"}
    return result


def _percolation(gap: Reals, around: tuple[bool, ...]) -> tuple[Reals, Reals, Reals, float, float, int]:
    """Return what `_LONG_NAMES` names, of a map: the first three by direction."""
    touching = gap <= 0.0
    of_gap, of_contact = (sizes(regions(flags, *around)) for flags in (~touching, touching))
    connected = [[connects(flags, axis, around) for axis in _DIRECTIONS.values()] for flags in (~touching, touching)]
    levels, critical = np.unique(gap[gap > 0.0]), []
    for axis in _DIRECTIONS.values():  # the largest level at which nodes of at least that gap connect, by bisection
        fewest, most = 0, len(levels)  # levels below the first connect, those from the second on do not
        while fewest < most:
            middle = (fewest + most) // 2
            if connects(gap >= levels[middle], axis, around):
                fewest = middle + 1
            else:
                most = middle
        critical.append(float(levels[fewest - 1]) if fewest else 0.0)
    largest = (float(each.max(initial=0) / gap.size) for each in (of_gap, of_contact))
    return *np.array(connected, dtype=np.int8), np.array(critical), *largest, len(of_gap)


_REFINEMENTS, _ROUNDING = 30, 1e-14
_LARGEST_RESIDUAL = 1e-3
_OF_GROOVES = (
    "The contact is that of a profile: its grooves go on without end along y, as after turning, and leak there. Across "
    "them one ridge that touches holds all. For a surface that is rough along y too, solve a scene with `dimension: 2`"
)
_ALIKE = 2.0  # ratio of the factors of both directions, that of maps of many channels is below 1.5


@checked
def leakage(dataset: Annotated[xr.Dataset, CONTACT]) -> xr.Dataset:
    """Leakage through the gap of contacts as `gfmd solve` leaves them, `[..., direction]`, by direction x and y.

    A fluid of viscosity eta fills the gap u, and its pressure falls from one side of the period to the other, across
    which a period goes around, and walls close a window: div(u^3 grad p) = 0 (Reynolds 1886), without flow into
    nodes that touch. `hydraulic_gap` d is the gap of parallel walls that leak as much: a pressure difference P drives
    d^3 P / (12 eta) times L_y / L_x through the map along x. `flow_factor` is d^3 over the cube of the mean gap (Patir
    & Cheng, J. Lubr. Technol. 100:12, 1978). Both are 0 without a channel. `local_flow` `[..., direction, y, x]` is the
    flow through a node over the mean flow of all nodes. `flow_residual` is the relative difference of the flow by
    outlet and by dissipation; beyond 1e-3, where channels are narrower than 1e-5 of the largest gap, the hydraulic gap
    is not-a-number. The gap of a profile goes on without end along y. The attribute `validity` names the doubts of the
    contact, that of profiles, factors above 1, and those that differ much by direction. Raises UnusableDataError for a
    dataset without these fields, a run that is not ok, or more nodes than memory takes.
    """
    nodes = check_fields(dataset, ("pressure", "gap"))
    around = (False, *goes_around(dataset))[-2:]

    def both_directions(gap: Reals) -> tuple[Reals, Reals, Reals]:
        rows = np.atleast_2d(gap)
        found = [_along_rows(np.moveaxis(rows, axis, 0), around[1 - axis]) for axis in _DIRECTIONS.values()]
        gaps, residuals, flows = zip(*found, strict=True)
        turned = [np.moveaxis(flow, 0, axis) for flow, axis in zip(flows, _DIRECTIONS.values(), strict=True)]
        return np.array(gaps), np.array(residuals), np.reshape(turned, (2, *gap.shape))

    hydraulic, residual, flow = xr.apply_ufunc(
        both_directions,
        dataset["gap"],
        input_core_dims=[nodes],
        output_core_dims=[["direction"], ["direction"], ["direction", *nodes]],
        vectorize=True,
    )
    result = xr.Dataset(coords={"direction": list(_DIRECTIONS)}, attrs={"title": "leakage through a contact"})
    result["hydraulic_gap"] = hydraulic
    result["flow_factor"] = (hydraulic / dataset["gap"].mean(nodes).where(hydraulic > 0.0, 1.0)) ** 3
    result["flow_residual"] = residual
    result["local_flow"] = flow
    described = {
        "hydraulic_gap": ("gap of parallel walls that leak as much", str(dataset["gap"].attrs.get("units", "1"))),
        "flow_factor": ("leakage over that of parallel walls at the mean gap", "1"),
        "flow_residual": ("relative difference of the flow by outlet and by dissipation", "1"),
        "local_flow": ("flow through a node over the mean flow of all nodes", "1"),
        "direction": ("direction in which the pressure of the fluid falls", "1"),
    }
    for name, (long_name, unit) in described.items():
        result[name].attrs = {"long_name": long_name, "units": unit}
    of_contact = filter(None, [dataset.attrs.get("validity")])
    own = _doubts(result["flow_factor"]) if "y" in nodes else (_OF_GROOVES,)
    result.attrs["validity"] = "\n".join([*of_contact, *own])
    return result


def _doubts(factors: xr.DataArray) -> Iterator[str]:
    """Sentences on flow factors that surprise: those of surfaces without a lay are alike, and on average below 1."""
    pairs = factors.transpose(..., "direction").values.reshape(-1, len(_DIRECTIONS))
    high, low = pairs.max(axis=1), pairs.min(axis=1)
    largest = int(np.argmax(np.nan_to_num(high)))
    where = " in step {}" if "step" in factors.dims else ""
    if high[largest] > 1.0 + _LARGEST_RESIDUAL:
        along = list(_DIRECTIONS)[int(pairs[largest].argmax())]
        yield (
            f"The flow factor along {along}{where.format(largest)} is {high[largest]:.3g}. The gap leaks more than "
            "parallel walls at its mean would, because deep channels run through the map. Random surfaces without a "
            "lay have factors below 1 on average"
        )
    for along, shut in zip(_DIRECTIONS, (pairs == 0.0).T, strict=True):
        if shut.any():
            step = where.format(int(shut.argmax()))
            yield f"No channel is open along {along}{step}: on this grid nothing leaks there"
    ratios = np.divide(high, low, out=np.zeros_like(high), where=low > 0.0)
    unlike = int(ratios.argmax())
    if ratios[unlike] > _ALIKE:
        of_x, of_y = pairs[unlike]
        yield (
            f"The flow factors along x and y{where.format(unlike)} are {of_x:.3g} and {of_y:.3g}. Either the surface "
            "has a lay, and each direction a factor of its own. Or few channels decide, and one map says little: solve "
            "other seeds, measure another patch, or take a map with more of the longest waves"
        )


def _along_rows(gap: Reals, around: bool) -> tuple[float, float, Reals]:
    """Hydraulic gap from the first row to the last, the residual, and the flow through nodes over its mean.

    The fluid may flow `around` the ends of rows that are periodic.

    Nodes are cells, whose faces conduct as their halves in series do. So walls of a gap that varies along the flow
    alone are solved exactly: d^-3 is the mean of u^-3.
    """
    largest, flow = gap.max(), np.zeros_like(gap)
    if largest <= 0.0:
        return 0.0, 0.0, flow
    conductivity = (gap / largest) ** 3
    # open nodes of the regions that connect the first row with the last
    labels = regions(conductivity > 0.0, around_y=False, around_x=around)
    shared = np.intersect1d(labels[0], labels[-1])
    reached = np.isin(labels, shared[shared > 0])
    if not reached.any():
        return 0.0, 0.0, flow
    conductivity = np.where(reached, conductivity, 0.0)
    number = np.cumsum(reached).reshape(reached.shape) - 1
    along = _faces(conductivity[:-1], conductivity[1:], number[:-1], number[1:])
    columns = slice(None) if around else slice(-1)
    beside = (np.roll(each, -1, axis=1)[:, columns] for each in (conductivity, number))
    across = _faces(conductivity[:, columns], next(beside), number[:, columns], next(beside))
    one, other, conductance = (np.concatenate(parts) for parts in zip(along, across, strict=True))
    inlet, outlet = (np.zeros(int(reached.sum())) for _ in range(2))
    for ends, row in ((inlet, 0), (outlet, -1)):
        ends[number[row][reached[row]]] = 2.0 * conductivity[row][reached[row]]  # half a cell
    pressure = _pressure(one, other, conductance, inlet, outlet)
    out = float(outlet @ pressure)
    dissipated = float(
        conductance @ (pressure[one] - pressure[other]) ** 2 + inlet @ (1.0 - pressure) ** 2 + outlet @ pressure**2
    )
    rows, nx = gap.shape
    residual = abs(out - dissipated) / dissipated
    cube = dissipated * rows / nx if residual <= _LARGEST_RESIDUAL else np.nan
    ends = inlet * (1.0 - pressure) + outlet * pressure
    parts = (_through_nodes(*faces, pressure, rim) for faces, rim in ((along, ends), (across, 0.0)))
    flow[reached] = np.hypot(*parts) * nx / out if residual <= _LARGEST_RESIDUAL else np.nan
    return float(largest * np.cbrt(cube)), residual, flow


def _faces(here: Reals, there: Reals, number: Indices, other: Indices) -> tuple[Indices, Indices, Reals]:
    """Numbers of the nodes on both sides of each open face, and its conductance."""
    both = (here > 0.0) & (there > 0.0)
    return number[both], other[both], 2.0 * here[both] * there[both] / (here[both] + there[both])


def _through_nodes(one: Indices, other: Indices, conductance: Reals, pressure: Reals, rim: Reals | float) -> Reals:
    """Flow through each node in one direction, the mean of that through its two faces; a rim is a face of one node."""
    flow, n = conductance * (pressure[one] - pressure[other]), len(pressure)
    return np.asarray(0.5 * (np.bincount(one, flow, n) + np.bincount(other, flow, n) + rim))


def _pressure(one: Indices, other: Indices, conductance: Reals, inlet: Reals, outlet: Reals) -> Reals:
    """Pressure of each node, 1 before the inlet and 0 behind the outlet."""
    n = len(inlet)
    diagonal = inlet + outlet + np.bincount(one, conductance, n) + np.bincount(other, conductance, n)
    scale = 1.0 / np.sqrt(diagonal)  # conductances differ by dozens of orders
    coupling = conductance * scale[one] * scale[other]
    upper = scipy.sparse.coo_array((coupling, (one, other)), shape=(n, n))
    matrix = scipy.sparse.csc_array(scipy.sparse.diags_array(np.ones(n)) - upper - upper.T)
    # symmetric and diagonally dominant: pivots stay on the diagonal
    try:
        factors = scipy.sparse.linalg.splu(
            matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except MemoryError:
        raise UnusableDataError(
            f"you gave channels of {n} nodes, whose flow takes more memory than there is; gfmd allows a map of fewer "
            "nodes"
        ) from None
    pressure = scale * factors.solve(scale * inlet)
    # a diagonal rounded leaks: behind narrow places pressures are refined by the flows through faces, which do not
    for _ in range(_REFINEMENTS):
        flow = conductance * (pressure[other] - pressure[one])
        gained = np.bincount(one, flow, n) - np.bincount(other, flow, n)
        change = scale * factors.solve(scale * (gained + inlet * (1.0 - pressure) - outlet * pressure))
        pressure += change
        if abs(change).max() <= _ROUNDING:
            break
    return np.asarray(pressure)
