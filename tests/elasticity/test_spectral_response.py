"""The stiffness of three displacements of a map, by Navier's equations in many digits, profiles and closed forms."""

import mpmath
import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.fourier import grid
from support.cases import some_of

SOFT, HARD = Material(1.0, 0.4), Material(20.0, 0.1)
BODIES = {
    "half-space": ElasticBody(0.3, None),
    "auxetic half-space": ElasticBody(-0.6, None),
    "slab": ElasticBody(0.2, 0.1),
    "nearly incompressible slab": ElasticBody(0.4999, 0.3),
    "layer on a half-space": ElasticBody.layered((0.05,), (SOFT,), HARD),
    "layers on a rigid base": ElasticBody.layered((0.05, 0.3), (SOFT, HARD), None),
}
INCOMPRESSIBLE = {"half-space": ElasticBody(0.5, None), "slab": ElasticBody(0.5, 0.2)}


def layers_of(body, q):
    """Heights and materials of a body from the surface downwards, on a rigid base that a half-space does not feel."""
    if body.stack is None:
        return [(body.aspect_ratio or 30.0 / q, Material(1.0, body.nu))]
    layers = list(zip(body.stack.heights, body.stack.materials, strict=True))
    return layers if body.stack.base is None else [*layers, (30.0 / q, body.stack.base)]


def from_navier(body, qx, qy):
    """Stiffness `[3, 3]` of the surface for u exp(i (qx x + qy y)), by Hooke's law and equilibrium in three dimensions.

    With t = (sigma_xz, sigma_yz, sigma_zz) they are one linear equation for (u, t) over z.
    """
    q = (mpmath.mpf(qx), mpmath.mpf(qy))
    through = mpmath.eye(6)
    for height, material in layers_of(body, np.hypot(qx, qy)):
        nu, modulus = mpmath.mpf(material.poissons_ratio), mpmath.mpf(material.modulus)
        shear = modulus * (1 - nu) / 2
        lame = 2 * shear * nu / (1 - 2 * nu)

        def c(i, j, k, m, lame=lame, shear=shear):
            return lame * (i == j) * (k == m) + shear * ((i == k) * (j == m) + (i == m) * (j == k))

        def matrix(element):
            return mpmath.matrix(3, 3) + mpmath.matrix([[element(i, k) for k in range(3)] for i in range(3)])

        lift = matrix(lambda i, k: c(i, 2, k, 2)) ** -1
        along = matrix(lambda i, k: sum(1j * q[a] * c(i, 2, k, a) for a in (0, 1)))
        across = matrix(lambda i, k: sum(1j * q[a] * c(i, a, k, 2) for a in (0, 1)))
        plane = matrix(lambda i, k: sum(-q[a] * q[b] * c(i, a, k, b) for a in (0, 1) for b in (0, 1)))
        slope = mpmath.matrix(6, 6)
        slope[:3, :3], slope[:3, 3:] = -lift * along, lift
        slope[3:, :3], slope[3:, 3:] = across * lift * along - plane, -across * lift
        through = through * mpmath.expm(slope * mpmath.mpf(height), method="taylor")
    found = through[3:, 3:] * through[:3, 3:] ** -1
    return np.array([[complex(found[i, j]) for j in range(3)] for i in range(3)])


def matrices(elements):
    """Hermitian matrices `[ny, nx // 2 + 1, 3, 3]` of the elements."""
    xx, xy, yy, xz, yz, zz = elements
    found = np.array([[xx + 0j, xy, 1j * xz], [xy, yy, 1j * yz], [-1j * xz, -1j * yz, zz]])
    return np.moveaxis(found, (0, 1), (-2, -1))


@pytest.mark.parametrize("body", some_of(BODIES.values(), 1, 3, 5), ids=BODIES)
def test_every_wave_obeys_naviers_equations(body):
    found = matrices(body.response((32, 32)).elements)
    for ky, kx in ((0, 1), (1, 0), (-2, 3), (5, 9)):
        with mpmath.workdps(60):
            true = from_navier(body, 2 * np.pi * kx, 2 * np.pi * ky)
        np.testing.assert_allclose(found[ky, kx], true, atol=1e-12 * abs(true).max())


@pytest.mark.parametrize("body", [*BODIES.values(), *INCOMPRESSIBLE.values()])
@pytest.mark.parametrize("nx", [24, 25])
def test_waves_along_either_axis_are_those_of_a_profile(body, nx):
    elements, profile = body.response((nx, nx)).elements, body.response((nx,))
    k11, k13, k33 = profile.elements[0], profile.elements[1], profile.normal
    np.testing.assert_allclose(elements[[0, 3, 5], 0], (k11, k13, k33), rtol=1e-13)
    np.testing.assert_allclose(elements[[2, 4, 5], : nx // 2 + 1, 0], (k11, k13, k33), rtol=1e-13)
    assert not elements[[1, 4], 0].any()
    assert not elements[[1, 3], :, 0].any()


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3, 0.5])
def test_shear_across_the_wave_feels_the_shear_modulus_alone(nu):
    """G |q| of a half-space, G |q| coth(|q| h) of a slab."""
    q, shear, height = grid.wavenumbers(64)[1:-1], 0.5 * (1.0 - nu), 0.03
    of_half_space = ElasticBody(nu, None).response((64, 64)).elements[2, 0, 1:-1]
    np.testing.assert_allclose(of_half_space, shear * q, rtol=1e-15)
    of_slab = ElasticBody(nu, height).response((64, 64)).elements[2, 0]
    np.testing.assert_allclose(of_slab[1:-1], shear * q / np.tanh(q * height), rtol=1e-14)
    assert of_slab[0] == pytest.approx(shear / height, rel=1e-14)


