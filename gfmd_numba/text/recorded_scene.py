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


def is_elastic_contact(text: str) -> bool:
    """Return whether elastic bodies met a hard wall, at whose pressures most solids would flow."""
    scene = json.loads(text).get("scene", {})
    wall, bodies = (
        scene.get("interface", {}).get("hard_wall"),
        (scene.get("body") or {}, scene.get("counter_body") or {}),
    )
    flows = any(each.get("plasticity") or each.get("relaxation") for each in bodies)
    return wall is not None and wall.get("hardness") is None and not flows
