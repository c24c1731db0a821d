"""What the observables of the table are: functions of a contact."""

from pkgutil import resolve_name
from typing import Any

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.contact_area import (
    contact_area_fraction,
    contact_area_fraction_counted,
    contact_area_fraction_edges,
    contact_area_fraction_edges_error,
    edge,
    elastic_nodes,
    filled,
    mean_of_nodes,
    perimeter,
    touching,
)
from gfmd_numba.contact.finiteness import finite_status
from gfmd_numba.contact.observables import recorded
from gfmd_numba.contact.state import Contact, once
from gfmd_numba.roughness import statistics
from gfmd_numba.solvers.status import Status

_OPEN_PRESSURE, _OPEN_GAP = 10.0, 0.02  # of nodes that may still change sides, over what is violated


def kappa(contact: Contact) -> Reals:
    """Area-load coefficient a_r g E* / p, contact area corrected for its edges `[realisation]`; nan unless p > 0."""
    return _over_pressure(contact_area_fraction(contact) * rms_gradient(contact), contact)


def _over_pressure(product: Reals, contact: Contact) -> Reals:
    """Area times gradient over the mean pressure `[realisation]`; nan without one above 0, as adhesion allows."""
    pressure = mean_pressure(contact)
    return np.asarray(product / np.where(pressure > 0.0, pressure, np.nan))


def kappa_counted(contact: Contact) -> Reals:
    """Area-load coefficient with the contact area as counted nodes `[realisation]`."""
    return _over_pressure(contact_area_fraction_counted(contact) * rms_gradient(contact), contact)


def kappa_r(contact: Contact) -> Reals:
    """Area-load coefficient a_r g_r E* / p with the rms gradient over the contact `[realisation]`."""
    return _over_pressure(contact_area_fraction(contact) * rms_gradient_contact(contact), contact)


def kappa_edges(contact: Contact) -> Reals:
    """Area-load coefficient, each contact edge located from the pressures next to it `[realisation]`."""
    return _over_pressure(contact_area_fraction_edges(contact) * rms_gradient(contact), contact)


def kappa_edges_error(contact: Contact) -> Reals:
    """Standard deviation of `kappa_edges` by stretches of too few nodes to locate their edges `[realisation]`."""
    return _over_pressure(contact_area_fraction_edges_error(contact) * rms_gradient(contact), contact)


def kappa_residual_error(contact: Contact) -> Reals:
    """What the solver's residual may change kappa by: as the pressure may, and nodes left open do `[realisation]`.

    With eps = residual times peak pressure, open are nodes of a pressure below 10 eps or a gap below 0.02 eps L_x / E*:
    none that changed sides on the way to 1e-12 had more than 6 and 0.012 (`benchmarks/residual_and_kappa.py`).
    """
    now, pressure = touching(contact), contact.equilibrium.pressure
    along = tuple(range(1, now.ndim))
    violated = np.expand_dims(contact.equilibrium.residual, along) * pressure.max(axis=along, keepdims=True)
    leaving = (now & (pressure <= _OPEN_PRESSURE * violated)).sum(axis=along)
    joining = (~now & (gap(contact) <= _OPEN_GAP * violated)).sum(axis=along)
    # a node that fills a gap of one takes its edges with it, on maps four of at most as much as a profile's
    edges = 1.0 + 2.0 * (now.ndim - 1) * abs(edge(contact).excess)
    nodes = edges * np.maximum(leaving, joining) / now[0].size
    share = violated.reshape(-1) / mean_pressure(contact) + nodes / contact_area_fraction(contact)
    return np.asarray(share * kappa(contact))


@once
def mean_pressure(contact: Contact) -> Reals:
    """Mean contact pressure in g E* `[realisation]`."""
    return mean_of_nodes(contact.equilibrium.pressure)


def peak_pressure(contact: Contact) -> Reals:
    """Largest contact pressure on any node in g E* `[realisation]`."""
    pressure = contact.equilibrium.pressure
    return np.asarray(pressure.max(axis=tuple(range(1, pressure.ndim))))


@once
def rms_gradient(contact: Contact) -> Reals:
    """Rms gradient of the punch in g `[realisation]`."""
    return np.sqrt(_moment(contact, 2))


