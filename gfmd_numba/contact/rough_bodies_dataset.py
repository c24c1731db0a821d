"""What rough elastic bodies add to the dataset of a contact: topographies, own displacements, and the next order."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.bodies import contact_modulus
from gfmd_numba.contact.dataset import cf_attributes, refuse_nonfinite, units
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.rough_body import STEEPEST, THICKNESS, RoughBody, change_of_thickness
from gfmd_numba.contact.rough_body_observables import OF_PUNCH, OF_SUM, ROUGH_BODY_OBSERVABLES
from gfmd_numba.contact.rough_surfaces import BODIES
from gfmd_numba.contact.slopes import tractions_on
from gfmd_numba.contact.state import Contact
from gfmd_numba.contact.two_step import Pressed
from gfmd_numba.elasticity import fields, map_topography, topography
from gfmd_numba.elasticity.map_topography import MapResponse
from gfmd_numba.elasticity.topography import Response
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import statistics
from gfmd_numba.scene import Scene

_NEXT = "next_order"
_OUT = "normal displacement of the {}, out of it"
_SIDEWAYS = "tangential displacement of the {}"


def add_bodies(
    found: xr.Dataset,
    scene: Scene,
    bodies: tuple[RoughBody, ...],
    rms_gradient: float,
    problem: Problem,
    pressed: Pressed,
) -> None:
    """Add heights and displacements `[(y,) x]` of each body, of profiles forming tractions, and the next order."""
    found["height"].attrs["long_name"] = "sum of the heights of both surfaces, peaks towards each other"
    for name in ("rms_gradient", "rms_gradient_contact", "nayak"):
        attributes = found[name].attrs
        attributes["long_name"] = attributes["long_name"].replace(OF_PUNCH, OF_SUM)
    length, unit = scene.length or 1.0, units(scene)
    responses: tuple[Response | MapResponse, ...] = pressed.responses
    for name, body, response in zip(BODIES, bodies, responses, strict=False):
        prefix, whose = ("", "body") if name == "body" else ("counter_body_", "counter body")
        stress = contact_modulus(scene) / body.share
        scales = {"height": length, "pressure": stress}
        outwards = f"topography of the {whose}, peaks outwards"
        found[f"{name}_height"] = found["height"].dims, body.heights * length, cf_attributes(outwards, unit["height"])
        along, pressure = tractions_on(body, problem, pressed.contact, rms_gradient, pressed.correction.pairing)
        own = (
            _of_profile(body, response, along, pressure)
            if isinstance(response, Response)
            else _of_map(body, response, along, pressure)
        )
        for variable, kind, long_name, values in own:
            attributes = cf_attributes(long_name.format(whose), unit[kind])
            found[prefix + variable] = found["height"].dims, values * scales[kind], attributes
        if pressed.correction.pairing is None:
            continue
        without = replace(problem, tractions=None)  # prescribed tractions have variables of their own
        along, pressure = tractions_on(body, without, pressed.contact, rms_gradient, pressed.correction.pairing)
        assert along is not None  # between inclined surfaces
        for variable, long_name, values in _of_inclined(along, pressure, prefix):
            attributes = cf_attributes(long_name.format(whose), unit["pressure"])
            found[prefix + variable] = found["height"].dims, values * stress, attributes
    if pressed.correction.pairing is not None and problem.interface.couples:
        scale = rms_gradient * contact_modulus(scene)
        for variable, long_name, values in _on_surface(pressed.contact):
            found[variable] = found["height"].dims, values * scale, cf_attributes(long_name, unit["pressure"])
    attributes = cf_attributes(ROUGH_BODY_OBSERVABLES[_NEXT].long_name, unit["height"])
    found[_NEXT] = ((), pressed.next_order * length, attributes)
    refuse_nonfinite(found)


def _of_profile(
    body: RoughBody, response: Response, along: Reals | None, pressure: Reals
) -> Iterator[tuple[str, str, str, Reals]]:
    nx = len(pressure)
    flat = fields.surface_under_tractions(np.zeros(nx) if along is None else along[0], -pressure, body.elastic)
    yield "displacement", "height", _OUT, grid.signal(flat.u3, nx) + response.u3
    yield "tangential_displacement", "height", _SIDEWAYS, grid.signal(flat.u1, nx) + response.u1
    yield from forming_tractions(body, len(response.orders) - 1)


def forming_tractions(body: RoughBody, order: int) -> Iterator[tuple[str, str, str, Reals]]:
    """Name, kind of unit, description and values (E*) of the tractions that form the topography of a profile.

    `order` is that in the slope to which the topography is then followed.
    """
    former = topography.forming(body.elastic, order)
    tangential, normal = fields.surface_tractions(
        topography.formed_surface(body.heights, former), len(body.heights), former
    )
    forms = "traction that forms the topography of the {} from flat (5.15)"
    yield "forming_traction", "pressure", f"normal {forms}", normal
    yield "tangential_forming_traction", "pressure", f"tangential {forms}", tangential


def _of_inclined(along: Reals, pressure: Reals, prefix: str) -> Iterator[tuple[str, str, Reals]]:
    """Tractions on the places of a body; the pressure on the lower one is that of the contact."""
    if prefix:
        yield "pressure", "contact pressure on the {}", pressure
    yield from _by_axis("tangential_traction", "tangential traction of the contact on the {}, along the plane", along)


def _on_surface(contact: Contact) -> Iterator[tuple[str, str, Reals]]:
    """What a contact of inclined surfaces bears on their own axes, which friction compares."""
    found = contact.equilibrium
    assert found.tangential is not None  # where something rubs
    yield "surface_pressure", "contact pressure along the normal of the touching surface", found.pressure[0]
    yield from _by_axis(
        "surface_traction", "traction on the body along the touching surface", found.tangential.traction[0]
    )


def _by_axis(name: str, long_name: str, along: Reals) -> Iterator[tuple[str, str, Reals]]:
    """A tangential field `[component, (y,) x]`, on maps one along x and one along y."""
    ways = {"": ", along x", "_y": ", along y"} if len(along) > 1 else {"": ""}
    for values, (suffix, way) in zip(along, ways.items(), strict=True):
        yield f"{name}{suffix}", f"{long_name}{way}", values


def _of_map(
    body: RoughBody, response: MapResponse, along: Reals | None, pressure: Reals
) -> Iterator[tuple[str, str, str, Reals]]:
    if along is None or response.along is None:
        flat = map_topography.flat_displacement(-pressure, body.elastic)
        yield "displacement", "height", _OUT, flat + response.u3
        return
    u1, u2, u3 = body.elastic.response(pressure.shape).apply(np.stack((*along, -pressure)))
    yield "displacement", "height", _OUT, u3 + response.u3
    yield "tangential_displacement", "height", f"{_SIDEWAYS} along x", u1 + response.along[0]
    yield "tangential_displacement_y", "height", f"{_SIDEWAYS} along y", u2 + response.along[1]


def doubt(bodies: tuple[RoughBody, ...], order: int, found: xr.Dataset, displacement: str = "displacement") -> str:
    """Return warnings about slopes above the thesis's limit and about films at order 0, one sentence a line.

    `displacement` names the normal one in the dataset that was found.
    """
    return "\n".join(filter(None, (_of_slopes(bodies, found, displacement), too_thin(bodies) if order == 0 else "")))


def _of_slopes(bodies: tuple[RoughBody, ...], found: xr.Dataset, displacement: str) -> str:
    steepest = max(float(statistics.rms_gradient(body.heights, (1.0,) * body.heights.ndim)) for body in bodies)
    if steepest <= STEEPEST:
        return ""
    error, unit = float(found["next_order"].max()), found["next_order"].units
    largest = float(abs(found[displacement]).max()) or 1.0
    off = f"{error:.1e} {'L_x' if unit == '1' else unit}, {error / largest:.2g} times the largest displacement"
    return (
        f"a deformable surface has an rms gradient of {steepest:.3g}, above the {STEEPEST:g} of the thesis; "
        f"the next order in the slope would change displacements by up to {off}, and the error is of that size"
    )


def too_thin(bodies: Sequence[RoughBody]) -> str:
    """Return a warning about films whose thickness the roughness changes, which order 0 leaves out; else nothing."""
    body = max(bodies, key=change_of_thickness, default=None)
    change = 0.0 if body is None else change_of_thickness(body)
    if body is None or change < THICKNESS:
        return ""
    if body.elastic.stack is not None:
        return (
            f"the roughness of a deformable body changes the thickness of its topmost layer by up to {change:.2g} of "
            "it, which order 0 leaves out, as if the interface below followed the surface: if it is flat, take a "
            "numerics.topography_order of 1 or 2"
        )
    return (
        f"the roughness of a deformable body changes its thickness by up to {change:.2g} of it, which order 0 leaves "
        f"out: pressures are off by about that share, or twice that near a Poisson's ratio of 1/2; "
        "take a numerics.topography_order of 1 or 2"
    )
