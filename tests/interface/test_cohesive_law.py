"""The law of gap and slip: consistent derivatives, balance of forces, shearing off, and friction with adhesion."""

import numpy as np
import pytest
from mpmath import exp, mpf, workdps
from scipy.special import lambertw

from gfmd_numba import kernels
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options
from support.kernel_twins import both
from support.laws import nearly_flat, surface

COHESION = XuNeedlemanLaw(0.3, 0.2, 0.4)


def test_cohesive_tractions_are_derivatives_of_the_energy():
    gap, slip = np.meshgrid(np.linspace(-0.2, 1.0, 9), np.linspace(-0.8, 0.8, 9))
    law, h = COHESION, 1e-6
    normal = (law.energy(gap + h, slip) - law.energy(gap - h, slip)) / (2 * h)
    tangential = (law.energy(gap, slip + h) - law.energy(gap, slip - h)) / (2 * h)
    np.testing.assert_allclose(law.normal_traction(gap, slip), normal, atol=1e-9)
    np.testing.assert_allclose(law.tangential_traction(gap, slip), tangential, atol=1e-9)
    assert law.energy(0.0, 0.0) == -0.3
    peak = law.normal_traction(np.array(0.2), np.array(0.0))
    assert peak == pytest.approx(0.3 / 0.2 / np.e)


def test_cohesive_stiffness_is_the_derivative_of_the_tractions():
    gap, slip = np.meshgrid(np.linspace(-0.21, 1.0, 9), np.linspace(-0.8, 0.8, 9))  # no gap at 0, where it may jump
    law, h = COHESION, 1e-6
    tangential, both, normal = law.stiffness(gap, slip[np.newaxis])
    np.testing.assert_allclose(
        normal, -(law.normal_traction(gap - h, slip) - law.normal_traction(gap + h, slip)) / (2 * h), atol=1e-8
    )
    shear = [law.tangential_traction(gap, slip + sign * h) for sign in (1, -1)]
    np.testing.assert_allclose(tangential, (shear[0] - shear[1]) / (2 * h), atol=1e-8)
    pull = [law.normal_traction(gap, slip + sign * h) for sign in (1, -1)]
    np.testing.assert_allclose(both, (pull[0] - pull[1]) / (2 * h), atol=1e-8)


@pytest.mark.parametrize("step", [1.0, 1e-6, 1e-14])
def test_the_change_of_the_cohesive_energy_does_not_cancel(step):
    """Against mpmath, also where the surfaces come to overlap or cease to."""
    rng = np.random.default_rng(1)
    gap, slip = np.concatenate((rng.uniform(-0.3, 1.0, 40), rng.uniform(-0.3, 0.3, 40) * step)), rng.normal(size=80)
    closing, dragged = step * 0.3 * rng.normal(size=(2, 80))

    def exact(g, s, c, t):
        def energy(g, s):
            g, s = g / mpf(0.2), s / mpf(0.4)
            opened, overlap = max(g, 0), min(g, 0)
            return 1 - (1 + overlap) * exp(-overlap) - (1 + opened) * exp(-opened - s * s)

        with workdps(60):
            g, s, c, t = map(mpf, (g, s, c, t))
            return float(mpf(0.3) * (energy(g - c, s - t) - energy(g, s)))

    expected = [exact(*each) for each in zip(gap, slip, closing, dragged, strict=True)]
    found = COHESION.energy_change(gap, slip[np.newaxis], closing, dragged[np.newaxis])
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-14 * step)


def test_the_energy_comes_back_from_where_its_exponential_is_less_than_any_number():
    """From 40 tangential lengths, or a gap of 1000 normal ones, back to where the law acts, and away again."""
    gap, slip = np.array([0.1, 0.0, -0.1, 200.0, 0.1]), np.array([16.0, 16.0, -16.0, 16.0, 0.1])
    closing, dragged = np.array([0.02, 0.0, 0.05, 199.9, -200.0]), np.array([15.9, 16.0, -15.8, 15.9, -16.0])
    expected = COHESION.energy(gap - closing, slip - dragged) - COHESION.energy(gap, slip)
    np.testing.assert_allclose(
        COHESION.energy_change(gap, slip[np.newaxis], closing, dragged[np.newaxis]), expected, rtol=1e-12
    )


