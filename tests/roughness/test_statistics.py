"""Statistics of surfaces against waves with closed forms, brute force and the theory of Gaussian surfaces."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from self_affine_spectrum import SelfAffineSpectrum

from gfmd_numba.arrays.threads import shared_by
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import model_surfaces, statistics
from gfmd_numba.roughness.self_affine import SelfAffineWaves

LENGTHS = (2.0, 5.0)
MAP = (1.0, 1.0)


def wave_map(ny=24, nx=32):
    y, x = np.arange(ny)[:, np.newaxis] / ny * LENGTHS[0], np.arange(nx) / nx * LENGTHS[1]
    q_y, q_x = 2 * np.pi * 3 / LENGTHS[0], 2 * np.pi * 2 / LENGTHS[1]
    return 0.1 * np.cos(q_y * y + q_x * x) + 7.0, np.hypot(q_y, q_x)


def test_a_wave_on_a_map_has_its_statistics_in_closed_form():
    heights, q = wave_map()
    w = 0.1 / np.sqrt(2)
    assert statistics.rms_height(heights, LENGTHS) == pytest.approx(w)
    assert statistics.rms_gradient(heights, LENGTHS) == pytest.approx(q * w)
    assert statistics.rms_curvature(heights, LENGTHS) == pytest.approx(q**2 * w)
    assert statistics.nayak(heights, LENGTHS) == pytest.approx(1.5)


@pytest.mark.parametrize(("share", "wavelength", "short"), [(0.4, 1 / 4, 1.0), (0.6, 1 / 32, 0.6), (1.0, 1 / 32, 1.0)])
def test_the_median_wave_and_shorter_ones_have_at_least_half_of_the_mean_square_gradient(share, wavelength, short):
    """Of two waves, the one that has more than half of it; of one, that with all of it."""
    x = np.arange(256) / 256
    z = np.sqrt(1 - share) / 4 * np.cos(2 * np.pi * 4 * x) + np.sqrt(share) / 32 * np.sin(2 * np.pi * 32 * x)
    assert statistics.median_wave(3.0 * z, (0.7,)) == pytest.approx((0.7 * wavelength, short))
    assert statistics.median_wave(z + np.zeros((64, 1)), (0.5, 0.7)) == pytest.approx((0.7 * wavelength, short))


def test_rms_height_of_a_map_is_its_standard_deviation():
    heights = np.random.default_rng(0).normal(size=(3, 6, 8))
    np.testing.assert_allclose(statistics.rms_height(heights, LENGTHS), heights.std(axis=(1, 2)))


def test_typical_slope_is_the_angle():
    x = np.arange(4096) / 4096 * 5.0
    wave = 0.3 * np.sin(2 * np.pi * x / 5.0 * 4)
    slope = 0.3 * 2 * np.pi / 5.0 * 4 * np.cos(2 * np.pi * x / 5.0 * 4)
    assert statistics.typical_slope(wave, 5.0) == pytest.approx(np.sqrt((np.arctan(slope) ** 2).mean()))


@pytest.mark.parametrize("shape", [(9,), (8,), (6, 8), (5, 7)])
def test_autocorrelation_is_that_of_brute_force(shape):
    heights = np.random.default_rng(1).normal(size=(2, *shape))
    lengths = LENGTHS[: len(shape)]
    axes = tuple(range(1, len(shape) + 1))
    centred = heights - heights.mean(axis=axes, keepdims=True)
    found = statistics.autocorrelation(heights, lengths)
    for shift in np.ndindex(shape):
        moved = np.roll(centred, [-s for s in shift], axis=axes)
        exact = (centred * moved).mean(axis=axes) / (centred**2).mean(axis=axes)
        np.testing.assert_allclose(found[(slice(None), *shift)], exact, atol=1e-12)


@pytest.mark.parametrize("n", [64, 65, 118])
@pytest.mark.parametrize("dimension", [1, 2])
def test_the_radial_mean_of_a_radial_function_is_the_function(dimension, n):
    length = 3.0
    shift = np.fft.fftfreq(n) * length
    radial = abs(shift) if dimension == 1 else np.hypot(shift[:, np.newaxis], shift)
    distance, mean = statistics.radial_mean(radial, (length,) * dimension)
    np.testing.assert_allclose(mean, distance)
    assert len(distance) == n // 2 + 1
    assert distance[0] == 0.0
    assert distance[-1] == pytest.approx(1.5, abs=0.03)


@pytest.mark.parametrize("dimension", [1, 2])
def test_a_self_affine_surface_shows_its_spectrum_and_hurst_exponent(dimension):
    nx, length, hurst = (4096, 3.0, 0.7) if dimension == 1 else (256, 3.0, 0.7)
    largest = nx // 2 - 1
    model = SelfAffineSpectrum(dimension, hurst, length / (0.9 * largest), length / 4, length)
    power = model_surfaces.psd_power(model, nx, largest, length)
    heights = 0.01 * model_surfaces.surfaces(power, nx, largest, 4, range(6))
    lengths = (length,) * dimension
    q, density, waves = statistics.spectral_density(heights, lengths)
    even = grid.signal(np.sqrt(power), *(nx,) * dimension)  # a surface of exactly the mean power
    _, expected, _ = statistics.spectral_density(0.01 * even, lengths)
    inside = (q > 1.2 * 2 * np.pi / (length / 4)) & (q < 0.85 * 2 * np.pi / model.cut_on)
    np.testing.assert_allclose(expected[inside], 1e-4 * model.psd(q[inside]), rtol=0.06)  # a bin averages a curve
    score = (density[inside] / expected[inside] - 1) * np.sqrt(waves[inside])
    assert inside.sum() > 10
    assert abs(score).max() < 4.0
    assert waves.sum() == pytest.approx(6 * ((nx**dimension - 1) / 2), rel=1e-12)
    found, error = statistics.hurst_exponent(heights, 8 * np.pi / length, 2 * np.pi / model.cut_on, lengths)
    assert abs(found - hurst) < 3.5 * error
    assert error < 0.02


def test_error_of_the_hurst_exponent_is_the_scatter():
    model = SelfAffineSpectrum(1, 0.5, 1 / 100, 1 / 2, 1.0)
    heights = model_surfaces.surfaces(model_surfaces.psd_power(model, 256, 100), 256, 100, 9, range(400))
    found = np.array([statistics.hurst_exponent(h, 4 * np.pi, 200 * np.pi) for h in heights])
    assert found[:, 0].std() == pytest.approx(found[0, 1], rel=0.12)
    assert found[:, 0].mean() == pytest.approx(0.5, abs=3.5 * found[0, 1] / 20)


@pytest.mark.parametrize("dimension", [1, 2])
def test_moments_of_surfaces_are_those_of_their_model(dimension):
    """Period long against the roll-off: rms height, gradient, curvature and Nayak's parameter in closed form."""
    largest = 100
    model = SelfAffineSpectrum(dimension, 0.6, 1 / largest, 1 / 20, 1.0)
    nx = 256
    heights = model_surfaces.surfaces(
        model_surfaces.psd_power(model, nx, largest), nx, largest, 2, range(40 if dimension == 1 else 3)
    )
    lengths = (1.0,) * dimension
    moments = []
    for order in (0, 2, 4):
        found = statistics.spectral_moment(heights, order, lengths).mean()
        # a sum over whole wave numbers stands for the integral: ends of the range count in full
        assert found == pytest.approx(model.moment(order), rel=0.05)
        moments.append(model.moment(order))
    assert statistics.nayak(heights, lengths).mean() == pytest.approx(
        statistics.nayak_of_moments(*moments, dimension), rel=0.08
    )


