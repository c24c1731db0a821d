"""Surfaces from waves: their mean spectrum and autocorrelation, and the same surface on every grid."""

import numpy as np
import pytest
from self_affine_spectrum import SelfAffineSpectrum

from gfmd_numba.fourier import grid
from gfmd_numba.roughness import model_surfaces
from gfmd_numba.roughness.amplitudes import complex_gaussian, waves
from gfmd_numba.roughness.spectra import (
    ExponentialSpectrum,
    KCorrelationSpectrum,
    LengthAnisotropicSpectrum,
    Mounded,
    ScalingAnisotropicSpectrum,
)
from support.cases import some_of

PERIOD = 3.0
MODELS = [
    ExponentialSpectrum(1, 0.8, 0.2),
    KCorrelationSpectrum(1, 0.3, 0.2),
    Mounded(KCorrelationSpectrum(1, 0.7, 0.2), 0.6),
    ExponentialSpectrum(2, 0.5, 0.3),
    Mounded(ExponentialSpectrum(2, 0.8, 0.3), 0.6),
    LengthAnisotropicSpectrum(0.7, (0.2, 0.1)),
    ScalingAnisotropicSpectrum((0.9, 0.4), (0.2, 0.1)),
]
PLATEAU = [SelfAffineSpectrum(d, 0.8, PERIOD / 30, PERIOD / 4, PERIOD) for d in (1, 2)]
POWERS = {model_surfaces.psd_power: MODELS + PLATEAU, model_surfaces.filter_power: MODELS[2:4]}  # of each dimension
CASES = [
    pytest.param(
        power,
        model,
        id=f"{power.__name__}-{model}",
        marks=pytest.mark.long if power is model_surfaces.psd_power and model is MODELS[4] else (),  # takes seconds
    )
    for power, some in POWERS.items()
    for model in some
]


@pytest.mark.parametrize(("power_of", "model"), CASES)
def test_ensemble_has_the_spectrum_and_autocorrelation_of_theory(power_of, model):
    """Over 200 realisations, within the sampling error, which is known: a wave's power is exponential."""
    n, nx, largest = 200, 64, 31
    power = power_of(model, nx, largest, PERIOD)
    heights = model_surfaces.surfaces(power, nx, largest, 5, range(n))
    axes = tuple(range(1, heights.ndim))
    measured = abs(np.fft.rfftn(heights, axes=axes, norm="forward")) ** 2
    inside = power > 1e-12 * power.max()
    score = (measured.mean(axis=0)[inside] / power[inside] - 1) * np.sqrt(n)
    assert abs(score).max() < 5.5
    assert score.std() == pytest.approx(1.0, abs=0.25)
    assert abs(measured[:, ~inside]).max() < 1e-12 * power.max()
    found = np.array([grid.signal(m, *(nx,) * m.ndim) for m in measured])
    error = found.std(axis=0, ddof=1) / np.sqrt(n)
    score = (found.mean(axis=0) - grid.signal(power, *(nx,) * power.ndim)) / error
    assert abs(score).max() < 4.5
    np.testing.assert_allclose(heights.mean(axis=axes), 0.0, atol=1e-14)


@pytest.mark.parametrize("model", MODELS, ids=repr)
def test_filtered_surfaces_have_the_autocorrelation_asked_for(model):
    """At every grid point, up to the mean that is left out; the density method differs by what lies beyond Nyquist."""
    largest = 40
    nx = 2 * largest + 1
    exact = grid.signal(model_surfaces.filter_power(model, nx, largest, PERIOD), *(nx,) * model.dimension)
    shift = np.fft.fftfreq(nx) * PERIOD
    if isinstance(model, LengthAnisotropicSpectrum | ScalingAnisotropicSpectrum):
        asked = model.autocorrelation(shift[np.newaxis], shift[:, np.newaxis])
    else:
        asked = model.autocorrelation(abs(shift) if model.dimension == 1 else np.hypot(shift, shift[:, np.newaxis]))
    np.testing.assert_allclose(exact - exact.mean(), asked - asked.mean(), atol=1e-10)


@pytest.mark.parametrize(("power_of", "model"), CASES)
def test_a_finer_grid_samples_the_same_surface(power_of, model):
    coarse, fine = (
        model_surfaces.surfaces(power_of(model, nx, 12, PERIOD), nx, 12, 5, range(3, 5)) for nx in (32, 128)
    )
    every = (slice(None),) + (slice(None, None, 4),) * (coarse.ndim - 1)
    np.testing.assert_allclose(fine[every], coarse, atol=1e-12)


