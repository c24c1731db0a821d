"""Contact of bodies whose own surfaces are rough: two-step GFMD (thesis chapter 5) and its higher orders."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Reals
from gfmd_numba.contact import inclined, solution
from gfmd_numba.contact.evaluation import gap
from gfmd_numba.contact.inclined import Meeting, Moved
from gfmd_numba.contact.prescribed_load import Sliding
from gfmd_numba.contact.problem import DeformableBody, Problem, given_surface
from gfmd_numba.contact.rounds import Rounds
from gfmd_numba.contact.solution import Contact
from gfmd_numba.contact.surfaces import SummedSurface
from gfmd_numba.contact.tractions import Tractions
from gfmd_numba.elasticity import map_topography, topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.map_topography import MapResponse
from gfmd_numba.elasticity.topography import Response
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.iteration import tangential_shape
from gfmd_numba.solvers.status import Status

STEEPEST = 0.030  # rms gradient that the thesis allows order 0 (5.3.4)
THICKNESS = 0.01  # change of a film's thickness, over the thickness, above which order 0 is doubted
_MOST_ROUNDS = 30
_MOST_ROUNDS_INCLINED = 100
_CLOSER, _PATIENCE = 0.9, 3  # part of the least change so far that is closer; rounds that may come no closer

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
    """Largest height over the thickness in waves so long that the body is a film to them, q z_m <= 1; 0 if none are.

    Of a layered body the film is the topmost layer.
    """
    thickness = body.elastic.top.aspect_ratio
    if thickness is None:
        return 0.0
    waves = grid.coefficients(body.heights, body.heights.ndim)
    waves[grid.magnitudes(body.heights.shape) * thickness > 1.0] = 0.0
    return float(abs(grid.signal(waves, *body.heights.shape)).max()) / thickness


@dataclass(frozen=True)
class Pressed:
    """The contact of the flat bodies that the rough ones amount to, and what the topography of each adds (L_x).

    `expected_error` is what the next order would add to any displacement (L_x). Above order 0, `meeting` tells where
    inclined surfaces touch; None between level ones.
    """

    contact: Contact
    responses: Responses
    expected_error: float
    meeting: Meeting | None = None

    @property
    def in_plane(self) -> Contact:
        """The contact with its tractions along the plane and its pressure out of it, as the load counts them.

        Those of `contact` itself are along the touching surface and its normal. Without tangential tractions the two
        pressures are the same.
        """
        found = self.contact.equilibrium
        if self.meeting is None or found.tangential is None:
            return self.contact
        along, pressure = self.meeting.tractions(found.tangential.traction[0], found.pressure[0], 1)
        sideways = replace(found.tangential, traction=along.reshape(found.tangential.traction.shape))
        turned = replace(found, pressure=pressure[np.newaxis], tangential=sideways)
        return replace(self.contact, equilibrium=turned)


def solve(
    problem: Problem,
    bodies: tuple[RoughBody, ...],
    gradient: float,
    order: int,
    before: Pressed | None = None,
    sliding: Sequence[float] | None = None,
    punch: Reals | None = None,
) -> Pressed:
    """Press rough bodies together; the surface of the problem is the sum of all heights, in units of `gradient`.

    `punch` are the heights `[(y,) x]` of a rough rigid one (L_x).

    Flat bodies are pressed against walls moved by what their topographies add, until that stands still to the
    residual of the problem; where it does not, the run is not converged. With friction or a cohesive law each round
    begins where the last step ended, and the topography carries the nodes along the surface, too. Nodes may then be
    held elsewhere in each round, as they stick in one and not in the next: where rounds come no closer, nodes stay
    where the last one has held them. What rubs along inclined surfaces bears a part of the load (`lifted`).
    """
    start, dented = (None, 0.0) if before is None else (before.contact.equilibrium, before.contact.plastic_depth)
    rubs_along = problem.interface.couples and order > 0
    raised = np.zeros((1, *problem.surface.shape))
    uncontacted = np.zeros(tangential_shape(raised)[1:])
    if problem.tractions is not None and order > 0:  # what they alone do, the punch meets
        responses = _before_contact(problem.tractions, bodies, gradient, order)
        raised[0] = _raised(responses, problem, gradient)
        uncontacted = _shifted(responses, gradient) if rubs_along else uncontacted
    shifted = uncontacted
    if before is not None and before.meeting is not None:
        raised[0] = before.meeting.raised / gradient
        shifted = before.meeting.shifted.reshape(uncontacted.shape) / gradient
    elif before is not None and rubs_along:
        raised[0], shifted = _raised(before.responses, problem, gradient), _shifted(before.responses, gradient)
    since = uncontacted if problem.interface.cohesive is not None else shifted  # from where slip counts
    again, nearest, patience = None, np.inf, _PATIENCE
    is_inclined = punch is not None or len(bodies) > 1
    level = Meeting.before_contact(problem.surface.shape)
    meeting = None
    if is_inclined and order > 0:
        meeting = replace(level, shifted=gradient * uncontacted.reshape(level.shifted.shape))
        meeting = meeting if before is None else before.meeting
    spent: list[tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], Reals]] = []
    slid = gradient * np.asarray(sliding or (0.0,) * len(level.way))
    lifted = 0.0
    rounds, most = Rounds(), _MOST_ROUNDS if meeting is None else _MOST_ROUNDS_INCLINED
    for round_ in range(most):
        way = (shifted - since)[np.newaxis] if rubs_along else None
        pressed = problem if problem.mean_pressure is None else problem.under(problem.mean_pressure + lifted)
        solved = solution.solve(pressed, range(1), start, sliding, raised, way, dented, again)
        found = solved.equilibrium
        if not rubs_along:
            start = found
        spent.append((found.n_iterations, found.n_transforms, found.wall_time))
        responses = _responses(problem, solved, bodies, gradient, order, meeting)
        new = _raised(responses, problem, gradient)
        along = _shifted(responses, gradient) if rubs_along else shifted
        moved = max(float(abs(new - raised[0]).max()), float(abs(along - shifted).max()))
        if meeting is not None:
            surfaces = _moved(problem, solved, bodies, gradient, responses, meeting)
            met = inclined.meet(bodies, punch, slid, surfaces, meeting)
            if problem.interface.cohesive is not None:
                met = met.held_across(gradient * gap(solved)[0])
            new, moved = met.raised / gradient, met.difference(meeting) / gradient
        largest = float(abs(found.displacement).max())
        if meeting is not None and rubs_along:
            along, lifts = met.shifted.reshape(shifted.shape) / gradient, _lifted(solved, met)
            moved = max(moved, float(abs(along - shifted).max()))
            if problem.mean_pressure is not None:
                moved = max(moved, abs(lifts - lifted) / float(abs(found.pressure).mean()) * largest)
            lifted = lifts
        if found.status[0] != Status.ok or moved <= problem.numerics.residual * largest:
            break
        patience -= moved > _CLOSER * nearest
        nearest = min(moved, nearest)
        if rubs_along and problem.interface.friction is not None and patience <= 0:
            since, again = shifted, found
        if round_ < most - 1:
            state = new, along
            if problem.interface.friction is None and meeting is None:  # else they depend on how they were reached
                state = rounds.following((raised[0], shifted), state)
            raised[0], shifted = state
            meeting = None if meeting is None else met
    else:
        failed = np.full_like(solved.equilibrium.status, Status.not_converged)
        solved = replace(solved, equilibrium=replace(solved.equilibrium, status=failed))
    iterations, transforms, seconds = (np.sum(of_rounds, axis=0) for of_rounds in zip(*spent, strict=True))
    all_rounds = {"n_iterations": iterations, "n_transforms": transforms, "wall_time": seconds}
    solved = replace(solved, equilibrium=replace(solved.equilibrium, **all_rounds))
    following = _responses(problem, solved, bodies, gradient, order + 1, meeting)
    error = float(sum(response.highest_order for response in following))
    if meeting is not None and problem.interface.friction is not None:
        error += _off_bound(solved, bodies, gradient, meeting)
    if is_inclined and order == 0:
        flat = _moved(problem, solved, bodies, gradient, responses, level)
        met = inclined.meet(bodies, punch, slid, flat, level)
        error += inclined.change(flat, _moved(problem, solved, bodies, gradient, responses, met), met)
    return Pressed(solved, responses, error, meeting)


def _raised(responses: Responses, problem: Problem, gradient: float) -> Reals:
    """How far topographies carry the surfaces towards each other `[(y,) x]`, in g L_x."""
    return np.asarray(sum((response.u3 for response in responses), np.zeros(problem.surface.shape)) / gradient)


def _shifted(responses: Responses, gradient: float) -> Reals:
    """How far the topography carries the nodes of its surface along it `[x]`, on maps `[component, y, x]`, in g L_x."""
    response = responses[0]  # of the lower body: what meets it does not move on its own, or `meet` tells
    along = response.u1 if isinstance(response, Response) else response.along
    assert along is not None  # beside friction
    return along / gradient


def _lifted(solved: Contact, met: Meeting) -> float:
    """Mean of what tangential tractions along inclined surfaces bear of the load (g E*)."""
    found = solved.equilibrium
    assert found.tangential is not None  # beside what rubs
    _, pressure = met.tractions(found.tangential.traction[0], found.pressure[0], 1)
    return float(found.pressure[0].mean() - pressure.mean())


def _off_bound(solved: Contact, bodies: tuple[RoughBody, ...], gradient: float, met: Meeting) -> float:
    """Most that nodes of a map which slip across the slope move by what they bear more than the plane shows (L_x).

    Coulomb's law compares forces on the surface. Those along the plane are bounded by the same ratio if they are along
    the slope, by a ratio larger by half the square of the slope if they are across it, which no order knows.
    """
    found = solved.equilibrium
    assert found.tangential is not None  # beside friction
    traction = found.tangential.traction[0]
    if traction.ndim == 1:  # a profile knows no direction across
        return 0.0
    slipped = np.any(found.tangential.slip[0] != 0.0, axis=0)
    along, steepness = np.sum(traction * met.slope, axis=0), np.sum(met.slope**2, axis=0)
    size = np.sum(traction**2, axis=0)
    ratio = np.sqrt((1.0 + steepness) / (1.0 + np.divide(along**2, size, out=np.zeros_like(size), where=size > 0.0)))
    more = gradient * traction * np.where(slipped, ratio - 1.0, 0.0)
    none = np.zeros(more.shape[1:])
    each = (b.elastic.coupled_stiffness_of_map(none.shape).deflection(b.share * more, none) for b in bodies)
    return float(sum(max(float(abs(part).max()) for part in moved) for moved in each))


def _moved(
    problem: Problem,
    solved: Contact,
    bodies: tuple[RoughBody, ...],
    gradient: float,
    responses: Responses,
    meeting: Meeting,
) -> list[Moved]:
    """How the surface of each body has moved (L_x)."""
    every: Sequence[Response | MapResponse] = responses
    found = []
    for body, response in zip(bodies, every, strict=False):
        level, tilted = (tractions_on(body, problem, solved, gradient, met) for met in (None, meeting))
        found.append(inclined.moved(body.elastic, level, tilted, response))
    return found


def tractions_on(
    body: RoughBody, problem: Problem, solved: Contact, gradient: float, meeting: Meeting | None = None
) -> tuple[Reals | None, Reals]:
    """Traction along the surface, on maps `[component, y, x]`, and pressure `[(y,) x]` on a body, in its own E*.

    None stands for no traction along the surface. Prescribed tractions act on the lower body. On inclined surfaces,
    of which `meeting` tells, the tractions are those along the plane and out of it.
    """
    found, tangential = solved.equilibrium.pressure[0], solved.equilibrium.tangential
    pressure = gradient * found.astype(np.float64)  # the response is computed in double precision
    along = None if tangential is None else gradient * tangential.traction[0].astype(np.float64)
    if meeting is None:
        along = None if along is None else body.side * along
    else:
        along, pressure = meeting.tractions(along, pressure, body.side)
        along = along[0] if pressure.ndim == 1 else along
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
    bodies = tuple(rough_body(each, drawn, first.rough.order) for each in first.rough.bodies)
    of_bodies = {each.part for each in first.rough.bodies}
    punch = next((heights for part, heights in enumerate(drawn) if part not in of_bodies), None)
    together, gradient = given_surface(np.sum(drawn, axis=0), first.surface.rms_gradient)
    before: Pressed | None = None
    for problem, slid in zip(problems, sliding, strict=True):
        together_now = replace(problem, surface=together)
        before = solve(together_now, bodies, gradient, first.rough.order, before, slid, punch)
        yield before


def rough_body(body: DeformableBody, drawn: Sequence[Reals], order: int) -> RoughBody:
    """A deformable body, the surfaces `[(y,) x]` having `drawn` these heights (L_x).

    Raises ValueError for a topography that reaches through it, or at an order above 0 through its topmost layer.
    """
    heights = np.zeros_like(drawn[0]) if body.part is None else drawn[body.part]
    if allowed := allowed_topography(heights, body.elastic, order):
        span = f"from {heights.min():.3g} to {heights.max():.3g} L_x"
        raise ValueError(f"a topography {span} in place of {allowed}")
    return RoughBody(body.elastic, heights, body.share, body.side)


def allowed_topography(heights: Reals, body: ElasticBody, order: int) -> str:
    """What is allowed in place of heights `[(y,) x]` that a body has no room for; nothing if it has."""
    lowest, highest = float(heights.min()), float(heights.max())
    if body.aspect_ratio is not None and max(-lowest, highest) >= body.aspect_ratio:
        return f"one within the height of the body, {body.aspect_ratio:g} L_x, of its mean plane"
    if order > 0 and body.stack is not None and -lowest >= -body.top.base:
        return (
            f"valleys above the lower side of the topmost layer, {body.top.base:g} L_x, or a numerics.topography_order "
            "of 0, as interfaces are flat at higher orders"
        )
    return ""


def _responses(
    problem: Problem,
    solved: Contact,
    bodies: tuple[RoughBody, ...],
    gradient: float,
    order: int,
    meeting: Meeting | None,
) -> Responses:
    """Response of each body."""
    borne = [(body, *tractions_on(body, problem, solved, gradient, meeting)) for body in bodies]
    if len(problem.surface.shape) == 2:
        return tuple(map_topography.respond(p, body.heights, body.elastic, order, along) for body, along, p in borne)
    return tuple(topography.respond(p, body.heights, body.elastic, order, along) for body, along, p in borne)


def _before_contact(tractions: Tractions, bodies: tuple[RoughBody, ...], gradient: float, order: int) -> Responses:
    """Response of each body to prescribed tractions alone, which act on the lower one."""
    borne = [(body, gradient * body.share if body.side > 0 else 0.0) for body in bodies]
    t, p = tractions.tangential, -tractions.normal
    if p.ndim == 2:
        return tuple(map_topography.respond(of * p, body.heights, body.elastic, order, of * t) for body, of in borne)
    return tuple(topography.respond(of * p, body.heights, body.elastic, order, of * t) for body, of in borne)
