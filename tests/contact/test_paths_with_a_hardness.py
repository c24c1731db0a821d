"""Loading and unloading with a hardness: bounded least squares with a memory, closed loops, and punches made flat."""

import numpy as np
import pytest
from scipy.optimize import brentq, lsq_linear

import gfmd_numba
from gfmd_numba.analysis.plots.contact import plot_contact
from gfmd_numba.contact import evaluation
from gfmd_numba.contact.load_path import PathRecord, solve_path
from gfmd_numba.contact.problem import Problem
from gfmd_numba.contact.state import LoadStep
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine
from gfmd_numba.roughness.surfaces import given_surface
from gfmd_numba.scene import InputError
from gfmd_numba.solvers.table import Options

SLAB = ElasticBody(0.3, 0.3)
EPS = {"eps_c": 1 / 8, "eps_f": 1 / 8, "eps_t": 1 / 2}


def rough(shape=(32,), hurst=0.8, seed=3):
    """Heights of rms gradient 1."""
    waves = self_affine.SelfAffineWaves(hurst, 2, shape[0] // 4)
    return given_surface(waves.heights(shape, seed, range(1))[0])[0].heights


def steps(heights, loads, hardness, body=SLAB, displaced=False, solver="active_set_newton"):
    """The contacts along a path of mean pressures, or of displacements of the punch."""
    surface, _ = given_surface(heights, 1.0)
    wall, options = Interactions(True, hardness=hardness), Options(solver, residual=1e-10, max_iterations=2000)
    first = (None, loads[0]) if displaced else (loads[0], None)
    path = tuple(LoadStep(load, (0.0,) * heights.ndim) for load in loads[1:])
    problem = Problem(surface, body, wall, *first, options, path=path)
    found = list(solve_path(problem, 0))
    assert all((each.equilibrium.status == 0).all() for each in found)
    return problem.at_each_load, found


def losses(problems, found):
    """Energy lost in each step, as it is recorded."""
    record = PathRecord()
    for problem, contact in zip(problems, found, strict=True):
        record.add(problem, contact, True)
    return record.of_steps()["energy_lost"], record.of_path()["hysteresis"]


def dense(wall, load, hardness, displaced):
    """Pressure, displacement and wall of a profile on the slab by bounded least squares with its whole compliance."""
    n = wall.size
    stiff = SLAB.condensed_stiffness(2.0 * np.pi * np.arange(n // 2 + 1))
    matrix = np.fft.irfft(1.0 / stiff, n)[(np.arange(n)[:, None] - np.arange(n)) % n]
    root = np.linalg.cholesky(matrix).T

    def pressure(depth):
        right = -np.linalg.solve(root.T, wall - depth)
        return lsq_linear(root, right, (0.0, hardness), method="bvls", tol=1e-15, max_iter=10 * n).x

    depth = load if displaced else brentq(lambda d: pressure(d).mean() - load, 0.0, 10.0, xtol=1e-15, rtol=1e-14)
    found = pressure(depth)
    return found, -matrix @ found, wall - depth


@pytest.mark.parametrize(
    ("displaced", "hardness", "loads"),
    [
        (False, 0.1, (0.03, 0.07, 0.01, 0.05, 0.085, 0.04)),
        (True, 0.2, (0.05, 0.2, 0.12, 0.02, 0.25, 0.22)),
    ],
)
def test_each_step_is_bounded_least_squares_on_the_punch_that_the_last_one_left(displaced, hardness, loads):
    heights = rough()
    _, found = steps(heights, loads, hardness, displaced=displaced)
    depth = np.zeros(32)
    for load, contact in zip(loads, found, strict=True):
        pressure, u, wall = dense(heights.max() - heights + depth, load, hardness, displaced)
        depth = depth + np.where(pressure > hardness * (1.0 - 1e-7), np.maximum(u - wall, 0.0), 0.0)
        np.testing.assert_allclose(contact.equilibrium.pressure[0], pressure, atol=1e-6 * hardness)
        np.testing.assert_allclose(np.asarray(contact.plastic_depth)[0], depth, atol=1e-8)
        np.testing.assert_array_equal(contact.equilibrium.plastic[0], pressure > hardness * (1.0 - 1e-7))
    assert depth.max() > 0.01


@pytest.mark.parametrize("shape", [(512,), (32, 32)])
@pytest.mark.parametrize("body", [ElasticBody(None, None), ElasticBody(0.5, 0.05), ElasticBody(0.49, 0.02)])
@pytest.mark.parametrize("hardness", [0.05, pytest.param(0.3, marks=pytest.mark.long)])
def test_many_steps_of_a_growing_load_are_one(shape, body, hardness):
    loads = 0.6 * hardness * np.arange(1, 7) / 6
    problems, many = steps(rough(shape), loads, hardness, body)
    _, (one,) = steps(rough(shape), loads[-1:], hardness, body)
    largest = one.plastic_depth.max()
    np.testing.assert_allclose(many[-1].plastic_depth, one.plastic_depth, atol=1e-8 * largest)
    np.testing.assert_allclose(many[-1].equilibrium.pressure, one.equilibrium.pressure, atol=1e-7 * hardness)
    np.testing.assert_array_equal(many[-1].equilibrium.plastic, one.equilibrium.plastic)
    assert losses(problems, many)[1] == pytest.approx(evaluation.plastic_work(one)[0], rel=1e-8)


@pytest.mark.parametrize("shape", [(256,), (32, 32)])
def test_below_its_highest_load_a_contact_is_elastic_and_retraces(shape):
    hardness, loads = 0.2, (0.05, 0.15, 0.08, 0.001, 0.08, 0.15, 0.001, 0.15, 0.16)
    problems, found = steps(rough(shape), loads, hardness)
    lost, hysteresis = losses(problems, found)
    assert (lost[2:-1] == 0.0).all()
    assert (lost[[0, 1, -1]] > 0.0).all()
    grown = [evaluation.mean_plastic_depth(each)[0] for each in found]
    np.testing.assert_allclose(hardness * np.diff([0.0, *grown]), lost, rtol=1e-12, atol=1e-18)
    assert hysteresis == pytest.approx(hardness * grown[-1], rel=1e-12)
    for there, again in ((1, 5), (1, 7), (2, 4), (3, 6)):
        one, other = found[there], found[again]
        np.testing.assert_allclose(one.equilibrium.pressure, other.equilibrium.pressure, atol=1e-7 * hardness)
        np.testing.assert_allclose(evaluation.gap(one), evaluation.gap(other), atol=1e-7)
        np.testing.assert_array_equal(one.equilibrium.plastic, other.equilibrium.plastic)
    for each in found:
        assert each.equilibrium.pressure.max() <= hardness * (1.0 + each.equilibrium.residual[0])
    assert found[1].equilibrium.plastic.any()
    assert not found[4].equilibrium.plastic.any()


@pytest.mark.parametrize("load", [0.02, 0.1])
@pytest.mark.parametrize("make", ["rough", "sinusoid", "map"])
def test_an_unloaded_punch_presses_as_the_elastic_one_that_has_its_shape(make, load):
    n = 128
    wave = np.cos(2.0 * np.pi * (np.arange(n) + 0.3) / n) / 5.0
    heights = {"rough": rough((n,)), "sinusoid": wave, "map": rough((32, 32))}[make]
    _, (loaded, unloaded) = steps(heights, (0.15, load), 0.3)
    assert loaded.equilibrium.plastic.any()
    _, (own,) = steps(heights - unloaded.plastic_depth[0], (load,), None)
    np.testing.assert_allclose(unloaded.equilibrium.pressure, own.equilibrium.pressure, atol=1e-9)
    np.testing.assert_allclose(evaluation.gap(unloaded), evaluation.gap(own), atol=1e-12 * np.ptp(heights))
    (elastic,) = steps(heights, (load,), None)[1]
    assert abs(unloaded.equilibrium.pressure - elastic.equilibrium.pressure).max() > 0.01


def test_the_loop_of_force_and_displacement_encloses_the_plastic_work():
    """From first touch to a depth and back to an open gap: the work of the punch is what its flattening took."""
    depths = 0.25 * np.concatenate([np.linspace(0.0, 1.0, 40), np.linspace(1.0, 0.0, 40)[1:]])
    problems, found = steps(rough(), depths, 0.2, displaced=True)
    forces = [each.equilibrium.pressure.mean() for each in found]
    lost, hysteresis = losses(problems, found)
    assert forces[-1] == 0.0
    assert np.trapezoid(forces, depths) == pytest.approx(hysteresis, rel=1e-3)
    assert (lost[40:] == 0.0).all()
    assert evaluation.gap(found[-1]).min() > 0.0


@pytest.mark.parametrize("solver", ["active_set_newton", "conjugate_gradients"])
def test_a_punch_that_is_drawn_back_leaves_its_dents_open(solver):
    thin, depths = ElasticBody(0.45, 0.05), (0.15, 0.05, 0.04, 0.03, 0.02, 0.01, 0.21)
    _, (_, *withdrawn, closed) = steps(rough(), depths, 0.1, thin, displaced=True, solver=solver)
    for contact in withdrawn:
        assert (contact.equilibrium.pressure == 0.0).all()
        assert evaluation.gap(contact).min() > 0.0
        assert contact.equilibrium.n_transforms[0] < 500
    assert closed.equilibrium.plastic.any()


def scene(interface, **others):
    kept = {
        "body": {"poissons_ratio": 0.3},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": interface,
        "loading": {"reduced_pressure": 0.05},
    }
    path = [{"reduced_pressure": p} for p in (0.1, 0.01, 0.1, 0.15)]
    return {"scene": kept | others, "path": path, "discretisation": EPS, "seed": 5}


HARD = {"hard_wall": {"hardness": 0.01}}


def test_two_rough_bodies_dent_as_a_rigid_punch_of_all_heights_at_order_0():
    """Two bodies of equal moduli are one of half the E*, in units of which the hardness is."""
    psd = scene(HARD)["scene"]["roughness"]
    body = {"poissons_ratio": 0.3, "youngs_modulus": 2e9, "roughness": psd}
    counter = {"poissons_ratio": 0.3, "youngs_modulus": 2e9}
    modulus = 1e9 / (1.0 - 0.3**2)
    both = scene({"hard_wall": {"hardness": 0.01 * modulus}}, body=body, counter_body=counter, roughness=None)
    both["scene"]["length"] = 1e-3
    both["numerics"] = {"topography_order": 0}
    two, one = gfmd_numba.solve(both), gfmd_numba.solve(scene(HARD))
    assert float(one["hysteresis"]) > 0.0
    for name, unit in (("energy_lost", 1e-3 * modulus), ("plastic_depth", 1e-3), ("gap", 1e-3), ("pressure", modulus)):
        np.testing.assert_allclose(two[name] / unit, one[name], rtol=1e-6, atol=1e-7 * float(one[name].max()))
    assert two["energy_lost"].attrs["units"] == "J m-2"
    assert two["plastic_depth"].attrs["units"] == two["mean_plastic_depth"].attrs["units"] == "m"


@pytest.mark.long
def test_a_campaign_records_what_one_contact_does(tmp_path):
    file = scene(HARD)
    kept = {"name": "dents", "seed": 5, "realisations": 2, "scene": file["scene"], "path": file["path"]}
    results = gfmd_numba.run(kept | {"reference": EPS, "grid": {"hardness": [0.01, 0.02]}}, tmp_path / "out")
    assert (results["status"] == 0).all()
    alone = gfmd_numba.solve(file | {"realisation": 1})
    found = results.isel(case=int(np.flatnonzero(results["hardness"] == 0.01)[0]), realisation=1)
    for name in ("energy_lost", "hysteresis", "mean_plastic_depth", "plastic_area_fraction", "mean_gap"):
        np.testing.assert_array_equal(found[name], alone[name], err_msg=name)
        assert found[name].attrs["units"] == alone[name].attrs["units"]
    lost = results["hysteresis"].sel(case=results["hardness"] == 0.02)
    assert (lost.values < results["hysteresis"].isel(case=[0]).values).all()


def test_a_step_beyond_the_hardness_is_an_error_with_its_place():
    file = scene(HARD) | {"path": [{"reduced_pressure": 0.2}, {"reduced_pressure": 0.5}]}
    with pytest.raises(
        InputError, match=r"path\[1\]\.reduced_pressure: you gave 0\.5; gfmd allows below 0\.5, at which"
    ):
        gfmd_numba.solve(file)


def test_a_load_curve_that_falls_unloads():
    file = {key: value for key, value in scene(HARD).items() if key != "path"}
    rises = gfmd_numba.load_curve(file, [0.01, 0.1])
    falls = gfmd_numba.load_curve(file, [0.1, 0.01])
    assert float(falls["mean_gap"][1]) < float(rises["mean_gap"][0])
    assert float(falls["contact_stiffness"][0]) > 1.1 * float(rises["contact_stiffness"][1])


@pytest.mark.long
def test_the_picture_shows_the_punch_as_it_was_made():
    labels = [text.get_text() for text in plot_contact(gfmd_numba.solve(scene(HARD))).legends[0].get_texts()]
    assert "original punch" in labels
    labels = [
        text.get_text() for text in plot_contact(gfmd_numba.solve(scene({"hard_wall": {}}))).legends[0].get_texts()
    ]
    assert "original punch" not in labels


def labels_of(file):
    drawn = plot_contact(gfmd_numba.solve(file)).axes
    return [axis.get_xlabel() + axis.get_ylabel() + axis.get_title() for axis in drawn]


@pytest.mark.long
def test_the_picture_of_a_map_outlines_what_is_flattened():
    file = scene(HARD, dimension=2) | {"discretisation": {"eps_c": 1 / 16, "eps_f": 1 / 4, "eps_t": 1 / 2}}
    labels = labels_of(file)
    assert [label for label in labels if "flattened within lines" in label]
    file["scene"]["interface"] = {"hard_wall": {"hardness": 10.0}}
    labels = labels_of(file)
    assert not [label for label in labels if "flattened" in label]
