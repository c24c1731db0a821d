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
from gfmd_numba.contact.loaded_body import BoundaryValueProblem
from gfmd_numba.scene import COMPONENTS, BoundaryFile
from gfmd_numba.solvers.boundary_value_problem import Deformed


def loaded_body_dataset(file: BoundaryFile, problem: BoundaryValueProblem, deformed: Deformed) -> xr.Dataset:
    """Displacements and tractions of both components over `x`, and how they were reached, in SI units."""
    scene = file.scene
    scale, unit = scales(scene, 1.0), units(scene)
    nx = deformed.traction.shape[1]
    dataset = xr.Dataset(coords={"x": np.arange(nx) / nx * (scene.length or 1.0)})
    dataset["x"].attrs = cf_attributes("position along the surface", unit["height"]) | {POINTS: nx}
    for kind, quantity, values in (
        ("height", "displacement", deformed.displacement),
        ("pressure", "traction", deformed.traction),
    ):
        for component, direction, row in zip(COMPONENTS[::-1], ("along x", "out of it"), values, strict=True):
            attributes = cf_attributes(f"{component} {quantity} of the body, {direction}", unit[kind])
            dataset[f"{component}_{quantity}"] = ("x", row * scale[kind], attributes)
    for name, long_name, kind, value in (
        ("status", "how the run ended", "1", np.int8(deformed.status)),
        ("residual", "largest unbalanced traction over the largest traction", "1", deformed.residual),
        ("n_iterations", "solver iterations", "1", deformed.n_iterations),
        ("n_transforms", "fast Fourier transforms of length nx", "1", deformed.n_transforms),
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
    return dataset
