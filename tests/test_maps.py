"""Interfaces of two dimensions: closed forms, the profile they contain, symmetry, refinement, files and refusals."""

import numpy as np
import pytest
import xarray as xr

from gfmd_numba import body_fields, run
from gfmd_numba.analysis.plots.contact import plot_contact
from gfmd_numba.contact import contact_area, evaluation, solution
from gfmd_numba.contact.problem import Problem
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from gfmd_numba.interface.interactions import Interactions
from gfmd_numba.roughness import self_affine, statistics
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.self_affine_waves import SelfAffineWaves
from gfmd_numba.scene import InputError
from gfmd_numba.simulate import contact as single
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.options import Options
from gfmd_numba.solvers.preconditioners import far_field
from gfmd_numba.solvers.preconditioners.far_field import FarField
from gfmd_numba.solvers.preconditioners.near_field import NearField
from gfmd_numba.solvers.status import Status

SOLVERS = ("active_set_newton", "conjugate_gradients")
HALF_SPACE = ElasticBody(None, None)


def body(shape, slab=None):
    q = grid.magnitudes(shape)
    return stiffness.half_space(q) if slab is None else stiffness.slab(q, *slab)


def press(punch, load, solver="active_set_newton", slab=None):
    found = equilibrate(punch, body(punch.shape[1:], slab), load, Options(solver))
    assert (found.status == Status.ok).all()
    return found


