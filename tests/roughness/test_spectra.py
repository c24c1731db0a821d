"""Roughness models against mpmath, quadrature and each other."""

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import fresnel
from self_affine_spectrum import SelfAffineSpectrum

from gfmd_numba.roughness.spectra import (
    ExponentialSpectrum,
    KCorrelationSpectrum,
    LengthAnisotropicSpectrum,
    Mounded,
    ScalingAnisotropicSpectrum,
    stretched_exponential,
)
from gfmd_numba.roughness.statistics import nayak_of_moments
from support.cases import some_of


def printed_series(q, hurst, dimension, digits):
    """The series (3.11) with (2j)! for 2j!, summed with enough digits to survive its cancellation."""
    with mp.workdps(digits):
        x, h, total, j = mp.mpf(q), mp.mpf(hurst), mp.mpf(0), 0
        while True:
            if dimension == 1:
                term = mp.gamma((j + mp.mpf(1) / 2) / h) / mp.factorial(2 * j) * (-(x**2)) ** j
            else:
                term = mp.gamma((j + 1) / h) / mp.factorial(j) ** 2 * (-(x**2) / 4) ** j
            total += term
            if j > 5 and abs(term) < mp.mpf(10) ** -30:
                return float(total / (2 * mp.pi * h if dimension == 1 else 4 * mp.pi * h))
            j += 1


def inverse_series(q, hurst, dimension):
    """Fourier integrals of r^(2Hk), k = 1, 2 ..., summed; for H < 1/2 it converges for every q > 0."""
    with mp.workdps(60):
        total, alpha = mp.mpf(0), 2 * mp.mpf(hurst)
        for k in range(1, 400):
            power, sine = mp.mpf(q) ** (-alpha * k - dimension), mp.sin(mp.pi * alpha * k / 2)
            if dimension == 1:
                size = mp.gamma(alpha * k + 1) / mp.pi
            else:
                size = 2 ** (alpha * k) * mp.gamma(1 + alpha * k / 2) ** 2 / mp.pi**2
            total -= (-1) ** k * size / mp.factorial(k) * sine * power
        return float(total)


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize(
    ("hurst", "q", "digits"), some_of([(0.6, 3.0, 80), (0.99, 29.9, 160), (0.99, 31.0, 160)], 0, 2)
)
def test_the_exponential_spectrum_is_right_where_its_series_loses_all_digits(hurst, q, digits, dimension):
    assert stretched_exponential(np.array([q]), hurst, dimension)[0] == pytest.approx(
        printed_series(q, hurst, dimension, digits), rel=1e-11
    )


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize(("hurst", "q"), [(0.1, 0.7), (0.3, 0.7), (0.4, 40.0)])
def test_the_exponential_spectrum_is_right_where_its_series_diverges(hurst, q, dimension):
    exact = inverse_series(q, hurst, dimension)
    assert stretched_exponential(np.array([q]), hurst, dimension)[0] == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("q", [1e-3, 0.2, 7.0, 300.0])
def test_the_exponential_spectrum_has_its_closed_form(q):
    """Fresnel integrals for H = 1/4 on a profile, a power for H = 1/2 on a map."""
    s, c = fresnel(np.sqrt(1 / (2 * np.pi * q)))
    phase = 1 / (4 * q)
    exact = (np.sin(phase) * (0.5 - s) + np.cos(phase) * (0.5 - c)) / np.sqrt(2 * np.pi * q**3)
    assert stretched_exponential(np.array([q]), 0.25, 1)[0] == pytest.approx(exact, rel=1e-9)
    assert stretched_exponential(np.array([q]), 0.5, 2)[0] == pytest.approx((1 + q**2) ** -1.5 / (2 * np.pi), rel=1e-12)


