"""Body fields against (2.4) in high precision, equilibrium, boundary conditions and closed forms."""

import mpmath
import numpy as np
import pytest
import slab_stiffness
from inner_fields import inside

from gfmd_numba.elasticity import fields
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid
from support.cases import some_of

RATIOS = [-0.9, 0.0, 0.25, 0.33, 0.4999, 0.4999999999, 0.5]
BODIES = [ElasticBody(nu, a) for nu in (0.0, 0.33, 0.4999999, 0.5) for a in (None, 0.01, 0.3, 1.0, 50.0)]
NX = 64


def exact(k, y, nu):
    """Columns U_1, U_3, P, W for unit U_1 and unit U_3 at the surface, from (2.4) by mpmath."""
    kolosov = 3 - 4 * mpmath.mpf(nu)

    def waves(y):
        sinh, cosh = mpmath.sinh(y), mpmath.cosh(y)
        g1, g2, g3 = kolosov * sinh + y * cosh, y * sinh, kolosov * sinh - y * cosh
        return mpmath.matrix([[g1, -g2], [g2, g3], [-sinh, cosh], [cosh, -sinh]])

    return waves(y) * waves(k)[:2, :] ** -1


@pytest.mark.parametrize("nu", some_of(RATIOS, 0, 3, 6))
def test_transfer_is_2_4(nu):
    for k in [*np.logspace(-5, 2.4, 12), 0.999, 1.001]:
        for part in (0.0, 1e-3, 0.6, 1.0):
            depth = 0.5 * part
            found = ElasticBody(nu, 0.5).layers.transfer(depth, np.array([k / 0.5]))
            with mpmath.workdps(60 + int(k)):
                true = exact(mpmath.mpf(k), mpmath.mpf(k) * (1 - mpmath.mpf(part)), nu)
                for row, pair in enumerate((found.u1, found.u3, found.p, found.w)):
                    # what a wave of the surface amounts to: the larger of its values at depth and near the surface
                    for column in range(2):
                        size = abs(true[row, column]) + mpmath.exp(-k * part) * (1 if row < 2 else 1 / k)
                        allowed = (1e-12 + 1e-14 / k) * size  # tractions on a thin layer are larger by 1/k
                        assert abs(pair[column][0] - true[row, column]) < allowed, (k, part, row, column)


