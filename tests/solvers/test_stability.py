"""The smallest curvature of the energy: that of dense matrices, 0 at the fold of a closed form."""

import numpy as np
import pytest
import scipy.linalg
import slab_stiffness

from gfmd_numba.contact.jumps import smallest_curvature
from gfmd_numba.elasticity import stiffness
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw


@pytest.mark.parametrize("nodes", [16, 64, 63])
@pytest.mark.parametrize("work", [0.02, 0.002])
@pytest.mark.parametrize("free_mean", [True, False])
def test_it_is_the_smallest_eigenvalue_of_the_free_nodes(nodes, work, free_mean):
    rng = np.random.default_rng(nodes)
    gap, law = np.maximum(rng.normal(0.1, 0.1, nodes), 0.0), ExponentialLaw(work, 0.05)
    body = slab_stiffness.slab(grid.wavenumbers(nodes), 0.3, 0.5)
    alone = body.copy()
    if free_mean:
        body[0], alone[0] = 0.0, body[1:].min()
    held, every = gap == 0.0, np.eye(nodes)
    assert held.any()
    dense = [
        np.fft.irfft(k[:, None] * np.fft.rfft(every, axis=0), nodes, axis=0)[~held][:, ~held] for k in (body, alone)
    ]
    hessian = dense[0] + np.diag(law.stiffness(gap)[~held])
    expected = scipy.linalg.eigh(hessian, dense[1], eigvals_only=True)[0]
    assert smallest_curvature(gap, held, body, law) == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize("nodes", [8, 128])
def test_a_flat_punch_is_at_the_fold_where_the_law_softens_as_the_slab_stiffens(nodes):
    body, law = slab_stiffness.slab(grid.wavenumbers(nodes), 0.2, 0.1), ExponentialLaw(0.2, 0.05)
    fold = law.length * np.log(law.softening / body[0])
    for gap in (fold, fold + 0.05):
        found = smallest_curvature(np.full(nodes, gap), np.zeros(nodes, dtype=bool), body, law)
        assert found == pytest.approx(1.0 - np.exp((fold - gap) / law.length), abs=1e-5)


def test_nothing_moves_where_all_nodes_are_held():
    held, body = np.ones(8, dtype=bool), stiffness.half_space(grid.wavenumbers(8))
    assert smallest_curvature(np.zeros(8), held, body, ExponentialLaw(0.2, 0.05)) == 1.0