def test_overlapping_surfaces_repel_whatever_they_slip_and_resist_slip_as_at_zero_gap():
    slip, law = np.linspace(-2.0, 2.0, 9), COHESION
    np.testing.assert_array_equal(law.normal_traction(-0.1, slip), law.normal_traction(-0.1, 0.0))
    np.testing.assert_array_equal(law.tangential_traction(-0.5, slip), law.tangential_traction(0.0, slip))
    np.testing.assert_allclose(law.energy(-1e-12, slip), law.energy(1e-12, slip), atol=1e-12)


@pytest.mark.parametrize("pressure", [0.0, 1.0, 10.0])
def test_the_stiffness_of_the_cohesive_law_is_bounded(pressure):
    """Eigenvalues of its Hessian by finite differences, down to the gap at which it repels with the pressure."""
    law, h = COHESION, 1e-5
    deepest = -law.normal * lambertw(pressure * law.normal / law.work).real
    assert law.normal_traction(deepest, 0.0) == pytest.approx(-pressure, abs=1e-12)
    gap, slip = np.meshgrid(np.linspace(deepest, 2.0, 60), np.linspace(-1.5, 1.5, 61))
    nn = (law.normal_traction(gap + h, slip) - law.normal_traction(gap - h, slip)) / (2 * h)
    tt = (law.tangential_traction(gap, slip + h) - law.tangential_traction(gap, slip - h)) / (2 * h)
    nt = (law.normal_traction(gap, slip + h) - law.normal_traction(gap, slip - h)) / (2 * h)
    largest = np.linalg.eigvalsh(np.stack([np.stack([nn, nt], -1), np.stack([nt, tt], -1)], -1)).max()
    assert largest <= law.stiffest(pressure, hard_wall=False) * (1 + 1e-6)
    assert largest > 0.4 * law.stiffest(pressure, hard_wall=False)


def test_a_law_that_resists_slip_most_is_as_stiff_as_its_tractions_at_rest_and_their_coupling():
    """Both by finite differences, on a law whose tangential length is half its normal one."""
    law, h = XuNeedlemanLaw(0.3, 0.2, 0.1), 1e-6
    gap, slip = np.meshgrid(np.linspace(h, 1.0, 401), np.linspace(-0.3, 0.3, 401))
    at_rest = law.tangential_traction(0.0, h) / h
    coupling = abs(law.tangential_traction(gap + h, slip) - law.tangential_traction(gap - h, slip)).max() / (2 * h)
    assert law.stiffest(0.0, hard_wall=True) == pytest.approx(at_rest + coupling, rel=1e-4)


@pytest.mark.parametrize("kernel", both(kernels.xu_needleman_pull))
def test_the_cohesive_kernel_is_the_law(kernel):
    rng = np.random.default_rng(0)
    (u, ku), punch = rng.normal(size=(2, 3, 2, 16)), rng.normal(size=(3, 16))
    expected, rows = ku.copy(), [0, 2]
    dragged = np.linspace(-0.1, 0.2, 13)[np.newaxis]
    gap, slip = (punch - u[:, 1])[rows, :13], dragged - u[rows, 0, :13]
    expected[rows, 0, :13] -= COHESION.tangential_traction(gap, slip)
    expected[rows, 1, :13] -= COHESION.normal_traction(gap, slip)
    kernel(kernels.SurfaceState(u, ku, punch, np.zeros(3), u[:, :1]), punch, dragged, np.array(rows), 13, 0.3, 0.2, 0.4)
    np.testing.assert_allclose(ku, expected, rtol=1e-12)


def test_a_cohesive_contact_is_sheared_off(tmp_path):
    """An almost flat punch dragged sideways: the slab's spring in series with the law, which gives way."""
    work, normal, tangential = 0.02, 0.05, 0.1
    body = (1 - 0.3) / 2 / 0.1  # C44 / z_m in E*
    law = {"work_of_adhesion": work, "normal_length": normal, "tangential_length": tangential}
    slips = np.array([0.01, 0.03, 0.06, 0.071])
    pulls = 2 * work * slips / tangential**2 * np.exp(-((slips / tangential) ** 2))
    path = [{"sliding": float(slip + pull / body)} for slip, pull in zip(slips, pulls, strict=True)]
    result = nearly_flat(tmp_path, path, 0.0, hard_wall={}, cohesive=law)
    assert (result["status"] == 0).all()
    np.testing.assert_allclose(result["tangential_traction"].mean("x")[1:], pulls, rtol=1e-5)
    np.testing.assert_allclose(result["tangential_displacement"].mean("x")[1:], pulls / body, rtol=1e-5)


