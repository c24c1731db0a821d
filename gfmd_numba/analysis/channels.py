"""The gap of a map: whether a channel leads across, how narrow it gets, and what leaks through it.

Leakage follows from the Reynolds equation of a thin film, on the grid of the contact, by a sparse direct solver.
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
from gfmd_numba.arrays.regions import closed, regions
from gfmd_numba.text.numbers import steps_told
from gfmd_numba.text.recorded_scene import asked


def sizes(labels: npt.NDArray[np.int32]) -> npt.NDArray[np.int64]:
    """Number of nodes of each region `[region]`."""
    return np.bincount(labels.ravel())[1:].astype(np.int64)


def connecting(flags: Flags, axis: int, around: tuple[bool, ...] = (True, True)) -> Flags:
    """Nodes of the regions that lead `around` the period along `axis`, or from end to end of a window along it.

    A path that leads around may take several periods and shift along the other axis, so that no cut of the period
    matters. Pieces between the ends of the periods are joined by union-find, with the periods between their copies.
    """
    if not around[axis]:
        labels = regions(flags, around)
        shared = np.intersect1d(labels.take(0, axis), labels.take(-1, axis))
        return np.isin(labels, shared[shared > 0])
    pieces = regions(flags, (False, False))
    seams = [(other, pieces.take(-1, other), pieces.take(0, other)) for other in (0, 1) if around[other]]
    crossings = np.concatenate([np.stack([one, two, np.full_like(one, k == axis)], axis=1) for k, one, two in seams])
    above: dict[int, tuple[int, int]] = {}  # the piece that one is joined to, and how many periods it lies beyond

    def root(piece: int) -> tuple[int, int]:
        end, beyond = piece, 0
        while end in above:
            end, step = above[end]
            beyond += step
        if end != piece:
            above[piece] = end, beyond
        return end, beyond

    leading = set()
    for one, two, step in np.unique(crossings[crossings.min(axis=1, where=[True, True, False], initial=1) > 0], axis=0):
        (first, here), (second, there) = root(int(one)), root(int(two))
        if first != second:
            above[second] = first, here + int(step) - there
        elif here + step != there:
            leading.add(first)
    ends = {root(piece)[0] for piece in leading}
    return np.isin(pieces, [piece for piece in {*above, *ends} if root(piece)[0] in ends])


_DIRECTIONS = {"x": 1, "y": 0}  # to the axis of [y, x] that a channel follows
_LONG_NAMES = {
    "gap_connects": "whether an open channel leads across, around the period",
    "contact_connects": "whether a contact cluster leads across, around the period",
    "critical_gap": "largest gap that some channel across nowhere falls below",
    "largest_gap_fraction": "nodes of the largest connected gap over all nodes",
    "largest_contact_fraction": "nodes of the largest contact cluster over all nodes",
    "n_gaps": "number of separate gaps",
}


@checked
def gap_percolation(dataset: Annotated[xr.Dataset, CONTACT]) -> xr.Dataset:
    """Percolation of the gap on maps as `gfmd solve` leaves them, `[..., direction]`, by direction x and y.

    `gap_connects` and `contact_connects` are 1 where open nodes, or touching ones, lead around the period, or from side
    to side of a window. So where a period is cut does not matter, and a channel may take several periods to close.
    `critical_gap` has the unit of the gap and is 0 without a channel. Regions connect through the sides of nodes, not
    through corners: where two contacts meet at a corner, neither they nor the gaps next to it are connected. Raises
    UnusableDataError for a dataset without these fields or a run that is not ok.
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
    result["direction"].attrs = {"long_name": "direction in which a channel leads", "units": "1"}
    return result


