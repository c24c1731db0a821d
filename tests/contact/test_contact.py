"""Contacts against closed forms, against each other's solvers, and under a change of units."""

import numpy as np
import pytest
import slab_stiffness
import textbook

import gfmd_numba
from gfmd_numba.contact.area_correction import HALF_SPACE
from gfmd_numba.elasticity import stiffness
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.roughness import self_affine
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options
from gfmd_numba.theory import closed_forms
from support.contacts import press, scene_file

SOLVERS = ["verlet", "conjugate_gradients", "active_set_newton", "gronbech_jensen", "fire"]
AMPLITUDE = 0.01


def westergaard_errors(nx, load, solver):
    """Errors of the pressure over its peak (rms, and largest beyond 4 nodes from an edge), of the node count."""
    x = np.arange(nx) / nx - 0.5
    pressure = press(AMPLITUDE * np.cos(2 * np.pi * x), load, solver).pressure[0]
    exact = closed_forms.westergaard_pressure(x, load, AMPLITUDE)
    half_width = closed_forms.westergaard_half_width(load, AMPLITUDE)
    error = abs(pressure - exact) / exact.max()
    inside = abs(abs(x) - half_width) > 4 / nx
    return np.sqrt((error**2).mean()), error[inside].max(), (pressure > 0).sum() - 2 * half_width * nx


LOADS = np.linspace(0.05, 0.6, 12) * np.pi * AMPLITUDE


@pytest.mark.parametrize("solver", [pytest.param(x, marks=pytest.mark.long) if x == "fire" else x for x in SOLVERS])
def test_the_contact_of_a_wave_is_westergaards(solver):
    """Within 1e-3 of the peak (the square-root edge itself is unresolved), contact length within one spacing."""
    errors = np.array([westergaard_errors(1024, load, solver) for load in LOADS])
    assert errors[:, 0].max() < 1e-3
    assert errors[:, 1].max() < 1e-3
    corrected = errors[:, 2] - 2 * HALF_SPACE.excess
    assert abs(corrected).max() < 1.0
    assert abs(corrected.mean()) < 0.35  # the count alone is 0.38 too long on average


def test_westergaard_converges_with_order_one():
    rms = [np.median([westergaard_errors(nx, load, "verlet")[0] for load in LOADS]) for nx in (128, 2048)]
    order = np.log(rms[0] / rms[1]) / np.log(16)
    assert 0.9 < order < 1.4


def test_a_cylinder_makes_the_line_contact_of_hertz():
    nx, radius = 8192, 1.0
    x = np.arange(nx) / nx - 0.5
    for half_width in (0.015, 0.02, 0.025):
        load = np.pi * half_width**2 / (4 * radius)
        pressure = press(-(x**2) / (2 * radius), load).pressure[0]
        exact = textbook.hertz_line_pressure(x, load, radius)
        length = 2 * textbook.hertz_line_half_width(load, radius)
        assert np.sqrt(((pressure - exact) ** 2).mean()) < 1e-3 * exact.max()
        assert abs((pressure > 0).sum() - 2 * HALF_SPACE.excess - length * nx) < 1.0


@pytest.mark.parametrize("solver", SOLVERS)
def test_full_contact_is_linear(solver):
    heights = self_affine.SelfAffineWaves(0.8, 2, 32).heights((256,), 1, range(2))
    body = stiffness.half_space(grid.wavenumbers(256))
    result = press(heights, 5.0, solver)
    exact = 5.0 + grid.signal(body * grid.coefficients(heights), 256)
    assert exact.min() > 0.0
    np.testing.assert_allclose(result.pressure, exact, rtol=1e-9)


def test_all_solvers_find_the_same_contact():
    """Also the slab, and from light to nearly full contact."""
    q = grid.wavenumbers(256)
    for hurst, body in ((0.3, stiffness.half_space(q)), (0.8, slab_stiffness.slab(q, 0.49, 0.05))):
        heights = self_affine.SelfAffineWaves(hurst, 2, 64).heights((256,), 2, range(1))
        for load in (0.007, 0.3, 1.0):
            verlet, *others = (press(heights, load, solver, body).pressure for solver in SOLVERS)
            for other in others:
                np.testing.assert_array_equal(other > 0, verlet > 0)
                np.testing.assert_allclose(other, verlet, atol=1e-6 * verlet.max())


