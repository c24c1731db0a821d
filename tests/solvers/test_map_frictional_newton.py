"""Newton's method for friction on maps: every result holds the conditions, and is what other methods find."""

import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.solvers.equilibrium import begin, equilibrate, following
from gfmd_numba.solvers.iteration import HARD_WALL, Batch, Start, leave_pressures
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from support.cases import some_of
from support.frictional_maps import NEWTON, follow, press, rough
from support.map_contact_conditions import largest_violation, sticking


def random_path(seed):
    """Stiffness, friction and steps (punch, load, sliding) of a random scene."""
    rng = np.random.default_rng(seed)
    shape = tuple(int(n) for n in rng.choice([16, 21, 32], 2))
    nu = float(rng.choice([rng.uniform(-0.5, 0.5), 0.0, 0.3, 0.5]))
    aspect_ratio = rng.choice([None, 10 ** rng.uniform(-2.0, 0.5)])
    friction, load = 10 ** rng.uniform(-2.0, 0.0), 10 ** rng.uniform(-2.0, 0.0)
    punch = rough(shape, seed, rng.uniform(0.1, 1.0), rng.uniform(3.0, min(shape) / 2))
    deep = rng.uniform(0.1, 0.6) * punch.mean()
    controls_load = aspect_ratio is None or rng.random() < 0.5
    sliding, steps = np.zeros(2), []
    for _ in range(4):
        steps.append((punch, load, sliding) if controls_load else (punch - deep, None, sliding))
        factor = 10 ** rng.uniform(-0.5, 0.2)
        load, deep = load * factor, min(deep * factor, 0.7 * punch.mean())
        if aspect_ratio is not None:
            way = friction * min(aspect_ratio, 1.0) * 10 ** rng.uniform(-3.0, 0.0)
            sliding = sliding + way * rng.normal(size=2)
    return ElasticBody(nu, aspect_ratio).response(shape), friction, steps


@pytest.mark.parametrize("seed", some_of(range(5), 0, 3))
def test_every_step_of_a_random_path_holds_the_conditions_of_signorini_and_coulomb(seed):
    stiffness, friction, steps = random_path(seed)
    for (punch, load, _), (result, start) in zip(steps, follow(steps, stiffness, friction), strict=True):
        assert result.status[0] == Status.ok
        assert largest_violation(stiffness, punch, load, friction, result, start) < 2e-8


def test_a_wrong_traction_is_told_from_a_right_one():
    """The conditions above can fail: of the friction, the way, the pressure and the penetration."""
    punch, stiffness = rough((24, 24), 1), ElasticBody(0.2, 0.5).response((24, 24))
    result = press(punch, stiffness, 0.1, 0.2)
    assert largest_violation(stiffness, punch, 0.1, 0.2, result) < 2e-8
    assert largest_violation(stiffness, punch, 0.1, 0.19, result) > 1e-3
    assert largest_violation(stiffness, punch, 0.101, 0.2, result) > 1e-3
    assert largest_violation(stiffness, punch - 1e-3, 0.1, 0.2, result) > 1e-4
    start = Start.at_rest(punch)
    turned = Start(punch, start.tangential + np.reshape([0.0, 1e-3], (2, 1, 1)))
    assert largest_violation(stiffness, punch, 0.1, 0.2, result, turned) > 1e-3  # of slip in another direction


def test_the_first_guess_is_the_normal_contact_also_where_its_pressures_are_bounded_and_not_restored():
    """A punch that touches everywhere leaves nothing to revise, so that one step solves the problem."""
    result = press(rough((128, 128), 1, waves=16), ElasticBody(0.3, 1.0), 0.2, 0.3)
    assert result.touching.all()
    assert result.n_iterations[0] == 1