def rough(nx, realisations=range(1), hurst=0.8, seed=3):
    heights = self_affine.maps(hurst, 2, nx // 4, nx, seed, realisations)
    return heights.max(axis=(1, 2), keepdims=True) - heights


def problem(nx=64, load=0.03, cut_off=16, solver="active_set_newton"):
    surface = RandomSurface(SelfAffineWaves(0.8, 2, cut_off), nx, 7, dimension=2)
    return Problem(surface, HALF_SPACE, Interactions(hard_wall=True), load, None, Options(solver))


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("slab", [None, (0.33, 0.1), (0.5, 0.05)])
def test_a_profile_extruded_along_y_is_pressed_like_the_profile(solver, slab):
    heights = self_affine.profiles(0.5, 2, 16, 64, 1, range(2))
    profiles = heights.max(axis=1, keepdims=True) - heights
    expected = press(profiles, 0.1, solver, slab)
    found = press(np.repeat(profiles[:, np.newaxis], 32, axis=1), 0.1, solver, slab)
    np.testing.assert_array_equal(found.touching, np.broadcast_to(expected.touching[:, np.newaxis], (2, 32, 64)))
    np.testing.assert_allclose(found.pressure[:, 5], expected.pressure, atol=1e-6 * expected.pressure.max())


def test_a_wave_in_both_directions_touches_everywhere_at_the_pressure_of_its_closed_form():
    """Johnson, Greenwood & Higginson, Int. J. Mech. Sci. 27:383 (1985): p* = sqrt(2) pi E* amplitude / wavelength."""
    amplitude, n = 0.01, 32
    x = 2.0 * np.pi * np.arange(n) / n
    wave = amplitude * np.cos(x) * np.cos(x)[:, np.newaxis]
    flat_at = np.sqrt(2.0) * np.pi * amplitude
    punch = (amplitude - wave)[np.newaxis]
    above = press(punch, 1.01 * flat_at)
    assert above.touching.all()
    np.testing.assert_allclose(above.pressure[0], 1.01 * flat_at + flat_at * wave / amplitude, rtol=1e-6)
    assert not press(punch, 0.99 * flat_at).touching.all()


def test_hertz_point_contact():
    """a^3 = 3 F R / 4 E*."""
    n, a = 192, 12.0 / 192
    x = np.arange(n) / n - 0.5
    punch = 0.5 * (x**2 + x[:, np.newaxis] ** 2)[np.newaxis]  # R = L_x
    load = 4.0 / 3.0 * a**3
    found = press(punch, load)
    assert found.pressure.max() == pytest.approx(1.5 * load / (np.pi * a**2), rel=0.01)
    assert contact_area.n_segments(solution.Contact(-punch, punch, found))[0] == 1


@pytest.mark.parametrize("slab", [None, (0.33, 0.05), (0.5, 0.02)])
@pytest.mark.parametrize("load", [0.005, 0.1, 2.0])
def test_the_solvers_agree(slab, load):
    punch = rough(64, range(2), hurst=0.3)
    newton, gradients = (press(punch, load, solver, slab) for solver in SOLVERS)
    np.testing.assert_array_equal(newton.touching, gradients.touching)
    np.testing.assert_allclose(newton.pressure, gradients.pressure, atol=1e-6 * gradients.pressure.max())


def test_a_prescribed_displacement_is_met_with_the_pressure_that_prescribes_it():
    punch, slab = rough(64), (0.3, 0.1)
    found = press(punch, 0.05, slab=slab)
    down = (punch - found.displacement)[found.touching].mean()
    assert down == pytest.approx(0.0, abs=1e-12)
    mean = found.displacement.mean() + 0.05 / stiffness.uniform(*slab)
    by_displacement = equilibrate(punch - mean, body(punch.shape[1:], slab), None, Options("active_set_newton"))
    assert by_displacement.pressure.mean() == pytest.approx(0.05, rel=1e-6)


def test_transposed_map_gives_the_transposed_contact():
    punch = rough(64)
    straight, across = press(punch, 0.03), press(punch.swapaxes(1, 2).copy(), 0.03)
    np.testing.assert_array_equal(across.touching, straight.touching.swapaxes(1, 2))
    np.testing.assert_allclose(across.pressure.swapaxes(1, 2), straight.pressure, atol=1e-6)


def test_a_map_does_not_know_its_batch():
    together = solution.solve(problem(), range(3)).equilibrium
    for i in range(3):
        alone = solution.solve(problem(), range(i, i + 1)).equilibrium
        np.testing.assert_array_equal(alone.pressure[0], together.pressure[i])


@pytest.mark.parametrize("cut_off", [8, 16])
def test_refining_the_grid_keeps_the_map(cut_off):
    coarse, fine = (self_affine.maps(0.5, 2, cut_off, nx, 5, range(2)) for nx in (32, 96))
    if 2 * cut_off < 32:  # at Nyquist the coarser grid sees one phase of the shortest waves
        np.testing.assert_allclose(fine[:, ::3, ::3], coarse, atol=1e-15)
    np.testing.assert_allclose(statistics.rms_gradient(fine, (1.0, 1.0)), 1.0, rtol=1e-12)
    np.testing.assert_allclose(coarse.mean(axis=(1, 2)), 0.0, atol=1e-16)


def test_more_waves_are_added_to_the_map():
    few, many = (self_affine.maps(0.5, 2, cut_off, 64, 5, range(1)) for cut_off in (8, 16))
    ratio = np.fft.rfft2(many[0])[:5, 1:6] / np.fft.rfft2(few[0])[:5, 1:6]
    np.testing.assert_allclose(ratio, ratio[0, 0].real, atol=1e-9)


def test_clusters_and_perimeter_on_the_torus():
    """A plus of five nodes across a corner, a pair across an edge, one node that meets the plus at a corner only."""
    flags = np.zeros((1, 8, 8), dtype=bool)
    flags[0, [0, 0, 0, 1, 7], [0, 1, 7, 0, 0]] = True
    flags[0, 4, [0, 7]] = True
    flags[0, 2, 1] = True
    pressure = flags.astype(float)
    equilibrium = press(np.zeros((1, 8, 8)), 1.0)
    made = solution.Contact(pressure, pressure, type(equilibrium)(**{**vars(equilibrium), "touching": flags}))
    assert contact_area.n_segments(made).tolist() == [3]
    assert [sides.tolist() for sides in contact_area.perimeter(made)] == [[6 + 2 + 2], [6 + 4 + 2]]


def test_rms_gradient_over_the_contact_is_that_of_the_surface_in_full_contact():
    made = solution.solve(problem(load=20.0), range(1))
    assert made.equilibrium.touching.all()
    assert evaluation.rms_gradient_contact(made) == pytest.approx(evaluation.rms_gradient(made), rel=1e-12)
    assert contact_area.contact_area_fraction(made) == 1.0
    assert contact_area.n_segments(made) == 0


def test_neighbours_are_a_stencil_of_the_stiffness_that_is_positive_definite():
    shape, rng = (12, 16), np.random.default_rng(0)
    nodes = np.flatnonzero(rng.random(shape) < 0.5)
    for slab in (None, (0.5, 0.01), (0.3, 0.001)):
        symbol = body(shape, slab)
        inverse = NearField(symbol, shape)
        inverse.factor(nodes, len(nodes))
        matrix = np.empty((len(nodes), len(nodes)))
        for column, unit in zip(matrix, np.eye(len(nodes)), strict=True):
            inverse.solve(unit, column)
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-12 * matrix.max())
        assert np.linalg.eigvalsh(matrix).min() > 0.0
    symbol = body(shape)
    symbol[0, 0] = symbol[0, 1]
    near = np.fft.irfft2(symbol, shape)
    near[2:-1], near[:, 2:-1] = 0.0, 0.0
    inverse = NearField(body(shape), shape)
    inverse.factor(nodes, len(nodes))
    given, pressure = np.zeros(shape), np.empty(len(nodes))
    given.flat[nodes] = u = rng.normal(size=len(nodes))
    inverse.solve(u, pressure)
    expected = np.fft.irfft2(np.fft.rfft2(given) * np.fft.rfft2(near), shape).ravel()[nodes]
    np.testing.assert_allclose(pressure, expected, atol=1e-12)


