"""Coupled stiffness against its defining formulae in high precision, its limits and the condensed stiffness."""

import mpmath
import numpy as np
import pytest
import slab_stiffness
import textbook

from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.body import ElasticBody

RATIOS = [-0.99, -0.5, 0.0, 0.2, 0.25, 0.33, 0.49, 0.4999, 0.499999, 0.4999999999, 0.5 - 2**-50]
WAVES = np.concatenate([np.logspace(-8, 2.5, 64), np.logspace(3, 8, 6)])


def digits(k):
    return 80 + int(min(k, 400))  # small k loses up to 40 digits, cosh^2 - sinh^2 loses k of them


def exact(k, nu):
    """C11 M11, C11 M13, C11 M33 in E* by (6.58), and the size of the two terms of M13; beyond k = 400 exp(-2k) is 0."""
    k, nu = mpmath.mpf(min(k, 400.0)), mpmath.mpf(nu)
    s = (1 - 2 * nu) / (2 * (1 - nu))
    r = (1 - s) / (1 + s)
    sinh, cosh = mpmath.sinh(k), mpmath.cosh(k)
    f = cosh**2 - (r * k) ** 2 - 1
    c11 = (1 - nu) ** 2 / (1 - 2 * nu)
    diagonal = c11 * (1 - r) / f
    coupling = c11 * (1 - r) / (1 + r) / f
    parts = coupling * (1 - r) * sinh**2, coupling * 2 * (r * k) ** 2
    return diagonal * (cosh * sinh - r * k), parts[0] - parts[1], diagonal * (cosh * sinh + r * k), parts[0] + parts[1]


def incompressible(k):
    """The same for nu = 1/2, where C11 (1 - r) -> 2 C44 = E*/2 and r -> 1 (limits of (6.58))."""
    k = mpmath.mpf(min(k, 400.0))
    f = mpmath.sinh(k) ** 2 - k**2
    half = mpmath.cosh(k) * mpmath.sinh(k)
    return (half - k) / f / 2, -(k**2) / f / 2, (half + k) / f / 2, k**2 / f / 2


def test_slab_is_6_58():
    for nu in RATIOS:
        values = np.array(slab_stiffness.slab_elements(WAVES[::2], nu)).T
        for k, (a11, a13, a33) in zip(WAVES[::2], values, strict=True):
            with mpmath.workdps(digits(k)):
                e11, e13, e33, size = exact(k, nu)
                assert abs(a11 / e11 - 1) < 1e-13
                assert abs(a33 / e33 - 1) < 1e-13
                assert abs(a13 - e13) < 1e-13 * size
                if nu <= 0.25:
                    assert abs(a13 / e13 - 1) < 1e-13


@pytest.mark.parametrize("nu", [*RATIOS, 0.5])
def test_the_compliance_of_a_body_is_the_inverse_of_6_58(nu):
    """Of the package itself, which makes every slab of layers; the elements above are those that other tests take."""
    for k, found in zip(
        WAVES[::3], np.transpose(ElasticBody(nu, 1.0).layers.compliance_times_q(WAVES[::3])), strict=True
    ):
        with mpmath.workdps(digits(k)):
            e11, e13, e33 = (incompressible(k) if nu == 0.5 else exact(k, nu))[:3]
            determinant = e11 * e33 - e13**2
            for value, element, whole in zip(found, (e33, e13, e11), (e33, mpmath.sqrt(e11 * e33), e11), strict=True):
                assert abs(value * determinant - element) < 1e-12 * whole


def test_coupling_keeps_its_digits_away_from_its_zero():
    for nu in RATIOS:
        for k in WAVES[::3]:
            with mpmath.workdps(digits(k)):
                e13, size = exact(k, nu)[1::2]
                if abs(e13) > 0.1 * size or nu <= 0.25:
                    assert abs(slab_stiffness.slab_elements(np.array([k]), nu)[1][0] / e13 - 1) < 1e-12


def test_incompressible_slab_is_finite():
    values = np.array(slab_stiffness.slab_elements(WAVES[:64], 0.5)).T
    for k, (a11, a13, a33) in zip(WAVES, values, strict=False):
        with mpmath.workdps(digits(k)):
            e11, e13, e33, _ = incompressible(k)
            assert abs(a11 / e11 - 1) < 1e-13
            assert abs(a33 / e33 - 1) < 1e-13
            assert abs(a13 / e13 - 1) < 1e-13
            near = exact(k, mpmath.mpf(1) / 2 - mpmath.mpf(10) ** -60)
            assert abs(a33 / near[2] - 1) < 1e-12


