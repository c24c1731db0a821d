"""Fields inside the body under a solved contact, as a dataset."""

from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np
import numpy.typing as npt
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.bodies import effective_modulus, elastic_body
from gfmd_numba.contact.dataset import CONVENTIONS, POINTS
from gfmd_numba.contact.refusal import check_where
from gfmd_numba.elasticity import fields, topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.scene import Body, BoundaryFile, InputError, LoadedBody, Scene, SceneFile
from gfmd_numba.scene.document import Document
from gfmd_numba.text.input_error import brief

Record = TypeVar("Record", BoundaryFile, SceneFile)

_LEVELS = 101
_ROUNDING = 1e-3  # of the spacing, by which nodes may be off their places
_WHOLE = "all nodes of the period, as gfmd_numba.solve returns them; cut the fields inside afterwards"
_FIELDS = ("pressure", "normal_traction", "tangential_traction", "body_height", "counter_body_height")
_NAMES = {
    "u1": ("displacement_1", "length", "displacement along x"),
    "u3": ("displacement_3", "length", "displacement along z, out of the body"),
    "strain1": ("strain_1", "1", "strain along x"),
    "strain3": ("strain_3", "1", "strain along z"),
    "strain5": ("strain_5", "1", "engineering shear strain in the plane"),
    "stress1": ("stress_1", "stress", "stress along x, tension positive"),
    "stress2": ("stress_2", "stress", "stress out of the plane, tension positive"),
    "stress3": ("stress_3", "stress", "stress along z, tension positive"),
    "stress5": ("stress_5", "stress", "shear stress in the plane"),
}


def body_fields(contact: xr.Dataset, z: npt.ArrayLike | None = None, body: str = "body") -> xr.Dataset:
    """Displacement, strain and stress `(z, x)`, of a path `(step, z, x)`, inside a body of a solved contact.

    `z` counts from the mean plane of the undeformed surface, negative inside, in m (L_x without a length); by default
    101 levels from the surface down to the rigid base, else to L_x or the last layer, denser near the surface; at an
    interface of layers stresses are those above it. Stresses are in Pa (E* without a modulus), numbered as Voigt does.
    (x, z) of a rough body are labels, its places while it was flat:
    `formed_1` and `formed_3` (u'' of thesis 5.2) take them to the stress-free body. A `counter_body` is seen in axes of
    its own, z out of it. What belongs to a run that is not ok is not-a-number. Raises InputError for z outside the
    body and for a dataset that no contact was solved for. Thesis (2.4) to (2.6), (5.6).
    """
    scene, order = _described(contact, body)
    asked = scene.body if body == "body" or isinstance(scene, LoadedBody) else scene.counter_body
    assert asked is not None  # _described's promise
    length = scene.length or 1.0
    elastic = elastic_body(asked, scene.length)
    heights = _levels(elastic, length) if z is None else _checked(elastic, length, _numbers(z))
    whole = contact if "step" in contact.dims else contact.expand_dims("step")
    steps = [_one(asked, elastic, length, order, whole.isel(step=i), heights, body) for i in range(whole.sizes["step"])]
    if "step" not in contact.dims:
        return steps[0]
    joined = xr.concat(steps, "step", data_vars="all", coords="minimal", compat="override", join="exact")
    return joined.assign_coords({name: given for name, given in contact.coords.items() if given.dims == ("step",)})


def _described(contact: xr.Dataset, body: str) -> tuple[Scene | LoadedBody, int]:
    """Scene of a dataset and the order its topography was followed to; raises InputError."""
    found = contact.variables.keys()
    if "scene" not in contact.attrs or not ({"x", "pressure"} <= found or {"x", "normal_traction"} <= found):
        raise InputError("contact: given no results of a contact; allowed: what gfmd_numba.solve returns")
    if "normal_traction" in contact:
        scene: Scene | LoadedBody = _recorded(BoundaryFile, contact).scene
        names, order = ["body"], 0
    else:
        file = _recorded(SceneFile, contact)
        check_where(Document(Path("contact"), "", file.model_dump()), file.scene, "fields inside")
        names = ["body"] if file.scene.counter_body is None else ["body", "counter_body"]
        scene, order = file.scene, file.numerics.slope_order(file.scene)
    if body not in names:
        raise InputError(f"body: given {body!r}; allowed: {' or '.join(map(repr, names))}")
    if not _is_whole(contact):
        raise InputError("contact: given a contact that was altered; allowed: what gfmd_numba.solve returns")
    _check_period(contact["x"], scene.length or 1.0)
    return scene, order


def _check_period(x: xr.DataArray, length: float) -> None:
    """Raise InputError unless the nodes `x` are all those of the period: the tractions between them are periodic."""
    present = x.size
    solved = x.attrs.get(POINTS, present)
    if str(solved) != str(present):
        raise InputError(f"contact: given {present} of the {solved} nodes of its period; allowed: {_WHOLE}")
    spacing, at = length / present, x.values.astype(np.float64)
    rounding = 4.0 * float(np.finfo(x.dtype).eps) * abs(at).max() if x.dtype.kind == "f" else 0.0
    if not (abs(np.diff(at) - spacing) <= _ROUNDING * spacing + rounding).all():
        given = f"nodes x from {at[0]:.6g} to {at[-1]:.6g} that are not all {spacing:.6g} apart, as in a period"
        raise InputError(f"contact: given {given}; allowed: {_WHOLE}")


