"""The rough surfaces of a scene as heights, and what they are when pressed together."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import frexp, hypot, ldexp, prod

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.problem import DeformableBody, RoughBodies
from gfmd_numba.contact.scales import scales_of
from gfmd_numba.contact.surfaces import GivenSurface, SmoothSurface, SummedSurface, Surface, Topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import generators, statistics
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.measured import Field, MeasuredSurface, Reader, measured_field, periodic_surface
from gfmd_numba.roughness.surface_files import read_content
from gfmd_numba.scene import (
    Discretisation,
    Document,
    Measured,
    Random,
    Scene,
    SceneFile,
)
from gfmd_numba.scene.quantities import LARGEST, SMALLEST
from gfmd_numba.scene.records import ends_of
from gfmd_numba.scene.units import in_reduced_units

Place = tuple[str, ...]  # of a roughness in the scene
MeasuredSurfaces = Mapping[Place, MeasuredSurface]

BODIES = ("body", "counter_body")
_FADED = (
    "periodic: window fades the measured surface to a plane at its ends, and area, gap and pressure are those of the "
    "faded surface: take periodic: mirror for a contact, and a window for spectra"
)
_UNEQUAL = 1e-3  # of the size of a map, by which its two sizes may differ
STEEPEST = 0.030  # rms gradient that the thesis allows order 0 (5.3.4)
_WIDER_THAN_A_PATCH = 2  # periods of a random patch over its length, so that its ends do not meet
_ROUNDING = 1e-12  # of the largest height, below which a sum of heights is rounding


@dataclass(frozen=True, kw_only=True)
class RoughBody(DeformableBody):
    """A deformable body and its stress-free topography `[(y,) x]` of zero mean in L_x."""

    heights: Reals


@dataclass(frozen=True)
class FacingSurfaces:
    """What is pressed together, in units of its rms gradient g.

    `rough` are the elastic bodies that rough surfaces belong to, and `bodies` what one realisation of them is.
    """

    surface: Surface
    rms_gradient: float
    bodies: tuple[RoughBody, ...] | None = None
    rough: RoughBodies | None = None

    @property
    def order(self) -> int:
        """Order in the slope to which the topographies of bodies are followed; 0 of smooth bodies."""
        return 0 if self.rough is None else self.rough.order


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


def facing_surfaces(file: SceneFile, measured: MeasuredSurfaces, document: Document) -> FacingSurfaces:
    """Surfaces of a scene; raises InputError for those that cannot be used, or do not fit each other or their body."""
    if file.scene.follows_topography:
        draws = file.discretisation, file.seed, file.slope_order
        summed, bodies = ensemble_of_rough_bodies(file.scene, *draws, measured, document)
        drawn = check_drawn(file.scene, summed, bodies, file.realisation, document)
        return FacingSurfaces(summed, summed.rms_gradient, drawn, bodies)
    rough = None if file.scene.roughness is None else _of_the_punch(file, measured, document)
    return punch_on_its_form(file.scene, rough, document)


def given_surface(heights: Reals, gradient: float | None = None, periodic: object = True) -> tuple[GivenSurface, float]:
    """Surface in units of a `gradient` g, by default the rms gradient of its heights (in L_x), and that gradient.

    Raises ValueError for a flat surface, without roughness to speak of, or one too large for its gradient.
    """
    scale, slope = scaled_gradient(heights, ends_of(periodic, heights.ndim))
    rounding = heights.shape[-1] * np.finfo(float).eps  # about the rms gradient of heights of order 1 that are rounded
    own = slope * scale
    if slope <= 100.0 * rounding:
        size = f"an rms gradient of {own:.2g} in heights of up to {np.abs(heights).max():.3g}"
        raise ValueError(f"{size}: it is flat but for rounding")
    if not SMALLEST <= own <= LARGEST:
        raise ValueError(f"an rms gradient of {own:.3g}, not from {SMALLEST:g} to {LARGEST:g}")
    unit = heights / scale / (slope if gradient is None else gradient / scale)
    return GivenSurface.of(unit), own if gradient is None else gradient


def scaled_gradient(heights: Reals, ends: tuple[bool, ...] = ()) -> tuple[float, float]:
    """A power of two about as large as the heights, which rounds nothing, and their rms gradient in units of it."""
    scale = ldexp(1.0, frexp(np.abs(heights).max())[1] - 1)
    return scale, float(statistics.rms_gradient(heights / scale, (1.0,) * heights.ndim, ends))


def random_surface(
    record: Random, scene: Scene, discretisation: Discretisation | None, seed: int
) -> tuple[RandomSurface, float]:
    """Ensemble that a record of a scene describes at a discretisation, and the rms gradient asked of it.

    Raises ValueError for lengths that do not go with the period.
    """
    period, cut_from = scene.length or 1.0, 1 if scene.periodic else _WIDER_THAN_A_PATCH
    return generators.random_surface(record, discretisation, period, scene.dimension, seed, cut_from)


def smooth_part(scene: Scene, shape: tuple[int, ...] | None) -> Topography | None:
    """Form of the punch of a scene, on the grid of its roughness, or its own where the shape of that is None.

    It stands on the middle of a measured field: where the mirror image doubles that, on a quarter of the period.
    """
    if scene.form is None:
        return None
    if shape is None:
        assert scene.form.points is not None  # the promise of a scene without roughness
        shape = (scene.form.points,) * scene.dimension
    form = in_reduced_units(scene.form, scene.length or 1.0, 1.0)
    mirrored = any(isinstance(each, Measured) and each.periodic == "mirror" for each in scene.surfaces.values())
    middle = tuple(0.25 if mirrored and not end else 0.5 for end in scene.ends[::-1])
    return Topography(SmoothSurface(form, shape, middle), 1.0, False)


def punch_on_its_form(
    scene: Scene, rough: tuple[RandomSurface | GivenSurface, float] | None, document: Document
) -> FacingSurfaces:
    """Surface of a rigid punch in units of its rms gradient g: its roughness, if any, on its form, if any.

    g is that of the roughness, and of a form alone its own. Raises InputError for a form that is flat but for rounding.
    """
    smooth = smooth_part(scene, None if rough is None else rough[0].shape)
    if smooth is None:
        assert rough is not None  # a scene has one of the two
        return FacingSurfaces(*rough)
    if rough is not None:
        return FacingSurfaces(SummedSurface((Topography(*rough, False), smooth), rough[1]), rough[1])
    try:
        gradient = given_surface(smooth.drawn(0), periodic=scene.periodic)[1]
    except ValueError as error:
        raise document.refused(("scene", "form"), f"a form that is not flat, not {error}") from None
    return FacingSurfaces(SummedSurface((smooth,), gradient), gradient)


def _of_the_punch(
    file: SceneFile, measured: MeasuredSurfaces, document: Document
) -> tuple[RandomSurface | GivenSurface, float]:
    scene = file.scene
    if isinstance(scene.roughness, Measured):
        with usable(document, ("scene", "roughness"), scene.roughness):
            return given_surface(measured["roughness",].in_periods, periodic=scene.periodic)
    return _random(("roughness",), scene, file.discretisation, file.seed, document)


def ensemble_of_rough_bodies(
    scene: Scene,
    discretisation: Discretisation | None,
    seed: int,
    order: int,
    measured: MeasuredSurfaces,
    document: Document,
) -> tuple[SummedSurface, RoughBodies]:
    """All surfaces of a scene whose topographies are followed, and its bodies; raises InputError for unusable ones.

    A random body faces a random punch or counter body with the next seed.
    """
    parts: dict[Place, Topography] = {}
    asked: dict[Place, float] = {}
    for place, record in scene.surfaces.items():
        centred = place != ("roughness",)
        if isinstance(record, Measured):
            parts[place] = Topography(GivenSurface.of(measured[place].in_periods), 1.0, centred)
        else:
            surface, asked[place] = _random(place, scene, discretisation, seed, document)
            parts[place] = Topography(surface, asked[place], centred)
            seed = (seed + 1) % 2**32
    fixed = (part.surface.shape for place, part in parts.items() if ("scene", *place) not in document.elsewhere)
    shape = next(fixed, None)
    for place, part in parts.items():
        if shape is not None and part.surface.shape != shape:
            allowed = f"as many heights as the other surface has, {_points(shape)}"
            raise document.fault(("scene", *place), f"{_points(part.surface.shape)} heights", allowed)
    ends, smooth = scene.ends, smooth_part(scene, shape)
    gradient = _asked_for(asked, parts, ends)
    if smooth is not None:
        parts["form",] = smooth
        gradient = gradient or prod(scaled_gradient(smooth.drawn(0), ends))
    places, scales = list(parts), scales_of(scene)
    bodies = tuple(
        DeformableBody(
            body,
            share,
            places.index((name, "roughness")) if (name, "roughness") in parts else None,
            1 if name == "body" else -1,
        )
        for name, body, share in zip(BODIES, scales.bodies, scales.shares, strict=False)
    )
    return SummedSurface(tuple(parts.values()), gradient), RoughBodies(bodies, order)


def check_drawn(
    scene: Scene, summed: SummedSurface, rough: RoughBodies, realisation: int, document: Document
) -> tuple[RoughBody, ...]:
    """Rough bodies of one realisation; raises InputError for surfaces that do not fit each other, or their body."""
    places = list(scene.surfaces)
    drawn = []
    for place, part in zip([*places, ("form",)], summed.parts, strict=False):
        with usable(document, ("scene", *place)):
            drawn.append(part.drawn(realisation))
    bodies = []
    for name, each in zip(BODIES, rough.bodies, strict=False):
        try:
            bodies.append(rough_body(each, drawn, rough.order))
        except ValueError:
            heights = drawn[each.part or 0]
            given = f"a topography from {heights.min():.3g} to {heights.max():.3g} L_x"
            allowed = allowed_topography(heights, each.elastic, rough.order)
            raise document.fault(("scene", name, "roughness"), given, allowed) from None
    together = np.sum(drawn, axis=0)
    if np.ptp(together) <= _ROUNDING * max(abs(each).max() for each in drawn):
        allowed = "surfaces that are not all flat, and do not fit into each other everywhere"
        raise document.fault(("scene",), "heights that add up to nothing", allowed)
    try:
        given_surface(together, summed.rms_gradient)
    except ValueError as error:
        allowed = "surfaces whose roughness is finite and not 0"
        raise document.fault(("scene",), f"surfaces that add up to {error}", allowed) from None
    return tuple(bodies)


def _asked_for(asked: Mapping[Place, float], parts: Mapping[Place, Topography], ends: tuple[bool, ...]) -> float:
    """Rms gradient that a scene asks for, of what it presses together: the same wherever the roughness lies.

    Random surfaces are independent of all others, so that mean squares add up in the mean over them; measured ones are
    what they are, so that their heights do.
    """
    measured = [part.drawn(0) for place, part in parts.items() if place not in asked]
    own = [prod(scaled_gradient(np.sum(measured, axis=0), ends))] if measured else []
    return hypot(*asked.values(), *own)


def _points(shape: tuple[int, ...]) -> str:
    return " x ".join(map(str, shape))


def _random(
    place: Place, scene: Scene, discretisation: Discretisation | None, seed: int, document: Document
) -> tuple[RandomSurface, float]:
    """Ensemble of the record at a place, and the rms gradient asked of it."""
    record = scene.surfaces[place]
    assert isinstance(record, Random)  # any other is measured
    with usable(document, ("scene", *place)):
        return random_surface(record, scene, discretisation, seed)


def _field(record: Measured, document: Document, place: Place, read: Reader) -> Field:
    with usable(document, place, record):
        return measured_field(record, read)


def _measured(
    field: Field, scene: Scene, length: float | None, told_by: str, document: Document, place: Place
) -> MeasuredSurface:
    record = field.record
    dimension = scene.dimension if "dimension" in scene.model_fields_set else None
    with usable(document, place, record):
        found = periodic_surface(field, length, dimension, scene.has_moduli, told_by, scene.periodic)
    if record.periodic == "window":
        found = replace(found, doubts=(*found.doubts, _FADED))
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
        raise document.fault((*place, record.key), given, allowed)
    return found


@contextmanager
def usable(document: Document, place: Place, record: Measured | None = None) -> Iterator[None]:
    """Raise InputError for a surface at a place that cannot be used, by its file or heights if it is measured."""
    try:
        yield
    except ValueError as error:
        if record is None:
            raise document.refused(place, f"a usable surface, not {error}") from None
        allowed = "a table of equidistant heights in units that are stated"
        raise document.fault((*place, record.key), f"{record.shown} ({error})", allowed) from None


def rough_body(body: DeformableBody, drawn: Sequence[Reals], order: int) -> RoughBody:
    """A deformable body, the surfaces `[(y,) x]` having `drawn` these heights (L_x).

    Raises ValueError for a topography that reaches through it, or at an order above 0 through its topmost layer.
    """
    heights = np.zeros_like(drawn[0]) if body.part is None else drawn[body.part]
    if allowed := allowed_topography(heights, body.elastic, order):
        span = f"from {heights.min():.3g} to {heights.max():.3g} L_x"
        raise ValueError(f"a topography {span} in place of {allowed}")
    return RoughBody(**vars(body), heights=heights)


def allowed_topography(heights: Reals, body: ElasticBody, order: int) -> str:
    """What is allowed in place of heights `[(y,) x]` that a body has no room for; nothing if it has."""
    lowest, highest = float(heights.min()), float(heights.max())
    if body.aspect_ratio is not None and max(-lowest, highest) >= body.aspect_ratio:
        return f"one within the height of the body, {body.aspect_ratio:g} L_x, of its mean plane"
    if order > 0 and body.stack is not None and -lowest >= -body.top.base:
        return (
            f"valleys above the lower side of the topmost layer, {body.top.base:g} L_x, or a numerics.topography_order "
            "of 0, as interfaces are flat at higher orders"
        )
    return ""


def change_of_thickness(body: RoughBody) -> float:
    """Largest height over the thickness in waves so long that the body is a film to them, q z_m <= 1; 0 if none are.

    Of a layered body the film is the topmost layer.
    """
    thickness = body.elastic.top.aspect_ratio
    if thickness is None:
        return 0.0
    waves = grid.coefficients(body.heights, body.heights.ndim)
    waves[grid.magnitudes(body.heights.shape) * thickness > 1.0] = 0.0
    return float(abs(grid.signal(waves, *body.heights.shape)).max()) / thickness
