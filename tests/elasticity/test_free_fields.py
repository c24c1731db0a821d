"""Fields inside bodies without a period: Hertz's, Boussinesq's, Cerruti's, and those of ever longer periods."""

import numpy as np
import pytest

from gfmd_numba.elasticity import fields, free_body, free_fields
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from support.cases import some_of

NAMES = fields.DISPLACEMENTS + fields.STRAINS + fields.STRESSES
LAYERS = ElasticBody.layered((0.05, 0.15), (Material(1.0, 0.3), Material(0.3, 0.4)), None)


def below(tractions, nu):
    return free_fields.under_tractions(tractions, ElasticBody(nu, None))


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_below_a_ball_stresses_are_those_of_hertz(nu):
    """On the axis (Johnson, Contact Mechanics, 3.45), down to ten radii, far below the window."""
    n, a = 128, 0.25
    x = np.arange(n) / n - 0.5
    tractions = np.zeros((3, n, n))
    tractions[2] = -np.sqrt(np.maximum(1.0 - (x**2 + x[:, np.newaxis] ** 2) / a**2, 0.0))
    depth = np.array([0.0, 0.2, 0.48, 1.0, 3.0, 10.0])
    found = below(tractions, nu).section(-a * depth, ("stress1", "stress2", "stress3"), "x", 0.5)[:, :, n // 2]
    along = -1.0 / (1.0 + depth**2)
    across = -(1.0 + nu) * (1.0 - depth * np.arctan2(1.0, depth)) - 0.5 * along
    np.testing.assert_allclose(found, [across, across, along], atol=1e-4)


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_below_a_cylinder_stresses_are_those_of_hertz(nu):
    """On the axis (Johnson, Contact Mechanics, 4.46)."""
    n, a = 512, 0.25
    x = np.arange(n) / n - 0.5
    tractions = np.zeros((2, n))
    tractions[1] = -np.sqrt(np.maximum(1.0 - (x / a) ** 2, 0.0))
    depth = np.array([0.0, 0.2, 0.786, 1.0, 3.0, 10.0])
    found = below(tractions, nu).section(-a * depth, ("stress1", "stress2", "stress3"))[:, :, n // 2]
    root = np.sqrt(1.0 + depth**2)
    along, across = -1.0 / root, 2.0 * depth - (1.0 + 2.0 * depth**2) / root
    np.testing.assert_allclose(found, [across, nu * (along + across), along], atol=1e-4)


def boussinesq(nu, x, y, depth):
    """Displacements and stresses by a unit force into the body, E* = 1, z out of it (Johnson, 3.18 and 3.19)."""
    r, rho, modulus = np.hypot(x, y), np.sqrt(x**2 + y**2 + depth**2), 0.5 * (1.0 - nu)
    outwards = depth / rho**3 - (1.0 - 2.0 * nu) / (rho * (rho + depth))
    radial = (1.0 - 2.0 * nu) / (rho * (rho + depth)) - 3.0 * depth * r**2 / rho**5
    hoop = -(1.0 - 2.0 * nu) * (1.0 / (rho * (rho + depth)) - depth / rho**3)
    c, s = x / r, y / r
    return {
        "u1": outwards * x / (4.0 * np.pi * modulus),
        "u2": outwards * y / (4.0 * np.pi * modulus),
        "u3": -(depth**2 / rho**3 + 2.0 * (1.0 - nu) / rho) / (4.0 * np.pi * modulus),
        "stress1": (c**2 * radial + s**2 * hoop) / (2.0 * np.pi),
        "stress2": (s**2 * radial + c**2 * hoop) / (2.0 * np.pi),
        "stress3": -3.0 * depth**3 / (2.0 * np.pi * rho**5),
        "stress5": 3.0 * depth**2 * x / (2.0 * np.pi * rho**5),
        "stress6": c * s * (radial - hoop) / (2.0 * np.pi),
    }


def cerruti(nu, x, y, depth):
    """The same by a unit force along x (Johnson, 3.76 and 3.77)."""
    rho, modulus = np.sqrt(x**2 + y**2 + depth**2), 0.5 * (1.0 - nu)
    of_one, flat = rho + depth, 1.0 - 2.0 * nu
    scale = 1.0 / (4.0 * np.pi * modulus)
    return {
        "u1": scale * (1.0 / rho + x**2 / rho**3 + flat * (1.0 / of_one - x**2 / (rho * of_one**2))),
        "u2": scale * (x * y / rho**3 - flat * x * y / (rho * of_one**2)),
        "u3": -scale * (x * depth / rho**3 + flat * x / (rho * of_one)),
        "stress3": -3.0 * x * depth**2 / (2.0 * np.pi * rho**5),
        "stress4": 3.0 * x * y * depth / (2.0 * np.pi * rho**5),
        "stress5": 3.0 * x**2 * depth / (2.0 * np.pi * rho**5),
    }


@pytest.mark.parametrize("nu", some_of([0.05, 0.3, 0.5], 1))
@pytest.mark.parametrize(("direction", "exact"), [(2, boussinesq), (0, cerruti)])
def test_far_from_a_loaded_node_fields_are_those_of_a_point_force(direction, exact, nu):
    """A node is not a point, but from five spacings below it the waves that it lacks are not felt."""
    n = 64
    tractions = np.zeros((3, n, n))
    tractions[direction, 20, 30] = -(n**2) if direction == 2 else n**2
    inner = below(tractions, nu)
    for depth in (8.0 / n, 0.3, 4.0):
        places = np.array([(20, 34), (5, 30), (60, 60), (40, 1)])
        expected = exact(nu, (places[:, 1] - 30) / n, (places[:, 0] - 20) / n, depth)
        plane = inner.plane(-depth, tuple(expected))[:, places[:, 0], places[:, 1]]
        for found, (name, values) in zip(plane, expected.items(), strict=True):
            largest = max(abs(each).max() for other, each in expected.items() if other[0] == name[0])
            np.testing.assert_allclose(found, values, atol=2e-6 * largest, err_msg=f"{name} at {depth}")


def rough_tractions(shape, seed=0):
    traction = np.random.default_rng(seed).random((len(shape) + 1, *shape))
    fade = np.sin(np.pi * (np.arange(shape[0]) + 0.5) / shape[0]) ** 2
    return traction * (fade if len(shape) == 1 else fade * fade[:, np.newaxis])


def smooth_tractions(shape):
    """Waves that end smoothly at the edge of the window, which any grid knows."""
    x = (np.arange(shape[0]) + 0.5) / shape[0]
    bump = np.sin(np.pi * x) ** 4
    one, other = bump * (1.0 + 0.5 * np.cos(2.0 * np.pi * x)), bump * np.sin(2.0 * np.pi * x)
    if len(shape) == 1:
        return np.array([other, -one])
    return np.array([np.outer(one, other), np.outer(other, one), -np.outer(one, one)])


@pytest.mark.parametrize("nu", [0.05, 0.3, 0.5])
@pytest.mark.parametrize("shape", [(32,), (24, 24)])
def test_at_the_surface_tractions_are_met_and_displacements_are_those_of_its_kernel(nu, shape):
    tractions = rough_tractions(shape)
    wide = np.zeros((len(tractions), *free_body.padded_shape(shape)))
    window = (slice(None), *(slice(n) for n in shape))
    wide[window] = tractions
    expected = free_body.response(shape, ElasticBody(nu, None), couples=True).apply(wide)[window]
    inner = below(tractions, nu)
    names = ("u1", "u3") if len(shape) == 1 else ("u1", "u2", "u3")
    stresses = ("stress5", "stress3") if len(shape) == 1 else ("stress5", "stress4", "stress3")
    found = (
        inner.section(np.zeros(1), names + stresses)[:, 0] if len(shape) == 1 else inner.plane(0.0, names + stresses)
    )
    np.testing.assert_allclose(found[len(names) :], tractions, atol=1e-6)
    smooth = (slice(None), *(slice(4, -4) for _ in shape))
    np.testing.assert_allclose(found[: len(names)][smooth], expected[smooth], atol=5e-3 * abs(expected).max())


@pytest.mark.parametrize(
    ("body", "shape"), [(ElasticBody(0.3, 0.2), (32,)), (ElasticBody(0.45, 0.5), (24, 24)), (LAYERS, (24, 24))]
)
def test_a_slab_is_one_in_a_period_that_is_long_beside_its_height(body, shape):
    periods, tractions = 16 if len(shape) == 1 else 8, smooth_tractions(shape)
    wide = np.zeros((len(tractions), *(periods * n for n in shape)))
    wide[(slice(None), *(slice(n) for n in shape))] = tractions
    if body is LAYERS:
        heights, materials = (0.05 / periods, 0.15 / periods), (Material(1.0, 0.3), Material(0.3, 0.4))
        far = ElasticBody.layered(heights, materials, None)
    else:
        far = ElasticBody(body.nu, body.aspect_ratio / periods)
    z = np.array([0.0, -0.04, 0.9 * body.base_z])
    n = shape[-1]
    far_below = fields.Inside((fields.surface_under_tractions(wide, far),), far)
    expected = far_below.section(z / periods, NAMES, "y", 0.5 / periods if len(shape) > 1 else 0.0)[..., :n]
    expected[:3] *= periods
    found = free_fields.under_tractions(tractions, body).section(z, NAMES, "y", 0.5 if len(shape) > 1 else 0.0)
    for one, other, name in zip(found, expected, NAMES, strict=True):
        np.testing.assert_allclose(one, other, atol=2e-4 * abs(expected).max(), err_msg=name)


def test_sections_and_planes_meet():
    inner = below(rough_tractions((20, 20)), 0.3)
    z = np.array([-0.05, -0.4])
    at_x, at_y = inner.section(z, NAMES, "x", 0.25), inner.section(z, NAMES, "y", 0.6)
    for i, level in enumerate(z):
        plane = inner.plane(level, NAMES)
        np.testing.assert_allclose(at_x[:, i], plane[:, :, 5], atol=1e-10)
        np.testing.assert_allclose(at_y[:, i], plane[:, 12], atol=1e-10)
        largest = inner.largest_von_mises(np.array([level]))
        assert largest.von_mises[0] == pytest.approx(fields.von_mises(*plane[-6:]).max(), rel=1e-3)
    with pytest.raises(ValueError, match="outside the body"):
        inner.plane(0.1, NAMES)
