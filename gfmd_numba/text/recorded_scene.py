"""What the text of a scene says that a dataset was solved from, to those who know datasets alone."""

import json


def has_form(text: str) -> bool:
    """Return whether the punch has a form, whose heights and mean pressure say how long the cut-out is."""
    return json.loads(text).get("scene", {}).get("form") is not None


def is_form_alone(text: str) -> bool:
    """Return whether a form without roughness was pressed, of which p*, kappa and Persson's theory say nothing."""
    scene = json.loads(text).get("scene", {})
    bodies = [scene, scene.get("body") or {}, scene.get("counter_body") or {}]
    return has_form(text) and all(each.get("roughness") is None for each in bodies)
