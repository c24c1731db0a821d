"""The preconditioner below stiff coatings, whose compliance no sum of decays with weights of one sign is close to."""

import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.exponential_sums.exponential_sum import ExponentialSum, RestrictedStiffness

N = 256
COATED = ElasticBody.layered((0.02,), (Material(1.0, 0.2),), Material(0.01, 0.4)).condensed_stiffness(
    grid.wavenumbers(N)
)
HALF_SPACE = 0.5 * grid.wavenumbers(N)


def compliance(stiffness):
    return np.concatenate(([0.0], N / stiffness[1:]))


def dense(stiffness):
    """Stiffness matrix of all nodes, whose mean is as stiff as the longest wave."""
    symbol = np.concatenate((stiffness[1:2], stiffness[1:]))
    distance = np.arange(N)[:, np.newaxis] - np.arange(N)
    return (grid.signal(symbol.astype(complex), N) / N)[distance % N]


def test_decays_are_positive_for_a_half_space_and_below_a_stiff_coating_only_with_a_gap_at_the_cut():
    for stiffness, count, positive in ((HALF_SPACE, N, True), (COATED, N, False), (COATED, N // 2, True)):
        decays = ExponentialSum(compliance(stiffness), N)
        decays.factor(np.arange(N), count)
        assert decays.is_positive == positive


@pytest.mark.parametrize("share", [0.05, 0.5, 1.0])
def test_the_inverse_is_the_stiffness_between_the_nodes(share):
    rng = np.random.default_rng(1)
    count = int(share * N)
    nodes = np.full(N, -1)
    nodes[:count] = np.sort(rng.permutation(N)[:count])
    inverse = RestrictedStiffness(np.concatenate(([0.0], COATED[1:])), N)
    inverse.factor(nodes, count)
    u, p = rng.standard_normal(count), np.full(N, 7.0)
    inverse.solve(u, p)
    np.testing.assert_allclose(p[:count], dense(COATED)[np.ix_(nodes[:count], nodes[:count])] @ u, rtol=1e-10)
    assert (p[count:] == 7.0).all()
    assert u @ p[:count] > 0.0
    assert inverse.transforms == 2
