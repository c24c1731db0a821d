"""Softest modes against the printed closed forms in high precision and against all waves of a slab."""

import mpmath
import numpy as np
import pytest
import slab_stiffness
import slowest_mode

from gfmd_numba.elasticity import moduli, stiffness

ASPECTS = [0.003, 0.05, 0.2, 0.5, 1.0, 4.0]


def poissons_ratio(s):
    return 1 - 1 / (2 * (1 - s))


def printed(k, a, s):
    """kappa_1 and kappa_3 of (6.78) over C44/L_x."""
    pi = mpmath.pi
    top = 4 * pi * k * (8 * pi**2 * a**2 * k**2 * (s - 1) ** 2 - (s**2 - 1) * mpmath.cosh(4 * pi * a * k) + s**2 + 1)
    wide, thin = (s + 1) * mpmath.sinh(4 * pi * a * k), 4 * pi * a * k * (s - 1)
    return top / (wide - thin), top / (wide + thin)


def brute(matrices):
    return np.linalg.eigvalsh(matrices)[:, 0]


@pytest.mark.parametrize("s", [0.001, 0.2, 0.5, 0.9])
@pytest.mark.parametrize("a", ASPECTS)
def test_switch_is_6_82(a, s):
    """f1 and f3 as printed, which the two stiffnesses of (6.78) give; small f is a difference of large terms."""
    with mpmath.workdps(60):
        tangential, normal = printed(1, mpmath.mpf(a), mpmath.mpf(s))
        for case, wave, uniform in (("f1", tangential, 1 / mpmath.mpf(a)), ("f3", normal, 1 / (mpmath.mpf(a) * s))):
            assert abs(float(slowest_mode.switch(case, a, s)) - float(wave - uniform)) < 1e-11 * uniform


@pytest.mark.parametrize("s", [0.02, 0.3, 0.5, 0.9])
@pytest.mark.parametrize("a", ASPECTS)
def test_coupled_switches_are_differences_of_eigenvalues(a, s):
    nu, q = poissons_ratio(s), 2 * np.pi
    a11, a13, a33 = (q * m / moduli.c44(nu) for m in slab_stiffness.slab_elements(np.array(q * a), nu))
    low, high = np.linalg.eigvalsh(np.array([[a11, a13], [a13, a33]]))
    expected = {"f1'": high - 1 / (a * s), "f3'": low - 1 / (a * s), "f3''": low - 1 / a}
    for case, value in expected.items():
        assert slowest_mode.switch(case, a, s) == pytest.approx(value, abs=1e-10 * high)


def test_softest_modes_of_the_half_space_are_6_70_and_6_84():
    """(6.70), (6.84), and for nu = 1/2 no coupling (6.86)."""
    assert slowest_mode.half_space_normal().stiffness == pytest.approx(stiffness.half_space(2 * np.pi), rel=1e-15)
    for nu in (-0.9, 0.0, 0.3, 0.5):
        young = 1 - nu**2  # E in E*
        expected = 2 * np.pi * young / (3 - nu - 4 * nu**2)
        assert slowest_mode.half_space_coupled(nu).stiffness == pytest.approx(expected, rel=1e-14)
    assert slowest_mode.half_space_coupled(0.5).stiffness == pytest.approx(np.pi)
    assert slowest_mode.slab_coupled(0.3, 50.0).stiffness < slowest_mode.half_space_coupled(0.3).stiffness


def test_the_uniform_mode_of_a_slab_is_6_66():
    """(6.66) with E in E*."""
    nu, a = 0.3, 0.7
    assert slowest_mode.uniform_slab(nu, a) == pytest.approx(((1 - nu**2) / (2 * a * (1 + nu)), 0, "tangential"))
    assert slowest_mode.uniform_slab(0.5, a).stiffness == pytest.approx(0.25 / a)


@pytest.mark.parametrize("nu", [-5.0, -0.9, 0.0, 0.2, 0.3, 0.45, 0.5])
@pytest.mark.parametrize("a", ASPECTS)
def test_the_softest_mode_is_the_softest_of_all(nu, a):
    index = np.arange(1, 4000)
    q = 2 * np.pi * index
    a11, a13, a33 = (q * m for m in slab_stiffness.slab_elements(q * a, nu))
    shear, normal = slab_stiffness.uniform_stiffness(nu, a)
    with np.errstate(invalid="ignore"):
        candidates = {
            "tangential": (shear, q * slab_stiffness.condensed_elements(q * a, nu)[0]),
            "normal": (normal, q / 2 * slab_stiffness.slab_factor(q * a, nu)),
        }
    candidates["mixed"] = shear, brute(np.moveaxis(np.array([[a11, a13], [a13, a33]]), -1, 0))
    for name, (uniform, waves) in candidates.items():
        mode = (
            slowest_mode.slab_coupled(nu, a) if name == "mixed" else slowest_mode.one_direction(nu, a, name)  # type: ignore[arg-type]
        )
        assert mode.stiffness == pytest.approx(min(uniform, waves.min()), rel=1e-6)
        if mode.wave_index:
            assert mode.stiffness == pytest.approx(waves[mode.wave_index - 1], rel=1e-6)


def test_uniform_tangential_mode_is_softest_for_every_ordinary_slab():
    """(6.90): eta = (eta_1(0), eta_1(0)), for 0 <= nu <= 1/2 and down to where long waves become softer."""
    for nu in np.linspace(-0.18, 0.5, 11):
        for a in np.geomspace(1e-3, 10, 15):
            assert slowest_mode.slab_coupled(nu, a)[1:] == (0, "tangential")
    assert slowest_mode.slab_coupled(-0.19, 0.03)[1:] == (1, "mixed")


def test_softest_wave_of_a_thin_incompressible_slab_is_not_the_first():
    """6.3.3 says k = 1 for any a; q f(q z_m) of (6.74) has its minimum at q z_m = 2.12."""
    for a, index in ((1.0, 1), (0.25, 1), (0.2, 2), (0.1, 3), (0.01, 34)):
        mode = slowest_mode.incompressible_slab(a)
        assert mode.wave_index == index
        with mpmath.workdps(40):

            def force_constant(k, a=a):
                x = 4 * mpmath.pi * mpmath.mpf(a) * k
                return mpmath.pi * k * (x**2 / 2 + mpmath.cosh(x) + 1) / (mpmath.sinh(x) - x)

            values = [float(force_constant(k)) for k in range(1, 60)]
        assert mode.stiffness == pytest.approx(min(values), rel=1e-12)
        assert values.index(min(values)) + 1 == index


def test_thin_limit_of_the_frictionless_switch_is_a_quarter():
    """Below nu = 1/4 long waves are stiffer than the uniform mode, above softer (Fig. 6.12)."""
    s = (1 - 2 * 0.25) / (2 * (1 - 0.25))
    assert slowest_mode.switch("f3", 0.01, 1.01 * s) > 0
    assert slowest_mode.switch("f3", 0.01, 0.99 * s) < 0
