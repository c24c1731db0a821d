"""A body that is loaded and displaced without a punch: from its file to a problem, its solution and a dataset.

A rough body is the flat one, and what its topography adds.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.contact_dataset import forming_tractions
from gfmd_numba.contact.contact_input import with_measured_surfaces
from gfmd_numba.contact.dataset import (
    CONVENTIONS,
    Units,
    modulus_attributes,
    refuse_nonfinite,
)
from gfmd_numba.contact.doubts import doubt_of_bodies
from gfmd_numba.contact.observables import OBSERVABLES, ROUGH_BODY_OBSERVABLES
from gfmd_numba.contact.plausible_numbers import implausible
from gfmd_numba.contact.reduction import solver_options
from gfmd_numba.contact.refusal import check_combination
from gfmd_numba.contact.rough_surfaces import RoughBody, pressed_bodies
from gfmd_numba.contact.scales import scales_of
from gfmd_numba.contact.tractions import balanced, read_boundary
from gfmd_numba.elasticity import topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.roughness.measured import MeasuredSurface
from gfmd_numba.scene import COMPONENTS, BoundaryFile, Document
from gfmd_numba.scene.checks import arrays_of_a_loaded_body, check_nodes
from gfmd_numba.scene.measured_record import AXES
from gfmd_numba.solvers.boundary_value_problem import Deformed, deform
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options, able

Prescribed = dict[str, Reals]  # by the key of the boundary `[(ny,) nx]` in Pa and m, or E* and L_x

_MOST_ROUNDS = 30
_TOLD = {
    "residual": "largest unbalanced traction over the largest traction",
    "n_transforms": "fast Fourier transforms of the surface",
}


@dataclass(frozen=True)
class LoadedBodyInput:
    """A file, what it prescribes, and its body if that is rough; `measured` are the surfaces read from files."""

    file: BoundaryFile
    prescribed: Prescribed
    rough: RoughBody | None = None
    measured: tuple[MeasuredSurface, ...] = ()


@dataclass(frozen=True)
class BoundaryValueProblem:
    """Tractions (E*) and displacements (L_x) `[component, (y,) x]`, the normal ones last; not-a-number where free.

    A rough body has `heights` `[(y,) x]` in L_x, which are followed to an `order` in their slope.
    """

    body: ElasticBody
    traction: Reals
    displacement: Reals
    options: Options
    heights: Reals | None = None
    order: int = 0


def read_loaded_body(file: BoundaryFile, document: Document) -> LoadedBodyInput:
    """Whatever a file describes or names; raises InputError for what is over-determined, or does not fit or balance."""
    file, measured = with_measured_surfaces(file, document)
    check_combination(document, file.scene, file.numerics)
    rough = None
    if file.scene.follows_topography:
        (rough,) = pressed_bodies(file, measured, document).bodies or ()
    body, dimension = file.scene.body, file.scene.dimension
    needed = arrays_of_a_loaded_body(dimension, file.slope_order)
    shape = None if file.points is None else (file.points,) * dimension
    if rough is not None:
        shape = rough.heights.shape
        check_nodes(document, ("scene", "body", "roughness"), rough.heights.size, needed)
    elif file.points is not None:
        check_nodes(document, ("points",), float(file.points) ** dimension, needed)
    arrays = read_boundary(document, file.scene.boundary, dimension, shape)
    name, given = next(iter(arrays.items()))
    check_nodes(document, ("scene", "boundary", name), given.size, needed)
    if body.is_half_space:
        for component in COMPONENTS[dimension][::-1]:
            held = component.key("displacement")
            if held not in arrays:
                remedy = f"or {body.holder} or a {held}, as nothing holds a half-space"
                arrays = balanced(document, arrays, component.key("traction"), remedy)
    elif body.is_incompressible and np.isfinite(arrays.get("normal_displacement", np.nan)).all():
        raise document.refused(
            ("scene", "boundary", "normal_displacement"),
            "not-a-number for at least one node of an incompressible slab, whose pressure no displacement tells",
        )
    return LoadedBodyInput(file, dict(arrays), rough, tuple(measured.values()))


def reduce_loaded_body(given: LoadedBodyInput) -> BoundaryValueProblem:
    """Dimensionless problem of what is prescribed."""
    file, prescribed, scales = given.file, given.prescribed, scales_of(given.file.scene)
    free, components = np.full(next(iter(prescribed.values())).shape, np.nan), COMPONENTS[file.scene.dimension]
    traction, displacement = (
        np.stack([prescribed.get(component.key(quantity), free) for component in components])
        for quantity in ("traction", "displacement")
    )
    return BoundaryValueProblem(
        scales.bodies[0],
        np.nan_to_num(traction, nan=0.0) / scales.modulus,
        displacement / scales.length,
        solver_options(file.numerics, able(["prescribed"])[0]),
        None if given.rough is None else given.rough.heights,
        file.slope_order or 0,
    )


@dataclass(frozen=True)
class Loaded:
    """Displacements and tractions of the surface, and what the next order would add to any displacement (L_x).

    Tractions count per area of the mean plane. The error of a flat body is 0.
    """

    deformed: Deformed
    next_order: float = 0.0


def solve_boundary_value_problem(problem: BoundaryValueProblem) -> Loaded:
    """Displacements and tractions of the surface.

    A flat body bears the tractions, displaced by what is prescribed less what its topography adds. Where displacements
    are prescribed, that repeats until it stands still to the residual of the problem, or the run is not converged.
    """
    response, given = problem.body.response(problem.traction.shape[1:]), problem.displacement
    if problem.heights is None:
        return Loaded(deform(response, problem.traction, given, problem.options))
    held, added = ~np.isnan(given), np.zeros_like(given)
    spent: list[tuple[int, int, float]] = []
    for _ in range(_MOST_ROUNDS):
        flat = deform(response, problem.traction, given - added, problem.options)
        spent.append((flat.n_iterations, flat.n_transforms, flat.wall_time))
        new, _ = _response(problem, problem.heights, flat.traction, problem.order)
        total = np.where(held, given, flat.displacement + new)
        enough = problem.options.residual * float(abs(total).max())
        is_still = not held.any() or float(abs(new - added)[held].max()) <= enough
        if is_still or flat.status != Status.ok:
            break
        added = new
    status = flat.status if is_still or flat.status != Status.ok else Status.too_steep
    iterations, transforms, seconds = (sum(of_rounds) for of_rounds in zip(*spent, strict=True))
    deformed = replace(
        flat,
        displacement=total,
        status=status,
        n_iterations=int(iterations),
        n_transforms=int(transforms),
        wall_time=float(seconds),
    )
    _, next_order = _response(problem, problem.heights, flat.traction, problem.order + 1)
    return Loaded(deformed, next_order)


def _response(problem: BoundaryValueProblem, heights: Reals, traction: Reals, order: int) -> tuple[Reals, float]:
    """What the topography adds to the displacement `[component, (y,) x]`, and the part of the highest order."""
    found = topography.respond(-traction[-1], heights, problem.body, order, traction[:-1])
    assert found.along is not None  # as tractions along the surface are given
    return np.stack([*found.along, found.u3]), found.highest_order


def loaded_body_dataset(given: LoadedBodyInput, problem: BoundaryValueProblem, loaded: Loaded) -> xr.Dataset:
    """Displacements and tractions of all components over `x`, or (y, x), and how they were reached, in SI units.

    Of a rough body also its topography, and what forms that. The attribute `validity` holds reasons to doubt it.
    """
    file, deformed, scene = given.file, loaded.deformed, given.file.scene
    unit, dims = Units.of(scene, 1.0), AXES[-scene.dimension :]
    found: dict[str, Any] = {}
    for kind, quantity, values in (
        ("height", "displacement", deformed.displacement),
        ("pressure", "traction", deformed.traction),
    ):
        for component, of_nodes in zip(COMPONENTS[scene.dimension], values, strict=True):
            long_name = f"{component.name} {quantity} of the body, {component.way}"
            found[component.key(quantity)] = unit.variable(dims, kind, long_name, of_nodes)
    if given.rough is not None:
        outwards = "topography of the body, peaks outwards"
        found["body_height"] = unit.variable(dims, "height", outwards, given.rough.heights)
        found |= unit.variables(dims, forming_tractions(given.rough, "body", problem.order))
        row = ROUGH_BODY_OBSERVABLES["next_order"]
        found["next_order"] = unit.variable((), row.unit, row.long_name, loaded.next_order)
    for name in ("status", "residual", "n_iterations", "n_transforms", "wall_time"):
        row, value = OBSERVABLES[name], getattr(deformed, name)
        told = replace(row, long_name=_TOLD.get(name, row.long_name))
        found[name] = unit.measure(name, told, np.int8(value) if name == "status" else value)
    attributes = {"Conventions": CONVENTIONS, "title": "loaded body", "scene": file.model_dump_json()}
    attributes |= {"solver": problem.options.solver} | modulus_attributes(scene)
    positions = unit.positions(deformed.traction.shape[1:], "the surface", scene.length)
    dataset = xr.Dataset(found, positions, attributes)
    refuse_nonfinite(dataset)
    sentences = implausible(scene)
    if given.rough is not None:
        sentences += [sentence for surface in given.measured for sentence in surface.doubts]
        sentences.append(doubt_of_bodies((given.rough,), problem.order, dataset, "normal_displacement"))
        dataset.attrs["processing"] = "\n".join(done for surface in given.measured for done in surface.done)
    dataset.attrs["validity"] = "\n".join(filter(None, sentences))
    return dataset
