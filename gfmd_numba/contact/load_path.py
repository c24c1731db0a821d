"""The solution of a problem along its loading path, and the record of its measures.

The solution is a fold over the steps of the path. The contact is recorded at every step, and the path as a whole.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import repeat
from math import isinf, isnan, nan
from typing import Any

import numpy as np
import numpy.typing as npt

from gfmd_numba.arrays.threads import shared_by
from gfmd_numba.contact import jumps, plastic_flow, solution, time_steps, two_step
from gfmd_numba.contact.energy_balance import EnergyBalance, components, friction_limit_of, wall_pressure
from gfmd_numba.contact.evaluation import mean_pressure, measure, plastic_work, slid_over_peaks
from gfmd_numba.contact.observables import (
    OF_PUNCH,
    OF_SUM,
    PATH_OBSERVABLES,
    ROUGH_BODY_OBSERVABLES,
    Observable,
    recorded,
)
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.processes import processes_of
from gfmd_numba.contact.solution import solve
from gfmd_numba.contact.state import Contact, State, Tell, with_costs
from gfmd_numba.contact.two_step import RoughContact
from gfmd_numba.roughness.surfaces import SummedSurface
from gfmd_numba.solvers.status import Status


def solve_path(problem: Problem, realisation: int, tell: Tell = lambda more: None) -> Iterator[Contact]:
    """Equilibrium of a realisation at each load of a path, begun in the state that the last step has left.

    `tell` is called with the steps done since the last call; one may be a part of a step.
    """
    solve: Callable[[Problem, State], Contact] = solution.solve
    if problem.rough is not None:
        state, solve = two_step.begin(problem, realisation), two_step.solve
    else:
        state = solution.begin(problem, range(realisation, realisation + 1))
        solve = _follower(problem, tell)
    attracts = problem.displacement is not None and problem.interface.softening > 0.0 and problem.plasticity is None
    last: list[_Pulled] = []  # the punch as it is drawn off, from the first step of that to the latest two
    for at_load in problem.at_each_load:
        solved = solve(at_load, state)
        if problem.plasticity is None:
            tell(1.0)
        if attracts:
            last = [each for each in last if each.problem.load > at_load.load] + [_Pulled(at_load, solved)]
            solved = _with_peak(solved, last, solve)
            last = last[-2:]
        yield solved
        state = solved.after


@dataclass(frozen=True)
class _Pulled:
    """A contact under an attraction, and the problem it solves."""

    problem: Problem
    contact: Contact

    @cached_property
    def tension(self) -> float:
        """Mean tension (g E*)."""
        return -float(mean_pressure(self.contact.in_plane)[0])

    def halfway(self, end: "_Pulled", solve: Callable[[Problem, State], Contact]) -> "_Pulled":
        """The contact in the middle of the step from here to an end."""
        problem = end.problem.under(self.problem.step.towards(end.problem.step, 0.5))
        return _Pulled(problem, solve(problem, self.contact.after))


def _with_peak(solved: Contact, last: list[_Pulled], solve: Callable[[Problem, State], Contact]) -> Contact:
    """The last contact with the largest tension of the last two steps, where it lies between them.

    The steps beside the largest tension are halved until it would hardly rise further.
    """
    if len(last) < 3 or not 0.0 < last[1].tension > last[2].tension or last[0].tension > last[1].tension:
        return solved
    before, at, behind = last
    tried: list[_Pulled] = []
    for _ in range(_HALVINGS):
        if _rise(before, at, behind) <= _RISE * at.tension:
            break
        first, second = before.halfway(at, solve), at.halfway(behind, solve)
        tried += first, second
        if any(each.contact.equilibrium.status[0] != Status.ok for each in (first, second)):
            break
        halves = (replace(each.problem, duration=0.5 * each.problem.duration) for each in (at, behind))
        at, behind = (replace(each, problem=half) for each, half in zip((at, behind), halves, strict=True))
        five = [before, first, at, second, behind]
        largest = int(np.argmax([each.tension for each in five[1:4]]))
        before, at, behind = five[largest : largest + 3]
    spent = [solved.equilibrium, *(each.contact.equilibrium for each in tried)]
    least = min([solved.least_pressure, *(-each.tension for each in tried)])
    return replace(solved, equilibrium=with_costs(solved.equilibrium, spent), least_pressure=least)


def _follower(problem: Problem, tell: Tell) -> Callable[[Problem, State], Contact]:
    """What makes a step of the path of a problem: in one piece, or divided at jumps or in time."""
    if problem.plasticity is not None:
        largest = max(step.load for step in (problem.step, *problem.path))
        return partial(plastic_flow.follow, solve=solution.solve, largest=largest, tell=tell)
    steps = problem.step, *problem.path
    divided = sum(map(time_steps.is_divided, repeat(problem), (None, *steps), steps))
    if divided and problem.time_tolerance is not None:
        return partial(time_steps.follow, tolerance=problem.time_tolerance / divided)
    return jumps.follow if problem.path and jumps.is_followed(problem) else solution.solve


Measures = dict[str, npt.NDArray[Any]]

_ROUNDED = 1e-6  # of a tension, by which solutions of one load differ
_RISE, _HALVINGS = 3e-3, 8  # of the largest tension, by which it may rise further; halvings of a step at most


def _rise(before: _Pulled, at: _Pulled, behind: _Pulled) -> float:
    """What tension may rise by beyond that in the middle: as it has risen last, up to a jump, or by a parabola."""
    way, rest = before.problem.load - at.problem.load, at.problem.load - behind.problem.load
    slope, fall = (at.tension - before.tension) / way, (at.tension - behind.tension) / rest
    bend = (slope + fall) / (way + rest)
    return max(slope * rest, 0.25 * (slope - bend * way) ** 2 / bend if bend > 0.0 else 0.0)


@dataclass
class PathRecord:
    """The rows of `PATH_OBSERVABLES` for one realisation, in g L_x and g E*, added to contact by contact."""

    steps: dict[str, list[float]] = field(
        default_factory=lambda: {name: [] for name, row in PATH_OBSERVABLES.items() if row.of == "contact"}
    )
    _certain: list[float] = field(default_factory=list)  # energy dissipated in jumps and by plastic work
    _loads: list[float] = field(default_factory=list)
    _least: list[float] = field(default_factory=list)  # mean pressure on the way to a step
    _pressures: list[float] = field(default_factory=list)  # mean pressure at its end
    _balance: EnergyBalance | None = None
    _dissipated: float = 0.0  # by the dashpots of a viscoelastic body

    def add(self, problem: Problem, solved: Contact, is_ok: bool) -> None:
        """Record the contact at the next step, not-a-number for one that is not ok."""
        contact = solved.in_plane
        pressure = float(mean_pressure(contact)[0])
        self._loads.append(problem.load)
        self._pressures.append(pressure)
        in_parts = pressure if contact.followed is None else contact.followed.least_pressure
        self._least.append(min(pressure, contact.least_pressure, in_parts))
        if not is_ok:
            for values in (*self.steps.values(), self._certain):
                values.append(nan)
            return
        followed, before, self._balance = contact.followed, self._balance, EnergyBalance.of(problem, contact)
        loss = 0.0 if before is None else self._balance.dissipated(before)
        plastic = float(plastic_work(contact)[0])
        if followed is not None:
            loss, plastic = followed.dissipated, followed.plastic_work
        elif (springs := contact.memory.get("springs")) is not None:
            loss, self._dissipated = float(springs.dissipated[0]) - self._dissipated, float(springs.dissipated[0])
        elif problem.interface.hardness is not None:
            loss = plastic  # also of the first step, which finds the punch as it was made
        jumps = followed is not None and not isnan(followed.jump_at)
        self._certain.append(max(loss, 0.0) if jumps or problem.relaxation is not None else plastic)
        self.steps["mean_tangential_traction"].append(float(self._balance.traction[0]))
        self.steps["mean_tangential_traction_y"].append(float(self._balance.traction[-1]))
        self.steps["stick_fraction"].append(stick_fraction(problem, solved))
        self.steps["slid_over_peaks"].append(float(slid_over_peaks(contact, problem.step.sliding)[0]))
        self.steps["energy_lost"].append(loss)

    def of_steps(self) -> dict[str, npt.NDArray[Any]]:
        """Rows of the contact at every step.

        The losses of jumps and plastic work are certain. The other losses are trapezia, which may be wrong, as forces
        between the ends of steps are not known. Nothing gives dissipated energy back. So a loss that a later step
        seems to gain back is none.
        """
        rows = {name: np.array(values) for name, values in self.steps.items()}
        certain = np.array(self._certain)
        rest = rows["energy_lost"] - certain
        so_far = np.where(np.isnan(rest), np.inf, np.nancumsum(rest))
        for_good = np.maximum(np.minimum.accumulate(so_far[::-1])[::-1], 0.0)
        for_good = np.where(np.isnan(rest), np.nan, for_good)
        return rows | {"energy_lost": certain + np.diff(for_good, prepend=0.0)}

    def of_path(self) -> dict[str, float]:
        """Rows of the path as a whole, not-a-number if a step is not ok."""
        lost = float(self.of_steps()["energy_lost"].sum())
        return {"hysteresis": lost, "pull_off_pressure": nan if isnan(lost) else self._pull_off()}

    def _pull_off(self) -> float:
        """Largest tension since the punch was deepest; not-a-number if there is none that falls as it is drawn off."""
        deepest = len(self._loads) - 1 - int(np.argmax(self._loads[::-1]))
        least = [self._pressures[deepest], *self._least[deepest + 1 :]]
        at = deepest + int(np.argmin(least))
        tension = -min(least)
        fallen = -self._pressures[at] < (1.0 - _ROUNDED) * tension
        falls = at > deepest and self._loads[at] < self._loads[at - 1] and fallen
        further = min(self._loads[at:]) < self._loads[at]
        return tension if tension > 0.0 and (falls or further) else nan


def stick_fraction(problem: Problem, contact: Contact) -> float:
    """Touching nodes that bear less than friction allows, over all touching ones; not-a-number without any.

    The residual tells how far the traction of a slipping node may be from its bound.
    """
    found, friction = contact.equilibrium, problem.interface.friction
    touching = found.touching[0]
    if not touching.any():
        return nan
    if found.tangential is None or friction is None or isinf(friction):
        return 1.0
    wall = wall_pressure(problem, contact)
    slack = float(found.residual[0]) * float(wall.max())
    rubbing = np.linalg.norm(components(found.tangential.traction, wall), axis=0).reshape(wall.shape)
    sticks = rubbing < friction_limit_of(problem, contact, wall) - slack
    return float((sticks & touching).sum() / touching.sum())


@shared_by(1)
def measured(problem: Problem, realisations: range) -> Measures:
    """All measures of realisations of a problem `[realisation]`, along a path of contacts `[realisation, step]`.

    A run along a path ends at the first step whose status is not ok, and has this status, the largest residual, and the
    sums of iterations, transforms and time. Measures of the contact are not-a-number from that step on.
    """
    if problem.path:
        rows = [_along(problem, realisation) for realisation in realisations]
        return {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    if problem.rough is None and problem.plasticity is None and not problem.duration:
        return measure(solve(problem, realisations))
    found = [_measure(problem, next(solve_path(problem, realisation))) for realisation in realisations]
    return {name: np.concatenate([each[name] for each in found]) for name in found[0]}


def recorded_of(problem: Problem) -> dict[str, Observable]:
    """What is recorded of each contact of a problem."""
    names = [process.name for process in processes_of(problem)]
    has_hardness, steadily, passes = problem.interface.hardness is not None, problem.speed > 0.0, problem.passing
    rows = recorded(has_hardness, problem.ends, problem.has_form, names, steadily, passes is not None)
    if problem.rough is None:
        return rows
    named = {name: replace(row, long_name=row.long_name.replace(OF_PUNCH, OF_SUM)) for name, row in rows.items()}
    return named | ROUGH_BODY_OBSERVABLES


def _measure(problem: Problem, solved: Contact) -> Measures:
    """Measures `[realisation]` of one contact."""
    values = measure(solved.in_plane)
    if not isinstance(solved, RoughContact):
        return values
    assert isinstance(problem.surface, SummedSurface)  # of rough bodies
    error = solved.next_order / problem.surface.rms_gradient
    return values | {"next_order": np.where(values["status"] == Status.ok, error, nan)}


def _along(problem: Problem, realisation: int) -> Measures:
    """Measures of one realisation: `[step]` of the contact, `[]` of all else."""
    record, found = PathRecord(), []
    for one, solved in zip(problem.at_each_load, solve_path(problem, realisation), strict=False):
        found.append(_measure(one, solved))
        is_ok = bool(found[-1]["status"][0] == Status.ok)
        record.add(one, solved, is_ok)
        if not is_ok:
            break
    rows = recorded_of(problem)
    values = {name: np.concatenate([each[name] for each in found]) for name in rows}
    joined: Measures = {name: values[name][0] for name, row in rows.items() if row.of == "surface"}
    joined |= {name: _filled(values[name], problem.n_loads) for name, row in rows.items() if row.of == "contact"}
    joined |= {name: values[name].sum() for name in ("n_iterations", "n_transforms", "wall_time")}
    joined |= {"status": values["status"][-1], "residual": values["residual"].max()}
    joined |= {name: _filled(steps, problem.n_loads) for name, steps in record.of_steps().items()}
    return joined | {name: np.asarray(value) for name, value in record.of_path().items()}


def _filled(values: npt.NDArray[Any], steps: int) -> npt.NDArray[Any]:
    """Values of the first of so many steps, not-a-number for the others."""
    return np.concatenate([values, np.full(steps - len(values), nan)])
