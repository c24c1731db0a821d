"""Bodies with a topography: against exact solutions, the conditions on the true surface, and finite elements."""

import numpy as np
import pytest
import slab_stiffness
from finite_elements import Body, graded
from inner_fields import inside

from gfmd_numba.elasticity import topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options

NX = 256
X = np.arange(NX) / NX
WAVE = np.cos(2 * np.pi * X)
BUMPY = 0.6 * WAVE + 0.4 * np.sin(6 * np.pi * X)
PRESSURE = 1.0 + np.cos(2 * np.pi * X) + 0.3 * np.sin(4 * np.pi * X)
BODIES = [ElasticBody(0.33, 1.0), ElasticBody(0.0, 0.2), ElasticBody(0.5, 0.3), ElasticBody(0.33, None)]


def displaced(pressure, body):
    """Both displacements of a flat body under a pressure."""
    return body.response(pressure.shape).apply(np.stack((0 * pressure, -pressure)))


def orders(errors, steps=(2.0, 2.0)):
    return np.log2(errors[:-1] / errors[1:]) / np.log2(steps)


@pytest.mark.parametrize("body", BODIES)
def test_a_body_that_is_not_pressed_or_flat_is_left_alone(body):
    for pressure, heights in ((0 * X, 0.01 * BUMPY), (PRESSURE, 0 * X)):
        response = topography.respond(pressure, heights, body, 3)
        assert not response.along.any()
        assert not response.u3.any()
    assert topography.respond(PRESSURE, 0.01 * BUMPY, body, 0).highest_order == 0.0


@pytest.mark.parametrize("order", [1, 2])
def test_short_waves_together_make_none_that_only_the_grid_sees(order):
    """The waves that a coarse grid holds are those of a fine one, whichever longer wave a product would look like."""
    found = []
    for n in (8, 64):
        x = 6 * np.pi * np.arange(n) / n
        given = 0.01 * np.array([np.cos(x + 0.4), np.cos(x), np.sin(x)])
        response = topography.respond(given[0], given[1], ElasticBody(0.3, None), order, given[2:])
        found.append([grid.coefficients(field)[:4] for field in (response.along[0], response.u3)])
    np.testing.assert_allclose(*found, atol=1e-13 * np.abs(found[1]).max())


@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_uniform_topography_is_a_higher_slab(order):
    nu, a, errors = 0.3, 0.5, []
    for height in (0.04, 0.02, 0.01):
        low, high = displaced(PRESSURE, ElasticBody(nu, a)), displaced(PRESSURE, ElasticBody(nu, a + height))
        response = topography.respond(PRESSURE, np.full(NX, height), ElasticBody(nu, a), order)
        errors.append([abs(response.along[0] - (high - low)[0]).max(), abs(response.u3 - (high - low)[1]).max()])
    assert (orders(np.array(errors), [[2.0], [2.0]]) > order + 0.5).all()


@pytest.mark.parametrize("body", BODIES)
def test_the_true_surface_bears_the_pressure_at_the_highest_order(body):
    """(sigma_13, sigma_33) - h' (sigma_11, sigma_13) = (0, -p) at z = h, to the next order in the slope."""
    order, errors = 3, []
    for size in (0.02, 0.01, 0.005):
        heights = size * BUMPY
        surface = topography.rough_surface(np.stack((0 * X, -PRESSURE)), heights, body, order)
        at = inside(surface, np.array([0.0]), body)
        slope = grid.signal(1j * grid.wavenumbers(NX) * grid.coefficients(heights), NX)
        shear = at.stress5[0] - slope * at.stress1[0]
        normal = at.stress3[0] - slope * at.stress5[0] + PRESSURE
        errors.append([abs(shear).max(), abs(normal).max()])
    shear, normal = np.transpose(errors)
    assert (orders(shear) > order + 0.8).all()
    assert (normal < 1e-12).all() or (orders(normal) > order + 0.8).all()


SHEAR = 0.5 * np.sin(2 * np.pi * X + 0.4) + 0.2 * np.cos(4 * np.pi * X) + 0.3


@pytest.mark.parametrize(
    "body", [*BODIES[:3], ElasticBody.layered((0.3, 0.2), (Material(1.0, 0.3), Material(4.0, 0.1)), None)]
)
@pytest.mark.parametrize("order", [0, 1, 2])
def test_the_true_surface_bears_a_tangential_traction_too(body, order):
    """(sigma_13, sigma_33) - h' (sigma_11, sigma_13) = (t, -p) at z = h, to the next order in the slope."""
    errors = []
    for size in (0.02, 0.01, 0.005):
        heights = size * BUMPY
        surface = topography.rough_surface(np.stack((SHEAR, -PRESSURE)), heights, body, order)
        at = inside(surface, np.array([0.0]), body)
        slope = grid.signal(1j * grid.wavenumbers(NX) * grid.coefficients(heights), NX)
        shear = at.stress5[0] - slope * at.stress1[0] - SHEAR
        normal = at.stress3[0] - slope * at.stress5[0] + PRESSURE
        errors.append([abs(shear).max(), abs(normal).max()])
    for found in np.transpose(errors):
        assert (orders(found) > order + 0.8).all()


