"""Kernels of sums over ever coarser grids against NumPy's interpolation and dense algebra."""

import numpy as np
import pytest

from gfmd_numba import kernels
from gfmd_numba.solvers.parallel_law import ParallelLaw
from support.kernel_twins import both

SHAPES = pytest.mark.parametrize("shapes", [((6, 8), (3, 4)), ((5, 7), (3, 4)), ((1, 9), (1, 5)), ((4, 6), (4, 3))])


def places(fine, coarse):
    """Where each row and column lies on a coarser grid, by plain division."""
    for n, m in zip(fine, coarse, strict=True):
        at = np.arange(n) * m / n
        yield from (np.floor(at).astype(np.int64), at - np.floor(at))


def between(values, nodes, axis):
    """Periodic values at equal steps of a period, linear between their nodes, by NumPy."""
    n = values.shape[axis]
    return np.apply_along_axis(
        lambda line: np.interp(np.arange(nodes) * n / nodes, np.arange(n), line, period=n), axis, values
    )


@SHAPES
@pytest.mark.parametrize("kernel", both(kernels.to_finer))
def test_a_finer_grid_has_what_is_linear_between_nodes(kernel, shapes, rng):
    fine, coarse = shapes
    values, found = rng.normal(size=coarse), rng.normal(size=fine)
    expected = found + between(between(values, fine[0], 0), fine[1], 1)
    kernel(values, found, tuple(places(*shapes)))
    np.testing.assert_allclose(found, expected, atol=1e-14)


@SHAPES
@pytest.mark.parametrize("kernel", both(kernels.to_coarser))
def test_a_coarser_grid_has_means_by_the_transpose_of_that(kernel, shapes, rng):
    fine, coarse = shapes
    values, weights, found, back = rng.normal(size=fine), rng.normal(size=coarse), np.empty(coarse), np.zeros(fine)
    kernel(values, found, tuple(places(*shapes)))
    kernels.to_finer(weights, back, tuple(places(*shapes)))
    assert (found * weights).mean() == pytest.approx((values * back).mean())
    assert found.mean() == pytest.approx(values.mean())


@pytest.mark.parametrize("stiffness", [0.0, 3.0, -0.1])
@pytest.mark.parametrize("shape", [(8, 16), (8,)])
def test_body_and_law_are_in_parallel_for_a_uniform_traction(stiffness, shape):
    """Compliances of all grids then add up to that of the coarsest, 2, with the law beside it; of the finest to 1/3."""
    law, n = ParallelLaw(np.full((1, *shape[:-1], shape[-1] // 2 + 1), 1.0 / 3.0), shape), int(np.prod(shape))
    compliances, weight, weights = np.linspace(1.0 / 3.0, 2.0, len(law._grids.shapes)), np.ones(n), law._weights[0]
    kernels.parallel_compliance(law._grids, compliances, np.full(n, stiffness), weight, weights, law._room)
    np.testing.assert_allclose(weight, 1.0 / (3.0 + max(stiffness, 0.0)))
    found = np.empty(n)
    kernels.comply_in_parallel(law._grids, weight, weights, np.ones(n), found, law._room)
    first = 1.0 / (3.0 + stiffness) - weight  # where a law softens, the finest grid does as if it did not
    np.testing.assert_allclose(found, 1.0 / (0.5 + stiffness) - first)


@pytest.mark.parametrize("solve", both(kernels.comply_in_parallel))
def test_what_nodes_do_to_each_other_is_symmetric_and_positive(solve, rng):
    shape, n = (6, 10), 60
    law = ParallelLaw(1.0 / (1.0 + rng.random((1, 6, 6))), shape)
    stiffness, weight = rng.normal(size=(1, n)), (rng.random((1, n)) < 0.7).astype(np.float64)
    free = weight[0] > 0.0
    law.factor(stiffness, weight, np.empty((1, n)))
    matrix = np.empty((n, n))
    for j, one in enumerate(np.eye(n)):
        solve(law._grids, weight[0], law._weights[0], one, matrix[j], law._room)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-15)
    assert np.linalg.eigvalsh(matrix[np.ix_(free, free)]).min() > 0.1
