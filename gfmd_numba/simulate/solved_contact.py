"""A solved contact as it comes back from its dataset: its scene, and whether all nodes of its period are there."""

from pathlib import Path
from typing import TypeVar

import numpy as np
import xarray as xr

from gfmd_numba.contact.dataset import POINTS
from gfmd_numba.contact.refusal import check_where
from gfmd_numba.scene import BoundaryFile, InputError, LoadedBody, Scene, SceneFile
from gfmd_numba.scene.document import Document

Record = TypeVar("Record", BoundaryFile, SceneFile)

_ROUNDING = 1e-3  # of the spacing, by which nodes may be off their places
_WHOLE = "all nodes of the period, as gfmd_numba.solve returns them; cut the fields inside afterwards"
_ALTERED = "contact: given a contact that was altered; allowed: what gfmd_numba.solve returns"
_FIELDS = (
    *("pressure", "normal_traction", "tangential_traction", "tangential_traction_y"),
    *("prescribed_normal_traction", "prescribed_tangential_traction"),
    *("body_height", "counter_body_height"),
)


def described(contact: xr.Dataset, body: str) -> tuple[Scene | LoadedBody, int]:
    """Scene of a dataset and the order its topography was followed to; raises InputError."""
    found = contact.variables.keys()
    if "scene" not in contact.attrs or not ({"x", "pressure"} <= found or {"x", "normal_traction"} <= found):
        raise InputError("contact: given no results of a contact; allowed: what gfmd_numba.solve returns")
    if "normal_traction" in contact:
        scene: Scene | LoadedBody = _recorded(BoundaryFile, contact).scene
        names, order = ["body"], 0
    else:
        file = _recorded(SceneFile, contact)
        check_where(Document(Path("contact"), "", file.model_dump()), file.scene, "fields inside", file.numerics)
        names = ["body"] if file.scene.counter_body is None else ["body", "counter_body"]
        scene, order = file.scene, file.numerics.slope_order(file.scene)
    if body not in names:
        raise InputError(f"body: given {body!r}; allowed: {' or '.join(map(repr, names))}")
    nodes = nodes_of(scene)
    loaded_beside = isinstance(scene, Scene) and scene.boundary is not None
    if not _is_whole(contact, nodes) or (loaded_beside and "prescribed_normal_traction" not in contact):
        raise InputError(_ALTERED)
    for dim in nodes:
        _check_period(contact[dim], dim, scene.length or 1.0)
    return scene, order


def nodes_of(scene: Scene | LoadedBody) -> tuple[str, ...]:
    """Dims of the nodes of a scene."""
    return ("x",) if isinstance(scene, LoadedBody) or scene.dimension == 1 else ("y", "x")


def _check_period(x: xr.DataArray, dim: str, length: float) -> None:
    """Raise InputError unless the nodes along x, or y, are all those of the period: the tractions are periodic."""
    present = x.size
    solved = x.attrs.get(POINTS, present)
    if str(solved) != str(present):
        raise InputError(f"contact: given {present} of the {solved} nodes of its period; allowed: {_WHOLE}")
    spacing, at = length / present, x.values.astype(np.float64)
    rounding = 4.0 * float(np.finfo(x.dtype).eps) * abs(at).max() if x.dtype.kind == "f" else 0.0
    if not (abs(np.diff(at) - spacing) <= _ROUNDING * spacing + rounding).all():
        given = f"nodes {dim} from {at[0]:.6g} to {at[-1]:.6g} that are not all {spacing:.6g} apart, as in a period"
        raise InputError(f"contact: given {given}; allowed: {_WHOLE}")


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
    named = all("units" in place.attrs for place in places) and "units" in fields[0].attrs
    return laid_out and numbers and named and contact.sizes.get("step", 1) > 0


def _recorded(record: type[Record], contact: xr.Dataset) -> Record:
    """Scene file that a dataset was solved from; raises InputError if its attribute is no such thing any more."""
    try:
        return record.model_validate_json(contact.attrs["scene"])
    except ValueError:
        raise InputError(
            "contact: given a contact whose scene is unreadable; allowed: what gfmd_numba.solve returns"
        ) from None
