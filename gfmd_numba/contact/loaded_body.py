"""A body that is loaded and displaced without a punch: what its file prescribes, as a dimensionless problem."""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.bodies import contact_modulus, elastic_body
from gfmd_numba.contact.reduction import solver_options
from gfmd_numba.contact.refusal import check_combination
from gfmd_numba.contact.tractions import balanced, read_boundary
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.scene import COMPONENTS, BoundaryFile, Document
from gfmd_numba.scene.document import Location
from gfmd_numba.scene.memory import ARRAYS_OF_A_LOADED_BODY, beyond_memory
from gfmd_numba.solvers.boundary_value_problem import Deformed, deform
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.table import able

Prescribed = dict[str, Reals]  # by the key of the boundary `[(ny,) nx]` in Pa and m, or E* and L_x


@dataclass(frozen=True)
class BoundaryValueProblem:
    """Tractions (E*) and displacements (L_x) `[component, (y,) x]`, the normal ones last; not-a-number where free."""

    body: ElasticBody
    traction: Reals
    displacement: Reals
    options: Options


def read_loaded_body(file: BoundaryFile, document: Document) -> Prescribed:
    """Whatever a file prescribes, node by node; raises InputError for what is over-determined or out of balance."""
    check_combination(document, file.scene, file.numerics)
    body, dimension = file.scene.body, file.scene.dimension
    shape = None if file.points is None else (file.points,) * dimension
    if shape is not None:
        _check_memory(document, ("points",), shape)
    arrays = read_boundary(document, file.scene.boundary, dimension, shape)
    name, given = next(iter(arrays.items()))
    _check_memory(document, ("scene", "boundary", name), given.shape)
    if body.is_half_space:
        for component in COMPONENTS[dimension][::-1]:
            held = component.key("displacement")
            if held not in arrays:
                remedy = f"or {body.holder} or a {held}, as nothing holds a half-space"
                arrays = balanced(document, arrays, component.key("traction"), remedy)
    elif body.is_incompressible and np.isfinite(arrays.get("normal_displacement", np.nan)).all():
        raise document.error(
            ("scene", "boundary", "normal_displacement"),
            document.value(("scene", "boundary", "normal_displacement")),
            "not-a-number for at least one node of an incompressible slab, whose pressure no displacement tells",
        )
    return arrays


def reduce_loaded_body(file: BoundaryFile, prescribed: Prescribed) -> BoundaryValueProblem:
    """Dimensionless problem of what is prescribed."""
    free, components = np.full(next(iter(prescribed.values())).shape, np.nan), COMPONENTS[file.scene.dimension]
    traction, displacement = (
        np.stack([prescribed.get(component.key(quantity), free) for component in components])
        for quantity in ("traction", "displacement")
    )
    return BoundaryValueProblem(
        elastic_body(file.scene.body, file.scene.length),
        np.nan_to_num(traction, nan=0.0) / contact_modulus(file.scene),
        displacement / (file.scene.length or 1.0),
        solver_options(file.numerics, able(["prescribed"])[0]),
    )


def solve_boundary_value_problem(problem: BoundaryValueProblem) -> Deformed:
    """Displacements and tractions of the surface."""
    stiffness = problem.body.stiffness_of_all(problem.traction.shape[1:])
    return deform(stiffness, problem.traction, problem.displacement, problem.options)


def _check_memory(document: Document, place: Location, shape: tuple[int, ...]) -> None:
    if allowed := beyond_memory(float(np.prod(shape, dtype=float)), ARRAYS_OF_A_LOADED_BODY[len(shape)]):
        raise document.error(place, document.value(place), allowed)
