"""Wear by Archard's law: the worn volume, the flat that a sine wears to, and the divisions of steps of any length."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

import gfmd_numba
from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.processes import PunchWear
from gfmd_numba.contact.solution import begin, solve
from gfmd_numba.contact.state import LoadStep
from gfmd_numba.scene.scene_file import load_scene
from support.cases import some_of

EPS = {1: {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}, 2: {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2}}

SLAB = {"aspect_ratio": 0.4}


def scene(dimension=1, periodic=True, rate=2.0, **body):
    return {
        "dimension": dimension,
        "periodic": periodic,
        "body": {"poissons_ratio": 0.3} | body,
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}, "wear": {"rate": rate}},
        "loading": {"reduced_pressure": 0.05},
    }


def solved(scene, path, **more):
    file = {"scene": scene, "path": path, "numerics": {"residual": 1e-12}} | more
    if "roughness" in scene and scene["roughness"]["method"] == "psd":
        file |= {"seed": 2, "discretisation": EPS[scene["dimension"]]}
    found = gfmd_numba.solve(file)
    assert not found["status"].any()
    return found


@pytest.mark.filterwarnings("ignore:the contact reaches the edge of the window")
@pytest.mark.parametrize(("dimension", "periodic", "body"), some_of([(1, False, SLAB), (2, True, {})], 0))
def test_the_worn_volume_is_rate_times_load_times_way(dimension, periodic, body):
    """However the way is divided, whichever way it goes, and under a load that changes evenly with the way."""
    path = [{"sliding": 0.05}, {"sliding": 0.07, "reduced_pressure": 0.08}, {"sliding": 0.01}]
    path += [{"sliding": 0.02, "sliding_y": 0.01}] * (dimension == 2)
    found = solved(scene(dimension, periodic, **body), path, numerics={"time_tolerance": 0.1, "residual": 1e-12})
    gradient = float(found["rms_gradient_target"])
    ways = (0.05, 0.02, 0.06, np.hypot(0.01, 0.01))[: len(path)]
    loads = gradient * np.array([0.05, 0.065, 0.08, 0.08])[: len(path)]
    worn = 2.0 * loads * ways
    np.testing.assert_allclose(np.delete(np.diff(found["mean_worn_depth"]), 1), np.delete(worn, 1), rtol=1e-9)
    second = found.isel(step=2)
    assert float(second["mean_worn_depth"]) == pytest.approx(worn[:2].sum(), rel=float(second["time_error"]))
    np.testing.assert_allclose(found["worn_depth"].mean(("y", "x")[2 - dimension :]), found["mean_worn_depth"])
    assert (np.diff(found["contact_area_fraction"])[[0, 1]] > 0.0).all()


@pytest.mark.filterwarnings("ignore:the grid has too few nodes")
def test_a_sine_wears_to_its_flat():
    """Under a small load a blunt sine loses its caps, of the worn volume; its flat bears an even pressure."""
    n, amplitude, load, rate = 128, 1e-3, 1e-5, 40.0
    x = np.arange(n) / n
    heights = amplitude * np.cos(2.0 * np.pi * (x - 0.5))
    whole = scene(rate=rate)
    whole |= {"roughness": {"method": "measured"}, "loading": {"reduced_pressure": load}}
    file = {"scene": whole, "path": [{"sliding": 2.0}], "numerics": {"residual": 1e-10, "time_tolerance": 0.01}}
    found = gfmd_numba.solve(file, heights=heights)
    assert not found["status"].any()
    volume = float(found["mean_worn_depth"][-1])

    def missing(b):  # of a cap from -b to b
        return amplitude * (np.sin(2.0 * np.pi * b) / np.pi - 2.0 * b * np.cos(2.0 * np.pi * b)) - volume

    b = brentq(missing, 1e-6, 0.5)
    last = found.isel(step=-1)
    assert float(last["contact_area_fraction"]) == pytest.approx(2.0 * b, abs=2.0 / n)
    worn = np.array(last["height"] - last["worn_depth"])
    flat = np.minimum(heights, amplitude * np.cos(2.0 * np.pi * b)) - heights.mean()
    assert abs(worn - worn.mean() - flat + flat.mean()).max() < 0.01 * amplitude
    pressure = np.array(last["pressure"])[abs(x - 0.5) < 0.8 * b]
    assert np.ptp(pressure) < 0.1 * pressure.mean()


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:the contact reaches the edge of the window")
def test_a_body_that_creeps_wears_the_same_volume():
    whole = scene(periodic=False, relaxation=[{"modulus": 3.0, "time": 1.0}])
    path = [{"sliding": 0.1, "duration": 1.0}, {"sliding": 0.2}]
    found = solved(whole, path, numerics={"time_tolerance": 0.1, "residual": 1e-10})
    expected = 2.0 * 0.02 * 0.05 * np.array([0.1, 0.2])
    np.testing.assert_allclose(found["mean_worn_depth"][1:], expected, rtol=1e-8)


def test_full_contact_is_that_of_the_relaxed_body_and_the_punch_as_worn():
    """By Parseval for a half-space: how a step is divided makes no difference."""
    path = [{"sliding": way, "duration": 1.0} for way in (0.1, 0.2)]
    found = solved(
        scene(relaxation=[{"modulus": 3.0, "time": 1.0}]), path, numerics={"time_tolerance": 0.1, "residual": 1e-10}
    )
    waves = np.fft.rfft(found["height"] - found["worn_depth"]) / found.sizes["x"]
    expected = np.sqrt((2.0 * abs(np.pi * np.arange(waves.shape[-1]) * waves) ** 2).sum(axis=-1))
    np.testing.assert_allclose(found["full_contact_rms_pressure"], expected, rtol=1e-3)


def test_units_make_no_difference():
    numerics = {"residual": 1e-12, "time_tolerance": 0.1}
    plain = solved(scene(), [{"sliding": 0.5}], numerics=numerics)
    body = {"youngs_modulus": "2 GPa", "poissons_ratio": 0.3}
    modulus = 2e9 / (1.0 - 0.3**2)
    engineering = scene() | {"length": "1 mm", "body": body}
    engineering["interface"] = {"hard_wall": {}, "wear": {"rate": f"{2.0 / modulus!r} m^2/N"}}
    found = solved(engineering, [{"sliding": "0.5 mm"}], numerics=numerics)
    np.testing.assert_allclose(found["mean_worn_depth"], 1e-3 * plain["mean_worn_depth"], rtol=1e-9)
    assert found["worn_depth"].units == "m"


def test_without_wear_nothing_is_remembered(monkeypatch):
    def made(*given):
        raise AssertionError("what wear alone needs was made")

    for name in ("begin", "change", "advance"):
        monkeypatch.setattr(PunchWear, name, made)
    whole = scene()
    whole["interface"] = {"hard_wall": {}}
    found = solved(whole, [{"reduced_pressure": 0.06}])
    assert not {"worn_depth", "mean_worn_depth"} & set(found.variables)
    assert LoadStep(0.0, (0.0,)).towards(LoadStep(1.0, (2.0,), 4.0), 0.25) == LoadStep(0.25, (0.5,), 1.0)


def rubbing(path, rate=2.0, coefficient=0.3, periodic=True, body=None, **numerics):
    """The file of a rough punch that wears, and rubs with a coefficient of friction."""
    whole = scene(periodic=periodic, rate=rate, **body or {"aspect_ratio": 0.4})
    if coefficient is not None:
        whole["interface"]["friction"] = {"coefficient": coefficient}
    return {
        "scene": whole,
        "path": path,
        "seed": 2,
        "discretisation": EPS[1],
        "numerics": {"residual": 1e-9} | numerics,
    }


def followed(file, divisions):
    """Contacts at the ends of divisions of the first step."""
    problem, _ = read_contact(*load_scene(file)).reduced
    state = begin(problem, range(1))
    found = [solve(problem.at_each_load[0], state)]
    for i in range(divisions):
        step = problem.step.towards(problem.path[0], (i + 1) / divisions)
        found.append(solve(problem.under(step), found[-1].after))
    assert not any(each.equilibrium.status[0] for each in found)
    return problem, found


def test_each_node_wears_by_its_own_slip():
    """The volume is the rate times the sum over nodes of mean pressure times slip, as far as nodes keep touching."""
    problem, found = followed(rubbing([{"sliding": 2e-3}]), 32)
    expected = problem.wear_rate * abs(found[0].equilibrium.tangential.slip[0, 0]) * found[0].equilibrium.pressure[0]
    expected *= 0.5
    for last, now in pairwise(found):
        way = now.step.sliding[0] - last.step.sliding[0]
        assert problem.wear_rate * way * np.pi * now.heights.shape[-1] / 2.0 < 2.0  # short enough for the mean
        moved = now.tangential_displacement[0, 0] - last.tangential_displacement[0, 0]
        slip = np.where(now.equilibrium.touching[0], way - moved, 0.0)
        expected += 0.5 * problem.wear_rate * abs(slip) * (last.equilibrium.pressure[0] + now.equilibrium.pressure[0])
    sticks = (found[1].equilibrium.tangential.slip[0, 0] == 0.0) & found[1].equilibrium.touching[0]
    assert sticks.any()
    worn = found[-1].after.memory["worn"][0]
    assert worn.mean() == pytest.approx(expected.mean(), rel=1e-10)
    np.testing.assert_allclose(worn, expected, atol=1e-10 * worn.max())


@pytest.mark.parametrize("coefficient", [None, pytest.param(0.3, marks=pytest.mark.long)])
def test_divisions_of_short_steps_are_of_second_order(coefficient):
    file = rubbing([{"sliding": 5e-4}], coefficient=coefficient)
    depths = [followed(file, divisions)[1][-1].after.memory["worn"] for divisions in (8, 16, 32)]
    changes = [abs(one - other).sum() for one, other in pairwise(depths)]
    assert changes[0] / changes[1] > 3.0  # 4 of second order, 2 of first


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:the punch has slid")
@pytest.mark.filterwarnings("ignore:the contact reaches the edge of the window")
def test_a_punch_that_slides_far_wears_as_without_friction():
    """On an incompressible half-space friction does not change the pressure; the punch first drags it along a bit."""
    body = {"poissons_ratio": 0.5}
    file = rubbing([{"sliding": 0.4}], 1.0, 0.01, periodic=False, body=body, time_tolerance=2e-2)
    file["discretisation"] |= {"eps_f": 1 / 4}
    found = gfmd_numba.solve(file)
    del file["scene"]["interface"]["friction"]
    plain = gfmd_numba.solve(file)
    for name in ("worn_depth", "pressure"):
        error = abs(found[name][-1] - plain[name][-1]).sum() / plain[name][-1].sum()
        assert float(error) < 0.01
    assert float(found["mean_worn_depth"][-1]) == pytest.approx(float(plain["mean_worn_depth"][-1]), rel=5e-3)
    assert 0.0 < float(found["time_error"][-1]) < 2e-2
    assert "energy_lost" not in found
    touches = found["pressure"][-1].values > 0.0
    assert float(found["slip"][-1].values[touches].max()) > 0.98 * 0.4  # of all divisions, less what the body follows


@pytest.mark.long
def test_long_steps_hold_their_tolerance():
    """As no wave of the grid swings to and fro; beside three times as many steps."""
    path = [{"sliding": 1e-3}, {"sliding": 0.02}]
    found = gfmd_numba.solve(rubbing(path, time_tolerance=5e-2))
    ways = [*np.linspace(0.0, 1e-3, 4)[1:], *np.linspace(1e-3, 0.02, 4)[1:]]
    path = [{"sliding": float(way)} for way in ways]
    fine = gfmd_numba.solve(rubbing(path, time_tolerance=5e-2))
    for name in ("worn_depth", "pressure", "displacement"):
        error = abs(found[name][-1] - fine[name][-1]).sum() / abs(fine[name][-1]).sum()
        assert float(error) < float(found["time_error"][-1]) + float(fine["time_error"][-1])
    assert float(found["time_error"][-1]) < 5e-2


@pytest.mark.long
def test_the_peak_pressure_of_a_punch_that_runs_in_is_that_of_many_steps():
    """The example of docs/time.md, beside 256 times as many steps of first order."""
    body = {"youngs_modulus": "2 GPa", "poissons_ratio": 0.4}
    whole = scene(rate="1e-14 m^2/N", **body) | {"length": "1 mm", "loading": {"pressure": "1 MPa"}}
    whole["roughness"]["rms_gradient"] = 0.05
    file = {"scene": whole, "path": [{"sliding": f"{way} m"} for way in (1, 10, 100)]}
    file |= {"discretisation": EPS[1] | {"eps_f": 1 / 16}, "numerics": {"time_tolerance": 0.03}}
    found = gfmd_numba.solve(file)
    np.testing.assert_allclose(found["peak_pressure"][1:], [31.86e6, 7.850e6, 1.798e6], rtol=1e-2)
    assert 0.0 < float(found["time_error"][-1]) < 0.03
    assert all("narrow on this grid" in line for line in found.validity.splitlines())
    found = gfmd_numba.solve(file | {"path": [{"pressure": "2 MPa"}, {"sliding": "1 mm"}]})
    assert found["time_error"][1] == 0.0  # of a step that wears nothing off