def rms_gradient_contact(contact: Contact) -> Reals:
    """Rms gradient of the punch over the contact in g `[realisation]`, in which the edge nodes count for less."""
    now = touching(contact)
    axes = tuple(range(1, now.ndim))
    bias = np.expand_dims(edge(contact).perimeter_bias(*perimeter(contact)), axes)
    share = filled(contact).astype(float)
    elastic = elastic_nodes(contact)
    for axis in axes:
        for side in (1, -1):
            share -= bias * (elastic & ~np.roll(now, side, axis=axis))
    square = np.zeros(contact.heights.shape)
    for axis in axes[::-1]:
        square += statistics.gradient(contact.heights.swapaxes(axis, -1)).swapaxes(axis, -1) ** 2
    return np.asarray(np.sqrt((share * square).sum(axis=axes) / share.sum(axis=axes)))


@once
def gap(contact: Contact) -> Reals:
    """Distance between the surfaces in g L_x `[realisation, (y,) x]`; exactly 0 where they touch.

    That of plastic nodes is 0 too: what the displacement penetrates there, the punch has flattened by.
    """
    distance = contact.punch - contact.equilibrium.displacement
    return distance if contact.equilibrium.plastic is None else np.maximum(distance, 0.0)


def mean_gap(contact: Contact) -> Reals:
    """Mean distance between the surfaces in g L_x `[realisation]`."""
    return mean_of_nodes(gap(contact))


def mean_plastic_depth(contact: Contact) -> Reals:
    """Mean depth in g L_x by which the punch has been flattened since it was first loaded `[realisation]`."""
    return mean_of_nodes(np.asarray(contact.plastic_depth))


def plastic_work(contact: Contact) -> Reals:
    """Work per nominal area that flattened the punch in this step, in g^2 E* L_x `[realisation]`.

    A node that gives way bears what it bears at the end of the step, all the way.
    """
    return mean_of_nodes(contact.equilibrium.pressure * contact.flattened)


def nayak(contact: Contact) -> Reals:
    """Nayak's parameter m0 m4 / m2^2 of the punch `[realisation]`."""
    m0, m2, m4 = (_moment(contact, order) for order in (0, 2, 4))
    return statistics.nayak_of_moments(m0, m2, m4, contact.heights.ndim - 1)


def elastic_energy(contact: Contact) -> Reals:
    """Elastic energy per nominal area of what the punch adds to the deformation, in g^2 E* L_x `[realisation]`.

    That of all waves but the mean, -<p (u - <u>)> / 2 by Clapeyron, and <tau (v - <v>)> / 2 of each tangential one.
    """
    along = tuple(range(1, contact.heights.ndim))
    u, tangential = contact.equilibrium.displacement, contact.equilibrium.tangential
    work = -contact.equilibrium.pressure * (u - u.mean(axis=along, keepdims=True))
    if tangential is not None:
        v = tangential.displacement
        inside = tuple(axis + 1 for axis in along)
        work = work + (tangential.traction * (v - v.mean(axis=inside, keepdims=True))).sum(axis=1)
    return np.asarray(0.5 * work.mean(axis=along))


@once
def _power(contact: Contact) -> Reals:
    return statistics.power(contact.heights, _periods(contact))


def _moment(contact: Contact, order: int) -> Reals:
    """Moment of the spectrum of the punch `[realisation]`, in g^2 L_x^(2 - order)."""
    return statistics.moment_of_power(_power(contact), contact.heights.shape[1:], order, _periods(contact))


def _periods(contact: Contact) -> tuple[float, ...]:
    return (1.0,) * (contact.heights.ndim - 1)


def measure(contact: Contact) -> dict[str, npt.NDArray[Any]]:
    """All observables of a contact, name -> `[realisation]`; those of a run that is not ok are not-a-number."""
    found = contact.equilibrium
    rows = recorded(found.plastic is not None)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        values = {name: _value(name, row.function, contact) for name, row in rows.items()}
    fields = {"heights": contact.heights, "pressure": found.pressure, "displacement": found.displacement}
    if found.tangential is not None:
        fields |= {"traction": found.tangential.traction, "sideways": found.tangential.displacement}
    status = finite_status(values | fields)
    for name, row in rows.items():
        if row.of == "contact":
            values[name] = np.where(status != Status.ok, np.nan, values[name])
    return values | {"status": status}


def _value(name: str, function: str | None, contact: Contact) -> npt.NDArray[Any]:
    value: npt.NDArray[Any] = (
        getattr(contact.equilibrium, name) if function is None else resolve_name(function)(contact)
    )
    return value
