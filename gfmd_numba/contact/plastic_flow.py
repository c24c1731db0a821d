"""Plastic flow inside the body: J2 plasticity in sublayers below the surface, found together with the contact.

The state is `PlasticState`, the process `PlasticFlow`. Let e_p be the plastic strain, p the pressure and s the
deviatoric stress. They determine each other:

    r = U e_p                     residual displacement of the surface    (`Sublayers.surface_displacement`)
    p = C(r)                      contact on a surface moved by r         (`solution.solve`)
    s = 2 G (e(p, e_p) - e_p)     e: deviatoric strain in the body        (`Sublayers.strains`)
    e_p = R(s)                    von Mises stress of s <= Y(e_eq)        (`kernels.return_to_yield`)

    Y(e_eq) = Y_0 + h e_eq + (Y_s - Y_0) (1 - exp(-e_eq / e_s)),    e_eq: equivalent plastic strain of all steps

(in this order the fields of `kernels.Hardening`).

The map from e_p on the right to e_p on the left is a step of forward-backward splitting (Lions and Mercier, SIAM J.
Numer. Anal. 16:964, 1979) of a convex energy. So it is nonexpansive: it never takes two strains farther apart.
Anderson's method makes it fast. The iteration ends if 2 G max |change of e_p| <= `RESIDUAL_RATIO` residual Y_0.
Strains are in g, stresses in g E*, thicknesses in L_x.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Reals
from gfmd_numba.contact.evaluation import once
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import (
    Contact,
    LoadStep,
    Process,
    State,
    StepModification,
    Tell,
    relative_difference,
    with_costs,
)
from gfmd_numba.elasticity.eigenstrain import Sublayers
from gfmd_numba.elasticity.fields import von_mises
from gfmd_numba.solvers import anderson
from gfmd_numba.solvers.equilibrium import Equilibrium
from gfmd_numba.solvers.status import Status, withdrawn

NAME = "flow"  # of what the process remembers
RESIDUAL_RATIO = 100.0  # that of the flow over that of the contact
_FEWEST = 4  # increments, half of which tell their error: one and two of them often err alike
_MIXED, _LOOPS, _RISEN = 5, 500, 2.0
_PROBES, _SHALLOWEST, _DEEPEST = 32, 0.25, 2.0  # sublayers that look for the depth, from (nodes) to (L_x)
_MARGIN = 1.6  # of the depth to which an elastic body would yield: flow is up to 1.5 times as deep
_NEARLY = 0.9  # of the largest stress


@dataclass(frozen=True)
class PlasticState:
    """Plastic `strain` `[component, sublayer, y, x]` of a body, and the `equivalent` plastic strain of all steps.

    The `strain` moves the surface out of the body by the `residual_displacement` `[realisation, (y,) x]`. The yield
    condition and the flow rule hold to a `residual` times the yield stress. With half the increments, the mean pressure
    or the residual displacement would change by a relative `error`, not-a-number where it is not known.
    """

    body: Sublayers
    strain: Reals
    equivalent: Reals
    residual_displacement: Reals
    residual: float = 0.0
    error: float = np.nan

    @classmethod
    def untouched(cls, body: Sublayers, shape: tuple[int, ...]) -> "PlasticState":
        """Return the state in which nothing has flowed below a surface of a shape `[realisation, (y,) x]`."""
        equivalent = np.zeros((body.waves.thickness.size, *body.shape))
        return cls(body, np.zeros((body.components, *equivalent.shape)), equivalent, np.zeros(shape))


@dataclass(frozen=True)
class PlasticFlow(Process):
    """The process: it remembers the `PlasticState` that `follow` has found, and moves the surface by it."""

    name: ClassVar[str] = NAME

    def begin(self, shape: tuple[int, ...]) -> PlasticState | None:
        """Nothing has flowed, and the depth of the sublayers is not known yet."""
        return None

    def change(self, state: State, step: LoadStep) -> StepModification:
        """The surface has moved by the residual displacement."""
        plastic: PlasticState | None = state.memory[NAME]
        return StepModification(normal_offset=None if plastic is None else plastic.residual_displacement)


def plastic_state(contact: Contact) -> PlasticState:
    """Return the plastic state at the end of the step of a contact."""
    plastic: PlasticState = contact.after.memory[NAME]
    return plastic


def equivalent(tensor: Reals) -> Reals:
    """Equivalent stress `[sublayer, y, x]` of a deviatoric one `[component, sublayer, y, x]`.

    Of a strain it is 1.5 times the equivalent strain.
    """
    xx, zz, *shear = tensor
    return von_mises(xx, -xx - zz, zz, *shear)


@once
def stresses(contact: Contact) -> Reals:
    """Equivalent stress, and stress along x, in the body under a contact, means of sublayers `[2, sublayer, y, x]`."""
    plastic = plastic_state(contact)
    plastic.body.surface_displacement(plastic.strain)
    *strains, normal = plastic.body.strains(
        contact.equilibrium.pressure[0].reshape(plastic.body.shape), with_normal=True
    )
    deviator = 2.0 * plastic.body.shear * (np.stack(strains) - plastic.strain)
    return np.stack((equivalent(deviator), normal + deviator[0] - deviator[1]))


Solve = Callable[[Problem, State], Contact]  # contact on a surface that has moved by the residual displacement


def follow(problem: Problem, state: State, solve: Solve, largest: float, tell: Tell) -> Contact:
    """Equilibrium at the end of a step that begins in a state; `largest` is the largest load of its path (g E*)."""
    assert problem.plasticity is not None
    started, increments = time.perf_counter(), problem.plasticity.increments
    fewer = increments // 2 if increments >= _FEWEST else 0
    if state.memory[NAME] is None:
        state = state.remembering(NAME, _nothing_yet(problem, state, solve, largest))

    def divided(into: int) -> Contact:
        return _divided(problem, state, solve, into, lambda: tell(1.0 / (increments + fewer)))

    found = divided(increments)
    if fewer and found.equilibrium.status[0] == Status.ok:
        coarse = divided(fewer)
        pairs = [(each.equilibrium.pressure, each.change.normal_offset) for each in (coarse, found)]
        error = max(relative_difference(*both) for both in zip(*pairs, strict=True))
        assert found.before is not None  # of what was solved
        plastic = replace(found.before.memory[NAME], error=error)
        found = replace(found, before=found.before.remembering(NAME, plastic))
    spent = np.array([time.perf_counter() - started])
    return replace(found, equilibrium=replace(found.equilibrium, wall_time=spent))


def _divided(problem: Problem, state: State, solve: Solve, increments: int, tell: Callable[[], None]) -> Contact:
    """The contact that a step ends with, in so many increments, or the first that is not ok."""
    start, before = state.step_before(problem.step), state.memory[NAME].strain
    spent: list[Equilibrium] = []
    for increment in range(1, increments + 1):
        step = start.towards(problem.step, increment / increments) if increment < increments else problem.step
        guess = 2.0 * state.memory[NAME].strain - before if increment > 2 else state.memory[NAME].strain
        before = state.memory[NAME].strain
        found = _increment(problem.under(step), state, solve, guess)
        tell()
        spent.append(found.equilibrium)
        if found.equilibrium.status[0] != Status.ok:
            break
        state = found.after
    return replace(found, equilibrium=with_costs(found.equilibrium, spent))


def _increment(problem: Problem, state: State, solve: Solve, strain: Reals) -> Contact:
    """Equilibrium at the load of a problem, after a state, begun with a guess of the plastic strain."""
    assert problem.plasticity is not None
    start, hardening = state.memory[NAME], problem.plasticity.hardening
    bound = RESIDUAL_RATIO * problem.numerics.residual
    body, mixing, is_last = start.body, Mixing(start), False
    transforms, iterations = np.zeros((2, 1), dtype=np.int64)
    for _ in range(_LOOPS):
        moved = body.surface_displacement(strain).reshape(start.residual_displacement.shape)
        found = solve(problem, state.remembering(NAME, replace(start, residual_displacement=moved)))
        state, iterations = state.begun_at(found), iterations + 1
        transforms = transforms + found.equilibrium.n_transforms + 2 * strain.shape[0] * strain.shape[1]
        returned = body.strains(found.equilibrium.pressure[0].reshape(body.shape))  # yet the whole strains
        points = (each.reshape(len(strain), -1) for each in (returned, start.strain))
        kernels.return_to_yield(*points, start.equivalent.ravel(), hardening, body.shear)
        residual = 2.0 * body.shear * float(abs(returned - strain).max()) / hardening.stress
        if found.equilibrium.status[0] != Status.ok or (is_last and residual <= bound):
            break
        is_last = residual <= bound  # the last step is not mixed: it leaves nothing where nothing yields
        strain = returned if is_last else mixing.next(strain, returned)
    else:
        failed = withdrawn(found.equilibrium.status, True, Status.steps_used_up)
        found = replace(found, equilibrium=replace(found.equilibrium, status=failed))
    added = equivalent(strain - start.strain) / 1.5
    plastic = PlasticState(body, strain, start.equivalent + added, moved, residual)
    counted = replace(found.equilibrium, n_transforms=transforms, n_iterations=iterations)
    return replace(found, before=state.remembering(NAME, plastic), equilibrium=counted)


class Mixing:
    """Anderson's mixing of a map of plastic strains, over the points whose strain has changed in any iteration.

    The map itself never takes two strains farther apart. If mixing does, it begins anew from the best strain.
    """

    def __init__(self, start: PlasticState) -> None:
        self._start = start.strain.reshape(len(start.strain), -1)
        self._weight = np.repeat(np.sqrt(start.body.waves.thickness), self._start.shape[1] // len(start.strain[0]))
        self._changed = np.zeros(self._start.shape[1], dtype=np.bool_)
        self._found: list[Reals] = []  # beyond the start, at the points that have changed, flat
        self._steps: list[Reals] = []
        self._best: tuple[float, Reals] = np.inf, np.empty(0)

    def next(self, strain: Reals, returned: Reals) -> Reals:
        """Return the next strain, from one that the map has turned into another."""
        here, there = (each.reshape(self._start.shape) for each in (strain, returned))
        self._look_at((there != self._start).any(axis=0) | (here != self._start).any(axis=0))
        start, weight = self._start[:, self._changed], np.tile(self._weight[self._changed], len(there))
        given, found = ((each[:, self._changed] - start).ravel() for each in (here, there))
        step = found - given
        size = float(np.linalg.norm(weight * step))
        if size > _RISEN * self._best[0]:
            self._found, self._steps, found = [], [], self._best[1]
        else:
            self._found, self._steps = [*self._found[-_MIXED:], found], [*self._steps[-_MIXED:], step]
            if size < self._best[0]:
                self._best = size, found
            if len(self._found) > 1:
                found = anderson.mixed(self._found, self._steps, weight)
        mixed = self._start.copy()
        mixed[:, self._changed] += found.reshape(len(mixed), -1)
        return mixed.reshape(strain.shape)

    def _look_at(self, changed: Flags) -> None:
        """Look at more points, where nothing has changed so far."""
        changed |= self._changed
        old, self._changed = self._changed[changed], changed

        def spread(values: Reals) -> Reals:
            found = np.zeros((len(self._start), old.size))
            found[:, old] = values.reshape(len(found), -1)
            return found.ravel()

        if not old.all():
            self._found, self._steps = ([*map(spread, each)] for each in (self._found, self._steps))
            self._best = self._best[0], spread(self._best[1])


def _nothing_yet(problem: Problem, state: State, solve: Solve, largest: float) -> PlasticState:
    """Body in which nothing has flowed, with sublayers as deep as the problem says, or as its largest load needs."""
    plasticity, shape = problem.plasticity, state.heights.shape
    assert plasticity is not None
    map_shape, depth = shape[-2:], plasticity.depth  # of a profile the one realisation is the one row
    if depth is None:
        probes = np.diff(np.geomspace(_SHALLOWEST / shape[-1], _DEEPEST, _PROBES), prepend=0.0)
        probe = PlasticState.untouched(Sublayers(map_shape, probes, problem.body.nu), shape)
        elastic = solve(problem.under(problem.step._replace(load=largest)), state.remembering(NAME, probe))
        stress = stresses(elastic)[0].max(axis=(1, 2))
        reached = np.flatnonzero(stress >= min(plasticity.hardening.stress, _NEARLY * stress.max()))[-1]
        depth = _MARGIN * float(probes[: reached + 1].sum())
    return PlasticState.untouched(
        Sublayers(map_shape, plasticity.thicknesses(depth, shape[-1]), problem.body.nu), shape
    )
