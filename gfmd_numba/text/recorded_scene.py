"""What the text of a scene says that a dataset was solved from, to those who know datasets alone."""

import json
from collections.abc import Mapping
from typing import Any

from gfmd_numba.text.numbers import with_prefix

KIND = {1: "profile", 2: "map"}  # of surfaces, by their dimension
_TEXTS = ("campaign", "yaml")  # attributes that hold what a user wrote
_LOADS = {"pressure": "Pa", "line_load": "N m-1", "force": "N"}


def asked(attributes: Mapping[Any, Any]) -> dict[str, str]:
    """Return those attributes of a dataset that hold what its user wrote, for what is computed from it."""
    return {name: str(attributes[name]) for name in _TEXTS if name in attributes}


def _at(text: str, *place: str) -> Any:
    """Return what a recorded scene has at a place; None without, as in a record that was altered by hand."""
    try:
        found = json.loads(text)
    except (TypeError, ValueError):
        return None
    for key in ("scene", *place):
        found = found.get(key) if isinstance(found, dict) else None
    return found


def has_form(text: str) -> bool:
    """Return whether the punch has a form, whose heights and mean pressure say how long the cut-out is."""
    return _at(text, "form") is not None


def is_form_alone(text: str) -> bool:
    """Return whether a form without roughness was pressed, of which p*, kappa and Persson's theory say nothing."""
    rough = (_at(text, *of, "roughness") for of in ((), ("body",), ("counter_body",)))
    return has_form(text) and not any(rough)


def is_elastic_contact(text: str) -> bool:
    """Return whether elastic bodies met a hard wall, at whose pressures most solids would flow."""
    flows = any(_at(text, body, name) for body in ("body", "counter_body") for name in ("plasticity", "relaxation"))
    return _at(text, "interface", "hard_wall") is not None and hardness(text) is None and not flows


def is_measured_profile(text: str) -> bool:
    """Return whether rough profiles met that were all measured, which may stand for surfaces that are no ridges."""
    scene = _at(text)
    rough = _rough(scene) if isinstance(scene, dict) and scene.get("dimension") == 1 else []
    return bool(rough) and all(each.get("method") == "measured" for each in rough) and not scene.get("form")


def hardness(text: str) -> float | None:
    """Return the hardness of the wall, in the unit of pressures; None of a wall that does not yield."""
    found = _at(text, "interface", "hard_wall", "hardness")
    return found if isinstance(found, int | float) else None


def described(text: str, load: bool = True) -> str:
    """Return what was pressed on what, and under which `load`, as far as the scene says it in units; "" without.

    A record that was altered by hand says nothing: it is a title, not a number.
    """
    try:
        scene = json.loads(text).get("scene", {})
        is_doubled = scene.get("periodic", True) is True and fields_in_period(text) > 1
        parts = [_surface(scene, is_doubled), f"on {_body(scene['body'])}"] if scene.get("body") else []
        if parts and scene.get("counter_body"):
            parts.append(f"against {_body(scene['counter_body'])}")
        for name, value in (scene.get("loading") or {}).items() if parts and load else ():
            if name in _LOADS and value is not None:
                parts.append(f"under {with_prefix(value, _LOADS[name])}")
    except (AttributeError, LookupError, TypeError, ValueError):
        return ""
    return ", ".join(parts)


def _surface(scene: dict[str, Any], is_doubled: bool) -> str:
    kind, rough = KIND[scene.get("dimension", 1)], _rough(scene)
    said = f"smooth {kind}"
    if rough:
        kinds = {"measured" if each.get("method") == "measured" else "rough" for each in rough}
        hurst = {each.get("hurst") for each in rough}
        said = f"{' and '.join(sorted(kinds))} {kind}{'s' * (len(rough) > 1)}"
        said += f", Hurst exponent {hurst.pop():g}" if len(hurst) == 1 and None not in hurst else ""
    said += " with a form" if scene.get("form") else ""
    length = scene.get("length")
    if length is None:
        return said
    size = with_prefix(length, "m")
    return f"{said}, mirrored to a period of {size}" if is_doubled else f"{said}, {size} long"


def _rough(scene: dict[str, Any]) -> list[dict[str, Any]]:
    """The records of the surfaces of the punch and of the bodies."""
    owners = [scene, *(scene.get(body) for body in ("body", "counter_body"))]
    found = [owner.get("roughness") for owner in owners if isinstance(owner, dict)]
    return [each for each in found if isinstance(each, dict)]


def fields_in_period(text: str) -> int:
    """Return how often a measured field is in a period, as `Scene.fields_in_period` does."""
    scene = _at(text)
    if not isinstance(scene, dict):
        return 1
    periodic, rough = scene.get("periodic", True), _rough(scene)
    mirrored = bool(rough) and all(each.get("periodic") == "mirror" for each in rough) and not scene.get("form")
    axes = scene.get("dimension", 1) if periodic is True else int(periodic is not False)
    return 2**axes if mirrored else 1


def _body(body: dict[str, Any]) -> str:
    ratio = body.get("aspect_ratio")
    kind = "layers" if body.get("layers") else "a half-space" if ratio in (None, float("inf")) else "a slab"
    kind = kind.replace("a ", "a viscoelastic ", 1) if body.get("relaxation") else kind
    modulus = body.get("youngs_modulus")
    return kind if modulus is None else f"{kind} of Young's modulus {with_prefix(modulus, 'Pa')}"
