"""Contact of bodies whose own surfaces are rough: two-step GFMD (thesis chapter 5) and its higher orders."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact import solution
from gfmd_numba.contact.problem import DeformableBody, Problem, given_surface
from gfmd_numba.contact.solution import Contact
from gfmd_numba.contact.surfaces import SummedSurface
from gfmd_numba.elasticity import map_topography, topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.map_topography import MapResponse
from gfmd_numba.elasticity.topography import Response
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.equilibrium import Equilibrium
from gfmd_numba.solvers.status import Status

STEEPEST = 0.030  # rms gradient that the thesis allows order 0 (5.3.4)
THICKNESS = 0.01  # change of a film's thickness, over the thickness, above which order 0 is doubted
_MOST_ROUNDS = 30


@dataclass(frozen=True)
class RoughBody:
    """A deformable body, its stress-free topography `[(y,) x]` of zero mean in L_x, and its part E*/E_i* of 1/E*."""

    elastic: ElasticBody
    heights: Reals
    share: float


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
    responses: tuple[Response, ...] | tuple[MapResponse, ...]
    expected_error: float


def solve(
    problem: Problem, bodies: tuple[RoughBody, ...], gradient: float, order: int, before: Equilibrium | None = None
) -> Pressed:
    """Press rough bodies together; the surface of the problem is the sum of all heights, in units of `gradient`.

    Flat bodies are pressed against walls moved by what their topographies add, until that stands still to the
    residual of the problem; where it does not, the run is not converged. Of maps only order 0 is known.
    """
    raised = np.zeros((1, *problem.surface.shape))
    for round_ in range(_MOST_ROUNDS):
        solved = solution.solve(problem, range(1), before, raised=raised)
        before = solved.equilibrium
        responses = _responses(solved, bodies, gradient, order)
        new = sum((response.u3 for response in responses), np.zeros(problem.surface.shape)) / gradient
        moved = float(abs(new - raised[0]).max())
        enough = problem.numerics.residual * float(abs(solved.equilibrium.displacement).max())
        if solved.equilibrium.status[0] != Status.ok or moved <= enough:
            break
        if round_ < _MOST_ROUNDS - 1:
            raised[0] = new
    else:
        failed = np.full_like(solved.equilibrium.status, Status.not_converged)
        solved = replace(solved, equilibrium=replace(solved.equilibrium, status=failed))
    following = _responses(solved, bodies, gradient, order + 1)
    return Pressed(solved, responses, sum(response.highest_order for response in following))


def solve_steps(problems: Sequence[Problem], realisation: int) -> Iterator[Pressed]:
    """Press the rough bodies of a problem together at each of several loads, each begun where the last one ended.

    Raises ValueError as `rough_body` does, and for surfaces that add up to nothing.
    """
    first = problems[0]
    assert isinstance(first.surface, SummedSurface)  # the promise of the reduction
    assert first.rough is not None
    drawn = first.surface.drawn(realisation)
    bodies = tuple(rough_body(each, drawn) for each in first.rough.bodies)
    together, gradient = given_surface(np.sum(drawn, axis=0), first.surface.rms_gradient)
    before = None
    for problem in problems:
        pressed = solve(replace(problem, surface=together), bodies, gradient, first.rough.order, before)
        yield pressed
        before = pressed.contact.equilibrium


def rough_body(body: DeformableBody, drawn: Sequence[Reals]) -> RoughBody:
    """A deformable body, the surfaces `[(y,) x]` having `drawn` these heights (L_x).

    Raises ValueError for a topography that reaches through it.
    """
    heights = np.zeros_like(drawn[0]) if body.part is None else drawn[body.part]
    height = body.elastic.aspect_ratio
    if height is not None and max(-float(heights.min()), float(heights.max())) >= height:
        span = f"from {heights.min():.3g} to {heights.max():.3g} L_x"
        raise ValueError(f"a topography {span} is not within the height {height:g} L_x of its body")
    return RoughBody(body.elastic, heights, body.share)


def _responses(
    solved: Contact, bodies: tuple[RoughBody, ...], gradient: float, order: int
) -> tuple[Response, ...] | tuple[MapResponse, ...]:
    """Response of each body; its unit of stress is its own modulus, in which the pressure is lower by its share."""
    pressure = solved.equilibrium.pressure[0] * gradient
    if pressure.ndim == 2:
        return tuple(
            map_topography.respond(body.share * pressure, body.heights, body.elastic, order) for body in bodies
        )
    return tuple(topography.respond(body.share * pressure, body.heights, body.elastic, order) for body in bodies)
