"""Attraction on bodies that creep: limits of slow and fast paths, pull-off at a rate, energy, and random histories."""

import numpy as np
import pytest

import gfmd_numba
from gfmd_numba.contact.load_path import solve_path
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import LoadStep
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.prony import PronySeries
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.roughness.surfaces import given_surface
from gfmd_numba.solvers.table import Options
from support.viscoelastic import STANDARD, relaxation

pytestmark = pytest.mark.filterwarnings("ignore:after some .* fully relaxed")  # limits
POINTS, DEEPEST = 160, 8e-3
HEIGHTS = 2e-2 * np.cos(2.0 * np.pi * np.arange(POINTS) / POINTS)
LAW = {"work_of_adhesion": 2e-4, "range": 2e-3}


def drawn_off(series, seconds=None, steps=4, modulus=1.0, highest=DEEPEST, **numerics):
    """A wave that was pressed into a slab, at rest if the body creeps, and is drawn off in so many seconds."""
    body = {"youngs_modulus": modulus, "poissons_ratio": 0.3, "aspect_ratio": 0.5}
    body |= {} if series is None else {"relaxation": relaxation(series)}
    ways = np.linspace(DEEPEST, -highest, steps + 1)[1:].tolist()
    takes = {} if series is None else {"duration": seconds / steps}
    path = [{"displacement": way, **takes} for way in ways]
    found = gfmd_numba.solve(
        {
            "scene": {
                "length": 1.0,
                "body": body,
                "roughness": {"method": "measured", "units": {"z": "m"}},
                "interface": {"hard_wall": {}, "exponential": LAW},
                "loading": {"displacement": DEEPEST},
            },
            "path": path if series is None else [{"duration": 1e7}, *path],
            "numerics": numerics,
        },
        heights=HEIGHTS,
    )
    assert not found["status"].any()
    return found if series is None else found.isel(step=slice(1, None))


@pytest.mark.long
def test_a_slow_path_is_that_of_the_relaxed_body():
    slow, elastic = drawn_off(STANDARD, 1e7, steps=2), drawn_off(None, steps=2)
    np.testing.assert_allclose(slow["mean_pressure"], elastic["mean_pressure"], atol=1e-3 * 6.7e-3)
    np.testing.assert_array_equal(slow["gap"] == 0.0, elastic["gap"] == 0.0)


@pytest.mark.long
def test_a_load_at_once_is_that_of_the_glassy_body():
    glassy = drawn_off(None, modulus=4.0, steps=1)
    first = gfmd_numba.solve(
        {
            "scene": {
                "length": 1.0,
                "body": {
                    "youngs_modulus": 1.0,
                    "poissons_ratio": 0.3,
                    "aspect_ratio": 0.5,
                    "relaxation": relaxation(STANDARD),
                },
                "roughness": {"method": "measured", "units": {"z": "m"}},
                "interface": {"hard_wall": {}, "exponential": LAW},
                "loading": {"displacement": DEEPEST},
            }
        },
        heights=HEIGHTS,
    )
    pressure = glassy["pressure"].isel(step=0)
    np.testing.assert_allclose(first["pressure"], pressure, atol=1e-6 * float(abs(pressure).max()))


@pytest.mark.long
def test_the_faster_it_is_drawn_off_the_more_it_sticks():
    how = {"steps": 4, "highest": 3.0 * DEEPEST, "time_tolerance": 1e-2}
    slow, fast = (float(drawn_off(STANDARD, seconds, **how)["pull_off_pressure"]) for seconds in (1e7, 0.1))
    assert 0.0 < slow < 0.6 * fast


def adhesive_problem(path, series=STANDARD, load=0.05, tolerance=1e-3, n=64, seed=3, duration=0.0):
    """A relaxing slab under a rough profile that attracts it, by prescribed displacements."""
    surface = given_surface(self_affine.SelfAffineWaves(0.8, 2, n // 8).heights((n,), seed, range(1))[0])[0]
    laws = Interactions(True, ExponentialLaw(2e-3, 0.01))
    memory, options = PronySeries(*zip(*series, strict=True)), Options("truncated_newton")
    slab = ElasticBody(0.3, 0.5)
    return Problem(
        surface,
        slab,
        laws,
        None,
        load,
        options,
        path=path,
        relaxation=memory,
        time_tolerance=tolerance,
        duration=duration,
    )


@pytest.mark.long
def test_work_is_stored_dissipated_or_in_the_law_where_nothing_jumps():
    """Drawn off by a little from rest, so that the contact only shrinks."""
    steps = 16
    ways = 0.05 - 0.01 * np.linspace(0.0, 1.0, steps + 1)[1:]
    path = (LoadStep(0.05, (0.0,), 1e4), *(LoadStep(way, (0.0,), 1.0 / steps) for way in ways))
    problem = adhesive_problem(path, tolerance=1e-3)
    contacts = list(solve_path(problem, 0))[1:]
    law, energies, forces, lost = problem.interface.normal_law, [], [], []
    for each in contacts:
        springs, gap = each.after.memory["springs"], each.punch - each.equilibrium.displacement
        energies.append(float(springs.energy(periodic=False)[0] + law.energy(gap).mean()))
        forces.append(float(each.equilibrium.pressure.mean()))
        lost.append(float(springs.dissipated[0]))
    work = 0.5 * (np.array(forces[1:]) + forces[:-1]) * np.diff([0.05, *ways])
    balance = np.diff(energies) + np.diff(lost) - work
    assert np.diff(lost).min() > 0.0
    assert abs(balance.sum()) < 1e-3 * abs(work).sum()


def test_a_random_history_is_certified():
    seed = 1
    draw = np.random.default_rng(seed)
    series = tuple(zip(draw.uniform(0.2, 4.0, 2), 10.0 ** draw.uniform(-1.0, 0.0, 2), strict=True))
    loads, times = draw.uniform(-0.03, 0.1, 5), 10.0 ** draw.uniform(-1.5, 1.0, 5) * (draw.random(5) > 0.2)
    steps = tuple(LoadStep(load, (0.0,), time) for load, time in zip(loads, times, strict=True))[:3]
    problem = adhesive_problem(steps, series, 0.05, 1e-2, seed=seed)
    for contact in solve_path(problem, 0):
        assert contact.equilibrium.status[0] == 0
        assert contact.equilibrium.residual[0] <= 1e-8
