"""A law the grid does not resolve is told: how fast it softens over how fast the shortest wave stiffens."""

import numpy as np
import pytest
from scipy.special import ive

import gfmd_numba
from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.law_resolution import COARSEST, doubt, resolution
from gfmd_numba.contact.load_path import load_path
from gfmd_numba.contact.problem import CounterBody, Problem
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine_waves import SelfAffineWaves
from gfmd_numba.scene import InputError, load_scene
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.options import Options

AMPLITUDE, WORK, RANGE = 0.1, 6e-3, 2e-3
ADHESIVE = {"work_of_adhesion": WORK, "range": RANGE}


@pytest.mark.parametrize(
    "energy",
    [
        (ExponentialLaw(0.3, 0.2), lambda law, gap: law.energy(gap)),
        (ExponentialLaw(-0.3, 0.2), lambda law, gap: law.energy(gap)),
        (XuNeedlemanLaw(0.3, 0.2, 0.4), lambda law, gap: law.energy(gap, 0.0 * gap)),
    ],
    ids=["attraction", "repulsion", "cohesive"],
)
def test_softening_is_the_largest_negative_curvature_of_the_energy(energy):
    law, of = energy
    gap, h = np.linspace(0.0, 2.0, 20001), 1e-4
    curvature = (of(law, gap + h) - 2 * of(law, gap) + of(law, gap - h)) / h**2
    assert law.softening == pytest.approx(max(-curvature.min(), 0.0), rel=1e-5, abs=1e-4)


def problem(nx, interface, body=None, counter=None):
    surface = RandomSurface(SelfAffineWaves(0.8, 2, 32), nx, 1)
    return Problem(surface, body or ElasticBody(None, None), interface, 0.1, None, Options("verlet"), counter=counter)


ATTRACTION = Interactions(True, ExponentialLaw(WORK, RANGE))


def test_of_an_exponential_law_it_is_that_of_its_range():
    assert resolution(problem(512, ATTRACTION)) == pytest.approx(WORK / RANGE**2 / (np.pi * 512 / 2))
    assert resolution(problem(512, Interactions(True))) == 0.0
    assert resolution(problem(512, Interactions(False, ExponentialLaw(-WORK, RANGE)))) == 0.0


def test_the_shortest_wave_is_as_stiff_as_the_bodies_make_it():
    """A thin incompressible slab stiffens all waves of the grid, a second half-space halves them."""
    half_space = resolution(problem(512, ATTRACTION))
    thin = resolution(problem(512, ATTRACTION, ElasticBody(0.5, 1e-3)))
    factor = stiffness.slab_factor(np.array([np.pi * 512 * 1e-3]), 0.5)[0]
    assert factor > 2
    assert thin == pytest.approx(half_space / factor)
    two = resolution(problem(512, ATTRACTION, counter=CounterBody(ElasticBody(None, None), 0.5)))
    assert two == pytest.approx(half_space)
    softer = resolution(problem(512, ATTRACTION, counter=CounterBody(ElasticBody(0.5, 1e-3), 0.5)))
    assert softer == pytest.approx(half_space * (0.5 + 0.5 / factor))


@pytest.mark.parametrize("body", [None, ElasticBody(0.5, 1e-3), ElasticBody(0.3, 1e-2)])
def test_the_grid_it_asks_for_resolves_the_law(body):
    told = doubt(problem(512, ATTRACTION, body), None)
    nodes = int(told.rpartition("at least ")[2].split()[0])
    assert nodes > 512
    assert resolution(problem(nodes, ATTRACTION, body)) <= COARSEST
    assert doubt(problem(nodes, ATTRACTION, body), None) == ""


def pull_off(nodes):
    """Largest tension of a wave on a slab of height 1, drawn back in short steps, and x."""
    law, x = Interactions(True, ExponentialLaw(WORK, 2 * RANGE)), np.arange(nodes) / nodes
    body = stiffness.slab(grid.wavenumbers(nodes), 0.3, 1.0)
    before, most = None, 0.0
    for displacement in np.arange(-0.04, -0.12, -5e-4):
        punch = (AMPLITUDE * (1 - np.cos(2 * np.pi * x)) - displacement)[np.newaxis]
        if before is None:  # on the branch in contact
            punch_in = punch - 0.04
            before = equilibrate(punch_in, body, None, OPTIONS, law)
        before = equilibrate(punch, body, None, OPTIONS, law, following(before, punch, 0.0))
        assert before.status[0] == 0
        most = max(most, -before.pressure.mean())
    return most, law.softening / body[-1]


OPTIONS = Options("truncated_newton", residual=1e-6)


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


def test_pull_off_of_a_wave_is_off_by_what_x_says():
    """Johnson, Int. J. Solids Struct. 32:423 (1995): p = p* sin^2 psi - (2 E* w tan psi / L_x)^(1/2)."""
    psi = np.linspace(1e-3, 0.6, 100001)
    exact = -(np.pi * AMPLITUDE * np.sin(psi) ** 2 - np.sqrt(2 * WORK * np.tan(psi))).min()
    found = {x: tension / exact - 1 for tension, x in map(pull_off, (128, 256, 512, 1280))}
    np.testing.assert_allclose(list(found), [1.865, 0.933, 0.466, 0.187], rtol=3e-3)
    np.testing.assert_allclose(list(found.values())[:3], [0.93, 0.28, 0.053], rtol=0.05)
    assert all((abs(error) < 0.01) == (x < COARSEST) for x, error in found.items())