@pytest.mark.parametrize("hurst", some_of([0.05, 0.5, 0.999], 0, 2))
@pytest.mark.parametrize("dimension", [1, 2])
def test_exponential_spectrum_has_no_seams(hurst, dimension):
    """Table and direct sum, integral and inverse powers agree; the value at 0 is a gamma function."""
    seam = stretched_exponential(np.array([30.0, 30.0 * (1 + 1e-9)]), hurst, dimension)
    assert seam[1] / seam[0] == pytest.approx(1.0, abs=1e-8)
    q = np.geomspace(1e-4, 29.0, 7)
    many = stretched_exponential(np.concatenate([q, np.geomspace(1e-4, 29.0, 5000)]), hurst, dimension)[:7]
    np.testing.assert_allclose(many, stretched_exponential(q, hurst, dimension), rtol=1e-8)
    at_zero = stretched_exponential(np.zeros(1), hurst, dimension)[0]
    exact = mp.gamma(1 / (2 * hurst)) / (2 * hurst * mp.pi)
    if dimension == 2:
        exact = mp.gamma(1 / hurst) / (2 * hurst * 2 * mp.pi)
    assert at_zero == pytest.approx(float(exact), rel=1e-13)


def models(dimension):
    for hurst in (0.3, 0.8):
        for model in (ExponentialSpectrum(dimension, hurst, 1.3), KCorrelationSpectrum(dimension, hurst, 1.3)):
            yield model
            yield Mounded(model, 1.5 if hurst == 0.3 else 6.0)


@pytest.mark.parametrize("model", [*models(1), *models(2)], ids=repr)
def test_spectrum_is_the_transform_of_the_autocorrelation(model):
    """Back-transformed at three distances, the near ones where the surface is self-affine."""
    distance = np.array([0.0, 0.1, 1.7])
    u = np.arange(-3.85, 4.25, 0.005)  # steps in log q that grow smoothly to both sides of the mounds
    q = np.exp(1.0 + np.sinh(u))
    density = model.psd(q) * q**model.dimension * np.cosh(u) * 0.005
    if model.dimension == 2:
        density *= 2 * np.pi
    else:
        density *= 2
    assert density.sum() == pytest.approx(1.0, abs=1e-8)
    assert density.min() >= 0.0
    # exp(-t q^2) in place of the waves: the mean of R over a Gaussian of variance 2 t, without oscillations
    for t in 0.25 * distance[1:] ** 2:
        smooth = (density * np.exp(-t * q**2)).sum()
        spread = np.sqrt(2 * t)
        r = np.arange(0.0, 12.0, 1 / 4000) * spread + spread / 8000
        weight = np.exp(-(r**2) / (4 * t)) * (r if model.dimension == 2 else 1.0)
        expected = (weight * model.autocorrelation(r)).sum() / weight.sum()
        assert smooth == pytest.approx(expected, abs=2e-4 if model_is_steep(model) else 1e-6)


def model_is_steep(model):
    """Whether R leaves 1 like r^0.6, which the sum over r resolves to 1e-4 only."""
    return getattr(model, "model", model).hurst < 0.5


def test_mounded_gaussian_is_a_bessel_function():
    """(3.22) with the I0 that belongs where K0 is printed."""
    q, xi, separation = np.array([0.0, 1.0, 4.0]), 1.3, 2.0
    common = xi**2 / (4 * np.pi) * np.exp(-(4 * np.pi**2 + (q * separation) ** 2) * xi**2 / (4 * separation**2))
    exact = common * np.i0(np.pi * q * xi**2 / separation)
    np.testing.assert_allclose(Mounded(ExponentialSpectrum(2, 1.0, xi), separation).psd(q), exact, rtol=1e-12)


