"""Functions that compute the observables of the table from a contact: where it touches, and what follows from that."""

from collections.abc import Callable, Mapping, Sequence
from functools import cache, wraps
from pkgutil import resolve_name
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.arrays.regions import closed, regions
from gfmd_numba.contact import area_correction
from gfmd_numba.contact.observables import OBSERVABLES, PATH_OBSERVABLES, Observable, recorded
from gfmd_numba.contact.state import Contact
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import statistics
from gfmd_numba.solvers.certificate import pressure_scale
from gfmd_numba.solvers.status import Status, withdrawn

Found = TypeVar("Found")
_NEARLY_ALL = 0.9  # of the sides of a smooth contact can be located
_UNDEFINED_AT_TIMES = {name for name, row in (OBSERVABLES | PATH_OBSERVABLES).items() if row.undefined_at_times}
_OPEN_PRESSURE, _OPEN_GAP = 10.0, 0.02  # of nodes that may still change sides, over what is violated


def once(function: Callable[[Contact], Found]) -> Callable[[Contact], Found]:
    """Compute a function of a contact once, and keep what it has found with the contact; nobody changes that."""

    @wraps(function)
    def found(contact: Contact) -> Found:
        if function not in contact.found:
            contact.found[function] = function(contact)
        known: Found = contact.found[function]
        return known

    return found


def of_profiles(
    function: Callable[[Contact], Found],
    of_maps: Callable[[Contact], Any] = lambda contact: np.full(len(contact.heights), np.nan),
) -> Callable[[Contact], Found]:
    """The same of profiles; of maps what another function finds, or not-a-number `[realisation]`: it is not known."""

    @wraps(function)
    def found(contact: Contact) -> Found:
        return function(contact) if contact.heights.ndim == 2 else of_maps(contact)

    return found


def touching(contact: Contact) -> npt.NDArray[np.bool_]:
    """Nodes in contact `[realisation, (y,) x]`: those on which the hard wall presses."""
    return contact.equilibrium.touching


@once
def edge(contact: Contact) -> area_correction.Edge:
    """What the grid makes of the edges of the contact."""
    now = contact.heights[0]

    def felt(q: Reals) -> Reals:
        return contact.change.applied_to(SpectralResponse.of_normal(contact.stiffness(q))).normal

    of_waves = felt if contact.change.wear_compliance else contact.stiffness
    return area_correction.edge(of_waves, 1.0 / now.shape[-1])


@once
def elastic_nodes(contact: Contact) -> npt.NDArray[np.bool_]:
    """Touching nodes that are neither plastic nor in a fringe, nor have flowed below `[realisation, (y,) x]`.

    At an edge with elastic nodes, the pressure goes to zero as under an elastic body, and counted nodes reach too far.
    If the uppermost sublayer has flowed, the pressure ends at a finite value, and counted nodes are right in the mean.
    """
    now, plastic, flow = touching(contact), contact.equilibrium.plastic, contact.memory.get("flow")
    if flow is not None:
        return np.asarray(now & (flow.equivalent[0].reshape(now.shape) == 0.0))
    return now if plastic is None else now & ~plastic & ~_fringe(contact, plastic)


@once
def filled(contact: Contact) -> npt.NDArray[Any]:
    """Share of each node that is in contact `[realisation, (y,) x]`, but for the edges of elastic nodes.

    Around a plastic spot pressure falls from the hardness to zero within a fringe. One narrower than a node is a
    node that the edge of the spot crosses: it is in contact where it bears the hardness, a share p / p_H of it. So the
    area of a wholly plastic contact is the load over the hardness.
    """
    plastic = contact.equilibrium.plastic
    if plastic is None:
        return touching(contact)
    pressure = contact.equilibrium.pressure
    hardness = pressure.max(axis=_nodes(contact), keepdims=True)  # that of a fringe, which has plastic neighbours
    share = np.divide(pressure, hardness, out=np.zeros(pressure.shape), where=hardness > 0.0)
    return np.where(_fringe(contact, plastic), share, touching(contact))


