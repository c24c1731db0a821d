"""The truncated Newton method: its energy never rises, its equilibria are those of the dynamics and of plain checks."""

import numpy as np
import pytest
import slab_stiffness

from gfmd_numba import kernels
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.equilibrium import begin, equilibrate, following
from gfmd_numba.solvers.iteration import Batch, Start
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from support.kernel_twins import both
from support.laws import surface

ATTRACTION = Interactions(True, ExponentialLaw(2e-3, 1e-2))
REPULSION = Interactions(False, ExponentialLaw(-2e-3, 1e-2))
WITH_A_WALL = Interactions(True, ExponentialLaw(-2e-4, 1e-2))
WALL = Interactions(True)
LAWS = pytest.mark.parametrize(
    "interface", [ATTRACTION, REPULSION, WITH_A_WALL, WALL], ids=["attraction", "repulsion", "both", "wall"]
)


def energy(u, punch, body, load, law):
    """Mean energy per area of body, law and load, from Fourier coefficients."""
    waves = grid.coefficients(u)
    elastic = 0.5 * (grid.multiplicity(len(u)) * body * np.abs(waves) ** 2).sum()
    return elastic - load * u.mean() + (0.0 if law is None else law.energy(punch - u).mean())


def violation(found, punch, body, load, interface):
    """Largest violated condition of equilibrium over the largest traction, of each row, from plain NumPy."""
    u = found.displacement
    law = np.zeros_like(u) if interface.normal_law is None else interface.normal_law.traction(punch - u)
    free = load - grid.signal(body * grid.coefficients(u), u.shape[1]) + law  # what the wall has to bear
    touching = (u >= punch) & interface.hard_wall
    worst = np.where(touching, np.maximum(-free, 0.0), np.abs(free)).max(axis=1)
    if interface.hard_wall:
        worst = np.maximum(worst, 1e300 * (u > punch).any(axis=1))
    return worst / np.maximum(free.max(axis=1), np.abs(law).max(axis=1))


@LAWS
@pytest.mark.parametrize("load", [0.05, None], ids=["load", "displacement"])
def test_the_energy_never_rises_and_ends_in_equilibrium(interface, load):
    punch, body = surface(256)
    if load is None:
        body, punch = slab_stiffness.slab(grid.wavenumbers(256), 0.3, 0.5), punch - 0.02
    loads = np.full(3, load or 0.0)
    batch = Batch(
        punch, SpectralResponse.of_normal(body), None if load is None else loads, interface, Start.at_rest(punch)
    )
    solver = begin(batch, Options("truncated_newton"))
    energies = []
    rows = np.arange(3)
    for _ in range(60):
        u = solver.state.u[:, 0, :256]
        energies.append([energy(u[i], punch[i], body, loads[i], interface.normal_law) for i in rows])
        if (solver.residual(rows) <= 1e-8).all():
            break
        solver.advance(rows)
    rise = np.diff(energies, axis=0)
    assert (rise <= 1e-13 * np.abs(energies).max(axis=0)).all()
    assert len(rise) > 3
    found = equilibrate(punch, SpectralResponse.of_normal(body), load, Options("truncated_newton"), interface)
    assert (found.status == 0).all()
    assert (violation(found, punch, body, load or 0.0, interface) <= 1e-8).all()


@pytest.mark.parametrize("interface", [REPULSION, WITH_A_WALL, WALL], ids=["repulsion", "both", "wall"])
@pytest.mark.parametrize("load", [1e-3, pytest.param(1.0, marks=pytest.mark.long)])
def test_the_one_equilibrium_of_a_convex_energy_is_that_of_the_dynamics(interface, load):
    punch, body = surface(128)
    newton, verlet = (
        equilibrate(punch, SpectralResponse.of_normal(body), load, Options(solver, residual=1e-10), interface)
        for solver in ("truncated_newton", "verlet")
    )
    assert (newton.status == 0).all()
    np.testing.assert_allclose(newton.pressure, verlet.pressure, rtol=0, atol=1e-6 * verlet.pressure.max())
    assert (2 * newton.n_transforms < verlet.n_transforms).all()


def wave(n, amplitude=0.1):
    return amplitude * (1.0 - np.cos(2.0 * np.pi * np.arange(n) / n))[np.newaxis]


def retraction(solver, n, law, step, last, residual=1e-8):
    """Equilibria of a wave on a slab of height L_x, drawn back from first touch."""
    body = slab_stiffness.slab(grid.wavenumbers(n), 0.3, 1.0)
    found = []
    for displacement in np.arange(0.0, last, -step):
        punch = wave(n) - displacement
        start = following(found[-1], punch, 0.0) if found else None
        found.append(
            equilibrate(
                punch, SpectralResponse.of_normal(body), None, Options(solver, residual), Interactions(True, law), start
            )
        )
    return found


