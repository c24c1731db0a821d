"""Newton's method for friction with a law of the gap: the conditions hold, and other solvers find the same."""

from dataclasses import replace

import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import begin, equilibrate, following
from gfmd_numba.solvers.exponential_sums.exponential_sum import ExponentialSum
from gfmd_numba.solvers.iteration import Batch, Start
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from support.cases import some_of
from support.contact_conditions import largest_violation, sticking

NEWTON = Options("frictional_newton", max_iterations=100)  # and no other solver after it
ATTRACTION, REPULSION = ExponentialLaw(2e-4, 2e-3), ExponentialLaw(-2e-4, 2e-3)


def rough(nx, seed, hurst=0.8, waves=32, rows=1):
    heights = self_affine.SelfAffineWaves(hurst, 2, waves).heights((nx,), seed, range(rows))
    return heights.max(axis=1, keepdims=True) - heights


def press(punch, stiffness, load, friction, law, start=None, sliding=0.0, options=NEWTON):
    laws = Interactions(True, normal_law=law, friction=friction)
    return equilibrate(punch, stiffness, load, options, laws, start, sliding)


def random_path(seed):
    """Stiffness, friction, law and steps (punch, load, sliding) of a random scene; each sixth one sticks."""
    rng = np.random.default_rng(seed)
    nx = int(rng.choice([128, 255, 512]))
    nu = float(rng.choice([rng.uniform(-0.5, 0.5), 0.0, 0.3, 0.5]))
    aspect_ratio = rng.choice([None, 10 ** rng.uniform(-1.5, 0.5)])
    friction, load = 10 ** rng.uniform(-2.0, 0.0) if seed % 6 else np.inf, 10 ** rng.uniform(-3.0, 0.0)
    reach = 10 ** rng.uniform(-3.0, -1.0)
    work = 10 ** rng.uniform(-2.0, -0.3) * 0.5 * np.pi * nx * reach**2
    law = ExponentialLaw(float(work if rng.random() < 0.6 else -(10 ** rng.uniform(-4.0, 0.0)) * reach), float(reach))
    punch = rough(nx, seed, rng.uniform(0.1, 1.0), int(rng.integers(4, nx // 4)))
    deep = rng.uniform(0.1, 0.5) * punch.mean()
    controls_load = aspect_ratio is None or rng.random() < 0.5
    sliding, steps = 0.0, []
    for _ in range(3):
        steps.append((punch, load, sliding) if controls_load else (punch - deep, None, sliding))
        factor = 10 ** rng.uniform(-0.5, 0.2)
        load, deep = load * factor, min(deep * factor, 0.6 * punch.mean())
        if aspect_ratio is not None:
            sliding += rng.normal() * min(friction, 1.0) * min(aspect_ratio, 1.0) * 10 ** rng.uniform(-3.0, -0.5)
    return ElasticBody(nu, aspect_ratio).response((nx,)), friction, law, steps


@pytest.mark.parametrize("seed", some_of(range(0, 24, 4), 0, 3, 5))
def test_every_step_of_a_random_path_holds_the_conditions_with_a_law(seed):
    stiffness, friction, law, steps = random_path(seed)
    before = None
    for punch, load, sliding in steps:
        start = None if before is None else following(before, punch, sliding)
        before = press(punch, stiffness, load, friction, law, start, sliding)
        assert before.status[0] == Status.ok
        assert largest_violation(stiffness, punch, load, friction, before, start, law=law) < 2e-8


@pytest.mark.parametrize(
    ("nu", "friction", "law"),
    [(0.0, 0.2, ATTRACTION), (0.3, 0.7, ATTRACTION), (0.3, 0.2, REPULSION), (0.5, 0.7, REPULSION)],
)
def test_the_dynamics_with_a_law_has_the_same_nodes_sticking_and_slipping(nu, friction, law):
    nx, load = 256, 0.1
    punch, stiffness = rough(nx, 3), ElasticBody(nu, 0.5).response((nx,))
    at_rest, row, laws = Start.at_rest(punch), np.arange(1), Interactions(True, normal_law=law, friction=friction)
    batch = Batch(punch, stiffness.with_mean(0.0), np.array([load]), laws, at_rest, 0.0, 10.0)
    dynamics = begin(batch, Options("verlet"))
    while dynamics.residual(row)[0] > 1e-10:
        for _ in range(20):
            dynamics.advance(row)
    (tangential, normal), (shear, restoring) = (each[0, :, :nx] for each in dynamics.state[:2])
    start = replace(at_rest, displacement=normal[np.newaxis].copy())  # on the same branch
    options = Options("frictional_newton", residual=1e-10, max_iterations=100)
    found = press(punch, stiffness, load, friction, law, start, options=options)
    assert found.status[0] == Status.ok
    touching = (normal >= punch[0]) & (restoring < load)
    np.testing.assert_array_equal(found.touching[0], touching)
    np.testing.assert_array_equal(sticking(found, start), touching & (tangential == 0.0))
    peak = found.pressure.max()
    np.testing.assert_allclose(found.tangential.traction[0, 0], shear, atol=1e-8 * peak)
    np.testing.assert_allclose(found.displacement[0], normal, atol=1e-8 * np.ptp(punch))


def test_a_law_without_strength_leaves_friction_as_it_is_alone():
    punch, stiffness, friction = rough(512, 4), ElasticBody(0.2, 0.4).response((512,)), 0.3
    faint = ExponentialLaw(1e-14 * ATTRACTION.work, ATTRACTION.length)
    alone, together = None, None
    for load, sliding in ((0.1, 0.0), (0.05, 2e-3)):
        first, second = (None if each is None else following(each, punch, sliding) for each in (alone, together))
        alone = press(punch, stiffness, load, friction, None, first, sliding)
        together = press(punch, stiffness, load, friction, faint, second, sliding)
        peak = alone.pressure.max()
        np.testing.assert_allclose(together.pressure, alone.pressure, atol=2e-8 * peak)
        np.testing.assert_allclose(together.tangential.traction, alone.tangential.traction, atol=2e-8 * peak)
        np.testing.assert_array_equal(together.touching, alone.touching)


@pytest.mark.parametrize(("law", "friction"), [(ATTRACTION, np.inf), (REPULSION, 0.3)])
def test_friction_leaves_the_pressure_of_a_law_on_an_incompressible_half_space(law, friction):
    """Shear does not lift its surface, so that Newton's method without friction finds the pressure."""
    punch, stiffness = rough(512, 5), ElasticBody(0.5, None).response((512,))
    rubbed = press(punch, stiffness, 0.1, friction, law)
    laws = Interactions(True, normal_law=law)
    smooth = equilibrate(punch, stiffness.condensed(), 0.1, Options("truncated_newton"), laws)
    peak = rubbed.pressure.max()
    np.testing.assert_allclose(rubbed.pressure, smooth.pressure, atol=3e-8 * peak)
    np.testing.assert_array_equal(rubbed.touching, smooth.touching)


def test_a_rigid_mean_with_a_law_is_the_limit_of_one_that_is_nearly_rigid():
    punch, friction, found = rough(256, 2), 0.3, []
    punch -= 0.4 * punch.mean()
    for nu in (0.5, 0.5 - 1e-9):
        stiffness, before = ElasticBody(nu, 0.3).response((256,)), None
        for sliding in (0.0, 5e-3):
            start = None if before is None else following(before, punch, sliding)
            before = press(punch, stiffness, None, friction, ATTRACTION, start, sliding)
            assert before.status[0] == Status.ok
        found.append(before)
    rigid, nearly = found
    assert abs(rigid.tangential.traction).max() > 0.01 * rigid.pressure.max()
    np.testing.assert_allclose(rigid.pressure, nearly.pressure, atol=1e-5 * rigid.pressure.max())
    np.testing.assert_allclose(rigid.tangential.traction, nearly.tangential.traction, atol=1e-5 * rigid.pressure.max())


def test_ridges_with_a_law_are_profiles():
    n, across, body, friction, law = 64, 6, ElasticBody(0.2, 0.3), 0.3, ATTRACTION
    punch = rough(n, 3, waves=16)
    ridges, stiffness = np.repeat(punch[:, np.newaxis], across, axis=1), body.response((across, n))
    of_map, of_profile = None, None
    for drag in (0.0, 5e-3):
        sliding = np.reshape((drag, 0.0), (2, 1, 1))
        first = None if of_map is None else following(of_map, ridges, sliding)
        second = None if of_profile is None else following(of_profile, punch, drag)
        of_map = press(ridges, stiffness, 0.1, friction, law, first, sliding)
        of_profile = press(punch, body.response((n,)), 0.1, friction, law, second, drag)
        assert of_map.status[0] == of_profile.status[0] == Status.ok
        peak, own = of_profile.pressure.max(), of_map.tangential.traction[0]
        np.testing.assert_allclose(of_map.pressure[0], np.tile(of_profile.pressure, (across, 1)), atol=5e-8 * peak)
        np.testing.assert_allclose(own[0], np.tile(of_profile.tangential.traction[0], (across, 1)), atol=5e-8 * peak)
        assert abs(own[1]).max() < 5e-8 * peak


def test_one_more_load_with_a_law_takes_less_than_a_quarter_of_the_transforms_of_the_dynamics():
    nx, rows, law = 1024, 1, ExponentialLaw(2e-5, 3e-4)
    punch, stiffness = rough(nx, 7, 0.8, 128, rows), ElasticBody(0.3, None).response((nx,))
    first = press(punch, stiffness, 0.05, 0.3, law)
    start = following(first, punch, 0.0)
    found = press(punch, stiffness, 0.06, 0.3, law, start)
    assert (found.status == Status.ok).all()
    damped = press(punch, stiffness, 0.06, 0.3, law, start, options=Options("verlet"))
    assert damped.n_transforms[0] > 4 * found.n_transforms[0]


def test_friction_without_a_wall_is_refused():
    punch, stiffness = rough(64, 1, waves=8), ElasticBody(0.3, None).response((64,))
    batch = Batch(
        punch, stiffness.with_mean(0.0), np.array([0.1]), Interactions(False, normal_law=ATTRACTION, friction=0.3),
        Start.at_rest(punch), 0.0, 10.0,
    )  # fmt: skip
    with pytest.raises(ValueError, match="friction on a hard wall only"):
        begin(batch, NEWTON)


def test_nodes_may_have_a_compliance_of_their_own_of_either_sign():
    n, rng = 64, np.random.default_rng(1)
    compliance = np.concatenate(([0.3], 1.0 / np.arange(1.0, n // 2 + 1)))
    body = ExponentialSum(compliance, n)
    own = np.where(rng.random(n) < 0.3, 0.0, rng.choice([-1.0, 1.0], n) * 10 ** rng.uniform(0.0, 3.0, n))
    distance = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))[..., np.newaxis]
    rates, _, weights, white, _ = body.decays
    matrix = (weights * np.exp(-rates * distance)).sum(axis=-1) + np.diag(white + own)
    assert np.linalg.eigvalsh(matrix)[0] < 0.0 < np.linalg.eigvalsh(matrix)[-1]
    asked, found = rng.normal(size=n), np.empty(n)
    body.factor(np.arange(n), n, own)
    body.solve(asked, found)
    np.testing.assert_allclose(matrix @ found, asked, atol=1e-8)