def beside(contact: Contact, flags: npt.NDArray[np.bool_], side: int, axis: int) -> npt.NDArray[np.bool_]:
    """Flag of the neighbour on one side (1: before, -1: behind) of each node.

    Beyond the end of a window nothing is known: a node there counts as its own neighbour.
    """
    found = np.roll(flags, side, axis=axis)
    if contact.ends and contact.ends[axis - 1]:
        end = 0 if side == 1 else -1
        np.moveaxis(found, axis, 0)[end] = np.moveaxis(flags, axis, 0)[end]
    return found


def _fringe(contact: Contact, plastic: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Elastic nodes with both plastic and open neighbours."""
    now = touching(contact)
    next_to_plastic, next_to_open = (
        np.logical_or.reduce([beside(contact, some, side, axis) for axis in range(1, now.ndim) for side in (1, -1)])
        for some in (plastic, ~now)
    )
    return np.asarray(now & ~plastic & next_to_plastic & next_to_open)


@once
def n_segments(contact: Contact) -> npt.NDArray[np.int64]:
    """Number of separate stretches of contact `[realisation]`, or clusters; 0 in full contact, which has no edge."""
    now, around = touching(contact), tuple(not end for end in contact.ends or (False,) * len(_nodes(contact)))
    upto = np.maximum.accumulate(regions(now, around).max(axis=_nodes(contact)))
    return np.where(now.all(axis=_nodes(contact)) & all(around), 0, np.diff(upto, prepend=0)).astype(np.int64)


def _open_sides(contact: Contact, nodes: npt.NDArray[np.bool_]) -> Indices:
    """Number of open neighbours of some touching nodes along each axis (y,) x `[axis, realisation, (y,) x]`, 0 to 2."""
    now = touching(contact)
    along = [[nodes & ~beside(contact, now, side, axis) for side in (1, -1)] for axis in range(1, now.ndim)]
    return np.asarray(np.sum(along, axis=1, dtype=np.int8))


@once
def perimeter(contact: Contact) -> tuple[Indices, ...]:
    """Number of neighbours along x, and on maps along y, of which one touches elastically, one not `[realisation]`."""
    sides = _open_sides(contact, elastic_nodes(contact))
    return tuple(each.reshape(len(each), -1).sum(axis=1) for each in sides[::-1])


def _above_flow(contact: Contact) -> Indices | int:
    """Number of sides of edges below which the body has flowed: anywhere within a spacing `[realisation]`."""
    if "flow" not in contact.memory:
        return 0
    sides = _open_sides(contact, touching(contact) & ~elastic_nodes(contact))
    return np.asarray(sides.sum(axis=(0, *(1 + axis for axis in _nodes(contact)))))


@once
def contact_area_fraction(contact: Contact) -> Reals:
    """Contact length over L_x, or area over L_x^2, with the mean correction for its edges `[realisation]`."""
    sides = perimeter(contact)
    excess = edge(contact).perimeter_bias(*sides) * sum(sides)
    return np.asarray(mean_of_nodes(filled(contact)) - excess / contact.heights[0].size)


def contact_area_fraction_error(contact: Contact) -> Reals:
    """Standard deviation of the corrected contact length over L_x, or area over L_x^2 `[realisation]`.

    Edges lie anywhere within a spacing, with a variance of 1/12 a side of a node; the nodes in a disc at a random place
    have 0.057 a side (Kendall, Q. J. Math. 19:1, 1948: 0.677 r^(1/2) for a radius r). Mirror images of an edge lie at
    the same place within theirs. On thin bodies also their mean position is uncertain, where contacts are small.
    """
    sides, nodes = sum(perimeter(contact)), touching(contact).sum(axis=_nodes(contact))
    across = (nodes / np.maximum(n_segments(contact), 1)) ** (1.0 / len(_nodes(contact)))
    of_mean = edge(contact).short * sides / np.maximum(across, 1.0)
    unknown = contact.fields_in_period * (sides + _above_flow(contact))
    return np.asarray(np.sqrt(unknown / 12.0 + of_mean**2) / contact.heights[0].size)


@once
def located_length(contact: Contact) -> tuple[Reals, Reals]:
    """Contact length over L_x with edges where the pressures at their two last nodes put them, and its deviation.

    Of profiles. The standard deviation is that of stretches too short to tell `[realisation]`.
    """
    found, ends = contact.equilibrium, any(contact.ends)
    length, unknown = area_correction.contact_length(
        found.pressure, found.touching, edge(contact), elastic_nodes(contact), filled(contact), ends
    )
    above_flow = np.sqrt(_above_flow(contact) / 12.0) / found.touching.shape[1]
    return length, np.sqrt(contact.fields_in_period) * np.hypot(unknown, above_flow)


@of_profiles
def mean_segment_length(contact: Contact) -> Reals:
    """Mean length of a stretch of contact over L_x `[realisation]`; that of full contact is 1."""
    area, segments = contact_area_fraction(contact), n_segments(contact)
    return np.asarray(np.where(area == 1.0, 1.0, area / segments))


def contact_radius(contact: Contact) -> Reals:
    """Half the contact length in L_x, of a map the radius of a disc as large as the contact area `[realisation]`.

    Edges are where the pressures next to them say, if these say so of nearly all, and elsewhere at their mean position.
    """
    area, unknown = of_profiles(located_length, _located_area)(contact)
    # pressure at an edge is no root of the distance where open nodes bear tractions
    pulled = ((contact.equilibrium.pressure != 0.0) & ~touching(contact)).any(axis=_nodes(contact))
    found = np.where((unknown == 0.0) & ~pulled, area, contact_area_fraction(contact))
    return area_correction.radius(found, len(_nodes(contact)))


def _located_area(contact: Contact) -> tuple[Reals, Flags]:
    """Contact area of maps over L_x^2 with its edges located, and whether many are unknown `[realisation]`."""
    now, sides = touching(contact), perimeter(contact)
    half_space = area_correction.HALF_SPACE.excess
    is_thin = abs(edge(contact).excess - half_space) > area_correction.HALF_SPACE_TO_EDGES * half_space
    # where a body has crept a node bears what it has been through, and not the root of its distance alone
    creeps = contact.before is not None and "springs" in contact.before.memory
    if is_thin or (creeps and np.any(contact.change.normal_offset)):
        return np.zeros(len(now)), np.ones(len(now), dtype=np.bool_)
    bias, ends = edge(contact).perimeter_bias(*sides), contact.ends or (False, False)
    pressure, filled_nodes = contact.equilibrium.pressure, filled(contact)
    area, share = area_correction.contact_area(pressure, now, bias, elastic_nodes(contact), filled_nodes, ends)
    return area / now[0].size, share < _NEARLY_ALL


def mean_of_nodes(field: npt.NDArray[Any]) -> Reals:
    """Mean over the nodes of each realisation."""
    return np.asarray(field.mean(axis=tuple(range(1, field.ndim))))


def kappa_residual_error(contact: Contact) -> Reals:
    """Possible change of kappa by the residual of the solver: of the pressure, and of nodes that may change sides.

    With eps = residual times peak pressure, open are nodes of a pressure below 10 eps or a gap below 0.02 eps L_x / E*:
    none that changed sides on the way to 1e-12 had more than 6 and 0.012 (`benchmarks/residual_and_kappa.py`). The
    pressure of the wall counts, without the traction of a law. Under a cohesive law, whose traction depends on gap and
    slip together, it counts from the least one of the touching nodes.
    """
    now, pressure, along = touching(contact), contact.equilibrium.pressure, _nodes(contact)
    violated = np.expand_dims(contact.equilibrium.residual, along) * pressure.max(axis=along, keepdims=True)
    wall = pressure + contact.law_traction_at_contact
    least = np.where(now, wall, 0.0).min(axis=along, keepdims=True, initial=0.0)
    leaving = (now & (wall - least <= _OPEN_PRESSURE * violated)).sum(axis=along)
    joining = (~now & (gap(contact) <= _OPEN_GAP * violated)).sum(axis=along)
    # a node that fills a gap of one takes its edges with it, on maps four of at most as much as a profile's
    edges = 1.0 + 2.0 * (now.ndim - 1) * abs(edge(contact).excess)
    nodes = edges * np.maximum(leaving, joining) / now[0].size
    share = violated.reshape(-1) / mean_pressure(contact) + nodes / contact_area_fraction(contact)
    return np.asarray(share * kappa(contact))


def peak_pressure(contact: Contact) -> Reals:
    """Largest contact pressure on any node in g E* `[realisation]`."""
    return np.asarray(contact.equilibrium.pressure.max(axis=_nodes(contact)))


@once
def rms_gradient(contact: Contact) -> Reals:
    """Rms gradient of the punch in g `[realisation]`."""
    if any(contact.ends):
        return statistics.rms_gradient(contact.roughness, _periods(contact), contact.ends)
    return np.sqrt(_moments(contact)[1])


@once
def rms_gradient_contact(contact: Contact) -> Reals:
    """Rms gradient of the punch over the contact in g `[realisation]`, in which the edge nodes count for less."""
    bias = np.expand_dims(edge(contact).perimeter_bias(*perimeter(contact)), _nodes(contact))
    share = filled(contact) - bias * _open_sides(contact, elastic_nodes(contact)).sum(axis=0)
    squares = statistics.weighed_square_gradient(contact.roughness, share, _periods(contact), contact.ends)
    return np.asarray(np.sqrt(squares / share.sum(axis=_nodes(contact))))


@once
def gap(contact: Contact) -> Reals:
    """Distance between the surfaces in g L_x `[realisation, (y,) x]`; exactly 0 where they touch.

    The gap of plastic nodes is 0 too: the punch is flattened by the depth of penetration.
    """
    distance = contact.punch - contact.equilibrium.displacement
    return distance if contact.equilibrium.plastic is None else np.maximum(distance, 0.0)


def _mean(field: Callable[[Contact], Any]) -> Callable[[Contact], Reals]:
    """Mean over the nodes of a field of each contact `[realisation]`."""
    return lambda contact: mean_of_nodes(np.asarray(field(contact)))


contact_area_fraction_counted = _mean(touching)
plastic_area_fraction = _mean(lambda contact: contact.equilibrium.plastic)
mean_plastic_depth = _mean(lambda contact: contact.plastic_depth)
mean_worn_depth = _mean(lambda contact: contact.memory["worn"])
mean_pressure = once(_mean(lambda contact: contact.equilibrium.pressure))
mean_gap = _mean(lambda contact: gap(contact))


def _over_pressure(product: Callable[[Contact], Reals]) -> Callable[[Contact], Reals]:
    """Return kappa = a_r g E* / p `[realisation]`, a_r / p a secant and g that of this surface; nan if p <= 0."""

    def found(contact: Contact) -> Reals:
        pressure = mean_pressure(contact)
        return np.asarray(product(contact) / np.where(pressure > 0.0, pressure, np.nan))

    return found


kappa = _over_pressure(lambda contact: contact_area_fraction(contact) * rms_gradient(contact))
kappa_counted = _over_pressure(lambda contact: contact_area_fraction_counted(contact) * rms_gradient(contact))
kappa_r = _over_pressure(lambda contact: contact_area_fraction(contact) * rms_gradient_contact(contact))
kappa_edges = of_profiles(_over_pressure(lambda contact: located_length(contact)[0] * rms_gradient(contact)))
kappa_edges_error = of_profiles(_over_pressure(lambda contact: located_length(contact)[1] * rms_gradient(contact)))


def approach(contact: Contact) -> Reals:
    """Return how far the punch has sunk in since first touch in g L_x `[realisation]`, without a period."""
    return np.asarray(np.reshape(np.asarray(contact.approach), -1) * np.ones(len(contact.heights)))


def edge_contact(contact: Contact) -> Reals:
    """Touching nodes at the ends of a window over all nodes there `[realisation]`."""
    touches = closed(gap(contact))
    outermost = np.zeros(touches.shape, dtype=np.bool_)
    for axis, ends in enumerate(contact.ends, 1):
        np.moveaxis(outermost, axis, 0)[[0, -1]] |= ends
    return np.asarray((touches & outermost).sum(axis=_nodes(contact)) / outermost[0].sum())


def slid_over_peaks(contact: Contact, sliding: Sequence[float]) -> Reals:
    """Longest way of a touching node past the body over the mean distance of the peaks, in g.

    nan without a period, and where no way is known `[realisation]`.
    """
    if contact.ends or contact.tangential_displacement is None:
        return np.full(len(contact.heights), np.nan)
    along = _nodes(contact)
    m0, m2 = _moments(contact)[0], _moments(contact)[1] / len(along)  # along any direction
    way = np.linalg.norm(np.reshape(sliding, (-1, *(1,) * len(along))) - contact.tangential_displacement, axis=1)
    touches = closed(gap(contact))
    counts = touches | ~touches.any(axis=along, keepdims=True)
    distance = statistics.distance_of_peaks(m0, m2, nayak(contact))
    return np.asarray(np.max(way, axis=along, where=counts, initial=0.0) / distance)


def plastic_work(contact: Contact) -> Reals:
    """Work per nominal area that flattened the punch in this step, in g^2 E* L_x `[realisation]`.

    A node that yields bears its pressure at the end of the step over all of its penetration in the step.
    """
    return mean_of_nodes(contact.equilibrium.pressure * contact.plastic_penetration)


def time_error(contact: Contact) -> Reals:
    """Relative error by the divisions of all steps so far `[realisation]`."""
    return np.full(len(contact.heights), contact.time_error)


def hysteretic_friction(contact: Contact) -> Reals:
    """Force against the sliding of the punch along x, <p du/dx>, over the load, in g `[realisation]`.

    Where a punch slides steadily it is the energy that the body dissipates per distance.
    """
    u, out = contact.equilibrium.displacement, contact.change.normal_offset
    return _traction_along(contact, u if out is None else u + out) / mean_pressure(contact)


def hysteretic_friction_error(contact: Contact) -> Reals:
    """Difference of that to <p d(punch)/dx> over the load, in g `[realisation]`: slopes differ next to the contact."""
    return abs(_traction_along(contact, gap(contact))) / mean_pressure(contact)


def _traction_along(contact: Contact, surface: Reals) -> Reals:
    """Mean traction along x of the pressure on a surface `[realisation, (y,) x]`, in g^2 E* `[realisation]`.

    Where x has no period the slope is that between the neighbours of a node.
    """
    pressure, dimension = contact.equilibrium.pressure, surface.ndim - 1
    if contact.ends and contact.ends[-1]:
        return mean_of_nodes(pressure * np.gradient(surface, 1.0 / surface.shape[-1], axis=-1))
    waves = [grid.coefficients(field, dimension) for field in (pressure, surface)]
    products = (waves[0].conj() * grid.derivative(waves[1])).real * grid.multiplicity(surface.shape[-1])
    return np.asarray(products.sum(axis=_nodes(contact)))


def full_contact_rms_pressure(contact: Contact) -> Reals:
    """Rms fluctuation of the pressure in full contact in g E* `[realisation]`.

    That of a window is g E*/2, as if its roughness went on beyond the ends.

    That of a body that creeps is what the relaxed one bears, or under a steadily sliding punch that one itself.
    """
    change = contact.change
    if contact.ends:
        return np.asarray(0.5 * rms_gradient(contact))
    if change.factor == 1.0 and change.wear_compliance == 0.0:
        return contact.equilibrium.full_contact_rms_pressure
    # the solver knows a division of the step alone, with what has crept before and what wears off
    bodies = SpectralResponse.of_normal(contact.stiffness(grid.magnitudes(contact.heights.shape[1:])))
    return pressure_scale(contact.heights - contact.memory.get("worn", 0.0), bodies)


def nayak(contact: Contact) -> Reals:
    """Nayak's parameter m0 m4 / m2^2 of the punch `[realisation]`."""
    return statistics.nayak_of_moments(*_moments(contact), contact.heights.ndim - 1)


def elastic_energy(contact: Contact) -> Reals:
    """Elastic energy per nominal area of what the punch adds to the deformation, in g^2 E* L_x `[realisation]`.

    With a period it is the energy of all waves but the mean, -<p (u - <u>)> / 2 by Clapeyron, plus <tau (v - <v>)> / 2
    for each tangential component. Without a period it is the whole energy, -<p u> / 2. A viscoelastic body has the
    energy of its springs.
    """
    springs = contact.memory.get("springs")
    if springs is not None:
        return np.asarray(springs.energy(contact.approach is None))
    along = _nodes(contact)
    u, tangential = contact.equilibrium.displacement, contact.equilibrium.tangential
    if contact.approach is None:
        u = u - u.mean(axis=along, keepdims=True)
    work = -contact.equilibrium.pressure * u
    if tangential is not None:
        v = tangential.displacement
        if contact.approach is None:
            v = v - v.mean(axis=tuple(axis + 1 for axis in along), keepdims=True)
        work = work + (tangential.traction * v).sum(axis=1)
    return np.asarray(0.5 * work.mean(axis=along))


@once
def _moments(contact: Contact) -> tuple[Reals, Reals, Reals]:
    """Moments 0, 2 and 4 of the spectrum of the punch `[realisation]`, in g^2 L_x^(2 - order)."""
    periods = _periods(contact)
    power = statistics.power(contact.roughness, periods)
    m0, m2, m4 = statistics.moments_of_power(power, contact.heights.shape[1:], (0, 2, 4), periods)
    return m0, m2, m4


def _nodes(contact: Contact) -> tuple[int, ...]:
    """Axes of the nodes of each field."""
    return tuple(range(1, contact.heights.ndim))


def _periods(contact: Contact) -> tuple[float, ...]:
    return (1.0,) * (contact.heights.ndim - 1)


def recorded_of(contact: Contact) -> dict[str, Observable]:
    """Rows of all observables that a contact has."""
    before, has_hardness, has_form = contact.before, contact.equilibrium.plastic is not None, contact.form is not None
    if before is None or contact.step is None:
        return recorded(has_hardness, contact.ends, has_form)
    steadily, passes = contact.step.speed > 0.0, before.passing is not None
    return recorded(has_hardness, contact.ends, has_form, before.memory, steadily, passes)


def measure(contact: Contact) -> dict[str, npt.NDArray[Any]]:
    """All observables of a contact, name -> `[realisation]`; those of a run that is not ok are not-a-number."""
    found, rows = contact.equilibrium, recorded_of(contact)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        values = {
            name: np.asarray(getattr(found, name) if row.of == "run" else _function(row.function_of(name))(contact))
            for name, row in rows.items()
        }
    fields = {"heights": contact.heights, "pressure": found.pressure, "displacement": found.displacement}
    if found.tangential is not None:
        fields |= {"traction": found.tangential.traction, "sideways": found.tangential.displacement}
    status = finite_status(values | fields)
    for name, row in rows.items():
        if row.of == "contact":
            values[name] = np.where(status != Status.ok, np.nan, values[name])
    return values | {"status": status}


_function = cache(resolve_name)


def finite_status(values: Mapping[str, npt.NDArray[Any]]) -> npt.NDArray[np.int8]:
    """Status `[...]` of results by name `[..., node]`, `nonfinite` where one that was ok holds no number.

    A measure that is undefined without contact may be not-a-number; an infinite measure is always an error.
    """
    status = np.asarray(values["status"])
    bad = np.zeros(status.shape, dtype=np.bool_)
    for name, value in values.items():
        wrong = np.isinf(value) if name in _UNDEFINED_AT_TIMES else ~np.isfinite(value)
        bad |= wrong.reshape(*status.shape, -1).any(axis=-1)
    return withdrawn(status, bad, Status.nonfinite)
