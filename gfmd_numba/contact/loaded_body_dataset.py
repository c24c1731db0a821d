"""What `gfmd solve` writes of a body that is loaded without a punch."""

import numpy as np
import xarray as xr

from gfmd_numba.contact.dataset import (
    CONVENTIONS,
    POINTS,
    cf_attributes,
    measure_attributes,
    modulus_attributes,
    refuse_nonfinite,
    scales,
    units,
)
from gfmd_numba.contact.loaded_body import BoundaryValueProblem, LoadedBodyInput
from gfmd_numba.contact.loaded_rough_body import Loaded
from gfmd_numba.contact.plausible_numbers import implausible
from gfmd_numba.contact.rough_bodies_dataset import doubt, forming_tractions
from gfmd_numba.contact.rough_body_observables import ROUGH_BODY_OBSERVABLES
from gfmd_numba.scene import COMPONENTS
from gfmd_numba.scene.measured_record import AXES


def loaded_body_dataset(given: LoadedBodyInput, problem: BoundaryValueProblem, loaded: Loaded) -> xr.Dataset:
    """Displacements and tractions of all components over `x`, or (y, x), and how they were reached, in SI units.

    Of a rough body also its topography, and what forms that. The attribute `validity` holds reasons to doubt it.
    """
    file, deformed = given.file, loaded.deformed
    scene = file.scene
    scale, unit = scales(scene, 1.0), units(scene)
    dims, along = AXES[-scene.dimension :], {1: ("the surface",), 2: AXES}[scene.dimension]
    dataset = xr.Dataset()
    for dim, way, nodes in zip(dims, along, deformed.traction.shape[1:], strict=True):
        attributes = cf_attributes(f"position along {way}", unit["height"]) | {POINTS: nodes}
        dataset.coords[dim] = (dim, np.arange(nodes) / nodes * (scene.length or 1.0), attributes)
    for kind, quantity, values in (
        ("height", "displacement", deformed.displacement),
        ("pressure", "traction", deformed.traction),
    ):
        for component, of_nodes in zip(COMPONENTS[scene.dimension], values, strict=True):
            attributes = cf_attributes(f"{component.name} {quantity} of the body, {component.way}", unit[kind])
            dataset[component.key(quantity)] = (dims, of_nodes * scale[kind], attributes)
    if given.rough is not None:
        outwards = cf_attributes("topography of the body, peaks outwards", unit["height"])
        dataset["body_height"] = dims, given.rough.heights * scale["height"], outwards
        for name, kind, long_name, values in forming_tractions(given.rough, problem.order):
            dataset[name] = dims, values * scale[kind], cf_attributes(long_name.format("body"), unit[kind])
        error = ROUGH_BODY_OBSERVABLES["next_order"]
        added = loaded.next_order * scale["height"]
        dataset["next_order"] = ((), added, cf_attributes(error.long_name, unit["height"]))
    for name, long_name, kind, value in (
        ("status", "how the run ended", "1", np.int8(deformed.status)),
        ("residual", "largest unbalanced traction over the largest traction", "1", deformed.residual),
        ("n_iterations", "solver iterations", "1", deformed.n_iterations),
        ("n_transforms", "fast Fourier transforms of the surface", "1", deformed.n_transforms),
        ("wall_time", "time spent in the solver", "s", deformed.wall_time),
    ):
        dataset[name] = ((), value, measure_attributes(name, kind, long_name))
    refuse_nonfinite(dataset)
    dataset.attrs = {
        "Conventions": CONVENTIONS,
        "title": "loaded body",
        "scene": file.model_dump_json(),
        "solver": problem.options.solver,
        **modulus_attributes(scene),
    }
    sentences = implausible(scene)
    if given.rough is not None:
        sentences += [sentence for surface in given.measured for sentence in surface.doubts]
        sentences.append(doubt((given.rough,), problem.order, dataset, "normal_displacement"))
        dataset.attrs["processing"] = "\n".join(done for surface in given.measured for done in surface.done)
    dataset.attrs["validity"] = "\n".join(filter(None, sentences))
    return dataset
