"""Newton's method for a cohesive law: its energy never rises, and it ends where damped dynamics does, sooner."""

import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import begin, equilibrate, following
from gfmd_numba.solvers.iteration import Batch, Start
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from support.laws import surface

LAW = XuNeedlemanLaw(2e-3, 2e-2, 4e-2)
NEWTON = Options("truncated_newton")
WALL = pytest.mark.parametrize("hard_wall", [True, False], ids=["wall", "law alone"])


def energy(u1, u3, punch, body, load, law, sliding=0.0):
    """Mean energy per area of body, law and load, from Fourier coefficients `[x]`."""
    c1, c3 = grid.coefficients(u1), grid.coefficients(u3)
    k33 = np.where(np.isfinite(body.normal), body.normal, 0.0)
    waves = body.elements[0] * np.abs(c1) ** 2 + k33 * np.abs(c3) ** 2 - 2.0 * body.elements[1] * (c1.conj() * c3).imag
    elastic = 0.5 * (grid.multiplicity(len(u1)) * waves).sum()
    return elastic + law.energy(punch - u3, sliding - u1).mean() - load * u3.mean()


def violation(found, punch, body, load, law, hard_wall, sliding=0.0):
    """Largest violated condition of the first row over the largest traction, by NumPy's transforms."""
    u1, u3, n = found.tangential.displacement[0, 0], found.displacement[0], punch.shape[1]
    c1, c3 = np.fft.rfft(u1), np.fft.rfft(u3)
    shear = np.fft.irfft(body.elements[0] * c1 + 1j * body.elements[1] * c3, n)
    gap, slip = punch[0] - u3, sliding - u1
    pull, drag = law.normal_traction(gap, slip), law.tangential_traction(gap, slip)
    wall = load - np.fft.irfft(body.normal * c3 - 1j * body.elements[1] * c1, n) + pull
    touching = (gap <= 0.0) & hard_wall
    assert not (hard_wall and (gap < 0.0).any())
    worst = max(np.where(touching, -wall, np.abs(wall)).max(), np.abs(shear - drag).max())
    return worst / max(wall.max(), np.abs(pull).max(), np.abs(drag).max())


@WALL
@pytest.mark.parametrize("load", [0.05, None], ids=["load", "displacement"])
def test_the_energy_never_rises_and_ends_in_equilibrium(hard_wall, load):
    punch, body = surface(256)[0][:1], ElasticBody(0.2, 0.5).response((256,))
    if load is None:
        punch = punch - 0.02
    else:
        body = body.with_mean(0.0)
    laws, loads = Interactions(hard_wall, cohesive=LAW), None if load is None else np.array([load])
    solver, energies = begin(Batch(punch, body, loads, laws, Start.at_rest(punch), 0.01), NEWTON), []
    row = np.zeros(1, dtype=np.int64)
    for _ in range(60):
        residual = solver.residual(row)
        u1, u3 = solver.state.u[0, :, :256]
        energies.append(energy(u1, u3, punch[0], body, load or 0.0, LAW, 0.01))
        if residual[0] <= 1e-8:
            break
        solver.advance(row)
    assert (np.diff(energies) <= 1e-13 * np.abs(energies).max()).all()
    assert len(energies) > 3
    found = equilibrate(punch, body, load, NEWTON, laws, sliding=0.01)
    assert found.status[0] == 0
    assert violation(found, punch, body, load or 0.0, LAW, hard_wall, 0.01) <= 1e-8


@WALL
def test_a_rough_contact_is_that_of_the_dynamics(hard_wall):
    punch, body = surface()[0], ElasticBody(0.2, None).response((512,))
    laws = Interactions(hard_wall, cohesive=LAW)
    newton, verlet = (
        equilibrate(punch, body, 0.05, Options(solver, residual=1e-9), laws)
        for solver in ("truncated_newton", "verlet")
    )
    assert (newton.status == 0).all()
    np.testing.assert_allclose(newton.pressure, verlet.pressure, atol=1e-7 * verlet.pressure.max())
    scale = np.abs(verlet.tangential.traction).max()
    np.testing.assert_allclose(newton.tangential.traction, verlet.tangential.traction, atol=1e-7 * scale)
    assert (2 * newton.n_transforms < verlet.n_transforms).all()


def test_the_last_steps_converge_as_those_of_newton_do():
    """With a part of the law's second derivatives wrong or left out it takes 8 to 300 steps."""
    punch, body = surface()[0] - 0.02, ElasticBody(0.2, 0.5).response((512,))
    laws, exact = Interactions(True, cohesive=LAW), Options("truncated_newton", 1e-11, max_iterations=100)
    first = equilibrate(punch, body, None, exact, laws, sliding=0.03)
    found = equilibrate(punch - 1e-3, body, None, exact, laws, following(first, punch - 1e-3, 0.031), 0.031)
    assert (first.n_iterations <= 9).all()
    assert (found.n_iterations <= 7).all()


