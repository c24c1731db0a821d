"""The table of measures: what is recorded of every contact, with units and meaning."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from gfmd_numba.contact.contact_area import (
    contact_area_fraction,
    contact_area_fraction_counted,
    contact_area_fraction_edges,
    contact_area_fraction_edges_error,
    contact_area_fraction_error,
    mean_of_nodes,
    mean_segment_length,
    n_segments,
    perimeter,
    touching,
)
from gfmd_numba.contact.edges import EDGE_BIAS, perimeter_bias
from gfmd_numba.contact.finiteness import finite_status
from gfmd_numba.contact.solution import Contact
from gfmd_numba.roughness import statistics
from gfmd_numba.solvers.status import Status

Reals = npt.NDArray[np.float64]

_OPEN_PRESSURE, _OPEN_GAP = 10.0, 0.02  # of nodes that may still change sides, over what is violated


def kappa(contact: Contact) -> Reals:
    """Area-load coefficient a_r g E* / p, contact area corrected for its edges `[realisation]`; nan unless p > 0."""
    return _over_pressure(contact_area_fraction(contact) * rms_gradient(contact), contact)


def _over_pressure(product: Reals, contact: Contact) -> Reals:
    """Area times gradient over the mean pressure `[realisation]`; nan without one above 0, as adhesion allows."""
    pressure = mean_pressure(contact)
    return np.asarray(product / np.where(pressure > 0.0, pressure, np.nan))


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
    edges = 1.0 + 2.0 * (now.ndim - 1) * EDGE_BIAS
    nodes = edges * np.maximum(leaving, joining) / now[0].size
    share = violated.reshape(-1) / mean_pressure(contact) + nodes / contact_area_fraction(contact)
    return np.asarray(share * kappa(contact))


def mean_pressure(contact: Contact) -> Reals:
    """Mean contact pressure in g E* `[realisation]`."""
    return mean_of_nodes(contact.equilibrium.pressure)


def rms_gradient(contact: Contact) -> Reals:
    """Rms gradient of the punch in g `[realisation]`."""
    return statistics.rms_gradient(contact.heights, _periods(contact))


def rms_gradient_contact(contact: Contact) -> Reals:
    """Rms gradient of the punch over the contact in g `[realisation]`, in which the edge nodes count for less."""
    now = touching(contact)
    axes = tuple(range(1, now.ndim))
    bias = EDGE_BIAS if now.ndim == 2 else np.expand_dims(perimeter_bias(*perimeter(contact)), axes)
    share = now.astype(float)
    for axis in axes:
        for side in (1, -1):
            share -= bias * (now & ~np.roll(now, side, axis=axis))
    square = statistics.gradient(contact.heights) ** 2
    if now.ndim == 3:
        square += statistics.gradient(contact.heights.swapaxes(1, 2)).swapaxes(1, 2) ** 2
    return np.asarray(np.sqrt((share * square).sum(axis=axes) / share.sum(axis=axes)))


def gap(contact: Contact) -> Reals:
    """Distance between the surfaces in g L_x `[realisation, (y,) x]`; exactly 0 where they touch."""
    return contact.punch - contact.equilibrium.displacement


def elastic_energy(contact: Contact) -> Reals:
    """Elastic energy per nominal area of what the punch adds to the deformation, in g^2 E* L_x `[realisation]`.

    That of all waves but the mean, -<p (u - <u>)> / 2 by Clapeyron, and <tau (v - <v>)> / 2 of the tangential ones.
    """
    along = tuple(range(1, contact.heights.ndim))
    u, tangential = contact.equilibrium.displacement, contact.equilibrium.tangential
    work = -contact.equilibrium.pressure * (u - u.mean(axis=along, keepdims=True))
    if tangential is not None:
        v = tangential.displacement
        work = work + tangential.traction * (v - v.mean(axis=along, keepdims=True))
    return np.asarray(0.5 * work.mean(axis=along))


def _periods(contact: Contact) -> tuple[float, ...]:
    return (1.0,) * (contact.heights.ndim - 1)


@dataclass(frozen=True)
class Measure:
    """A recorded quantity: what it tells of, and the unit that turns it into SI.

    Those are 1, g, g L_x, g E*, g^2 E* L_x and seconds; E*/stiffness is 1 but for a scene with a `stiffness_scale`.
    """

    name: str
    of: Literal["contact", "surface", "run"]
    unit: Literal["1", "E*/stiffness", "gradient", "height", "pressure", "energy", "s"]
    long_name: str
    function: Callable[[Contact], npt.NDArray[Any]]


MEASURES = (
    Measure(
        "kappa",
        "contact",
        "E*/stiffness",
        "area-load coefficient a_r g E* / p, contact area corrected for its edges",
        kappa,
    ),
    Measure(
        "kappa_residual_error",
        "contact",
        "E*/stiffness",
        "largest change of kappa to expect from the residual of the solver",
        kappa_residual_error,
    ),
    Measure(
        "kappa_counted",
        "contact",
        "E*/stiffness",
        "area-load coefficient a_r g E* / p, contact area as counted nodes",
        lambda c: _over_pressure(contact_area_fraction_counted(c) * rms_gradient(c), c),
    ),
    Measure(
        "kappa_r",
        "contact",
        "E*/stiffness",
        "area-load coefficient a_r g_r E* / p with the rms gradient over the contact",
        lambda c: _over_pressure(contact_area_fraction(c) * rms_gradient_contact(c), c),
    ),
    Measure(
        "contact_area_fraction",
        "contact",
        "1",
        "contact length over L_x, or area over L_x^2, corrected for its edges",
        contact_area_fraction,
    ),
    Measure(
        "contact_area_fraction_counted",
        "contact",
        "1",
        "touching nodes over all nodes",
        contact_area_fraction_counted,
    ),
    Measure(
        "contact_area_fraction_error",
        "contact",
        "1",
        "standard deviation of contact_area_fraction by edges between the nodes of profiles",
        contact_area_fraction_error,
    ),
    Measure(
        "kappa_edges",
        "contact",
        "E*/stiffness",
        "area-load coefficient a_r g E* / p, each contact edge located from the pressures beside it",
        lambda c: _over_pressure(contact_area_fraction_edges(c) * rms_gradient(c), c),
    ),
    Measure(
        "kappa_edges_error",
        "contact",
        "E*/stiffness",
        "standard deviation of kappa_edges by stretches of too few nodes to locate their edges",
        lambda c: _over_pressure(contact_area_fraction_edges_error(c) * rms_gradient(c), c),
    ),
    Measure("n_segments", "contact", "1", "number of separate stretches of contact, or clusters of a map", n_segments),
    Measure(
        "mean_segment_length",
        "contact",
        "1",
        "mean length of a stretch of contact over L_x, corrected for its edges",
        mean_segment_length,
    ),
    Measure(
        "elastic_energy",
        "contact",
        "energy",
        "elastic energy per nominal area of the deformation by the punch, beyond uniform compression",
        elastic_energy,
    ),
    Measure("mean_pressure", "contact", "pressure", "mean contact pressure", mean_pressure),
    Measure("mean_gap", "contact", "height", "mean gap between the surfaces", lambda c: mean_of_nodes(gap(c))),
    Measure("rms_gradient", "surface", "gradient", "rms gradient of the punch", rms_gradient),
    Measure(
        "rms_gradient_contact",
        "contact",
        "gradient",
        "rms gradient of the punch over the contact",
        rms_gradient_contact,
    ),
    Measure(
        "nayak",
        "surface",
        "1",
        "Nayak's parameter m0 m4 / m2^2 of the punch",
        lambda c: statistics.nayak(c.heights, _periods(c)),
    ),
    Measure(
        "full_contact_pressure",
        "surface",
        "pressure",
        "rms fluctuation of the pressure in full contact, (sum_q K(q)^2 |h(q)|^2)^(1/2)",
        lambda c: c.equilibrium.full_contact_pressure,
    ),
    Measure("status", "run", "1", "how the run ended", lambda c: c.equilibrium.status),
    Measure(
        "residual",
        "run",
        "1",
        "largest violation of the contact conditions over the largest pressure, or relative load imbalance",
        lambda c: c.equilibrium.residual,
    ),
    Measure("n_iterations", "run", "1", "solver iterations", lambda c: c.equilibrium.n_iterations),
    Measure(
        "n_transforms", "run", "1", "fast Fourier transforms of the whole grid", lambda c: c.equilibrium.n_transforms
    ),
    Measure("wall_time", "run", "s", "time spent in the solver", lambda c: c.equilibrium.wall_time),
)


def measure(contact: Contact) -> dict[str, npt.NDArray[Any]]:
    """All measures of a contact, name -> `[realisation]`; those of a run that is not ok are not-a-number."""
    found = contact.equilibrium
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        values = {m.name: m.function(contact) for m in MEASURES}
    fields = {"heights": contact.heights, "pressure": found.pressure, "displacement": found.displacement}
    if found.tangential is not None:
        fields |= {"traction": found.tangential.traction, "sideways": found.tangential.displacement}
    status = finite_status(values | fields)
    for m in MEASURES:
        if m.of == "contact":
            values[m.name] = np.where(status != Status.ok, np.nan, values[m.name])
    return values | {"status": status}
