"""Rough deformable bodies from their scene to their dataset."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot, prod
from pathlib import Path

import numpy as np
import numpy.typing as npt
import xarray as xr

from gfmd_numba.contact import problem
from gfmd_numba.contact.dataset import contact_dataset, refuse_nonfinite, units
from gfmd_numba.contact.problem import Problem, Profile, contact_modulus, effective_modulus, elastic_body
from gfmd_numba.contact.two_step import STEEPEST, Pressed, RoughBody
from gfmd_numba.elasticity import fields, topography
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import recipe, statistics
from gfmd_numba.roughness.measured import measured_profile
from gfmd_numba.scene import Body, Document, InputError, Measured, Scene, SceneFile, Surface

Reals = npt.NDArray[np.float64]
Place = tuple[str, ...]  # of a roughness in the scene

NAMES = ("body", "counter_body")
_ROUNDING = 1e-12  # of the largest height, below which a sum of heights is rounding


@dataclass(frozen=True)
class Surfaces:
    """The deformable bodies with their topographies, and the sum of all heights in units of the gradient asked for."""

    bodies: tuple[RoughBody, ...]
    profile: Profile
    rms_gradient: float


def surfaces(file: SceneFile, document: Document) -> Surfaces:
    """Surfaces of a scene in L_x; raises InputError for profiles that do not fit each other or their body.

    A random body faces a random punch or counter body with the next seed.
    """
    scene = file.scene
    heights: dict[Place, Reals] = {}
    seed = file.seed
    asked: dict[Place, float] = {}
    for place, surface in scene.surfaces.items():
        given, gradient = _heights(surface, file, seed, document, ("scene", *place))
        heights[place] = given if place == ("roughness",) else given - given.mean()
        if gradient is not None:
            asked[place] = gradient
            seed = (seed + 1) % 2**32
    nx = len(next(iter(heights.values())))
    for place, given in heights.items():
        if len(given) != nx:
            allowed = f"as many heights as the other surface has, {nx}"
            raise InputError(document.line(("scene", *place), f"{len(given)} heights", allowed))
    bodies = tuple(
        _body(scene, body, heights.get((name, "roughness"), np.zeros(nx)), document, name)
        for name, body in zip(NAMES, scene.deformable, strict=False)
    )
    together = np.sum(list(heights.values()), axis=0)
    if np.ptp(together) <= _ROUNDING * max(abs(each).max() for each in heights.values()):
        allowed = "surfaces that are not all flat, and do not fit into each other everywhere"
        raise InputError(document.line(("scene",), "heights that add up to nothing", allowed))
    try:
        profile, rms_gradient = problem.profile(together, _asked_for(asked, heights))
    except ValueError as error:
        allowed = "surfaces that are rough, and not beyond all measure"
        raise InputError(document.line(("scene",), f"surfaces that add up to {error}", allowed)) from None
    return Surfaces(bodies, profile, rms_gradient)


def _asked_for(asked: Mapping[Place, float], heights: Mapping[Place, Reals]) -> float:
    """Rms gradient that a scene asks for, of what it presses together: the same wherever the roughness lies.

    Random surfaces are independent of all others, so that mean squares add up in the mean over them; measured ones are
    what they are, so that their heights do.
    """
    measured = [given for place, given in heights.items() if place not in asked]
    own = [prod(problem.scaled_gradient(np.sum(measured, axis=0)))] if measured else []
    return hypot(*asked.values(), *own)


def dataset(scene: Scene, reduced: Problem, given: Surfaces, pressed: Pressed) -> xr.Dataset:
    """What `contact_dataset` holds, with the heights and displacements of each body and the expected error."""
    found = contact_dataset(scene, reduced, given.rms_gradient, pressed.contact)
    found["height"].attrs["long_name"] = "sum of the heights of both surfaces, peaks towards each other"
    for name in ("rms_gradient", "rms_gradient_contact", "nayak"):
        attributes = found[name].attrs
        attributes["long_name"] = attributes["long_name"].replace("of the punch", "of the sum of the heights")
    length, unit = scene.length or 1.0, units(scene)
    pressure = pressed.contact.equilibrium.pressure[0] * given.rms_gradient
    nx = len(pressure)
    for name, body, response in zip(NAMES, given.bodies, pressed.responses, strict=False):
        prefix, whose = ("", "body") if name == "body" else ("counter_body_", "counter body")
        flat = fields.surface_under_tractions(np.zeros(nx), -body.share * pressure, body.elastic)
        forming = topography.formed_surface(body.heights, body.elastic)
        along, normal = fields.surface_tractions(forming, nx, body.elastic)
        stress = contact_modulus(scene) / body.share
        for variable, kind, scale, long_name, values in (
            (f"{name}_height", "height", length, f"topography of the {whose}, peaks outwards", body.heights),
            (
                f"{prefix}displacement",
                "height",
                length,
                f"normal displacement of the {whose}, out of it",
                grid.signal(flat.u3, nx) + response.u3,
            ),
            (
                f"{prefix}tangential_displacement",
                "height",
                length,
                f"tangential displacement of the {whose}",
                grid.signal(flat.u1, nx) + response.u1,
            ),
            (
                f"{prefix}forming_traction",
                "pressure",
                stress,
                f"normal traction that forms the topography of the {whose} from flat (5.15)",
                normal,
            ),
            (
                f"{prefix}tangential_forming_traction",
                "pressure",
                stress,
                f"tangential traction that forms the topography of the {whose} from flat (5.15)",
                along,
            ),
        ):
            found[variable] = ("x", values * scale, {"long_name": long_name, "units": unit[kind]})
    attributes = {"long_name": "expected error of displacements, what the next order adds", "units": unit["height"]}
    found["expected_error"] = ((), pressed.expected_error * length, attributes)
    refuse_nonfinite(found)
    return found


def doubt(given: Surfaces, found: xr.Dataset) -> str:
    """What is to be said of slopes above the thesis's limit; nothing of lower ones."""
    steepest = max(float(statistics.rms_gradient(body.heights)) for body in given.bodies)
    if steepest <= STEEPEST:
        return ""
    error, unit = float(found["expected_error"].max()), found["expected_error"].units
    largest = float(abs(found["displacement"]).max()) or 1.0
    off = f"{error:.1e} {'L_x' if unit == '1' else unit}, {error / largest:.1e}"
    return (
        f"a deformable surface has an rms gradient of {steepest:.3g}, above the {STEEPEST:g} of the thesis; "
        f"displacements are expected to be off by {off} of the largest"
    )