@pytest.mark.parametrize("hard_wall", [True, False])
def test_cohesive_forces_balance_on_a_rough_surface(hard_wall):
    punch, _ = surface()
    law = XuNeedlemanLaw(0.002, 0.02, 0.02)
    both = ElasticBody(0.2, None).response((punch.shape[1],))
    result = equilibrate(punch, both, 0.05, Options("verlet"), Interactions(hard_wall, cohesive=law))
    assert (result.status == 0).all()
    c1, c3 = grid.coefficients(result.tangential.displacement[:, 0]), grid.coefficients(result.displacement)
    f1 = grid.signal(both.elements[0] * c1 + 1j * both.elements[1] * c3, punch.shape[1])
    f3 = grid.signal(both.normal * c3 - 1j * both.elements[1] * c1, punch.shape[1])
    gap, slip = punch - result.displacement, -result.tangential.displacement[:, 0]
    wall = result.pressure + law.normal_traction(gap, slip)
    np.testing.assert_allclose(f1, law.tangential_traction(gap, slip), atol=2e-8)
    np.testing.assert_allclose(0.05 - f3 + law.normal_traction(gap, slip), wall, atol=2e-8)
    assert (wall > -1e-8).all()
    assert abs(wall).max() > 0.01 if hard_wall else abs(wall).max() < 1e-7


def test_adhesion_lets_an_unloaded_punch_rub(tmp_path):
    """An almost flat punch at its first touch: the wall presses as hard as the law pulls, and friction is on that."""
    work, length, friction = 0.02, 0.05, 0.3
    body, most = (1 - 0.3) / 2 / 0.1, 0.3 * 0.02 / 0.05  # C44 / z_m and the traction it slides at, in E*
    path = [{"sliding": 0.5 * most / body}, {"sliding": 3 * most / body}]
    law = {"work_of_adhesion": work, "range": length}
    result = nearly_flat(tmp_path, path, 0.0, hard_wall={}, exponential=law, friction={"coefficient": friction})
    assert (result["status"] == 0).all()
    np.testing.assert_allclose(result["pressure"], 0.0, atol=1e-6 * work / length)
    np.testing.assert_allclose(result["tangential_traction"].mean("x"), [0.0, 0.5 * most, most], rtol=1e-5, atol=1e-9)


@pytest.mark.parametrize("work", [0.002, -0.002])
def test_forces_of_law_and_friction_balance_on_a_rough_surface(work):
    punch, _ = surface()
    law, friction = ExponentialLaw(work, 0.02), 0.2
    both = ElasticBody(0.2, None).response((punch.shape[1],))
    result = equilibrate(punch, both, 0.05, Options("verlet"), Interactions(True, law, friction))
    assert (result.status == 0).all()
    c1, c3 = grid.coefficients(result.tangential.displacement[:, 0]), grid.coefficients(result.displacement)
    f1 = grid.signal(both.elements[0] * c1 + 1j * both.elements[1] * c3, punch.shape[1])
    f3 = grid.signal(both.normal * c3 - 1j * both.elements[1] * c1, punch.shape[1])
    pull = law.traction(punch - result.displacement)
    wall = result.pressure + pull
    np.testing.assert_allclose(0.05 - f3 + pull, wall, atol=2e-8)
    assert wall.min() > -1e-8
    np.testing.assert_array_equal(wall > 1e-8, result.touching)
    np.testing.assert_allclose(f1, result.tangential.traction[:, 0], atol=2e-8)
    assert (abs(f1) <= friction * wall + 2e-8).all()  # of the wall's pressure, not of what is left of it
    assert abs(f1).max() > 0.1 * friction * wall.max()
    assert (result.n_transforms == 4 * (result.n_iterations + 1)).all()  # as without the law
