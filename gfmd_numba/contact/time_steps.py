"""Steps of a path that take time, divided until halving all divisions changes next to nothing.

The load and the sliding are linear in time over a step of the path. Divisions grow with the time since its beginning,
as what a body remembers decays: they are equal in the logarithm of that time and the shortest relaxation time. Where
the punch passes over the body, all are alike.
"""

from dataclasses import replace
from math import expm1, inf, log1p

from gfmd_numba.contact import solution
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.relaxation import tractions_of
from gfmd_numba.contact.state import Contact, State, relative_difference, with_costs
from gfmd_numba.solvers.equilibrium import Equilibrium
from gfmd_numba.solvers.status import Status

HALVINGS = 10  # at most
_EVENLY = 1e-9  # growth of divisions over a step that are as good as equal


def follow(problem: Problem, state: State, tolerance: float) -> Contact:
    """Equilibrium at the end of a step, reached from a state with an error by its divisions of at most a tolerance.

    Where halving all divisions changes r times less than halving them before did, r - 1 times the error is left of a
    change. It is taken as 1 to 3 times, as errors fall with the square of the divisions unless something happens all at
    once. `time_error` adds the error to that of the steps before. After the most halvings it may be above the
    tolerance.
    """
    before = 0.0 if state.last is None else state.last.time_error
    found, spent = _divided(problem, state, 1)
    change, error = 0.0, 0.0
    for halvings in range(1, HALVINGS + 1) if problem.duration > 0.0 else ():
        if found.equilibrium.status[0] != Status.ok:
            break
        coarse, (found, more) = found, _divided(problem, state, 2**halvings)
        spent += more
        if found.equilibrium.status[0] != Status.ok:
            break
        last, change = change, difference(coarse, found, state)
        error = change / (min(max(last / change, 2.0), 4.0) - 1.0) if change > 0.0 else 0.0
        if error <= tolerance:
            break
    return replace(found, equilibrium=with_costs(found.equilibrium, spent), time_error=before + error)


def _divided(problem: Problem, state: State, divisions: int) -> tuple[Contact, list[Equilibrium]]:
    """The contact that a step ends with, in so many divisions, or the first that is not ok, and all before it."""
    start = state.step_before(problem.step)
    series, gone, least = problem.relaxation, 0.0, inf
    spent: list[Equilibrium] = []
    assert series is not None
    slides = problem.passing is not None and start.sliding != problem.step.sliding
    growth = _EVENLY if slides else log1p(problem.duration / min(series.times))
    for division in range(1, divisions + 1):
        share = 1.0 if division == divisions else expm1(growth * division / divisions) / expm1(growth)
        step = start.towards(problem.step, share)._replace(duration=(share - gone) * problem.duration)
        solved = solution.solve(problem.under(step), state)
        spent.append(solved.equilibrium)
        if solved.equilibrium.status[0] != Status.ok:
            break
        state, gone, least = solved.after, share, min(least, float(solved.equilibrium.pressure.mean()))
    return replace(solved, least_pressure=least), spent


def difference(coarse: Contact, fine: Contact, before: State) -> float:
    """Mean difference of the tractions of two contacts over their mean, or that of the displacements if it is larger.

    Tractions count in those `before` the step if these are larger, as it may end without contact.
    """
    earlier = 0.0 if before.last is None else float(abs(tractions_of(before.last)).sum())
    moved = (each.after.memory["springs"].stretch[0] for each in (coarse, fine))
    return max(relative_difference(tractions_of(coarse), tractions_of(fine), earlier), relative_difference(*moved))
