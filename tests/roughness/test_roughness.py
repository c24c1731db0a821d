"""Self-affine profiles: the gradient asked for, the same surface on every grid, the spectrum of theory."""

import numpy as np
import pytest

from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine, statistics


@pytest.mark.parametrize("nx", [64, 96, 99, 4096])
@pytest.mark.parametrize("hurst", [0.0, 0.3, 1.0])
def test_rms_gradient_is_exact(nx, hurst):
    heights = self_affine.SelfAffineWaves(hurst, 2, 31).heights((nx,), 7, range(5))
    assert heights.shape == (5, nx)
    np.testing.assert_allclose(statistics.rms_gradient(heights), 1.0, rtol=1e-12)
    np.testing.assert_allclose(heights.mean(axis=1), 0.0, atol=1e-15)


@pytest.mark.parametrize("cut_off", [8, 32])  # 32: the shortest wave at Nyquist of the coarse grid
def test_a_finer_grid_samples_the_same_surface(cut_off):
    coarse = self_affine.SelfAffineWaves(0.8, 2, cut_off).heights((64,), 7, range(3))
    fine = self_affine.SelfAffineWaves(0.8, 2, cut_off).heights((256,), 7, range(3))
    np.testing.assert_allclose(fine[:, ::4], coarse, atol=1e-12)


def test_more_waves_refine_the_same_surface():
    few = grid.coefficients(self_affine.SelfAffineWaves(0.8, 2, 16).heights((256,), 7, range(3)))[:, 1:17]
    many = grid.coefficients(self_affine.SelfAffineWaves(0.8, 2, 64).heights((256,), 7, range(3)))[:, 1:17]
    ratio = many / few  # the same waves, all rescaled to keep the gradient
    np.testing.assert_allclose(ratio, ratio[:, :1] * np.ones(16), rtol=1e-9)
    np.testing.assert_allclose(ratio.imag, 0.0, atol=1e-9)


def test_realisations_do_not_depend_on_their_block():
    block = self_affine.SelfAffineWaves(0.5, 2, 16).heights((64,), 7, range(6))
    np.testing.assert_array_equal(self_affine.SelfAffineWaves(0.5, 2, 16).heights((64,), 7, range(4, 6)), block[4:])
    assert not np.allclose(block[0], block[1])
    assert not np.allclose(self_affine.SelfAffineWaves(0.5, 2, 16).heights((64,), 8, range(1)), block[:1])


def test_mean_spectrum_follows_theory():
    """Plateau below the cut-on, q^-(1 + 2H) above, nothing beyond the cut-off; exponential statistics."""
    hurst, cut_on, cut_off, n = 0.6, 4, 128, 4000
    coefficients = grid.coefficients(self_affine.SelfAffineWaves(hurst, cut_on, cut_off).heights((512,), 3, range(n)))
    index = np.arange(1, cut_off + 1)
    theory = np.maximum(index, cut_on) ** -(1 + 2 * hurst)
    theory /= 2 * np.sum((2 * np.pi * index) ** 2 * theory)
    power = abs(coefficients[:, 1 : cut_off + 1]) ** 2
    # fixing the gradient of each realisation biases a mode of weight w by a relative 2 w: here below 0.04
    deviation = power.mean(axis=0) / theory - 1
    assert abs(deviation).max() < 0.04 + 4 / np.sqrt(n)
    assert abs(deviation.mean()) < 0.02
    assert (power[:, 0].std() / power[:, 0].mean()) == pytest.approx(1.0, abs=0.1)
    assert abs(coefficients[:, cut_off + 1 :]).max() < 1e-15


def test_a_wave_has_its_statistics_in_closed_form():
    x, q, amplitude = np.arange(100) / 100, 2 * np.pi * 3, 0.01
    wave = amplitude * np.cos(q * x)
    assert statistics.rms_gradient(wave) == pytest.approx(q * amplitude / np.sqrt(2))
    assert statistics.nayak(wave) == pytest.approx(1.0)
    np.testing.assert_allclose(statistics.gradient(wave), -q * amplitude * np.sin(q * x), atol=1e-14)


@pytest.mark.parametrize("nx", [8, 9])
def test_power_adds_up_to_the_mean_square(nx):
    signal = np.random.default_rng(0).normal(size=(2, nx))
    power = grid.multiplicity(nx) * abs(grid.coefficients(signal)) ** 2
    np.testing.assert_allclose(power.sum(axis=1), (signal**2).mean(axis=1))
    np.testing.assert_allclose(grid.signal(grid.coefficients(signal), nx), signal)
