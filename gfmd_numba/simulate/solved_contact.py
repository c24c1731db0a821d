"""A solved contact as it comes back from its dataset: its scene, and whether all nodes of its period are there."""

from typing import TypeVar

import numpy as np
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.dataset import POINTS, POINTS_OF_WINDOW
from gfmd_numba.scene import COMPONENTS, BoundaryFile, InputError, LoadedBody, Scene, SceneFile
from gfmd_numba.scene.measured_record import AXES
from gfmd_numba.text.input_error import brief

Record = TypeVar("Record", BoundaryFile, SceneFile)

_ROUNDING = 1e-3  # of the spacing, by which nodes may be off their places
_WHOLE = "all nodes of the period, as gfmd_numba.solve returns them; cut the fields inside afterwards"
_ALTERED = "contact: you gave a contact that was altered; gfmd allows what gfmd_numba.solve returns"
_TRACTIONS = tuple(component.key("traction") for component in COMPONENTS[2])
_PRESCRIBED, _COUNTER = "prescribed_", "counter_body_"
_ON_EACH = ("pressure", *_TRACTIONS)
_FIELDS = (
    *(whose + name for whose in ("", _COUNTER) for name in _ON_EACH),
    *(_PRESCRIBED + each for each in _TRACTIONS),
    "body_height",
    "counter_body_height",
)


def described(contact: xr.Dataset, body: str) -> tuple[Scene | LoadedBody, int]:
    """Scene of a dataset and the order its topography was followed to; raises InputError."""
    found = contact.variables.keys()
    solved = ({"x", "pressure"} <= found or {"x", "normal_traction"} <= found) and "von_mises" not in found
    if "scene" not in contact.attrs or not solved:  # fields inside a body have the pressure on it as well
        raise InputError("contact: you gave no results of a contact; gfmd allows what gfmd_numba.solve returns")
    if "normal_traction" in contact:
        file: BoundaryFile | SceneFile = _recorded(BoundaryFile, contact)
    else:
        file = _recorded(SceneFile, contact)
    scene, order = file.scene, file.numerics.slope_order(file.scene)
    if isinstance(scene, Scene) and scene.body.relaxation is not None:
        given = "one of a viscoelastic body"
        raise InputError(f"contact: you gave {given}; gfmd allows elastic bodies, as this is not built yet")
    if isinstance(scene, Scene) and scene.body.plasticity is not None:
        allowed = "elastic bodies: a contact of a body that flows has von_mises_stress and stress_x of its own"
        raise InputError(f"contact: you gave one of a body that flows inside; gfmd allows {allowed}")
    names = ["body", "counter_body"][: len(scene.deformable)]
    if not isinstance(body, str) or body not in names:
        raise InputError(f"body: you gave {brief(body)}; gfmd allows {' or '.join(map(repr, names))}")
    nodes = nodes_of(scene)
    if not _is_whole(contact, nodes) or not found >= _needed(scene, order):
        raise InputError(_ALTERED)
    for dim in nodes:
        _check_period(contact[dim], dim, scene.length or 1.0)
    return scene, order


def nodes_of(scene: Scene | LoadedBody) -> tuple[str, ...]:
    """Dims of the nodes of a scene."""
    return AXES[-scene.dimension :]


def tractions_on(body: str, step: xr.Dataset, nodes: tuple[str, ...]) -> Reals:
    """Tractions `[component, (y,) x]` on a body, along the surface and last out of the body, in the unit of the file.

    They are those of the punch and those that are prescribed. Where surfaces are inclined, the file has those on each
    body.
    """
    names = [component.key("traction") for component in COMPONENTS[len(nodes)]]
    whose = _COUNTER if body == "counter_body" and _COUNTER + "pressure" in step else ""
    found = _found(step, [whose + name for name in names], nodes)
    if "pressure" in step:
        found[-1] = -step[whose + "pressure"].values
    if body == "counter_body":
        if not whose:  # the tangential tractions of the file are those on `body`
            found[:-1] *= -1.0
        return found
    return found + _found(step, [_PRESCRIBED + name for name in names], nodes)


def _found(step: xr.Dataset, names: list[str], nodes: tuple[str, ...]) -> Reals:
    """Variables of these names `[name, (y,) x]`, zero where there is none."""
    found = np.zeros((len(names), *(step.sizes[dim] for dim in nodes)))
    for i, name in enumerate(names):
        if name in step:
            found[i] = step[name].values
    return found


def _needed(scene: Scene | LoadedBody, order: int) -> set[str]:
    """Names of the tractions without which prescribed ones, or those on inclined surfaces, would be incomplete."""
    names = [component.key("traction") for component in COMPONENTS[scene.dimension]]
    needed = set()
    if scene.boundary is not None:
        needed |= {("" if isinstance(scene, LoadedBody) else _PRESCRIBED) + name for name in names}
    if isinstance(scene, Scene) and order > 0 and scene.touches_inclined:
        needed |= {whose + name for whose in ("", _COUNTER) for name in ("pressure", *names[:-1])}
        if scene.counter_body is None:
            needed -= {name for name in needed if name.startswith(_COUNTER)}
    return needed


def _check_period(x: xr.DataArray, dim: str, length: float) -> None:
    """Raise InputError unless the nodes along x, or y, are all those of the period, or of the window."""
    present = x.size
    solved = x.attrs.get(POINTS, x.attrs.get(POINTS_OF_WINDOW, present))
    if str(solved) != str(present):
        raise InputError(f"contact: you gave {present} of the {solved} nodes of its period; gfmd allows {_WHOLE}")
    spacing, at = length / present, x.values.astype(np.float64)
    rounding = 4.0 * float(np.finfo(x.dtype).eps) * abs(at).max() if x.dtype.kind == "f" else 0.0
    if not (abs(np.diff(at) - spacing) <= _ROUNDING * spacing + rounding).all():
        given = f"nodes {dim} from {at[0]:.6g} to {at[-1]:.6g} that are not all {spacing:.6g} apart, as in a period"
        raise InputError(f"contact: you gave {given}; gfmd allows {_WHOLE}")


def _is_whole(contact: xr.Dataset, nodes: tuple[str, ...]) -> bool:
    """Whether what the fields are made from is there, in numbers with units over the nodes, and a step if any."""
    fields = [contact[name] for name in _FIELDS if name in contact]
    if "status" not in contact or any(dim not in contact.variables for dim in nodes):
        return False
    if any(contact[dim].dims != (dim,) or contact.sizes[dim] < 4 for dim in nodes):
        return False
    laid_out = {field.dims for field in fields} <= {nodes, ("step", *nodes)}
    laid_out &= contact["status"].dims in ((), ("step",))
    places = [contact[dim] for dim in nodes]
    numbers = all(each.dtype.kind in "fiu" for each in (*places, contact["status"], *fields))
    named = all("units" in each.attrs for each in (*places, *fields))
    return laid_out and numbers and named and contact.sizes.get("step", 1) > 0


def _recorded(record: type[Record], contact: xr.Dataset) -> Record:
    """Scene file that a dataset was solved from; raises InputError if its attribute is no such thing any more."""
    try:
        return record.model_validate_json(contact.attrs["scene"])
    except ValueError:
        raise InputError(
            "contact: you gave a contact whose scene is unreadable; gfmd allows what gfmd_numba.solve returns"
        ) from None
