"""Bodies that creep: what Lee and Radok, and Ting, know of them, their limits, the order of their steps and energy."""

import copy
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

import gfmd_numba
from gfmd_numba.contact import time_steps
from gfmd_numba.contact.contact_input import read_contact
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.solution import begin, solve
from gfmd_numba.contact.state import LoadStep
from gfmd_numba.contact.validity import FEWEST
from gfmd_numba.contact.viscoelasticity import Relaxation
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.prony import PronySeries
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.roughness.surfaces import given_surface
from gfmd_numba.scene.scene_file import load_scene
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from support.viscoelastic import STANDARD, THREE, compliance, equivalent_load, in_a_window, modulus, relaxation

EPS = {1: {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}, 2: {"eps_c": 1 / 2, "eps_f": 1 / 8, "eps_t": 1 / 2}}
TIMES = (1.0, 100.0)


def scene(dimension=1, periodic=True, load=0.05, series=None, **more):
    """A rough punch on a body, elastic without a series."""
    body = {"poissons_ratio": 0.5} | ({} if series is None else {"relaxation": relaxation(series)})
    return {
        "dimension": dimension,
        "periodic": periodic,
        "body": body,
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": load} | more,
    }


def solved(scene, path=(), **numerics):
    """The dataset of a scene and a path."""
    file = {"scene": scene, "path": list(path), "numerics": numerics}
    if "roughness" in scene:
        file |= {"discretisation": EPS[scene["dimension"]], "seed": 3}
    found = gfmd_numba.solve(file)
    assert not found["status"].any()
    return found


def dwells(times, **more):
    """Steps that end at times."""
    return [{"duration": end - start, **more} for start, end in zip((0.0, *times), times, strict=False)]


@pytest.mark.long
def test_under_a_constant_load_a_rough_profile_is_the_elastic_one_of_the_creep_compliance():
    """Lee and Radok: of a contact that only grows all but the pressure is that of E* = 1 / J(t)."""
    creeping = solved(scene(series=THREE), dwells(TIMES), time_tolerance=1e-2)
    for i, time in enumerate((0.0, *TIMES)):
        elastic = solved(scene(load=0.05 * compliance(THREE, time)))
        now = creeping.isel(step=i)
        assert float(now["contact_area_fraction"]) == pytest.approx(float(elastic["contact_area_fraction"]), rel=1e-6)
        np.testing.assert_array_equal(now["gap"] == 0.0, elastic["gap"] == 0.0)
        for name in ("gap", "displacement"):
            error = abs(now[name] - elastic[name]).max() / abs(elastic[name]).max()
            assert float(error) <= max(float(now["time_error"]), 1e-8)
    assert float(creeping["time_error"][-1]) <= 1e-2
    np.testing.assert_allclose(creeping["time"], [0.0, *TIMES])


@pytest.mark.long
def test_its_statistics_are_those_of_the_elastic_one_too():
    """Pressures count over those of full contact with E* = 1 / J(t), however the steps are divided."""
    creeping = solved(scene(series=STANDARD), dwells(TIMES), time_tolerance=0.05)
    np.testing.assert_array_equal(creeping["full_contact_rms_pressure"], creeping["full_contact_rms_pressure"][0])
    found = gfmd_numba.contact_statistics(creeping)
    for i, time in enumerate((0.0, *TIMES)):
        elastic = solved(scene(load=0.05 * compliance(STANDARD, time)))
        name = "full_contact_rms_pressure"
        assert float(creeping[name][i]) == pytest.approx(float(elastic[name]))
        expected = float(gfmd_numba.contact_statistics(elastic)["contact_area_fraction_persson"])
        assert float(found["contact_area_fraction_persson"][i]) == pytest.approx(expected, rel=2e-3)
        borne = found["pressure"] * found["pressure_density"].isel(step=i) * np.diff(found["pressure"]).mean()
        reduced = float(elastic["mean_pressure"] / elastic["full_contact_rms_pressure"])
        assert float(borne.sum()) == pytest.approx(reduced, rel=0.05)


