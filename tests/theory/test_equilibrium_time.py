"""Equilibrium time against marching modes one step at a time."""

import equilibrium_time as et
import numpy as np
import pytest
import slab_stiffness
import textbook

from gfmd_numba.theory import damping
from support.cases import some_of


def march(stiffness, eta, dt, start, tolerance, steps):
    """Last step with |u| above tolerance, plus one, with plain complex 2 x 2 matrices and velocities as (6.55)."""
    u, v, last = np.array(start, dtype=complex), np.zeros(len(start)), 0
    for n in range(1, steps + 1):
        v = v - dt * stiffness @ u - dt**2 * eta * v
        u = u + dt * v
        if np.linalg.norm(u) > tolerance:
            last = n
    return last + 1


@pytest.mark.parametrize("dt", [pytest.param(0.05, marks=pytest.mark.long), 0.5])
@pytest.mark.parametrize("ratio", [0.3, 0.99, 1.0, 1.5])
def test_steps_are_counted_as_marched(dt, ratio):
    rng = np.random.default_rng(3)
    root = rng.normal(size=(5, 2, 2))
    stiffness = root @ root.transpose(0, 2, 1) + 0.3 * np.eye(2)
    stiffness *= 3.0 / np.linalg.eigvalsh(stiffness).max()
    eta = ratio * np.array([1.0, 1.3]) * textbook.scalar_damping(np.linalg.eigvalsh(stiffness), dt)
    start = rng.normal(size=(5, 2)) + 1j * rng.normal(size=(5, 2))
    steps = et.steps_to_equilibrium(stiffness, eta, dt, start, 1e-9, 100000)
    for i in range(5):
        assert steps[i] == march(stiffness[i], eta, dt, start[i], 1e-9, steps[i] + 500)


def test_what_does_not_come_to_rest_says_so():
    one = np.ones((1, 1))
    both = et.steps_to_equilibrium(one, np.array([[1e6], [1.0]]), 0.1, [1.0], 1e-6, 500)
    assert both[0] == 501
    assert both[1] == march(one, np.array([1.0]), 0.1, [1.0], 1e-6, 500)
    assert et.steps_to_equilibrium(one, 0 * one[0], 0.1, [1.0], 1e-6, 500) == 501
    assert et.steps_to_equilibrium(one, 1e6 * one[0], 0.1, [1.0], 1e-6, 500) == 501
    assert et.steps_to_equilibrium(one, one[0], 0.1, [1.0], 1e-6, 50) == 51


@pytest.mark.parametrize("stiffness", [0.01, 40.0])
@pytest.mark.parametrize("z", some_of([3e-3, 0.3, 0.9], 0, 2))
@pytest.mark.parametrize("fraction", [1e-4, pytest.param(1e-14, marks=pytest.mark.long)])
def test_critical_equilibrium_time_is_the_marched_one(stiffness, z, fraction):
    dt = z / np.sqrt(stiffness)
    eta = np.array([damping.critical_damping(stiffness, dt)])
    steps = et.steps_to_equilibrium(np.array([[stiffness]]), eta, dt, [1.0], fraction, 10**5)
    predicted = et.critical_equilibrium_time(np.array(stiffness), dt, fraction) / dt
    assert steps == np.ceil(predicted)


def test_the_critical_equilibrium_time_of_the_oscillator_has_its_closed_form():
    """For dt -> 0 it solves (1 + x) exp(-x) = fraction, and is independent of dt to first order only."""
    x = float(et.critical_equilibrium_time(np.array(1.0), 1e-7, 1e-16))
    assert (1 + x) * np.exp(-x) == pytest.approx(1e-16, rel=1e-4)
    assert x == pytest.approx(40.6, abs=0.05)
    z = np.array([1e-3, 2e-3])
    shorter = [1 - et.critical_equilibrium_time(np.array(1.0), dt, 1e-16) / x for dt in z]
    np.testing.assert_allclose(shorter, z * shorter[0] / z[0], rtol=1e-2)
    assert shorter[0] > 4e-4


@pytest.mark.parametrize(("fraction", "gain"), [(1e-6, 0.772), (1e-14, 0.876)])
def test_just_below_critical_damping_is_fastest(fraction, gain):
    dt = 0.005
    ratios = np.linspace(0.93, 1.01, 401)
    eta = ratios[:, None] * damping.critical_damping(1.0, dt)
    steps = et.steps_to_equilibrium(np.ones((1, 1)), eta, dt, [1.0], fraction, 10**5)
    assert ratios[steps.argmin()] == pytest.approx(et.fastest_damping_ratio(fraction), abs=2e-3)
    critical = et.critical_equilibrium_time(np.array(1.0), dt, fraction) / dt
    assert steps.min() / critical == pytest.approx(gain, abs=2e-3)


