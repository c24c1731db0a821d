"""Contact of bodies whose own surfaces are rough: two-step GFMD (thesis chapter 5) and its higher orders."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays import Reals
from gfmd_numba.contact import solution
from gfmd_numba.contact.prescribed_load import Sliding
from gfmd_numba.contact.problem import Problem, given_surface
from gfmd_numba.contact.rough_body import RoughBody, rough_body
from gfmd_numba.contact.rounds import Rounds
from gfmd_numba.contact.slopes import Responses, SlopeCorrection, Slopes, in_plane
from gfmd_numba.contact.solution import Contact
from gfmd_numba.contact.surfaces import SummedSurface
from gfmd_numba.solvers.status import Status

Spent = tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], Reals]  # iterations, transforms and seconds of a round

_MOST_ROUNDS = 30
_MOST_ROUNDS_INCLINED = 100
_HALF = 0.5  # of the largest displacement, which the next order may add
_CLOSER, _PATIENCE = 0.9, 3  # part of the least change so far that is closer; rounds that may come no closer


@dataclass(frozen=True)
class Pressed:
    """The contact of the flat bodies that the rough ones amount to, and what the topography of each adds (L_x).

    `next_order` is what the next order would add to any displacement (L_x), and `correction` what slopes added to the
    contact.
    """

    contact: Contact
    responses: Responses
    next_order: float
    correction: SlopeCorrection

    @property
    def in_plane(self) -> Contact:
        """The contact with its tractions along the plane and its pressure out of it, as the load counts them.

        Those of `contact` itself are along the touching surface and its normal. Without tangential tractions the two
        pressures are the same.
        """
        found = self.contact.equilibrium
        if self.correction.pairing is None or found.tangential is None:
            return self.contact
        along, pressure = in_plane(self.contact, self.correction.pairing)
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

    Flat bodies are pressed against walls moved by what their slopes add, until that stands still to the residual of the
    problem; where it does not, they are too steep. With friction or a cohesive law each round begins where the
    last step ended, and slopes carry the nodes along the surface, too. Nodes may then be held elsewhere in each round,
    as they stick in one and not in the next: where rounds come no closer, nodes stay where the last one has held them.
    """
    start, dented = (None, 0.0) if before is None else (before.contact.equilibrium, before.contact.plastic_depth)
    slid = gradient * np.asarray(sliding or (0.0,) * len(problem.surface.shape))
    slopes = Slopes(problem, bodies, gradient, order, punch, slid)
    untouched = slopes.untouched()
    is_inclined = untouched.pairing is not None
    correction = untouched if before is None or not (slopes.rub or is_inclined) else before.correction
    since = untouched if problem.interface.cohesive is not None else correction  # from where slip counts
    again, nearest, patience = None, np.inf, _PATIENCE
    spent: list[Spent] = []
    rounds, most = Rounds(), _MOST_ROUNDS_INCLINED if is_inclined else _MOST_ROUNDS
    for round_ in range(most):
        way = (correction.shifted - since.shifted)[np.newaxis] if slopes.rub else None
        pressed = problem if problem.mean_pressure is None else problem.under(problem.mean_pressure + correction.lifted)
        raised = correction.raised[np.newaxis]
        solved = solution.solve(pressed, range(1), start, sliding, raised, way, dented, again)
        found = solved.equilibrium
        if not slopes.rub:
            start = found
        spent.append((found.n_iterations, found.n_transforms, found.wall_time))
        responses = slopes.responses(solved, correction.pairing, order)
        new = slopes.after(solved, responses, correction)
        moved = new.difference(correction, gradient, solved)
        enough = problem.numerics.residual * float(abs(found.displacement).max())
        if found.status[0] != Status.ok or moved <= enough:
            break
        patience -= moved > _CLOSER * nearest
        nearest = min(moved, nearest)
        if slopes.rub and problem.interface.friction is not None and patience <= 0:
            since, again = correction, found
        if round_ == most - 1:
            continue
        if problem.interface.friction is None:  # else they depend on how they were reached
            new = new.of_state(rounds.following(correction.state(gradient), new.state(gradient)), gradient)
        correction = new
    else:
        solved = _failed(solved)
    solved = _of_all_rounds(solved, spent)
    error = slopes.next_order(solved, responses, correction.pairing)
    moved_by_all = found.displacement if solved.deflected is None else found.displacement + solved.deflected[1]
    if solved.equilibrium.status[0] == Status.ok and error > _HALF * gradient * float(abs(moved_by_all).max()):
        solved = _failed(solved)
    return Pressed(solved, responses, error, correction)


def _of_all_rounds(contact: Contact, spent: list[Spent]) -> Contact:
    """The same with what all rounds have taken."""
    iterations, transforms, seconds = (np.sum(of_rounds, axis=0) for of_rounds in zip(*spent, strict=True))
    all_rounds = {"n_iterations": iterations, "n_transforms": transforms, "wall_time": seconds}
    return replace(contact, equilibrium=replace(contact.equilibrium, **all_rounds))


def _failed(contact: Contact) -> Contact:
    """The same as a contact of bodies that are too steep."""
    failed = np.full_like(contact.equilibrium.status, Status.too_steep)
    return replace(contact, equilibrium=replace(contact.equilibrium, status=failed))


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
