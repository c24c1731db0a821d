"""Contact of bodies whose own surfaces are rough: two-step GFMD (thesis chapter 5) and its higher orders."""

from dataclasses import dataclass, fields, replace

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact import solution
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.processes import processes_of
from gfmd_numba.contact.rough_surfaces import rough_body
from gfmd_numba.contact.slopes import Responses, SlopeCorrection, Slopes, in_plane
from gfmd_numba.contact.state import Contact, State, with_costs
from gfmd_numba.roughness.surfaces import SummedSurface, given_surface
from gfmd_numba.solvers import anderson
from gfmd_numba.solvers.equilibrium import Equilibrium
from gfmd_numba.solvers.status import Status, withdrawn

_MOST_ROUNDS = 30
_MOST_ROUNDS_INCLINED = 100
_PLAIN = 8  # rounds after which plain ones count as slow
_DEPTH = 5  # differences of rounds that are kept
_HALF = 0.5  # of the largest displacement, which the next order may add
_CLOSER, _PATIENCE = 0.9, 3  # part of the least change so far that is closer; rounds that may come no closer


@dataclass(frozen=True, kw_only=True)
class RoughContact(Contact):
    """The contact of the equivalent flat bodies, and the displacement that the topography of each body adds (L_x).

    `next_order` is the largest displacement that the next order would add (L_x), and `correction` are the corrections
    by slopes.
    """

    responses: Responses
    next_order: float
    correction: SlopeCorrection

    @property
    def in_plane(self) -> Contact:
        """As of any contact; its own tractions are along the touching surface and its normal.

        Without tangential tractions the two pressures are the same.
        """
        found = self.equilibrium
        if self.correction.pairing is None or found.tangential is None:
            return self
        along, pressure = in_plane(self, self.correction.pairing)
        sideways = replace(found.tangential, traction=along.reshape(found.tangential.traction.shape))
        turned = replace(found, pressure=pressure[np.newaxis], tangential=sideways)
        return replace(self, equilibrium=turned)


def begin(problem: Problem, realisation: int) -> State:
    """State of the surfaces of one realisation before the first step.

    Raises ValueError as `rough_body` does, and for surfaces that add up to nothing.
    """
    assert isinstance(problem.surface, SummedSurface)  # the promise of the reduction
    assert problem.rough is not None
    drawn, order = problem.surface.drawn(realisation), problem.rough.order
    bodies = tuple(rough_body(each, drawn, order) for each in problem.rough.bodies)
    of_bodies = {each.part for each in problem.rough.bodies}
    rigid = [heights for part, heights in enumerate(drawn) if part not in of_bodies and len(bodies) == 1]
    punch = np.sum(rigid, axis=0) if rigid else None
    together, gradient = given_surface(np.sum(drawn, axis=0), problem.surface.rms_gradient)
    slopes = Slopes(problem, bodies, gradient, order, punch)
    return State.untouched(together.heights[np.newaxis], (*processes_of(problem), slopes), form=problem.surface.form)


def solve(problem: Problem, state: State) -> RoughContact:
    """Press rough bodies together, from the state that the last step has left.

    In rounds, flat bodies are pressed against walls moved by the corrections of the last round (`slopes.py`), until the
    corrections change by less than the residual of the problem; if they do not, the bodies are too steep. With friction
    or a cohesive law each round begins where the last step ended, and slopes also shift the nodes along the surface. A
    node may then stick in one round and slip in the next. If rounds come no closer, nodes that stick keep the places of
    the last round.
    """
    slopes = next(each for each in state.processes if isinstance(each, Slopes))
    gradient, has_friction = slopes.gradient, problem.interface.friction is not None
    correction: SlopeCorrection = state.memory[slopes.name]
    began, nearest, patience = state, np.inf, _PATIENCE
    spent: list[Equilibrium] = []
    rounds, most = SlopeRounds(), _MOST_ROUNDS if correction.pairing is None else _MOST_ROUNDS_INCLINED
    for round_ in range(most):
        solved = solution.solve(problem, state)
        found = solved.equilibrium
        if not slopes.rub:
            state = state.begun_at(solved)
        spent.append(found)
        responses = slopes.responses(solved, correction.pairing, slopes.order)
        new = slopes.after(solved, responses, correction)
        moved = new.difference(correction, gradient, solved)
        enough = problem.numerics.residual * float(abs(found.displacement).max())
        if found.status[0] != Status.ok or moved <= enough:
            break
        patience -= moved > _CLOSER * nearest
        nearest = min(moved, nearest)
        if slopes.rub and has_friction and patience <= 0:
            state = state.begun_at(solved, repeats=True)
            new = replace(new, since=correction.shifted)
        if round_ == most - 1:
            continue
        if not has_friction:  # else they depend on how they were reached
            new = new.of_state(rounds.following(correction.state(gradient), new.state(gradient)), gradient)
        correction = new
        state = state.remembering(slopes.name, correction)
    else:
        solved = _too_steep(solved)
    found = with_costs(solved.equilibrium, spent)
    solved = replace(solved, equilibrium=found, before=began.remembering(slopes.name, correction))
    error = slopes.next_order(solved, responses, correction.pairing)
    out = solved.change.normal_offset
    moved_by_all = found.displacement if out is None else found.displacement + out
    if error > _HALF * gradient * float(abs(moved_by_all).max()):
        solved = _too_steep(solved)
    of_contact = {each.name: getattr(solved, each.name) for each in fields(solved) if each.init}
    return RoughContact(**of_contact, responses=responses, next_order=error, correction=correction)


def _too_steep(contact: Contact) -> Contact:
    """The same as a contact of bodies that are too steep."""
    failed = withdrawn(contact.equilibrium.status, True, Status.too_steep)
    return replace(contact, equilibrium=replace(contact.equilibrium, status=failed))


class SlopeRounds:
    """Rounds that map a state of some arrays to another one, until both are the same; slow rounds are extrapolated.

    Rounds that move away from a fixed point on one side are not extrapolated back to it: if a topography is too steep
    for its order, this fixed point means nothing. Rounds that jump to and fro have the fixed point between them, and
    are extrapolated.
    """

    def __init__(self) -> None:
        self._count, self._approaches = 0, True
        self._found: list[Reals] = []
        self._change: list[Reals] = []

    def following(self, given: tuple[Reals, ...], found: tuple[Reals, ...]) -> tuple[Reals, ...]:
        """State that the next round begins with, from what the last one was given and has found."""
        before, after = (np.concatenate([part.ravel() for part in state]) for state in (given, found))
        self._count += 1
        self._found = [*self._found[-_DEPTH:], after]
        self._change = [*self._change[-_DEPTH:], after - before]
        if self._count == _PLAIN:
            back = float(self._change[-1] @ self._change[-2]) < 0.0
            self._approaches = back or bool(abs(self._change[-1]).max() < abs(self._change[-3]).max())
        if self._count <= _PLAIN or not self._approaches:
            return found
        parts = np.split(anderson.mixed(self._found, self._change), np.cumsum([part.size for part in found])[:-1])
        return tuple(part.reshape(each.shape) for part, each in zip(parts, found, strict=True))
