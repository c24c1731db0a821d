"""The Prony series of a generalised Maxwell body, against quadrature."""

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad

from gfmd_numba.elasticity.prony import PronySeries, in_series
from support.viscoelastic import THREE, compliance, modulus

SERIES = PronySeries(*zip(*THREE, strict=True))


def test_its_modulus_falls_from_the_glassy_one_to_the_relaxed_one():
    for time in (0.0, 0.03, 1.0, 20.0):
        assert SERIES.modulus(time) == pytest.approx(modulus(THREE, time), rel=1e-14)
    assert SERIES.modulus(0.0) == SERIES.factor(0.0) == 4.5
    assert SERIES.modulus(1e4) == pytest.approx(1.0)
    assert SERIES.factor(1e9) == pytest.approx(1.0, abs=1e-7)


@pytest.mark.parametrize("duration", [0.0, 1e-9, 1e-4, 4.9e-4, 5.1e-4, 0.03, 1.0, 40.0])
def test_springs_and_dashpots_of_a_step_are_those_of_quadrature(duration):
    """The stretch of a spring is w exp(-s) + r (1 - exp(-s)), s the time over the relaxation time, r = du / x."""
    decay, ramp_factor = SERIES.update_coefficients(duration)
    losses = SERIES.losses(duration)
    for i, time in enumerate(SERIES.times):
        x = duration / time
        assert decay[i] == pytest.approx(np.exp(-x), rel=1e-14)
        if x == 0.0:
            assert ramp_factor[i] == 1.0
            assert not losses[:, i].any()
            continue
        old, new = (lambda s: np.exp(-s)), (lambda s, x=x: -np.expm1(-s) / x)
        assert ramp_factor[i] == pytest.approx(new(x), rel=1e-13)
        pairs = ((old, old), (old, new), (new, new))
        expected = [quad(lambda s, f=f, g=g: f(s) * g(s), 0.0, x, epsabs=0.0, epsrel=1e-11)[0] for f, g in pairs]
        np.testing.assert_allclose(losses[:, i], expected, rtol=1e-8)


STEEP = PronySeries((4.0, 0.3, 20.0), (1e-6, 1e-2, 3.0))
ELASTIC = PronySeries((), ())


@pytest.mark.parametrize(
    "parts", [((1.0, SERIES), (1.0, STEEP)), ((0.2, SERIES), (0.8, ELASTIC)), ((0.5, STEEP), (0.5, STEEP))]
)
def test_the_creep_compliances_of_bodies_in_series_add_up(parts):
    """E(t) of the two together, and J = 1 / E, against the inverse Laplace transform of 1 / (s^2 sum J_i / s)."""
    both, whole = in_series(parts), sum(share for share, _ in parts)

    def transform(series, s):  # s times that of E(t), in many digits
        pairs = zip(series.moduli, series.times, strict=True)
        return 1 + sum(mp.mpf(m) * s * mp.mpf(tau) / (1 + s * mp.mpf(tau)) for m, tau in pairs)

    def modulus_of_both(s):
        return whole / sum(share / transform(series, s) for share, series in parts)

    for time in (1e-7, 1e-5, 1e-2, 0.7, 30.0):
        expected = mp.invertlaplace(lambda s: modulus_of_both(s) / s, time, method="talbot", degree=40)
        assert both.modulus(time) == pytest.approx(float(expected), rel=1e-11)
        compliance_of_both = sum(
            share * compliance(tuple(zip(series.moduli, series.times, strict=True)), time) if series.moduli else share
            for share, series in parts
        )
        own = tuple(zip(both.moduli, both.times, strict=True))
        assert compliance(own, time) == pytest.approx(compliance_of_both / whole, rel=1e-8)
    frequency = np.geomspace(1e-4, 1e8, 13)
    expected = whole / sum(share / series.complex_modulus(frequency) for share, series in parts)
    np.testing.assert_allclose(both.complex_modulus(frequency), expected, rtol=1e-11)
    assert len(both.times) <= sum(len(series.times) for _, series in parts)


def test_two_bodies_of_one_material_are_one_and_elastic_ones_none():
    both = in_series(((0.3, SERIES), (0.7, SERIES)))
    one, other = (sorted(zip(each.times, each.moduli, strict=True)) for each in (SERIES, both))
    np.testing.assert_allclose(other, one, rtol=1e-12)
    assert in_series(((0.5, ELASTIC), (0.5, ELASTIC))) == ELASTIC


def test_series_over_twelve_decades_add_up_too():
    draw, frequency = np.random.default_rng(0), np.geomspace(1e-5, 1e12, 60)
    for _ in range(50):
        sizes = draw.integers(1, 16, 2)
        each = [PronySeries(tuple(10 ** draw.uniform(-4, 2, n)), tuple(10 ** draw.uniform(-9, 3, n))) for n in sizes]
        parts = tuple(zip(draw.uniform(0.1, 1.0, 2), each, strict=True))
        expected = sum(share for share, _ in parts)
        expected /= sum(share / series.complex_modulus(frequency) for share, series in parts)
        both = in_series(parts)
        np.testing.assert_allclose(both.complex_modulus(frequency), expected, rtol=1e-7)
        assert min(*both.moduli, *both.times) > 0.0


def test_the_longest_retardation_is_the_slowest_root_of_the_modulus():
    moduli, times = np.array([0.5, 10.0, 2.0]), np.array([1.0, 0.3, 1e-3])
    slowest = PronySeries(tuple(moduli), tuple(times)).longest_retardation
    share = -times / slowest  # s tau at s = -1 / theta
    assert 1.0 + (moduli * share / (1.0 + share)).sum() == pytest.approx(0.0, abs=1e-9)
    assert slowest > times.max()  # where one root lies, as the others lie between the times
