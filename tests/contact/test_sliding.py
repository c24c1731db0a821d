"""A punch that slides steadily over a body that creeps: closed forms, limits, the energy, and hard cases."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ive, kve

import gfmd_numba
from gfmd_numba.contact.evaluation import hysteretic_friction_error
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import LoadStep
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.prony import PronySeries
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.roughness.surfaces import given_surface
from gfmd_numba.solvers.table import Options
from support.viscoelastic import STANDARD, THREE, in_a_window, relaxation

pytestmark = pytest.mark.filterwarnings("ignore:at .* waves of")  # limits
GRADIENT = 0.01


def solved(series, speed, load=0.05, dimension=1, eps_c=1 / 4, seed=3, **body):
    """The dataset of a rough punch that slides, without a speed does not, over a body, elastic without a series."""
    whole = {"poissons_ratio": 0.5} | body | ({} if series is None else {"relaxation": relaxation(series)})
    found = gfmd_numba.solve(
        {
            "scene": {
                "dimension": dimension,
                "body": whole,
                "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": GRADIENT},
                "interface": {"hard_wall": {}},
                "loading": {"reduced_pressure": load} | ({} if speed is None else {"speed": speed}),
            },
            "discretisation": {"eps_c": eps_c, "eps_f": 1 / 16, "eps_t": 1 / 2},
            "seed": seed,
        }
    )
    assert not found["status"].any()
    return found


def complex_modulus(series, frequency):
    """E' + i E'' over the relaxed modulus, by its definition."""
    return 1.0 + sum(m * 1j * frequency * tau / (1.0 + 1j * frequency * tau) for m, tau in series)


@pytest.mark.parametrize("speed", np.geomspace(1e-4, 1e2, 3))
def test_friction_of_a_wave_in_full_contact_is_the_loss_modulus(speed):
    """q^2 A^2 Im E(q v) / 4 on a half-space; on a slab times what it is stiffer by."""
    waves, amplitude, x = 3, 1e-3, np.arange(64) / 64
    q = 2.0 * np.pi * waves
    profile = amplitude * np.cos(q * x)
    for heights in (profile, profile * np.ones((64, 1))):
        scene = {
            "dimension": heights.ndim,
            "body": {"poissons_ratio": 0.5, "relaxation": relaxation(THREE)},
            "roughness": {"method": "measured"},
            "interface": {"hard_wall": {}},
            "loading": {"reduced_pressure": 50.0, "speed": speed},
        }
        found = gfmd_numba.solve({"scene": scene}, heights=heights)
        friction = q**2 * amplitude**2 * complex_modulus(THREE, q * speed).imag / 4.0
        assert float(found["contact_area_fraction"]) == 1.0
        assert float(found["hysteretic_friction"] * found["mean_pressure"]) == pytest.approx(friction, rel=1e-9)
        assert float(found["hysteretic_friction_error"]) <= 1e-9 * float(found["hysteretic_friction"])
        front = float((found["pressure"] * np.sin(q * x)).mean())  # an asperity's front is where it falls
        assert front > 0.0


def rolling(load, radius, modulus, lag):
    """Half-width of contact, way of its middle ahead of the lowest point, and friction of a cylinder (Hunter, 1961).

    J. Appl. Mech. 28:611, on a standard solid of E* = 1 and one branch; `lag` is speed times its relaxation time. With
    P = p - lag p' and W = u - (1 + modulus) lag u', which are those of an elastic half-space, W is known in the
    contact; p = 0 at both ends and u bounded in front give two conditions, by integrals that are Bessel functions.
    """
    longer = (1.0 + modulus) * lag

    def middle(width):
        back, front = ive(1, width / lag) / ive(0, width / lag), kve(1, width / longer) / kve(0, width / longer)
        shift = modulus * lag * back / (back + front)
        return shift, np.pi * width**2 / (4.0 * radius) * (1.0 + 2.0 * shift * front / width)

    width = brentq(lambda width: middle(width)[1] - load, 1e-9 * radius, radius, xtol=1e-14)
    shift, _ = middle(width)
    moment = (shift - lag) * load + np.pi * width**2 * (longer - shift) / (4.0 * radius)
    return width, shift, moment / (radius * load)


