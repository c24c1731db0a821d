"""A body that is loaded and displaced without a punch: what its file prescribes, as a dimensionless problem."""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.bodies import contact_modulus, elastic_body
from gfmd_numba.contact.contact_input import check_rules, with_measured
from gfmd_numba.contact.reduction import solver_options
from gfmd_numba.contact.refusal import check_combination
from gfmd_numba.contact.rough_body import RoughBody
from gfmd_numba.contact.rough_surfaces import MeasuredSurfaces, check_drawn, ensemble_of_rough_bodies
from gfmd_numba.contact.tractions import balanced, read_boundary
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.roughness.measured import MeasuredSurface
from gfmd_numba.scene import COMPONENTS, BoundaryFile, Document
from gfmd_numba.scene.document import Location
from gfmd_numba.scene.memory import arrays_of_a_loaded_body, beyond_memory
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.table import able

Prescribed = dict[str, Reals]  # by the key of the boundary `[(ny,) nx]` in Pa and m, or E* and L_x


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
    scene, measured = with_measured(file.scene, document)
    file = file.model_copy(update={"scene": scene})
    check_rules(file.check_period, document, ())
    check_combination(document, file.scene, file.numerics)
    rough = _rough_body(file, measured, document)
    body, dimension = file.scene.body, file.scene.dimension
    shape = None if file.points is None else (file.points,) * dimension
    if rough is not None:
        shape = rough.heights.shape
        _check_memory(document, ("scene", "body", "roughness"), shape, file)
    elif shape is not None:
        _check_memory(document, ("points",), shape, file)
    arrays = read_boundary(document, file.scene.boundary, dimension, shape)
    name, given = next(iter(arrays.items()))
    _check_memory(document, ("scene", "boundary", name), given.shape, file)
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
    return LoadedBodyInput(file, dict(arrays), rough, tuple(measured.values()))


def reduce_loaded_body(given: LoadedBodyInput) -> BoundaryValueProblem:
    """Dimensionless problem of what is prescribed."""
    file, prescribed = given.file, given.prescribed
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
        None if given.rough is None else given.rough.heights,
        file.slope_order or 0,
    )


def _rough_body(file: BoundaryFile, measured: MeasuredSurfaces, document: Document) -> RoughBody | None:
    """The body with its topography, None for a flat one; raises InputError for heights that cannot be used."""
    scene = file.scene
    if not scene.follows_topography:
        return None
    order = file.numerics.slope_order(scene)
    ensemble = ensemble_of_rough_bodies(scene, file.discretisation, file.seed, order, measured, document)
    (body,) = check_drawn(scene, *ensemble, file.realisation, document)
    return body


def _check_memory(document: Document, place: Location, shape: tuple[int, ...], file: BoundaryFile) -> None:
    arrays = arrays_of_a_loaded_body(len(shape), file.slope_order)
    if allowed := beyond_memory(float(np.prod(shape, dtype=float)), arrays):
        raise document.error(place, document.value(place), allowed)
