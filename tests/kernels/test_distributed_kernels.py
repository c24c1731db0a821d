"""The compiled loop over the nodes in contact of a slab."""

import numpy as np
import pytest
from scipy.ndimage import convolve

from gfmd_numba import kernels
from support.kernel_twins import both


@pytest.mark.parametrize("kernel", both(kernels.near_tractions))
def test_near_tractions_are_a_convolution_that_is_periodic_along_x(kernel, rng):
    stencil, displacement = rng.normal(size=(3, 3)), rng.normal(size=(6, 5))
    stencil += stencil[::-1, ::-1]
    nodes, found = np.array([0, 4, 7, 19]), np.empty(4)
    kernel(stencil, displacement, nodes, found)
    expected = convolve(displacement, stencil, mode="wrap")[1:-1].ravel()[nodes]
    np.testing.assert_allclose(found, expected, rtol=1e-12)
