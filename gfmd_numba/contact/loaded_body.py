"""A body that is loaded and displaced without a punch: its problem and its solution.

A rough body is the flat one, and what its topography adds.
"""

from dataclasses import dataclass, replace

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.contact_input import LoadedBodyInput
from gfmd_numba.contact.reduction import solver_options
from gfmd_numba.elasticity import topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.scene import COMPONENTS
from gfmd_numba.solvers.boundary_value_problem import Deformed, deform
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options, able

_MOST_ROUNDS = 30


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


def reduce_loaded_body(given: LoadedBodyInput) -> BoundaryValueProblem:
    """Dimensionless problem of what is prescribed."""
    file, prescribed, scales = given.file, given.prescribed, given.scales
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
        file.slope_order,
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
