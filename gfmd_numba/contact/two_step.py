"""Contact of bodies whose own surfaces are rough: two-step GFMD (thesis chapter 5) and its higher orders."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Reals
from gfmd_numba.contact import solution
from gfmd_numba.contact.prescribed_load import Sliding
from gfmd_numba.contact.problem import DeformableBody, Problem, given_surface
from gfmd_numba.contact.solution import Contact
from gfmd_numba.contact.surfaces import SummedSurface
from gfmd_numba.elasticity import map_topography, topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.map_topography import MapResponse
from gfmd_numba.elasticity.topography import Response
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.status import Status

STEEPEST = 0.030  # rms gradient that the thesis allows order 0 (5.3.4)
THICKNESS = 0.01  # change of a film's thickness, over the thickness, above which order 0 is doubted
_MOST_ROUNDS = 30

Responses = tuple[Response, ...] | tuple[MapResponse, ...]


@dataclass(frozen=True)
class RoughBody:
    """A deformable body, its stress-free topography `[(y,) x]` of zero mean in L_x, and its part E*/E_i* of 1/E*.

    `side` is -1 for the upper one of two, on which the lower one pulls the opposite way.
    """

    elastic: ElasticBody
    heights: Reals
    share: float
    side: int = 1


def change_of_thickness(body: RoughBody) -> float:
    """Largest height over the thickness in waves so long that the body is a film to them, q z_m <= 1; 0 if none are."""
    if body.elastic.aspect_ratio is None:
        return 0.0
    waves = grid.coefficients(body.heights, body.heights.ndim)
    waves[grid.magnitudes(body.heights.shape) * body.elastic.aspect_ratio > 1.0] = 0.0
    return float(abs(grid.signal(waves, *body.heights.shape)).max()) / body.elastic.aspect_ratio


@dataclass(frozen=True)
class Pressed:
    """The contact of the flat bodies that the rough ones amount to, and what the topography of each adds (L_x).

    `expected_error` is what the next order would add to any displacement (L_x).
    """

    contact: Contact
    responses: Responses
    expected_error: float


def solve(
    problem: Problem,
    bodies: tuple[RoughBody, ...],
    gradient: float,
    order: int,
    before: Pressed | None = None,
    sliding: Sequence[float] | None = None,
) -> Pressed:
    """Press rough bodies together; the surface of the problem is the sum of all heights, in units of `gradient`.

    Flat bodies are pressed against walls moved by what their topographies add, until that stands still to the
    residual of the problem; where it does not, the run is not converged. With friction each round begins where the last
    step ended, and a profile's topography carries its nodes along x, too; on maps only order 0 is then known.
    """
    start = None if before is None else before.contact.equilibrium
    rubs_along = problem.interface.couples and order > 0
    raised, since = np.zeros((1, *problem.surface.shape)), np.zeros(problem.surface.shape[-1:])
    if before is not None and rubs_along:
        raised[0], since = _raised(before.responses, problem, gradient), _shifted(before.responses, gradient)
    shifted = since
    spent: list[tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], Reals]] = []
    for round_ in range(_MOST_ROUNDS):
        way = (shifted - since)[np.newaxis] if rubs_along else None
        solved = solution.solve(problem, range(1), start, sliding, raised, way)
        found = solved.equilibrium
        if not rubs_along:
            start = found
        spent.append((found.n_iterations, found.n_transforms, found.wall_time))
        responses = _responses(problem, solved, bodies, gradient, order)
        new = _raised(responses, problem, gradient)
        along = _shifted(responses, gradient) if rubs_along else shifted
        moved = max(float(abs(new - raised[0]).max()), float(abs(along - shifted).max()))
        enough = problem.numerics.residual * float(abs(solved.equilibrium.displacement).max())
        if solved.equilibrium.status[0] != Status.ok or moved <= enough:
            break
        if round_ < _MOST_ROUNDS - 1:
            raised[0], shifted = new, along
    else:
        failed = np.full_like(solved.equilibrium.status, Status.not_converged)
        solved = replace(solved, equilibrium=replace(solved.equilibrium, status=failed))
    iterations, transforms, seconds = (np.sum(of_rounds, axis=0) for of_rounds in zip(*spent, strict=True))
    all_rounds = {"n_iterations": iterations, "n_transforms": transforms, "wall_time": seconds}
    solved = replace(solved, equilibrium=replace(solved.equilibrium, **all_rounds))
    following = _responses(problem, solved, bodies, gradient, order + 1)
    return Pressed(solved, responses, sum(response.highest_order for response in following))


def _raised(responses: Responses, problem: Problem, gradient: float) -> Reals:
    """How far topographies carry the surfaces towards each other `[(y,) x]`, in g L_x."""
    return np.asarray(sum((response.u3 for response in responses), np.zeros(problem.surface.shape)) / gradient)


def _shifted(responses: Responses, gradient: float) -> Reals:
    """How far the topography of a profile carries the nodes of its surface along x `[x]`, in g L_x."""
    (response,) = responses  # of one body: between two, friction is known at order 0 alone
    assert isinstance(response, Response)
    return response.u1 / gradient


def tractions_on(body: RoughBody, problem: Problem, solved: Contact, gradient: float) -> tuple[Reals | None, Reals]:
    """Traction along the surface, on maps `[component, y, x]`, and pressure `[(y,) x]` on a body, in its own E*.

    None stands for no traction along the surface. Prescribed tractions act on the lower body.
    """
    pressure, tangential = solved.equilibrium.pressure[0] * gradient, solved.equilibrium.tangential
    along = None if tangential is None else body.side * gradient * tangential.traction[0]
    if problem.tractions is not None and body.side > 0:
        pressure = pressure - gradient * problem.tractions.normal
        along = gradient * problem.tractions.tangential + (0.0 if along is None else along)
    return None if along is None else body.share * along, body.share * pressure


def solve_steps(problems: Sequence[Problem], sliding: Sequence[Sliding], realisation: int) -> Iterator[Pressed]:
    """Press the rough bodies of a problem together at each of several loads, each begun where the last one ended.

    Raises ValueError as `rough_body` does, and for surfaces that add up to nothing.
    """
    first = problems[0]
    assert isinstance(first.surface, SummedSurface)  # the promise of the reduction
    assert first.rough is not None
    drawn = first.surface.drawn(realisation)
    bodies = tuple(rough_body(each, drawn) for each in first.rough.bodies)
    together, gradient = given_surface(np.sum(drawn, axis=0), first.surface.rms_gradient)
    before: Pressed | None = None
    for problem, slid in zip(problems, sliding, strict=True):
        before = solve(replace(problem, surface=together), bodies, gradient, first.rough.order, before, slid)
        yield before


def rough_body(body: DeformableBody, drawn: Sequence[Reals]) -> RoughBody:
    """A deformable body, the surfaces `[(y,) x]` having `drawn` these heights (L_x).

    Raises ValueError for a topography that reaches through it.
    """
    heights = np.zeros_like(drawn[0]) if body.part is None else drawn[body.part]
    height = body.elastic.aspect_ratio
    if height is not None and max(-float(heights.min()), float(heights.max())) >= height:
        span = f"from {heights.min():.3g} to {heights.max():.3g} L_x"
        raise ValueError(f"a topography {span} is not within the height {height:g} L_x of its body")
    return RoughBody(body.elastic, heights, body.share, body.side)


def _responses(
    problem: Problem, solved: Contact, bodies: tuple[RoughBody, ...], gradient: float, order: int
) -> Responses:
    """Response of each body."""
    borne = [(body, *tractions_on(body, problem, solved, gradient)) for body in bodies]
    if len(problem.surface.shape) == 2:
        return tuple(map_topography.respond(p, body.heights, body.elastic, order, along) for body, along, p in borne)
    return tuple(topography.respond(p, body.heights, body.elastic, order, along) for body, along, p in borne)