@pytest.mark.parametrize("residual", [1e-2, 1e-8])
def test_a_solver_that_has_ended_leaves_pressures_whatever_it_worked_with(residual):
    punch, load = rough((128, 128), 1, waves=16), 0.05
    response = ElasticBody(0.3, 1.0).response((128, 128)).condensed()
    solver = begin(Batch(punch, response, np.array([load]), HARD_WALL), Options("active_set_newton", residual))
    while solver.residual(np.arange(1))[0] > residual:
        solver.advance(np.arange(1))
    leave_pressures(solver, np.arange(1))
    pressure = solver.state.restoring[0, 0, : 128 * 128]
    exact = equilibrate(punch, response, load, NEWTON).pressure.ravel()
    assert np.abs(pressure - exact).max() < 2.0 * residual * exact.max()


def dense_contact(stiffness, wall, anchor, friction, sweeps):
    """Tractions `[3, node]` of a contact by projections node by node, on the inverse of a dense matrix."""
    n, shape = wall.size, wall.shape
    xx, xy, yy, xz, yz, zz = stiffness.elements
    symbol = np.array([[xx + 0j, xy, 1j * xz], [xy, yy, 1j * yz], [-1j * xz, -1j * yz, zz]])
    matrix = np.empty((3, n, 3, n))
    for component, node in np.ndindex(3, n):
        unit = np.zeros((3, n))
        unit[component, node] = 1.0
        waves = np.fft.rfft2(unit.reshape(3, *shape))
        matrix[:, :, component, node] = np.fft.irfft2(np.einsum("ijyx,jyx->iyx", symbol, waves), shape).reshape(3, n)
    compliance = np.linalg.inv(matrix.reshape(3 * n, 3 * n)).reshape(3, n, 3, n)
    t, u = np.zeros((3, n)), np.zeros((3, n))
    wall, anchor = wall.ravel(), anchor.reshape(2, n)
    for _ in range(sweeps):
        for j in range(n):
            own = compliance[:, j, :, j]
            new = t[:, j].copy()
            new[2] = min(t[2, j] - (u[2, j] - wall[j]) / own[2, 2], 0.0)  # pressure is minus that
            trial = t[:2, j] - (u[:2, j] - anchor[:, j]) / own[0, 0]
            size = np.hypot(*trial)
            new[:2] = trial * min(1.0, -friction * new[2] / size if size > 0.0 else 1.0)
            u += compliance[:, :, :, j] @ (new - t[:, j])
            t[:, j] = new
    return t.reshape(3, *shape)


@pytest.mark.parametrize("nu", [0.0, 0.49])
def test_small_maps_are_those_of_dense_algebra(nu):
    body, shape, friction = ElasticBody(nu, 0.3), (6, 7), 0.3
    wall, stiffness = rough(shape, 5, waves=3) - 0.05, body.response(shape)
    drag = np.reshape([0.004, -0.007], (2, 1, 1))
    start = Start(np.minimum(wall, 0.0), np.zeros((1, 2, *shape)), drag)
    found = press(wall, stiffness, None, friction, start, drag)
    dense = dense_contact(stiffness, wall[0], np.broadcast_to(drag, (2, *shape)), friction, sweeps=200)
    assert found.status[0] == Status.ok
    peak = found.pressure.max()
    np.testing.assert_allclose(found.pressure[0], -dense[2], atol=1e-7 * peak)
    np.testing.assert_allclose(found.tangential.traction[0], dense[:2], atol=1e-7 * peak)
    stuck = sticking(found)
    assert 0 < stuck.sum() < found.touching.sum() < wall.size


