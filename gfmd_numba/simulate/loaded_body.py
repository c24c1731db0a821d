"""One body without a punch, loaded and displaced as its boundary prescribes, from a file to a dataset."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from gfmd_numba.contact.dataset import (
    CONVENTIONS,
    measure_attributes,
    modulus_attributes,
    refuse_nonfinite,
    scales,
    units,
)
from gfmd_numba.contact.problem import elastic_body, solver_options
from gfmd_numba.contact.refusal import check_combination
from gfmd_numba.contact.tractions import balanced, read_boundary
from gfmd_numba.scene import COMPONENTS, BoundaryFile, Document, LoadedBody, load_boundary
from gfmd_numba.solvers.boundary_value_problem import Deformed, deform
from gfmd_numba.solvers.table import able

Reals = npt.NDArray[np.float64]

SOLVER = able(["prescribed"])[0]


def solve_loaded(source: str | Path | Mapping[str, Any] | BoundaryFile) -> xr.Dataset:
    """Displacements and tractions of both components over `x`, and how they were reached, in SI units.

    Raises InputError for a boundary that is over-determined or out of balance; a run that fails says so in `status`.
    """
    file, document = load_boundary(source)
    scene = file.scene
    check_combination(document, scene, file.numerics)
    arrays = _balanced(document, scene, read_boundary(document, scene.boundary, file.points))
    nx = len(next(iter(arrays.values())))
    scale = scales(scene, 1.0)
    # tangential, then normal
    traction, displacement = (
        np.stack([arrays.get(f"{component}_{kind}", np.full(nx, np.nan)) for component in COMPONENTS[::-1]])
        for kind in ("traction", "displacement")
    )
    deformed = deform(
        elastic_body(scene.body, scene.length).coupled_stiffness(nx),
        np.nan_to_num(traction, nan=0.0) / scale["pressure"],
        displacement / scale["height"],
        solver_options(file.numerics, SOLVER),
    )
    dataset = _dataset(scene, deformed)
    dataset.attrs |= {"scene": file.model_dump_json(), "solver": SOLVER}
    return dataset


def _balanced(document: Document, scene: LoadedBody, arrays: dict[str, Reals]) -> dict[str, Reals]:
    """Raise InputError for means that nothing holds, or that nothing tells."""
    body = scene.body
    if body.is_half_space:
        for component in COMPONENTS:
            if f"{component}_displacement" not in arrays:
                remedy = f"or {body.holder} or a {component}_displacement, as nothing holds a half-space"
                arrays = balanced(document, arrays, component, remedy)
    elif body.is_incompressible and np.isfinite(arrays.get("normal_displacement", np.nan)).all():
        raise document.error(
            ("scene", "boundary", "normal_displacement"),
            document.value(("scene", "boundary", "normal_displacement")),
            "not-a-number for at least one node of an incompressible slab, whose pressure no displacement tells",
        )
    return arrays


def _dataset(scene: LoadedBody, deformed: Deformed) -> xr.Dataset:
    scale, unit = scales(scene, 1.0), units(scene)
    nx = deformed.traction.shape[1]
    dataset = xr.Dataset(coords={"x": np.arange(nx) / nx * (scene.length or 1.0)})
    dataset["x"].attrs = {"long_name": "position along the surface", "units": unit["height"]}
    for kind, quantity, values in (
        ("height", "displacement", deformed.displacement),
        ("pressure", "traction", deformed.traction),
    ):
        for component, direction, row in zip(COMPONENTS[::-1], ("along x", "out of it"), values, strict=True):
            attributes = {"long_name": f"{component} {quantity} of the body, {direction}", "units": unit[kind]}
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
    dataset.attrs = {"Conventions": CONVENTIONS, "title": "loaded body"} | modulus_attributes(scene)
    return dataset
