"""A run whose residual has stopped falling ends, and says so; a slow one goes on."""

import re
from dataclasses import replace

import numpy as np
import pytest
import yaml

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers import equilibrium
from gfmd_numba.solvers.equilibrium import equilibrate, following
from gfmd_numba.solvers.status import Stagnation, Status
from gfmd_numba.solvers.table import Options
from support.command_line import gfmd, unfolded
from support.laws import surface


def stopped_at(residuals):
    """Looks `[row]` after which residuals `[look, row]` are said to have stopped falling; 0 for never."""
    rows = np.arange(residuals.shape[1])
    stagnation = Stagnation(rows.size)
    flags = np.array([stagnation.look(each, rows) for each in residuals])
    return np.where(flags.any(axis=0), flags.argmax(axis=0) + 1, 0)


def test_residuals_that_fall_slowly_are_left_alone():
    """Exponentials of from 30 to 3000 looks for a factor of e, some with swings or scatter, and powers of time."""
    rng, looks = np.random.default_rng(0), np.arange(1, 10001)[:, np.newaxis]
    slowness, swings = np.geomspace(30.0, 3000.0, 40), rng.uniform(0.1, 2.0, 40)
    falling = np.exp(-looks / slowness)
    swinging = falling * (np.abs(np.cos(swings * looks / slowness)) + 0.01)
    scattered = falling * np.exp(rng.normal(size=falling.shape))
    powers = looks ** -np.linspace(0.15, 2.0, 20)
    assert (stopped_at(np.hstack([falling, swinging, scattered, powers])) == 0).all()


@pytest.mark.parametrize("least", [1e-3, 1e-5, 1e-7])
def test_a_contact_that_creeps_past_a_lost_equilibrium_is_left_alone(least):
    """There x' = least + x^2: the residual is least in the middle, and then a jump leads to another equilibrium."""
    middle = np.tan(np.linspace(-1.5, 1.5, 2000))
    creeping = least * (1.0 + middle**2)
    residuals = np.concatenate([creeping, np.exp(-np.arange(4000) / 100.0)])[:, np.newaxis]
    assert stopped_at(residuals)[0] == 0
    begun_there = np.concatenate([np.full(5, least), np.exp(-np.arange(400) / 10.0)])[:, np.newaxis]
    assert stopped_at(begun_there)[0] == 0


@pytest.mark.parametrize("floor", [1e-4, 1e-8, 1e-13])
def test_a_floor_is_found_in_a_few_times_the_looks_that_led_to_it(floor):
    """Residuals there scatter by a factor of two to either side."""
    rng, looks = np.random.default_rng(1), np.arange(1, 6001)[:, np.newaxis]
    slowness = np.geomspace(1.0, 30.0, 20)
    reached = slowness * np.log(1.0 / floor)
    residuals = np.exp(-looks / slowness) + floor * 2.0 ** rng.uniform(-1.0, 1.0, (6000, 20))
    stopped = stopped_at(residuals)
    assert (stopped > 2.0 * reached).all()
    assert (stopped < 10.0 * reached + 200.0).all()


def test_what_rounding_leaves_ends_the_run_long_before_the_iterations_allowed():
    punch, body = surface(256)
    laws, most = Interactions(False, ExponentialLaw(-1e-3, 2e-3)), 20_000
    for load, options, acting in (
        (1e-11, Options("conjugate_gradients"), Interactions(True)),
        (0.05, Options("truncated_newton", 1e-16), laws),
        (0.05, Options("verlet", 1e-16), laws),
    ):
        found = equilibrate(
            punch, SpectralResponse.of_normal(body), load, replace(options, max_iterations=most), acting
        )
        assert (found.status == Status.stagnated).all()
        assert (found.residual > options.residual).all()
        assert (found.n_iterations < most / 4).all()


def test_the_message_names_the_residual_that_rounding_left_and_what_to_do(tmp_path):
    scene = {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 1e-11},
    }
    path = tmp_path / "light.yaml"
    path.write_text(yaml.safe_dump({"scene": scene, "discretisation": {"eps_c": 0.25, "eps_f": 0.03125, "eps_t": 0.5}}))
    done = gfmd("solve", path, "-o", tmp_path / "out.nc")
    assert done.exit_code == 3
    said = unfolded(done.stderr)
    assert re.search(r"stagnated after \d{2,4} iterations at a residual of \d\.\de-0[5-7]", said)
    assert "ask for a numerics.residual above the one that was found" in said


def run(random, solver):
    """One random contact, and a next load on it, of a solver that is not always well chosen."""
    n = int(random.choice([64, 128, 256]))
    heights = self_affine.SelfAffineWaves(random.uniform(0.3, 0.9), 2, n // 4).heights(
        (n,), int(random.integers(1000)), range(3)
    )
    punch = heights.max(axis=1, keepdims=True) - heights
    body = ElasticBody(0.3, float(random.choice([0.05, 0.5])) if random.random() < 0.5 else None)
    length, load = 10 ** random.uniform(-2.3, -1.0), 10 ** random.uniform(-2.5, -0.3)
    numbers = {}
    if solver in ("verlet", "fire", "gronbech_jensen"):
        numbers["time_step"] = random.uniform(0.2, 0.95)
    if solver in ("verlet", "gronbech_jensen"):
        numbers["damping"] = 10 ** random.uniform(-0.7, 0.7)
    options = Options(solver, 10 ** random.uniform(-10, -6), max_iterations=100_000, **numbers)
    laws, stiffness = Interactions(True), body.response((n,))
    if solver != "conjugate_gradients":
        attraction = ExponentialLaw(10 ** random.uniform(-4.5, -2.5), length)
        if random.random() < 0.5 and solver not in ("fire", "gronbech_jensen"):
            laws = Interactions(random.random() < 0.5, cohesive=XuNeedlemanLaw(attraction.work, length, 2 * length))
        else:
            laws = Interactions(True, attraction)
    if not laws.couples:
        stiffness = stiffness.condensed()
    first = equilibrate(punch, stiffness, load, options, laws)
    return first, equilibrate(punch, stiffness, 1.01 * load, options, laws, following(first, punch, 0.0))


@pytest.mark.parametrize("solver", ["conjugate_gradients", "truncated_newton", "verlet", "fire", "gronbech_jensen"])
def test_runs_that_converge_are_left_alone(solver, monkeypatch):
    """No run that ends ok would have been stopped before."""
    stopped, runs = [], 3

    class Recorded(Stagnation):
        def __init__(self, rows):
            super().__init__(rows)
            stopped.append(np.zeros(rows, dtype=bool))

        def look(self, residual, active):
            stopped[-1][active] |= super().look(residual, active)
            return np.zeros(active.size, dtype=bool)

    random, ok = np.random.default_rng(2), 0
    monkeypatch.setattr(equilibrium, "Stagnation", Recorded)
    for _ in range(runs):
        stopped.clear()
        for found, flags in zip(run(random, solver), stopped, strict=True):
            assert not (flags & (found.status == 0)).any()
            ok += int((found.status == 0).sum())
    assert ok > 5.4 * runs  # of six
