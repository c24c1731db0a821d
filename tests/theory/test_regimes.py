"""Roots, regimes and limits of the schemes against marching them and against a dense eigenvalue solver."""

import numpy as np
import pytest
import regimes
import slab_stiffness
import textbook
from regimes import gronbech_jensen, position_verlet

from gfmd_numba.solvers import dynamics
from gfmd_numba.theory import damping


def verlet_matrix(x, y):
    """Step of (r, dt v) by (6.34), with dt = 1."""
    return np.array([[1 - x, 1 - y], [-x, 1 - y]])


def gronbech_jensen_matrix(x, y):
    """Step of (r, dt v) by (6.38) as printed, with dt = 1: displacement first, then velocity with the new force."""
    a, b = (1 - y / 2) / (1 + y / 2), 1 / (1 + y / 2)
    position = np.array([1 - b * x / 2, b])
    return np.array([position, np.array([-x * a / 2, a]) - x / 2 * position])


MATRICES = [(position_verlet, verlet_matrix), (gronbech_jensen, gronbech_jensen_matrix)]
X, Y = np.meshgrid(np.linspace(0.013, 4.9, 41), np.linspace(0.017, 5.1, 43))


def distance(a, b):
    """How far two sets of roots lie apart, in whatever order."""
    apart = abs(np.ravel(a)[:, None] - np.ravel(b))
    return max(apart.min(axis=0).max(), apart.min(axis=1).max())


@pytest.mark.parametrize(("scheme", "matrix"), MATRICES)
def test_roots_are_the_eigenvalues_of_a_step(scheme, matrix):
    larger, smaller = regimes.roots(scheme.polynomial(X, Y))
    growth = regimes.growth(scheme.polynomial(X, Y))
    for i, j in np.ndindex(X.shape):
        expected = np.linalg.eigvals(matrix(X[i, j], Y[i, j]))
        assert distance([larger[i, j], smaller[i, j]], expected) < 1e-10
        assert growth[i, j] == pytest.approx(abs(expected).max(), abs=1e-10)


@pytest.mark.parametrize(("scheme", "matrix"), MATRICES)
def test_regimes_are_what_the_motion_does(scheme, matrix):
    names = regimes.regime(scheme.polynomial(X, Y))
    growth = regimes.growth(scheme.polynomial(X, Y))
    assert set(names.flat) == set(regimes.Regime)
    for i, j in np.ndindex(X.shape):
        step = matrix(X[i, j], Y[i, j])
        eigenvalues = np.linalg.eigvals(step)
        if abs(growth[i, j] - 1) > 1e-3:  # what 4000 steps can tell
            with np.errstate(over="ignore", invalid="ignore"):
                decays = abs(np.linalg.matrix_power(step, 4000)).max() < 1.0
            assert decays == (names[i, j] != "unstable")
        if names[i, j] != "unstable":
            assert (abs(eigenvalues.imag).max() > 0) == (names[i, j] == "under-damped")


@pytest.mark.parametrize(("scheme", "matrix"), MATRICES)
@pytest.mark.parametrize("x", [0.01, 0.5, 1.0, 2.5, 3.9])
def test_lines_separate_the_regimes(scheme, matrix, x):
    def name(y):
        return str(regimes.regime(scheme.polynomial(np.array(x), np.array(y))))

    critical, limit = scheme.critical(np.array(x)), min(float(scheme.stability(np.array(x))), 1e6)
    assert name(0.9999 * critical) == "under-damped"
    assert name(1.0001 * critical) == "over-damped"
    assert name(0.9999 * limit) == "over-damped"
    assert abs(np.linalg.eigvals(matrix(x, 0.9999 * limit))).max() < 1
    if scheme is position_verlet:
        assert name(1.0001 * limit) == "unstable"
        assert abs(np.linalg.eigvals(matrix(x, 1.0001 * limit))).max() > 1


