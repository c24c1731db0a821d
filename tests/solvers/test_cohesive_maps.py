"""Cohesive laws on maps: ridges are profiles, turned maps have turned answers, and one energy gives all tractions."""

import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.interface import vector_slip
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.interface.xu_needleman import XuNeedlemanLaw
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import begin, equilibrate, following
from gfmd_numba.solvers.iteration import Batch, Start
from gfmd_numba.solvers.table import Options
from gfmd_numba.solvers.truncated_newton import EnergyOfSlip
from support.frictional_maps import rough

LAW = XuNeedlemanLaw(2e-3, 2e-2, 4e-2)
LAYERS = ElasticBody.layered((0.05, 0.2), (Material(1.0, 0.2), Material(0.1, 0.4)), None)
EXACT = {name: Options(name, residual=1e-10) for name in ("truncated_newton", "verlet")}
WALL = pytest.mark.parametrize("hard_wall", [True, False], ids=["wall", "law alone"])


def press(punch, body, load, law, hard_wall=True, start=None, sliding=(0.0, 0.0), solver="truncated_newton"):
    laws, drag = Interactions(hard_wall, cohesive=law), np.reshape(sliding, (2, 1, 1))
    stiffness = body.response(punch.shape[1:])
    found = equilibrate(punch, stiffness, load, EXACT[solver], laws, start, drag)
    assert (found.status == 0).all()
    return found


@pytest.mark.parametrize(
    ("body", "load", "hard_wall", "solver", "along"),
    [
        (ElasticBody(0.3, None), 0.1, True, "truncated_newton", "x"),
        (ElasticBody(0.2, 0.3), 0.1, False, "truncated_newton", "y"),
        pytest.param(ElasticBody(0.2, 0.3), None, True, "verlet", "x", marks=pytest.mark.long),
        pytest.param(ElasticBody(0.5, 0.3), None, False, "truncated_newton", "x", marks=pytest.mark.long),
        (LAYERS, None, True, "truncated_newton", "y"),
        (LAYERS, 0.1, False, "verlet", "y"),
    ],
)
def test_ridges_are_profiles(body, load, hard_wall, solver, along):
    n, across = 64, 6
    heights = self_affine.SelfAffineWaves(0.8, 2, 16).heights((n,), 3, range(1))
    punch = heights.max() - heights - (0.02 if load is None else 0.0)
    ridges = np.repeat(punch[:, np.newaxis], across, axis=1)
    ridges = ridges if along == "x" else ridges.swapaxes(1, 2).copy()
    law, one, two = Interactions(hard_wall, cohesive=LAW), None, None
    for drag in (0.0,) if body.aspect_ratio is None else (0.0, 2e-2, 1.9e-2):
        start = None if one is None else following(one, punch, drag)
        one = equilibrate(punch, body.response((n,)), load, EXACT[solver], law, start, drag)
        way = (drag, 0.0) if along == "x" else (0.0, drag)
        start = None if two is None else following(two, ridges, np.reshape(way, (2, 1, 1)))
        two = press(ridges, body, load, LAW, hard_wall, start, way, solver)
        pressure, traction = two.pressure[0], two.tangential.traction[0]
        if along == "y":
            pressure, traction = pressure.T, traction[::-1].swapaxes(1, 2)
        scale = max(np.abs(one.pressure).max(), np.abs(one.tangential.traction).max())
        np.testing.assert_allclose(pressure, np.tile(one.pressure, (across, 1)), atol=1e-8 * scale)
        np.testing.assert_allclose(traction[0], np.tile(one.tangential.traction[0], (across, 1)), atol=1e-8 * scale)
        assert np.abs(traction[1]).max() < 1e-12 * scale
        assert np.abs(traction[0]).max() > 1e-3 * scale


@WALL
def test_a_turned_map_has_the_turned_answer(hard_wall):
    """Also where the grid has other numbers of nodes along x and y; dragged across its own axes."""
    punch, body, drag = 4.0 * rough((48, 64), 1, rows=2), ElasticBody(0.2, 0.3), (3e-2, -1e-2)
    turned = np.rot90(punch, axes=(2, 1)).copy()  # what lay along x now lies along y, what lay along y along -x
    found = press(punch, body, 0.1, LAW, hard_wall, sliding=drag)
    other = press(turned, body, 0.1, LAW, hard_wall, sliding=(-drag[1], drag[0]))
    peak = found.pressure.max()

    def turn(field):
        return np.rot90(field, axes=(2, 1))

    along, across = found.tangential.traction.swapaxes(0, 1)
    np.testing.assert_allclose(other.pressure, turn(found.pressure), atol=1e-8 * peak)
    np.testing.assert_allclose(other.tangential.traction[:, 1], turn(along), atol=1e-8 * peak)
    np.testing.assert_allclose(other.tangential.traction[:, 0], -turn(across), atol=1e-8 * peak)
    assert min(np.abs(along).max(), np.abs(across).max()) > 1e-2 * peak