@pytest.mark.long
def test_a_resolved_branch_is_that_of_the_dynamics_for_an_eighth_of_the_transforms():
    """Up to the jump: x = 0.08, where no node snaps on its own."""
    law = ExponentialLaw(6e-3, 4.83e-3 * np.sqrt(2.0))
    newton, verlet = (retraction(solver, 1024, law, 8e-3, -0.066, 1e-10) for solver in ("truncated_newton", "verlet"))
    assert all(each.status[0] == 0 for each in newton + verlet)
    peak = max(each.pressure.max() for each in verlet)
    for one, other in zip(newton, verlet, strict=True):
        np.testing.assert_allclose(one.pressure, other.pressure, rtol=0, atol=1e-6 * peak)
    spent, before = (sum(each.n_transforms[0] for each in path) for path in (newton, verlet))
    assert 8 * spent < before


def test_a_fold_is_passed_downhill_and_the_surfaces_part():
    found = retraction("truncated_newton", 256, ExponentialLaw(6e-3, 1e-2), 4e-3, -0.1)
    assert all(each.status[0] == 0 for each in found)
    tension = [-each.pressure.mean() for each in found]
    assert found[0].touching.any()
    assert not found[-1].touching.any()
    assert tension[-1] < 1e-3 * max(tension)


@pytest.mark.parametrize("ranges", [200.0, 360.0, 1e4])
def test_surfaces_far_beyond_the_range_of_a_law_are_in_equilibrium_apart(ranges):
    """Beyond some 350 ranges the squares of the tractions underflow; the body springs back all the same."""
    law = ExponentialLaw(1e-5, 1e-3)
    heights = self_affine.SelfAffineWaves(0.8, 2, 32).heights((128,), 4, range(1))
    punch = heights.max() - heights
    slab = slab_stiffness.slab(grid.wavenumbers(128), 0.3, 1.0)
    options, laws = Options("truncated_newton", max_iterations=500), Interactions(True, law)
    before = equilibrate(punch - 0.05, SpectralResponse.of_normal(slab), None, options, laws)
    wall = punch + 1e-3 * ranges
    apart = equilibrate(wall, SpectralResponse.of_normal(slab), None, options, laws, following(before, wall, 0.0))
    assert apart.status[0] == Status.ok
    assert abs(apart.displacement).max() < 1e-80
    assert apart.n_transforms[0] < 6 * 138  # decades down to tractions that are none


def test_a_first_load_ends_on_the_branch_of_many_small_ones_and_of_the_dynamics():
    heights = self_affine.SelfAffineWaves(0.8, 2, 32).heights((512,), 4, range(2))
    punch, body = heights.max(axis=1, keepdims=True) - heights, stiffness.half_space(grid.wavenumbers(512))
    law = Interactions(True, ExponentialLaw(0.1 * np.pi * 256 * 3e-3**2, 3e-3))
    at_once, dynamics = (
        equilibrate(punch, SpectralResponse.of_normal(body), 0.01, Options(solver), law)
        for solver in ("truncated_newton", "verlet")
    )
    start = None
    for load in np.geomspace(1e-4, 0.01, 12):
        found = equilibrate(punch, SpectralResponse.of_normal(body), load, Options("truncated_newton"), law, start)
        start = following(found, punch, 0.0)
    for other in (dynamics, found):
        assert (other.status == 0).all()
        np.testing.assert_allclose(at_once.pressure, other.pressure, rtol=0, atol=1e-6 * other.pressure.max())


@pytest.mark.long
def test_a_map_at_rest_begins_on_coarser_grids_and_ends_on_the_branch_of_a_path():
    """Where the law is resolved, x = 0.2: a start says that there is a path, and takes no coarser grid."""
    waves = RandomSurface(SelfAffineWaves(0.8, 5, 16), 128, 2024, dimension=2)
    heights = waves.heights(range(2))
    punch = heights.max(axis=(1, 2), keepdims=True) - heights
    body = SpectralResponse.of_normal(stiffness.half_space(grid.magnitudes((128, 128))))
    options, laws = Options("truncated_newton"), Interactions(True, ExponentialLaw(2e-5, 6.6e-4))
    coarse = equilibrate(punch, body, 0.02, options, laws)
    path = [equilibrate(punch, body, 0.004, options, laws, Start.at_rest(punch))]
    for load in (0.009, 0.02):
        path.append(equilibrate(punch, body, load, options, laws, following(path[-1], punch, 0.0)))
    assert (coarse.status == Status.ok).all()
    np.testing.assert_array_equal(coarse.touching, path[-1].touching)
    np.testing.assert_allclose(coarse.pressure, path[-1].pressure, rtol=0, atol=1e-6 * coarse.pressure.max())
    at_rest = equilibrate(punch, body, 0.02, options, laws, Start.at_rest(punch))
    assert (coarse.n_transforms < 0.9 * at_rest.n_transforms).all()