def test_scaled_heights_have_the_rms_asked_for():
    heights = np.random.default_rng(3).normal(size=(4, 6, 8)) + 2.0
    by_height = statistics.scaled(heights, LENGTHS, rms_height=0.3)
    np.testing.assert_allclose(statistics.rms_height(by_height, LENGTHS), 0.3)
    np.testing.assert_allclose(by_height.mean(axis=(1, 2)), 0.0, atol=1e-15)
    by_gradient = statistics.scaled(heights, LENGTHS, rms_gradient=0.3)
    np.testing.assert_allclose(statistics.rms_gradient(by_gradient, LENGTHS), 0.3)
    with pytest.raises(ValueError, match="flat"):
        statistics.scaled(np.ones((1, 8)), (1.0,), rms_height=1.0)


@pytest.mark.parametrize("size", [pytest.param(1024, marks=pytest.mark.long), 1025])
def test_threads_share_what_is_made_and_known_of_a_map_and_change_no_bit_of_it(size, monkeypatch):
    weight, shared = np.random.default_rng(1).random((1, size, size)), []
    submit, waves = ThreadPoolExecutor.submit, SelfAffineWaves(0.7, 2.0, (size - 1) // 2)

    def made() -> list[np.ndarray]:
        shared.append(0)
        heights = waves.heights((size, size), 3, range(1))
        return [
            heights,
            grid.coefficients(heights, 2),
            np.stack(statistics.moments_of_power(statistics.power(heights, MAP), (size, size), (0, 2, 4), MAP)),
            statistics.weighed_square_gradient(heights, weight, MAP),
            statistics.weighed_square_gradient(heights, weight, MAP, (True, False)),
        ]

    def noted(pool, *work):  # once for each other thread
        shared[-1] += 1
        return submit(pool, *work)

    monkeypatch.setattr(ThreadPoolExecutor, "submit", noted)
    alone = made()
    with shared_by(2):
        for found, expected in zip(made(), alone, strict=True):
            np.testing.assert_array_equal(found, expected)
    # of amplitudes one, of waves one, of transforms two, of moments one, of gradients two
    assert shared == [0, (1 + 1 + 2) + 2 + (2 + 1) + 2 + 2]


@pytest.mark.parametrize("n", [12, 13])
def test_the_weighed_square_gradient_is_that_of_the_sum_of_waves(n):
    rng = np.random.default_rng(n)
    heights, weight = rng.normal(size=(2, 3, n)), rng.random((2, 3, n))
    weight[:, :, 4] = weight[0, 2] = 0.0
    k, m = np.fft.fftfreq(n, 1 / n), np.fft.fftfreq(3, 1 / 3)
    k[abs(k) == n / 2] = 0.0  # the derivative of the wave at Nyquist is zero on every node
    waves = np.fft.fft2(heights)
    along = [np.fft.ifft2(2j * np.pi * q * waves).real for q in (k / 5.0, m[:, np.newaxis] / 7.0)]
    expected = ((along[0] ** 2 + along[1] ** 2) * weight).sum(axis=(1, 2))
    np.testing.assert_allclose(statistics.weighed_square_gradient(heights, weight, (7.0, 5.0)), expected, rtol=1e-12)


@pytest.mark.parametrize("n", [4, 5, 40])
def test_gradients_of_heights_that_end_are_those_of_a_spline(n):
    heights = np.random.default_rng(1).normal(size=(3, n))
    slopes = CubicSpline(np.arange(n), heights, axis=1)(np.arange(n), 1)
    found = statistics.rms_gradient(heights, (n,), (True,))
    np.testing.assert_allclose(found, np.sqrt((slopes**2).mean(axis=1)), rtol=1e-12)
