"""Results as xarray datasets in SI units: one contact, or a whole campaign."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.bodies import contact_modulus, elastic_body, stiffness_scale
from gfmd_numba.contact.evaluation import gap, measure
from gfmd_numba.contact.finiteness import finite_status
from gfmd_numba.contact.observables import Observable, recorded
from gfmd_numba.contact.problem import Effect, Problem
from gfmd_numba.contact.state import Contact
from gfmd_numba.interface import vector_slip
from gfmd_numba.scene import COMPONENTS, LoadedBody, Scene
from gfmd_numba.scene.heights import AXES
from gfmd_numba.scene.quantities import (
    FORCE_ON_A_MAP,
    LINE_LOAD,
    MEAN_PRESSURE,
    PUNCH_DISPLACEMENT,
    REDUCED_PRESSURE,
    RMS_GRADIENT_TARGET,
)
from gfmd_numba.solvers import status

CONVENTIONS = "CF-1.11"
POINTS = "points_per_period"  # attribute of x, which tells a whole period from a part of one
# coordinates of what a loading prescribes; the fields of a contact have the short names
PRESCRIBED = {"displacement": "punch_displacement", "pressure": "prescribed_pressure"}
INDICES = {
    "case": "case, in the order of the campaign",
    "realisation": "realisation: the same random surface in every case",
    "step": "step of the path, from the first loading",
}


def scales(scene: Scene | LoadedBody, rms_gradient: float) -> dict[str, float]:
    """What each unit of the dimensionless problem is worth: lengths in m (or L_x), stresses in Pa (or E*)."""
    height, pressure = rms_gradient * (scene.length or 1.0), rms_gradient * contact_modulus(scene)
    return {
        "1": 1.0,
        "E*/stiffness": 1.0 / stiffness_scale(scene),
        "gradient": rms_gradient,
        "height": height,
        "pressure": pressure,
        "energy": pressure * height,
        "s": 1.0,
    }


def units(scene: Scene | LoadedBody) -> dict[str, str]:
    """Name of each unit in the files; L_x and E* count as 1 where the scene leaves them open."""
    height, pressure = "m" if scene.length else "1", "Pa" if scene.has_moduli else "1"
    named = [unit for unit in (pressure, height) if unit != "1"]
    return {
        "1": "1",
        "E*/stiffness": "1",
        "gradient": "1",
        "height": height,
        "pressure": pressure,
        "energy": "J m-2" if len(named) == 2 else "".join(named) or "1",
        "force per length": "N m-1",
        "force": "N",
        "s": "s",
    }


def modulus_attributes(scene: Scene | LoadedBody) -> dict[str, str]:
    """Attributes of a dataset whose E* is that of one layer among others; none of any other."""
    bodies = (scene.body,) if isinstance(scene, LoadedBody) else scene.deformable
    if all(body.layers is None for body in bodies) or not scene.has_moduli:
        return {}
    modulus = contact_modulus(scene) / stiffness_scale(scene)
    whose = "the topmost layer" if len(bodies) == 1 else "both bodies together, of layers the topmost"
    return {"effective_modulus": f"{modulus:.17g} Pa: E* is that of {whose}"}


def load_attributes(scene: Scene) -> dict[str, dict[str, Any]]:
    """CF attributes of what a loading prescribes, by the name of its coordinate."""
    height = units(scene)["height"]
    return {
        "reduced_pressure": cf_attributes(REDUCED_PRESSURE),
        "prescribed_pressure": cf_attributes(MEAN_PRESSURE, "Pa"),
        "line_load": cf_attributes(LINE_LOAD, "N m-1"),
        "force": cf_attributes(FORCE_ON_A_MAP, "N"),
        "punch_displacement": cf_attributes(PUNCH_DISPLACEMENT, height),
        "sliding": cf_attributes("tangential displacement of the punch since first touch", height),
        "sliding_y": cf_attributes("tangential displacement of the punch along y since first touch", height),
    }


def dropped_effects(effects: Iterable[Effect]) -> str:
    """One line for each effect of the scene that was left out of the computation."""
    return "\n".join(f"{effect.name}: {effect.reason}" for effect in effects if effect.state == "dropped")


def cf_attributes(long_name: str, units: str = "1") -> dict[str, Any]:
    """What every variable and coordinate that is written says of itself."""
    return {"long_name": long_name, "units": units}


def measure_attributes(name: str, unit: str, long_name: str) -> dict[str, Any]:
    """CF attributes of a measure."""
    attributes = cf_attributes(long_name, unit)
    if name == "status":
        attributes |= status.flag_attributes(status.SENTENCES)
    if name.startswith("kappa"):
        attributes["comment"] = (
            "not-a-number where the mean pressure is not above 0: under tension area has no such law"
        )
    return attributes


def contact_dataset(scene: Scene, problem: Problem, rms_gradient: float, contact: Contact) -> xr.Dataset:
    """Fields over x, or (y, x), and scalars of the first realisation of a contact.

    Displacements count from the unloaded body on a slab, and from their own mean on a half-space, whose mean
    displacement has no reference.
    """
    scale, unit = scales(scene, rms_gradient), units(scene)
    displacement = contact.equilibrium.displacement[0]
    if problem.displacement is None:
        displacement = displacement - displacement.mean() - _uniform_compression(scene, problem)
    if contact.change.out is not None:
        displacement = displacement + contact.change.out[0]
    fields = {
        "height": ("height", "height of the punch, peaks towards the body", contact.heights[0]),
        "pressure": ("pressure", "contact pressure", contact.equilibrium.pressure[0]),
        "displacement": ("height", "normal displacement of the body, positive towards the punch", displacement),
        "gap": ("height", "gap between the surfaces", gap(contact)[0]),
    }
    if problem.interface.hardness is not None:
        of_punch = "depth by which the punch has been flattened, kept when it is unloaded"
        fields["plastic_depth"] = "height", of_punch, np.asarray(contact.plastic_depth)[0]
    fields |= _tangential_fields(contact, problem.interface.friction is not None)
    if problem.tractions is not None:
        given = *problem.tractions.tangential, problem.tractions.normal
        for component, values in zip(COMPONENTS[scene.dimension], given, strict=True):
            long_name = f"prescribed traction on the body, {component.way}"
            fields[f"prescribed_{component.key('traction')}"] = "pressure", long_name, values
    dims, along = AXES[-scene.dimension :], {1: ("the interface",), 2: AXES}[scene.dimension]
    coordinates: dict[str, Any] = {}
    for dim, way, nodes in zip(dims, along, contact.heights.shape[1:], strict=True):
        attributes = cf_attributes(f"position along {way}", unit["height"]) | {POINTS: nodes}
        coordinates[dim] = (dim, np.arange(nodes) / nodes * (scene.length or 1.0), attributes)
    coordinates["rms_gradient_target"] = ((), rms_gradient, cf_attributes(RMS_GRADIENT_TARGET))
    variables: dict[str, Any] = {
        name: (dims, values * scale[kind], cf_attributes(long_name, unit[kind]))
        for name, (kind, long_name, values) in fields.items()
    }
    measures = measure(contact)
    for name, row in recorded(problem.interface.hardness is not None).items():
        attributes = measure_attributes(name, unit[row.unit], row.long_name)
        variables[name] = ((), scaled(measures[name][0], scale[row.unit]), attributes)
    if contact.equilibrium.growing_wave is not None:
        attributes = measure_attributes("growing_wave", "1", "index of the wave that grew most before it was unstable")
        variables["growing_wave"] = ((), contact.equilibrium.growing_wave[0], attributes)
    attrs = {"Conventions": CONVENTIONS, "title": "rough contact"} | modulus_attributes(scene)
    dataset = xr.Dataset(variables, coordinates, attrs)  # at once: each addition aligns what is there
    refuse_nonfinite(dataset)
    return dataset


def _tangential_fields(contact: Contact, rubs: bool) -> dict[str, tuple[str, str, Reals]]:
    """Tangential fields of the first realisation, on maps along x and y; none where the normal one is alone."""
    tangential = contact.equilibrium.tangential
    if tangential is None:
        return {}
    sideways = tangential.displacement[0]
    if contact.change.along is not None:
        sideways = sideways + contact.change.along[0]
    kinds = {
        "displacement": ("height", "tangential displacement of the body", sideways),
        "traction": ("pressure", "tangential traction of the punch on the body", tangential.traction[0]),
    }
    ways = {"": " along x", "_y": " along y"} if len(sideways) > 1 else {"": ""}
    fields = {
        f"tangential_{kind}{suffix}": (unit, f"{long_name}{way}", values[i])
        for kind, (unit, long_name, values) in kinds.items()
        for i, (suffix, way) in enumerate(ways.items())
    }
    if rubs:
        slid = vector_slip.length(tangential.slip[0])
        fields["slip"] = ("height", "way a touching node has slid in this step, 0 where it sticks", slid)
    return fields


def refuse_nonfinite(dataset: xr.Dataset) -> None:
    """Change a status that is ok where a result of one run, in its units, is not finite."""
    results = {str(name): variable.values for name, variable in dataset.data_vars.items()}
    dataset["status"].values = finite_status(results)


def scaled(values: npt.NDArray[Any], factor: float) -> npt.NDArray[Any]:
    """Values in file units; counts and flags keep their integer type."""
    return values if factor == 1.0 else values * factor


def _uniform_compression(scene: Scene, problem: Problem) -> float:
    uniform = float(elastic_body(scene.body, scene.length).condensed_stiffness(np.zeros(1))[0])
    return 0.0 if problem.mean_pressure is None or uniform == 0.0 else problem.mean_pressure / uniform


def campaign_dataset(
    coordinates: Mapping[str, tuple[str | tuple[str, ...], list[Any], dict[str, Any]]],
    rows: Mapping[str, Observable],
    values: list[dict[str, npt.NDArray[Any]]],
    unit: Mapping[str, str],
) -> xr.Dataset:
    """Dataset `(case, realisation)` of the measures of every case, already in file units, with `step` along a path."""
    variables = {}
    values = [case | {"status": finite_status(case)} for case in values]
    for name, row in rows.items():
        stacked = np.stack([case[name] for case in values])
        variables[name] = (
            ("case", "realisation", "step")[: stacked.ndim],
            stacked,
            measure_attributes(name, unit[row.unit], row.long_name),
        )
    return indexed(xr.Dataset(variables, attrs={"Conventions": CONVENTIONS})).assign_coords(coordinates)


def indexed(dataset: xr.Dataset) -> xr.Dataset:
    """Dataset with a number for each case, realisation and step."""
    counted = [str(dim) for dim in dataset.dims if dim in INDICES]
    return dataset.assign_coords(
        {name: (name, np.arange(dataset.sizes[name]), cf_attributes(INDICES[name])) for name in counted}
    )
