"""The recipe of docs/architecture.md for a process: wear as it is written there, and the relaxation of a body."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest

from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.contact.problem import Problem, RoughBodies
from gfmd_numba.contact.rough_surfaces import DeformableBody
from gfmd_numba.contact.solution import solve
from gfmd_numba.contact.state import LoadStep, StepModification
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.roughness.surfaces import SummedSurface, Topography, given_surface
from gfmd_numba.solvers.table import Options
from support.pages import ROOT, printed

RATE = 0.01


def wear():
    """The process that the page prints, with a rate."""
    (block,) = (each for each in printed(ROOT / "docs" / "architecture.md") if each.kind == "python")
    names = {"__name__": "wear"}
    exec(block.text, names)
    return names["Wear"](RATE)


def rough(dimension):
    """A random surface."""
    shape = {1: (128,), 2: (32, 32)}[dimension]
    waves = self_affine.SelfAffineWaves(0.8, 2, shape[0] // 4)
    return given_surface(waves.heights(shape, 3, range(1))[0])[0]


def sliding(dimension, loads, ways):
    """Steps of a path."""
    return tuple(LoadStep(load, (far, 0.5 * far)[:dimension]) for load, far in zip(loads, ways, strict=True))


LOADS, WAYS = (0.05, 0.08, 0.08, 0.02), (1.0, 3.0, 3.0, -2.0)
LAWS = {
    "hard wall": (Interactions(True), "active_set_newton"),
    "hardness": (Interactions(True, hardness=0.3), "active_set_newton"),
    "friction": (Interactions(True, friction=0.3), "frictional_newton"),
    "adhesion": (Interactions(True, normal_law=ExponentialLaw(5e-4, 0.05)), "truncated_newton"),
}


@pytest.mark.parametrize("dimension", [1, pytest.param(2, marks=pytest.mark.long)])
@pytest.mark.parametrize("law", LAWS)
def test_the_worn_volume_is_rate_times_load_times_way(dimension, law):
    """Archard's law, whatever the contact, also while dents and slip are remembered. Adhesion divides steps."""
    interface, solver = LAWS[law]
    loads = (0.05,) * len(LOADS) if law == "adhesion" else LOADS
    path = sliding(dimension, loads, WAYS)
    numerics = Options(solver, residual=1e-10)
    plain = Problem(rough(dimension), ElasticBody(0.3, 0.5), interface, 0.05, None, numerics, path=path)
    worn = replace(plain, processes=(wear(),))
    found, expected = list(solve_path(worn, 0)), 0.0
    ways = np.abs(np.diff([0.0, *WAYS])) * (1.0 if dimension == 1 else np.sqrt(1.25))
    for contact, load, way in zip(found[1:], loads, ways, strict=True):
        assert contact.equilibrium.status[0] == 0
        expected += RATE * load * way
        assert contact.after.memory["wear"].mean() == pytest.approx(expected, rel=1e-8)
    flat = list(solve_path(plain, 0))
    assert (found[-1].equilibrium.pressure != flat[-1].equilibrium.pressure).any()
    assert (
        (found[-1].equilibrium.plastic is None) == ("indentation" not in found[-1].after.memory) == (law != "hardness")
    )
    assert len({plain.identity, worn.identity, replace(worn, path=path[:1]).identity}) == 3


def test_the_punch_of_a_rough_body_wears():
    """The body's topography is followed to first order in its slope."""
    heights = 0.02 * rough(1).heights
    body = DeformableBody(ElasticBody(0.3, 0.5), 1.0, 0, 1)
    surface = SummedSurface((Topography(replace(rough(1), heights=heights), 1.0, True),), 0.02)
    bodies, numerics = RoughBodies((body,), 1), Options("active_set_newton", residual=1e-8)
    path = sliding(1, LOADS, WAYS)
    laws = Interactions(True)
    problem = Problem(surface, body.elastic, laws, 0.05, None, numerics, path=path, rough=bodies, processes=(wear(),))
    *_, last = solve_path(problem, 0)
    expected = RATE * np.dot(LOADS, np.abs(np.diff([0.0, *WAYS])))
    assert last.after.memory["wear"].mean() == pytest.approx(expected, rel=1e-6)
    assert last.next_order > 0.0


@dataclass(frozen=True)
class Relaxation:
    """Maxwell elements beside the springs of the bodies: their `modulus` over these (a Prony series of one term).

    It remembers the displacement u and that of the dashpot v, for u linear in time in each step.
    """

    modulus: float
    time: float
    name: ClassVar[str] = "relaxation"

    def begin(self, shape):
        return np.zeros((2, *shape))

    def _step(self, state, step):
        """Factor on the stiffness and how far the body has moved on its own; shares of v, old u and new u in new v."""
        x, (u, v) = step.duration / self.time, state.memory[self.name]
        kept, mean = np.exp(-x), -np.expm1(-x) / x if x else 1.0
        factor = 1.0 + self.modulus * mean
        return factor, self.modulus * (kept * v + (mean - kept) * u) / factor, (kept, mean - kept, 1.0 - mean)

    def change(self, state, step):
        factor, out, _ = self._step(state, step)
        return StepModification(normal_offset=out, factor=factor)

    def advance(self, state, solved, step):
        _, out, shares = self._step(state, step)
        (u, v), new = state.memory[self.name], solved.equilibrium.displacement + out
        return np.stack([new, shares[0] * v + shares[1] * u + shares[2] * new])


@pytest.mark.parametrize("shape", [(64,), (32, 32)])
def test_the_pressure_of_full_contact_relaxes_exponentially(shape):
    """Its fluctuation is the modulus at that time, times that of the long-term body."""
    wave = np.cos(2.0 * np.pi * np.arange(shape[-1]) / shape[-1]) * np.ones(shape)
    path = tuple(LoadStep(10.0, (0.0,) * len(shape), duration) for duration in (0.1, 0.3, 1.0, 1.0))
    process, numerics = Relaxation(3.0, 0.7), Options("conjugate_gradients", residual=1e-10)
    surface, laws = given_surface(wave)[0], Interactions(True)
    problem = Problem(surface, ElasticBody(None, None), laws, 10.0, None, numerics, path=path, processes=(process,))
    time = 0.0
    for step, contact in zip((problem.step, *path), solve_path(problem, 0), strict=True):
        time += step.duration
        amplitude = 2.0 * abs(grid.coefficients(contact.equilibrium.pressure, len(shape))).reshape(-1)[1]
        modulus = 1.0 + 3.0 * np.exp(-time / 0.7)
        assert contact.equilibrium.touching.all()
        assert amplitude == pytest.approx(modulus * np.pi * np.ptp(contact.heights) / 2.0, rel=1e-6)


def test_a_body_begins_stiff_and_ends_soft():
    """Under a constant load: at once as an elastic body four times as stiff, and at last as the long-term one."""
    numerics = Options("active_set_newton", residual=1e-9)
    elastic = Problem(rough(1), ElasticBody(None, None), Interactions(True), 0.08, None, numerics)
    relaxing = replace(elastic, processes=(Relaxation(3.0, 1.0),))
    first = solve(relaxing, range(1))
    stiff = solve(replace(elastic, mean_pressure=0.02), range(1)).equilibrium
    np.testing.assert_allclose(first.equilibrium.pressure, 4.0 * stiff.pressure, atol=1e-6)
    state = first.after
    for _ in range(12):
        last = solve(relaxing.under(LoadStep(0.08, (0.0,), 8.0)), state)
        state = last.after
    np.testing.assert_allclose(last.equilibrium.pressure, solve(elastic, range(1)).equilibrium.pressure, atol=1e-6)
