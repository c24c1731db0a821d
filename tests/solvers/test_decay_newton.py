"""Contacts of profiles on a sum of decays: those of conjugate gradients, for a handful of transforms."""

from dataclasses import replace

import numpy as np
import pytest
import slab_stiffness
from scipy.linalg import eigh

from gfmd_numba import kernels
from gfmd_numba.elasticity import free_body, stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers import table
from gfmd_numba.solvers.active_set_newton import ActiveSetNewton
from gfmd_numba.solvers.equilibrium import begin, equilibrate
from gfmd_numba.solvers.exponential_sums.newton import DecayNewton, decay_model
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Start
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options

NEWTON = Options("active_set_newton")


def punches(hurst, n, seed, rows=2, least=2):
    heights = self_affine.SelfAffineWaves(hurst, least, n // 4).heights((n,), seed, range(rows))
    return heights.max(axis=1, keepdims=True) - heights


def drawn(seed):
    """A punch, a body and either load or displacement, at random."""
    rng = np.random.default_rng(seed)
    n = int(rng.choice([300, 511, 1000, 1024, 1021, 2187, 4096]))
    q, slab = grid.wavenumbers(n), rng.random() < 0.6
    nu, aspect = float(rng.choice([0.0, 0.3, 0.49, 0.5])), 10.0 ** rng.uniform(-3.0, 1.0)
    body = slab_stiffness.slab(q, nu, aspect) if slab else stiffness.half_space(q)
    punch = punches(float(rng.choice([0.0, 0.3, 0.5, 0.8, 1.0])), n, seed, least=int(rng.choice([1, 2, 8])))
    if slab and rng.random() < 0.4:
        return punch - 10.0 ** rng.uniform(-3.0, -0.1) * punch.mean(axis=1, keepdims=True), body, None
    return punch, body, 10.0 ** rng.uniform(-6.0, 0.7)


@pytest.mark.parametrize("seed", range(12))
def test_the_contact_is_that_of_conjugate_gradients(seed):
    punch, body, load = drawn(seed)
    found = equilibrate(punch, SpectralResponse.of_normal(body), load, NEWTON)
    expected = equilibrate(
        punch, SpectralResponse.of_normal(body), load, Options("conjugate_gradients", max_iterations=20_000)
    )
    assert (found.status == Status.ok).all()
    assert (expected.status == Status.ok).all()
    np.testing.assert_array_equal(found.touching, expected.touching)
    largest = expected.pressure.max(axis=1, keepdims=True)
    np.testing.assert_allclose(found.pressure / largest, expected.pressure / largest, atol=1e-6)


@pytest.mark.parametrize("hurst", [0.3, 0.8])
@pytest.mark.parametrize("n", [2**10, 2**13, 2**15])
def test_a_contact_takes_at_most_eight_pairs_of_transforms(hurst, n):
    result = equilibrate(
        punches(hurst, n, 2018, 4), SpectralResponse.of_normal(stiffness.half_space(grid.wavenumbers(n))), 0.007, NEWTON
    )
    assert (result.status == Status.ok).all()
    assert (result.n_transforms <= 16).all()


def test_a_prescribed_displacement_takes_no_more_transforms_than_a_load():
    n = 1024
    punch, body = punches(0.8, n, 1), slab_stiffness.slab(grid.wavenumbers(n), 0.3, 0.1)
    pressed = equilibrate(punch - 0.2 * punch.mean(), SpectralResponse.of_normal(body), None, NEWTON)
    assert (pressed.status == Status.ok).all()
    assert (pressed.n_transforms <= 16).all()


def test_no_digit_depends_on_the_batch():
    n = 1000
    punch, body = punches(0.5, n, 7, 6), stiffness.half_space(grid.wavenumbers(n))
    together = equilibrate(punch, SpectralResponse.of_normal(body), 0.02, NEWTON)
    for row in (0, 3, 5):
        alone = equilibrate(punch[row : row + 1].copy(), SpectralResponse.of_normal(body), 0.02, NEWTON)
        for name in ("displacement", "pressure", "residual", "n_transforms", "n_iterations"):
            np.testing.assert_array_equal(getattr(alone, name)[0], getattr(together, name)[row])


@pytest.mark.parametrize("residual", [1e-3, 1e-6, 1e-10])
def test_the_certificate_holds_whatever_the_residual_asked_for(residual):
    n = 1024
    body, punch = stiffness.half_space(grid.wavenumbers(n)), punches(0.3, n, 3, 4)
    result = equilibrate(punch, SpectralResponse.of_normal(body), 0.05, Options("active_set_newton", residual=residual))
    assert (result.residual <= residual).all()
    spectrum = grid.coefficients(result.displacement) * body
    spectrum[:, 0] = 0.0
    traction = 0.05 - grid.signal(spectrum, n)
    off = np.where(result.displacement >= punch, np.minimum(traction, 0.0), traction)
    assert (abs(off).max(axis=1) <= 1.01 * residual * traction.max(axis=1)).all()
    assert (result.displacement <= punch).all()


@pytest.mark.parametrize("n", [255, 1024, 2**13, 2**17])
@pytest.mark.parametrize("free_mean", [True, False])
def test_decays_are_close_to_the_compliance_at_all_wave_numbers(n, free_mean):
    """The transform of the model's product with one node is the compliance."""
    body = slab_stiffness.slab(grid.wavenumbers(n), 0.3, 0.5)
    if free_mean:
        body[0] = 0.0
    model = decay_model(body, n, free_mean)
    count = min(n, 4096)
    source, product = np.zeros((2, n))
    source[0] = 1.0
    fine = kernels.DecaySum(model.powers, model.powers, model.weights, model.white, model.mean)
    kernels.decay_product(np.ones(n, dtype=np.int64), n, fine, source, product)
    symbol = np.fft.rfft(product).real[1:count]
    np.testing.assert_allclose(symbol * body[1:count], 1.0, atol=max(2.0 * model.error, 1e-5))
    assert model.error < 2e-3
    if not free_mean:
        assert product.sum() * body[0] == pytest.approx(1.0, abs=1e-6)


def test_a_model_is_made_once_for_a_body_and_a_grid():
    body = stiffness.half_space(grid.wavenumbers(512))
    assert decay_model(body, 512, True) is decay_model(body.copy(), 512, True)
    assert decay_model(2.0 * body, 512, True) is not decay_model(body, 512, True)


@pytest.mark.parametrize("free_mean", [True, False])
def test_decays_in_a_window_are_those_of_the_half_space_itself(free_mean):
    """As energies of pressures in the window, which have no mean if that is free, beside the kernel that ends."""
    n = 256
    response = free_body.response((n,), ElasticBody(None, None))
    model = decay_model(response.normal, 2 * n, free_mean, response.window)
    products, next_nodes = np.empty((n, n)), np.ones(n, dtype=np.int64)
    fine = kernels.DecaySum(model.powers, model.powers, model.weights, model.white, model.mean)
    for source, product in zip(np.eye(n), products, strict=True):
        kernels.decay_product(next_nodes, n, fine, source, product)
    kernel = grid.influence(1.0 / response.normal, 2 * n)
    exact = kernel[abs(np.arange(n)[:, np.newaxis] - np.arange(n))]
    some = np.linalg.svd(np.ones((1, n)))[2][1:] if free_mean else np.eye(n)
    shares = eigh(some @ products @ some.T, some @ exact @ some.T, eigvals_only=True)
    assert max(shares.max() - 1.0, 1.0 - shares.min()) < 2.0 * model.error
    assert model.error < 1e-3


def test_a_run_cut_short_says_how_far_it_came():
    n = 1024
    punch = punches(0.3, n, 1)
    short = Options("active_set_newton", max_iterations=1)
    result = equilibrate(punch, SpectralResponse.of_normal(stiffness.half_space(grid.wavenumbers(n))), 0.01, short)
    assert (result.status == Status.steps_used_up).all()
    assert np.isfinite(result.residual).all()
    assert (result.displacement <= punch + 1e-15).all()


def test_conjugate_gradients_take_over_where_decays_do_not_converge(monkeypatch):
    n = 512
    hasty = replace(table.SOLVERS["active_set_newton"], gives_up_after=1)
    monkeypatch.setitem(table.SOLVERS, "active_set_newton", hasty)
    result = equilibrate(
        punches(0.3, n, 1), SpectralResponse.of_normal(stiffness.half_space(grid.wavenumbers(n))), 0.01, NEWTON
    )
    assert (result.status == Status.ok).all()
    assert (result.n_iterations > 1).all()


def test_profiles_are_solved_by_decays_and_bodies_far_from_them_are_not():
    n = 256
    punch = punches(0.8, n, 1)
    for body, by_decays in (
        (stiffness.half_space(grid.wavenumbers(n)), True),
        (np.resize([1.0, 9.0], n // 2 + 1), False),
    ):
        stiff = body.copy()
        stiff[0] = 0.0
        solver = begin(
            Batch(punch, SpectralResponse.of_normal(stiff), np.full(2, 0.01), HARD_WALL, Start.at_rest(punch)), NEWTON
        )
        assert isinstance(solver, DecayNewton) == by_decays


def test_dense_and_sparse_contacts_of_a_batch_do_not_know_of_each_other(monkeypatch):
    """Dense ones are found by transforms, as sums over decays would cost more there."""
    n, load = 2048, 0.01
    punch, body = punches(0.8, n, 2018, 4), stiffness.half_space(grid.wavenumbers(n))
    punch *= np.array([[1.0], [0.02], [0.5], [0.04]])
    solved = []
    monkeypatch.setattr(
        "gfmd_numba.solvers.exponential_sums.newton.ActiveSetNewton.advance",
        lambda self, active, advance=ActiveSetNewton.advance: (solved.append(active.size), advance(self, active)),
    )
    together = equilibrate(punch, SpectralResponse.of_normal(body), load, NEWTON)
    assert (together.status == Status.ok).all()
    assert solved
    for i in range(4):
        alone = equilibrate(punch[i : i + 1], SpectralResponse.of_normal(body), load, NEWTON)
        np.testing.assert_array_equal(alone.displacement[0], together.displacement[i])
        np.testing.assert_array_equal(alone.pressure[0], together.pressure[i])
        assert alone.n_transforms[0] == together.n_transforms[i]
        expected = equilibrate(punch[i : i + 1], SpectralResponse.of_normal(body), load, Options("conjugate_gradients"))
        np.testing.assert_array_equal(alone.touching, expected.touching)
