"""Rules between the bodies of a scene: which of them is rough, which deforms, and what then acts between them."""

from __future__ import annotations

from math import isinf
from typing import TYPE_CHECKING

from gfmd_numba.scene.quantities import broken_rule

if TYPE_CHECKING:
    from gfmd_numba.scene.records import Scene


def check_bodies(scene: Scene) -> None:
    """Raise a located PydanticCustomError for bodies that cannot be pressed together."""
    counter = scene.counter_body
    if all(roughness is None for roughness in (scene.roughness, *(body.roughness for body in scene.deformable))):
        raise broken_rule(
            ("roughness",), "a mapping with method 'psd' or 'measured', of the punch, or in body of the body itself"
        )
    if counter is not None:
        if scene.roughness is not None:
            raise broken_rule(("roughness",), "nothing beside a counter_body, which has a roughness of its own")
        for name, body in (("body", scene.body), ("counter_body", counter)):
            if body.youngs_modulus is None:
                raise broken_rule((name, "youngs_modulus"), "a number above 0 for both bodies, as they share the load")
        if counter.state != scene.body.state:
            raise broken_rule(("counter_body", "state"), f"{scene.body.state!r}, as that of the body")
        if scene.loading.displacement is not None and isinf(counter.aspect_ratio):
            raise broken_rule(
                ("counter_body", "aspect_ratio"),
                "a finite aspect_ratio, or loading.reduced_pressure in place of loading.displacement, "
                "as a half-space has no reference for displacement",
            )
    if scene.follows_topography:
        for name, body in zip(("body", "counter_body"), scene.deformable, strict=False):
            if body.stiffness_scale != 1.0:
                raise broken_rule((name, "stiffness_scale"), "1 where a deformable body is rough or both deform")
        for name in ("friction", "cohesive"):
            if getattr(scene.interface, name) is not None:
                raise broken_rule(
                    ("interface", name),
                    "nothing that drags where a deformable body is rough or both deform: only normal tractions are "
                    "followed there; map the roughness to a rigid punch",
                )
        if scene.boundary is not None:
            raise broken_rule(("boundary",), "nothing where a deformable body is rough or both deform")
