"""A wall of finite hardness: dense solutions, conditions in plain NumPy, limits, and convergence up to 0.95 of it."""

from dataclasses import replace

import numpy as np
import pytest
import slab_stiffness
from scipy.optimize import brentq, lsq_linear

from gfmd_numba import kernels
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.certificate import Certificate
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options
from support.cases import some_of

SOLVERS = ("active_set_newton", "conjugate_gradients")


def body(shape, slab=None):
    q = grid.magnitudes(shape)
    return stiffness.half_space(q) if slab is None else slab_stiffness.slab(q, *slab)


def press(punch, load, hardness, solver="active_set_newton", slab=None, **options):
    wall = Interactions(hard_wall=True, hardness=hardness)
    return equilibrate(
        punch, SpectralResponse.of_normal(body(punch.shape[1:], slab)), load, Options(solver, **options), wall
    )


def rough(shape, hurst=0.8, seed=1, realisations=range(2)):
    heights = self_affine.SelfAffineWaves(hurst, 2, shape[0] // 4).heights(shape, seed, realisations)
    return heights.max(axis=tuple(range(1, heights.ndim)), keepdims=True) - heights


def excess(punch, found, hardness, load, slab=None):
    """Traction that no pressure allowed by gap and bounds balances, over the largest pressure, in plain NumPy."""
    symbol = body(punch.shape[1:], slab).copy()
    if load is not None:
        symbol.flat[0] = 0.0
    axes = tuple(range(1, punch.ndim))
    u, gap = found.displacement, punch - found.displacement
    restoring = np.fft.irfftn(np.fft.rfftn(u, axes=axes) * symbol, punch.shape[1:], axes=axes)
    traction = (load or 0.0) - restoring
    allowed = np.where(gap > 0.0, 0.0, np.where(gap < 0.0, hardness, np.clip(traction, 0.0, hardness)))
    peak = allowed.max(axis=axes)
    worst = abs(traction - allowed).max(axis=axes) / peak
    if load is None:
        return worst, allowed
    return np.maximum(worst, abs((traction - allowed).mean(axis=axes)) / load), allowed


def assert_certified(punch, found, hardness, load, slab=None):
    assert (found.status == Status.ok).all(), found.residual
    assert found.pressure.min() >= 0.0
    assert found.pressure.max() <= hardness
    gap = punch - found.displacement
    free = found.touching & ~found.plastic
    assert (gap[~found.touching] >= 0.0).all()
    assert (gap[free] == 0.0).all()
    assert (gap[found.plastic] <= 0.0).all()
    assert (found.pressure[found.plastic] == hardness).all()
    assert (found.pressure[~found.touching] == 0.0).all()
    residual, pressure = excess(punch, found, hardness, load, slab)
    np.testing.assert_allclose(residual, found.residual, rtol=0.1, atol=3e-10)
    np.testing.assert_allclose(pressure, found.pressure, atol=1e-9 * hardness)


def dense(punch, load, hardness, slab=None):
    """Pressure of a profile by bounded least squares with the whole compliance matrix, and the approach."""
    n = punch.size
    symbol = body((n,), slab)
    with np.errstate(divide="ignore"):
        compliance = np.where(symbol > 0.0, 1.0 / symbol, 1.0)  # under a load a uniform displacement does not matter
    matrix = np.fft.irfft(compliance, n)[(np.arange(n)[:, None] - np.arange(n)) % n]
    root = np.linalg.cholesky(matrix).T

    def pressure(approach):
        right = -np.linalg.solve(root.T, punch - approach)
        return lsq_linear(root, right, (0.0, hardness), method="bvls", tol=1e-15, max_iter=10 * n).x

    if load is None:
        return pressure(0.0)
    reach = np.ptp(punch) + abs(compliance).sum() * hardness
    approach = brentq(lambda a: pressure(a).mean() - load, -reach, reach, xtol=1e-15, rtol=1e-14)
    return pressure(approach)


def assert_same_nodes(found, expected, hardness):
    near = 1e-6 * hardness
    np.testing.assert_array_equal(found.plastic[0], expected > hardness - near)
    np.testing.assert_array_equal(found.touching[0], expected > near)
    np.testing.assert_allclose(found.pressure[0], expected, atol=1e-5 * hardness)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(("share", "hardness"), some_of([(0.1, 1.0), (0.5, 0.2), (0.95, 0.02)], 1))
def test_nodes_are_those_of_bounded_least_squares_under_a_load(solver, share, hardness):
    punch = rough((64,), realisations=range(1))
    found = press(punch, share * hardness, hardness, solver)
    assert_certified(punch, found, hardness, share * hardness)
    assert_same_nodes(found, dense(punch[0], share * hardness, hardness), hardness)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("slab", [(0.3, 1.0), (0.49, 0.05)])
@pytest.mark.parametrize("depth", [0.2, 1.5])
@pytest.mark.parametrize("hardness", [0.05, 0.3])
def test_nodes_are_those_of_bounded_least_squares_under_a_displacement(solver, slab, depth, hardness):
    punch = rough((64,), realisations=range(1))
    punch -= depth * punch.mean()
    found = press(punch, None, hardness, solver, slab)
    assert_certified(punch, found, hardness, None, slab)
    assert_same_nodes(found, dense(punch[0], None, hardness, slab), hardness)


@pytest.mark.parametrize("share", [0.3, 0.7, 0.9])
def test_a_sinusoid_flattens_as_bounded_least_squares_say(share):
    """Westergaard's contact, whose peak pressure (4 p p_full)^(1/2) the hardness cuts off."""
    n, full = 64, 1.0
    punch = full / np.pi * (1.0 - np.cos(2.0 * np.pi * (np.arange(n) + 0.3) / n))[np.newaxis]
    load = 0.2
    hardness = share * 2.0 * np.sqrt(load * full)
    found = press(punch, load, hardness)
    assert found.plastic.any()
    assert_same_nodes(found, dense(punch[0], load, hardness), hardness)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("shape", [(512,), (33, 33)])
@pytest.mark.parametrize("hardness", [0.003, pytest.param(0.6, marks=pytest.mark.long)])
def test_conditions_hold_with_both_bounds(solver, shape, hardness):
    punch = rough(shape)
    for share in (0.02, 0.5, 0.95):
        assert_certified(punch, press(punch, share * hardness, hardness, solver), hardness, share * hardness)


@pytest.mark.parametrize("solver", SOLVERS)
def test_conditions_hold_under_an_incompressible_slab(solver):
    punch = rough((256,))
    punch -= 0.8 * punch.mean(axis=1, keepdims=True)
    found = press(punch, None, 0.2, solver, (0.5, 0.1))
    assert (found.status == Status.ok).all()
    assert found.plastic.any()
    assert found.pressure.max() == 0.2


def test_the_residual_is_the_violation_of_each_condition():
    """Nodes moved by hand to where each condition in turn is broken."""
    punch = rough((64,), realisations=range(1))
    found = press(punch, 0.15, 0.3)
    kinds = {"open": ~found.touching, "free": found.touching & ~found.plastic, "plastic": found.plastic}
    for nodes in kinds.values():
        assert nodes.any()

    load, row = np.array([0.15]), np.arange(1)
    stiff = body((64,)).copy()
    stiff[0] = 0.0

    def residual(u):
        certificate = Certificate(1, kernels.ContactLimits(hardness=0.3))
        certificate.look(kernels.SurfaceState.of_normal(u, np.fft.irfft(np.fft.rfft(u) * stiff), punch, load), row, 64)
        return certificate.residual(load, row)[0]

    assert residual(found.displacement) < 1e-7
    for nodes in kinds.values():
        for by in (1e-3, -1e-3):
            moved = found.displacement.copy()
            moved[0, np.flatnonzero(nodes[0])[0]] += by
            expected, _ = excess(punch, replace(found, displacement=moved), 0.3, 0.15)
            assert residual(moved) == pytest.approx(expected[0], rel=1e-9)
            assert expected[0] > 1e-3


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("shape", [(300,), (64, 64)])
@pytest.mark.parametrize("above", [1.0, 1.0 + 1e-12, 1e30])
def test_a_hardness_above_the_elastic_pressure_changes_no_bit(solver, shape, above):
    punch = rough(shape, realisations=range(1))
    elastic = press(punch, 0.05, None, solver)
    hard = press(punch, 0.05, above * float(elastic.pressure.max()), solver)
    assert elastic.plastic is None
    assert not (hard.plastic.any() if above > 1.0 else hard.plastic.sum() > 1)
    for name in ("displacement", "pressure", "touching", "residual", "n_iterations", "n_transforms"):
        np.testing.assert_array_equal(getattr(elastic, name), getattr(hard, name), name)


def test_realisations_that_yield_leave_the_others_as_they_are():
    punch = rough((256,), realisations=range(6))
    elastic = press(punch, 0.05, None)
    peaks = elastic.pressure.max(axis=1)
    hardness = float(np.median(peaks))
    found = press(punch, 0.05, hardness)
    stays = peaks < hardness
    assert 0 < stays.sum() < 6
    np.testing.assert_array_equal(found.pressure[stays], elastic.pressure[stays])
    np.testing.assert_array_equal(found.plastic.any(axis=1), ~stays)
    for i in range(6):
        np.testing.assert_array_equal(press(punch[i : i + 1], 0.05, hardness).pressure[0], found.pressure[i])


@pytest.mark.parametrize("shape", [(2048,), (64, 64)])
@pytest.mark.parametrize("share", [0.1, 0.4, 0.9])
def test_contacts_far_too_soft_to_deform_the_body_are_the_load_over_the_hardness(shape, share):
    hardness = 1e-5
    punch = rough(shape)
    found = press(punch, share * hardness, hardness)
    assert (found.status == Status.ok).all()
    nodes = punch[0].size
    for wall, plastic in zip(punch, found.plastic, strict=True):
        assert abs(plastic.sum() - share * nodes) <= 2
        assert np.sort(wall[plastic])[-2] <= np.sort(wall[~plastic])[1]  # the nodes that the punch has lowest


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_load_beyond_the_hardness_is_refused(solver):
    with pytest.raises(ValueError, match=r"at or above the 0\.3 that the hardness bears"):
        press(rough((64,)), 0.3, 0.3, solver)


def test_solvers_without_a_second_bound_refuse_it():
    for solver in ("verlet", "gronbech_jensen", "fire"):
        with pytest.raises(ValueError, match="knows no hardness"):
            equilibrate(
                rough((64,)),
                SpectralResponse.of_normal(body((64,))),
                0.1,
                Options(solver),
                Interactions(True, hardness=0.2),
            )


@pytest.mark.parametrize(("hurst", "hardness"), [(0.3, 1e-3), (0.8, 0.1), (0.3, 1.0)])
def test_profiles_converge_up_to_0_95_of_the_hardness(hurst, hardness):
    punch = rough((2**13,), hurst, realisations=range(1))
    for share in (0.01, 0.95):
        found = press(punch, share * hardness, hardness)
        assert found.status[0] == Status.ok
        assert found.residual[0] <= 1e-8
        assert found.n_transforms[0] < 3000


@pytest.mark.long
@pytest.mark.parametrize(("hurst", "hardness"), [(0.8, 1e-3), (0.3, 0.3)])
@pytest.mark.parametrize("shape", [(2**16,), (256, 256)])
def test_large_grids_converge_up_to_0_95_of_the_hardness(hurst, hardness, shape):
    punch = rough(shape, hurst, realisations=range(1))
    for share in (0.07, 0.95):
        found = press(punch, share * hardness, hardness)
        assert found.status[0] == Status.ok
        assert found.residual[0] <= 1e-8
        assert found.pressure.max() <= hardness