def _percolation(gap: Reals, around: tuple[bool, ...]) -> tuple[Reals, Reals, Reals, float, float, int]:
    """Return what `_LONG_NAMES` names, of a map: the first three by direction."""
    touching = closed(gap)
    of_gap, of_contact = (sizes(regions(flags, around)) for flags in (~touching, touching))
    axes = _DIRECTIONS.values()
    connected = [[connecting(flags, axis, around).any() for axis in axes] for flags in (~touching, touching)]
    levels, critical = np.unique(gap[~touching]), []
    for axis in axes:  # the largest level at which nodes of at least that gap connect, by bisection
        fewest, most = 0, len(levels)  # levels below the first connect, those from the second on do not
        while fewest < most:
            middle = (fewest + most) // 2
            if connecting(gap >= levels[middle], axis, around).any():
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

    A fluid of viscosity eta fills the gap h: div(h^3 grad p) = 0 (Reynolds 1886), without flow into nodes that touch.
    Its pressure is a mean gradient and a periodic part, so that where the period is cut does not matter. In a window it
    is uniform on the sides of inlet and outlet, and the other two are impermeable. `hydraulic_gap` d is the gap of
    parallel walls that leak as much: a pressure difference P drives d^3 P / (12 eta) times L_y / L_x through the map
    along x. `flow_factor` is d^3 over the cube of the mean gap (Patir & Cheng, J. Lubr. Technol. 100:12, 1978). Both
    are 0 without a channel. `local_flow` `[..., direction, y, x]` is the flow through a node over the mean flow of all
    nodes. `flow_residual` is the relative difference of the flow through cuts and by dissipation; beyond 1e-3, where
    channels are narrower than 1e-5 of the largest gap, the hydraulic gap is not-a-number. The gap of a profile goes on
    without end along y. The attribute `validity` names the doubts of the contact, that of profiles, factors above 1,
    and those that differ much by direction. Raises UnusableDataError for a dataset without these fields, a run that is
    not ok, or more nodes than memory takes.
    """
    nodes = check_fields(dataset, ("pressure", "gap"))
    around = (False, *goes_around(dataset))[-2:]

    hydraulic, residual, flow = xr.apply_ufunc(
        _in_both_directions,
        dataset["gap"],
        kwargs={"around": around},
        input_core_dims=[nodes],
        output_core_dims=[["direction"], ["direction"], ["direction", *nodes]],
        vectorize=True,
    )
    attributes = {"title": "leakage through a contact", **asked(dataset.attrs)}
    result = xr.Dataset(coords={"direction": list(_DIRECTIONS)}, attrs=attributes)
    result["hydraulic_gap"] = hydraulic
    result["flow_factor"] = (hydraulic / dataset["gap"].mean(nodes).where(hydraulic > 0.0, 1.0)) ** 3
    result["flow_residual"] = residual
    result["local_flow"] = flow
    described = {
        "hydraulic_gap": ("gap of parallel walls that leak as much", str(dataset["gap"].attrs.get("units", "1"))),
        "flow_factor": ("leakage over that of parallel walls at the mean gap", "1"),
        "flow_residual": ("relative difference of the flow through cuts and by dissipation", "1"),
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

    step = " in step {}" if "step" in factors.dims else ""
    if high[largest] > 1.0 + _LARGEST_RESIDUAL:
        along = list(_DIRECTIONS)[int(pairs[largest].argmax())]
        yield (
            f"The flow factor along {along}{step.format(largest)} is {high[largest]:.3g}. The gap leaks more than "
            "parallel walls at its mean would, because deep channels run through the map. Random surfaces without a "
            "lay have factors below 1 on average"
        )
    for along, shut in zip(_DIRECTIONS, (pairs == 0.0).T, strict=True):
        if shut.any():
            steps = steps_told(shut.tolist(), len(shut) - 1)
            yield f"No channel is open along {along}{steps and f' in {steps}'}: on this grid nothing leaks there"
    ratios = np.divide(high, low, out=np.zeros_like(high), where=low > 0.0)
    unlike = int(ratios.argmax())
    if ratios[unlike] > _ALIKE:
        of_x, of_y = pairs[unlike]
        yield (
            f"The flow factors along x and y{step.format(unlike)} are {of_x:.3g} and {of_y:.3g}. Either the surface "
            "has a lay, and each direction a factor of its own. Or few channels decide, and one map says little: solve "
            "other seeds, measure another patch, or take a map with more of the longest waves"
        )


def _in_both_directions(gap: Reals, around: tuple[bool, ...]) -> tuple[Reals, Reals, Reals]:
    """Hydraulic gap, residual and flow through nodes over its mean `[direction, (y,) x]`, by direction.

    Both directions of a period share what was factored: on a torus, regions that lead around one way and regions that
    lead around the other would cross, so that they are the same.
    """
    rows, largest, network = np.atleast_2d(gap), gap.max(), None
    conductivity = (rows / (largest or 1.0)) ** 3
    gaps, residuals, flows = np.zeros(2), np.zeros(2), np.zeros((2, *rows.shape))
    for i, axis in enumerate(_DIRECTIONS.values()):
        reached = connecting(conductivity >= np.finfo(np.float64).tiny, axis, around)
        if not reached.any():
            continue
        room = None if around[axis] else axis
        if network is None or network.room != room:
            network = None  # whose factors fill a good part of the memory
            network = _Network(np.where(reached, conductivity, 0.0), around, room)
        gaps[i], residuals[i], flows[i, reached] = network.flow_along(axis)
    return largest * gaps, residuals, flows.reshape(2, *gap.shape)


class _Network:
    """Nodes of a gap through which a fluid flows, and the faces between them.

    Nodes are cells, whose faces conduct as their halves in series do. So walls of a gap that varies along the flow
    alone are solved exactly: d^-3 is the mean of u^-3. Both ends of a window along the axis `room` open into one room,
    as if it had a period.
    """

    def __init__(self, conductivity: Reals, around: tuple[bool, ...], room: int | None) -> None:
        reached, self.room, self._shape = conductivity > 0.0, room, conductivity.shape
        number = np.cumsum(reached).reshape(reached.shape) - 1
        self._n = int(reached.sum())
        labels, order = regions(reached, around)[reached], np.argsort(conductivity[reached])
        held = np.zeros(labels.max() + 1, dtype=np.intp)
        held[labels[order]] = order  # the widest node of each region, where its pressure is 0
        held = held[1:] if room is None else np.array([self._n])
        faces = []
        for axis in (0, 1):
            conducts, numbers = np.moveaxis(conductivity, axis, 0), np.moveaxis(number, axis, 0)
            if axis == room:
                conducts, numbers = (
                    np.pad(each, ((0, 1), (0, 0)), constant_values=beyond)
                    for each, beyond in ((conducts, np.inf), (numbers, self._n))
                )
            faces.append(_faces(conducts, numbers, around[axis] or axis == room))
        one, other, conductance, self._row = (np.concatenate(parts) for parts in zip(*faces, strict=True))
        self._ends, self._conductance, n_along = (one, other), conductance, len(faces[0][0])
        self._along = slice(n_along), slice(n_along, None)  # the faces across each axis
        self._pressure = _Pressure(self._ends, conductance, held)

    def flow_along(self, axis: int) -> tuple[float, float, Reals]:
        """Hydraulic gap over the largest gap, the residual, and the flow through nodes over its mean."""
        conductance, (one, other), along = self._conductance, self._ends, self._along[axis]
        (rows, across), cut = (self._shape[axis], self._shape[1 - axis]), self._row[along]
        fall = np.zeros(len(one))
        fall[along] = cut == rows - (axis != self.room)  # the mean gradient, where the period ends
        pressure = self._pressure.under(fall)
        fallen = pressure[one] - pressure[other] + fall
        through = conductance * fallen
        dissipated = float(through @ fallen)
        # the flow through each straight cut, weighed by its resistance, as wide cuts round more
        weights = 1.0 / np.bincount(cut, conductance[along])
        out = float(weights @ np.bincount(cut, through[along]) / weights.sum())
        residual = abs(out - dissipated) / dissipated
        if not residual <= _LARGEST_RESIDUAL:
            return np.nan, residual, np.full(self._n, np.nan)
        # through each node in one direction, twice the mean of the flows through its two faces
        both = (
            (np.bincount(one[half], through[half], self._n) + np.bincount(other[half], through[half], self._n))[
                : self._n
            ]
            for half in self._along
        )
        return float(np.cbrt(dissipated * rows / across)), residual, 0.5 * np.hypot(*both) * across / out


def _faces(conductivity: Reals, number: Indices, around: bool) -> tuple[Indices, Indices, Reals, Indices]:
    """Numbers of the nodes before and behind each open face along the first axis, its conductance, and its row."""
    rows = slice(None) if around else slice(-1)
    behind, numbers = np.roll(conductivity, -1, axis=0)[rows], np.roll(number, -1, axis=0)[rows]
    both = (conductivity[rows] > 0.0) & (behind > 0.0)
    conductance = 2.0 / (1.0 / conductivity[rows][both] + 1.0 / behind[both])
    return number[rows][both], numbers[both], conductance, np.nonzero(both)[0]


class _Pressure:
    """Pressures of nodes between faces, 0 at those held, by the factors of the conductances."""

    def __init__(self, ends: tuple[Indices, Indices], conductance: Reals, held: Indices) -> None:
        self._ends, self._conductance = (one, other), _ = ends, conductance
        n = int(max(one.max(), other.max())) + 1
        diagonal, self._leak = np.bincount(one, conductance, n) + np.bincount(other, conductance, n), np.zeros(n)
        # to a pressure of 0; nothing flows there, as what falls adds no fluid to a region
        self._leak[held] = diagonal[held]
        self._scale = scale = 1.0 / np.sqrt(diagonal + self._leak)  # conductances differ by dozens of orders
        coupling = conductance * scale[one] * scale[other]
        upper = scipy.sparse.coo_array((coupling, (one, other)), shape=(n, n))
        matrix = scipy.sparse.csc_array(scipy.sparse.diags_array(np.ones(n)) - upper - upper.T)
        # symmetric and diagonally dominant: pivots stay on the diagonal
        try:
            self._factors = scipy.sparse.linalg.splu(
                matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )
        except MemoryError:
            raise UnusableDataError(
                f"you gave channels of {n} nodes, whose flow takes more memory than there is; gfmd allows a map of "
                "fewer nodes"
            ) from None

    def under(self, fall: Reals) -> Reals:
        """Pressure of each node. From end to end of a face it falls by their difference and by `fall`."""
        (one, other), scale = self._ends, self._scale
        n, pressure = len(scale), np.zeros(len(scale))
        # a diagonal rounded leaks: behind narrow places pressures are refined by the flows through faces, which do not
        for _ in range(_REFINEMENTS):
            flow = self._conductance * (pressure[one] - pressure[other] + fall)
            gained = np.bincount(other, flow, n) - np.bincount(one, flow, n) - self._leak * pressure
            change = scale * self._factors.solve(scale * gained)
            pressure += change
            if abs(change).max() <= _ROUNDING:
                break
        return pressure
