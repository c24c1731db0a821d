"""The problems that a scene reduces to, one for each step of its loading, and their solution one after another."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from gfmd_numba.contact import branch, solution, two_step
from gfmd_numba.contact.contact_input import ContactInput
from gfmd_numba.contact.prescribed_load import Sliding, reduced_sliding, steps_of
from gfmd_numba.contact.problem import Effect, Problem
from gfmd_numba.contact.reduction import reduce
from gfmd_numba.contact.solution import Contact
from gfmd_numba.contact.two_step import Pressed


@dataclass(frozen=True)
class LoadPath:
    """Problems in g L_x and g E* for one realisation, each with the tangential displacement of its punch.

    `effects` says which effects of the scene are on, off, condensed or dropped.
    """

    problems: tuple[Problem, ...]
    sliding: tuple[Sliding, ...]
    realisation: int
    effects: tuple[Effect, ...]


def load_path(given: ContactInput) -> LoadPath:
    """Dimensionless problems of a scene at its own loading, then after each change of its path."""
    file, surfaces = given.file, given.surfaces
    steps = list(steps_of(file.scene, file.path))
    reduced = [
        reduce(scene, surfaces.surface, surfaces.rms_gradient, file.numerics, given.tractions, surfaces.rough)
        for scene, _ in steps
    ]
    problems = tuple(problem for problem, _ in reduced)
    sliding = tuple(reduced_sliding(sliding, file.scene, surfaces.rms_gradient) for _, sliding in steps)
    return LoadPath(problems, sliding, file.realisation, reduced[-1][1])


def solve_path(path: LoadPath) -> Iterator[Contact | Pressed]:
    """Equilibrium of each step, begun where the last one ended."""
    yield from solve_steps(path.problems, path.sliding, path.realisation)


def solve_steps(
    problems: Sequence[Problem], sliding: Sequence[Sliding], realisation: int
) -> Iterator[Contact | Pressed]:
    """Equilibrium at each of several loads of a realisation, begun where the last one ended."""
    if problems[0].rough is not None:
        yield from two_step.solve_steps(problems, sliding, realisation)
        return
    one = range(realisation, realisation + 1)
    last: tuple[Problem, Contact, Sliding] | None = None
    for problem, slid in zip(problems, sliding, strict=True):
        if len(problems) > 1 and branch.is_followed(problem):
            contact = branch.follow(problem, one, last, slid)
        else:
            before, dented = (None, 0.0) if last is None else (last[1].equilibrium, last[1].plastic_depth)
            contact = solution.solve(problem, one, before, slid, dented=dented)
        last = problem, contact, slid
        yield contact