@pytest.mark.parametrize("nu", [*RATIOS, 0.5, -1e6])
def test_condensing_either_component_gives_the_other(nu):
    k = WAVES
    a11, a13, a33 = slab_stiffness.slab_elements(k, nu)
    tangential, normal = slab_stiffness.condensed_elements(k, nu)
    np.testing.assert_allclose(2 * normal, slab_stiffness.slab_factor(k, nu), rtol=1e-13)
    np.testing.assert_allclose(tangential * a33, normal * a11, rtol=1e-13)
    fair = abs(a13**2 / a11) < 0.9 * a33  # elsewhere the subtraction on the next line is what is wrong
    assert fair.any()
    np.testing.assert_allclose(normal[fair], (a33 - a13**2 / a11)[fair], rtol=1e-13)


@pytest.mark.parametrize("nu", RATIOS)
def test_principal_stiffness_is_the_spectrum(nu):
    for k in WAVES[::3]:
        low, high = textbook.principal_elements(np.array([k]), nu)
        with mpmath.workdps(digits(k)):
            e11, e13, e33, _ = exact(k, nu)
            mean, root = (e11 + e33) / 2, mpmath.sqrt(((e33 - e11) / 2) ** 2 + e13**2)
            assert abs(low[0] / (mean - root) - 1) < 1e-12
            assert abs(high[0] / (mean + root) - 1) < 1e-12


@pytest.mark.parametrize("nu", [*RATIOS, 0.5])
def test_deep_slab_is_the_half_space(nu):
    k = np.array([50.0, 1e3, 1e6, 1e8])
    for deep, limit in zip(slab_stiffness.slab_elements(k, nu), slab_stiffness.half_space_elements(nu), strict=True):
        np.testing.assert_allclose(deep, limit, rtol=1e-14, atol=1e-30)
    s = (1 - 2 * nu) / (2 * (1 - nu))
    shear = (1 - nu) / 2
    np.testing.assert_allclose(
        slab_stiffness.half_space_elements(nu), np.array([2, 2 * s, 2]) / (1 + s) * shear, rtol=1e-14
    )


@pytest.mark.parametrize("nu", RATIOS[:6])
def test_long_waves_become_the_uniform_modes(nu):
    a, q = 0.5, 1e-7
    a11, a13, a33 = (q * m[0] for m in slab_stiffness.slab_elements(np.array([q * a]), nu))
    shear, normal = slab_stiffness.uniform_stiffness(nu, a)
    assert a11 == pytest.approx(shear, rel=1e-10)
    assert a33 == pytest.approx(normal, rel=1e-10)
    assert abs(a13) < 1e-6 * shear
    assert normal == pytest.approx(slab_stiffness.uniform(nu, a), rel=1e-15)


def test_moduli_are_those_of_linear_elasticity():
    nu = 0.3
    assert moduli.c11(nu) == pytest.approx((1 - nu) ** 2 / (1 - 2 * nu))
    assert moduli.c11(nu, 0.1) == pytest.approx(10 * moduli.c11(nu))
    assert moduli.c11(0.5) == np.inf
    assert moduli.c44(0.3) / moduli.c11(0.3) == pytest.approx((1 - 2 * nu) / (2 * (1 - nu)))


def test_poissons_ratio_may_be_an_array():
    k, nu = np.array([[0.1], [3.0]]), np.array(RATIOS)
    for i, value in enumerate(slab_stiffness.slab_elements(k, nu)):
        assert value.shape == (2, len(RATIOS))
        np.testing.assert_array_equal(value[1, 3], slab_stiffness.slab_elements(k[1], RATIOS[3])[i][0])


@pytest.mark.parametrize(("k", "nu"), [(1.0, 0.51), (1.0, np.nan), (0.0, 0.3), (-1.0, 0.3), (np.nan, 0.3)])
def test_what_has_no_stiffness_is_refused(k, nu):
    with pytest.raises(ValueError, match=r"poissons_ratio|q z_m"):
        slab_stiffness.slab_elements(np.array([k]), nu)
