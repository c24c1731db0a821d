"""Strains by eigenstrains in sublayers: stresses of a pressure, symmetry, positivity and reciprocity."""

import numpy as np
import pytest

from gfmd_numba.elasticity import fields
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.eigenstrain import Sublayers

THICKNESS = np.array([0.05, 0.1, 0.02, 0.3])


def inner(one, other, thickness=THICKNESS):
    """Product of two deviatoric tensors, mean over the surface and integral over the depth."""
    yy = (one[0] + one[1]) * (other[0] + other[1])
    whole = one[0] * other[0] + one[1] * other[1] + yy + 2.0 * (one[2:] * other[2:]).sum(axis=0)
    return float(thickness @ whole.mean(axis=(1, 2)))


def smooth(rng, shape, lead=()):
    """Random fields without the Nyquist waves."""
    found = fields.grid.coefficients(rng.normal(size=(*lead, *shape)), 2)
    return fields.grid.signal(fields.grid.without_nyquist(found, shape), *shape)


@pytest.mark.parametrize("shape", [(12,), (6, 8), (5, 9)])
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_strains_under_a_pressure_are_means_of_the_fields_inside(shape, nu):
    layers, body = Sublayers(shape, THICKNESS, nu), ElasticBody(nu, None)
    pressure = 1.0 + smooth(np.random.default_rng(1), layers.shape)
    layers.surface_displacement(np.zeros((layers.components, 4, *layers.shape)))
    found = layers.strains(pressure, with_normal=True)
    tractions = np.stack((0.0 * pressure, 0.0 * pressure, -pressure))
    surface = fields.surface_under_tractions(tractions, body)
    places, weights = np.polynomial.legendre.leggauss(8)
    tops = np.append(0.0, np.cumsum(THICKNESS))
    for j in range(4):
        depths = 0.5 * (tops[j] + tops[j + 1]) + 0.5 * THICKNESS[j] * places
        planes = [fields.Inside((surface,), body).plane(-depth, fields.STRESSES) for depth in depths]
        s1, s2, s3, s4, s5, s6 = np.tensordot(0.5 * weights, planes, 1)
        mean = (s1 + s2 + s3) / 3.0
        expected = np.stack((s1 - mean, s3 - mean, s5, s6, s4)[: layers.components])
        np.testing.assert_allclose(2.0 * layers.shear * found[:-1, j], expected, atol=1e-8)
        np.testing.assert_allclose(found[-1, j], s3, atol=1e-8)


@pytest.mark.parametrize(("shape", "nu"), [((8,), 0.3), ((3, 4), 0.3), ((2, 3), 0.5), ((2, 3), -0.5)])
def test_energy_of_eigenstrains_is_symmetric_and_positive(shape, nu):
    layers = Sublayers(shape, THICKNESS, nu)
    unit, free, columns = np.zeros((layers.components, 4, *layers.shape)), np.zeros(layers.shape), []
    for i in range(unit.size):
        unit.flat[i] = 1.0
        layers.surface_displacement(unit)
        columns.append(layers.strains(free).ravel())
        unit.flat[i] = 0.0
    of_components = 2.0 * np.eye(layers.components)
    of_components[0, 1] = of_components[1, 0] = 1.0  # yy = -xx - zz
    metric = np.kron(of_components, np.kron(np.diag(THICKNESS), np.eye(free.size) / free.size))
    of_strains = metric @ np.transpose(columns)
    np.testing.assert_allclose(of_strains, of_strains.T, atol=1e-15)
    root = np.linalg.inv(np.linalg.cholesky(metric))
    shares = np.linalg.eigvalsh(root @ of_strains @ root.T)  # of an eigenstrain that strains follow
    assert shares[0] >= -1e-12
    assert shares[-1] <= 1.0 + 1e-12


def test_what_a_pressure_does_to_eigenstrains_they_do_to_the_surface():
    shape, rng = (6, 8), np.random.default_rng(4)
    layers, pressure, eigenstrain = Sublayers(shape, THICKNESS, 0.3), smooth(rng, shape), rng.normal(size=(5, 4, 6, 8))
    pressure -= pressure.mean()  # under which the surface has no place
    out = layers.surface_displacement(eigenstrain)
    both = layers.strains(pressure)
    layers.surface_displacement(eigenstrain)
    stress = 2.0 * layers.shear * (both - layers.strains(0.0 * pressure))
    assert float((pressure * out).mean()) == pytest.approx(-inner(stress, eigenstrain), rel=1e-12)


def test_rows_of_a_map_that_are_alike_are_profiles():
    shape, rng = (4, 8), np.random.default_rng(5)
    profile, whole = Sublayers((8,), THICKNESS, 0.3), Sublayers(shape, THICKNESS, 0.3)
    eigenstrain, pressure = rng.normal(size=(3, 4, 1, 8)), rng.random((1, 8))
    along = np.concatenate((eigenstrain, np.zeros((2, 4, 1, 8)))).repeat(4, axis=2)
    np.testing.assert_allclose(
        whole.surface_displacement(along), profile.surface_displacement(eigenstrain).repeat(4, axis=0), atol=1e-15
    )
    found = whole.strains(pressure.repeat(4, axis=0))
    np.testing.assert_allclose(found[:3], profile.strains(pressure).repeat(4, axis=2), atol=1e-14)
    assert abs(found[3:]).max() < 1e-14