def test_a_step_drags_each_node_by_half_a_tangential_length_at_most_where_the_law_acts():
    """Nodes: dragged far, dragged little, far away from the punch, and so far past the law that it no longer acts."""
    law, gap = EnergyOfSlip(LAW), LAW.normal * np.array([1.0, 1.0, 5.0, 1.0])
    slip = LAW.tangential * np.array([[0.0, 0.0, 0.0, 9.0], [0.0] * 4])
    way = LAW.tangential * np.array([[1.8, 0.3, 1.8, 1.8], [2.4, 0.4, 2.4, 2.4], [1.0] * 4])
    u = np.random.default_rng(0).normal(size=way.shape)
    trial = u + way
    assert law.shorten(lambda: (gap, slip), u, trial)
    kept = np.array([0.5 / 3.0, 1.0, 1.0, 1.0])
    np.testing.assert_allclose(trial - u, way * [kept, kept, np.ones(4)], atol=1e-15)
    assert not law.shorten(lambda: (gap, slip), u, u + 0.1 * way)


def test_the_curvature_along_a_direction_is_the_second_derivative_of_the_energy():
    rng, law = np.random.default_rng(0), EnergyOfSlip(LAW)
    gap, slip, moved = rng.uniform(0.01, 0.05, 12), rng.uniform(-0.04, 0.04, (2, 12)), rng.normal(size=(3, 12))
    curvature, pulled = np.zeros((2, 3, 12))
    law.fill_curvature(gap, slip, curvature)
    coupling = law.add_coupling(moved, pulled)
    way = 1e-5 * np.reshape((-1.0, 0.0, 1.0), (-1, 1))
    slipped = vector_slip.length(slip[:, np.newaxis] - way * moved[:2, np.newaxis])
    before, at, behind = LAW.energy(gap - way * moved[2], slipped).sum(axis=1)
    expected = (before - 2.0 * at + behind) / 1e-10
    assert (curvature * moved**2).sum() + coupling == pytest.approx(expected, rel=1e-5)
    assert (moved * pulled).sum() == pytest.approx(coupling)


def restored(u, stiffness):
    """Tractions `[component, y, x]` that restore displacements, by NumPy's transforms."""
    xx, xy, yy, xz, yz, zz = np.where(np.isfinite(stiffness.elements), stiffness.elements, 0.0)
    x, y, z = np.fft.rfft2(u)
    waves = (xx * x + xy * y + 1j * xz * z, xy * x + yy * y + 1j * yz * z, zz * z - 1j * (xz * x + yz * y))
    return np.fft.irfft2(np.stack(waves), u.shape[1:])


@WALL
@pytest.mark.parametrize("load", [0.05, None], ids=["load", "displacement"])
def test_the_energy_never_rises_and_its_slopes_balance(hard_wall, load):
    """The energy is summed from displacements and the law's own formula; at its end no node is out of balance."""
    punch = 4.0 * rough((32, 48), 1)
    punch -= 0.02 if load is None else 0.0
    body, drag = ElasticBody(0.2, 0.5).response((32, 48)), np.reshape((1e-2, 2e-2), (2, 1, 1))
    if load is not None:
        body = body.with_mean(0.0)
    loads, laws = None if load is None else np.array([load]), Interactions(hard_wall, cohesive=LAW)
    solver = begin(Batch(punch, body, loads, laws, Start.at_rest(punch), drag), EXACT["truncated_newton"])
    row, energies, n = np.zeros(1, dtype=np.int64), [], 32 * 48
    for _ in range(60):
        residual = solver.residual(row)
        u = solver.state.u[0, :, :n].reshape(3, 32, 48)
        force, gap, slip = restored(u, body), punch[0] - u[2], drag - u[:2]
        g, overlap = np.maximum(gap, 0.0) / 2e-2, np.minimum(gap, 0.0) / 2e-2
        decay = np.exp(-g - (slip**2).sum(axis=0) / 16e-4)
        law = 2e-3 * (1.0 - (1.0 + overlap) * np.exp(-overlap) - (1.0 + g) * decay)
        energies.append((0.5 * (u * force).sum(axis=0) + law - (load or 0.0) * u[2]).mean())
        if residual[0] <= 1e-10:
            break
        solver.advance(row)
    assert len(energies) > 3
    assert (np.diff(energies) <= 1e-13 * np.abs(energies).max()).all()
    pull = 2e-3 / 2e-2 * (g * decay + overlap * np.exp(-overlap))
    drags = 2.0 * 2e-3 / 16e-4 * slip * (1.0 + g) * decay
    wall = (load or 0.0) - force[2] + pull
    scale = max(np.abs(drags).max(), wall.max(), np.abs(pull).max())
    np.testing.assert_allclose(force[:2], drags, atol=2e-10 * scale)
    touching = (gap <= 0.0) & hard_wall
    assert np.abs(wall[~touching]).max() < 2e-10 * scale
    assert wall.min() > -2e-10 * scale
    assert touching.any() == hard_wall


