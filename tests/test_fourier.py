"""The planned transforms: the convention, the count, and independence of the batch."""

import numpy as np
import pytest

from gfmd_numba.fourier import grid
from gfmd_numba.fourier.convolution import Convolution


@pytest.mark.parametrize("n", [4, 7, 64, 101])
def test_convolution_is_multiplication_in_fourier_space(n):
    rng = np.random.default_rng(0)
    field, symbol = Convolution(3, n, sources=2), rng.normal(size=n // 2 + 1)
    field.sources[1][:, :n] = signal = rng.normal(size=(3, n))
    field.apply(field.symbol(symbol), np.array([0, 2]), source=1)
    expected = grid.signal(symbol * grid.coefficients(signal), n)
    np.testing.assert_allclose(field.result[[0, 2], :n], expected[[0, 2]], atol=1e-14)
    assert not field.result[1].any()
    np.testing.assert_array_equal(field.sources[1][:, :n], signal)
    assert field.n_transforms.tolist() == [2, 0, 2]


@pytest.mark.parametrize("n", [30, 64, 101])
def test_a_row_does_not_know_its_batch(n):
    signal, symbol = np.random.default_rng(0).normal(size=(5, n)), np.arange(n // 2 + 1.0)
    whole = Convolution(5, n)
    whole.sources[0][:, :n] = signal
    whole.apply(whole.symbol(symbol), np.arange(5))
    for i in range(5):
        alone = Convolution(1, n)
        alone.sources[0][:, :n] = signal[i]
        alone.apply(alone.symbol(symbol), np.arange(1))
        np.testing.assert_array_equal(alone.result[0], whole.result[i])