def first_pull_off(nodes, work, tabor):
    """Largest tension on the branch that is drawn back from first touch, and x."""
    stretch = (work**2 / (4 * np.pi**2 * AMPLITUDE)) ** (1 / 3)
    law = ExponentialLaw(work, stretch / tabor)
    body = stiffness.slab(grid.wavenumbers(nodes), 0.3, 1.0)
    punch, before, most = AMPLITUDE * (1 - np.cos(2 * np.pi * np.arange(nodes) / nodes))[np.newaxis], None, 0.0
    while before is None or before.touching.any():
        start = None if before is None else following(before, punch, 0.0)
        before = equilibrate(punch, body, None, OPTIONS, Interactions(True, law), start)
        assert before.status[0] == 0
        most, punch = max(most, -before.pressure.mean()), punch + min(stretch / 50, law.length / 4)
    return most, law.softening / body[-1]


@pytest.mark.parametrize(("tabor", "nodes"), [(0.5, 64), (1, 64), (2, 256), (4.9, 1280)])
def test_where_no_warning_is_given_pull_off_is_that_of_a_fine_grid(tabor, nodes):
    (coarse, x), (fine, _) = (first_pull_off(each, WORK, tabor) for each in (nodes, 4 * nodes))
    assert x < COARSEST
    assert coarse == pytest.approx(fine, rel=0.01)


@pytest.mark.parametrize(("tabor", "off"), [(0.5, -0.117), (1, -0.039), (2, -0.008), (4.9, 0.0)])
def test_pull_off_tends_to_that_of_a_short_range(tabor, off):
    """Johnson's closed form is the limit of large Tabor parameters, and is not to be had at small ones."""
    psi = np.linspace(1e-3, 1.2, 100001)
    exact = -(np.pi * AMPLITUDE * np.sin(psi) ** 2 - np.sqrt(2 * WORK * np.tan(psi))).min()
    assert first_pull_off(2048 if tabor > 4 else 512, WORK, tabor)[0] / exact - 1 == pytest.approx(off, abs=2e-3)


def test_pull_off_tends_to_that_of_a_rigid_body():
    """The mean of the law's traction over a wave that touches in one point is a Bessel function."""
    tabor, stretch = 0.02, (WORK**2 / (4 * np.pi**2 * AMPLITUDE)) ** (1 / 3)
    length = stretch / tabor
    exact = WORK / length * ive(0, AMPLITUDE / length)
    assert first_pull_off(128, WORK, tabor)[0] == pytest.approx(exact, rel=1e-3)


def in_units(length, modulus, gradient, range_, random):
    """One dimensionless adhesive scene in units of its own: file, and heights where they are not random."""
    roughness = {"method": "psd", "hurst": 0.8, "rms_gradient": gradient}
    if not random:
        heights = gradient * length * np.cos(2 * np.pi * np.arange(128) / 128) / (np.sqrt(2) * np.pi)
        roughness = {"method": "measured", "heights": heights, "units": {"z": "m"}}
    scale = gradient * length
    law = {"work_of_adhesion": 1e-2 * gradient * scale * modulus / (1 - 0.3**2), "range": range_ * scale}
    file = {
        "scene": {
            "length": length,
            "body": {"youngs_modulus": modulus, "poissons_ratio": 0.3, "aspect_ratio": 0.5},
            "roughness": roughness,
            "interface": {"hard_wall": {}, "exponential": law},
            "loading": {"displacement": 0.1 * scale},
        }
    }
    return file | ({"discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1}} if random else {})


UNITS = [(1.0, 1.0, 0.1), (1.0, 1.0, 0.01), (1e-4, 2.1e11, 0.1), (1e-4, 2.1e11, 0.01), (37.0, 3e-3, 0.1)]


def read(*scene):
    return read_contact(*load_scene(in_units(*scene)))


@pytest.mark.parametrize("random", [True, False], ids=["random", "array"])
@pytest.mark.parametrize(("range_", "x"), [(0.02, 0.1243), (0.01, 0.4974)])
def test_a_verdict_knows_no_units_and_no_gradient(range_, x, random):
    given = [read(*units, range_, random) for units in UNITS]
    problems = [load_path(each).problems[0] for each in given]
    np.testing.assert_allclose([resolution(each) for each in problems], x, rtol=1e-3)
    (said,) = {doubt(problem, each.file.discretisation) for problem, each in zip(problems, given, strict=True)}
    assert (said == "") == (x < COARSEST)
    if random:  # heights of an array that is multiplied by a number are rounded anew
        assert len({each.identity for each in problems}) == 1


@pytest.mark.parametrize("random", [True, False], ids=["random", "array"])
@pytest.mark.parametrize("units", UNITS)
def test_a_refusal_knows_no_units_and_no_gradient(units, random):
    with pytest.raises(InputError, match="each node would snap into contact on its own"):
        read(*units, 0.005, random)


def test_a_map_is_told_by_the_shortest_wave_along_an_axis():
    surface = RandomSurface(SelfAffineWaves(0.8, 2, 32), 128, 1, dimension=2)
    of_map = Problem(surface, ElasticBody(None, None), ATTRACTION, 0.1, None, Options("truncated_newton"))
    assert resolution(of_map) == resolution(problem(128, ATTRACTION))
    assert "over 8 % too large at 0.9. Take at least 4776 points both ways" in doubt(of_map, None)
    assert "over 25 % too large at 0.9. Take at least 4776 points, " in doubt(problem(128, ATTRACTION), None)
