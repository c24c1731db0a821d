"""Every generator draws surfaces of the scale asked for, and refines the same surface on a finer grid."""

from dataclasses import replace

import numpy as np
import pytest
from self_affine_spectrum import SelfAffineSpectrum

from gfmd_numba.roughness import model_surfaces, statistics
from gfmd_numba.roughness.generators import RandomSurface, gradient_over_height
from gfmd_numba.roughness.model_surfaces import ModelWaves
from gfmd_numba.roughness.recursive import Recursion
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.roughness.spectra import (
    ExponentialSpectrum,
    KCorrelationSpectrum,
    LengthAnisotropicSpectrum,
    Mounded,
    ScalingAnisotropicSpectrum,
)
from gfmd_numba.scene.surface_file import SurfaceFile
from gfmd_numba.simulate.surface import make

NX = 64


def generators(dimension):
    yield SelfAffineWaves(0.8, 2, 16)
    yield SelfAffineWaves(0.3, 3.5, 16, plateau=False)
    yield ModelWaves("psd", KCorrelationSpectrum(dimension, 0.7, 0.1), 16)
    yield ModelWaves("fourier_filter", ExponentialSpectrum(dimension, 0.7, 0.1), 16)
    yield ModelWaves("fourier_filter", Mounded(KCorrelationSpectrum(dimension, 0.5, 0.05), 0.2), 16)
    if dimension == 2:
        yield SelfAffineWaves(0.8, 4, 16, anisotropy=2.0)
        yield ModelWaves("psd", LengthAnisotropicSpectrum(0.7, (0.1, 0.2)), 16)
        yield ModelWaves("psd", ScalingAnisotropicSpectrum((0.7, 0.5), (0.1, 0.2)), 16)
    for method in ("midpoint_displacement", "successive_addition"):
        yield Recursion(method, dimension, 0.5, 1 / 16, 1 / 2)


ALL = [(generator, dimension) for dimension in (1, 2) for generator in generators(dimension)]


@pytest.mark.parametrize(("generator", "dimension"), ALL)
def test_surfaces_have_unit_rms_gradient_or_the_rms_height_that_belongs_to_it(generator, dimension):
    periods = (1.0,) * dimension
    heights = RandomSurface(generator, NX, 7, dimension).heights(range(3))
    assert heights.shape == (3, *(NX,) * dimension)
    np.testing.assert_allclose(statistics.rms_gradient(heights, periods), 1.0, rtol=1e-12)
    by_height = RandomSurface(generator, NX, 7, dimension, by_height=True).heights(range(3))
    expected = 1.0 / gradient_over_height(generator, (NX,) * dimension)
    np.testing.assert_allclose(statistics.rms_height(by_height, periods), expected, rtol=1e-12)
    flat, others = heights.reshape(3, -1), by_height.reshape(3, -1)
    factor = (flat * others).sum(axis=1) / (flat**2).sum(axis=1)
    np.testing.assert_allclose(others, factor[:, np.newaxis] * flat, atol=1e-12)


@pytest.mark.parametrize(("generator", "dimension"), ALL)
def test_a_finer_grid_samples_the_same_surface(generator, dimension):
    coarse = RandomSurface(generator, NX, 7, dimension).heights(range(2))
    fine = RandomSurface(generator, 2 * NX, 7, dimension).heights(range(2))
    sampled = fine[(slice(None), *(slice(None, None, 2),) * dimension)]
    scale = (sampled * coarse).sum() / (coarse**2).sum()  # recursive surfaces may end at another step
    np.testing.assert_allclose(sampled, scale * coarse, atol=1e-9 * abs(coarse).max())


MODELS = [each for each in ALL if isinstance(each[0], ModelWaves)]


@pytest.mark.parametrize(("generator", "dimension"), MODELS)
def test_the_power_of_theory_is_the_mean_power_of_the_ensemble(generator, dimension):
    shape = (NX,) * dimension
    found = statistics.power(generator.heights(shape, 3, range(100)), (1.0,) * dimension).mean(axis=0)
    theory = generator.power(shape)
    waves = theory > 1e-9 * theory.max()
    # the mean of 100 exponentially distributed powers scatters by 1 / 10; 16 waves tell that scatter to a sixth
    assert 0.05 < np.sqrt(np.mean((found[waves] / theory[waves] - 1.0) ** 2)) < 0.16
    assert found[~waves].max() < 1e-9 * theory.max()


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize("plateau", [True, False])
def test_the_power_of_self_affine_waves_is_that_of_the_spectrum(plateau, dimension):
    model = SelfAffineSpectrum(dimension, 0.3, 1 / 16, 1 / 4, 1.0 if plateau else 1 / 4)
    expected = model_surfaces.psd_power(model, NX, 16)
    found = SelfAffineWaves(0.3, 4, 16, plateau=plateau).power((NX,) * dimension)
    np.testing.assert_allclose(found / found.max(), expected / expected.max(), rtol=1e-12)
    assert statistics.moment_of_power(found, (NX,) * dimension, 0, (1.0,) * dimension) == pytest.approx(1.0)


@pytest.mark.parametrize(("generator", "dimension"), ALL)
def test_by_theory_the_ensemble_has_the_scale_and_a_surface_differs_by_a_factor(generator, dimension):
    each = RandomSurface(generator, NX, 7, dimension).heights(range(40)).reshape(40, -1)
    if isinstance(generator, SelfAffineWaves):
        generator = replace(generator, by_theory=True)
    heights = RandomSurface(generator, NX, 7, dimension, by_theory=True).heights(range(40))
    factor = np.expand_dims((heights.reshape(40, -1) * each).sum(axis=1) / (each**2).sum(axis=1), 1)
    np.testing.assert_allclose(heights.reshape(40, -1), factor * each, atol=1e-12 * abs(each).max() * factor.max())
    expected = 1.0 / gradient_over_height(generator, (NX,) * dimension)
    squares = statistics.rms_height(heights, (1.0,) * dimension) ** 2 / expected**2
    assert abs(squares.mean() - 1.0) < 4.0 * squares.std() / np.sqrt(40)
    assert factor.std() > 0.003  # or the ensemble has no spread, and the test no meaning


def excess_at_short_waves(**given):
    """By how much the mean power of 150 surfaces exceeds that of theory, over the shorter half of their waves."""
    record = {"method": "psd", "model": "exponential", "hurst": 0.8, "correlation_length": 0.2, "points": 128}
    file = SurfaceFile.model_validate({"surface": record | given, "seed": 5})
    made = [make(file.model_copy(update={"realisation": realisation})) for realisation in range(150)]
    found = np.mean([statistics.power(surface.heights, (1.0,)) for surface in made], axis=0)
    theory = np.mean([surface.power for surface in made], axis=0)
    return np.mean(found[32:63] / theory[32:63]) - 1.0


@pytest.mark.long
@pytest.mark.parametrize("given", [{"rms_height": 0.02}, {"rms_gradient": 0.5}], ids=lambda given: next(iter(given)))
def test_a_scaled_ensemble_has_the_spectrum_of_theory(given):
    scatter = 1.0 / np.sqrt(150 * 31)  # of the mean of so many exponentially distributed powers
    assert abs(excess_at_short_waves(**given, scaling="ensemble")) < 4.0 * scatter


@pytest.mark.long
def test_surfaces_that_are_scaled_one_by_one_are_too_rough_at_short_waves():
    """As the long waves, which carry the height, are few."""
    assert excess_at_short_waves(rms_height=0.02) > 0.1