@pytest.mark.parametrize("hurst", [0.2, 0.7])
def test_mounded_k_correlation_is_the_printed_series(hurst):
    """(3.20) and (3.21), which converge for b < 1."""
    q, xi, separation = 2.0, 0.4, 2.5
    bracket = 1 + (q * xi) ** 2 / (2 * hurst) + 2 * (np.pi * xi) ** 2 / (hurst * separation**2)
    b = 4 * np.pi * xi**2 * separation * q / (2 * hurst * separation**2 * bracket)
    series = mp.nsum(lambda j: mp.gamma(2 * j + hurst + 1) / mp.factorial(j) ** 2 * (b**2 / 4) ** j, [0, mp.inf])
    exact = xi**2 / (2 * np.pi * mp.gamma(hurst + 1) * bracket ** (1 + hurst)) * series
    found = Mounded(KCorrelationSpectrum(2, hurst, xi), separation).psd(np.array([q]))[0]
    assert found == pytest.approx(float(exact), rel=1e-12)


@pytest.mark.parametrize("dimension", [1, 2])
@pytest.mark.parametrize("hurst", [0.0, 0.4, 1.0])
def test_moments_of_a_self_affine_surface_are_integrals_of_its_spectrum(hurst, dimension):
    model = SelfAffineSpectrum(dimension, hurst, cut_on=0.01, roll_off=0.3, longest=2.0)
    q_0, q_r, q_s = (2 * np.pi / length for length in (2.0, 0.3, 0.01))
    for order in (0, 1, 2, 4):
        area = lambda q: (2 if dimension == 1 else 2 * np.pi * q) * q**order * float(model.psd(np.array(q)))  # noqa: E731, B023
        exact = quad(area, q_0, q_r)[0] + quad(area, q_r, q_s, limit=200)[0]
        assert model.moment(order) == pytest.approx(exact, rel=1e-8)
    assert nayak_of_moments(model.moment(0), model.moment(2), model.moment(4), dimension) > 1.5
    outside = np.array([0.0, 0.99 * q_0, 1.01 * q_s])
    np.testing.assert_array_equal(model.psd(outside), 0.0)


def test_height_height_correlation_is_self_affine_at_short_distances():
    r = 1e-4
    for hurst in (0.3, 0.8):
        model = ExponentialSpectrum(1, hurst, 1.0)
        near, far = 1.0 - model.autocorrelation(np.array([r, 2 * r]))
        assert np.log2(far / near) == pytest.approx(2 * hurst, abs=2e-2)
        assert model.autocorrelation(np.array([1e6]))[0] == pytest.approx(0.0)


@pytest.mark.parametrize(
    "model", [LengthAnisotropicSpectrum(0.7, (0.5, 0.1)), ScalingAnisotropicSpectrum((0.9, 0.4), (0.5, 0.1))], ids=repr
)
def test_anisotropic_spectra_are_transforms_of_their_autocorrelation(model):
    """Unit integral, and along x the stretched_exponential of the autocorrelation."""
    steps = np.arange(-14.0, 24.0, 0.05)
    q = np.exp(steps)
    q_x, q_y = np.meshgrid(q, q)
    weight = 4 * q_x * q_y * 0.05**2
    assert (weight * model.psd(q_x, q_y)).sum() == pytest.approx(1.0, abs=2e-4)
    t = 0.01
    smooth = (weight * model.psd(q_x, q_y) * np.exp(-t * (q_x**2 + q_y**2))).sum()
    r = (np.arange(600) + 0.5) * 0.002
    x, y = np.meshgrid(r, r)
    gaussian = np.exp(-(x**2 + y**2) / (4 * t))
    expected = (gaussian * model.autocorrelation(x, y)).sum() / gaussian.sum()
    assert smooth == pytest.approx(expected, abs=2e-4)


def test_length_anisotropy_with_equal_lengths_is_the_k_correlation_model():
    q = np.array([0.0, 1.0, 30.0])
    hurst, xi = 0.7, 0.2
    isotropic = KCorrelationSpectrum(2, hurst, xi * np.sqrt(2 * hurst)).psd(q)
    np.testing.assert_allclose(LengthAnisotropicSpectrum(hurst, (xi, xi)).psd(0.6 * q, 0.8 * q), isotropic, rtol=1e-12)