@pytest.mark.parametrize(("nu", "friction", "aspect_ratio"), [(0.0, 0.2, None), (0.3, 0.4, 0.3), (0.5, 0.3, 0.5)])
def test_the_dynamics_has_the_same_nodes_sticking_and_slipping(nu, friction, aspect_ratio):
    shape, load = (24, 20), 0.1
    punch, stiffness = rough(shape, 3, waves=6), ElasticBody(nu, aspect_ratio).response(shape)
    drag = np.reshape([0.002, 0.001], (2, 1, 1)) if aspect_ratio else 0.0
    at_rest, row = Start.at_rest(punch), np.arange(1)
    pressed = press(punch, stiffness, load, friction) if aspect_ratio else None
    start = at_rest if pressed is None else following(pressed, punch, drag)
    law = Interactions(True, friction=friction)
    batch = Batch(punch, stiffness.with_mean(0.0), np.array([load]), law, start, drag, 10.0)
    dynamics = begin(batch, Options("verlet"))
    while dynamics.residual(row)[0] > 1e-10:
        for _ in range(20):
            dynamics.advance(row)
    u, ku, anchor = (
        each[..., : punch.size].reshape(1, -1, *shape) for each in (*dynamics.state[:2], dynamics.state.anchor)
    )
    u1, t1, restoring = u[:, :2], ku[:, :2], ku[0, 2]
    found = press(
        punch,
        stiffness,
        load,
        friction,
        start,
        np.ravel(drag) if aspect_ratio else (0.0, 0.0),
        options=Options("frictional_newton", residual=1e-10),
    )
    assert found.status[0] == Status.ok
    touching = (u[0, 2] >= punch[0]) & (restoring < load)
    np.testing.assert_array_equal(found.touching[0], touching)
    np.testing.assert_array_equal(sticking(found), touching & (u1 == anchor)[0].all(axis=0))
    peak = found.pressure.max()
    np.testing.assert_allclose(found.tangential.traction, t1, atol=1e-8 * peak)
    np.testing.assert_allclose(found.pressure[0][touching], load - restoring[touching], atol=1e-8 * peak)


def test_turned_by_a_right_angle_a_contact_is_the_same():
    punch, body = rough((20, 24), 6), ElasticBody(0.1, 0.4)
    steps = [(0.0, 0.0), (0.004, 0.001), (0.004, -0.003)]
    straight = list(follow([(punch, 0.1, way) for way in steps], body, 0.3))
    turned = list(follow([(punch.swapaxes(1, 2), 0.1, way[::-1]) for way in steps], body, 0.3))
    for (one, _), (other, _) in zip(straight, turned, strict=True):
        peak = one.pressure.max()
        np.testing.assert_allclose(one.pressure, other.pressure.swapaxes(1, 2), atol=1e-7 * peak)
        other_traction = other.tangential.traction[:, ::-1].swapaxes(2, 3)
        np.testing.assert_allclose(one.tangential.traction, other_traction, atol=1e-7 * peak)


def test_a_punch_dragged_far_slides_against_its_way():
    punch, body, friction = rough((24, 24), 2), ElasticBody(0.5, 0.5), 0.25
    way = 5.0 * np.array([np.cos(0.7), np.sin(0.7)])
    _, (found, _) = follow([(punch, 0.2, (0.0, 0.0)), (punch, 0.2, way)], body, friction)
    assert found.status[0] == Status.ok
    assert not sticking(found).any()
    dragged = friction * found.pressure[0] * way[:, np.newaxis, np.newaxis] / 5.0
    # the body gives way by some hundredths of the drag, which turns each node by no more than that
    np.testing.assert_allclose(found.tangential.traction[0], dragged, atol=0.02 * friction * found.pressure.max())
    mean = found.tangential.traction[0].mean(axis=(1, 2))
    assert np.hypot(*mean) == pytest.approx(friction * 0.2, rel=1e-3)


def test_a_rigid_mean_is_the_limit_of_one_that_is_nearly_rigid():
    punch, friction, aspect_ratio, found = rough((20, 20), 2), 0.3, 0.1, []
    punch -= 0.4 * punch.mean()
    ways = [(0.0, 0.0), (0.01 * aspect_ratio, 0.02 * aspect_ratio), (0.0, 0.0)]
    for nu in (0.5, 0.5 - 1e-9):
        body = ElasticBody(nu, aspect_ratio)
        stiffness = body.response((20, 20))
        for result, start in follow([(punch, None, way) for way in ways], body, friction):
            assert result.status[0] == Status.ok
            assert largest_violation(stiffness, punch, None, friction, result, start) < 2e-8
        found.append(result)
    rigid, nearly = found
    peak = rigid.pressure.max()
    assert abs(rigid.tangential.traction).max() > 0.01 * peak
    np.testing.assert_allclose(rigid.pressure, nearly.pressure, atol=1e-5 * peak)
    np.testing.assert_allclose(rigid.tangential.traction, nearly.tangential.traction, atol=1e-5 * peak)