@pytest.mark.parametrize("lag", [2e-4, 1e-2])
def test_a_cylinder_rolls_as_hunter_says(lag):
    """In a period of 140 half-widths; lags are 0.03 and 1.4 of these."""
    radius, modulus, width = 1.0, 3.0, 1.0 / 140.0
    load = np.pi * width**2 / (4.0 * radius)
    found = gfmd_numba.solve(
        {
            "scene": {
                "length": 1.0,
                "body": {
                    "youngs_modulus": 0.75,
                    "poissons_ratio": 0.5,
                    "relaxation": relaxation(((modulus, 1.0),), 0.75),
                },
                "form": {"radius": radius, "points": 8192},
                "interface": {"hard_wall": {}},
                "loading": {"line_load": load, "speed": lag},
            }
        }
    )
    width, shift, friction = rolling(load, radius, modulus, lag)
    assert float(found["contact_radius"]) == pytest.approx(width, rel=3e-3)
    x = found["x"].values[found["pressure"].values > 0.0] - 0.5
    assert 0.5 * (x[0] + x[-1]) == pytest.approx(shift, abs=1.0 / 8192)
    assert float(found["hysteretic_friction"]) == pytest.approx(friction, rel=1e-2)


@pytest.mark.long
def test_a_cylinder_that_sets_off_in_a_window_comes_to_roll_as_hunter_says():
    """Marched over nodes that rest, far from where it touched down; nothing of this is periodic."""
    radius, modulus, lag, load = 1.0, 3.0, 0.02, np.pi / 8.0**2 / 4.0
    width, _, friction = rolling(load, radius, modulus, lag)
    path = [{"duration": 20.0}, {"sliding": 0.2, "duration": 0.2 / lag}, {"sliding": 0.22, "duration": 0.02 / lag}]
    found = in_a_window(1, 1.0, 256, {"line_load": load}, path, time_tolerance=2e-2)
    assert float(found["contact_radius"][-1]) == pytest.approx(width, rel=3e-3)
    assert float(found["hysteretic_friction"][-1]) == pytest.approx(friction, rel=3e-3)
    work = friction * float(found["mean_pressure"][-1]) * 0.02
    assert float(found["energy_lost"][-1]) == pytest.approx(work, rel=3e-3)


def test_a_ball_that_jumps_in_a_window_finds_a_glassy_body_that_remembers_nothing_else():
    way = [{"sliding": 0.25, "sliding_y": -0.125}]
    found = in_a_window(2, 1.0, 32, {"force": 4.0 * 0.15**3 / 3.0}, way, time_tolerance=1e-2)
    touching = found["pressure"][1].values > 0.0
    for name in ("pressure", "height"):
        landed, here = np.roll(found[name][0], (-4, 8), axis=(0, 1)), found[name][1].values
        where = touching if name == "height" else ...  # a parabola does not come in again at the other end
        np.testing.assert_allclose(here[where], landed[where], atol=1e-8 * float(abs(found[name]).max()))


@pytest.mark.parametrize("slab", [{}, {"poissons_ratio": 0.3, "aspect_ratio": 0.1}])
def test_slow_and_fast_punches_find_elastic_bodies(slab):
    for speed, stiffer in ((1e-12, 1.0), (1e12, 4.5)):
        sliding, elastic = solved(THREE, speed, **slab), solved(None, None, 0.05 / stiffer, **slab)
        np.testing.assert_array_equal(sliding["gap"] == 0.0, elastic["gap"] == 0.0)
        np.testing.assert_allclose(sliding["gap"], elastic["gap"], atol=1e-7 * float(elastic["gap"].max()))
        assert float(sliding["contact_area_fraction"]) == float(elastic["contact_area_fraction"])
        assert abs(float(sliding["hysteretic_friction"])) < 1e-9


def test_a_slow_map_finds_an_elastic_body():
    """A fast one does not: waves along the way of the punch stand still, and the body relaxes under them."""
    sliding, elastic = solved(THREE, 1e-12, dimension=2, eps_c=1 / 2), solved(None, None, dimension=2, eps_c=1 / 2)
    np.testing.assert_array_equal(sliding["gap"] == 0.0, elastic["gap"] == 0.0)
    assert abs(float(sliding["hysteretic_friction"])) < 1e-9