@pytest.mark.parametrize(("other", "slab"), [(STANDARD, {}), (None, {"aspect_ratio": 0.2})])
def test_of_two_bodies_the_creep_compliances_add_up(slab, other):
    """Under a constant load their contact is that of two elastic bodies of 1 / E* = J_1 / E_1* + J_2 / E_2*."""
    series, moduli = (THREE, other), (1.0, 3.0)
    bodies = [
        slab | {"youngs_modulus": e, "poissons_ratio": 0.3} | ({} if s is None else {"relaxation": relaxation(s, e)})
        for s, e in zip(series, moduli, strict=True)
    ]

    def pair(load, bodies):
        rough, above = bodies
        rough = rough | {"roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}}
        whole = scene(load=load) | {"length": 1.0, "body": rough, "counter_body": above}
        return {name: value for name, value in whole.items() if name != "roughness"}

    def file(whole, **more):
        return {"scene": whole, "discretisation": EPS[1] | {"eps_c": 1 / 2}, "seed": 3} | more

    creeping = gfmd_numba.solve(file(pair(0.05, bodies), path=dwells((2.0,)), numerics={"time_tolerance": 1e-2}))
    elastic = [{key: value for key, value in each.items() if key != "relaxation"} for each in bodies]
    for i, time in enumerate((0.0, 2.0)):
        each = [1.0 if s is None else compliance(s, time) for s in series]
        softer = (3.0 * each[0] + each[1]) / 4.0
        now, then = creeping.isel(step=i), file(pair(0.05 * softer, elastic), numerics={"topography_order": 0})
        expected = gfmd_numba.solve(then)
        error = abs(now["gap"] - expected["gap"]).max() / expected["gap"].max()
        assert float(error) <= max(float(now["time_error"]), 1e-8)
    assert creeping["displacement"].long_name.startswith("normal displacements of both bodies together")


def test_it_does_not_matter_whether_a_body_that_creeps_or_the_punch_is_rough():
    """At order 0 in the slope; a steep body is warned of."""
    on_punch = scene(series=STANDARD)
    on_punch["roughness"] |= {"rms_gradient": 0.05}
    on_body = copy.deepcopy(on_punch)
    on_body["body"]["roughness"] = on_body.pop("roughness")
    rest = {"discretisation": EPS[1], "seed": 3, "path": dwells((1.0,)), "numerics": {"time_tolerance": 0.05}}
    one = gfmd_numba.solve({"scene": on_punch} | rest)
    with pytest.warns(UserWarning, match="order 0 in the slope, at which bodies that creep are pressed"):
        other = gfmd_numba.solve({"scene": on_body} | rest)
    for name in ("gap", "pressure", "energy_lost"):
        np.testing.assert_allclose(other[name], one[name], atol=1e-9 * float(abs(one[name]).max()))
    assert other["height"].long_name.startswith("sum of the heights")


def test_layers_that_relax_alike_creep_as_the_one_body_that_they_are():
    def of(load, **body):
        whole = scene(load=load)
        whole["body"] = body
        return whole

    stack = {"layers": [{"youngs_modulus": 2.0, "poissons_ratio": 0.4, "height": 0.02}], "base": "rigid"}
    stack["layers"] += [{"youngs_modulus": 20.0, "poissons_ratio": 0.2, "height": 0.1}]
    found = solved(of(0.05, **stack, relaxation=relaxation(THREE, 2.0)), dwells((2.0,)), time_tolerance=1e-2)
    for i, time in enumerate((0.0, 2.0)):
        elastic = solved(of(0.05 * compliance(THREE, time), **stack))
        error = abs(found["gap"][i] - elastic["gap"]).max() / elastic["gap"].max()
        assert float(error) <= max(float(found["time_error"][i]), 1e-8)


def test_under_a_load_that_grows_evenly_the_profile_is_that_of_the_equivalent_load():
    creeping = solved(
        scene(series=STANDARD, duration=0.5), [{"duration": 1.5, "reduced_pressure": 0.2}], time_tolerance=1e-2
    )
    for i, time in enumerate((0.5, 2.0)):
        elastic = solved(scene(load=equivalent_load(STANDARD, 0.0, 0.1, time)))
        assert float(creeping["contact_area_fraction"][i]) == pytest.approx(
            float(elastic["contact_area_fraction"]), rel=1e-6
        )
        assert float(creeping["mean_gap"][i]) == pytest.approx(float(elastic["mean_gap"]), rel=1e-3)


@pytest.mark.filterwarnings("ignore:after some .* s this body is fully relaxed")
@pytest.mark.parametrize("slab", [False, True])
def test_loads_at_once_find_a_glassy_body_and_slow_ones_a_relaxed_body(slab):
    def of(body, *given, **more):
        whole = scene(**more)
        whole["body"] |= body | ({"poissons_ratio": 0.3, "aspect_ratio": 0.3} if slab else {})
        return solved(whole, *given, residual=1e-10)

    found = of({"relaxation": relaxation(THREE)}, [{"duration": 1e6}, {"duration": 1e6}])
    for i, load in ((0, 0.05 / 4.5), (2, 0.05)):
        elastic = of({}, load=load)
        for name in ("gap", "displacement"):
            np.testing.assert_allclose(found[name][i], elastic[name], atol=1e-8 * float(abs(elastic[name]).max()))
        pressure = elastic["pressure"] * (4.5 if i == 0 else 1.0)
        np.testing.assert_allclose(found["pressure"][i], pressure, atol=1e-8 * float(pressure.max()))


def test_a_ball_creeps_as_lee_and_radok_say():
    """The approach a^2 / R, a^3 = 3 R F J / 4, which is known better than the radius of so few nodes."""
    load = 4.0 * 0.25**3 / (3.0 * 4.0)
    found = in_a_window(2, 4.0, 32, {"force": load}, dwells((2.0,)))
    for i, time in enumerate((0.0, 2.0)):
        radius = np.cbrt(3.0 * load * compliance(STANDARD, time))
        assert float(found["approach"][i]) == pytest.approx(radius**2 / 4.0, rel=2e-3)


@pytest.mark.long
def test_a_ball_is_unloaded_as_ting_says():
    """Approach at an even speed and back: the contact is that of the time t1 with int_t1^t E(t - s) d(approach) = 0."""
    deepest, turn = 0.25**2 / 4.0, 1.0

    def speed(time):
        return deepest if time < turn else -deepest

    def earlier(time):
        def missing(first):
            parts = [(first, turn), (turn, time)]
            return sum(quad(lambda s: modulus(STANDARD, time - s) * speed(s), *part)[0] for part in parts)

        return brentq(missing, 0.0, turn)

    def force(time):
        last = time if time <= turn else earlier(time)  # F = 4 / (3 R) int E(t - s) d(a^3), a^2 = R approach
        cubes = lambda s: 1.5 * (4.0 * deepest) ** 1.5 * np.sqrt(s)  # noqa: E731
        return quad(lambda s: modulus(STANDARD, time - s) * cubes(s), 0.0, last)[0] / 3.0

    path = [{"displacement": share * deepest, "duration": abs(share - 1.0)} for share in (0.9, 0.8)]
    path[1]["duration"] = 0.1
    found = in_a_window(2, 4.0, 32, {"displacement": deepest, "duration": 1.0}, path)
    for i, time in enumerate((1.0, 1.1, 1.2)):
        assert float(found["mean_pressure"][i]) == pytest.approx(force(time), rel=5e-3)
    radius = np.sqrt(4.0 * deepest * earlier(1.2))
    assert float(found["contact_radius"][-1]) == pytest.approx(radius, rel=0.05)


def rough_problem(n=128, load=0.05, series=STANDARD, tolerance=1e-3, residual=1e-10, **more):
    """A relaxing body under a rough profile."""
    surface = given_surface(self_affine.SelfAffineWaves(0.8, 2, n // 8).heights((n,), 3, range(1))[0])[0]
    numerics, memory = Options("active_set_newton", residual=residual), PronySeries(*zip(*series, strict=True))
    body, laws = ElasticBody(None, None), Interactions(True)
    return Problem(surface, body, laws, load, None, numerics, relaxation=memory, time_tolerance=tolerance, **more)


def test_steps_in_time_are_of_second_order():
    """A dwell, and a load that falls: the error of divisions of time against 36 of them falls as their square."""
    for load in (0.05, 0.01):
        problem = rough_problem()
        state = solve(problem, begin(problem, range(1))).after
        step = problem.under(LoadStep(load, (0.0,), 2.0))
        exact = time_steps._divided(step, state, 36)[0]
        errors = [time_steps.difference(time_steps._divided(step, state, n)[0], exact) for n in (3, 6, 12)]
        orders = -np.diff(np.log2(errors))
        assert (orders > 1.5).all()
        assert np.log2(errors[0] / errors[-1]) / 2 == pytest.approx(2.0, abs=0.25)


def random_history(seed, tolerance):
    """A relaxing profile under a path of four random loads and durations, some of them 0."""
    draw = np.random.default_rng(seed)
    series = tuple(zip(draw.uniform(0.2, 4.0, 2), 10.0 ** draw.uniform(-1.0, 0.0, 2), strict=True))
    loads, durations = 10.0 ** draw.uniform(-2.0, -0.5, 5), 10.0 ** draw.uniform(-1.5, 1.0, 5) * (draw.random(5) > 0.2)
    first, *path = (LoadStep(load, (0.0,), time) for load, time in zip(loads, durations, strict=True))
    return rough_problem(64, first.load, series, tolerance, 1e-8, duration=first.duration, path=tuple(path))


def worst_of(seed, tolerance, monkeypatch):
    """Largest error of a random history against four times finer divisions, and the largest that is reported."""
    problem, counts = random_history(seed, tolerance), []
    divided = time_steps._divided

    def counted(step, state, divisions):
        counts.append((step.step, divisions))
        return divided(step, state, divisions)

    with monkeypatch.context() as patch:
        patch.setattr(time_steps, "_divided", counted)
        found = list(solve_path(problem, 0))
    taken = dict(counts)
    state, errors = begin(problem, range(1)), []
    for step, contact in zip((problem.step, *problem.path), found, strict=True):
        one = problem.under(step)
        fine = divided(one, state, 4 * taken[step] if step.duration else 1)[0]
        assert contact.equilibrium.status[0] == fine.equilibrium.status[0] == 0
        errors.append(time_steps.difference(contact, fine))
        state = fine.after
    return max(errors), found[-1].time_error


@pytest.mark.long
def test_automatic_steps_hold_their_tolerance(monkeypatch):
    error, reported = worst_of(1, 5e-2, monkeypatch)
    assert error <= reported <= 5e-2


@pytest.mark.long
@pytest.mark.parametrize("seed", [25, 37])
def test_automatic_steps_hold_their_tolerance_in_hard_histories(seed, monkeypatch):
    """In a contact whose nodes touch down in turn, and in one of whose load hardly a twentieth is left."""
    error, reported = worst_of(seed, 1e-2, monkeypatch)
    assert error <= reported <= 1e-2


def test_the_error_that_is_left_is_judged_by_the_slower_of_two_changes():
    order = [1e-2 * 4.0**-n for n in range(4)]
    assert time_steps.remaining_error(order) == pytest.approx(order[-1] / 1.5)
    assert time_steps.remaining_error([1e-2]) > 6e-2  # nothing is known of the next change
    assert time_steps.remaining_error([6e-3, 1.4e-2]) > 9e-2  # nor where changes grow
    assert time_steps.remaining_error([6.8e-3, 4.9e-3, 1.1e-3]) > 2.8e-3  # a small one by chance
    assert time_steps.remaining_error([1e-2, 1e-5]) >= 1e-2 / 6.0
    assert time_steps.remaining_error([0.0, 0.0]) == 0.0


def test_what_the_punch_does_is_stored_or_dissipated():
    """A slab in a window is pressed and let go; the work is that of a smooth force through those at the steps' ends.

    A force that is linear between these would be wrong by 3e-3, whatever the divisions of time.
    """
    rises, falls = np.linspace(0.1, 1.0, 10), np.linspace(0.9, 0.1, 9)
    depth = 2e-3 * np.concatenate([rises, falls])
    whole = scene(periodic=False, series=STANDARD)
    whole["body"] |= {"poissons_ratio": 0.3, "aspect_ratio": 0.5}
    whole["loading"] = {"displacement": depth[0], "duration": 0.1}
    found = solved(whole, [{"displacement": each, "duration": 0.1} for each in depth[1:]])
    force, deepest = np.concatenate([[0.0], found["mean_pressure"]]), len(rises)
    loading, unloading = CubicSpline([0.0, *depth[:deepest]], force[: deepest + 1]), depth[deepest - 1 :][::-1]
    spent = CubicSpline(unloading, force[deepest:][::-1])
    work = np.array(
        [loading.integrate(0.0, d) for d in depth[:deepest]]
        + [loading.integrate(0.0, depth[deepest - 1]) - spent.integrate(d, depth[deepest - 1]) for d in depth[deepest:]]
    )
    stored = np.array(found["elastic_energy"])
    lost = np.cumsum(found["energy_lost"])
    assert (np.diff(lost) > 0.0).all()
    np.testing.assert_allclose(stored + lost, work, atol=4e-4 * work.max())
    assert float(found["hysteresis"]) == pytest.approx(lost[-1])


def test_an_elastic_body_has_no_memory_and_pays_nothing(monkeypatch):
    relaxing = solved(scene(series=STANDARD))

    def made(*given):
        raise AssertionError("what a memory alone needs was made")

    for name in ("begin", "change", "advance"):
        monkeypatch.setattr(Relaxation, name, made)
    monkeypatch.setattr(time_steps, "follow", made)
    elastic = solved(scene(), [{"reduced_pressure": 0.1}])
    stiff = solved(scene(load=0.05 / 4.0))
    assert int(stiff["n_transforms"]) == int(relaxing["n_transforms"])  # a memory takes none either
    assert "time" not in elastic.coords
    assert "time_error" not in elastic
    problem = rough_problem()
    assert problem.identity != Problem(**{**_fields(problem), "relaxation": None, "time_tolerance": None}).identity
    with pytest.raises(AssertionError, match="memory alone"):
        begin(problem, range(1))


def _fields(problem):
    return {name: getattr(problem, name) for name in Problem.__dataclass_fields__ if name != "_identity"}


def test_a_difference_is_the_larger_one_over_what_it_came_from():
    def contact(pressure, stretch, largest=(0.0, 0.0)):
        moved = np.array([stretch, np.zeros(2)])[:, np.newaxis, np.newaxis]
        after = SimpleNamespace(memory={"springs": SimpleNamespace(stretch=moved, largest=largest)})
        equilibrium = SimpleNamespace(pressure=np.array([pressure]), tangential=None, displacement=None)
        return SimpleNamespace(after=after, equilibrium=equilibrium)

    coarse = contact([1.0, 1.0], [2.0, 2.0])
    assert time_steps.difference(coarse, contact([1.0, 1.1], [2.0, 3.0], (21.0, 10.0))) == pytest.approx(0.1)
    assert time_steps.difference(coarse, contact([1.0, 1.1], [2.0, 3.0], (0.2, 1e3))) == pytest.approx(0.1 / 2.1)


def test_springs_remember_the_largest_load():
    problem = rough_problem()
    high = solve(problem, begin(problem, range(1))).after
    low = solve(problem.under(LoadStep(1e-3, (0.0,), 2.0)), high).after
    assert low.memory["springs"].largest[0] == pytest.approx(high.memory["springs"].largest[0])


@pytest.mark.filterwarnings("ignore:stagnated:UserWarning")
def test_where_a_division_of_time_fails_nothing_is_said_of_the_end_of_the_step(monkeypatch):
    """The contact is then one on the way, of fewer nodes, and its error in time is unknown."""
    solve_one, loading = solve, {"line_load": 0.25 * np.pi * 0.25**2 / 4.0, "duration": 1.0}

    def failing(problem, state):
        found = solve_one(problem, state)
        found.equilibrium.status[:] = Status.stagnated if problem.duration < 1.0 else Status.ok
        return found

    scene = {"periodic": False, "length": 1.0, "form": {"radius": 4.0, "points": 26}, "interface": {"hard_wall": {}}}
    scene |= {"body": {"poissons_ratio": 0.5, "youngs_modulus": 0.75, "relaxation": relaxation(STANDARD, 0.75)}}
    file = {"scene": scene | {"loading": loading}}
    assert not gfmd_numba.solve(file | {"numerics": {"time_tolerance": 0.1}}).validity
    monkeypatch.setattr(time_steps.solution, "solve", failing)
    found = gfmd_numba.solve(file)
    assert int(found["status"]) == Status.stagnated
    assert 0 < int((found["pressure"] > 0.0).sum()) < FEWEST
    assert not found.validity
    problem, _ = read_contact(*load_scene(file)).reduced
    assert np.isnan(next(solve_path(problem, 0)).time_error)
