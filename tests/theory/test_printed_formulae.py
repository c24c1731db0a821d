"""Formulae of thesis chapter 6 that are misprinted or do not hold; docs/errata.md lists them."""

import numpy as np
import pytest
import regimes
import slab_stiffness
import slowest_mode
import textbook
from equilibrium_time import steps_to_equilibrium, time_constant

from gfmd_numba.elasticity import moduli
from gfmd_numba.theory import damping

SINH, COSH, PI = np.sinh, np.cosh, np.pi


def stiffnesses(k, a, s):
    """kappa_1, kappa_3 of one direction, the smaller and larger of the coupled slab, kappa_1(0) and kappa_3(0)."""
    nu, q = 1 - 0.5 / (1 - s), 2 * PI * k
    k = np.array(q * a)
    waves = q * np.array([*slab_stiffness.condensed_elements(k, nu), *textbook.principal_elements(k, nu)])
    return *waves, *slab_stiffness.uniform_stiffness(nu, a), moduli.c44(nu)


@pytest.mark.parametrize("a", [0.05, 0.3])
@pytest.mark.parametrize("k", [1, 2, 5])
def test_6_79_to_6_81_need_the_square_of_k(k, a):
    x = 4 * PI * k * a
    for power in (2, 1):
        top = 8 * k**power * a**2 * PI**2
        tangential, normal, _, _, shear, axial, _ = stiffnesses(k, a, 0.5)
        first = 2 * PI * k * a * (5 + top + 3 * COSH(x)) / (x + 3 * SINH(x)) / (tangential / shear)
        second = PI * k * a * (5 + top + 3 * COSH(x)) / (-x + 3 * SINH(x)) / (normal / axial)
        tangential, normal, _, _, shear, _, c44 = stiffnesses(k, a, 0.0)
        third = 4 * PI * k * a * (1 + top + COSH(x)) / (x + SINH(x)) / (tangential / shear)
        fourth = 4 * PI * k * (1 + top + COSH(x)) / (-x + SINH(x)) / (normal / c44)
        right = np.allclose([first, second, third, fourth], 1.0, rtol=1e-9, atol=0)
        assert right == (power == 2 or k == 1)
    printed = 4 * PI * k * a * (1 + 8 * k * a**2 * PI**2 + 4 * COSH(x)) / (-x + 3 * SINH(x)) / (normal / c44)
    assert abs(printed - 1) > 0.2


@pytest.mark.parametrize("a", [0.05, 0.3, 1.0])
@pytest.mark.parametrize("k", [1, 2])
def test_6_87_to_6_89_call_the_smaller_stiffness_1(k, a):
    """The forms are right, but with the minus they are kappa_3' of (6.84) and of the conclusions drawn."""
    x = 4 * PI * a * k
    below = -8 * PI**2 * a**2 * k**2 + 9 * COSH(x) - 9
    b1 = 3 * SINH(x) / below
    root = -24 * (PI * a * k * SINH(x / 2)) ** 2 + 16 * ((PI * a * k) ** 4 + (PI * a * k) ** 2) + 9 * SINH(x / 2) ** 4
    b2 = root / below**2
    _, _, smaller, larger, shear, axial, _ = stiffnesses(k, a, 0.5)
    assert 8 * PI * a * k * (b1 - b2**0.5) == pytest.approx(smaller / shear, rel=1e-9)
    assert 4 * PI * a * k * (b1 + b2**0.5) == pytest.approx(larger / axial, rel=1e-9)
    below = -8 * PI**2 * a**2 * k**2 + COSH(x) - 1
    mean, apart = SINH(x) / below, 4 * PI * k * np.sqrt(4 * PI**2 * a**4 * k**2 + a**2) / below
    _, _, smaller, larger, shear, _, _ = stiffnesses(k, a, 0.0)
    assert x * (mean - apart) == pytest.approx(smaller / shear, rel=1e-9)
    assert x * (mean + apart) == pytest.approx(larger / shear, rel=1e-9)


