"""Fields inside the body under a solved contact, as a dataset."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import xarray as xr

from gfmd_numba.dataset import CONVENTIONS
from gfmd_numba.elasticity import fields
from gfmd_numba.elasticity.fields import Elastic, Fields
from gfmd_numba.problem import effective_modulus
from gfmd_numba.scene import InputError, Scene, SceneFile

Reals = npt.NDArray[np.float64]

_LEVELS = 101
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


def body_fields(contact: xr.Dataset, z: npt.ArrayLike | None = None) -> xr.Dataset:
    """Displacement, strain and stress `(z, x)`, of a path `(step, z, x)`, inside the body of a solved contact.

    `z` counts from the undeformed surface, negative inside, in m (L_x without a length); by default 101 levels from
    the surface down to the base or, in a half-space, to L_x, denser near the surface. Stresses are in Pa (E* without
    a modulus), numbered as Voigt does. What belongs to a run that is not ok is not-a-number. Raises InputError for z
    outside the body and for a dataset that no contact was solved for. Thesis (2.4) to (2.6).
    """
    if "scene" not in contact.attrs or not {"x", "displacement", "pressure"} <= contact.variables.keys():
        raise InputError("contact: given no results of a contact; allowed: what gfmd_numba.solve returns")
    scene = SceneFile.model_validate_json(contact.attrs["scene"]).scene
    heights = _levels(scene) if z is None else _checked(scene, np.atleast_1d(np.asarray(z, dtype=np.float64)))
    if "step" in contact.dims:
        steps = [_one(scene, contact.isel(step=i), heights) for i in range(contact.sizes["step"])]
        joined = xr.concat(steps, "step", data_vars="all", coords="minimal", compat="override", join="exact")
        return joined.assign_coords({name: given for name, given in contact.coords.items() if given.dims == ("step",)})
    return _one(scene, contact, heights)


def _levels(scene: Scene) -> Reals:
    lowest = 1.0 if np.isinf(scene.body.aspect_ratio) else scene.body.aspect_ratio
    return 0.0 - lowest * (scene.length or 1.0) * np.linspace(0.0, 1.0, _LEVELS) ** 2


def _checked(scene: Scene, z: Reals) -> Reals:
    lowest = -scene.body.aspect_ratio * (scene.length or 1.0)
    outside = ~(np.isfinite(z) & (z <= 0.0) & (z >= lowest * (1.0 + 1e-12)))
    if z.ndim != 1 or outside.any():
        given = f"{z[outside][0]:g}" if z.ndim == 1 else f"an array of shape {z.shape}"
        unit = "L_x" if scene.length is None else "m"
        allowed = f"one row of heights in {unit} from the surface, {lowest:g} (the base) to 0"
        raise InputError(f"z: given {given}; allowed: {allowed}")
    return z


def _one(scene: Scene, contact: xr.Dataset, z: Reals) -> xr.Dataset:
    length, modulus = scene.length or 1.0, effective_modulus(scene.body)
    values = _fields(scene, contact, z / length)
    failed = int(contact["status"]) != 0
    dataset = xr.Dataset(coords={"z": z, "x": contact["x"]})
    unit = {"length": contact["x"].attrs["units"], "stress": contact["pressure"].attrs["units"], "1": "1"}
    scale = {"length": length, "stress": modulus, "1": 1.0}
    dataset["z"].attrs = {"long_name": "height above the undeformed surface", "units": unit["length"]}
    for field, (name, kind, long_name) in _NAMES.items():
        scaled = np.full_like(values.u1, np.nan) if failed else getattr(values, field) * scale[kind]
        dataset[name] = (("z", "x"), scaled, {"long_name": long_name, "units": unit[kind]})
    stresses = (dataset[f"stress_{i}"].values for i in (1, 2, 3, 5))
    attributes = {"long_name": "von Mises's equivalent stress", "units": unit["stress"]}
    dataset["von_mises"] = (("z", "x"), fields.von_mises(*stresses), attributes)
    dataset["pressure"] = contact["pressure"]
    dataset.attrs = {"Conventions": CONVENTIONS, "title": "fields inside the body", "scene": contact.attrs["scene"]}
    return dataset


def _fields(scene: Scene, contact: xr.Dataset, z: Reals) -> Fields:
    """Fields in L_x and E*."""
    body, length, modulus = scene.body, scene.length or 1.0, effective_modulus(scene.body)
    elastic = Elastic(body.effective_poissons_ratio, None if np.isinf(body.aspect_ratio) else body.aspect_ratio)
    normal, pressure = contact["displacement"].values / length, contact["pressure"].values / modulus
    if "tangential_displacement" in contact:
        tangential = contact["tangential_displacement"].values / length
        traction = contact["tangential_traction"].values / modulus
        found = fields.with_friction(tangential, normal, traction.mean(), pressure.mean(), elastic)
    else:
        found = fields.frictionless(normal, pressure.mean(), elastic)
    values = fields.fields(found, len(normal), z, elastic)
    if body.state == "plane_stress":
        return replace(values, stress2=np.zeros_like(values.stress2))
    return values