def test_a_row_does_not_depend_on_the_others():
    punch, body = rough((20, 24), 9, rows=3), ElasticBody(0.2, 0.4)
    together = press(punch, body, 0.1, 0.25)
    for row in range(3):
        alone = press(punch[row : row + 1], body, 0.1, 0.25)
        np.testing.assert_array_equal(alone.pressure[0], together.pressure[row])
        np.testing.assert_array_equal(alone.tangential.slip[0], together.tangential.slip[row])
        assert alone.n_transforms[0] == together.n_transforms[row]


def test_a_punch_that_touches_nothing_is_carried_by_nothing():
    punch = rough((16, 16), 4) + 0.1
    result = press(punch, ElasticBody(0.3, 0.5), None, 0.3)
    assert result.status[0] == Status.ok
    assert not result.pressure.any()
    assert not result.tangential.traction.any()


def test_a_run_that_is_cut_short_says_so():
    punch, body = rough((32, 32), 6), ElasticBody(0.0, None)
    result = press(punch, body, 0.2, 0.1, options=Options("frictional_newton", max_iterations=1))
    assert result.status[0] == Status.steps_used_up
    assert 1e-8 < result.residual[0] < np.inf


def test_a_guess_that_goes_to_and_fro_ends():
    """Five nodes on a half-space, all of which slip: nothing holds the body."""
    punch, body = rough((16, 16), 18, waves=3.4), ElasticBody(0.1, None)
    found = press(punch, body, 1.5e-3, 0.02)
    assert found.status[0] == Status.ok
    assert largest_violation(body.response((16, 16)), punch, 1.5e-3, 0.02, found) < 2e-8


@pytest.mark.parametrize("solver", ["frictional_newton", "verlet"])
def test_under_an_infinite_friction_no_node_slips(solver):
    punch, body = rough((16, 16), 1), ElasticBody(0.0, None)
    found = press(
        punch, body, 0.1, np.inf, options=Options(solver, max_iterations=100 if solver != "verlet" else 20000)
    )
    assert found.status[0] == Status.ok
    assert not found.tangential.slip.any()
    assert abs(found.tangential.traction[0][:, found.touching[0]]).max() > 0.1 * found.pressure.max()


def test_a_frictionless_map_is_the_same_to_every_solver_of_friction():
    punch, stiffness = rough((24, 32), 8), ElasticBody(0.3, 0.4).condensed_stiffness(grid.magnitudes((24, 32)))
    found = {
        name: equilibrate(punch, SpectralResponse.of_normal(stiffness), 0.05, Options(name))
        for name in ("conjugate_gradients", "verlet")
    }
    found["coupled"] = press(punch, ElasticBody(0.3, 0.4), 0.05, 1e-12)
    expected = found.pop("conjugate_gradients")
    for each in found.values():
        assert each.status[0] == Status.ok
        np.testing.assert_array_equal(each.touching, expected.touching)
        np.testing.assert_allclose(each.pressure, expected.pressure, atol=1e-7 * expected.pressure.max())


def test_a_time_step_beyond_the_limit_is_unstable_and_names_a_wave():
    punch, body = rough((16, 20), 2), ElasticBody(0.2, 0.5)
    found = press(punch, body, 0.1, 0.3, options=Options("verlet", time_step=1.5))
    assert found.status[0] == Status.unstable
    assert found.growing_wave[0] > 0


def test_an_incompressible_slab_has_no_room_below_the_mean_of_the_punch():
    punch = rough((16, 16), 2)
    for options in (NEWTON, Options("frictional_newton")):  # the dynamics knows no rigid mean, and is not begun
        result = press(punch - 1.01 * punch.mean(), ElasticBody(0.5, 0.5), None, 0.3, options=options)
        assert result.status[0] == Status.no_equilibrium
        assert result.n_iterations[0] <= 100