def test_6_43_is_the_reciprocal():
    """Two stiffnesses with one critical damping: the expression printed for kappa_a/kappa_b is kappa_b/kappa_a."""
    a, dt = 0.7, 0.9
    printed = (dt**2 * a - 4 * dt * a**0.5 + 4) / (dt**2 * a)
    assert damping.critical_damping(a * printed, dt) == pytest.approx(damping.critical_damping(a, dt))
    assert damping.critical_damping(a / printed, dt) != pytest.approx(damping.critical_damping(a, dt), rel=0.1)


def test_6_37_puts_the_unstable_regime_in_the_wrong_place():
    """xi = 2 (L - 1) < -2 is a negative root, which still decays; a mode grows for xi < -4."""
    x, y = np.array(2.0), np.array(0.9)  # dt sqrt(K) = sqrt(2), over-damped
    roots = np.array(regimes.roots(regimes.position_verlet.polynomial(x, y)))
    assert (2 * (roots - 1)).real.min() < -2
    assert regimes.growth(regimes.position_verlet.polynomial(x, y)) < 1
    assert steps_to_equilibrium(np.array([[2.0]]), np.array([0.9]), 1.0, [1.0], 1e-12, 1000) < 1000


def test_6_91_stiffer_waves_do_not_decay_faster():
    """All under-damped waves of a half-space decay alike; (6.91) has 1/tau grow by pi k E*/L_x dt / 2."""
    k, dt, eta = np.array([1.0, 4.0, 16.0, 64.0]), 0.05, 1.0
    waves = PI * k
    steps = steps_to_equilibrium(waves[:, None, None], np.array([eta]), dt, np.ones((4, 1)), 1e-14, 20000)
    assert np.ptp(steps) < 0.03 * steps.min()
    printed = 2 / (dt * (eta + waves))
    assert printed[0] > 40 * printed[-1]
    np.testing.assert_allclose(time_constant(waves, np.full(4, eta), dt), -2 * dt / np.log1p(-eta * dt**2))


def test_6_93_has_a_two_too_many():
    """(6.70) is pi k E*/L_x, not 2 pi k E*/L_x."""
    assert 1 / np.sqrt(slowest_mode.half_space_normal().stiffness) == pytest.approx(1 / np.sqrt(PI))


def test_6_15_over_damped_motion_reaches_the_same_equilibrium():
    """Section 6.1 and 6.2 have it come to rest elsewhere: the fixed point does not depend on the damping."""
    stiffness, force, dt = 1.0, 0.3, 0.1
    u = old = 0.0
    for _ in range(4000):
        u, old = 2 * u - old + dt**2 * (force - stiffness * u + 10 / dt * (old - u)), u
    assert u == pytest.approx(force / stiffness, rel=1e-12)


@pytest.mark.parametrize("adhesion", [0.4, -0.4])
def test_6_117_adhesion_softens_every_wave_by_the_same(adhesion):
    """With the potential (6.109) the force rises towards the punch: K - dgamma/z_r^2 exp(-g/z_r), with no factor q.

    Printed is K + q dgamma/z_r^2; the conclusion of 6.6.1 that adhesion raises the critical damping is reversed.
    """
    nx, reach, gap = 64, 0.5, 0.3
    x = np.arange(nx) / nx
    for k in (1, 5, 20):
        u = 1e-6 * np.cos(2 * PI * k * x)

        def energy(u, k=k):
            return -adhesion * np.exp(-(gap - u) / reach).sum()

        force = np.empty(nx)
        for i in range(nx):
            kick = np.zeros(nx)
            kick[i] = 1e-5
            force[i] = -(energy(u + kick) - energy(u - kick)) / 2e-5
        slope = (np.fft.rfft(force)[k] / np.fft.rfft(u)[k]).real
        assert -slope == pytest.approx(-adhesion / reach**2 * np.exp(-gap / reach), rel=1e-3)
