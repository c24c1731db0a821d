"""The rough surfaces of a scene as heights, and what they are when pressed together."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot, inf, prod

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact import problem
from gfmd_numba.contact.bodies import contact_modulus, effective_modulus, elastic_body
from gfmd_numba.contact.problem import GivenSurface
from gfmd_numba.contact.two_step import RoughBody
from gfmd_numba.roughness import recipe
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.measured import Field, MeasuredSurface, Reader, measured_field, periodic_surface
from gfmd_numba.roughness.surface_files import read_content
from gfmd_numba.scene import Body, Document, InputError, Measured, Random, Scene, SceneFile

Place = tuple[str, ...]  # of a roughness in the scene
MeasuredSurfaces = Mapping[Place, MeasuredSurface]

BODIES = ("body", "counter_body")
_UNEQUAL = 1e-3  # of the size of a map, by which its two sizes may differ
_ROUNDING = 1e-12  # of the largest height, below which a sum of heights is rounding


@dataclass(frozen=True)
class PressedSurfaces:
    """What is pressed together, in units of its rms gradient g; `bodies` are rough elastic ones it is the sum of."""

    surface: RandomSurface | GivenSurface
    rms_gradient: float
    bodies: tuple[RoughBody, ...] | None = None


def measured_surfaces(
    scene: Scene, document: Document, read: Reader = read_content
) -> tuple[dict[Place, MeasuredSurface], float | None]:
    """Measured surfaces of a scene by their places, and the period in m: that of the scene, or else that of a file.

    `read` gives the content of a file. Raises InputError for files that cannot be used, or that tell different periods.
    """
    records = {place: record for place, record in scene.surfaces.items() if isinstance(record, Measured)}
    fields = {place: _field(record, document, ("scene", *place), read) for place, record in records.items()}
    told = {place: field.period for place, field in fields.items() if field.period is not None}
    first = next(iter(told), None) if scene.length is None else None
    length, told_by = (scene.length, "length") if first is None else (told[first], f"{'.'.join(first)}")
    surfaces = {}
    for place, field in fields.items():
        own = place == first  # whose period is told by nobody else
        surfaces[place] = _measured(field, scene, None if own else length, told_by, document, ("scene", *place))
    return surfaces, length


def pressed_surfaces(file: SceneFile, measured: MeasuredSurfaces, document: Document) -> PressedSurfaces:
    """Surfaces of a scene; raises InputError for those that cannot be used, or do not fit each other or their body."""
    if file.scene.follows_topography:
        return _of_rough_bodies(file, measured, document)
    return PressedSurfaces(*_of_the_punch(file, measured, document))


def _of_the_punch(
    file: SceneFile, measured: MeasuredSurfaces, document: Document
) -> tuple[RandomSurface | GivenSurface, float]:
    scene = file.scene
    if isinstance(scene.roughness, Measured):
        try:
            return problem.given_surface(measured["roughness",].in_periods)
        except ValueError as error:
            raise _unusable_file(scene.roughness, document, ("scene", "roughness"), error) from None
    try:
        return problem.random_surface(scene, file.discretisation, file.seed)
    except ValueError as error:
        raise _unusable(document, ("scene", "roughness"), error) from None


def _of_rough_bodies(file: SceneFile, measured: MeasuredSurfaces, document: Document) -> PressedSurfaces:
    """A random body faces a random punch or counter body with the next seed."""
    scene, seed = file.scene, file.seed
    heights: dict[Place, Reals] = {}
    asked: dict[Place, float] = {}
    for place, surface in scene.surfaces.items():
        if isinstance(surface, Measured):
            given = measured[place].in_periods
        else:
            given, asked[place] = _random(surface, file, seed, document, ("scene", *place))
            seed = (seed + 1) % 2**32
        heights[place] = given if place == ("roughness",) else given - given.mean()
    shape = next(iter(heights.values())).shape
    for place, given in heights.items():
        if given.shape != shape:
            allowed = f"as many heights as the other surface has, {_points(shape)}"
            raise InputError(document.line(("scene", *place), f"{_points(given.shape)} heights", allowed))
    bodies = tuple(
        _body(scene, body, heights.get((name, "roughness"), np.zeros(shape)), document, name)
        for name, body in zip(BODIES, scene.deformable, strict=False)
    )
    together = np.sum(list(heights.values()), axis=0)
    if np.ptp(together) <= _ROUNDING * max(abs(each).max() for each in heights.values()):
        allowed = "surfaces that are not all flat, and do not fit into each other everywhere"
        raise InputError(document.line(("scene",), "heights that add up to nothing", allowed))
    try:
        pressed, rms_gradient = problem.given_surface(together, _asked_for(asked, heights))
    except ValueError as error:
        allowed = "surfaces whose roughness is finite and not 0"
        raise InputError(document.line(("scene",), f"surfaces that add up to {error}", allowed)) from None
    return PressedSurfaces(pressed, rms_gradient, bodies)


def _asked_for(asked: Mapping[Place, float], heights: Mapping[Place, Reals]) -> float:
    """Rms gradient that a scene asks for, of what it presses together: the same wherever the roughness lies.

    Random surfaces are independent of all others, so that mean squares add up in the mean over them; measured ones are
    what they are, so that their heights do.
    """
    measured = [given for place, given in heights.items() if place not in asked]
    own = [prod(problem.scaled_gradient(np.sum(measured, axis=0)))] if measured else []
    return hypot(*asked.values(), *own)


def _points(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape))


def _random(surface: Random, file: SceneFile, seed: int, document: Document, place: Place) -> tuple[Reals, float]:
    """Heights `[(y,) x]` in L_x, and the rms gradient asked of them."""
    period = file.scene.length or 1.0
    try:
        ensemble = recipe.random_surface(surface, file.discretisation, period, file.scene.dimension, seed)
        gradient = recipe.rms_gradient(surface, ensemble, period)
        return np.asarray(gradient * ensemble.heights(range(file.realisation, file.realisation + 1))[0]), gradient
    except ValueError as error:
        raise _unusable(document, place, error) from None


def _field(record: Measured, document: Document, place: Place, read: Reader) -> Field:
    try:
        return measured_field(record, read)
    except ValueError as error:
        raise _unusable_file(record, document, place, error) from None


def _measured(
    field: Field, scene: Scene, length: float | None, told_by: str, document: Document, place: Place
) -> MeasuredSurface:
    record = field.record
    try:
        dimension = scene.dimension if "dimension" in scene.model_fields_set else None
        found = periodic_surface(field, length, dimension, scene.has_moduli, told_by)
    except ValueError as error:
        raise _unusable_file(record, document, place, error) from None
    unequal = max(found.lengths) > min(found.lengths) * (1.0 + _UNEQUAL)
    if len(set(found.heights.shape)) > 1 or unequal:
        points, sizes = (" x ".join(f"{each:.6g}" for each in both) for both in (found.heights.shape, found.lengths))
        unit = "L_x" if found.unit == "1" else "m"
        given = f"{record.shown} ({points} points over {sizes} {unit})"
        remedy = (
            "crop: square cuts one out"
            if unequal
            else f"points: {max(found.heights.shape)} resamples it to as many points both ways"
        )
        allowed = f"a map of as many points, and the same size, both ways; {remedy}"
        raise InputError(document.line((*place, record.key), given, allowed))
    return found


def _body(scene: Scene, body: Body, heights: Reals, document: Document, name: str) -> RoughBody:
    elastic = elastic_body(body, scene.length)
    height = inf if elastic.aspect_ratio is None else elastic.aspect_ratio
    if float(abs(heights).max()) >= height:
        given = f"a topography from {heights.min():.3g} to {heights.max():.3g} L_x"
        allowed = f"one within the height of the body, {height:g} L_x, of its mean plane"
        raise InputError(document.line(("scene", name, "roughness"), given, allowed))
    side = 1 if name == BODIES[0] else -1
    return RoughBody(elastic, heights, contact_modulus(scene) / effective_modulus(body), side)


def _unusable(document: Document, place: Place, error: ValueError) -> InputError:
    return document.error(place, document.value(place), f"a usable surface, not {error}")


def _unusable_file(record: Measured, document: Document, place: Place, error: ValueError) -> InputError:
    allowed = "at least 4 equidistant finite heights over one period, in units that are stated, not all equal"
    return InputError(document.line((*place, record.key), f"{record.shown} ({error})", allowed))
