"""Fields below a map against profiles, exact waves in the axes of the map, equilibrium and Hertz."""

import tracemalloc

import mpmath
import numpy as np
import pytest
from inner_fields import inside

from gfmd_numba.elasticity import fields, moduli
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.fields import DISPLACEMENTS, STRAINS, STRESSES
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.fourier import grid
from support.cases import some_of

ALL = DISPLACEMENTS + STRAINS + STRESSES
COATED, SOFT = (Material(1.0, 0.3), Material(5.0, 0.4)), Material(0.1, 0.2)
BODIES = {
    "half-space": ElasticBody(0.3, None),
    "slab": ElasticBody(0.2, 0.3),
    "incompressible slab": ElasticBody(0.5, 0.3),
    "layers": ElasticBody.layered((0.02, 0.3), COATED, None),
    "layers on a half-space": ElasticBody.layered((0.02, 0.1), COATED, SOFT),
}
Z = np.array([0.0, -0.003, -0.02, -0.05, -0.3])


def random_tractions(shape, body, seed=1):
    """Tractions of all waves of the grid, Nyquist too; nothing holds the mean tangential one of a half-space."""
    found = np.random.default_rng(seed).standard_normal((3, *shape))
    return found - found.mean(axis=(1, 2), keepdims=True) if np.isinf(body.base_z) else found


@pytest.mark.parametrize("n", [32, 33])
@pytest.mark.parametrize("body", BODIES.values(), ids=BODIES)
def test_a_ridge_has_the_fields_of_its_profile_along_x_and_along_y(body, n):
    tangential, _, normal = random_tractions((1, n), body)[:, 0]
    flat = fields.surface_under_tractions(np.stack((tangential, normal)), body)
    expected = vars(inside(flat, Z, body))
    along_x, along_y = np.zeros((3, n + 2, n)), np.zeros((3, n, n + 2))
    along_x[0], along_x[2] = tangential, normal
    along_y[1], along_y[2] = tangential[:, np.newaxis], normal[:, np.newaxis]
    turned = {"1": "2", "2": "1", "5": "4"}
    for tractions, across, swapped in ((along_x, "y", {}), (along_y, "x", turned)):
        surface = fields.surface_under_tractions(tractions, body)
        found = dict(zip(ALL, fields.Inside((surface,), body).section(Z, ALL, across, 0.37), strict=True))
        for name, values in expected.items():
            same = found.pop(name[:-1] + swapped.get(name[-1], name[-1]))
            np.testing.assert_allclose(same, values, atol=1e-13 * abs(values).max(), err_msg=name)
        largest = max(abs(values).max() for values in expected.values())
        assert max(abs(values).max() for values in found.values()) < 1e-13 * largest  # nothing along the ridge


def moduli_of(material):
    """Lame's lambda and mu in units of E* of the top."""
    nu = mpmath.mpf(material.poissons_ratio)
    young = material.modulus * (1 - nu**2)
    return young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))


def all_of(state, qx, qy, material):
    """Displacements, strains and stresses of the state u, sigma_13, sigma_23, sigma_33, by Hooke's law."""
    lam, mu = moduli_of(material)
    u1, u2, u3, s5, s4, s3 = state
    e1, e2 = 1j * qx * u1, 1j * qy * u2
    e3 = (s3 - lam * (e1 + e2)) / (lam + 2 * mu)
    e6 = 1j * (qy * u1 + qx * u2)
    pressure = lam * (e1 + e2 + e3)
    strains = (e1, e2, e3, s4 / mu, s5 / mu, e6)
    return (u1, u2, u3, *strains, pressure + 2 * mu * e1, pressure + 2 * mu * e2, s3, s4, s5, mu * e6)


def slope(qx, qy, material):
    """Matrix of the derivative of the state in z."""
    columns = []
    for i in range(6):
        state = [mpmath.mpf(i == j) for j in range(6)]
        found = dict(zip(ALL, all_of(state, qx, qy, material), strict=True))
        u3 = state[2]
        columns.append(
            [
                found["strain5"] - 1j * qx * u3,
                found["strain4"] - 1j * qy * u3,
                found["strain3"],
                -1j * (qx * found["stress1"] + qy * found["stress6"]),
                -1j * (qx * found["stress6"] + qy * found["stress2"]),
                -1j * (qx * found["stress5"] + qy * found["stress4"]),
            ]
        )
    return mpmath.matrix(columns).T


def exact(traction, qx, qy, layers, depths):
    """Fields at some depths of one wave, whose base is held far below, or at the last layer's end, by exponentials."""
    ends = [0.0, *np.cumsum([height for height, _ in layers])]

    def downwards(depth):
        found = mpmath.eye(6)
        for top, (height, material) in zip(ends, layers, strict=False):
            if depth > top:
                found = mpmath.expm(-mpmath.mpf(min(depth - top, height)) * slope(qx, qy, material)) * found
        return found

    to_base = downwards(ends[-1])[:3, :]
    u = mpmath.lu_solve(to_base[:, :3], -to_base[:, 3:] * mpmath.matrix(traction))
    on_top = mpmath.matrix([*u, *traction])
    for depth in depths:
        material = next(m for end, (_, m) in zip(ends[1:], layers, strict=True) if depth <= end)
        yield [complex(each) for each in all_of(list(downwards(depth) * on_top), qx, qy, material)]