def test_critical_line_is_the_critical_damping():
    stiffness, dt = np.array([0.3, 2.0, 7.0]), 0.4
    eta = damping.critical_damping(stiffness, dt)
    np.testing.assert_allclose(eta * dt**2, position_verlet.critical(stiffness * dt**2))


def test_gronbech_jensen_keeps_the_critical_damping_of_the_oscillator_to_second_order():
    x = np.array([1e-4, 4e-4])
    exact = 2 * np.sqrt(x)
    np.testing.assert_allclose(1 - gronbech_jensen.critical(x) / exact, x / 8, rtol=1e-3)
    np.testing.assert_allclose(1 - position_verlet.critical(x) / exact, np.sqrt(x) / 2, rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "coefficients"),
    [("position_verlet", dynamics.position_verlet), ("gronbech_jensen", dynamics.gronbech_jensen)],
)
def test_integrators_have_these_roots(name, coefficients):
    """What the solvers step with is critical for the softest mode and stable for the stiffest by this theory."""
    softest, stiffest = 0.3, 20.0
    scheme = getattr(regimes, name)
    memory, push = coefficients(softest, stiffest, 0.999, 1.0)
    roots = [(1 + memory - push * k, np.array(memory)) for k in (softest, stiffest)]
    larger, smaller = regimes.roots(roots[0])
    assert abs(larger - smaller) < 1e-6
    assert regimes.regime(roots[1]) != "unstable"
    y = 1 - memory if name == "position_verlet" else 2 * (1 - memory) / (1 + memory)
    factor = 1.0 if name == "position_verlet" else 1 / (1 + y / 2)
    x = np.array([softest, stiffest]) * push / factor
    theory = scheme.polynomial(x, np.full(2, y))
    np.testing.assert_allclose(theory[0], [roots[0][0], roots[1][0]], rtol=1e-12)
    np.testing.assert_allclose(theory[1], memory, rtol=1e-12)
    assert scheme.critical(x[0]) == pytest.approx(y, rel=1e-6)


def test_formal_stability_limit_is_not_enough():
    """x = 3.9 is within the printed limit x <= 4 and grows once damped by more than 0.05."""
    x = np.array(3.9)
    assert regimes.growth(position_verlet.polynomial(x, np.array(0.04))) < 1
    assert regimes.growth(position_verlet.polynomial(x, np.array(0.06))) > 1
    assert regimes.growth(gronbech_jensen.polynomial(x, np.array(50.0))) < 1


@pytest.mark.parametrize("scheme", [position_verlet, gronbech_jensen])
def test_damping_with_the_sign_of_6_2_feeds_the_motion(scheme):
    x = np.array(0.5)
    assert regimes.regime(scheme.polynomial(x, np.array(-0.01))) == "unstable"
    assert regimes.growth(scheme.polynomial(x, np.array(-0.01))) > 1
    assert regimes.growth(scheme.polynomial(x, np.array(0.01))) < 1


def test_every_critically_damped_mode_has_a_double_root():
    """Mode-dependent damping: each mode has the double root 1 - dt sqrt(K) of its own stiffness."""
    stiffness, dt = np.geomspace(0.01, 9.0, 20), 0.3
    eta = damping.critical_damping(stiffness, dt)
    radius = regimes.spectral_radius(stiffness[:, None, None], eta[:, None], dt)
    np.testing.assert_allclose(radius, abs(1 - dt * np.sqrt(stiffness)), atol=1e-7)


@pytest.mark.parametrize("dt", [0.1, 0.5, 0.63])
def test_scalar_damping_is_the_largest_that_over_damps_nothing(dt):
    stiffness = np.geomspace(0.05, 9.0, 60)
    eta = textbook.scalar_damping(stiffness, dt)

    def names(factor):
        x, y = stiffness * dt**2, np.full(60, factor * eta * dt**2)
        return set(regimes.regime(position_verlet.polynomial(x, y)))

    assert names(1 - 1e-9) == {"under-damped"}
    assert "over-damped" in names(1 + 1e-9)
    softest_decides = dt * (stiffness[0] ** 0.5 + stiffness[-1] ** 0.5) <= 2
    assert (eta == damping.critical_damping(stiffness[0], dt)) == softest_decides