def random_surface(body, seed=1):
    """Surface under both tractions on NX nodes, waves up to NX // 4, and the tractions."""
    rng = np.random.default_rng(seed)
    waves = rng.standard_normal((2, NX // 2 + 1)) + 1j * rng.standard_normal((2, NX // 2 + 1))
    waves[:, 0], waves[:, NX // 4 :] = (0.3, -0.7), 0.0
    tractions = grid.signal(waves, NX)
    return fields.surface_under_tractions(tractions, body), tractions


def along_x(field):
    return grid.signal(1j * grid.wavenumbers(NX) * grid.coefficients(field), NX)


def along_z(body, depth, step):
    """Fields at a depth and their derivatives by sixth-order central differences, checked for having converged."""
    found, _ = random_surface(body)
    levels = inside(found, -depth + step * np.arange(-3, 4), body)
    weights = np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * step)
    slopes = {name: weights @ values for name, values in vars(levels).items()}
    return {name: values[3] for name, values in vars(levels).items()}, slopes


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("part", [0.2, 0.6])
def test_fields_are_in_equilibrium_and_obey_hookes_law(body, part):
    depth = part * min(body.aspect_ratio or 0.1, 0.1)
    here, slope = along_z(body, depth, min(depth / 10, 2e-4))
    nu = body.poissons_ratio
    stress = max(abs(here[name]).max() for name in ("stress1", "stress3", "stress5"))
    gradient = max(abs(along_x(here[f"stress{i}"])).max() for i in (1, 3, 5))
    assert abs(along_x(here["stress1"]) + slope["stress5"]).max() < 1e-8 * gradient
    assert abs(along_x(here["stress5"]) + slope["stress3"]).max() < 1e-8 * gradient
    strain = max(abs(here[f"strain{i}"]).max() for i in (1, 3, 5))
    assert abs(here["strain1"] - along_x(here["u1"])).max() < 1e-12 * strain
    assert abs(here["strain3"] - slope["u3"]).max() < 1e-8 * strain
    assert abs(here["strain5"] - slope["u1"] - along_x(here["u3"])).max() < 1e-8 * strain
    # strains of the stresses in plane strain, E* = 1: finite at nu = 1/2
    s1, s2, s3 = here["stress1"], here["stress2"], here["stress3"]
    young = 1 - nu**2
    np.testing.assert_allclose(s2, nu * (s1 + s3), atol=1e-12 * stress)
    np.testing.assert_allclose(here["strain1"], (s1 - nu * (s2 + s3)) / young, atol=1e-12 * (strain + stress))
    np.testing.assert_allclose(here["strain3"], (s3 - nu * (s1 + s2)) / young, atol=1e-12 * (strain + stress))
    np.testing.assert_allclose(here["strain5"], here["stress5"] * 2 / (1 - nu), atol=1e-12 * (strain + stress))


@pytest.mark.parametrize("body", BODIES)
def test_fields_meet_the_boundary_conditions(body):
    found, tractions = random_surface(body)
    depths = [0.0] if body.aspect_ratio is None else [0.0, -body.aspect_ratio]
    result = inside(found, np.array(depths), body)
    displaced = body.response((NX,)).apply(tractions)
    for found, expected in zip((result.stress5, result.stress3), tractions, strict=True):
        np.testing.assert_allclose(found[0], expected, atol=1e-12 * abs(expected).max())
    for found, expected in zip((result.u1, result.u3), displaced, strict=True):
        np.testing.assert_allclose(found[0], expected, atol=1e-12 * abs(displaced).max())
    if body.aspect_ratio is not None:
        assert abs(result.u1[1]).max() < 1e-12 * abs(result.u1).max()
        assert abs(result.u3[1]).max() < 1e-12 * abs(result.u3).max()


@pytest.mark.parametrize("body", BODIES)
@pytest.mark.parametrize("nx", [16, 17])
def test_a_loaded_surface_bears_its_tractions_up_to_nyquist(body, nx):
    tractions = np.random.default_rng(2).standard_normal((2, nx))
    result = inside(fields.surface_under_tractions(tractions, body), np.array([0.0]), body)
    np.testing.assert_allclose((result.stress5[0], result.stress3[0]), tractions, atol=1e-11)


def test_normal_displacement_under_pressure_is_that_of_the_condensed_stiffness():
    pressure, q = np.random.default_rng(4).uniform(size=32), grid.wavenumbers(32)
    for nu in (0.0, 0.33, 0.5):
        body = ElasticBody(nu, 0.2)
        found = inside(fields.surface_under_tractions(np.stack((0 * pressure, -pressure)), body), np.zeros(1), body)
        expected = grid.signal(-grid.coefficients(pressure) / slab_stiffness.slab(q, nu, 0.2), 32)
        np.testing.assert_allclose(found.u3[0], expected, atol=1e-14)


def test_a_displaced_surface_is_where_it_was_put_up_to_nyquist():
    nx, body = 16, ElasticBody(0.3, 0.2)
    u1, u3 = np.random.default_rng(3).standard_normal((2, nx))
    stiff = ElasticBody(0.3, 0.2).response((nx,))
    v1, v3 = grid.coefficients(u1), grid.coefficients(u3)
    t1, t3 = (
        grid.signal(t, nx)
        for t in (stiff.elements[0] * v1 + 1j * stiff.elements[1] * v3, stiff.normal * v3 - 1j * stiff.elements[1] * v1)
    )
    result = inside(fields.displaced_surface(np.stack((u1, u3)), body), np.array([0.0, -0.2]), body)
    for field, given in ((result.u1, u1), (result.u3, u3), (result.stress5, t1), (result.stress3, t3)):
        np.testing.assert_allclose(field[0], given, atol=1e-11 * abs(given).max())
    assert abs(result.u1[1]).max() + abs(result.u3[1]).max() < 1e-12


@pytest.mark.parametrize("nu", RATIOS)
def test_deep_slab_is_the_half_space(nu):
    q, depth = 2 * np.pi * np.array([1.0, 10.0, 1e3, 1e6, 1e9]), 0.003
    deep, limit = (ElasticBody(nu, height).layers.transfer(depth, q) for height in (20.0, None))
    for found, true in zip(vars(deep).values(), vars(limit).values(), strict=True):
        np.testing.assert_allclose(found, true, rtol=1e-12, atol=1e-300)


def test_a_cosine_load_on_the_half_space_has_its_closed_form():
    """p cos(qx) gives sigma_33, sigma_11 = -p (1 +- d) exp(-d) cos(qx), sigma_13 = p d exp(-d) sin(qx), d = q depth."""
    x, q, nu = np.arange(NX) / NX, 2 * np.pi * 3, 0.33
    depth = np.array([0.0, 0.01, 0.1, 0.7])
    found = fields.surface_under_tractions(np.stack((0 * x, -np.cos(q * x))), ElasticBody(nu, None))
    result = inside(found, -depth, ElasticBody(nu, None))
    d = (q * depth)[:, np.newaxis]
    np.testing.assert_allclose(result.stress3, -(1 + d) * np.exp(-d) * np.cos(q * x), atol=1e-14)
    np.testing.assert_allclose(result.stress1, -(1 - d) * np.exp(-d) * np.cos(q * x), atol=1e-14)
    # the x-axis is along the surface and z out of the body: the material on the right is dragged down
    np.testing.assert_allclose(result.stress5, d * np.exp(-d) * np.sin(q * x), atol=1e-14)


def test_a_row_of_line_loads_is_flamant_near_one_of_them():
    """Flamant: sigma_rr = -2 P cos(theta) / (pi r) of a line load, nothing else (Johnson 1985, 2.23)."""
    nx, depth = 2**14, 0.004
    pressure = np.zeros(nx)
    pressure[nx // 2] = nx
    body = ElasticBody(0.3, None)
    surface = fields.surface_under_tractions(np.stack((0 * pressure, -pressure)), body)
    found = inside(surface, np.array([-depth]), body)
    x = np.arange(nx) / nx - 0.5
    near = abs(x) < 0.02
    r2 = x[near] ** 2 + depth**2
    radial = -2 * depth / (np.pi * r2)
    # images at a distance of 1 bring a pressure of the order of 1
    np.testing.assert_allclose(found.stress3[0][near], radial * depth**2 / r2, atol=0.05)
    np.testing.assert_allclose(found.stress1[0][near], radial * x[near] ** 2 / r2, atol=1.5)
    np.testing.assert_allclose(found.stress5[0][near], radial * -depth * x[near] / r2, atol=0.05)


def test_von_mises_stress_of_simple_states_is_known():
    assert fields.von_mises(np.array(2.0), np.array(0.0), np.array(0.0), np.array(0.0)) == 2.0
    assert fields.von_mises(np.array(3.0), np.array(3.0), np.array(3.0), np.array(1.0)) == pytest.approx(np.sqrt(3))


def test_nothing_overflows_at_any_wave_number_or_depth():
    nx = 2**15
    pressure = np.ones(nx)
    pressure[::2] = 0.0
    for body in (ElasticBody(0.5, 4.0), ElasticBody(0.3, 1e-4), ElasticBody(0.49999999, 1.0)):
        found = fields.surface_under_tractions(np.stack((0 * pressure, -pressure)), body)
        result = inside(found, -body.aspect_ratio * np.array([0.0, 1e-7, 0.5, 1.0]), body)
        assert all(np.isfinite(field).all() for field in vars(result).values())
        assert abs(result.stress3[2:]).max() <= 1.0


@pytest.mark.parametrize("z", [0.1, -0.31, np.nan, -np.inf])
def test_z_outside_the_body_is_refused(z):
    body = ElasticBody(0.3, 0.3)
    with pytest.raises(ValueError, match="outside the body"):
        inside(random_surface(body)[0], np.array([z]), body)