@pytest.mark.parametrize(
    ("body", "layers"),
    [
        (ElasticBody(0.3, None), [(3.0, Material(1.0, 0.3))]),
        (ElasticBody(0.3, 0.1), [(0.1, Material(1.0, 0.3))]),
        (ElasticBody.layered((0.02, 0.1), COATED, SOFT), [(0.02, COATED[0]), (0.1, COATED[1]), (3.0, SOFT)]),
        (ElasticBody.layered((0.02, 0.1), COATED, None), [(0.02, COATED[0]), (0.1, COATED[1])]),
    ],
    ids=["half-space", "slab", "layers on a half-space", "layers"],
)
@pytest.mark.parametrize(("kx", "ky"), some_of([(2, 3), (1, -2), (0, 1)], 1))
def test_a_wave_of_any_direction_is_that_of_elasticity_in_three_axes(body, layers, kx, ky):
    """Of all three tractions, against matrix exponentials of the equations of elasticity in x, y and z."""
    traction, n, depths = np.array([0.3 + 0.2j, -0.7j, 1.0]), 16, [0.0, 0.01, 0.02, 0.07]
    y, x = np.meshgrid(np.arange(n) / n, np.arange(n) / n, indexing="ij")
    wave = np.exp(2j * np.pi * (kx * x + ky * y))
    surface = fields.surface_under_tractions((traction[:, np.newaxis, np.newaxis] * wave).real, body)
    found = fields.Inside((surface,), body).section(-np.array(depths), ALL, "y", 0.3)
    with mpmath.workdps(40):
        qx, qy = 2 * mpmath.pi * kx, 2 * mpmath.pi * ky
        expected = np.array(list(exact(list(traction), qx, qy, layers, depths)))
    on_line = np.exp(2j * np.pi * (kx * np.arange(n) / n + ky * 0.3))
    expected = (expected.T[:, :, np.newaxis] * on_line).real
    for kind in ("u", "strain", "stress"):
        rows = [i for i, name in enumerate(ALL) if name.startswith(kind)]
        np.testing.assert_allclose(found[rows], expected[rows], atol=1e-11 * abs(expected[rows]).max(), err_msg=kind)


@pytest.mark.parametrize("body", [ElasticBody(0.3, None), ElasticBody(0.4999999, 0.3)], ids=["half-space", "slab"])
def test_fields_are_in_equilibrium_and_obey_hookes_law(body):
    n, depth, step = 31, 0.05, 2e-4  # without a Nyquist wave, whose derivative the nodes do not see
    surface = fields.surface_under_tractions(random_tractions((n, n), body), body)
    levels = -depth + step * np.arange(-3, 4)
    planes = np.stack([fields.Inside((surface,), body).plane(z, ALL) for z in levels])
    weights = np.array([-1, 9, -45, 0, 45, -9, 1]) / (60 * step)
    here = dict(zip(ALL, planes[3], strict=True))
    in_z = dict(zip(ALL, np.einsum("z,zfyx->fyx", weights, planes), strict=True))
    qy, qx = grid.wavevectors((n, n), (1.0, 1.0))
    in_x, in_y = (
        {name: grid.signal(1j * q * grid.coefficients(field, 2), n, n) for name, field in here.items()}
        for q in (qx, qy)
    )
    steepest = max(abs(in_x[name]).max() for name in STRESSES)
    for a, b, c in (("1", "6", "5"), ("6", "2", "4"), ("5", "4", "3")):
        unbalanced = in_x[f"stress{a}"] + in_y[f"stress{b}"] + in_z[f"stress{c}"]
        assert abs(unbalanced).max() < 1e-7 * steepest
    strains = (
        *(in_x["u1"], in_y["u2"], in_z["u3"]),
        *(in_y["u3"] + in_z["u2"], in_x["u3"] + in_z["u1"], in_x["u2"] + in_y["u1"]),
    )
    largest = max(abs(strain).max() for strain in strains)
    for name, strain in zip(STRAINS, strains, strict=True):
        assert abs(here[name] - strain).max() < 1e-7 * largest
    nu, shear = body.poissons_ratio, moduli.c44(body.poissons_ratio)
    mean = (here["stress1"] + here["stress2"] + here["stress3"]) / 3
    for i in range(1, 7):
        free = here[f"stress{i}"] - (mean if i < 4 else 0.0)
        volume = sum(here[f"strain{j}"] for j in (1, 2, 3)) / 3 if i < 4 else 0.0
        factor = 2.0 * shear if i < 4 else shear
        assert abs(free - factor * (here[f"strain{i}"] - volume)).max() < 1e-10 * abs(here["stress3"]).max()
    bulk = 2.0 * shear * (1 + nu) / (3 * (1 - 2 * nu))
    np.testing.assert_allclose(mean, bulk * sum(here[f"strain{j}"] for j in (1, 2, 3)), atol=1e-7 * abs(mean).max())


