"""Interfaces of two dimensions: closed forms, the profile they contain, symmetry and refinement."""

import numpy as np
import pytest
import slab_stiffness

from gfmd_numba.contact import evaluation, solution
from gfmd_numba.contact.state import Contact
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.roughness import self_affine, statistics
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options
from support.maps import body, press, problem, rough

SOLVERS = ("active_set_newton", "conjugate_gradients")


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("slab", [None, (0.33, 0.1), (0.5, 0.05)])
def test_a_profile_extruded_along_y_is_pressed_like_the_profile(solver, slab):
    heights = self_affine.SelfAffineWaves(0.5, 2, 16).heights((64,), 1, range(2))
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
    # of maps whose waves have one length: the least that there is (Nayak, J. Lubr. Technol. 93:398, 1971)
    assert evaluation.nayak(Contact(-punch, punch, above))[0] == pytest.approx(1.5)


def test_a_paraboloid_makes_the_point_contact_of_hertz():
    """a^3 = 3 F R / 4 E*."""
    n, a = 192, 12.0 / 192
    x = np.arange(n) / n - 0.5
    punch = 0.5 * (x**2 + x[:, np.newaxis] ** 2)[np.newaxis]  # R = L_x
    load = 4.0 / 3.0 * a**3
    found = press(punch, load)
    assert found.pressure.max() == pytest.approx(1.5 * load / (np.pi * a**2), rel=0.01)
    assert evaluation.n_segments(Contact(-punch, punch, found))[0] == 1


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
    mean = found.displacement.mean() + 0.05 / slab_stiffness.uniform(*slab)
    by_displacement = equilibrate(
        punch - mean, SpectralResponse.of_normal(body(punch.shape[1:], slab)), None, Options("active_set_newton")
    )
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
    coarse, fine = (self_affine.SelfAffineWaves(0.5, 2, cut_off).heights((nx, nx), 5, range(2)) for nx in (32, 96))
    if 2 * cut_off < 32:  # at Nyquist the coarser grid sees one phase of the shortest waves
        np.testing.assert_allclose(fine[:, ::3, ::3], coarse, atol=1e-15)
    np.testing.assert_allclose(statistics.rms_gradient(fine, (1.0, 1.0)), 1.0, rtol=1e-12)
    np.testing.assert_allclose(coarse.mean(axis=(1, 2)), 0.0, atol=1e-16)


def test_more_waves_are_added_to_the_map():
    few, many = (self_affine.SelfAffineWaves(0.5, 2, cut_off).heights((64, 64), 5, range(1)) for cut_off in (8, 16))
    ratio = np.fft.rfft2(many[0])[:5, 1:6] / np.fft.rfft2(few[0])[:5, 1:6]
    np.testing.assert_allclose(ratio, ratio[0, 0].real, atol=1e-9)


def test_clusters_and_perimeter_are_counted_on_the_torus():
    """A plus of five nodes across a corner, a pair across an edge, one node that meets the plus at a corner only."""
    flags = np.zeros((1, 8, 8), dtype=bool)
    flags[0, [0, 0, 0, 1, 7], [0, 1, 7, 0, 0]] = True
    flags[0, 4, [0, 7]] = True
    flags[0, 2, 1] = True
    pressure = flags.astype(float)
    equilibrium = press(np.zeros((1, 8, 8)), 1.0)
    made = Contact(pressure, pressure, type(equilibrium)(**{**vars(equilibrium), "touching": flags}))
    assert evaluation.n_segments(made).tolist() == [3]
    assert [sides.tolist() for sides in evaluation.perimeter(made)] == [[6 + 2 + 2], [6 + 4 + 2]]


def test_rms_gradient_over_the_contact_is_that_of_the_surface_in_full_contact():
    made = solution.solve(problem(load=20.0), range(1))
    assert made.equilibrium.touching.all()
    assert evaluation.rms_gradient_contact(made) == pytest.approx(evaluation.rms_gradient(made), rel=1e-12)
    assert evaluation.contact_area_fraction(made) == 1.0
    assert evaluation.n_segments(made) == 0


def test_tamaas_finds_the_same_contact_of_a_map():
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