def _is_whole(contact: xr.Dataset) -> bool:
    """Whether what the fields are made from is there, in numbers with units over x, and a step if there are some."""
    fields = [contact[name] for name in _FIELDS if name in contact]
    if "status" not in contact or contact["x"].dims != ("x",) or contact.sizes["x"] < 4:
        return False
    laid_out = {field.dims for field in fields} <= {("x",), ("step", "x")} and contact["status"].dims in ((), ("step",))
    numbers = all(each.dtype.kind in "fiu" for each in (contact["x"], contact["status"], *fields))
    named = "units" in contact["x"].attrs and "units" in fields[0].attrs
    return laid_out and numbers and named and contact.sizes.get("step", 1) > 0


def _recorded(record: type[Record], contact: xr.Dataset) -> Record:
    """Scene file that a dataset was solved from; raises InputError if its attribute is no such thing any more."""
    try:
        return record.model_validate_json(contact.attrs["scene"])
    except ValueError:
        raise InputError(
            "contact: given a contact whose scene is unreadable; allowed: what gfmd_numba.solve returns"
        ) from None


def _levels(body: ElasticBody, length: float) -> Reals:
    layers = 0.0 if body.stack is None else body.stack.height
    lowest = max(1.0, layers) if body.aspect_ratio is None else body.aspect_ratio
    return 0.0 - lowest * length * np.linspace(0.0, 1.0, _LEVELS) ** 2


def _numbers(z: npt.ArrayLike) -> Reals:
    try:
        return np.atleast_1d(np.asarray(z, dtype=np.float64))
    except (TypeError, ValueError):
        raise InputError(f"z: given {brief(z)}; allowed: a number, or one row of numbers") from None


def _checked(body: ElasticBody, length: float, z: Reals) -> Reals:
    lowest = body.base * length
    outside = ~(np.isfinite(z) & (z <= 0.0) & (z >= lowest * (1.0 + 1e-12)))
    if z.ndim != 1 or z.size == 0 or outside.any():
        given = f"{z[outside][0]:g}" if z.ndim == 1 and z.size else f"an array of shape {z.shape}"
        allowed = f"one row of heights from the surface, in the unit of x, {lowest:g} (the base) to 0"
        raise InputError(f"z: given {given}; allowed: {allowed}")
    return z


def _one(
    body: Body, elastic: ElasticBody, length: float, order: int, contact: xr.Dataset, z: Reals, name: str
) -> xr.Dataset:
    modulus = effective_modulus(body)
    nx = contact.sizes["x"]
    side = -1.0 if name == "counter_body" else 1.0  # the traction of the dataset is that on the body
    along = side * contact.get("tangential_traction", xr.zeros_like(contact["x"])).values / modulus
    normal = -contact["pressure"].values if "pressure" in contact else contact["normal_traction"].values
    flat = fields.surface_under_tractions(along, normal / modulus, elastic)
    formed = None
    if f"{name}_height" in contact:
        topography_ = contact[f"{name}_height"].values / length
        response = topography.respond(-normal / modulus, topography_, elastic, order, along)
        values = topography.rough_fields(flat, response, z / length, elastic)
        formed = fields.fields_inside(topography.formed_surface(topography_, elastic), nx, z / length, elastic)
    else:
        values = fields.fields_inside(flat, nx, z / length, elastic)
    if body.state == "plane_stress":
        values = replace(values, stress2=np.zeros_like(values.stress2))
    dataset = xr.Dataset(coords={"z": z, "x": contact["x"]})
    stress_unit = (contact["pressure"] if "pressure" in contact else contact["normal_traction"]).attrs["units"]
    unit = {"length": contact["x"].attrs["units"], "stress": stress_unit, "1": "1"}
    scale = {"length": length, "stress": modulus, "1": 1.0}
    dataset["z"].attrs = {"long_name": "height above the undeformed surface", "units": unit["length"]}
    failed = int(contact["status"]) != 0
    for field, (variable, kind, long_name) in _NAMES.items():
        scaled = np.full_like(values.u1, np.nan) if failed else getattr(values, field) * scale[kind]
        if not failed and not np.isfinite(scaled).all():
            raise InputError(
                "contact: given a contact whose fields are not finite; allowed: what gfmd_numba.solve returns"
            )
        dataset[variable] = (("z", "x"), scaled, {"long_name": long_name, "units": unit[kind]})
    stresses = (dataset[f"stress_{i}"].values for i in (1, 2, 3, 5))
    attributes = {"long_name": "von Mises's equivalent stress", "units": unit["stress"]}
    dataset["von_mises"] = (("z", "x"), fields.von_mises(*stresses), attributes)
    if formed is not None:
        for variable, moved in (("formed_1", formed.u1), ("formed_3", formed.u3)):
            attributes = {"long_name": "displacement that forms the topography", "units": unit["length"]}
            dataset[variable] = (("z", "x"), moved * length, attributes)
    dataset["pressure"] = ("x", -normal, {"long_name": "pressure on the surface", "units": unit["stress"]})
    dataset.attrs = {"Conventions": CONVENTIONS, "title": "fields inside the body", "scene": contact.attrs["scene"]}
    return dataset