def test_below_hertzs_pressure_the_largest_shear_is_0_31_of_it_at_0_48_radii():
    """Johnson 1985, (3.45): for nu = 0.3 half the difference of principal stresses is 0.310 p0 at z = -0.48 a."""
    n, radius = 256, 0.06
    x = np.arange(n) / n - 0.5
    pressure = np.sqrt(np.maximum(1.0 - (x**2 + x[:, np.newaxis] ** 2) / radius**2, 0.0))
    body, z = ElasticBody(0.3, None), -radius * np.linspace(0.3, 0.9, 31)
    surface = fields.surface_under_tractions(np.stack([0 * pressure, 0 * pressure, -pressure]), body)
    s1, s2, s3, *_ = fields.Inside((surface,), body).section(z, STRESSES, "y", 0.5)[:, :, n // 2]
    shear = 0.5 * abs(s3 - s1)
    assert shear.max() == pytest.approx(0.310, abs=0.002)
    assert -z[shear.argmax()] / radius == pytest.approx(0.48, abs=0.02)
    np.testing.assert_allclose(s1, s2, atol=1e-12)
    deep = -z / radius  # on the axis, but for the images of the period
    exact3 = -1.0 / (1.0 + deep**2)
    exact1 = -1.3 * (1.0 - deep * np.arctan(1.0 / deep)) + 0.5 / (1.0 + deep**2)
    np.testing.assert_allclose(s3, exact3, atol=0.02)
    np.testing.assert_allclose(s1, exact1, atol=0.02)
    most = fields.Inside((surface,), body).largest_von_mises(z[abs(deep - 0.48) < 0.05])
    assert most.von_mises.max() == pytest.approx(0.620, abs=0.004)
    deepest = most.von_mises.argmax()
    assert (most.x[deepest], most.y[deepest]) == pytest.approx((0.5, 0.5), abs=1 / n)


@pytest.mark.parametrize("shape", [(24, 30), (25, 31)])
def test_sections_cut_the_planes_and_the_largest_stress_is_theirs(shape):
    body = BODIES["layers"]
    surface = fields.surface_under_tractions(random_tractions(shape, body), body)
    planes = np.stack([fields.Inside((surface,), body).plane(z, ALL) for z in Z], axis=1)
    size = abs(planes).max(axis=(2, 3), keepdims=True)[..., 0]
    along_x = fields.Inside((surface,), body).section(Z, ALL, "y", 5 / shape[0])
    along_y = fields.Inside((surface,), body).section(Z, ALL, "x", 7 / shape[1])
    assert (abs(along_x - planes[:, :, 5]) <= 1e-12 * size).all()
    assert (abs(along_y - planes[:, :, :, 7]) <= 1e-12 * size).all()
    tractions = fields.Inside((surface,), body).plane(0.0, ("stress5", "stress4", "stress3"))
    np.testing.assert_allclose(tractions, random_tractions(shape, body), atol=1e-13)
    largest = fields.Inside((surface,), body).largest_von_mises(Z)
    mises = fields.von_mises(*planes[-6:])
    np.testing.assert_allclose(largest.von_mises[:4], mises.max(axis=(1, 2))[:4], rtol=1e-12)
    row, column = np.unravel_index(mises[1].argmax(), shape)
    assert (largest.x[1], largest.y[1]) == (column / shape[1], row / shape[0])


def test_waves_that_are_left_out_at_a_depth_are_not_missed(monkeypatch):
    body, z = BODIES["layers on a half-space"], np.array([-0.08, -0.15, -0.4])
    surface = fields.surface_under_tractions(random_tractions((256, 256), body), body)
    found = fields.Inside((surface,), body).section(z, ALL, "x", 0.2)
    assert max(fields.waves_kept((256, 256), 0.08)) < 128
    monkeypatch.setattr(fields, "_FADED", np.inf)
    whole = fields.Inside((surface,), body).section(z, ALL, "x", 0.2)
    np.testing.assert_allclose(found, whole, atol=1e-14 * abs(whole).max())


@pytest.mark.long
def test_a_section_never_holds_the_volume_in_memory():
    n, levels = 512, 20
    body = ElasticBody(0.3, 0.5)
    surface = fields.surface_under_tractions(random_tractions((n, n), body), body)
    tracemalloc.start()
    section = fields.Inside((surface,), body).section(-np.linspace(0.0, 0.02, levels), ALL)
    taken = tracemalloc.get_traced_memory()[1] - 3 * section.nbytes
    tracemalloc.reset_peak()
    fields.Inside((surface,), body).largest_von_mises(np.zeros(2))
    scan = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert taken < 40 * 8 * n**2  # the volume would be 300
    assert scan < 40 * 8 * n**2