def coupled_waves(nu, a, indices):
    q = 2 * np.pi * np.asarray(indices)
    a11, a13, a33 = (q * m for m in slab_stiffness.slab_elements(q * a, nu))
    return np.moveaxis(np.array([[a11, a13], [a13, a33]]), -1, 0)


def test_update_matrix_is_6_62_with_its_sign_corrected():
    """The step on complex (u1, u3) with the Hermitian matrix of (6.57); (6.62) prints -i in both corners."""
    stiffness = coupled_waves(0.49, 0.1, [1])
    (m11, m13), (_, m33) = stiffness[0]
    dt, eta = 0.2, np.array([2.0, 5.0])
    hermitian = np.array([[m11, -1j * m13], [1j * m13, m33]])
    damp = np.diag(eta)
    expected = np.block(
        [[np.eye(2) - dt**2 * hermitian, dt * np.eye(2) - dt**3 * damp], [-dt * hermitian, np.eye(2) - dt**2 * damp]]
    )
    ours = regimes.update_matrix(stiffness, eta, dt)[0]
    np.testing.assert_allclose(np.poly(ours), np.poly(expected), atol=1e-12)
    printed = expected.copy()
    printed[[1, 3], [0, 0]] *= -1
    assert abs(np.poly(printed) - np.poly(expected)).max() > 0.01


def test_one_damping_for_both_components_separates_the_principal_stiffnesses():
    """With eta_1 = eta_3 a coupled wave is two oscillators of stiffness kappa_1' and kappa_3' (6.84)."""
    nu, a, dt, eta = 0.3, 0.2, 0.1, 3.0
    matrix = regimes.update_matrix(coupled_waves(nu, a, [1, 2]), np.full((2, 2), eta), dt)
    q = 2 * np.pi * np.array([1, 2])
    parts = np.array(textbook.principal_elements(q * a, nu)) * q
    expected = np.array(regimes.roots(position_verlet.polynomial(parts * dt**2, eta * dt**2 + 0 * parts)))
    for i in range(2):
        assert distance(np.linalg.eigvals(matrix[i]), expected[:, :, i]) < 1e-12


@pytest.mark.parametrize(("nu", "a"), [(0.0, 0.5), (0.3, 0.1), (0.3, 1.0), (0.49, 1.0), (0.4999, 0.05)])
def test_no_vector_damping_beats_the_scalar_one(nu, a):
    """The uniform tangential mode sees eta_1 alone, and at its critical damping bounds the rate for every eta_3."""
    tangential, normal = slab_stiffness.uniform_stiffness(nu, a)
    modes = np.concatenate([[np.diag([float(tangential), float(normal)])], coupled_waves(nu, a, range(1, 60))])
    dt = 0.5 / np.sqrt(np.linalg.eigvalsh(modes).max())
    eta = damping.critical_damping(float(tangential), dt)

    def slowest(eta_1, eta_3):
        return regimes.spectral_radius(modes, np.array([eta_1, eta_3]), dt).max()

    scalar = slowest(eta, eta)
    assert scalar == pytest.approx(1 - dt * np.sqrt(tangential), abs=1e-7)
    assert slowest(eta, 0.9 * eta) > scalar + 1e-7
    for eta_1 in eta * np.array([0.5, 0.9, 1.1, 2.0]):
        assert min(slowest(eta_1, ratio * eta) for ratio in np.geomspace(0.5, 20, 30)) > scalar + 1e-5
    assert min(slowest(eta, ratio * eta) for ratio in np.geomspace(0.5, 20, 30)) > scalar - 1e-7
    if nu > 0.45:  # each uniform mode critically damped (6.65) over-damps the waves
        assert slowest(eta, damping.critical_damping(float(normal), dt)) > scalar + 1e-5