@pytest.mark.long
def test_one_more_load_on_a_fine_grid_takes_below_a_tenth_of_the_transforms_of_the_dynamics():
    heights = self_affine.SelfAffineWaves(0.8, 2, 128).heights((2048,), 4, range(2))
    punch, body = heights.max(axis=1, keepdims=True) - heights, ElasticBody(0.3, None).response((2048,))
    laws = Interactions(True, cohesive=XuNeedlemanLaw(2e-3, 1e-3, 3e-3))
    first = equilibrate(punch, body, 0.02, NEWTON, laws)
    spent = []
    for solver in ("truncated_newton", "verlet"):
        found = equilibrate(punch, body, 0.021, Options(solver), laws, following(first, punch, 0.0))
        assert (found.status == 0).all()
        spent.append(found.n_transforms)
    assert (10 * spent[0] < spent[1]).all()
    assert spent[0].max() < 300


def test_a_body_that_is_dragged_keeps_what_carries_it():
    """Repulsion of surfaces that overlap does not decay with slip: no load pushes one through the other."""
    punch, body = surface(256)[0][:1], ElasticBody(0.3, 0.3).response((256,))
    laws, before = Interactions(False, cohesive=XuNeedlemanLaw(2e-4, 3e-3, 5e-3)), None
    for sliding in (0.0, 0.01, 0.1):
        start = None if before is None else following(before, punch, sliding)
        before = equilibrate(punch, body, 0.05, NEWTON, laws, start, sliding)
        assert before.status[0] == 0
        assert violation(before, punch, body.with_mean(0.0), 0.05, laws.cohesive, False, sliding) <= 1e-8
    assert ((punch - before.displacement) / 3e-3).min() > -4.0
    assert ((sliding - before.tangential.displacement) / 5e-3).max() > 3.0  # far past what the law resists


@pytest.mark.parametrize(
    "laws",
    [
        Interactions(True, ExponentialLaw(2e-4, 1e-2)),
        Interactions(False, ExponentialLaw(-2e-3, 1e-2)),
        Interactions(True, cohesive=LAW),
        Interactions(False, cohesive=LAW),
    ],
    ids=["attraction", "repulsion", "cohesive with a wall", "cohesive"],
)
@pytest.mark.parametrize("displacement", [-0.02, 0.05])
def test_a_rigid_mean_is_that_of_a_body_that_is_almost_incompressible(laws, displacement):
    """The stiffness of the mean displacement is infinite, or 1e7."""
    punch, body = surface(256)[0] - displacement, ElasticBody(0.5, 0.3)
    rigid, almost = body.response((256,)), body.response((256,))
    almost.normal[0] = 1e7
    if not laws.couples:
        rigid, almost = rigid.condensed(), almost.condensed()
    assert rigid.is_rigid
    held, loose = (equilibrate(punch, stiffness, None, NEWTON, laws, sliding=0.004) for stiffness in (rigid, almost))
    assert (held.status == 0).all()
    assert (loose.status == 0).all()
    peak = np.abs(loose.pressure).max(axis=1)
    assert (np.abs(held.displacement.mean(axis=1)) * 128 * np.pi <= 1.1e-8 * peak).all()
    np.testing.assert_allclose(held.pressure, loose.pressure, atol=1e-5 * peak.max())
    np.testing.assert_allclose(held.displacement, loose.displacement, atol=1e-6)


@pytest.mark.parametrize("solver", ["truncated_newton", "verlet", "fire"])
def test_a_weak_attraction_across_a_wide_gap_is_solved_for_itself(solver):
    """Tractions are exp(-20) of the law's strength: to the first order the body follows them undeformed."""
    n, law = 64, ExponentialLaw(2e-3, 1e-2)
    punch = 0.2 + 0.01 * (1.0 - np.cos(2.0 * np.pi * np.arange(n) / n))[np.newaxis]
    body = ElasticBody(0.3, 0.5).condensed_stiffness(grid.wavenumbers(n))
    found = equilibrate(punch, SpectralResponse.of_normal(body), None, Options(solver), Interactions(True, law))
    assert found.status[0] == 0
    expected = grid.signal(grid.coefficients(law.traction(punch[0])) / body, n)
    np.testing.assert_allclose(found.displacement[0], expected, rtol=1e-6)


def test_dynamics_that_diverges_says_so_by_its_status_alone():
    """Numbers overflow in the law then, which NumPy would warn of."""
    heights = self_affine.SelfAffineWaves(0.8, 2, 128).heights((2048,), 4, range(1, 2))
    laws = Interactions(False, cohesive=XuNeedlemanLaw(1e-4 * np.pi * 1.024 * np.e**2, 1e-3, 3e-3))
    body = ElasticBody(0.3, None).response((2048,))
    for raised in (0.0, 0.01, 0.03):
        found = equilibrate(heights.max() - raised - heights, body, 0.02, Options("verlet"), laws)
        assert found.status[0] == Status.nonfinite
