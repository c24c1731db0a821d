"""A body whose surface has prescribed tractions and displacements, without a punch.

The displacement of a rough body is that of the flat one, and a part that its topography adds.
"""

from dataclasses import dataclass, replace

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact.contact_input import BoundaryInput
from gfmd_numba.contact.rough_surfaces import RoughBody
from gfmd_numba.elasticity import topography
from gfmd_numba.solvers.boundary_value_problem import Deformed, deform
from gfmd_numba.solvers.status import Status, withdrawn

_MOST_ROUNDS = 30


@dataclass(frozen=True)
class BoundarySolution:
    """Displacements and tractions of the surface, and what the next order would add to any displacement (L_x).

    Tractions count per area of the mean plane. The error of a flat body is 0.
    """

    deformed: Deformed
    solver: str
    next_order: float = 0.0


def solve_boundary_values(given: BoundaryInput) -> BoundarySolution:
    """Displacements and tractions of the surface of a body to which all is prescribed, in L_x and E*.

    The flat body under the tractions is solved with the prescribed displacements less the displacement that the
    topography adds. If displacements are prescribed, this is repeated until the added displacement changes by less than
    the residual of the scene; otherwise the run is `too_steep`.
    """
    body, rough, order = given.scales.bodies[0], given.rough, given.file.slope_order
    traction, asked, options = given.reduced
    response = body.response(traction.shape[1:])
    if rough is None:
        return BoundarySolution(deform(response, traction, asked, options), options.solver)
    held, added = ~np.isnan(asked), np.zeros_like(asked)
    spent: list[tuple[int, int, float]] = []
    for _ in range(_MOST_ROUNDS):
        flat = deform(response, traction, asked - added, options)
        spent.append((flat.n_iterations, flat.n_transforms, flat.wall_time))
        new, _ = _response(rough, flat.traction, order)
        total = np.where(held, asked, flat.displacement + new)
        enough = options.residual * float(abs(total).max())
        is_still = not held.any() or float(abs(new - added)[held].max()) <= enough
        if is_still or flat.status != Status.ok:
            break
        added = new
    status = Status(int(withdrawn(flat.status, not is_still, Status.too_steep)))
    iterations, transforms, seconds = (sum(of_rounds) for of_rounds in zip(*spent, strict=True))
    deformed = replace(
        flat,
        displacement=total,
        status=status,
        n_iterations=int(iterations),
        n_transforms=int(transforms),
        wall_time=float(seconds),
    )
    _, next_order = _response(rough, flat.traction, order + 1)
    return BoundarySolution(deformed, options.solver, next_order)


def _response(rough: RoughBody, traction: Reals, order: int) -> tuple[Reals, float]:
    """What the topography adds to the displacement `[component, (y,) x]`, and the part of the highest order."""
    found = topography.respond(-traction[-1], rough.heights, rough.elastic, order, traction[:-1])
    assert found.along is not None  # as tractions along the surface are given
    return np.stack([*found.along, found.u3]), found.highest_order
