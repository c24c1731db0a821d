"""Rules between the bodies of a scene: which of them is rough, and which deforms."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gfmd_numba.scene.layer_records import check_layers
from gfmd_numba.scene.quantities import broken_rule

if TYPE_CHECKING:
    from gfmd_numba.scene.records import Scene


def check_bodies(scene: Scene) -> None:
    """Raise a located PydanticCustomError for bodies that cannot be pressed together."""
    counter = scene.counter_body
    if not scene.surfaces:
        raise broken_rule(
            ("roughness",),
            "a mapping with a method like 'psd' or 'measured', here for the punch or inside body for the body itself",
        )
    if counter is not None:
        if scene.roughness is not None:
            raise broken_rule(("roughness",), "nothing with a counter_body, which has a roughness of its own")
        for name, body in (("body", scene.body), ("counter_body", counter)):
            if body.surface_modulus is None:
                raise broken_rule((name, "youngs_modulus"), "a number above 0 for both bodies, as they share the load")
        if counter.state != scene.body.state:
            raise broken_rule(("counter_body", "state"), f"{scene.body.state!r}, as that of the body")


def check_stacks(scene: Scene) -> None:
    """Raise a located PydanticCustomError for layers that do not fit the period."""
    for name, body in (("body", scene.body), ("counter_body", scene.counter_body)):
        if body is not None and body.layers is not None:
            check_layers((name,), body.layers, body.base or "rigid", scene.length)
