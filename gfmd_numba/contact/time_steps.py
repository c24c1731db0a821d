"""Steps of a path that take time or wear the punch, divided until halving all divisions changes next to nothing.

Load and sliding are linear in time over a step of the path. Divisions grow with the time t since the beginning of the
step, as the memory of a body decays: they are equal in ln(1 + t / tau), with the shortest relaxation time tau. If the
punch passes over the body or wears, all divisions are equal.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import expm1, inf, log1p, nan

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact import solution
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import Contact, LoadStep, State, relative_difference, with_costs
from gfmd_numba.contact.viscoelasticity import tractions_of
from gfmd_numba.interface import vector_slip
from gfmd_numba.solvers.equilibrium import Equilibrium
from gfmd_numba.solvers.status import Status

HALVINGS = 10  # at most
_SLOWEST, _FASTEST = 1.15, 2.5  # how many times smaller the next change is expected to be, at least and at most
_EVENLY = 1e-9  # growth of divisions over a step that are as good as equal


def follow(problem: Problem, state: State, tolerance: float) -> Contact:
    """Equilibrium at the end of a step, reached from a state with an error by its divisions of at most a tolerance.

    `time_error` adds the error to that of the steps before; not-a-number where a division fails. After the most
    halvings it may be above the tolerance.
    """
    before = 0.0 if state.last is None else state.last.time_error
    found, spent = _divided(problem, state, 1)
    changes: list[float] = []
    error = 0.0
    divided = is_divided(problem, None if state.last is None else state.last.step, problem.step)
    for halvings in range(1, HALVINGS + 1) if divided else ():
        if found.equilibrium.status[0] != Status.ok:
            error = nan
            break
        coarse, (found, more) = found, _divided(problem, state, 2**halvings)
        spent += more
        if found.equilibrium.status[0] != Status.ok:
            error = nan
            break
        changes.append(difference(coarse, found))
        error = remaining_error(changes)
        if error <= tolerance:
            break
    return replace(found, equilibrium=with_costs(found.equilibrium, spent), time_error=before + error)


def is_divided(problem: Problem, before: LoadStep | None, step: LoadStep) -> bool:
    """Whether a step after another one, None: the first, takes time or wears the punch."""
    if step.duration > 0.0 or before is None or problem.wear_rate is None:
        return step.duration > 0.0
    return problem.interface.couples or step.sliding != before.sliding  # any slip wears


def remaining_error(changes: Sequence[float]) -> float:
    """Error left after divisions have been halved repeatedly, from the changes by each halving.

    If each change is smaller than the one before by the factor r, the error left is 1 / (r - 1) of the last change.
    With short divisions the error falls as one over the square of their number, r = 4, less surely if nodes touch down
    or leave, and hardly if relaxation times are not resolved. The smaller of the last two r counts. A change below a
    quarter of the last one is taken as a quarter, as it is chance.
    """
    last = max(changes[-1], 0.25 * max(changes[-2:-1], default=0.0))
    shrink = [before / after if after > 0.0 else _FASTEST for before, after in pairwise(changes[-3:])]
    return last / (min(max(min(shrink, default=0.0), _SLOWEST), _FASTEST) - 1.0)


def _divided(problem: Problem, state: State, divisions: int) -> tuple[Contact, list[Equilibrium]]:
    """The contact that a step ends with, in so many divisions, or the first that is not ok, and all before it."""
    start = state.step_before(problem.step)
    series, gone, least = problem.relaxation, 0.0, inf
    spent: list[Equilibrium] = []
    slip_path: Reals | None = None
    slides = (problem.passing is not None or problem.wear_rate is not None) and start.sliding != problem.step.sliding
    growth = _EVENLY if slides or series is None else log1p(problem.duration / min(series.times))
    for division in range(1, divisions + 1):
        fraction = 1.0 if division == divisions else expm1(growth * division / divisions) / expm1(growth)
        step = start.towards(problem.step, fraction)._replace(duration=(fraction - gone) * problem.duration)
        solved = solution.solve(problem.under(step), state)
        spent.append(solved.equilibrium)
        if solved.equilibrium.tangential is not None:
            way = vector_slip.length(np.moveaxis(solved.equilibrium.tangential.slip, 1, 0))
            slip_path = way if slip_path is None else slip_path + way
        if solved.equilibrium.status[0] != Status.ok:
            break
        state, gone, least = solved.after, fraction, min(least, float(solved.equilibrium.pressure.mean()))
    return replace(solved, least_pressure=least, slip_path=slip_path), spent


def difference(coarse: Contact, fine: Contact) -> float:
    """Largest relative difference of two contacts: of tractions, displacements, and what has worn.

    It is a mean over the nodes, relative to the largest mean so far; for the worn depth relative to its own mean. The
    error of a traction remains when the traction falls again. So it is relative to the largest traction so far, which
    bodies that creep remember.
    """
    springs = fine.after.memory.get("springs")
    most = *((0.0, 0.0) if springs is None else springs.largest), 0.0
    return max(map(relative_difference, _compared(coarse), _compared(fine), most))


def _compared(contact: Contact) -> list[Reals]:
    """Tractions, displacements and, of a punch that wears, what has worn."""
    memory = contact.after.memory
    moved = memory["springs"].stretch[0] if "springs" in memory else contact.equilibrium.displacement
    return [tractions_of(contact), moved, *([memory["worn"]] if "worn" in memory else [])]