def columns(inverse, nodes):
    inverse.factor(nodes, len(nodes))
    matrix = np.empty((len(nodes), len(nodes)))
    for column, unit in zip(matrix, np.eye(len(nodes)), strict=True):
        inverse.solve(unit, column)
    return matrix


@pytest.mark.parametrize("slab", [None, (0.3, 0.1)])
def test_far_away_contacts_are_taken_into_account_by_blocks(monkeypatch, slab):
    """Against dense algebra."""
    monkeypatch.setattr(far_field, "_TOLERANCE", 1e-12)
    monkeypatch.setattr(far_field, "_FEWEST", 4)
    shape, rng = (96, 64), np.random.default_rng(0)
    nodes = np.flatnonzero(np.kron(rng.random((48, 32)) < 0.05, np.ones((2, 2))))
    stiff = body(shape, slab)
    soft = np.divide(1.0, stiff, out=np.zeros_like(stiff), where=stiff > 0.0)
    near, far = (columns(method(stiff, shape), nodes) for method in (NearField, FarField))
    y, x = np.divmod(nodes, 64)
    blocks = np.eye(96)[y // 8 * 8 + x // 8]
    rows = np.fft.fftfreq(12, 1 / 12).astype(int)
    smooth = np.fft.irfft2(soft[np.ix_(rows, np.arange(5))] / 64, (12, 8))
    smooth = np.array([np.roll(smooth, divmod(b, 8), axis=(0, 1)).ravel() for b in range(96)])
    shared = np.diag(near.sum(axis=1)) @ blocks
    expected = near - shared @ smooth @ np.linalg.inv(np.eye(96) + blocks.T @ shared @ smooth) @ shared.T
    np.testing.assert_allclose(far, expected, atol=1e-9 * near.max())
    assert np.linalg.eigvalsh(far).min() > 0.0


def test_newton_takes_few_transforms():
    few = solution.solve(problem(256, 0.01, 64), range(1)).equilibrium.n_transforms
    many = solution.solve(problem(256, 0.01, 64, "conjugate_gradients"), range(1)).equilibrium.n_transforms
    assert few[0] < 90
    assert few[0] < 0.5 * many[0]


def test_transforms_hardly_grow_with_the_map():
    taken = [solution.solve(problem(nx, 0.02, nx // 4), range(1)).equilibrium.n_transforms[0] for nx in (256, 512)]
    assert taken[1] < 1.2 * taken[0]


def test_agreement_with_tamaas():
    tamaas = pytest.importorskip("tamaas")
    tamaas.set_log_level(tamaas.LogLevel.error)
    punch = rough(64)[0]
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1.0, 1.0], [64, 64])
    model.E, model.nu = 1.0, 0.0
    tamaas.PolonskyKeerRey(model, np.ascontiguousarray(-punch), 1e-12).solve(0.05)
    found = press(punch[np.newaxis], 0.05)
    pressure = np.asarray(model.traction).reshape(64, 64)
    np.testing.assert_array_equal(found.touching[0], pressure > 0.0)
    np.testing.assert_allclose(found.pressure[0], pressure, atol=1e-5 * pressure.max())


SCENE = """\
dimension: 2
length: 1e-4
body: {youngs_modulus: 70e9, poissons_ratio: 0.33, aspect_ratio: 0.2}
roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
interface: {hard_wall: {}}
loading: {reduced_pressure: 0.05}
discretisation: {eps_c: 1/2, eps_f: 1/8, eps_t: 1/2}
"""


def scene(folder, old="", new=""):
    path = folder / "map.yaml"
    assert old in SCENE
    path.write_text(SCENE.replace(old, new) if old else SCENE)
    return path


def test_file_of_a_map(tmp_path):
    single.solve_scene(scene(tmp_path)).to_netcdf(tmp_path / "map.nc")
    with xr.open_dataset(tmp_path / "map.nc") as dataset:
        assert dataset["pressure"].dims == ("y", "x")
        assert dataset["y"].size == dataset["x"].size == 64
        assert float(dataset["pressure"].mean()) == pytest.approx(float(dataset["mean_pressure"]), rel=1e-9)
        assert float(dataset["kappa"]) < float(dataset["kappa_counted"])
        assert np.isnan(dataset["kappa_edges"])
        assert float(dataset["rms_gradient"]) == pytest.approx(0.01)
        figure = plot_contact(dataset)
        with pytest.raises(InputError, match=r"scene\.dimension: given 2; allowed: a contact of dimension 1"):
            body_fields(dataset)
    assert len(figure.axes) == 4  # two maps and their colour bars


@pytest.mark.parametrize(
    ("old", "new", "where", "allowed"),
    [
        ("hard_wall: {}", "hard_wall: {}, friction: {coefficient: 0.3}", "interface.friction", "hard_wall alone"),
        (
            "hard_wall: {}",
            "hard_wall: {}, exponential: {work_of_adhesion: 1, range: 1e-5}",
            "interface.exponential",
            "hard_wall alone",
        ),
        (
            SCENE.partition("roughness")[2],
            ": {method: measured, file: a.npy}\ninterface: {hard_wall: {}}\nloading: {reduced_pressure: 0.05}",
            "roughness.method",
            "a random surface with dimension 2, like method 'psd'",
        ),
        (
            "0.2}\nroughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}",
            "0.2, roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}}",
            "roughness.method",
            "a random surface with dimension 2, like method 'psd'",
        ),
        (
            "0.33,",
            "0.33, roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01},",
            "body.roughness",
            "nothing with dimension 2",
        ),
        (
            "roughness: {",
            "counter_body:\n  youngs_modulus: 1e9\n  poissons_ratio: 0.3\n  roughness: {",
            "counter_body",
            "nothing with dimension 2",
        ),
        ("length: 1e-4", "boundary: {normal_traction: 1.0}", "boundary", "nothing with dimension 2"),
        ("length: 1e-4", "numerics: {solver: verlet}", "numerics.solver", "'active_set_newton', 'conjugate_gradients'"),
        ("0.33,", "0.33, state: plane_stress,", "body.state", "'plane_strain'"),
        ("dimension: 2", "dimension: 3", "dimension", "one of 1, 2"),
    ],
)
def test_what_maps_are_refused(tmp_path, old, new, where, allowed):
    np.save(tmp_path / "a.npy", np.zeros(4))
    with pytest.raises(InputError) as refused:
        single.solve_scene(scene(tmp_path, old, new))
    assert f"{where}: given" in str(refused.value)
    assert allowed in str(refused.value)


def test_campaign_of_maps(tmp_path):
    text = """\
name: maps
seed: 1
realisations: 2
scene:
  dimension: 2
  body: {poissons_ratio: 0.33}
  roughness: {method: psd, hurst: 0.8, rms_gradient: 0.01}
  interface: {hard_wall: {}}
  loading: {reduced_pressure: 0.05}
reference: {eps_c: 1/2, eps_f: 1/8, eps_t: 1/2}
limits: {eps_c: [1, 1/4]}
"""
    (tmp_path / "maps.yaml").write_text(text)
    dataset = run(tmp_path / "maps.yaml", output=tmp_path / "out", workers=0)
    assert dataset["nx"].values.tolist() == [64, 32, 128]
    assert (dataset["status"] == Status.ok).all()
    assert ((dataset["kappa"] > 1.5) & (dataset["kappa"] < 3.0)).all()
    assert dataset["kappa_edges"].isnull().all()
