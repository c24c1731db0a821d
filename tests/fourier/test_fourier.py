"""The convention of transforms, planned ones, their count, and their independence of the batch."""

import numpy as np
import pytest

from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform, padded

SHAPES = [(8,), (9,), (6, 8), (7, 9), (8, 7), (49, 6)]


def _sum_of_waves(coefficients, shape):
    """The second formula of the convention, written out."""
    signal = np.zeros(shape)
    place = [np.arange(n) / n for n in shape]
    weight = np.broadcast_to(grid.multiplicity(shape[-1]), coefficients.shape)
    indices = np.broadcast_arrays(*grid.wave_indices(shape))
    for wave in np.ndindex(coefficients.shape):
        phase = sum(k[wave] * x for k, x in zip(indices, np.meshgrid(*place, indexing="ij"), strict=True))
        signal += weight[wave] * (coefficients[wave] * np.exp(2j * np.pi * phase)).real
    return signal


@pytest.mark.parametrize("shape", SHAPES)
def test_a_signal_is_the_sum_of_its_waves_and_their_mirror_images(shape):
    signal = np.random.default_rng(0).normal(size=shape)
    waves = grid.coefficients(signal, len(shape))
    assert waves.flat[0].real == pytest.approx(signal.mean())
    np.testing.assert_allclose(_sum_of_waves(waves, shape), signal, atol=1e-13)
    np.testing.assert_allclose(grid.signal(waves, *shape), signal, atol=1e-13)


@pytest.mark.parametrize("shape", SHAPES)
def test_parsevals_theorem_counts_each_kept_wave_as_often_as_its_multiplicity(shape):
    signal = np.random.default_rng(1).normal(size=(2, *shape))
    power = grid.multiplicity(shape[-1]) * abs(grid.coefficients(signal, len(shape))) ** 2
    axes = tuple(range(1, 1 + len(shape)))
    np.testing.assert_allclose(power.sum(axis=axes), (signal**2).mean(axis=axes))


@pytest.mark.parametrize("shape", SHAPES)
def test_wave_vectors_are_two_pi_over_the_period_times_the_wave_indices(shape):
    lengths = (0.3, 2.0)[-len(shape) :]
    vectors, indices = grid.wavevectors(shape, lengths), grid.wave_indices(shape)
    for q, k, length in zip(vectors, indices, lengths, strict=True):
        np.testing.assert_allclose(q, 2 * np.pi * k / length, rtol=1e-15)
    np.testing.assert_allclose(grid.magnitudes(shape, lengths) ** 2, sum(q**2 for q in vectors) + 0 * indices[-1])


def test_wave_indices_find_the_waves_of_a_coarser_grid():
    signal = np.cos(2 * np.pi * (2 * np.arange(12)[:, np.newaxis] / 12 - np.arange(16) / 16))
    coarse = grid.coefficients(signal, 2)[grid.wave_indices((6, 8))]
    np.testing.assert_allclose(coarse, grid.coefficients(signal[::2, ::2], 2), atol=1e-15)


def test_the_sine_at_nyquist_vanishes_on_every_node():
    wave = np.zeros(5, dtype=complex)
    wave[4] = 1j
    np.testing.assert_array_equal(grid.signal(wave, 8), 0.0)


def test_a_derivative_multiplies_by_the_wave_number_and_a_quarter_turn():
    x = np.arange(9) / 9
    found = grid.signal(grid.derivative(grid.coefficients(np.sin(6 * np.pi * x))), 9)
    np.testing.assert_allclose(found, 6 * np.pi * np.cos(6 * np.pi * x), atol=1e-12)


@pytest.mark.parametrize("shape", SHAPES)
def test_influence_coefficients_are_the_answer_to_one_unit_at_the_origin(shape):
    unit = np.zeros(shape)
    unit.flat[0] = 1.0
    symbol = 1.0 + grid.magnitudes(shape)
    expected = grid.signal(symbol * grid.coefficients(unit, len(shape)), *shape)
    np.testing.assert_allclose(grid.influence(symbol, *shape), expected, atol=1e-13)


@pytest.mark.parametrize("n", [4, 7, 64, 101])
def test_convolution_is_multiplication_in_fourier_space(n):
    rng = np.random.default_rng(0)
    field, symbol = Transform(3, n, sources=2), rng.normal(size=n // 2 + 1)
    field.sources[1][:, :n] = signal = rng.normal(size=(3, n))
    field.apply(field.symbol(symbol), np.array([0, 2]), source=1)
    expected = grid.signal(symbol * grid.coefficients(signal), n)
    np.testing.assert_allclose(field.result[[0, 2], :n], expected[[0, 2]], atol=1e-14)
    assert not field.result[1].any()
    np.testing.assert_array_equal(field.sources[1][:, :n], signal)
    assert field.n_transforms.tolist() == [2, 0, 2]


@pytest.mark.parametrize("shape", [(8, 6), (5, 7), (16, 16), (12, 64)])
def test_convolution_of_maps_is_multiplication_in_fourier_space(shape):
    rng = np.random.default_rng(0)
    field, symbol = Transform(3, *shape), rng.normal(size=(shape[0], shape[1] // 2 + 1))
    signal = rng.normal(size=(3, *shape))
    field.sources[0][:, : field.n] = signal.reshape(3, -1)
    field.apply(field.symbol(symbol), np.array([0, 2]))
    expected = grid.signal(symbol * grid.coefficients(signal, 2), *shape).reshape(3, -1)
    np.testing.assert_allclose(field.result[[0, 2], : field.n], expected[[0, 2]], atol=100 * np.finfo(float).eps)
    assert not field.result[1].any()


@pytest.mark.parametrize("nx", [16, 64, 510, 512, 1024])
def test_rows_of_maps_are_an_odd_number_of_cache_lines(nx):
    row = padded(nx // 2 + 1)
    assert row * 16 % 128 == 64
    assert 0 <= row - (nx // 2 + 1) < 128 // 16


@pytest.mark.parametrize("n", [30, 64, 101])
def test_a_row_does_not_know_its_batch(n):
    signal, symbol = np.random.default_rng(0).normal(size=(5, n)), np.arange(n // 2 + 1.0)
    whole = Transform(5, n)
    whole.sources[0][:, :n] = signal
    whole.apply(whole.symbol(symbol), np.arange(5))
    for i in range(5):
        alone = Transform(1, n)
        alone.sources[0][:, :n] = signal[i]
        alone.apply(alone.symbol(symbol), np.arange(1))
        np.testing.assert_array_equal(alone.result[0], whole.result[i])


@pytest.mark.parametrize("odd", [False, True])
def test_half_a_period_says_what_the_whole_one_does(odd):
    half = np.random.default_rng(0).normal(size=(3, 9))
    if odd:
        half[:, [0, -1]] = 0.0
    whole = np.concatenate((half, (-1 if odd else 1) * half[:, -2:0:-1]), axis=1)
    waves = np.fft.rfft(whole)
    np.testing.assert_allclose(grid.of_half_a_period(half, 1, odd), -waves.imag if odd else waves.real, atol=1e-13)
    np.testing.assert_allclose(grid.of_half_a_period(half.T, 0, odd), grid.of_half_a_period(half, 1, odd).T)
