"""An exponential law with a hardness: bounded least squares under the law's own pull, conditions, and limits."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

import gfmd_numba
from gfmd_numba.contact import evaluation
from gfmd_numba.contact.load_path import PathRecord, solve_path
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import LoadStep
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.interface.exponential import ExponentialLaw
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.roughness.surfaces import given_surface
from gfmd_numba.scene import InputError
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.status import Status
from gfmd_numba.solvers.table import Options

SLAB = ElasticBody(0.3, 0.3)
ATTRACTS, REPELS = ExponentialLaw(2e-4, 0.02), ExponentialLaw(-1e-3, 0.02)


def rough(shape=(64,), seed=3):
    waves = self_affine.SelfAffineWaves(0.8, 2, shape[0] // 4)
    return given_surface(waves.heights(shape, seed, range(1))[0])[0].heights


def stiff(shape, body=SLAB):
    return body.condensed_stiffness(grid.magnitudes(shape))


def press(punch, load, hardness, law, residual=1e-10):
    wall = Interactions(True, normal_law=law, hardness=hardness)
    options = Options("truncated_newton", residual=residual)
    return equilibrate(punch[np.newaxis], SpectralResponse.of_normal(stiff(punch.shape)), load, options, wall)


def dense(wall, hardness, law):
    """Pressure of the wall and of wall and law, and displacement, of a profile on the slab under a displacement.

    Bounded least squares with the whole compliance, repeated under what the law pulls at the gaps found last.
    """
    n = wall.size
    matrix = np.fft.irfft(1.0 / stiff((n,)), n)[(np.arange(n)[:, None] - np.arange(n)) % n]
    root, u = np.linalg.cholesky(matrix).T, np.minimum(wall, 0.0)
    for _ in range(400):
        pull = law.traction(np.maximum(wall - u, 0.0))
        right = -np.linalg.solve(root.T, wall - matrix @ pull)
        pressure = lsq_linear(root, right, (0.0, hardness), method="bvls", tol=1e-15, max_iter=10 * n).x
        last, u = u, 0.5 * u + 0.5 * matrix @ (pull - pressure)
        if abs(u - last).max() < 1e-13:
            return pressure, pressure - pull, u
    raise AssertionError("the pull of the law and the gap do not settle")


@pytest.mark.parametrize("law", [ATTRACTS, REPELS], ids=["attracts", "repels"])
@pytest.mark.parametrize(("depth", "hardness"), [(0.1, 0.1), (0.2, 0.8)])
def test_a_profile_is_that_of_bounded_least_squares_under_the_pull_of_the_law(law, depth, hardness):
    heights = rough()
    wall = heights.max() - heights - depth
    found = press(wall, None, hardness, law)
    pressure, total, u = dense(wall, hardness, law)
    assert found.status[0] == Status.ok
    np.testing.assert_allclose(found.pressure[0], total, atol=1e-6 * hardness)
    np.testing.assert_allclose(found.displacement[0], u, atol=1e-8)
    np.testing.assert_array_equal(found.plastic[0], pressure > hardness * (1.0 - 1e-7))
    assert 2 < found.plastic.sum() < 60


@pytest.mark.parametrize("shape", [(512,), (32, 32)])
@pytest.mark.parametrize(("work", "hardness"), [(-1e-3, 0.01), (3e-4, 0.6)])
def test_conditions_hold_under_loads_up_to_what_the_hardness_bears(work, shape, hardness):
    law = ExponentialLaw(work * hardness, 0.01)
    heights = rough(shape)
    punch = heights.max() - heights
    symbol = stiff(shape)
    symbol.flat[0] = 0.0
    for load in (0.02 * hardness, 0.5 * hardness, 0.9 * (hardness - law.strength)):
        found = press(punch, load, hardness, law, residual=1e-8)
        assert found.status[0] == Status.ok
        u, axes = found.displacement[0], tuple(range(punch.ndim))
        gap = punch - u
        traction = load - np.fft.irfftn(np.fft.rfftn(u) * symbol, shape, axes=axes) + law.traction(np.maximum(gap, 0.0))
        allowed = np.where(gap > 0.0, 0.0, np.where(gap < 0.0, hardness, np.clip(traction, 0.0, hardness)))
        assert abs(traction - allowed).max() <= 3e-8 * max(allowed.max(), abs(law.strength))
        np.testing.assert_allclose(
            found.pressure[0], allowed - law.traction(np.maximum(gap, 0.0)), atol=1e-7 * hardness
        )


@pytest.mark.parametrize("shape", [(512,), (64, 64)])
def test_a_vanishing_law_leaves_the_contact_of_the_active_sets(shape):
    heights = rough(shape)
    punch = heights.max() - heights
    alone = equilibrate(
        punch[np.newaxis],
        SpectralResponse.of_normal(stiff(shape)),
        0.1,
        Options("active_set_newton"),
        Interactions(True, hardness=0.2),
    )
    found = press(punch, 0.1, 0.2, ExponentialLaw(1e-12, 0.01))
    np.testing.assert_allclose(found.pressure, alone.pressure, atol=1e-6)
    np.testing.assert_array_equal(found.plastic, alone.plastic)
    same = press(punch, 0.1, 0.2, None, residual=1e-8)  # without a law the solver is that one
    np.testing.assert_array_equal(same.pressure, alone.pressure)


@pytest.mark.parametrize("law", [ATTRACTS, REPELS, None])
def test_a_hardness_that_nothing_reaches_changes_no_bit(law):
    heights = rough()
    wall = heights.max() - heights - 0.2
    elastic, hard = press(wall, None, None, law), press(wall, None, 1e6, law)
    for name in ("displacement", "pressure", "touching", "n_transforms"):
        np.testing.assert_array_equal(getattr(elastic, name), getattr(hard, name))


def test_a_load_that_the_law_pulls_beyond_the_hardness_is_refused():
    heights = rough()
    with pytest.raises(ValueError, match=r"at or above the 0\.19 that the hardness bears"):
        press(heights.max() - heights, 0.19, 0.2, ATTRACTS)
    found = press(heights.max() - heights, 0.21, 0.2, REPELS)
    assert found.status[0] == Status.ok


def loop(law, hardness, depths, solver="truncated_newton"):
    surface = given_surface(rough((64,)), 1.0)[0]
    wall, options = Interactions(True, normal_law=law, hardness=hardness), Options(solver, residual=1e-10)
    path = tuple(LoadStep(depth, (0.0,)) for depth in depths[1:])
    whole = Problem(surface, SLAB, wall, None, depths[0], options, path=path)
    found = list(solve_path(whole, 0))
    assert all(each.equilibrium.status[0] == Status.ok for each in found)
    record = PathRecord()
    for problem, contact in zip(whole.at_each_load, found, strict=True):
        record.add(problem, contact, True)
    return record.of_steps()["energy_lost"], found


@pytest.mark.parametrize("law", [pytest.param(ATTRACTS, marks=pytest.mark.long), REPELS], ids=["attracts", "repels"])
def test_the_loop_of_force_and_displacement_encloses_what_is_lost(law):
    """Plastic work, and under an attraction what its jumps take."""
    there = np.linspace(-0.1, 0.25, 22)
    depths = np.concatenate([there, there[::-1][1:]])
    lost, found = loop(law, 0.2, depths)
    forces = np.array([each.equilibrium.pressure.mean() for each in found])
    area = np.trapezoid(forces, depths)
    first = abs(forces[0] - forces[-1]) * 0.01  # far from the wall, where the loop is all but closed
    assert lost.sum() == pytest.approx(area, rel=1e-2, abs=first)
    yielded = (0.2 - law.strength) * evaluation.mean_plastic_depth(found[-1])[0]
    assert yielded > 0.0
    if law is REPELS:
        assert lost.sum() == pytest.approx(yielded, rel=1e-9)
        assert (lost[22:] == 0.0).all()
    else:
        assert lost.sum() >= yielded * (1.0 - 1e-3)


@pytest.mark.parametrize("law", [ATTRACTS, REPELS], ids=["attracts", "repels"])
def test_the_first_step_counts_from_the_punch_as_it_was_made_and_the_same_depth_again_loses_nothing(law):
    lost, (first, unloaded, again) = loop(law, 0.2, (0.1, 0.08, 0.1))
    assert lost[0] == pytest.approx((0.2 - law.strength) * evaluation.mean_plastic_depth(first)[0], rel=1e-9)
    assert lost[0] > 0.0
    assert abs(lost[1:].sum()) < 1e-6 * lost[0]
    assert not unloaded.equilibrium.plastic.any()
    np.testing.assert_array_equal(again.equilibrium.plastic, first.equilibrium.plastic)


@pytest.mark.long
def test_flattened_asperities_stick_better():
    """Pull-off after a deep contact: the dents conform, so the surfaces hold each other more strongly."""
    depths = [-0.1, *np.linspace(0.0, 0.2, 5), *np.linspace(0.18, -0.1, 15)]
    pulls = []
    for hardness in (0.1, None):
        _, found = loop(ATTRACTS, hardness, depths)
        pulls.append(-min(each.equilibrium.pressure.mean() for each in found[6:]))
    assert pulls[0] > 1.2 * pulls[1] > 0.0


FILE = {
    "scene": {
        "body": {"poissons_ratio": 0.3, "aspect_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {"hardness": 0.006}, "exponential": {"work_of_adhesion": 2e-7, "range": 5e-4}},
        "loading": {"displacement": -1e-3},
    },
    "path": [{"displacement": d} for d in (1e-3, 3e-3, 1e-3, -2e-3, 2e-3, -4e-3)],
    "seed": 3,
}
EPS = {"eps_c": 1 / 8, "eps_f": 1 / 8, "eps_t": 1 / 2}
COARSE = EPS | {"eps_c": 1 / 4, "eps_f": 1 / 4, "eps_t": 1}


@pytest.mark.parametrize("dimension", [1, pytest.param(2, marks=pytest.mark.long)])
def test_scenes_with_a_law_keep_their_dents(dimension):
    scene = FILE["scene"] | {"dimension": dimension}
    one = FILE | {"scene": scene, "discretisation": COARSE}
    found = gfmd_numba.solve(one)
    assert (found["status"] == 0).all()
    assert found.attrs["solver"] == "truncated_newton"
    plastic, depth = found["plastic_area_fraction"].values, found["mean_plastic_depth"].values
    assert plastic[2] > plastic[1] > plastic[0] == 0.0
    assert (plastic[3:] == 0.0).all()
    assert (depth[2:] == depth[2]).all()
    assert float(found["hysteresis"]) >= (0.006 - 4e-4) * depth[-1] * (1.0 - 1e-12)
    wall = found["pressure"] + 4e-4 * np.exp(-found["gap"] / 5e-4)
    assert float(wall.max()) == pytest.approx(0.006, rel=1e-7)
    assert float(found["pull_off_pressure"]) > 0.0


@pytest.mark.long
def test_campaigns_with_a_law_record_what_one_contact_does(tmp_path):
    kept = {"scene": FILE["scene"], "path": FILE["path"][:3], "seed": FILE["seed"]}
    results = gfmd_numba.run(kept | {"name": "sticky", "realisations": 1, "reference": COARSE}, tmp_path / "out")
    alone = gfmd_numba.solve(kept | {"discretisation": COARSE})
    for name in ("energy_lost", "hysteresis", "pull_off_pressure", "mean_plastic_depth", "plastic_area_fraction"):
        np.testing.assert_array_equal(results[name].isel(case=0, realisation=0), alone[name], err_msg=name)


def test_a_load_beyond_what_hardness_and_law_bear_is_an_error_with_its_place():
    """That of a wholly plastic contact is (0.006 - 4e-4) / 0.02, and the strongest law of the grid pulls 2e-3."""
    scene = FILE["scene"] | {"loading": {"reduced_pressure": 0.29}}
    said = (
        r"reduced_pressure: you gave 0\.29; gfmd allows below 0\.28, .* less what the exponential law pulls at no gap"
    )
    with pytest.raises(InputError, match=said):
        gfmd_numba.solve({"scene": scene, "discretisation": EPS})
    kept = {"name": "sticky", "seed": 1, "realisations": 1, "reference": EPS}
    kept["scene"] = scene | {"loading": {"reduced_pressure": 0.1}}
    with pytest.raises(InputError, match=r"grid\.reduced_pressure\[1\]: you gave 0\.21; gfmd allows below 0\.2,"):
        gfmd_numba.run(kept | {"grid": {"reduced_pressure": [0.1, 0.21], "work_of_adhesion": [1e-7, 1e-6]}})
