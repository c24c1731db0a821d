"""A law the grid does not resolve is told: how fast it softens over how fast the shortest wave stiffens."""

import numpy as np
import pytest
import slab_stiffness

import gfmd_numba
from gfmd_numba.contact.problem import DeformableBody, Problem
from gfmd_numba.contact.relative_softening import COARSEST, softening, warning
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.scene import InputError
from gfmd_numba.solvers.table import Options

AMPLITUDE, WORK, RANGE = 0.1, 6e-3, 2e-3
ADHESIVE = {"work_of_adhesion": WORK, "range": RANGE}


@pytest.mark.parametrize(
    ("law", "name", "energy"),
    [
        (ExponentialLaw(0.3, 0.2), "softening", ExponentialLaw.energy),
        (ExponentialLaw(-0.3, 0.2), "softening", ExponentialLaw.energy),
        (XuNeedlemanLaw(0.3, 0.2, 0.4), "softening", lambda law, gap: law.energy(gap, 0.0 * gap)),
        (XuNeedlemanLaw(0.3, 0.2, 0.4), "slip_softening", lambda law, slip: law.energy(0.0 * slip, slip)),
    ],
    ids=["attraction", "repulsion", "cohesive", "slip"],
)
def test_softening_is_the_largest_negative_curvature_of_the_energy(law, name, energy):
    way, h = np.linspace(0.0, 2.0, 20001), 1e-4
    curvature = (energy(law, way + h) - 2 * energy(law, way) + energy(law, way - h)) / h**2
    assert getattr(law, name) == pytest.approx(max(-curvature.min(), 0.0), rel=1e-5, abs=1e-4)


def problem(nx, interface, body=None, counter=None):
    surface = RandomSurface(SelfAffineWaves(0.8, 2, 32), nx, 1)
    return Problem(surface, body or ElasticBody(None, None), interface, 0.1, None, Options("verlet"), counter=counter)


ATTRACTION = Interactions(True, ExponentialLaw(WORK, RANGE))


def test_of_an_exponential_law_it_is_that_of_its_range():
    assert softening(problem(512, ATTRACTION)) == pytest.approx(WORK / RANGE**2 / (np.pi * 512 / 2))
    assert softening(problem(512, Interactions(True))) == 0.0
    assert softening(problem(512, Interactions(False, ExponentialLaw(-WORK, RANGE)))) == 0.0


def test_the_shortest_wave_is_as_stiff_as_the_bodies_make_it():
    """A thin incompressible slab stiffens all waves of the grid, a second half-space halves them."""
    half_space = softening(problem(512, ATTRACTION))
    thin = softening(problem(512, ATTRACTION, ElasticBody(0.5, 1e-3)))
    factor = slab_stiffness.slab_factor(np.array([np.pi * 512 * 1e-3]), 0.5)[0]
    assert factor > 2
    assert thin == pytest.approx(half_space / factor)
    two = softening(problem(512, ATTRACTION, counter=DeformableBody(ElasticBody(None, None), 0.5)))
    assert two == pytest.approx(half_space)
    softer = softening(problem(512, ATTRACTION, counter=DeformableBody(ElasticBody(0.5, 1e-3), 0.5)))
    assert softer == pytest.approx(half_space * (0.5 + 0.5 / factor))


@pytest.mark.parametrize("body", [None, ElasticBody(0.5, 1e-3), ElasticBody(0.3, 1e-2)])
def test_the_grid_it_asks_for_resolves_the_law(body):
    told = warning(problem(512, ATTRACTION, body), None)
    nodes = int(told.rpartition("at least ")[2].split()[0])
    assert nodes > 512
    assert softening(problem(nodes, ATTRACTION, body)) <= COARSEST
    assert warning(problem(nodes, ATTRACTION, body), None) == ""


@pytest.mark.parametrize(("dimension", "reach"), [(1, "16777216 points"), (2, "16384 points both ways")])
def test_a_law_that_no_grid_within_reach_resolves_is_refused_without_one(dimension, reach):
    scene = {
        "dimension": dimension,
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}, "exponential": {"work_of_adhesion": 1.0, "range": 1e-5}},
        "loading": {"reduced_pressure": 0.02},
    }
    with pytest.raises(InputError, match=f"No grid of up to {reach} resolves the law: take a longer range or less"):
        gfmd_numba.solve({"scene": scene, "discretisation": {"eps_c": 0.5, "eps_f": 0.5, "eps_t": 1.0}})


def test_a_map_is_told_by_the_shortest_wave_along_an_axis():
    surface = RandomSurface(SelfAffineWaves(0.8, 2, 32), 128, 1, dimension=2)
    of_map = Problem(surface, ElasticBody(None, None), ATTRACTION, 0.1, None, Options("truncated_newton"))
    assert softening(of_map) == softening(problem(128, ATTRACTION))
    assert "over 8 % too large at 0.9. Take at least 4776 points both ways" in warning(of_map, None)
    assert "over 25 % too large at 0.9. Take at least 4776 points, " in warning(problem(128, ATTRACTION), None)
