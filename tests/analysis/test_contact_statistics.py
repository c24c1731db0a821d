"""Distributions over contacts made by hand and solved, and the energy against work and Parseval."""

import numpy as np
import pytest
import slab_stiffness
import xarray as xr

import gfmd_numba
from gfmd_numba.analysis import UnusableDataError, plot_statistics
from gfmd_numba.contact import evaluation, solution
from gfmd_numba.contact.problem import Problem
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine import SelfAffineWaves
from gfmd_numba.solvers.table import Options

LOADS = np.concatenate([[0.0], np.geomspace(1e-4, 3.0, 120)])


def pressed(load, body, realisations=3, nodes=1024):
    numerics = Options("active_set_newton", residual=1e-10)
    surface = RandomSurface(SelfAffineWaves(0.8, 2, nodes // 8), nodes, 5)
    return solution.solve(Problem(surface, body, Interactions(True), load, None, numerics), range(realisations))


def test_elastic_energy_is_the_work_of_loading():
    """The integral of p d(approach) along a load path, the approach being what the mean gap loses."""
    body = ElasticBody(0.4, 0.05)
    values = [evaluation.measure(pressed(load, body, 1, 256)) for load in LOADS[1:]]
    gap = np.array([v["mean_gap"] for v in values])
    energy = np.array([v["elastic_energy"] for v in values])
    work = energy[0] + np.cumsum(0.5 * (LOADS[1:-1] + LOADS[2:])[:, np.newaxis] * -np.diff(gap, axis=0), axis=0)
    np.testing.assert_allclose(work, energy[1:], rtol=2e-3)
    assert (energy[0] < 1e-3 * energy[-1]).all()


@pytest.mark.parametrize("body", [ElasticBody(None, None), ElasticBody(0.5, 0.05)])
@pytest.mark.parametrize("load", [0.01, 0.3, 100.0])
def test_elastic_energy_is_that_of_its_waves(body, load):
    """Parseval: sum_q K |u~|^2 / 2 without the mean; in full contact u is the punch."""
    result = pressed(load, body)
    q = grid.wavenumbers(1024)
    k = 0.5 * q if body.aspect_ratio is None else slab_stiffness.slab(q, body.poissons_ratio, body.aspect_ratio)
    shape = -result.heights if load == 100.0 else result.equilibrium.displacement
    waves = grid.multiplicity(1024)[1:] * k[1:] * abs(grid.coefficients(shape)[:, 1:]) ** 2
    np.testing.assert_allclose(evaluation.elastic_energy(result), 0.5 * waves.sum(axis=1), rtol=1e-6)


@pytest.mark.parametrize("friction", [0.2, pytest.param(np.inf, marks=pytest.mark.long)])
def test_elastic_energy_with_friction_has_the_tangential_waves(friction):
    """Parseval on both components: (K11 |v|^2 + K33 |u|^2 + 2 K13 Im(v u*)) / 2."""
    numerics = Options("verlet", residual=1e-9)
    body, wall = ElasticBody(0.2, None), Interactions(True, friction=friction)
    result = solution.solve(
        Problem(RandomSurface(SelfAffineWaves(0.8, 2, 32), 256, 5), body, wall, 0.05, None, numerics), range(2)
    )
    assert (result.equilibrium.status == 0).all()
    u = grid.coefficients(result.equilibrium.displacement)
    v = grid.coefficients(result.equilibrium.tangential.displacement[:, 0])
    k = ElasticBody(0.2, None).response((256,))
    waves = k.elements[0] * abs(v) ** 2 + k.normal * abs(u) ** 2 + 2 * k.elements[1] * (v * u.conj()).imag
    energy = 0.5 * (grid.multiplicity(256) * waves)[:, 1:].sum(axis=1)
    np.testing.assert_allclose(evaluation.elastic_energy(result), energy, rtol=1e-5)
    assert (abs(v) ** 2).sum() > 1e-3 * (abs(u[:, 1:]) ** 2).sum()


def scene(**changes):
    scene = {
        "length": 1e-4,
        "body": {"youngs_modulus": 70e9, "poissons_ratio": 0.33},
        "roughness": {"method": "psd", "hurst": 0.8, "rms_gradient": 0.02},
        "interface": {"hard_wall": {}},
        "loading": {"reduced_pressure": 0.05},
    }
    discretisation = {"eps_c": 0.25, "eps_f": 1 / 32, "eps_t": 0.5}
    return {"scene": scene | changes, "discretisation": discretisation, "seed": 3}


@pytest.mark.parametrize(
    ("length", "modulus", "unit"), [(1e-4, 70e9, "J m-2"), (None, 70e9, "Pa"), (1e-4, None, "m"), (None, None, "1")]
)
def test_energy_is_in_the_units_of_the_scene(length, modulus, unit):
    body = {"poissons_ratio": 0.33} | ({"youngs_modulus": modulus} if modulus else {})
    changed = scene(body=body)
    if length is None:
        del changed["scene"]["length"]
    result = gfmd_numba.solve(changed)
    assert result["elastic_energy"].units == unit
    shape = result["displacement"] - result["displacement"].mean()
    assert float(result["elastic_energy"]) == pytest.approx(-0.5 * float((result["pressure"] * shape).mean()))


@pytest.fixture(scope="module")
def path():
    return gfmd_numba.solve(scene() | {"path": [{"reduced_pressure": 0.5}, {"reduced_pressure": 2.5}]})


def test_distributions_hold_every_node_and_segment(path):
    result = gfmd_numba.contact_statistics(path)
    width = {dim: float(result[dim][1] - result[dim][0]) for dim in ("pressure", "gap")}
    touching = path["contact_area_fraction_counted"]
    np.testing.assert_allclose(result["pressure_density"].sum("pressure") * width["pressure"], touching)
    np.testing.assert_allclose(result["gap_density"].sum("gap") * width["gap"], 1.0 - touching, atol=1e-12)
    np.testing.assert_array_equal(result["segments"].sum("length"), np.maximum(path["n_segments"], 1))
    mean = (result["pressure"] * result["pressure_density"]).sum("pressure") * width["pressure"]
    np.testing.assert_allclose(mean, path["mean_pressure"] / path["full_contact_rms_pressure"], rtol=0.05)
    assert touching[2] == 1.0
    # full contact: Persson's theory has the second moment of the nodes, but for its tail beyond the last of them
    theory = (result["pressure"] ** 2 * result["pressure_density_persson"]).sum("pressure") * width["pressure"]
    found = float((path["pressure"].isel(step=2) ** 2).mean() / path["full_contact_rms_pressure"].isel(step=2) ** 2)
    assert float(theory.isel(step=2)) == pytest.approx(found, rel=0.01)


def test_segments_of_contacts_made_by_hand_are_found():
    rows = ["1000000000001101", "0000000000000000", "1111111111111111", "0111100111111110"]
    gap = np.array([[float(node == "0") for node in row] for row in rows])
    fields = {name: (("realisation", "x"), gap) for name in ("gap", "height", "pressure")}
    scalars = {name: ("realisation", np.ones(4)) for name in ("mean_pressure", "full_contact_rms_pressure")}
    scalars["status"] = ("realisation", np.zeros(4))
    dataset = xr.Dataset(fields | scalars, {"x": np.arange(16) / 16})
    dataset["height"] = dataset["height"] + dataset["x"]
    segments = gfmd_numba.contact_statistics(dataset)["segments"]
    # 1, 2-3, 4-7 and 8-16 nodes; the first and last stretches of the first row are one, across the period
    np.testing.assert_array_equal(segments, [[0, 2, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1], [0, 0, 1, 1]])
    assert segments["length"].values == pytest.approx(np.sqrt(2) * np.array([1, 2, 4, 8]) / 16)


@pytest.mark.long
def test_picture_has_a_colour_for_each_step(path):
    figure = plot_statistics(gfmd_numba.contact_statistics(path))
    pressure, gap, length = figure.axes
    assert len(pressure.patches) == 3
    assert [text.get_text() for text in figure.legends[0].get_texts()][-1] == "Persson"
    assert length.get_xscale() == gap.get_yscale() == "log"
    single = gfmd_numba.contact_statistics(path.isel(step=0))
    assert len(plot_statistics(single).axes[0].patches) == 1


def test_no_contact_no_statistics():
    with pytest.raises(UnusableDataError, match="no results of a contact"):
        gfmd_numba.contact_statistics(xr.Dataset({"x": [0.0]}))


def test_steps_are_no_rows_of_a_map(path):
    with pytest.raises(UnusableDataError, match="altered results"):
        gfmd_numba.contact_statistics(path.rename(step="y"))


def test_a_failed_run_has_no_statistics(path):
    path = path.assign(status=("step", [0, 1, 0]))
    with pytest.raises(UnusableDataError, match="a run that is not ok"):
        gfmd_numba.contact_statistics(path)


@pytest.mark.parametrize("name", ["pressure", "gap"])
def test_one_field_that_is_not_finite_is_enough_to_refuse_a_contact(name):
    scene = {"body": {"poissons_ratio": 0.3}, "interface": {"hard_wall": {}}, "loading": {"reduced_pressure": 0.05}}
    scene["roughness"] = {"method": "psd", "hurst": 0.8, "rms_gradient": 0.01}
    found = gfmd_numba.solve({"scene": scene, "discretisation": {"eps_c": 1 / 4, "eps_f": 1 / 8, "eps_t": 1 / 2}})
    found[name][3] = np.inf
    with pytest.raises(UnusableDataError, match="fields that are not finite"):
        gfmd_numba.contact_statistics(found)
