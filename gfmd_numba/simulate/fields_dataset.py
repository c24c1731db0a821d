"""What the variables of fields inside a body are called, and their units."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.bodies import effective_modulus
from gfmd_numba.contact.dataset import CONVENTIONS, cf_attributes
from gfmd_numba.elasticity import fields
from gfmd_numba.scene import Body, InputError

Names = Mapping[str, tuple[str, str, str]]  # of a field: of its variable, its kind, and in words

OF_PROFILES: Names = {
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
OF_MAPS: Names = {
    "u1": ("displacement_1", "length", "displacement along x"),
    "u2": ("displacement_2", "length", "displacement along y"),
    "u3": ("displacement_3", "length", "displacement along z, out of the body"),
    "strain1": ("strain_1", "1", "strain along x"),
    "strain2": ("strain_2", "1", "strain along y"),
    "strain3": ("strain_3", "1", "strain along z"),
    "strain4": ("strain_4", "1", "engineering shear strain of y and z"),
    "strain5": ("strain_5", "1", "engineering shear strain of x and z"),
    "strain6": ("strain_6", "1", "engineering shear strain of x and y"),
    "stress1": ("stress_1", "stress", "stress along x, tension positive"),
    "stress2": ("stress_2", "stress", "stress along y, tension positive"),
    "stress3": ("stress_3", "stress", "stress along z, tension positive"),
    "stress4": ("stress_4", "stress", "shear stress of y and z"),
    "stress5": ("stress_5", "stress", "shear stress of x and z"),
    "stress6": ("stress_6", "stress", "shear stress of x and y"),
}


@dataclass(frozen=True)
class Scales:
    """What lengths in L_x and stresses in E* are worth, and their units in the file."""

    worth: Mapping[str, float]
    units: Mapping[str, str]

    @classmethod
    def of(cls, contact: xr.Dataset, body: Body, length: float) -> "Scales":
        """Scales of a body of a solved contact."""
        stress = (contact["pressure"] if "pressure" in contact else contact["normal_traction"]).attrs["units"]
        worth = {"length": length, "stress": effective_modulus(body, stress != "1"), "1": 1.0}
        return cls(worth, {"length": contact["x"].attrs["units"], "stress": stress, "1": "1"})

    def attributes(self, kind: str, long_name: str) -> dict[str, str]:
        """CF attributes of a variable of this kind."""
        return cf_attributes(long_name, self.units[kind])


def begun(contact: xr.Dataset, z: Reals, scales: Scales) -> xr.Dataset:
    """Dataset of fields over z and the nodes of a contact, without any yet."""
    nodes = {str(dim): contact[dim] for dim in ("y", "x") if dim in contact.dims}
    dataset = xr.Dataset(coords={"z": z, **nodes})
    dataset["z"].attrs = scales.attributes("length", "height above the undeformed surface")
    dataset.attrs = {"Conventions": CONVENTIONS, "scene": contact.attrs["scene"]}
    return dataset


def add_fields(
    dataset: xr.Dataset, dims: Sequence[str], values: Mapping[str, Reals], names: Names, scales: Scales, failed: bool
) -> None:
    """Add fields by their names, not-a-number where the run failed; raises InputError for any that are not finite."""
    for name, (variable, kind, long_name) in names.items():
        scaled = np.full_like(values[name], np.nan) if failed else values[name] * scales.worth[kind]
        if not failed and not np.isfinite(scaled).all():
            raise InputError(
                "contact: you gave a contact whose fields are not finite; gfmd allows what gfmd_numba.solve returns"
            )
        dataset[variable] = (dims, scaled, scales.attributes(kind, long_name))


def add_von_mises(dataset: xr.Dataset, dims: Sequence[str], scales: Scales) -> None:
    """Add von Mises's equivalent stress of all stresses that are there."""
    stresses = (dataset[f"stress_{i}"].values for i in range(1, 7) if f"stress_{i}" in dataset)
    attributes = scales.attributes("stress", "von Mises's equivalent stress")
    dataset["von_mises"] = (dims, fields.von_mises(*stresses), attributes)


def add_formed(dataset: xr.Dataset, dims: Sequence[str], moved: Mapping[str, Reals], scales: Scales) -> None:
    """Add the displacements (L_x) that form a topography from a flat body, by their names."""
    attributes = scales.attributes("length", "displacement that forms the topography")
    for name, values in moved.items():
        dataset[name] = (dims, values * scales.worth["length"], attributes)
