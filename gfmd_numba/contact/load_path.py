"""The problem that a scene with its loading path reduces to, and its solution: a fold over the steps of the path."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import islice

from gfmd_numba.contact import branch, solution, two_step
from gfmd_numba.contact.contact_input import ContactInput
from gfmd_numba.contact.prescribed_load import reduced_step, steps_of
from gfmd_numba.contact.problem import Effect, Problem
from gfmd_numba.contact.reduction import reduce
from gfmd_numba.contact.state import Contact, State
from gfmd_numba.contact.two_step import Pressed


def load_path(given: ContactInput) -> tuple[Problem, tuple[Effect, ...]]:
    """Dimensionless problem of a scene with the steps of its path, and what became of each of its effects."""
    file, surfaces, gradient = given.file, given.surfaces, given.surfaces.rms_gradient
    problem, effects = reduce(file.scene, surfaces.surface, gradient, file.numerics, given.tractions, surfaces.rough)
    steps = islice(steps_of(file.scene, file.path), 1, None)
    return replace(problem, path=tuple(reduced_step(*step, gradient) for step in steps)), effects


def solve_path(problem: Problem, realisation: int) -> Iterator[Contact | Pressed]:
    """Equilibrium of a realisation at each load of a path, begun in the state that the last step has left."""
    solve: Callable[[Problem, State], Contact | Pressed] = solution.solve
    if problem.rough is not None:
        state, solve = two_step.begin(problem, realisation), two_step.solve
    else:
        state = solution.begin(problem, range(realisation, realisation + 1))
        solve = branch.follow if problem.path and branch.is_followed(problem) else solution.solve
    for at_load in problem.at_each_load:
        solved = solve(at_load, state)
        yield solved
        state = solved.after
