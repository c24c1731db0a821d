"""Kernels of body and law in parallel against dense algebra."""

import numpy as np
import pytest

from gfmd_numba import kernels
from support.kernel_twins import both


@pytest.mark.parametrize("solve", both(kernels.parallel_solve))
def test_displacements_are_those_of_dense_algebra(solve, rng):
    """Nodes whose own compliance is zero do not move."""
    n, distance = 20, abs(np.arange(20)[:, np.newaxis] - np.arange(20))
    rates, weights, own = np.geomspace(0.02, 3.0, 8), rng.random((2, 8)), rng.random((2, n))
    own[0, 3:6] = 0.0
    keep, lower, share, t = np.exp(-rates)[np.newaxis], np.empty((2 * n, 8)), np.empty((2, n)), np.empty((2, n))
    carried = np.empty((8, 8))
    r, d = rng.normal(size=n + 25), np.full(n + 25, np.nan)
    for c in range(2):
        decays = kernels.Decays(rates, np.exp(-np.outer(np.arange(2), rates)), weights[c], 0.3, 1e-9)
        factors = kernels.Factors(np.empty((n, 8)), lower[c * n : (c + 1) * n], share[c], carried)
        kernels.exponential_sum_factor(decays, factors, np.arange(n), n, n, own[c])
    solve(r, 25, own, weights, kernels.Factors(keep, lower, 1.0 / share, carried), t, d)
    for c, part in enumerate((slice(0, n), slice(25, n + 25))):
        body = np.linalg.inv((weights[c] * np.exp(-rates * distance[..., np.newaxis])).sum(axis=-1) + 0.3 * np.eye(n))
        moves = own[c] > 0.0
        stiffness = body + np.diag(1.0 / np.where(moves, own[c], 1e-14))
        np.testing.assert_allclose(d[part][moves], np.linalg.solve(stiffness, r[part] * moves)[moves], rtol=1e-8)
        assert (d[part][~moves] == 0.0).all()