@pytest.mark.parametrize("nx", [16, pytest.param(64, marks=pytest.mark.long)])
@pytest.mark.parametrize("load", [1e-6, 1e-3, 0.0032, 0.01, 10.0])
def test_one_or_two_touching_nodes_and_full_contact_are_solved(nx, load):
    """Where conjugate directions go stale or vanish, and every solver still has to end with the same contact."""
    heights = np.concatenate(
        [self_affine.SelfAffineWaves(hurst, 1, nx // 4).heights((nx,), 3, range(10)) for hurst in (0, 0.5, 1)]
    )
    verlet, *others = (press(heights, load, solver, residual=1e-8).pressure for solver in SOLVERS)
    for other in others:
        np.testing.assert_array_equal(other > 0, verlet > 0)


@pytest.mark.parametrize(
    ("nu", "aspect_ratio", "load"),
    [(0.5, 1e-4, 0.3), (0.5, 3e-4, 0.02), (0.33, 1e-3, 0.02), (0.33, np.inf, 1e-7)],
)
def test_the_load_is_carried_however_small(nu, aspect_ratio, load):
    """Where the pressure of full contact is no measure of the pressures that matter."""
    heights, q = self_affine.SelfAffineWaves(0.8, 2, 64).heights((256,), 3, range(1)), grid.wavenumbers(256)
    body = stiffness.half_space(q) if np.isinf(aspect_ratio) else slab_stiffness.slab(q, nu, aspect_ratio)
    solvers = SOLVERS[:3] if np.isinf(aspect_ratio) else SOLVERS[1:3]  # dynamics of thin slabs take seconds
    results = [press(heights, load, solver, body, residual=1e-8) for solver in solvers]
    for result in results:
        np.testing.assert_allclose(result.pressure.mean(axis=1), load, rtol=2e-8)
        np.testing.assert_array_equal(result.touching, results[0].touching)


def test_area_grows_with_load():
    heights = self_affine.SelfAffineWaves(0.8, 2, 64).heights((256,), 3, range(3))
    areas = np.array([(press(heights, load).pressure > 0).sum(axis=1) for load in np.logspace(-3, 1, 9)])
    assert (np.diff(areas, axis=0) >= 0).all()
    assert (areas[-1] == 256).all()
    assert (areas[0] < 10).all()


@pytest.mark.parametrize(
    ("nu", "solvers"), [(0.3, SOLVERS), (0.49, SOLVERS), (0.5, ["conjugate_gradients", "active_set_newton"])]
)
def test_displacement_control_inverts_load_control(nu, solvers):
    """The punch displacement that a load produces reproduces that load and contact."""
    nx, a, load = 256, 0.2, 0.05
    heights = self_affine.SelfAffineWaves(0.8, 2, 32).heights((nx,), 4, range(1))
    body = slab_stiffness.slab(grid.wavenumbers(nx), nu, a)
    by_load = press(heights, load, body=body)
    punch = heights.max() - heights
    # what the load adds to the displacement is its mean: the slab is compressed by load / K(0)
    compression = load / body[0]
    displacement = by_load.displacement.mean() + compression
    for solver in solvers:
        by_displacement = equilibrate(
            punch - displacement, SpectralResponse.of_normal(body), None, Options(solver, residual=1e-10)
        )
        assert by_displacement.status[0] == 0
        np.testing.assert_array_equal(by_displacement.pressure > 0, by_load.pressure > 0)
        assert by_displacement.pressure.mean() == pytest.approx(load, rel=1e-6)


def test_solve_returns_fields_in_equilibrium():
    """Fields in SI units obey the slab's stiffness, mean compression included."""
    length, modulus, nu, a = 1e-4, 70e9, 0.33, 0.3
    result = gfmd_numba.solve(scene_file(length, modulus))
    n, e_star = result.sizes["x"], modulus / (1 - nu**2)
    assert n == 512
    assert {result[name].attrs["units"] for name in ("height", "displacement", "gap", "x")} == {"m"}
    assert result["pressure"].attrs["units"] == "Pa"
    assert float(result["x"][1]) == pytest.approx(length / n)
    body = slab_stiffness.slab(grid.wavenumbers(n), nu, a) * e_star / length
    restored = grid.signal(-body * grid.coefficients(result["displacement"].values), n)
    np.testing.assert_allclose(restored, result["pressure"], atol=1e-6 * float(result["pressure"].max()))
    assert float(result["rms_gradient"]) == pytest.approx(0.02)
    assert float(result["mean_pressure"]) == pytest.approx(0.05 * 0.02 * e_star, rel=1e-6)
    together = result["height"] + result["displacement"] + result["gap"]
    np.testing.assert_allclose(together, together[0], rtol=1e-9)
    assert float(result["gap"].min()) == 0.0
    kappa = float(result["contact_area_fraction"]) / 0.05
    assert float(result["kappa"]) == pytest.approx(kappa, rel=1e-6)


@pytest.mark.filterwarnings("ignore:.*A number without a unit")
@pytest.mark.parametrize(("length", "modulus"), [(1e-9, 1e15), (1e3, 1e-3)])
def test_units_do_not_matter(length, modulus):
    plain, other = gfmd_numba.solve(scene_file()), gfmd_numba.solve(scene_file(length, modulus))
    for name in ("kappa", "kappa_r", "contact_area_fraction", "nayak", "residual"):
        assert float(other[name]) == pytest.approx(float(plain[name]), rel=1e-12)
    np.testing.assert_allclose(other["height"], plain["height"] * length, rtol=1e-12)
    e_star = modulus / (1 - 0.33**2)
    np.testing.assert_allclose(other["pressure"], plain["pressure"] * e_star, rtol=1e-12)


def test_plane_stress_is_plane_strain_with_other_constants():
    """E and nu / (1 + nu) in place of E / (1 - nu^2) and nu."""
    nu, modulus = 0.4, 70e9
    body = {"youngs_modulus": modulus, "poissons_ratio": nu, "aspect_ratio": 0.1, "state": "plane_stress"}
    stress = gfmd_numba.solve(scene_file(1e-4, body=body))
    alike = nu / (1 + nu)
    body = {"youngs_modulus": modulus * (1 - alike**2), "poissons_ratio": alike, "aspect_ratio": 0.1}
    strain = gfmd_numba.solve(scene_file(1e-4, body=body))
    for name in ("kappa", "mean_pressure"):
        assert float(stress[name]) == pytest.approx(float(strain[name]), rel=1e-12)
    np.testing.assert_allclose(stress["displacement"], strain["displacement"], rtol=1e-10, atol=1e-16)
    assert float(stress["mean_pressure"]) == pytest.approx(0.05 * 0.02 * modulus, rel=1e-6)


def test_contact_does_not_depend_on_the_gradient():
    steep = scene_file(roughness={"method": "psd", "hurst": 0.8, "rms_gradient": 0.2})
    plain, other = gfmd_numba.solve(scene_file()), gfmd_numba.solve(steep)
    assert float(plain["kappa"]) == float(other["kappa"])
    np.testing.assert_allclose(other["pressure"], 10 * plain["pressure"], rtol=1e-12)


def test_displacement_is_in_units_of_length():
    by_load = gfmd_numba.solve(scene_file(1e-4))
    lowest = float(by_load["height"].max())
    down = lowest - float((by_load["height"] + by_load["displacement"]).max())
    by_displacement = gfmd_numba.solve(scene_file(1e-4, loading={"displacement": down}))
    assert float(by_displacement["kappa"]) == pytest.approx(float(by_load["kappa"]), rel=1e-5)
    np.testing.assert_allclose(by_displacement["displacement"], by_load["displacement"], atol=1e-6 * down)


@pytest.mark.long
def test_measured_profile_is_taken_as_it_is(tmp_path):
    x = np.arange(256) / 256
    heights = 2e-6 * np.cos(2 * np.pi * x) + 1e-6
    np.save(tmp_path / "profile.npy", heights)
    np.savetxt(tmp_path / "profile.csv", heights)
    gfmd_numba.solve(scene_file(1e-4)).to_netcdf(tmp_path / "other.nc")
    results = []
    for name in ("profile.npy", "profile.csv"):
        rough = {"method": "measured", "file": str(tmp_path / name), "units": {"z": "m"}}
        scene = scene_file(1e-4, 1e9, roughness=rough)
        del scene["discretisation"], scene["seed"]
        results.append(gfmd_numba.solve(scene))
    np.testing.assert_array_equal(results[0]["pressure"], results[1]["pressure"])
    np.testing.assert_allclose(results[0]["height"], heights, rtol=1e-12)
    amplitude = 2e-6 / 1e-4
    load = 0.05 * 2 * np.pi * amplitude / np.sqrt(2)  # in E*
    e_star = 1e9 / (1 - 0.33**2)
    assert float(results[0]["mean_pressure"]) == pytest.approx(load * e_star, rel=1e-6)
    scene["scene"]["roughness"] = {"method": "measured", "file": str(tmp_path / "other.nc")}
    again = gfmd_numba.solve(scene)
    np.testing.assert_allclose(again["height"], gfmd_numba.solve(scene_file(1e-4))["height"], rtol=1e-12)