def test_a_start_in_which_the_law_repels_beyond_all_measure_is_moved_back():
    punch, body = surface(128)
    start = Start(punch + 20.0, punch[:, np.newaxis])
    found = equilibrate(punch, SpectralResponse.of_normal(body), 0.05, Options("truncated_newton"), REPULSION, start)
    assert (found.status == 0).all()


@pytest.mark.parametrize("kernel", both(kernels.descent_start))
def test_nodes_that_press_against_the_wall_are_held(kernel):
    u, wall = np.array([0.0, 0.0, -1.0, -1.0]), np.zeros(4)
    restoring, (weight, d, kd, r) = np.array([1.0, 3.0, 1.0, 3.0]), np.full((4, 4), np.nan)
    kernel(kernels.Unknowns(u, restoring, wall, np.full(4, 2.0)), weight, kernels.Descent(d, kd, r))
    np.testing.assert_allclose(weight, [0.0, 1.0, 1.0, 1.0])
    np.testing.assert_allclose(r, [0.0, -1.0, 1.0, -1.0])
    assert not d.any()
    assert not kd.any()


def draws(count, n=7):
    return np.random.default_rng(5).normal(size=(count, n))


@pytest.mark.parametrize("kernel", both(kernels.descent_norm))
def test_held_nodes_do_not_move(kernel):
    r, compliant = draws(2)
    weight = np.array([0.0, 1.0, 0.5, 1.0, 1.0, 0.0, 1.0])
    expected = np.where(weight > 0.0, compliant, 0.0)
    assert kernel(r, weight, compliant) == pytest.approx(r @ expected)
    np.testing.assert_allclose(compliant, expected)


@pytest.mark.parametrize("kernel", both(kernels.descent_direction))
def test_the_direction_keeps_a_share(kernel):
    compliant, p, source = draws(3)
    expected = compliant + 0.3 * p
    kernel(compliant, 0.3, p, source)
    np.testing.assert_allclose(p, expected)
    np.testing.assert_allclose(source, expected)


@pytest.mark.parametrize("kernel", both(kernels.descent_curvature))
def test_the_curvature_is_that_of_body_and_law(kernel):
    p, kp, curvature, pulled = draws(4)
    np.testing.assert_allclose(kernel(p, kp, curvature, pulled), (p @ kp + p @ (curvature * p), p @ kp))
    np.testing.assert_allclose(pulled, curvature * p)


@pytest.mark.parametrize("kernel", both(kernels.descent_update))
def test_an_update_leaves_held_nodes_balanced(kernel):
    p, kp, pulled, d, kd, r = draws(6)
    weight = np.array([0.0, 1.0, 0.5, 1.0, 1.0, 0.0, 1.0])
    left = np.where(weight > 0.0, r - 0.2 * (kp + pulled), r)
    expected = d + 0.2 * p, kd + 0.2 * kp, left
    largest = kernel(p, kp, pulled, weight, 0.2, kernels.Descent(d, kd, r))
    assert largest == abs(left[weight > 0.0]).max()
    np.testing.assert_allclose((d, kd, r), expected)


@pytest.mark.parametrize("kernel", both(kernels.descent_trial))
def test_a_trial_stops_at_the_wall(kernel):
    u, wall, d = draws(3)
    source = np.empty(7)
    assert kernel(u, wall, d, 0.7, source)
    np.testing.assert_allclose(source, np.minimum(u + 0.7 * d, wall))
    assert not kernel(u, wall + 10.0, d, 0.7, source)


@pytest.mark.parametrize("kernel", both(kernels.descent_work))
def test_the_work_is_the_change_of_the_quadratic_energy(kernel):
    u, trial, restoring, closing, load = draws(5)
    matrix = np.random.default_rng(1).normal(size=(7, 7))
    matrix = matrix @ matrix.T
    work, slope, size = kernel(u, trial, matrix @ u, matrix @ trial, restoring, load, closing)
    np.testing.assert_allclose(closing, trial - u)
    quadratic = [0.5 * each @ matrix @ each - load @ each for each in (u, trial)]
    assert work == pytest.approx(quadratic[1] - quadratic[0])
    assert slope == pytest.approx((trial - u) @ (restoring - load))
    assert size == pytest.approx(abs((trial - u) * (0.5 * matrix @ (u + trial) - load)).sum())
