"""The finite-element reference converges, and to closed forms, before anything is held against it."""

import numpy as np
import pytest
import slab_stiffness
from finite_elements import Body, graded
from inner_fields import inside

from gfmd_numba.elasticity import fields
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options


def test_rows_grow_from_the_top():
    edges = graded(1.0, 20, 0.01)
    heights = np.diff(edges)
    assert (edges[0], edges[-1]) == (-1.0, 0.0)
    assert heights[-1] == pytest.approx(0.01)
    np.testing.assert_allclose(heights[1:-1] / heights[2:], heights[-2] / heights[-1], rtol=1e-6)


@pytest.mark.long
def test_stresses_inside_a_flat_slab_converge():
    nu, a, errors = 0.3, 0.5, []
    for columns, rows in ((8, 8), (16, 16), (32, 32)):
        mesh = Body(columns, np.linspace(-a, 0, rows + 1), nu)
        held = np.ones(len(mesh.top), dtype=bool)
        wave = -0.01 - 1e-3 * np.cos(2 * np.pi * mesh.x)  # pressed everywhere: no node pulls
        solution = mesh.press(wave, held)
        assert solution.iterations == 1
        x, z, u1, u3, s1, s3, s5 = mesh.inside(solution)
        nx = 2 * columns
        levels, row = np.unique(np.round(z, 12), return_inverse=True)
        normal = -0.01 - 1e-3 * np.cos(2 * np.pi * np.arange(nx) / nx)
        k = slab_stiffness.slab(grid.wavenumbers(nx), nu, a)
        traction = grid.signal(k * grid.coefficients(normal), nx)
        under = fields.surface_under_tractions(np.stack((0 * traction, traction)), ElasticBody(nu, a))
        exact = inside(under, levels, ElasticBody(nu, a))
        column = np.rint(x * nx).astype(int)
        pairs = ((u1, exact.u1), (u3, exact.u3), (s1, exact.stress1), (s3, exact.stress3), (s5, exact.stress5))
        errors.append([abs(found - true[row, column]).max() for found, true in pairs])
    errors = np.array(errors)
    assert (errors[-1] < [2e-7, 2e-7, 2e-5, 2e-5, 2e-5]).all(), errors
    assert (np.log2(errors[:-1] / errors[1:]) > 1.7).all(), errors


def test_rough_top_is_a_slab_of_its_height():
    mesh = Body(8, np.linspace(-0.5, 0, 9), 0.3, lambda x, z: (0 * x, 0.2 * (z + 0.5)))
    solution = mesh.press(np.full(len(mesh.top), -0.01), np.ones(len(mesh.top), dtype=bool))
    np.testing.assert_allclose(mesh.traction(solution), -0.01 * slab_stiffness.uniform(0.3, 0.6), rtol=1e-10)


@pytest.mark.long
def test_contact_of_a_wavy_punch_converges_to_that_of_the_spectral_solver():
    nx, delta, body, errors = 1024, 2e-3, ElasticBody(0.3, 0.5), []
    wall = 0.005 * (1 - np.cos(2 * np.pi * (np.arange(nx) / nx - 0.5))) - delta
    k = slab_stiffness.slab(grid.wavenumbers(nx), body.poissons_ratio, body.aspect_ratio)
    found = equilibrate(
        wall[np.newaxis], SpectralResponse.of_normal(k), None, Options("conjugate_gradients", residual=1e-10)
    )
    for columns in (32, 64, 128):
        over = nx // (2 * columns)
        mesh = Body(columns, graded(0.5, 24, 0.5 / columns), body.poissons_ratio)
        solution = mesh.press(wall[::over], wall[::over] < 0.0)
        normal = mesh.along_top(solution)[1]
        errors.append([abs(normal - found.displacement[0][::over]).max()])
    assert errors[2][0] < 5e-6
    assert errors[2][0] < errors[0][0] / 4