def test_shear_across_the_wave_decays_into_layers():
    """Equal layers are one slab; on a half-space of the same material they are that; far below nothing is felt."""
    q = np.geomspace(1e-3, 1e4, 50)
    two = ElasticBody.layered((0.1, 0.2), (SOFT, Material(1.0, 0.3)), None)
    one = ElasticBody(0.4, 0.3)
    shear = [SOFT.shear, Material(1.0, 0.3).shear]
    stiff = 1.0 / two.stack.compliance_across(q) * q
    assert stiff[0] == pytest.approx(1.0 / (0.1 / shear[0] + 0.2 / shear[1]), rel=1e-6)
    np.testing.assert_allclose(stiff[-5:], shear[0] * q[-5:], rtol=1e-14)
    same = ElasticBody(None, 0.3, type(two.stack)((0.1, 0.2), (SOFT, SOFT), None))
    np.testing.assert_allclose(same.compliance_across(q), one.compliance_across(q), rtol=1e-14)
    whole = ElasticBody(None, None, type(two.stack)((0.1, 0.2), (SOFT, SOFT), SOFT))
    np.testing.assert_allclose(q * whole.compliance_across(q), 1.0 / SOFT.shear, rtol=1e-14)


@pytest.mark.parametrize("body", [*BODIES.values(), *INCOMPRESSIBLE.values()])
@pytest.mark.parametrize("shape", [(12, 16), (9, 12), (12, 15)])
def test_without_tangential_tractions_the_normal_stiffness_is_the_condensed_one(body, shape):
    whole = body.response(shape)
    expected = body.condensed_stiffness(grid.magnitudes(shape))
    np.testing.assert_allclose(whole.condensed().normal, expected, rtol=1e-12)
    assert whole.with_mean(0.0).condensed().normal[0, 0] == 0.0


@pytest.mark.parametrize("body", [*BODIES.values(), *INCOMPRESSIBLE.values()])
@pytest.mark.parametrize("shape", [(12, 16), (9, 15)])
def test_the_compliance_is_the_inverse(body, shape):
    whole = body.response(shape)
    products = matrices(whole.elements)[:, 1:] @ matrices(whole.inverse())[:, 1:]
    np.testing.assert_allclose(products, np.broadcast_to(np.eye(3), products.shape), atol=1e-9)
    mean, inverse = whole.elements[[0, 2, 5], 0, 0], whole.inverse()[[0, 2, 5], 0, 0]
    np.testing.assert_allclose(inverse, [1.0 / k if k > 0.0 else 0.0 for k in mean])


@pytest.mark.parametrize("shape", [(12, 16), (9, 12), (12, 15)])
def test_displacements_of_real_tractions_are_real_and_the_energy_is_positive(shape):
    """Also at Nyquist, where the transform of real samples keeps waves twice or once."""
    rng = np.random.default_rng(1)
    u = rng.normal(size=(3, *shape))
    elements = ElasticBody(0.2, 0.4).response(shape).elements
    spectrum = np.einsum("yxij,jyx->iyx", matrices(elements), np.fft.rfft2(u))
    t = np.fft.irfft2(spectrum, shape)
    np.testing.assert_allclose(np.fft.rfft2(t), spectrum, atol=1e-10 * abs(spectrum).max())
    assert (t * u).sum() > 0.0
    v = rng.normal(size=(3, *shape))
    other = np.fft.irfft2(np.einsum("yxij,jyx->iyx", matrices(elements), np.fft.rfft2(v)), shape)
    assert (t * v).sum() == pytest.approx((other * u).sum(), rel=1e-12)  # reciprocity


def test_principal_stiffnesses_bound_the_energy():
    whole: SpectralResponse = ElasticBody(0.2, 0.4).response((8, 8))
    smallest, largest = whole.principal()
    found = np.linalg.eigvalsh(matrices(whole.elements))
    np.testing.assert_allclose(smallest, found[..., 0], rtol=1e-12)
    np.testing.assert_allclose(largest, found[..., 2], rtol=1e-12)


@pytest.mark.parametrize("shape", [(12,), (8, 8)])
@pytest.mark.parametrize("body", [ElasticBody(0.3, None), ElasticBody(0.3, 0.4), ElasticBody(0.5, 0.4)])
def test_a_wall_that_yields_adds_to_the_normal_compliance_alone(shape, body):
    """A mean that nothing restores stays so, and one that is rigid gives way with the wall."""
    response = body.response(shape)
    yielding = response.with_yielding(0.7)
    more = yielding.inverse() - response.inverse()
    moved = np.zeros_like(more)
    moved[-1] = 0.7
    moved[-1].flat[0] = 0.7 if response.normal.flat[0] > 0.0 else 0.0
    np.testing.assert_allclose(more, moved, atol=1e-12)
