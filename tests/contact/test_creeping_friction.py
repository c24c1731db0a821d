"""Friction and laws of gap and slip on bodies that creep: closed forms, limits, energy and random histories."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline

import gfmd_numba
from support.cases import some_of
from support.viscoelastic import STANDARD, THREE, modulus, relaxation

pytestmark = pytest.mark.filterwarnings("ignore:after some .* fully relaxed")  # limits
EPS = {1: {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}, 2: {"eps_c": 1 / 2, "eps_f": 1 / 4, "eps_t": 1 / 2}}
SLAB = {"poissons_ratio": 0.3, "aspect_ratio": 0.4}


def solved(series, loading, path, friction=0.3, dimension=1, body=SLAB, **more):
    """A rough punch that rubs on a body, elastic without a series."""
    body = body | ({} if series is None else {"relaxation": relaxation(series)})
    laws = more.pop("laws", {"friction": {"coefficient": friction}})
    scene = {
        "dimension": dimension,
        "body": body,
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}} | laws,
        "loading": loading,
    } | more.pop("scene", {})
    file = {"scene": scene, "path": path, "discretisation": EPS[dimension], "seed": 3, "numerics": more}
    found = gfmd_numba.solve(file)
    assert not found["status"].any()
    return found


@pytest.mark.parametrize(("dimension", "friction"), some_of([(1, 0.2), (1, np.inf), (2, 0.2)], 0))
def test_where_the_punch_stands_still_all_tractions_relax_as_the_modulus(dimension, friction):
    """Stick and slip stay where they were."""
    times, at_once = np.array([0.1, 20.0]), [{"sliding": 2e-4} | ({"sliding_y": 1e-4} if dimension == 2 else {})]
    dwells = [{"duration": float(each)} for each in np.diff(times, prepend=0.0)]
    found = solved(THREE, {"displacement": 1e-3}, [*at_once, *dwells], friction, dimension, residual=1e-10)
    assert float(found["time_error"][-1]) < 1e-8
    for i, time in enumerate(times):
        left = modulus(THREE, time) / modulus(THREE, 0.0)
        for name in ("pressure", "tangential_traction", *["tangential_traction_y"] * (dimension == 2)):
            np.testing.assert_allclose(
                found[name][2 + i], left * found[name][1], atol=1e-7 * float(abs(found[name][1]).max())
            )
        assert float(abs(found["slip"][2 + i]).max()) <= 1e-7 * float(found["tangential_displacement"][1].max())
    assert 0.0 < float(found["stick_fraction"][1]) <= 1.0


@pytest.mark.filterwarnings("ignore:strains are no longer small")
def test_a_punch_that_sticks_all_over_meets_the_memory_of_a_slab():
    """Mean traction (G / h) int E(t - s) ds of sliding at an even speed, then that of a dwell."""
    speed, turn = 1e-3, 2.0
    found = solved(
        THREE,
        {"reduced_pressure": 50.0},
        [{"sliding": speed * turn, "duration": turn}, {"duration": 1.0}],
        np.inf,
        body=SLAB | {"youngs_modulus": 1.0},
        scene={"length": 1.0},
        time_tolerance=0.1,
    )
    assert float(found["contact_area_fraction"].min()) == 1.0
    stiffness = 1.0 / (2.0 * (1.0 + 0.3)) / 0.4
    for i, time in ((1, turn), (2, turn + 1.0)):
        memory = quad(lambda s, time=time: modulus(THREE, time - s), 0.0, turn)[0]
        expected = stiffness * speed * memory
        assert float(found["mean_tangential_traction"][i]) == pytest.approx(expected, rel=1e-8)


@pytest.mark.long
def test_loads_at_once_find_a_glassy_body_and_slow_ones_a_relaxed_one():
    """The elastic path is divided as often as the slow one, as friction depends on the way."""
    loads, ways = np.linspace(0.05, 0.1, 5)[1:], np.linspace(0.0, 4e-4, 5)[1:]
    path = [{"reduced_pressure": float(p), "sliding": float(w)} for p, w in zip(loads, ways, strict=True)]
    elastic = solved(None, {"reduced_pressure": 0.05}, path)
    slow = [step | {"duration": 1e6} for step in path]
    found = solved(STANDARD, {"reduced_pressure": 0.05}, [{"duration": 1e6}, *slow], time_tolerance=0.1)
    for name in ("mean_tangential_traction", "contact_area_fraction"):
        scale = float(elastic[name][-1])
        np.testing.assert_allclose(found[name][2:], elastic[name][1:], atol=0.02 * scale)
    glassy = [{"reduced_pressure": 4.0 * float(loads[-1]), "sliding": float(ways[-1])}]
    found = solved(STANDARD, {"reduced_pressure": 0.2}, glassy, residual=1e-10)
    elastic = solved(None, {"reduced_pressure": 0.05}, [path[-1]], residual=1e-10)
    for name in ("pressure", "tangential_traction"):
        np.testing.assert_allclose(found[name], 4.0 * elastic[name], atol=1e-7 * 4.0 * float(elastic["pressure"].max()))


@pytest.mark.long
def test_work_is_stored_dissipated_or_rubbed_away():
    """A rough cylinder that is pressed into a half-space, slides to and fro, and is drawn off by a part of its way.

    The work is that of smooth forces through those at the ends of the steps.
    """
    steps, depth, way = 6, 5e-3, 2e-3
    share = np.linspace(0.0, 1.0, steps + 1)[1:]
    legs = [  # displacement and sliding at the ends of steps
        (depth * (0.4 + 0.6 * share), 0.0 * share),
        (depth + 0.0 * share, way * share),
        (depth + 0.0 * share, way - 1.5 * way * share),
        (depth * (1.0 - 0.4 * share), -0.5 * way + 0.0 * share),
    ]
    depths, ways = (np.concatenate([leg[i] for leg in legs]) for i in (0, 1))
    path = [
        {"displacement": float(d), "sliding": float(w), "duration": 1.0 / steps}
        for d, w in zip(depths, ways, strict=True)
    ]
    found = solved(
        STANDARD,
        {"displacement": 0.4 * depth},
        path,
        body={"poissons_ratio": 0.3},
        scene={"length": 1.0, "periodic": False, "form": {"radius": 4.0}},
        time_tolerance=1e-2,
    )
    force, traction = np.array(found["mean_pressure"]), np.array(found["mean_tangential_traction"])
    depths, ways, work = np.append(0.4 * depth, depths), np.append(0.0, ways), [0.0]
    for leg in range(4):
        part = slice(leg * steps, (leg + 1) * steps + 1)
        along, borne = (depths[part], force[part]) if leg in (0, 3) else (ways[part], traction[part])
        turns = np.sign(along[-1] - along[0])
        smooth = CubicSpline(turns * along, turns * borne)
        done = [float(smooth.integrate(turns * along[0], turns * each)) for each in along[1:]]
        work += (work[-1] + np.array(done)).tolist()
    stored, lost = np.array(found["elastic_energy"]), np.cumsum(found["energy_lost"])
    balance = stored - stored[0] + lost - work
    assert (np.diff(lost) > 0.0).all()
    assert abs(balance).max() < 1e-3 * abs(np.diff(work)).sum()
    assert float(found["stick_fraction"].min()) < 0.5 < float(found["stick_fraction"].max())


@pytest.mark.parametrize("law", [pytest.param("both", marks=pytest.mark.long), "cohesive"])
def test_random_histories_are_certified(law):
    draw = np.random.default_rng(len(law))
    attracts = {"work_of_adhesion": 1e-6}
    laws = {
        "both": {"friction": {"coefficient": 0.3}, "exponential": attracts | {"range": 2e-3}},
        "cohesive": {"cohesive": attracts | {"normal_length": 2e-3, "tangential_length": 1e-3}},
    }[law]
    path = [
        {"displacement": max(1e-2 * load, 0.0), "sliding": 3e-4 * way} | ({"duration": time} if time > 0.03 else {})
        for load, way, time in zip(
            draw.uniform(-0.02, 0.1, 4), draw.normal(size=4), 10.0 ** draw.uniform(-2.0, 1.0, 4), strict=True
        )
    ]
    found = solved(STANDARD, {"displacement": 1e-3}, path, laws=laws, time_tolerance=0.1)
    assert float(found["residual"].max()) <= 1e-8


def test_a_law_of_gap_and_slip_meets_the_relaxed_body_if_it_has_time():
    law = {"cohesive": {"work_of_adhesion": 1e-6, "normal_length": 2e-3, "tangential_length": 1e-3}}
    path = [{"displacement": 5e-4}, {"sliding": 3e-4}]
    elastic = solved(None, {"displacement": 1e-3}, path, laws=law)
    slow = [step | {"duration": 1e7} for step in path]
    found = solved(STANDARD, {"displacement": 1e-3}, [{"duration": 1e7}, *slow], laws=law).isel(step=slice(1, None))
    for name in ("mean_pressure", "mean_tangential_traction"):
        np.testing.assert_allclose(found[name], elastic[name], atol=1e-3 * float(abs(elastic["mean_pressure"]).max()))