def _heights(
    surface: Surface, file: SceneFile, seed: int, document: Document, location: Place
) -> tuple[Reals, float | None]:
    """Heights `[nx]` in L_x, and the rms gradient asked of a random surface; None of a measured one."""
    length = file.scene.length
    if isinstance(surface, Measured):
        try:
            return measured_profile(surface, length), None
        except ValueError as error:
            unit = "L_x" if length is None else "m"
            allowed = f"at least 4 equidistant finite heights in {unit} over one period"
            given = f"{Path(surface.file).name} ({error})"
            raise InputError(document.line((*location, "file"), given, allowed)) from None
    try:
        ensemble = recipe.random_surface(surface, file.discretisation, length or 1.0, 1, seed)
        gradient = recipe.rms_gradient(surface, ensemble, length or 1.0)
        return np.asarray(gradient * ensemble.heights(range(file.realisation, file.realisation + 1))[0]), gradient
    except ValueError as error:
        raise document.error(location, document.value(location), f"a usable surface, not {error}") from None


def _body(scene: Scene, body: Body, heights: Reals, document: Document, name: str) -> RoughBody:
    lowest = -float(heights.min())
    if lowest >= body.aspect_ratio or float(heights.max()) >= body.aspect_ratio:
        given = f"a topography from {heights.min():.3g} to {heights.max():.3g} L_x"
        allowed = f"one within the height of the body, aspect_ratio = {body.aspect_ratio:g}, of its mean plane"
        raise InputError(document.line(("scene", name, "roughness"), given, allowed))
    return RoughBody(elastic_body(body, scene.length), heights, contact_modulus(scene) / effective_modulus(body))
