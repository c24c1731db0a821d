"""The active-set Newton method: its preconditioner against dense algebra, its contacts, and how little it takes."""

from dataclasses import replace

import numpy as np
import pytest
import slab_stiffness
from scipy.linalg import eigh, null_space

from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers import table
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.exponential_sums.exponential_sum import ExponentialSum
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options

HALF_SPACE = (None, None)
BODIES = [HALF_SPACE, (0.0, 10.0), (0.33, 0.1), (0.49, 1e-2), (0.5, 0.1), (0.5, 1e-2), (0.5, 1e-4)]


def body(n, nu, aspect_ratio):
    q = grid.wavenumbers(n)
    return stiffness.half_space(q) if nu is None else slab_stiffness.slab(q, nu, aspect_ratio)


def solve(punch, body, load, solver="active_set_newton"):
    return equilibrate(punch, SpectralResponse.of_normal(body), load, Options(solver, max_iterations=20_000))


def assert_same(one, other):
    assert (one.status == Status.ok).all()
    assert (other.status == Status.ok).all()
    np.testing.assert_array_equal(one.touching, other.touching)
    largest = other.pressure.max(axis=1, keepdims=True)
    np.testing.assert_allclose(one.pressure / largest, other.pressure / largest, atol=1e-6)


@pytest.mark.parametrize(("nu", "aspect_ratio"), BODIES)
def test_an_exponential_sum_is_close_to_the_compliance_on_any_nodes(nu, aspect_ratio):
    """A condition number below two, whatever the nodes."""
    n, rng = 512, np.random.default_rng(1)
    compliance = np.concatenate(([0.0], 1.0 / body(n, nu, aspect_ratio)[1:]))
    matrix = np.fft.irfft(compliance, n)
    preconditioner = ExponentialSum(compliance, n)
    # one node in ten, one stretch, clusters across the end of the period
    sets = [rng.random(n) < 0.1, abs(np.arange(n) - 300) < 40, np.isin(np.arange(n) % 64, [0, 1, 2, 5, 63])]
    for chosen in sets:
        nodes = np.flatnonzero(chosen)
        nodes = np.roll(nodes, -1 - int(np.argmax(np.diff(nodes, append=nodes[0] + n))))
        preconditioner.factor(nodes, len(nodes))
        inverse = np.empty((len(nodes), len(nodes)))
        for column, unit in zip(inverse, np.eye(len(nodes)), strict=True):
            preconditioner.solve(unit, column)
        np.testing.assert_allclose(inverse, inverse.T, rtol=1e-6, atol=1e-6 * abs(inverse).max())
        restricted = matrix[(nodes[:, np.newaxis] - nodes) % n]
        balanced = null_space(np.ones((1, len(nodes))))
        ratios = eigh(
            balanced.T @ restricted @ balanced, balanced.T @ np.linalg.inv(inverse) @ balanced, eigvals_only=True
        )
        assert ratios.max() < 2.0 * ratios.min()  # conjugate gradients then gain a digit in 1.3 iterations


@pytest.mark.parametrize(("hurst", "load"), [(0.8, 1e-6), (0.0, 0.3), (0.8, 3.0)])
@pytest.mark.parametrize(("nu", "aspect_ratio"), [HALF_SPACE, (0.33, 0.05), (0.5, 0.01)])
def test_contacts_are_those_of_conjugate_gradients(hurst, load, nu, aspect_ratio):
    for n in (1021, 1024):
        heights = self_affine.SelfAffineWaves(hurst, 2, 255).heights((n,), 1, range(2))
        punch = heights.max(axis=1, keepdims=True) - heights
        both = [
            solve(punch, body(n, nu, aspect_ratio), load, solver)
            for solver in ("active_set_newton", "conjugate_gradients")
        ]
        assert_same(*both)
        assert (both[0].n_transforms < 200).all()


@pytest.mark.parametrize("load", [1e-5, 1e-2, 1.0, 100.0])
def test_flat_punches_and_vertical_walls_are_solved_as_by_conjugate_gradients(load):
    n = 600
    x = np.arange(n) / n
    rough = self_affine.SelfAffineWaves(0.5, 2, 150).heights((n,), 1, range(1))[0]
    plateaus = np.minimum(rough, np.quantile(rough, 0.7))
    punch = np.stack([np.where(x < 0.3, 0.0, 1.0), np.where(x < 0.3, 10.0, 0.0) - rough, -plateaus])
    punch -= punch.min(axis=1, keepdims=True)
    assert_same(
        solve(punch, body(n, *HALF_SPACE), load), solve(punch, body(n, *HALF_SPACE), load, "conjugate_gradients")
    )


@pytest.mark.parametrize(("nu", "aspect_ratio"), BODIES[1:5])
@pytest.mark.parametrize("depth", [1e-3, 0.5])
def test_a_prescribed_displacement_is_solved_as_by_conjugate_gradients(nu, aspect_ratio, depth):
    n = 512
    heights = self_affine.SelfAffineWaves(0.8, 2, 128).heights((n,), 1, range(2))
    punch = heights.max(axis=1, keepdims=True) - heights
    punch -= depth * punch.mean(axis=1, keepdims=True)
    slab = body(n, nu, aspect_ratio)
    assert_same(solve(punch, slab, None), solve(punch, slab, None, "conjugate_gradients"))


def test_a_punch_that_does_not_touch_has_no_pressure():
    slab = body(512, 0.3, 1.0)
    result = solve(np.full((1, 512), 0.1), slab, None)
    assert result.status[0] == Status.ok
    assert result.pressure.max() == 0.0


@pytest.mark.parametrize("solver", ["active_set_newton", "conjugate_gradients"])
def test_an_incompressible_slab_has_no_room_below_the_mean_of_the_punch(solver):
    heights = self_affine.SelfAffineWaves(0.8, 2, 64).heights((256,), 1, range(1))
    punch = heights.max() - heights
    for share, status in ((0.5, Status.ok), (1.01, Status.no_equilibrium)):
        assert solve(punch - share * punch.mean(), body(256, 0.5, 0.3), None, solver).status[0] == status


def test_transforms_hardly_grow_with_the_grid():
    hurst, medians = 0.3, []
    for n in (2**11, 2**13, 2**15, 2**17):
        heights = self_affine.SelfAffineWaves(hurst, 2, n // 4).heights((n,), 2018, range(max(1, 2**15 // n)))
        result = solve(heights.max(axis=1, keepdims=True) - heights, body(n, *HALF_SPACE), 0.007)
        assert (result.status == Status.ok).all()
        medians.append(np.median(result.n_transforms))
    assert max(medians) < 100
    assert max(medians) < 2 * min(medians)


def test_conjugate_gradients_take_over(monkeypatch):
    heights = self_affine.SelfAffineWaves(0.3, 2, 255).heights((1024,), 1, range(3))
    punch = heights.max(axis=1, keepdims=True) - heights
    alone = solve(punch, body(1024, *HALF_SPACE), 0.007, "conjugate_gradients")
    hasty = replace(table.SOLVERS["active_set_newton"], gives_up_after=1)
    monkeypatch.setitem(table.SOLVERS, "active_set_newton", hasty)
    result = solve(punch, body(1024, *HALF_SPACE), 0.007)
    np.testing.assert_array_equal(result.pressure, alone.pressure)
    np.testing.assert_array_equal(result.n_iterations, alone.n_iterations + 1)
    assert (result.n_transforms > alone.n_transforms).all()
