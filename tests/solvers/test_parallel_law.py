"""Body and law in parallel on ever coarser grids: an inverse that leaves few iterations to do."""

import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import diagonal
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.parallel_law import ParallelLaw

BODIES = {"half-space": ElasticBody(0.3, None), "slab": ElasticBody(0.2, 0.05), "thick slab": ElasticBody(0.3, 1.0)}


@pytest.mark.parametrize("shape", [(64,), (15, 12)], ids=["profile", "map"])
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES.keys())
@pytest.mark.parametrize("strength", [-0.02, 0.0, 1.0, 1e3])
def test_it_is_close_to_the_inverse_whichever_nodes_the_law_holds(shape, body, strength):
    """Eigenvalues of the product with the stiffness lie near 1, but for that of the softest wave."""
    rng, n = np.random.default_rng(0), int(np.prod(shape))
    response = body.response(shape).restored()
    compliances = diagonal(response.inverse())
    law = strength * shape[-1] * (rng.random((len(compliances), n)) < 0.5)
    moves = rng.random(law.shape) < 0.8
    parallel, weight, room = ParallelLaw(compliances, shape), moves.astype(np.float64), np.empty(law.shape)
    parallel.factor(law, weight, room)
    found, nodes = np.empty((n, *law.shape)), np.arange(n)
    for each, one in zip(found, np.eye(n), strict=True):
        parallel.solve(weight, np.tile(one, (len(law), 1)), each)
    apart = np.stack(np.unravel_index(nodes, shape), axis=-1)
    for c, compliance in enumerate(compliances):
        row = grid.influence(1.0 / compliance, *shape)
        exact = row[tuple(np.moveaxis((apart[:, np.newaxis] - apart) % shape, -1, 0))] + np.diag(law[c])
        free = np.ix_(moves[c], moves[c])
        ratios = np.sort(np.linalg.eigvals(found[:, c][free] @ exact[free]).real)
        assert ratios[0] > 0.3
        assert ratios[-2] < 3.0
        assert ratios[-1] < 5.0
