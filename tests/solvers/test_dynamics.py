"""Time step and damping against the scheme's own amplification matrix; how runs end."""

import dataclasses

import numpy as np
import pytest

from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.certificate import pressure_scale
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from gfmd_numba.theory import damping

SOLVERS = ["verlet", "gronbech_jensen", "fire", "conjugate_gradients", "active_set_newton"]


def amplification(k, dt, eta):
    """Largest modulus of the eigenvalues of one step on a mode of stiffness k."""
    matrix = np.array([[2 - dt**2 * (k + eta), -(1 - eta * dt**2)], [1.0, 0.0]])
    return abs(np.linalg.eigvals(matrix)).max()


@pytest.mark.parametrize("k", [0.01, 1.0, 300.0])
def test_critical_damping_has_a_double_root(k):
    dt = 0.3 / np.sqrt(k)
    eta = damping.critical_damping(k, dt)
    assert amplification(k, dt, eta) == pytest.approx(1 - dt * np.sqrt(k), abs=1e-7)
    assert amplification(k, dt, 1.1 * eta) > amplification(k, dt, eta) + 1e-3
    assert amplification(k, dt, 0.9 * eta) > amplification(k, dt, eta) + 1e-3


@pytest.mark.parametrize("zeta", [0.0, 0.5, 1.0, 3.0, 100.0])
@pytest.mark.parametrize("softest", [1e-3, 1.0, 900.0, 1000.0])
def test_stability_limit_is_where_a_mode_starts_to_grow(zeta, softest):
    stiffest = 1000.0
    limit = damping.stability_limit(softest, stiffest, zeta)

    def growth(dt):
        eta = zeta * damping.critical_damping(softest, dt)
        return max(amplification(k, dt, eta) for k in (softest, stiffest))

    assert growth(0.999 * limit) <= 1 + 1e-12
    assert growth(1.001 * limit) > 1 + 1e-6


def scene(nx=256, rows=4, hurst=0.5):
    heights = self_affine.SelfAffineWaves(hurst, 2, nx // 4).heights((nx,), 5, range(rows))
    return heights.max(axis=1, keepdims=True) - heights, stiffness.half_space(grid.wavenumbers(nx))


@pytest.mark.parametrize("solver", SOLVERS)
def test_members_of_a_batch_end_on_their_own(solver):
    """Each member stops when it is done, and its numbers do not depend on its neighbours."""
    punch, body = scene()
    punch *= np.array([[0.01], [0.1], [1.0], [10.0]])  # from full contact to a few spots
    numerics = Options(solver)
    batch = equilibrate(punch, SpectralResponse.of_normal(body), 0.05, numerics)
    assert (batch.status == Status.ok).all()
    assert len(set(batch.n_transforms)) > 1
    for i in range(len(punch)):
        alone = equilibrate(punch[i : i + 1], SpectralResponse.of_normal(body), 0.05, numerics)
        for field in dataclasses.fields(batch):
            whole = getattr(batch, field.name)
            if field.name != "wall_time" and whole is not None:  # of an effect that is absent
                np.testing.assert_array_equal(getattr(alone, field.name)[0], whole[i])


def test_transforms_are_those_of_the_algorithm():
    """Verlet: one pair a step and one before the first. Conjugate gradients: two pairs, and one per check.

    The last check also opens the gap, which every other one leaves to the next iteration.
    """
    punch, body = scene()
    result = equilibrate(punch, SpectralResponse.of_normal(body), 0.05, Options("verlet"))
    np.testing.assert_array_equal(result.n_transforms, 2 * (result.n_iterations + 1))
    result = equilibrate(punch, SpectralResponse.of_normal(body), 0.05, Options("conjugate_gradients"))
    np.testing.assert_array_equal(result.n_transforms, 4 * result.n_iterations + 2 * (result.n_iterations // 10) + 2)


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_certificate_is_recomputed_independently(solver):
    punch, body = scene()
    result = equilibrate(punch, SpectralResponse.of_normal(body), 0.05, Options(solver))
    assert (result.residual <= 1e-8).all()
    traction = 0.05 - grid.signal(body * grid.coefficients(result.displacement), punch.shape[1])
    touching = result.displacement == punch
    assert (result.displacement <= punch).all()
    violation = np.where(touching, np.maximum(-traction, 0.0), abs(traction)).max(axis=1)
    imbalance = abs(result.pressure.mean(axis=1) / 0.05 - 1)
    expected = np.maximum(violation / result.pressure.max(axis=1), imbalance)
    np.testing.assert_allclose(result.residual, expected, rtol=1e-3, atol=1e-12)
    full_contact = grid.signal(body * grid.coefficients(punch), punch.shape[1])
    np.testing.assert_allclose(pressure_scale(punch, SpectralResponse.of_normal(body)), full_contact.std(axis=1))
    np.testing.assert_allclose(result.pressure, np.where(touching, np.maximum(traction, 0), 0), atol=1e-12)
    np.testing.assert_allclose(result.pressure.mean(axis=1), 0.05, rtol=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_too_few_iterations_are_not_converged(solver):
    punch, body = scene()
    few = 1 if solver == "active_set_newton" else 13
    result = equilibrate(punch, SpectralResponse.of_normal(body), 0.05, Options(solver, max_iterations=few))
    assert (result.status == Status.steps_used_up).all()
    assert (result.residual > 1e-8).all()
    assert (result.n_iterations == few).all()


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_nonfinite_member_ends_alone(solver):
    punch, body = scene()
    punch[1, 7] = np.nan
    result = equilibrate(punch, SpectralResponse.of_normal(body), 0.05, Options(solver))
    assert result.status.tolist() == [Status.ok, Status.nonfinite, Status.ok, Status.ok]


def test_a_step_beyond_the_limit_is_reported_unstable():
    punch, body = scene()
    beyond = Options("verlet", time_step=1.05)
    result = equilibrate(punch, SpectralResponse.of_normal(body), 0.05, beyond)
    assert (result.status == Status.unstable).all()
    assert (result.growing_wave > 0.9 * (len(body) - 1)).all()  # those stiffer than 1/1.05^2 of the last
    assert equilibrate(punch, SpectralResponse.of_normal(body), 0.05, Options("verlet")).growing_wave is None