@pytest.mark.parametrize("body", BODIES[:3])
def test_fields_at_labels_meet_surface_and_base(body):
    response = topography.respond(PRESSURE, 0.01 * BUMPY, body, 2)
    surface = topography.rough_surface(np.stack((0 * X, -PRESSURE)), 0.01 * BUMPY, body, 2)
    u1, u3 = displaced(PRESSURE, body)
    found = inside(surface, np.array([0.0, -body.aspect_ratio]), body)
    np.testing.assert_allclose(found.u1[0], u1 + response.along[0], atol=1e-12)
    np.testing.assert_allclose(found.u3[0], u3 + response.u3, atol=1e-12)
    assert abs(found.u1[1]).max() + abs(found.u3[1]).max() < 1e-12 * abs(found.u1).max()


@pytest.mark.parametrize("nu", [0.0, 0.33, 0.5])
def test_forming_a_topography_takes_the_stiffness_times_it(nu):
    """(5.15) with the sign that holds the topography: F = q C11 M u''."""
    body, heights = ElasticBody(nu, 0.3), 0.01 * BUMPY
    stress = inside(topography.formed_surface(heights, body), np.array([0.0]), body)
    k = body.response((NX,))
    waves = grid.coefficients(heights)
    waves[0] = 0.0
    normal = np.where(np.isfinite(k.normal), k.normal, 0.0) * waves
    np.testing.assert_allclose(stress.stress3[0], grid.signal(normal, NX), atol=1e-13)
    np.testing.assert_allclose(stress.stress5[0], grid.signal(1j * k.elements[1] * waves, NX), atol=1e-13)


def pressed(heights, body, displacement, order):
    """Pressure and both displacements of a rough body under a flat punch, by repeated contact of the flat one."""
    raised = np.zeros(len(heights))
    k = slab_stiffness.slab(grid.wavenumbers(len(heights)), body.poissons_ratio, body.aspect_ratio)
    numerics = Options("conjugate_gradients", residual=1e-10)
    for _ in range(8):
        wall = heights.max() - heights - displacement - raised
        found = equilibrate(wall[np.newaxis], SpectralResponse.of_normal(k), None, numerics)
        response = topography.respond(found.pressure[0], heights, body, order)
        raised = response.u3
    normal = found.displacement[0] + response.u3
    return found.pressure[0], displaced(found.pressure[0], body)[0] + response.along[0], normal


def by_finite_elements(heights, body, displacement, columns, guess):
    """Nodes, tangential and normal displacement and pressure of the same contact; the mesh has the rough top."""
    nx = len(heights)
    over = nx // (2 * columns)
    height = body.aspect_ratio

    def stretched(x, z):
        return np.zeros_like(x), heights[np.rint(x * nx).astype(int) % nx] * (z + height) / height

    mesh = Body(columns, graded(height, 20, 0.5 / columns), body.poissons_ratio, stretched)
    clearance = (heights.max() - heights - displacement)[::over]
    solution = mesh.press(clearance, guess[::over])
    return *mesh.along_top(solution), -mesh.traction(solution)


@pytest.mark.long
def test_flattened_sinusoid_is_that_of_finite_elements():
    """Thesis 5.3.2 at half its amplitude: order 0 is 5e-6 L_x off, order 2 is as near as the mesh to a finer one."""
    nx, columns, body = 2048, 256, ElasticBody(0.33, 1.0)
    heights = -0.005 * np.cos(2 * np.pi * np.arange(nx) / nx)
    found = [pressed(heights, body, 1.65e-3, order) for order in (0, 1, 2)]
    fem1, fem3, fem_pressure = by_finite_elements(heights, body, 1.65e-3, columns, found[2][0] > 0.0)
    over = nx // (2 * columns)
    errors = np.array([(abs(u1[::over] - fem1).max(), abs(u3[::over] - fem3).max()) for _, u1, u3 in found])
    assert errors[0, 0] > 4e-6
    assert errors[1, 0] < 1e-6
    assert (errors[2] < 1e-6).all()
    pressure = found[2][0]
    assert pressure.mean() == pytest.approx(fem_pressure.mean(), rel=1e-3)
    assert abs(pressure[::over] - fem_pressure).max() < 1e-3  # E*, largest at the edges of the contact
