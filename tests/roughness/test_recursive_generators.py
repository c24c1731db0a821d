"""Midpoint displacement and successive addition: their own exact spectrum, nesting, and the known artefact."""

import numpy as np
import pytest
from self_affine_spectrum import SelfAffineSpectrum

from gfmd_numba.fourier.grid import resample, signal
from gfmd_numba.roughness import model_surfaces, statistics
from gfmd_numba.roughness.recursive import Recursion, power_of_points
from support.cases import some_of

METHODS = ("midpoint_displacement", "successive_addition")
CASES = [
    Recursion(method, dimension, hurst, 1 / 16, 1 / 2)
    for method in METHODS
    for dimension, hurst in ((1, 0.3), (1, 0.9), (2, 0.5))
]


def own_power(recursion):
    """Mean power per mean square height `[(n,) n // 2 + 1]`."""
    found = power_of_points(recursion)
    return (found / (found.sum() - found.flat[0]))[..., : found.shape[-1] // 2 + 1]


@pytest.mark.parametrize("recursion", some_of(CASES, 1, 5), ids=repr)
def test_ensemble_has_the_exact_spectrum_of_the_recursion(recursion):
    """Over 400 realisations; powers of a process that is not stationary are correlated, hence the wider bound."""
    n, nx = 400, 2**recursion.last
    heights = recursion.heights((nx,) * recursion.dimension, 5, range(n))
    axes = tuple(range(1, heights.ndim))
    measured = abs(np.fft.rfftn(heights, axes=axes, norm="forward")) ** 2
    error = measured.std(axis=0, ddof=1) / np.sqrt(n)
    score = (measured.mean(axis=0) - own_power(recursion)) / error
    assert abs(score).max() < 4.5
    assert score.std() == pytest.approx(1.0, abs=0.35)
    w = statistics.rms_height(heights, (1.0,) * recursion.dimension)
    assert (w**2).mean() == pytest.approx(1.0, abs=4 * (w**2).std() / np.sqrt(n))


@pytest.mark.parametrize("recursion", CASES, ids=repr)
def test_a_finer_grid_samples_the_same_surface(recursion):
    coarse, fine = (recursion.heights((nx,) * recursion.dimension, 5, range(2)) for nx in (32, 128))
    every = (slice(None),) + (slice(None, None, 4),) * recursion.dimension
    np.testing.assert_allclose(fine[every], coarse, atol=1e-12)


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize("method", METHODS)
def test_levels_of_a_recursion_nest(method, dimension):
    """A smaller cut-on keeps every point of midpoint displacement, and adds to those of successive addition."""
    few, many = (Recursion(method, dimension, 0.7, cut_on, 1 / 2) for cut_on in (1 / 8, 1 / 16))
    coarse, fine = (r.heights((2**r.last,) * r.dimension, 5, range(1))[0] for r in (few, many))
    shared = fine[(slice(None, None, 2),) * dimension]
    if method == "midpoint_displacement":
        np.testing.assert_allclose(shared / shared.flat[0], coarse / coarse.flat[0], rtol=1e-11)
    else:
        assert 0.9 < np.corrcoef(shared.ravel(), coarse.ravel())[0, 1] < 1.0


@pytest.mark.parametrize(("method", "old", "new"), [(METHODS[0], 1.0, 1.0), (METHODS[1], 1.25, 0.75)])
def test_one_step_of_a_recursion_is_that_by_hand(method, old, new):
    """Four heights of variance 1; between them their means, of variance 1/2, and heights of variance 1/2 or 1/4."""
    recursion = Recursion(method, 1, 0.5, 1 / 4, 1.0)
    assert (recursion.first, recursion.last) == (2, 3)
    heights = np.sqrt(1.0 - 1 / 4 - 1 / 32) * recursion.heights((8,) * recursion.dimension, 1, range(2_000))
    scatter = np.sqrt(1 / 2_000)  # of the mean of a product, in standard deviations of the factors; sqrt(2) for squares
    assert (heights**2).mean(axis=0) == pytest.approx(4 * [old, new], rel=4.0 * np.sqrt(2.0) * scatter)
    assert (heights * np.roll(heights, 1, axis=1)).mean(axis=0) == pytest.approx(8 * [0.5], abs=4.0 * scatter)
    assert (heights * np.roll(heights, 2, axis=1)).mean(axis=0) == pytest.approx(4 * [0.0, 0.25], abs=4.0 * scatter)


@pytest.mark.long
def test_both_methods_have_the_same_spectrum_but_not_the_same_heights():
    """Averaged over positions. The variance varies with position: by 2, 18 % at H = 1/2, by 19, 22 % at H = 0.9."""
    for hurst, uneven in ((0.5, (0.02, 0.18)), (0.9, (0.19, 0.22))):
        both = [Recursion(method, 1, hurst, 1 / 64, 1 / 2) for method in METHODS]
        np.testing.assert_allclose(*(own_power(recursion)[1:] for recursion in both), rtol=1e-12)
        for recursion, expected in zip(both, uneven, strict=True):
            variance = (recursion.heights((128,) * recursion.dimension, 3, range(2000)) ** 2).mean(axis=0)
            assert variance.std() / variance.mean() == pytest.approx(expected, abs=0.02)


@pytest.mark.parametrize(
    ("hurst", "correlation", "low", "high", "shortest"),
    [(0.3, 0.018, 0.86, 1.17, 1.73), (0.5, 0.027, 0.81, 1.21, 2.02), (0.9, 0.042, 0.28, 1.50, 1.02)],
)
def test_the_artefact_of_successive_addition_has_its_known_size(hurst, correlation, low, high, shortest):
    """Rms error of the autocorrelation up to half a period, and power over that asked for at one rms height; exact.

    The range of the power is that without the last octave, in which it goes on to the value at the shortest wave.
    """
    recursion = Recursion("successive_addition", 1, hurst, 1 / 1024, 1 / 4)
    asked = model_surfaces.psd_power(SelfAffineSpectrum(1, hurst, 1 / 1024, 1 / 4, 1.0), 2048, 1023)
    found = own_power(recursion)
    found[0] = 0.0
    curves = [signal(power, 2048) for power in (found, asked)]
    difference = curves[0] / curves[0][0] - curves[1] / curves[1][0]
    assert np.sqrt((difference[:1024] ** 2).mean()) == pytest.approx(correlation, abs=2e-3)
    asked /= 2.0 * asked.sum()  # found has the rms height 1 already
    ratio = found[1:1024] / asked[1:1024]
    assert (ratio[:511].min(), ratio[:511].max(), ratio[-1]) == pytest.approx((low, high, shortest), abs=0.02)


@pytest.mark.parametrize(("old", "new"), [(8, 32), (8, 9), (9, 8), (7, 21)])
def test_resampling_keeps_waves_that_fit(old, new):
    def surface(n):
        x = np.arange(n) / n
        y = x[:, np.newaxis]
        return np.cos(2 * np.pi * (2 * x + 3 * y) + 0.3) + np.sin(2 * np.pi * x) + 0.5

    np.testing.assert_allclose(resample(surface(old), (new, new)), surface(new), atol=1e-14)


def test_resampling_a_wave_at_nyquist_keeps_the_cosine():
    coarse = np.array([1.0, -1.0, 1.0, -1.0])
    np.testing.assert_allclose(resample(coarse, (8,)), np.cos(np.pi * np.arange(8) / 2), atol=1e-15)
    np.testing.assert_allclose(resample(resample(coarse, (8,)), (4,)), coarse, atol=1e-15)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.5, 0.3, 0.5), "not at least twice"),
        ((0.5, 0.1, 2.0), "at most 1"),
    ],
)
def test_recursions_that_make_no_sense_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        Recursion("midpoint_displacement", 1, *arguments)


def test_a_cut_on_beyond_nyquist_is_refused():
    with pytest.raises(ValueError, match="64 points of the last step on a grid of 32"):
        Recursion("successive_addition", 1, 0.5, 1 / 32, 0.5).heights((32,), 1, range(1))