@pytest.mark.parametrize("dimension", [1, 2])
def test_more_waves_refine_the_same_surface(dimension):
    shape = (32,) * dimension
    few, many = waves(7, 3, shape, 5), waves(7, 3, shape, 15)
    np.testing.assert_array_equal(many[few != 0], few[few != 0])
    assert np.count_nonzero(few) == (5 if dimension == 1 else 5 + 5 * 10 + 5 * 1 + 5)


@pytest.mark.parametrize("nx", [48, 49, 98])
def test_the_wave_at_the_cut_off_is_kept_in_all_directions(nx):
    power = model_surfaces.psd_power(SelfAffineSpectrum(2, 0.8, 0.04, 0.5, 1.0), nx, 20)
    assert power[0, 20] == power[20, 0] == power[-20, 0] > 0.0


def test_waves_of_a_profile_are_those_of_a_map_of_one_row():
    row, profile = waves(7, 3, (1, 33), 16)[0], waves(7, 3, (33,), 16)
    np.testing.assert_array_equal(row, profile)
    np.testing.assert_array_equal(profile[1:], complex_gaussian(7, 3, 16) / np.sqrt(2.0))


@pytest.mark.parametrize("rows", [1, 3, 9, 33, 65])
def test_each_wave_of_a_strip_has_a_number_of_its_own(rows):
    found = waves(7, 3, (rows, 33), 16)
    of_pairs = np.count_nonzero(found[:, 0]) // 2  # of which both are kept
    assert len(np.unique(abs(found[found != 0.0]).round(12))) == np.count_nonzero(found) - of_pairs


def test_waves_of_a_map_are_independent_and_belong_to_a_real_surface():
    found = np.array([waves(1, i, (16, 16), 7) for i in range(1000)])
    np.testing.assert_array_equal(found[:, 1:8, 0], found[:, :-8:-1, 0].conj())
    free = np.concatenate([found[:, 1:8, 0], found[:, :, 1:8].reshape(1000, -1)], axis=1)
    free = free[:, (free != 0).all(axis=0)]
    assert free.shape[1] == 2 * 7 * 8
    covariance = free.T @ free.conj() / 1000
    assert abs(covariance - np.eye(112)).max() < 5 / np.sqrt(1000)
    assert abs(free.T @ free / 1000).max() < 5 / np.sqrt(1000)


class Broken:
    isotropic = True
    dimension = 1

    def __init__(self, at_two):
        self.at_two = at_two

    def psd(self, q):
        return np.where(np.isclose(q, 4 * np.pi), self.at_two, 1.0)


@pytest.mark.parametrize(
    ("spectrum", "message"),
    [
        (Broken(np.nan), r"spectrum of nan at wave index \(2,\)"),
        (Broken(np.inf), r"spectrum of inf at wave index \(2,\)"),
        (Broken(-1.0), r"negative at wave index \(2,\)"),
    ],
)
def test_spectra_that_cannot_be_drawn_are_refused(spectrum, message):
    with pytest.raises(ValueError, match=message):
        model_surfaces.psd_power(spectrum, 32, 5)


@pytest.mark.parametrize(
    ("hurst", "octave", "shortest", "largest"),  # all waves of the grid, or those down to a cut-on
    some_of([(0.3, 2.05, 3.08, 500), (0.8, 1.31, 2.18, 1023)], 0),
)
def test_a_filter_folds_shorter_waves_into_the_last_octave(largest, hurst, octave, shortest):
    """Its power is that of the spectrum at all k + m (2 largest + 1), and so too large near the shortest wave."""
    model = ExponentialSpectrum(1, hurst, 0.02)
    found, spectrum = (
        each(model, 2048, largest)[1 : largest + 1] for each in (model_surfaces.filter_power, model_surfaces.psd_power)
    )
    k = np.arange(1, largest + 1)
    folds = np.arange(-100, 101)[:, np.newaxis] * (2 * largest + 1)
    np.testing.assert_allclose(found, 2 * np.pi * model.psd(2 * np.pi * abs(k + folds)).sum(axis=0), rtol=0.06)
    last = k > largest // 2
    assert found[last].sum() / spectrum[last].sum() == pytest.approx(octave, abs=0.05)
    assert found[-1] / spectrum[-1] == pytest.approx(shortest, abs=0.05)
    assert (found / spectrum)[k < largest / 8].max() < 1.07


def test_a_period_too_short_for_the_correlation_is_refused():
    with pytest.raises(ValueError, match="negative at wave index"):
        model_surfaces.filter_power(ExponentialSpectrum(1, 0.9, 1.0), 64, 31, 1.0)
