"""The processes of scenes: plastic indentation, wear, and deflection by prescribed tractions."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from gfmd_numba.arrays import Flags, Reals
from gfmd_numba.contact.plastic_flow import PlasticFlow
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import Contact, LoadStep, Process, State, StepModification
from gfmd_numba.contact.viscoelasticity import Relaxation
from gfmd_numba.elasticity import free_body


@dataclass(frozen=True)
class PlasticIndentation:
    """Plastic indentation of a punch of hardness H, whose nodes bear a pressure of H at most.

    It remembers the depth `[realisation, (y,) x]` by which the punch has been flattened. The flattened material
    vanishes: its volume is not conserved.
    """

    name: ClassVar[str] = "indentation"

    def begin(self, shape: tuple[int, ...]) -> Reals | float:
        """Nothing is flattened yet."""
        return 0.0

    def change(self, state: State, step: LoadStep) -> StepModification:
        """The wall is lower where it has been flattened."""
        return StepModification(wall=state.memory[self.name])

    def advance(self, state: State, solved: Contact, step: LoadStep) -> Reals | float:
        """The depth grows by the penetration of plastic nodes."""
        depth: Reals | float = state.memory[self.name] + solved.plastic_penetration
        return depth


@dataclass(frozen=True)
class Deflection(Process):
    """Displacement of the body by prescribed tractions; the punch meets the deflected surface, as the body is linear.

    It remembers this displacement `[component, (y,) x]`, the normal one last, which no step changes.
    """

    problem: Problem
    name: ClassVar[str] = "deflection"

    def begin(self, shape: tuple[int, ...]) -> Reals:
        """What the tractions do to the body."""
        tractions, counter = self.problem.tractions, self.problem.counter
        assert tractions is not None
        fraction = 1.0 if counter is None else 1.0 - counter.compliance_fraction  # of E* in that of the body
        given = np.stack((*tractions.tangential, tractions.normal))
        if any(self.problem.ends):
            return free_body.displaced(fraction * given, self.problem.body, self.problem.ends)
        return self.problem.body.response(given.shape[1:]).apply(fraction * given)

    def change(self, state: State, step: LoadStep) -> StepModification:
        """Displacements count from the deflected surface."""
        *along, out = state.memory[self.name]
        return StepModification(normal_offset=out[np.newaxis], tangential_offset=np.asarray(along)[np.newaxis])


@dataclass(frozen=True)
class PunchWear:
    """Archard's law: a node of the punch wears by a rate (in 1 / g E*) times its pressure times how far it slides.

    It remembers the depth `[realisation, (y,) x]` in g L_x. Under friction, each node wears by its own slip. In a step
    a node loses

        rate slip (theta p_end + (1 - theta) p_begin),    theta = max(1/2, 1 - 1 / (rate way K_max)),

    where the punch slides by `way`, and K_max (E*/L_x) is the stiffness of the `stiffest` wave. Short steps are of
    second order. In long steps theta grows, so that no wave of the grid oscillates. The wall of a step contains rate
    way theta p_end as a compliance, as if every node slipped by the whole way. If a node slipped by less in the last
    step, its wall is corrected by slip / way of that step.
    """

    rate: float
    stiffest: float
    name: ClassVar[str] = "worn"

    def begin(self, shape: tuple[int, ...]) -> Reals:
        """Nothing is worn yet."""
        return np.zeros(shape)

    def change(self, state: State, step: LoadStep) -> StepModification:
        """The wall is lower where it has worn, and compliance to the pressure of the step."""
        worn, most, last = state.memory[self.name], self.rate * state.sliding_distance(step), state.last
        compliance = max(0.5 * most, most - 1.0 / self.stiffest)
        if last is None or most == 0.0:
            return StepModification(wall=worn, wear_compliance=compliance)
        slipped: Reals | float = 1.0  # share of the way
        if last.equilibrium.tangential is not None:
            before = min(2.0 * last.change.wear_compliance, last.change.wear_compliance + 1.0 / self.stiffest)
            slipped = self.rate / before * _slip(last, 0.0) if before > 0.0 else compliance / most
        return StepModification(
            wall=worn + (slipped * most - compliance) * last.equilibrium.pressure, wear_compliance=compliance
        )

    def advance(self, state: State, solved: Contact, step: LoadStep) -> Reals:
        """Depths grow by what the step wears off."""
        way, pressure = state.sliding_distance(step), solved.equilibrium.pressure
        theta = solved.change.wear_compliance / (self.rate * way) if way > 0.0 else 0.5
        before = 0.0 if state.last is None else state.last.equilibrium.pressure
        worn = self.rate * _slip(solved, way) * (theta * pressure + (1.0 - theta) * before)
        depth: Reals = state.memory[self.name] + worn
        return depth


def _slip(contact: Contact, way: float) -> Reals | float:
    """How far nodes have slipped in a step `[realisation, (y,) x]`; without friction, the way of the punch."""
    found = contact.equilibrium.tangential
    return way if found is None else np.asarray(np.linalg.norm(found.slip, axis=1))


def processes_of(problem: Problem) -> tuple[Process, ...]:
    """All that happens to the steps of a problem, and its own processes last."""
    indentation = () if problem.interface.hardness is None else (PlasticIndentation(),)
    deflection = () if problem.tractions is None else (Deflection(problem),)
    relaxation = () if problem.relaxation is None else (Relaxation(problem),)
    wear = () if problem.wear_rate is None else (_wear(problem, problem.wear_rate),)
    flow = () if problem.plasticity is None else (PlasticFlow(),)
    return *indentation, *deflection, *relaxation, *wear, *flow, *problem.processes


def _wear(problem: Problem, rate: float) -> PunchWear:
    glassy = 1.0 if problem.relaxation is None else problem.relaxation.modulus(0.0)
    shortest = np.array([np.pi * np.linalg.norm(problem.surface.shape)])  # wave number
    return PunchWear(rate, glassy * float(problem.body.condensed_stiffness(shortest)[0]))


def bear_again(problem: Problem, state: State, touching: Flags, pressure: Reals) -> Flags:
    """Nodes `[realisation, (y,) x]` flattened earlier that bear the hardness again, to within the residual."""
    assert problem.interface.hardness is not None
    law = problem.interface.normal_law
    wall = pressure if law is None else pressure + law.traction(np.zeros(1))
    bears = touching & (wall >= (1.0 - problem.numerics.residual) * problem.interface.hardness)
    return np.asarray(bears & (np.asarray(state.memory["indentation"]) > 0.0))