@WALL
def test_newtons_method_ends_where_the_dynamics_does_with_fewer_transforms(hard_wall):
    punch, body = 4.0 * rough((32, 32), 1, rows=2), ElasticBody(0.2, None)
    newton, verlet = (press(punch, body, 0.1, LAW, hard_wall, solver=name) for name in EXACT)
    peak = verlet.pressure.max()
    np.testing.assert_allclose(newton.pressure, verlet.pressure, atol=1e-8 * peak)
    np.testing.assert_allclose(newton.tangential.traction, verlet.tangential.traction, atol=1e-8 * peak)
    assert (1.8 * newton.n_transforms < verlet.n_transforms).all()


def test_the_last_steps_converge_as_those_of_newton_do():
    """With a part of the law's second derivatives wrong or left out it takes more steps."""
    punch, body = 4.0 * rough((64, 64), 1) - 0.02, ElasticBody(0.2, 0.5)
    first = press(punch, body, None, LAW, sliding=(3e-2, 1e-2))
    drag = np.reshape((3.1e-2, 1.2e-2), (2, 1, 1))
    found = press(punch - 1e-3, body, None, LAW, start=following(first, punch - 1e-3, drag), sliding=drag)
    assert first.n_iterations[0] <= 8
    assert found.n_iterations[0] <= 6


def test_a_cohesive_slab_is_sheared_off_in_any_direction():
    """An almost flat punch: the slab's spring in series with the law, which gives way beyond the slip of its peak."""
    punch, body, work, tangential = 1e-9 * rough((4, 6), 1, waves=2), ElasticBody(0.3, 0.1), 0.02, 0.1
    spring, law = (1 - 0.3) / 2 / 0.1, XuNeedlemanLaw(0.02, 0.05, 0.1)  # C44 / z_m in E*
    for slip in (0.01, 0.06):
        pull = 2 * work * slip / tangential**2 * np.exp(-((slip / tangential) ** 2))
        for angle in (0.4, 2.5):
            way = np.array([np.cos(angle), np.sin(angle)])
            found = press(punch, body, None, law, sliding=way * (slip + pull / spring))
            mean = found.tangential.traction.mean(axis=(0, 2, 3))
            np.testing.assert_allclose(mean, pull * way, rtol=1e-7)
            shear = found.tangential.displacement.mean(axis=(0, 2, 3))
            np.testing.assert_allclose(shear, pull / spring * way, rtol=1e-7)


@pytest.mark.long
def test_damped_dynamics_without_a_wall_goes_on_from_an_overlap():
    """Pushed back to where the surfaces just meet, nodes would swing too deep into the repulsion for the time step."""
    law, punch, body = XuNeedlemanLaw(7.4e-5, 1e-3, 1e-3), 14.0 * rough((64, 64), 2), ElasticBody(0.3, 0.5)
    first, drag = press(punch, body, 0.02, law, False), np.reshape((8e-4, 6e-4), (2, 1, 1))
    assert (punch - first.displacement).min() < -1e-3
    press(punch, body, 0.021, law, False, following(first, punch, drag), drag, "verlet")


@pytest.mark.long
def test_a_map_at_rest_begins_on_coarser_grids():
    """And ends in the same equilibrium for three quarters of the transforms; a start of its own takes none."""
    heights = self_affine.SelfAffineWaves(0.8, 2, 8).heights((128, 128), 4, range(1))
    punch, body = heights.max(axis=(1, 2), keepdims=True) - heights, ElasticBody(0.3, 0.5)
    law = XuNeedlemanLaw(1.5e-4, 1e-3, 3e-3)
    coarse, at_rest = (press(punch, body, 0.02, law, start=start) for start in (None, Start.at_rest(punch)))
    np.testing.assert_array_equal(coarse.touching, at_rest.touching)
    for one, other in ((coarse.pressure, at_rest.pressure), (coarse.tangential.traction, at_rest.tangential.traction)):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-6 * at_rest.pressure.max())
    assert (4 * coarse.n_transforms < 3 * at_rest.n_transforms).all()
