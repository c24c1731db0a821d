"""Body and law in parallel: an inverse that leaves hardly an iteration to do."""

import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.exponential_sums import parallel_law
from gfmd_numba.solvers.exponential_sums.parallel_law import ParallelLaw
from gfmd_numba.solvers.table import Options
from support.laws import surface

N, SECOND = 64, 72


BODIES = {"half-space": ElasticBody(0.3, None), "slab": ElasticBody(0.2, 0.05), "thick slab": ElasticBody(0.3, 1.0)}


@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES.keys())
@pytest.mark.parametrize("strength", [0.0, 1.0, 1e3])
def test_it_is_close_to_the_inverse_whichever_nodes_the_law_holds(body, strength):
    """Eigenvalues of the product with the stiffness lie near 1, but for those of the cut, where the period is open."""
    rng = np.random.default_rng(0)
    stiffness = body.response((N,))
    law, moves = np.zeros((2, SECOND + N))
    law[:N], law[SECOND:] = strength * N * (rng.random((2, N)) < 0.5)
    moves[:N], moves[SECOND:] = rng.random((2, N)) < 0.8
    compliances = []
    for k in (stiffness.elements[0], stiffness.normal):
        k[0] = k[0] if k[0] > 0.0 else k[1:].min()
        compliances.append(1.0 / k)
    parallel = ParallelLaw(tuple(compliances), N, SECOND)
    assert parallel.is_safe
    parallel.factor(law, moves)
    inverse = np.zeros((SECOND + N, SECOND + N))
    for j in np.flatnonzero(moves):
        parallel.solve(np.eye(SECOND + N)[j], inverse[:, j])
    for part, compliance in zip((slice(0, N), slice(SECOND, SECOND + N)), compliances, strict=True):
        free = np.flatnonzero(moves[part]) + part.start
        row = grid.signal(1.0 / compliance / N, N)
        exact = row[(np.arange(N)[:, np.newaxis] - np.arange(N)) % N] + np.diag(law[part])
        exact = exact[np.ix_(free - part.start, free - part.start)]
        ratios = np.linalg.eigvals(inverse[np.ix_(free, free)] @ exact).real
        assert ratios.min() > 0.3
        assert ratios.max() < 4.0
        assert (abs(ratios - 1.0) > 0.1).sum() <= 4


def test_without_it_the_compliance_alone_leads_to_the_same_contact(monkeypatch):
    """As on fewer nodes than decays, or where decays of both signs are not positive definite."""
    assert not ParallelLaw((np.ones(5), np.ones(5)), 8, 8).is_safe
    punch, body = surface(256)[0], ElasticBody(0.2, None).response((256,))
    laws, exact = Interactions(True, cohesive=XuNeedlemanLaw(2e-3, 2e-2, 4e-2)), Options("truncated_newton", 1e-10)
    found = equilibrate(punch, body, 0.05, exact, laws)
    monkeypatch.setattr(parallel_law, "_FEWEST", 1000)
    other = equilibrate(punch, body, 0.05, exact, laws)
    assert (other.status == 0).all()
    assert (found.n_transforms < other.n_transforms).all()
    np.testing.assert_allclose(found.pressure, other.pressure, atol=1e-8 * other.pressure.max())
