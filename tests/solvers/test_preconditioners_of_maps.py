"""Preconditioners of maps: positive definite, near and far, and few transforms on any grid."""

import numpy as np
import pytest

from gfmd_numba.contact import solution
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.solvers import two_level_preconditioner
from gfmd_numba.solvers.friction.linear_problem import NearTractions
from gfmd_numba.solvers.two_level_preconditioner import StencilPreconditioner, TwoLevelPreconditioner
from support.maps import body, problem


def test_neighbours_are_a_stencil_of_the_stiffness_that_is_positive_definite():
    shape, rng = (12, 16), np.random.default_rng(0)
    nodes = np.flatnonzero(rng.random(shape) < 0.5)
    for slab in (None, (0.5, 0.01), (0.3, 0.001)):
        symbol = body(shape, slab)
        inverse = StencilPreconditioner(symbol, shape)
        inverse.factor(nodes, len(nodes))
        matrix = np.empty((len(nodes), len(nodes)))
        for column, unit in zip(matrix, np.eye(len(nodes)), strict=True):
            inverse.solve(unit, column)
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-12 * matrix.max())
        assert np.linalg.eigvalsh(matrix).min() > 0.0
    symbol = body(shape)
    symbol[0, 0] = symbol[0, 1]
    near = np.fft.irfft2(symbol, shape)
    near[2:-1], near[:, 2:-1] = 0.0, 0.0
    inverse = StencilPreconditioner(body(shape), shape)
    inverse.factor(nodes, len(nodes))
    given, pressure = np.zeros(shape), np.empty(len(nodes))
    given.flat[nodes] = u = rng.normal(size=len(nodes))
    inverse.solve(u, pressure)
    expected = np.fft.irfft2(np.fft.rfft2(given) * np.fft.rfft2(near), shape).ravel()[nodes]
    np.testing.assert_allclose(pressure, expected, atol=1e-12)


def test_a_node_among_held_ones_is_as_stiff_as_all_waves_together():
    """A mean that hardly gives way, as that of a thin slab, counts no more than the longest wave."""
    response, moved = ElasticBody(0.4999, 0.05).response((8, 12)), np.zeros((8, 12))
    near, (xx, xy, yy, _, _, zz) = NearTractions(response, (8, 12)), response.inverse()
    along = np.linalg.inv(np.moveaxis(np.array([[xx, xy], [xy, yy]]), (0, 1), (-2, -1)))
    assert 1.0 / zz[0, 0] > 10.0 / zz[0, 1]
    moved[3, 5] = 1.0
    stiff = (0.5 * np.trace(along, axis1=-2, axis2=-1), near.tangential_of_a_node), (1.0 / zz, near.normal_of_a_node)
    for waves, found in stiff:
        waves[0, 0] = min(waves[0, 0], waves[0, 1])
        assert found == pytest.approx(np.fft.irfft2(np.fft.rfft2(moved) * waves, (8, 12))[3, 5])


def columns(inverse, nodes):
    inverse.factor(nodes, len(nodes))
    matrix = np.empty((len(nodes), len(nodes)))
    for column, unit in zip(matrix, np.eye(len(nodes)), strict=True):
        inverse.solve(unit, column)
    return matrix


@pytest.mark.parametrize("slab", [None, (0.3, 0.1)])
def test_far_away_contacts_are_taken_into_account_by_blocks(monkeypatch, slab):
    """Against dense algebra."""
    monkeypatch.setattr(two_level_preconditioner, "_TOLERANCE", 1e-12)
    monkeypatch.setattr(two_level_preconditioner, "_FEWEST", 32)
    shape, rng = (96, 64), np.random.default_rng(0)
    nodes = np.flatnonzero(np.kron(rng.random((48, 32)) < 0.05, np.ones((2, 2))))
    stiff = body(shape, slab)
    soft = np.divide(1.0, stiff, out=np.zeros_like(stiff), where=stiff > 0.0)
    near, far = (columns(method(stiff, shape), nodes) for method in (StencilPreconditioner, TwoLevelPreconditioner))
    y, x = np.divmod(nodes, 64)
    belongs = np.eye(96)[y // 8 * 8 + x // 8]
    rows = np.fft.fftfreq(12, 1 / 12).astype(int)
    smooth = np.fft.irfft2(soft[np.ix_(rows, np.arange(5))] / 64, (12, 8))
    smooth = np.array([np.roll(smooth, divmod(b, 8), axis=(0, 1)).ravel() for b in range(96)])
    shared = np.diag(near.sum(axis=1)) @ belongs
    expected = near - shared @ smooth @ np.linalg.inv(np.eye(96) + belongs.T @ shared @ smooth) @ shared.T
    np.testing.assert_allclose(far, expected, atol=1e-9 * near.max())
    assert np.linalg.eigvalsh(far).min() > 0.0


def test_newton_takes_few_transforms():
    few = solution.solve(problem(256, 0.01, 64), range(1)).equilibrium.n_transforms
    many = solution.solve(problem(256, 0.01, 64, "conjugate_gradients"), range(1)).equilibrium.n_transforms
    assert few[0] < 90
    assert few[0] < 0.5 * many[0]


def test_transforms_hardly_grow_with_the_map():
    taken = [solution.solve(problem(nx, 0.02, nx // 4), range(1)).equilibrium.n_transforms[0] for nx in (256, 512)]
    assert taken[1] < 1.2 * taken[0]
