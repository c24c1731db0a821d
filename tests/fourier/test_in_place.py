"""Transforms of a map in place."""

import numpy as np
import pytest

from gfmd_numba.fourier import grid
from gfmd_numba.fourier.in_place import InPlaceTransform, storage


@pytest.mark.parametrize("shape", [(16, 16), (12, 10), (9, 7), (8, 64)])
@pytest.mark.parametrize(("dtype", "rounding"), [(np.float64, 1e-14), (np.float32, 1e-5)])
def test_stiffness_and_compliance_are_those_of_the_waves(shape, dtype, rounding):
    rng = np.random.default_rng(0)
    field = InPlaceTransform(shape, storage(1, shape, dtype)[0])
    samples, stiffness = rng.normal(size=shape), grid.magnitudes(shape) + 0.5
    stiffness[0, 0] = np.inf
    field.samples[:] = samples
    field.stiffen(stiffness)
    stiffness[0, 0] = 0.0
    expected = np.fft.irfft2(np.fft.rfft2(samples) * stiffness, shape)
    np.testing.assert_allclose(field.samples, expected, rtol=100 * rounding, atol=1e4 * rounding)
    field.soften(stiffness)
    np.testing.assert_allclose(field.samples, samples - samples.mean(), atol=30 * rounding)
    assert field.n_transforms == 4
    assert field.samples.dtype == dtype


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("nx", [64, 100, 1024, 4096])
def test_rows_are_an_odd_number_of_cache_lines(nx, dtype):
    made = storage(2, (3, nx), dtype)
    assert made.strides[1] % 128 == 64
    assert made.ctypes.data % 64 == 0
    assert made.shape[2] >= nx // 2 + 1
