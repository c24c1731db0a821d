"""What does not go together with an interface of dimension 2, or of 1."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gfmd_numba.scene.quantities import broken_rule

if TYPE_CHECKING:
    from gfmd_numba.scene.records import Scene

ONLY_MAPS = "nothing with dimension 1; anisotropy needs dimension 2"


def check_map(scene: Scene) -> None:
    """Raise a located PydanticCustomError for a map with more than a rough rigid punch and a hard wall."""
    if scene.roughness is None or scene.roughness.method != "psd":
        raise broken_rule(("roughness", "method"), "'psd' with dimension 2, also for a flat or measured punch")
    for name in ("exponential", "cohesive", "friction"):
        if getattr(scene.interface, name) is not None:
            raise broken_rule(("interface", name), f"hard_wall alone with dimension 2; {name} needs dimension 1")
    if scene.boundary is not None:
        raise broken_rule(("boundary",), "nothing with dimension 2; a boundary needs dimension 1")
    if scene.counter_body is not None:
        raise broken_rule(("counter_body",), "nothing with dimension 2; two elastic bodies need dimension 1")
    if scene.body.roughness is not None:
        raise broken_rule(("body", "roughness"), "nothing with dimension 2; a rough body needs dimension 1")
    if scene.body.state == "plane_stress":
        raise broken_rule(("body", "state"), "'plane_strain' with dimension 2, where E* is the same and nothing plane")


def check_anisotropy(scene: Scene) -> None:
    """Raise a located PydanticCustomError for a profile, or a surface of a rough body, that tells of a direction y."""
    surfaces: dict[tuple[str, ...], object] = {
        ("roughness",): scene.roughness,
        ("body", "roughness"): scene.body.roughness,
        ("counter_body", "roughness"): None if scene.counter_body is None else scene.counter_body.roughness,
    }
    for location, roughness in surfaces.items():
        if getattr(roughness, "anisotropy", None) is not None:
            raise broken_rule((*location, "anisotropy"), ONLY_MAPS)
