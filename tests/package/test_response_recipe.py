"""The recipe of docs/architecture.md for a response, followed on a copy of the package."""

import numpy as np
import pytest

from support.recipes import copied, run_on_copy

BODY = '''\
"""Half-space whose modulus depends on the wave number."""

from dataclasses import dataclass

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid


@dataclass(frozen=True)
class SoftSkin(ElasticBody):
    """Half-space of Poisson's ratio 0.3 whose waves of number q are softer by 1 + q depth."""

    poissons_ratio: float = 0.3
    aspect_ratio: None = None
    depth: float = 0.1

    def condensed_stiffness(self, q):
        return super().condensed_stiffness(q) / (1.0 + self.depth * q)

    def response(self, shape):
        return SpectralResponse(super().response(shape).elements / (1.0 + self.depth * grid.magnitudes(shape)))
'''
SCRIPT = """
import json, sys
from functools import reduce
import numpy as np
from gfmd_numba.contact.problem import Problem
from gfmd_numba.roughness.surfaces import given_surface
from gfmd_numba.contact.solution import solve
from gfmd_numba.elasticity.your_body import SoftSkin
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.table import Options

def found(shape, solver, laws, pressure, depth=0.1):
    heights = reduce(np.multiply, np.ix_(*(np.cos(2.0 * np.pi * np.arange(n) / n) for n in shape)))
    surface, _ = given_surface(heights)
    numerics = Options(solver, residual=1e-8)
    return Problem(surface, SoftSkin(depth=depth), laws, pressure, None, numerics)

made = []
for shape, solver, friction, pressure in json.load(sys.stdin):
    laws = Interactions(True, friction=friction)
    problem = found(tuple(shape), solver, laws, pressure)
    contact = solve(problem, range(1))
    tangential = contact.equilibrium.tangential
    made.append({
        "status": int(contact.equilibrium.status[0]),
        "area": float(contact.equilibrium.touching.mean()),
        "amplitude": float(np.ptp(contact.equilibrium.pressure) / np.ptp(contact.heights)),
        "shear": 0.0 if tangential is None else float(abs(tangential.traction).max()),
        "identity": problem.identity,
        "other": found(tuple(shape), solver, laws, pressure, 0.2).identity,
    })
json.dump(made, sys.stdout)
"""
FRICTIONLESS = ("active_set_newton", "conjugate_gradients", "truncated_newton", "verlet", "fire")


@pytest.mark.long
def test_a_half_space_whose_modulus_depends_on_the_wave_number_is_pressed_by_every_solver(tmp_path):
    """In full contact with one wave the amplitude of the pressure is its stiffness times that of the wave."""
    package = copied(tmp_path)
    (package / "elasticity" / "your_body.py").write_text(BODY)
    shapes = ([64], [64, 64])
    cases = [(shape, solver, None, 5.0) for shape in shapes for solver in FRICTIONLESS]
    cases += [(shape, "frictional_newton", 0.3, pressure) for shape in shapes for pressure in (5.0, 0.05)]
    cases += [(shape, "active_set_newton", None, 0.05) for shape in shapes]
    made = run_on_copy(package, SCRIPT, cases)
    for (shape, _, friction, pressure), found in zip(cases, made, strict=True):
        q = 2.0 * np.pi * np.sqrt(len(shape))
        assert found["status"] == 0
        assert found["identity"] != found["other"]
        assert (found["area"] == 1.0) == (pressure == 5.0)
        if friction is None and pressure == 5.0:
            assert found["amplitude"] == pytest.approx(0.5 * q / (1.0 + 0.1 * q), rel=1e-6)
        assert (found["shear"] > 0.0) == (friction is not None)
