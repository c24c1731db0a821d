"""Persson's theory: its limits, its moments, its diffusion, and simulated contacts from light to full contact."""

import numpy as np
import pytest
import slab_stiffness
from scipy.integrate import quad
from scipy.stats import norm

from gfmd_numba.contact import evaluation, solution
from gfmd_numba.contact.problem import Problem
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import statistics
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.table import Options
from gfmd_numba.theory import persson

HALF_SPACE, SLAB = ElasticBody(None, None), ElasticBody(0.33, 0.1)
SURFACES = 20


def press(hurst, body, load, surfaces=SURFACES):
    """Contacts in g E* of surfaces with 8 nodes to the shortest wave, and their measures."""
    numerics = Options("active_set_newton", residual=1e-8)
    surface = RandomSurface(SelfAffineWaves(hurst, 2, 256), 4096, 2018)
    pressed = solution.solve(Problem(surface, body, Interactions(True), load, None, numerics), range(surfaces))
    assert (pressed.equilibrium.status == 0).all()
    return pressed, evaluation.measure(pressed)


def test_perssons_area_is_right_at_light_load_and_full_contact():
    assert persson.contact_area_fraction(1e-8, 0.5) == pytest.approx(1e-8 * np.sqrt(8 / np.pi))  # kappa in p/(g E*)
    assert persson.contact_area_fraction(5.0, 0.5) == 1.0
    p = np.linspace(3.0, 7.0, 9)
    np.testing.assert_allclose(persson.pressure_density(p, 5.0, 0.5), norm.pdf(p, 5.0, 0.5), rtol=1e-12)


@pytest.mark.parametrize("mean", [1e-9, 1e-3, 0.1, 0.7, 3.0])
@pytest.mark.parametrize("s", [0.5, 2.0])
def test_area_and_mean_pressure_are_moments_of_the_density(mean, s):
    def moment(order):
        return quad(lambda p: p**order * persson.pressure_density(p, mean, s), 0.0, mean + 12 * s, epsabs=0.0)[0]

    assert moment(0) == pytest.approx(float(persson.contact_area_fraction(mean, s)), rel=1e-8)
    assert moment(1) == pytest.approx(mean, rel=1e-8)


def test_roughness_may_be_added_in_two_steps():
    """The density after s1 diffuses with s2 to that of sqrt(s1^2 + s2^2) (4.13)."""
    mean, s1, s2 = 0.3, 0.4, 0.7
    for p in (0.05, 0.4, 1.5):
        twice = quad(
            lambda before, p=p: persson.pressure_density(p, before, s2) * persson.pressure_density(before, mean, s1),
            0.0,
            6.0,
        )[0]
        assert twice == pytest.approx(float(persson.pressure_density(p, mean, np.hypot(s1, s2))), rel=1e-7)


def test_no_pressures_below_zero_and_arrays_broadcast():
    density = persson.pressure_density(np.linspace(-1.0, 1.0, 5), np.array([[0.1], [0.2]]), 0.5)
    assert density.shape == (2, 5)
    assert (density[:, :3] == 0.0).all()
    assert (density[:, 3:] > 0.0).all()


@pytest.mark.parametrize("body", [HALF_SPACE, SLAB, ElasticBody(0.5, 0.02)])
def test_full_contact_rms_pressure_is_that_of_simulated_full_contact(body):
    """Its rms fluctuation to rounding, g E*/2 on a half-space; and sum_q K^2 |h|^2 of arrays."""
    pressed, values = press(0.8, body, 1e3)
    assert pressed.equilibrium.touching.all()
    s = values["full_contact_rms_pressure"]
    np.testing.assert_allclose(pressed.equilibrium.pressure.std(axis=1), s, rtol=1e-6)
    q = grid.wavenumbers(4096)
    k = 0.5 * q if body is HALF_SPACE else slab_stiffness.slab(q, body.poissons_ratio, body.aspect_ratio)
    waves = grid.multiplicity(4096)[1:] * k[1:] ** 2 * statistics.power(pressed.heights)[:, 1:]
    np.testing.assert_allclose(s, np.sqrt(waves.sum(axis=1)), rtol=1e-12)
    if body is HALF_SPACE:
        np.testing.assert_allclose(s, 0.5, rtol=1e-12)


# Line contacts have more area than the theory says, the more so the lighter the load and the lower H. These ratios are
# of a half-space and nx = 16384 (benchmarks/persson_against_simulation.py; the slab's differ by up to 0.07); a quarter
# of their difference from 1 and three standard errors are allowed to the smaller surfaces and the slab here.
KNOWN = {0.3: (1.77, 1.46, 1.11, 1.013, 1.0), 0.8: (1.52, 1.26, 1.085, 1.011, 1.0)}


@pytest.mark.parametrize("body", [HALF_SPACE, pytest.param(SLAB, marks=pytest.mark.long)])
@pytest.mark.parametrize("hurst", [pytest.param(0.3, marks=pytest.mark.long), 0.8])
def test_simulated_area_is_perssons_times_a_known_ratio(hurst, body):
    for load, known in zip((0.007, 0.1, 0.5, 1.0, 3.0), KNOWN[hurst], strict=True):
        _, values = press(hurst, body, load, 10)
        expected = persson.contact_area_fraction(load, values["full_contact_rms_pressure"])
        ratio = values["contact_area_fraction"] / expected
        error = ratio.std(ddof=1) / np.sqrt(10)
        assert ratio.mean() == pytest.approx(known, abs=0.25 * (known - 1.0) + 3 * error + 1e-6)
        assert ratio.mean() >= 1.0 - 1e-9


@pytest.mark.long
@pytest.mark.parametrize(("hurst", "body"), [(0.3, HALF_SPACE), (0.8, SLAB)])
def test_simulated_pressures_are_distributed_nearly_as_perssons(hurst, body):
    """Half the integral of |difference|: 0.04 to 0.06 at p* = 0.5, and no more than scatter near full contact."""
    levels = np.linspace(0.0, 9.0, 91)
    middle, width = 0.5 * (levels[1:] + levels[:-1]), levels[1]
    distances = []
    for load in (0.5, 1.0, 3.0):
        pressed, values = press(hurst, body, load)
        s = values["full_contact_rms_pressure"][:, np.newaxis]
        found = (
            np.histogram((pressed.equilibrium.pressure / s)[pressed.equilibrium.touching], levels)[0] / s.size / 4096
        )
        theory = persson.pressure_density(middle, load / s, 1.0).mean(axis=0) * width
        distances.append(0.5 * abs(found - theory).sum())
    assert 0.03 < distances[0] < 0.08
    assert max(distances[1:]) < 0.02
