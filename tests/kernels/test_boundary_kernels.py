"""Kernels of prescribed tractions and displacements against plain NumPy twins."""

import numpy as np
import pytest

from gfmd_numba import kernels


@pytest.mark.parametrize("compiled", [True, False])
def test_kernels_of_boundaries_are_their_plain_twins(compiled):
    rng = np.random.default_rng(0)
    u, old, ku, traction = rng.normal(size=(4, 2, 16))
    free, excess, n = rng.random((2, 16)) < 0.6, np.array([0.0, 0.3]), 13
    step, mean, violation = (
        kernel if compiled else getattr(kernel, "py_func", kernel)
        for kernel in (kernels.prescribed_step, kernels.free_mean, kernels.prescribed_violation)
    )
    boundary = kernels.Boundary(traction, free, excess)
    real = free & (np.arange(16) < n)
    force = traction - ku - excess[:, None]
    assert mean(ku, boundary, 1, n) == pytest.approx((traction - ku)[1, real[1]].mean())
    assert violation(ku, boundary, n) == pytest.approx((abs(force[real]).max(), abs(ku + excess[:, None])[:, :n].max()))
    new, kept = np.where(real, u + 0.8 * (u - old) + 0.1 * force, u), np.where(real, u, old)
    step(u, old, ku, boundary, n, 0.8, 0.1)
    np.testing.assert_allclose(u, new)
    np.testing.assert_array_equal(old, kept)
    balanced = np.where(free, ku + excess[:, None], traction)
    assert violation(ku, kernels.Boundary(balanced, free, excess), n) == (
        0.0,
        pytest.approx(abs(ku + excess[:, None])[:, :n].max()),
    )
    ku[1, 3] = np.nan
    assert np.isnan(violation(ku, boundary, n)[0])
