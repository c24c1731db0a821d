"""The problems that a scene reduces to, one for each step of its loading, and their solution one after another."""

from collections.abc import Iterator
from dataclasses import dataclass

from gfmd_numba.contact import branch, solution, two_step
from gfmd_numba.contact.contact_input import ContactInput
from gfmd_numba.contact.prescribed_load import sliding_along_y, steps_of
from gfmd_numba.contact.problem import Effect, Problem
from gfmd_numba.contact.reduction import reduce
from gfmd_numba.contact.solution import Contact
from gfmd_numba.contact.two_step import Pressed, RoughBody
from gfmd_numba.scene.reduced_units import rounded


@dataclass(frozen=True)
class RoughBodies:
    """Rough elastic bodies, the rms gradient g that their problem is in units of, and the order in the slope."""

    bodies: tuple[RoughBody, ...]
    rms_gradient: float
    order: int


@dataclass(frozen=True)
class LoadPath:
    """Problems in g L_x and g E* for one realisation, each with the tangential displacement of its punch.

    On maps that is a pair, along x and along y.
    `effects` tells what became of the effects of the scene.
    """

    problems: tuple[Problem, ...]
    sliding: tuple[float | tuple[float, float], ...]
    realisation: int
    effects: tuple[Effect, ...]
    rough: RoughBodies | None = None


def load_path(given: ContactInput) -> LoadPath:
    """Dimensionless problems of a scene at its own loading, then after each change of its path."""
    file, surfaces = given.file, given.surfaces
    period = file.scene.length or 1.0
    steps = list(steps_of(file))
    reduced = [
        reduce(scene, surfaces.surface, surfaces.rms_gradient, file.numerics, given.tractions) for scene, _ in steps
    ]
    rough = None
    if surfaces.bodies is not None:
        rough = RoughBodies(surfaces.bodies, surfaces.rms_gradient, file.numerics.slope_order)
    problems = tuple(problem for problem, _ in reduced)
    along_x, along_y = (
        [rounded(rounded(way / period) / surfaces.rms_gradient) for way in ways]
        for ways in ((sliding for _, sliding in steps), sliding_along_y(file))
    )
    sliding = tuple(along_x) if file.scene.dimension == 1 else tuple(zip(along_x, along_y, strict=True))
    return LoadPath(problems, sliding, file.realisation, reduced[-1][1], rough)


def solve_path(path: LoadPath) -> Iterator[Contact | Pressed]:
    """Equilibrium of each step, begun where the last one ended."""
    one = range(path.realisation, path.realisation + 1)
    before, last = None, None
    for problem, sliding in zip(path.problems, path.sliding, strict=True):
        if path.rough is None and len(path.problems) > 1 and branch.is_followed(problem):
            contact = branch.follow(problem, one, last)
            last = problem, contact
            yield contact
        elif path.rough is None:
            contact = solution.solve(problem, one, before, sliding)
            yield contact
        else:
            rough = path.rough
            pressed = two_step.solve(problem, rough.bodies, rough.rms_gradient, rough.order, before)
            yield pressed
            contact = pressed.contact
        before = contact.equilibrium