def rough_problem(series, speed, load=0.05, n=256, seed=3, **more):
    """A rough profile that slides over a body that creeps."""
    surface = given_surface(self_affine.SelfAffineWaves(0.8, 2, n // 8).heights((n,), seed, range(1))[0])[0]
    memory = PronySeries(*zip(*series, strict=True))
    options = Options("sliding_newton", residual=1e-10)
    laws, body = Interactions(True), ElasticBody(None, None)
    return Problem(
        surface, body, laws, load, None, options, speed=speed, relaxation=memory, time_tolerance=1e-3, **more
    )


def test_pressure_and_gap_are_those_of_the_convolution():
    """By a dense matrix, built from the definition of the complex modulus."""
    speed, n = 3e-3, 256
    problem = rough_problem(THREE, speed, n=n, seed=2)
    (found,) = solve_path(problem, 0)
    q = 2.0 * np.pi * np.fft.fftfreq(n, 1.0 / n)
    symbol = np.zeros(n, dtype=complex)
    symbol[1:] = 2.0 / abs(q[1:]) / complex_modulus(THREE, -q[1:] * speed)
    symbol[n // 2] = symbol[n // 2].real
    response = np.fft.ifft(symbol)
    assert abs(response.imag).max() < 1e-12 * abs(response.real).max()
    matrix = response.real[(np.arange(n)[:, None] - np.arange(n)) % n]
    assert abs(matrix - matrix.T).max() > 0.1 * abs(matrix).max()
    pressure = found.equilibrium.pressure[0]
    gap = found.punch[0] + matrix @ pressure
    gap -= gap[pressure > 0.0].mean()
    assert pressure.min() >= 0.0
    assert pressure.mean() == pytest.approx(0.05, rel=1e-9)
    assert gap.min() > -1e-8 * gap.max()
    assert abs(gap[pressure > 0.0]).max() < 1e-8 * gap.max()
    q[n // 2] = 0.0
    along = (pressure * np.fft.ifft(1j * q * np.fft.fft(gap)).real).mean() / pressure.mean()
    assert along < 0.0
    assert hysteretic_friction_error(found)[0] == pytest.approx(-along, rel=1e-5)


def test_friction_is_what_the_dashpots_take():
    """Their power <p_i w_i> / tau_i over the speed, but for the wave at Nyquist, of which no grid tells the way."""
    speed = 3e-3
    problem = rough_problem(THREE, speed)
    (found,) = solve_path(problem, 0)
    springs = found.after.memory["springs"]
    times = np.array([tau for _, tau in THREE])
    power = ((springs.traction * springs.stretch)[1:, 0, 0].mean(axis=1) / times).sum()
    u, p = found.equilibrium.displacement[0], found.equilibrium.pressure[0]
    waves, n = 2.0j * np.pi * np.arange(129), 256
    slope = np.fft.irfft(waves * np.fft.rfft(u) * (np.arange(129) < 128), n)
    assert power / speed == pytest.approx(float((p * slope).mean()), rel=1e-4)
    np.testing.assert_allclose(springs.traction.sum(axis=0)[:, 0], -found.equilibrium.pressure, atol=1e-12)


BRANCHES = {  # whose compliance lags behind by up to 1.1, 16 and 3 times what is in phase
    "standard": STANDARD,
    "stiff": ((1000.0, 1.0),),
    "three": ((10.0, 1.0), (10.0, 0.1), (10.0, 0.01)),
}


@pytest.mark.parametrize("name", BRANCHES)
@pytest.mark.parametrize("load", [0.005, pytest.param(0.3, marks=pytest.mark.long)])
def test_bodies_that_lag_far_behind_are_solved_too(name, load):
    path = rough_problem(BRANCHES[name], 1e-5, load).at_each_load
    for speed in (1e-5, 1e-3, 0.1):
        problem = path[0].under(path[0].step._replace(speed=speed))
        (found,) = solve_path(problem, 0)
        assert found.equilibrium.status[0] == 0
        assert found.equilibrium.residual[0] <= 1e-10


def test_a_path_of_speeds_is_that_of_each_alone():
    speeds = (1e-4, 1e-3, 1e-2)
    scene = {
        "body": {"poissons_ratio": 0.5, "relaxation": relaxation(STANDARD)},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": GRADIENT},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.05, "speed": speeds[0]},
    }
    file = {"scene": scene, "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 16, "eps_t": 1 / 2}, "seed": 3}
    path = gfmd_numba.solve(file | {"path": [{"speed": each} for each in speeds[1:]]})
    np.testing.assert_allclose(path["speed"], speeds)
    for i, speed in enumerate(speeds):
        alone = solved(STANDARD, speed)
        np.testing.assert_array_equal(path["gap"][i] == 0.0, alone["gap"] == 0.0)
        for name in ("hysteretic_friction", "mean_gap", "peak_pressure"):
            assert float(path[name][i]) == pytest.approx(float(alone[name]), rel=1e-6)


def marched(points, tolerance, ways, speed=0.05, load=0.3):
    """A wave that slides over a standard solid from rest, and how it slides steadily."""
    heights = 1e-3 * np.cos(2.0 * np.pi * np.arange(points) / points)
    scene = {
        "body": {"poissons_ratio": 0.5, "relaxation": relaxation(STANDARD)},
        "roughness": {"method": "measured"},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": load},
    }
    begun = (0.0, *ways)
    path = [{"sliding": way, "duration": (way - last) / speed} for last, way in zip(begun, ways, strict=False)]
    marching = {"scene": scene, "path": path, "numerics": {"time_tolerance": tolerance}}
    steady = scene | {"loading": scene["loading"] | {"speed": speed}}
    return gfmd_numba.solve(marching, heights=heights), gfmd_numba.solve({"scene": steady}, heights=heights)


@pytest.mark.long
def test_a_punch_that_sets_off_comes_to_slide_steadily():
    found, steady = marched(64, 1e-2, (1.0,))
    assert not found["status"].any()
    last = found.isel(step=-1)
    np.testing.assert_allclose(last["height"], found["height"][0], atol=1e-13)  # after whole periods
    assert float(last["hysteretic_friction"]) == pytest.approx(float(steady["hysteretic_friction"]), rel=1e-2)
    assert float(found["hysteretic_friction"][0]) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.long
def test_marching_and_the_steady_state_are_one_and_its_friction_is_what_is_lost():
    found, steady = marched(64, 1e-3, (1.0, 1.5))
    for step in (1, 2):
        here = found.isel(step=step)
        assert float(here["hysteretic_friction"]) == pytest.approx(float(steady["hysteretic_friction"]), rel=1e-3)
        assert float(here["contact_area_fraction"]) == pytest.approx(float(steady["contact_area_fraction"]), rel=1e-3)
    work = float(steady["hysteretic_friction"] * steady["mean_pressure"]) * 0.5
    assert float(found["energy_lost"][2]) == pytest.approx(work, rel=1e-3)


@pytest.mark.parametrize("shape", [(16,), (12, 16)])
def test_waves_are_moved_between_nodes_without_smearing(shape):
    y, x = np.meshgrid(np.arange(shape[0]) / shape[0], np.arange(shape[-1]) / shape[-1], indexing="ij")
    waves = lambda y, x: np.cos(2 * np.pi * (3 * x + 2 * y)) + np.sin(10 * np.pi * x)  # noqa: E731
    way = (0.3, 0.17)[: len(shape)]
    y, x = (y, x) if len(shape) == 2 else (0.0, x[0])
    moved = waves(y - (*way, 0.0)[1], x - way[0])
    np.testing.assert_allclose(grid.moved(waves(y, x), way), moved, atol=1e-12)


def test_a_punch_that_jumps_finds_a_glassy_body_that_remembers_nothing_else():
    """Displaced by whole nodes at once, on a body that was pressed at once: the same contact, moved."""
    problem = rough_problem(STANDARD, 0.0, n=64, path=(LoadStep(0.05, (0.25,)),), passing=1.0)
    problem = replace(problem, numerics=Options("active_set_newton", residual=1e-10))
    first, second = solve_path(problem, 0)
    np.testing.assert_allclose(second.heights, np.roll(first.heights, 16, axis=1), atol=1e-12)
    np.testing.assert_array_equal(second.equilibrium.touching, np.roll(first.equilibrium.touching, 16, axis=1))
