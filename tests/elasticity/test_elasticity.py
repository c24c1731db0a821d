"""Stiffness against the thesis's 2 x 2 matrix in high precision, and against its limits."""

import mpmath
import numpy as np
import pytest
import slab_stiffness

from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody

RATIOS = [-0.99, -0.5, 0.0, 0.2, 0.33, 0.49, 0.4999, 0.499999, 0.4999999999]


def condensed(k, nu):
    """Ratio to the half-space of M33 - M13^2 / M11 with (2.12) as corrected by (6.58), by mpmath."""
    k, nu = mpmath.mpf(k), mpmath.mpf(nu)
    r = 1 / (3 - 4 * nu)
    f = mpmath.sinh(k) ** 2 - (r * k) ** 2
    m11 = (1 - r) * (mpmath.cosh(k) * mpmath.sinh(k) - r * k) / f
    m33 = (1 - r) * (mpmath.cosh(k) * mpmath.sinh(k) + r * k) / f
    m13 = (1 - r) / (1 + r) * ((1 - r) * mpmath.sinh(k) ** 2 - 2 * (r * k) ** 2) / f
    c11 = (1 - nu) ** 2 / (1 - 2 * nu)  # in E*
    return 2 * c11 * (m33 - m13**2 / m11)


def incompressible(k):
    """f(k) of (4.12), by mpmath."""
    k = mpmath.mpf(k)
    return (mpmath.cosh(2 * k) + 2 * k**2 + 1) / (mpmath.sinh(2 * k) - 2 * k)


def relative_error(k, nu, exact):
    factors = (
        slab_stiffness.slab_factor(np.array([k]), nu),
        2 * ElasticBody(nu, 1.0).condensed_stiffness(np.array([k])) / k,
    )
    with mpmath.workdps(60 + int(k)):  # cosh^2 - sinh^2 loses k digits, small k loses up to 40
        return max(abs(float(factor[0] / exact() - 1)) for factor in factors)


@pytest.mark.parametrize("nu", RATIOS)
def test_slab_is_the_schur_complement(nu):
    for k in np.logspace(-8, 2.5, 29):
        assert relative_error(k, nu, lambda k=k: condensed(k, nu)) < 1e-14


def test_incompressible_slab_is_4_12():
    for k in np.logspace(-8, 2.5, 29):
        assert relative_error(k, 0.5, lambda k=k: incompressible(k)) < 1e-14


@pytest.mark.parametrize("nu", [*RATIOS, 0.5])
def test_deep_slab_is_the_half_space(nu):
    k = np.logspace(2.5, 8, 50)
    np.testing.assert_allclose(slab_stiffness.slab_factor(k, nu), 1.0, rtol=1e-15)
    q = np.array([0.0, 1e-3, 1e5])
    np.testing.assert_array_equal(stiffness.half_space(q), q / 2)


@pytest.mark.parametrize("nu", RATIOS)
def test_long_waves_see_uniform_compression(nu):
    q, a = np.array([1e-7]), 1e-3
    wave = 0.5 * q * slab_stiffness.slab_factor(q * a, nu)
    assert wave == pytest.approx(slab_stiffness.uniform(nu, a), rel=1e-8)
    c11 = (1 - nu) / ((1 + nu) * (1 - 2 * nu)) * (1 - nu**2)  # in E*
    assert slab_stiffness.uniform(nu, a) == pytest.approx(c11 / a, rel=1e-9)


def test_slab_puts_the_parts_together():
    q = 2 * np.pi * np.arange(5.0)
    values = slab_stiffness.slab(q, 0.33, 0.1)
    assert values[0] == slab_stiffness.uniform(0.33, 0.1)
    np.testing.assert_allclose(values[1:], q[1:] / 2 * slab_stiffness.slab_factor(q[1:] * 0.1, 0.33))
    assert np.isinf(slab_stiffness.slab(q, 0.5, 0.1)[0])
    assert np.isfinite(slab_stiffness.slab(q, 0.5, 0.1)[1:]).all()
