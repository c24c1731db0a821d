"""The rough surfaces of a scene as heights, and their sum when pressed together."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.problem import DeformableBody, RoughBodies
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.scales import Scales
from gfmd_numba.fourier import grid
from gfmd_numba.roughness.measured import MeasuredSurfaces, usable
from gfmd_numba.roughness.surfaces import (
    SummedSurface,
    Surface,
    given_surface,
    on_its_form,
    sum_of_surfaces,
    surface_of_the_punch,
)
from gfmd_numba.scene import Document, Scene, SceneFile

STEEPEST = 0.030  # rms gradient that the thesis allows order 0 (5.3.4)
_ROUNDING = 1e-12  # of the largest height, below which a sum of heights is rounding


@dataclass(frozen=True, kw_only=True)
class RoughBody(DeformableBody):
    """A deformable body and its stress-free topography `[(y,) x]` of zero mean in L_x."""

    heights: Reals


@dataclass(frozen=True)
class FacingSurfaces:
    """The sum of the surfaces that are pressed together, in units of its rms gradient g.

    `rough` are the elastic bodies that rough surfaces belong to.
    """

    surface: Surface
    rms_gradient: float
    rough: RoughBodies | None = None

    @property
    def order(self) -> int:
        """Order in the slope to which the topographies of bodies are followed; 0 of smooth bodies."""
        return 0 if self.rough is None else self.rough.order


def facing_surfaces(file: SceneFile, scales: Scales, measured: MeasuredSurfaces, document: Document) -> FacingSurfaces:
    """Surfaces of a scene; raises InputError for those that cannot be used, or do not fit each other."""
    scene, levels, seed = file.scene, file.discretisation, file.seed
    bodies = rough_bodies(scene, scales, file.slope_order)
    rough = None if bodies else surface_of_the_punch(scene, levels, seed, measured, document)
    if rough is not None:
        return FacingSurfaces(on_its_form(scene, *rough), rough[1])
    summed = sum_of_surfaces(scene, levels, seed, measured, document)
    return FacingSurfaces(summed, summed.rms_gradient, bodies)


def rough_bodies(scene: Scene, scales: Scales, order: int) -> RoughBodies | None:
    """The deformable bodies of a scene, if their topographies are followed, to an order in the slope."""
    if not scene.follows_topography:
        return None
    places = list(scene.surfaces)
    bodies = tuple(
        DeformableBody(
            body,
            fraction,
            places.index((name, "roughness")) if (name, "roughness") in places else None,
            1 if name == "body" else -1,
        )
        for name, body, fraction in zip(scene.deformable, scales.bodies, scales.compliance_fractions, strict=True)
    )
    return RoughBodies(bodies, order)


def check_drawn(scene: Scene, surfaces: FacingSurfaces, realisation: int, document: Document) -> tuple[RoughBody, ...]:
    """Rough bodies of one realisation; raises InputError for surfaces that do not fit each other, or their body.

    There are none where no topography is followed.
    """
    summed, rough, drawn = surfaces.surface, surfaces.rough, []
    if rough is None:
        return ()
    assert isinstance(summed, SummedSurface)  # as that of bodies is
    for place, part in zip([*scene.surfaces, ("form",)], summed.parts, strict=False):
        with usable(document, ("scene", *place)):
            drawn.append(part.drawn(realisation))
    bodies = []
    for name, each in zip(scene.deformable, rough.bodies, strict=True):
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
        given_surface(together)
    except ValueError as error:
        allowed = "surfaces whose roughness is finite and not 0"
        raise document.fault(("scene",), f"surfaces that add up to {error}", allowed) from None
    return tuple(bodies)


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
    if order > 0 and body.stack is not None and -lowest >= -body.top.base_z:
        return (
            f"valleys above the lower side of the topmost layer, {body.top.base_z:g} L_x, or a "
            "numerics.topography_order of 0, as interfaces are flat at higher orders"
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
