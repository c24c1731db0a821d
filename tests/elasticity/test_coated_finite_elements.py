"""A coated body is that of the finite-element reference, to the mesh's error and converging with it."""

import numpy as np
import pytest
from finite_elements import Body
from inner_fields import inside

from gfmd_numba.elasticity import fields
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from gfmd_numba.solvers.equilibrium import equilibrate
from gfmd_numba.solvers.table import Options

COATING, BELOW = 0.1, 0.3
HARD, SOFT = Material(1.0, 0.2), Material(0.02, 0.45)
STACKS = {
    "hard on soft": ElasticBody.layered((COATING, BELOW), (HARD, SOFT), None),
    "soft on hard": ElasticBody.layered((COATING, BELOW), (Material(1.0, 0.45), Material(50.0, 0.2)), None),
}


def coated(columns, z_edges, stack):
    """A mesh whose elements above the interface are of one material and those below of another."""

    def materials(depth):
        found = stack.material(depth)
        return found.modulus, found.poissons_ratio

    return Body(columns, z_edges, None, materials=materials)


def edges(rows):
    return np.concatenate((np.linspace(-COATING - BELOW, -COATING, rows)[:-1], np.linspace(-COATING, 0.0, rows)))


@pytest.mark.long
@pytest.mark.parametrize("name", STACKS)
def test_a_coated_body_pressed_everywhere_converges_to_the_fields_inside(name):
    body, errors = STACKS[name], []
    for columns, rows in ((8, 7), (16, 13)):
        mesh = coated(columns, edges(rows), body)
        wave = -0.01 - 1e-3 * np.cos(2 * np.pi * mesh.x)
        solution = mesh.press(wave, np.ones(len(mesh.top), dtype=bool))
        x, z, u1, u3, *_ = mesh.inside(solution)
        nx = 2 * columns
        levels, row = np.unique(np.round(z, 12), return_inverse=True)
        normal = -0.01 - 1e-3 * np.cos(2 * np.pi * np.arange(nx) / nx)
        traction = grid.signal(body.condensed_stiffness(grid.wavenumbers(nx)) * grid.coefficients(normal), nx)
        under = fields.surface_under_tractions(np.stack((0 * traction, traction)), body)
        exact = inside(under, levels, body)
        column = np.rint(x * nx).astype(int)
        found = [abs(each - true[row, column]).max() for each, true in ((u1, exact.u1), (u3, exact.u3))]
        along_top = mesh.traction(solution)
        found.append(abs(along_top - traction).max() / abs(traction).max())
        errors.append(found)
    errors = np.array(errors)
    assert (errors[-1] < [1e-6, 1e-6, 4e-3]).all(), errors  # of displacements of 1e-2
    assert (np.log2(errors[:-1, :2] / errors[1:, :2]) > 1.7).all(), errors


@pytest.mark.long
def test_contact_of_a_coated_body_with_a_sinusoid_converges_to_that_of_the_spectral_solver():
    nx, delta, body, errors = 1024, 2e-3, STACKS["soft on hard"], []
    wall = 0.005 * (1 - np.cos(2 * np.pi * (np.arange(nx) / nx - 0.5))) - delta
    k = body.condensed_stiffness(grid.wavenumbers(nx))
    found = equilibrate(
        wall[np.newaxis], SpectralResponse.of_normal(k), None, Options("conjugate_gradients", residual=1e-9)
    )
    assert found.status[0] == 0
    touching = (found.pressure[0] > 0).mean()
    assert 0.05 < touching < 0.5
    lengths = []
    for columns, rows in ((16, 7), (32, 13), (64, 25)):
        over = nx // (2 * columns)
        mesh = coated(columns, edges(rows), body)
        solution = mesh.press(wall[::over], wall[::over] < 0.0)
        errors.append(abs(mesh.along_top(solution)[1] - found.displacement[0][::over]).max())
        lengths.append(solution.touching.mean())
    assert errors[-1] < 2e-5, errors  # of second order in the size of the elements: at half of it 5e-6
    assert errors[-1] < errors[0] / 4, errors
    assert lengths[-1] == pytest.approx(touching, abs=2 / 128)
