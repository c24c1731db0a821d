"""Steps of a load path along a branch of equilibria, divided until each jump between branches is located."""

from dataclasses import dataclass, replace

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.contact import solution
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import NOTHING_LOST, Contact, Followed
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.stability import smallest_curvature
from gfmd_numba.solvers.status import Status

_LOST = 2e-3  # energy lost in a step over the work of adhesion on the contact up to which it holds no jump to locate
_CURVED = 1e-2  # energy that a step seems to lose, as forces between its ends are unknown, over the work of the step
_UNCERTAIN = 2e-3  # part of it that hangs on where in a step the jump was, up to which that is known well enough
_DIVISIONS = 12  # halvings of a step at most
_MOST_SOLUTIONS = 64  # in one step, which may hold a jump of each asperity


@dataclass(frozen=True)
class _Point:
    problem: Problem
    contact: Contact

    @property
    def force(self) -> float:
        """What the load is conjugate to: the mean pressure, or minus the mean displacement."""
        if self.problem.displacement is not None:
            return self.pressure
        return -float(self.contact.equilibrium.displacement[0].mean())

    @property
    def pressure(self) -> float:
        """Mean pressure."""
        return float(self.contact.equilibrium.pressure[0].mean())

    @property
    def energy(self) -> float:
        """Energy per nominal area of body and law, less the work of a prescribed pressure."""
        punch, u = self.contact.punch[0], self.contact.equilibrium.displacement[0]
        stiffness = self._stiffness
        waves = np.abs(grid.coefficients(u, u.ndim)) ** 2 * grid.multiplicity(u.shape[-1])
        law = self.problem.interface.normal_law
        own = 0.0 if law is None else float(law.energy(punch - u).mean())
        return 0.5 * float(np.vdot(stiffness, waves)) + own - (self.problem.mean_pressure or 0.0) * float(u.mean())

    @property
    def stability(self) -> float:
        """Smallest curvature of the energy over that of the bodies alone, not-a-number unless in equilibrium."""
        law, found = self.problem.interface.normal_law, self.contact.equilibrium
        if law is None or found.status[0] != Status.ok:
            return float("nan")
        gap = self.contact.punch[0] - found.displacement[0]
        return smallest_curvature(gap, found.touching[0], self._stiffness, law)

    @property
    def _stiffness(self) -> Reals:
        stiffness = solution.condensed_stiffness(self.problem, grid.magnitudes(self.contact.punch.shape[1:]))
        if self.problem.mean_pressure is not None or not np.isfinite(stiffness.flat[0]):
            stiffness.flat[0] = 0.0  # a rigid mean stores no energy
        return stiffness


def stability(problem: Problem, contact: Contact) -> float:
    """Smallest curvature of the energy over that of the bodies alone; it may take as long as the equilibrium itself."""
    return _Point(problem, contact).stability


def is_followed(problem: Problem) -> bool:
    """Whether the steps of a path are divided: where a law of the gap attracts and the solver keeps to a branch."""
    law = problem.interface.normal_law
    return law is not None and law.softening > 0.0 and problem.numerics.solver == "truncated_newton"


def follow(problem: Problem, realisations: range, before: tuple[Problem, Contact] | None) -> Contact:
    """Equilibrium of a problem, reached from that of the one before it if any, with what happened on the way."""
    if before is None:
        first = _Point(problem, solution.solve(problem, realisations))
        return replace(first.contact, followed=replace(NOTHING_LOST, least_pressure=first.pressure))
    spent: list[Contact] = []
    point, steps = _advance(_Point(*before), problem, realisations, _DIVISIONS, 0.0, spent)
    jumps = [step for step in steps if not np.isnan(step.jump_at)]
    largest = max(jumps, key=lambda step: step.lost, default=NOTHING_LOST)
    counted = {
        name: sum(getattr(each.equilibrium, name) for each in spent)
        for name in ("n_iterations", "n_transforms", "wall_time")
    }
    equilibrium = replace(point.contact.equilibrium, **counted)
    least = min(_Point(problem, each).pressure for each in spent)
    followed = Followed(sum(step.lost for step in steps), largest.jump_at, least)
    return replace(point.contact, equilibrium=equilibrium, followed=followed)


def _advance(
    start: _Point, problem: Problem, realisations: range, divisions: int, curved: float, spent: list[Contact]
) -> tuple[_Point, list[Followed]]:
    """Go from a point to a problem in one step, or in two if it loses energy; `curved` may seem to be lost."""
    contact = solution.solve(problem, realisations, start.contact.equilibrium)
    spent.append(contact)
    end = _Point(problem, contact)
    gained, way = end.energy - start.energy, end.problem.load - start.problem.load
    least, most = sorted((start.force * way, end.force * way))  # work between them on a branch of monotonic force
    lost = 0.5 * (least + most) - gained
    if divisions == _DIVISIONS:
        curved = _CURVED * 0.5 * abs(least + most)
    negligible = _LOST * _adhesion(start, end)
    jumps = least - gained > negligible
    halfway = 0.5 * (start.problem.load + end.problem.load)
    if contact.equilibrium.status[0] != Status.ok or not (jumps or abs(lost) > max(negligible, curved)):
        return end, [Followed(lost, np.nan)]
    is_located = 0.5 * (most - least) <= _UNCERTAIN * abs(lost)
    if is_located or divisions == 0 or len(spent) >= _MOST_SOLUTIONS:
        return end, [Followed(lost, halfway if jumps else np.nan)]
    middle, first = _advance(start, problem.under(halfway), realisations, divisions - 1, curved, spent)
    end, second = _advance(middle, problem, realisations, divisions - 1, curved, spent)
    return end, first + second


def _adhesion(start: _Point, end: _Point) -> float:
    """Work of adhesion on the larger contact of two, infinite without any."""
    law = start.problem.interface.normal_law
    touching = max(float(each.contact.equilibrium.touching.mean()) for each in (start, end))
    assert law is not None  # as is_followed says
    return abs(float(law.energy(np.zeros(1))[0])) * touching or np.inf
