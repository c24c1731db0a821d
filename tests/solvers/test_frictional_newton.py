"""Newton's method for friction: every result holds the conditions, and is what damped dynamics finds."""

from dataclasses import replace

import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import begin, equilibrate, following
from gfmd_numba.solvers.iteration import Batch, Start
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import SOLVERS, Options
from support.cases import some_of
from support.contact_conditions import largest_violation, sticking

NEWTON = Options("frictional_newton", max_iterations=100)  # and no other solver after it


def rough(nx, seed, hurst=0.8, waves=32, rows=1):
    heights = self_affine.SelfAffineWaves(hurst, 2, waves).heights((nx,), seed, range(rows))
    return heights.max(axis=1, keepdims=True) - heights


def press(punch, stiffness, load, friction, start=None, sliding=0.0, options=NEWTON):
    return equilibrate(punch, stiffness, load, options, Interactions(True, friction=friction), start, sliding)


def random_path(seed):
    """Stiffness, friction and steps (punch, load, sliding) of a random scene."""
    rng = np.random.default_rng(seed)
    nx = int(rng.choice([128, 255, 512, 1000]))
    nu = float(rng.choice([rng.uniform(-0.5, 0.5), 0.0, 0.3, 0.5]))
    aspect_ratio = rng.choice([None, 10 ** rng.uniform(-2.0, 0.5)])
    friction, load = 10 ** rng.uniform(-2.0, 0.0), 10 ** rng.uniform(-3.0, 0.0)
    punch = rough(nx, seed, rng.uniform(0.1, 1.0), int(rng.integers(4, nx // 2)))
    deep = rng.uniform(0.1, 0.6) * punch.mean()
    controls_load = aspect_ratio is None or rng.random() < 0.5
    sliding, steps = 0.0, []
    for _ in range(4):
        steps.append((punch, load, sliding) if controls_load else (punch - deep, None, sliding))
        factor = 10 ** rng.uniform(-0.5, 0.2)
        load, deep = load * factor, min(deep * factor, 0.7 * punch.mean())
        if aspect_ratio is not None:
            sliding += rng.normal() * friction * min(aspect_ratio, 1.0) * 10 ** rng.uniform(-3.0, 0.0)
    return ElasticBody(nu, aspect_ratio).response((nx,)), friction, steps


@pytest.mark.parametrize("seed", some_of(range(0, 24, 4), 0, 2, 5))
def test_every_step_of_a_random_path_holds_the_conditions_of_signorini_and_coulomb(seed):
    stiffness, friction, steps = random_path(seed)
    before = None
    for punch, load, sliding in steps:
        start = None if before is None else following(before, punch, sliding)
        result = press(punch, stiffness, load, friction, start, sliding)
        assert result.status[0] == Status.ok
        assert largest_violation(stiffness, punch, load, friction, result, start) < 2e-8
        before = result


def test_a_wrong_traction_is_told_from_a_right_one():
    """The conditions above can fail: of the friction, the way, the pressure and the penetration."""
    punch, stiffness = rough(256, 1), ElasticBody(0.2, 0.5).response((256,))
    result = press(punch, stiffness, 0.1, 0.2)
    assert largest_violation(stiffness, punch, 0.1, 0.2, result) < 2e-8
    assert largest_violation(stiffness, punch, 0.1, 0.19, result) > 1e-3
    assert largest_violation(stiffness, punch, 0.101, 0.2, result) > 1e-3
    assert largest_violation(stiffness, punch - 1e-3, 0.1, 0.2, result) > 1e-4
    moved = Start(punch, np.ones((1, 1, 256)))  # so that all nodes slid the other way
    assert largest_violation(stiffness, punch, 0.1, 0.2, result, moved) > 1e-3


@pytest.mark.parametrize(
    ("nu", "friction", "load", "aspect_ratio"),
    [(0.0, 0.15, 0.15, None), (-0.4, 0.4, 0.02, 1.0), (0.3, 0.9, 0.1, 0.1), (0.5, 0.9, 0.1, 0.1)],
)
def test_the_dynamics_has_the_same_nodes_sticking_and_slipping(nu, friction, load, aspect_ratio):
    nx = 256
    punch, stiffness = rough(nx, 3), ElasticBody(nu, aspect_ratio).response((nx,))
    at_rest, row = Start.at_rest(punch), np.arange(1)
    batch = Batch(
        punch, stiffness.with_mean(0.0), np.array([load]), Interactions(True, friction=friction), at_rest, 0.0, 10.0
    )
    dynamics = begin(batch, Options("verlet"))
    while dynamics.residual(row)[0] > 1e-10:
        for _ in range(20):
            dynamics.advance(row)
    (tangential, normal), (shear, restoring) = (each[0, :, :nx] for each in dynamics.state[:2])
    found = press(punch, stiffness, load, friction, options=Options("frictional_newton", residual=1e-10))
    assert found.status[0] == Status.ok
    touching = (normal >= punch[0]) & (restoring < load)
    np.testing.assert_array_equal(found.touching[0], touching)
    np.testing.assert_array_equal(sticking(found, at_rest), touching & (tangential == 0.0))
    peak = found.pressure.max()
    np.testing.assert_allclose(found.tangential.traction[0, 0], shear, atol=3e-9 * peak)
    np.testing.assert_allclose(found.pressure[0][touching], (load - restoring)[touching], atol=3e-9 * peak)


@pytest.mark.parametrize("aspect_ratio", [0.1, 1.0])
def test_a_rigid_mean_is_the_limit_of_one_that_is_nearly_rigid(aspect_ratio):
    punch, friction = rough(256, 2), 0.3
    punch -= 0.4 * punch.mean()
    found = []
    for nu in (0.5, 0.5 - 1e-9):
        stiffness, before = ElasticBody(nu, aspect_ratio).response((256,)), None
        for sliding in (0.0, 0.02 * aspect_ratio, 0.0):
            start = None if before is None else following(before, punch, sliding)
            before = press(punch, stiffness, None, friction, start, sliding)
            assert before.status[0] == Status.ok
            assert largest_violation(stiffness, punch, None, friction, before, start) < 2e-8
        found.append(before)
    rigid, nearly = found
    assert abs(rigid.tangential.traction).max() > 0.01 * rigid.pressure.max()
    np.testing.assert_allclose(rigid.pressure, nearly.pressure, atol=1e-5 * rigid.pressure.max())
    np.testing.assert_allclose(rigid.tangential.traction, nearly.tangential.traction, atol=1e-5 * rigid.pressure.max())


def test_an_incompressible_slab_has_no_room_below_the_mean_of_the_punch():
    punch = rough(128, 2)
    stiffness = ElasticBody(0.5, 0.5).response((128,))
    for options in (NEWTON, Options("frictional_newton")):  # the dynamics knows no rigid mean, and is not begun
        result = press(punch - 1.01 * punch.mean(), stiffness, None, 0.3, options=options)
        assert result.status[0] == Status.no_equilibrium
        assert result.n_iterations[0] <= 100


def test_layers_whose_compliance_is_no_sum_of_decays_are_solved_too():
    nx, friction, load = 256, 0.3, 0.3
    body = ElasticBody.layered((0.02,), (Material(1.0, 0.2),), Material(0.01, 0.4))
    stiffness, punch = body.response((nx,)), 0.1 * rough(nx, 5)
    result = press(punch, stiffness, load, friction)
    assert result.status[0] == Status.ok
    assert largest_violation(stiffness, punch, load, friction, result) < 2e-8


def test_transforms_of_rough_contacts_stay_below_three_hundred():
    """Damped dynamics takes some thousands of the same contacts."""
    nx, rows = 2048, 1
    for nu, friction in ((0.3, 1.0), (0.0, 0.3)):
        punch, stiffness = rough(nx, 7, 0.8, 256, rows), ElasticBody(nu, None).response((nx,))
        result = press(punch, stiffness, 0.05, friction)
        assert (result.status == Status.ok).all()
        assert result.n_transforms[0] < 300
    damped = press(punch, stiffness, 0.05, friction, options=Options("verlet"))
    assert damped.n_transforms[0] > 8 * result.n_transforms[0]


def test_a_row_does_not_depend_on_the_others():
    punch, stiffness = rough(300, 9, 0.5, rows=3), ElasticBody(0.2, 0.4).response((300,))
    together = press(punch, stiffness, 0.1, 0.25)
    for row in range(3):
        alone = press(punch[row : row + 1], stiffness, 0.1, 0.25)
        np.testing.assert_array_equal(alone.pressure[0], together.pressure[row])
        np.testing.assert_array_equal(alone.tangential.displacement[0], together.tangential.displacement[row])
        assert alone.n_transforms[0] == together.n_transforms[row]


def test_a_punch_that_touches_nothing_is_carried_by_nothing():
    punch, stiffness = rough(128, 4) + 0.1, ElasticBody(0.3, 0.5).response((128,))
    result = press(punch, stiffness, None, 0.3)
    assert result.status[0] == Status.ok
    assert not result.pressure.any()
    assert not result.tangential.traction.any()


def test_a_run_that_is_cut_short_says_so():
    punch, stiffness = rough(512, 6), ElasticBody(0.0, None).response((512,))
    result = press(punch, stiffness, 0.2, 0.1, options=Options("frictional_newton", max_iterations=1))
    assert result.status[0] == Status.steps_used_up
    assert 1e-8 < result.residual[0] < np.inf
    assert result.pressure.mean() == pytest.approx(0.2, rel=0.2)


def test_a_guess_that_goes_to_and_fro_ends():
    """A contact of few spots on a half-space, where each hands the task of holding the body on to the next."""
    punch, stiffness = rough(256, 384, waves=128), ElasticBody(0.3, None).response((256,))
    result = press(punch, stiffness, 0.04, 0.092)
    assert result.status[0] == Status.ok
    assert largest_violation(stiffness, punch, 0.04, 0.092, result) < 2e-8


def test_what_newton_gives_up_the_dynamics_takes_over(monkeypatch):
    monkeypatch.setitem(SOLVERS, "frictional_newton", replace(SOLVERS["frictional_newton"], gives_up_after=2))
    punch, stiffness = rough(128, 3), ElasticBody(0.3, 0.5).response((128,))
    assert press(punch, stiffness, 0.2, 0.1).status[0] == Status.steps_used_up
    found = press(punch, stiffness, 0.2, 0.1, options=Options("frictional_newton"))
    assert found.status[0] == Status.ok
    assert found.n_iterations[0] > 2


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("load", [0.3, None])
def test_under_an_infinite_friction_no_node_slips_and_free_ones_bear_nothing(nu, load):
    """Nodes that touched before stay; of others, those that their traction pulls off touch down free of traction."""
    punch, stiffness = rough(256, 1), ElasticBody(nu, 0.3).response((256,))
    before, steps = None, ((0.0, load), (0.02, load), (-0.03, None if load is None else 0.5 * load))
    if load is None:
        punch -= 0.4 * punch.mean()
    for sliding, pushed in steps:
        start = None if before is None else following(before, punch, sliding)
        before = press(punch, stiffness, pushed, np.inf, start, sliding)
        assert before.status[0] == Status.ok
        assert not before.tangential.slip.any()
        assert largest_violation(stiffness, punch, pushed, np.inf, before, start) < 2e-8
    assert abs(before.tangential.traction).max() > 0.1 * before.pressure.max()


def test_full_contact_that_sticks_has_the_tractions_of_its_displacements():
    nx, load = 64, 2.0
    punch = 0.1 * (1.0 - np.cos(2.0 * np.pi * np.arange(nx) / nx))[np.newaxis]
    stiffness = ElasticBody(0.1, None).response((nx,))
    found = press(punch, stiffness, load, np.inf)
    k13, k33 = stiffness.elements[1][1], stiffness.normal[1]
    assert found.touching.all()
    wave = punch - punch.mean()
    np.testing.assert_allclose(found.pressure, load - k33 * wave, atol=1e-8)
    quarter = np.roll(wave, -nx // 4, axis=1)  # u1 = 0 everywhere, so that only the coupling acts
    np.testing.assert_allclose(found.tangential.traction[0], k13 * quarter, atol=1e-8)