@pytest.mark.parametrize("ratio", [0.2, 0.8, 1.0, 1.2, 3.0])
def test_time_constant_is_the_decay_of_the_motion(ratio):
    stiffness, dt = 2.0, 0.05
    eta = ratio * damping.critical_damping(stiffness, dt)
    tau = et.time_constant(np.array(stiffness), np.array(eta), dt)
    matrix = np.array([[1 - stiffness * dt**2, dt - eta * dt**3], [-stiffness * dt, 1 - eta * dt**2]])
    steps = np.array([20, 60]) * int(tau / dt)
    sizes = [np.linalg.norm(np.linalg.matrix_power(matrix, n)) for n in steps]
    measured = (steps[1] - steps[0]) * dt / np.log(sizes[0] / sizes[1])
    assert tau == pytest.approx(measured, rel=0.03)
    printed = 2 / (dt * (eta + stiffness))
    assert (abs(printed / tau - 1) < 0.05) == (ratio in (0.8, 1.0))


def test_time_constant_of_an_under_damped_mode_does_not_depend_on_its_stiffness():
    tau = et.time_constant(np.array([1.0, 2.0, 5.0]), np.array(0.3), 0.1)
    np.testing.assert_allclose(tau, -0.2 / np.log1p(-0.3 * 0.01))
    assert et.time_constant(np.array(1.0), np.array(0.0), 0.1) == np.inf
    assert et.time_constant(np.array(1.0), np.array(300.0), 0.1) < 0


def fastest(stiffness, start, dt, guesses):
    """Scalar damping with the least equilibrium time of all modes from the step (6.98), and that time."""
    steps = et.steps_to_equilibrium(stiffness, guesses[:, None, None], dt, start, 1e-16, 4000).max(axis=1)
    return guesses[steps.argmin()], steps.min() * dt


def slope(x, y):
    return np.polyfit(np.log(x), np.log(y), 1)[0]


@pytest.mark.long
def test_the_fastest_damping_of_a_half_space_is_found_by_marching():
    """(6.105), (6.106), Tab. 6.1 and Fig. 6.22: powers of L_x, E* and dt, found without any formula for the damping."""
    k = np.array([1, 2, 3, 10, 30])
    guesses = np.geomspace(0.5, 6.0, 300)

    def simulate(width=64, modulus=0.7, dt=0.15):
        stiffness = np.pi * k * modulus / width
        return fastest(stiffness[:, None, None], 0.01 / (1 + k)[:, None], dt, guesses)

    cases = {
        "width": ([32, 64, 128], -0.5, 0.5),
        "modulus": ([0.35, 0.7, 1.4], 0.5, -0.5),
        "dt": ([0.1, 0.15, 0.2], -1, 0),
    }
    for name, (values, of_eta, of_time) in cases.items():
        eta, times = np.transpose([simulate(**{name: value}) for value in values])
        assert slope(values, eta) == pytest.approx(of_eta, abs=0.06)
        assert slope(values, times) == pytest.approx(of_time, abs=0.06)


@pytest.mark.long
@pytest.mark.parametrize("nu", [0.3, 0.49])
def test_the_fastest_damping_of_a_slab_is_found_by_marching(nu):
    """Fig. 6.20: least at eta_1 critical for the uniform tangential mode, and eta_3 does not matter over a range."""
    k, nx, a, dt = np.array([1, 2, 3, 10, 30]), 64, 1.0, 0.5
    modulus, q = 0.7 / (1 - nu**2), 2 * np.pi * k / nx
    a11, a13, a33 = (modulus * q * m for m in slab_stiffness.slab_elements(q * a * nx, nu))
    uniform = modulus / nx * np.diag([float(m) for m in slab_stiffness.uniform_stiffness(nu, a)])
    of_modes = np.concatenate([uniform[None], np.moveaxis(np.array([[a11, a13], [a13, a33]]), -1, 0)])
    start = 0.01 / (1 + np.append(0, k))[:, None] * np.array([1, -1j])
    ratios = np.array([0.3, 0.6, 0.9, 1.05, 1.2, 1.4, 1.6, 2.0])
    one = np.linspace(0.1, 0.5, 101)
    eta = np.stack(np.broadcast_arrays(one, ratios[:, None] * one), -1)[:, :, None, :]
    times = et.steps_to_equilibrium(of_modes, eta, dt, start, 1e-16, 2000).max(axis=-1) * dt
    row, column = np.unravel_index(times.argmin(), times.shape)
    critical = damping.critical_damping(0.7 / (2 * a * nx * (1 + nu)), dt)
    assert one[column] == pytest.approx(critical, rel=0.08)
    assert ratios[row] > 1
    assert (times[3:, column] < 1.03 * times.min()).all()
    assert (times[:2, column] > 1.2 * times.min()).all()
