"""Two bodies that face each other: their stiffness by Navier's equations in many digits, and Dundurs' constant."""

import mpmath
import numpy as np
import pytest

from gfmd_numba.elasticity import moduli, stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.fourier import grid
from support.cases import some_of

SOFT, HARD = Material(1.0, 0.4), Material(8.0, 0.1)
SLAB, THIN = ElasticBody(0.3, 0.4), ElasticBody(-0.2, 0.05)
COATED = ElasticBody.layered((0.05, 0.2), (SOFT, HARD), None)
HALF_SPACE = ElasticBody(0.2, None)
PAIRS = [(SLAB, THIN, 0.3), (SLAB, SLAB, 0.8), (COATED, SLAB, 0.6), (THIN, COATED, 0.1)]


def compliance_by_navier(body, modulus, q, downwards):
    """Displacements `[3, 3]` of a surface exp(i (qx x + qy y)) under stresses (xz, yz, zz), of any modulus E*.

    The body fills the space below the surface, or above it. By Hooke's law and equilibrium, (u, stresses) obey one
    linear equation over z, and u is 0 on the rigid base.
    """
    parts = [(body.aspect_ratio, Material(1.0, body.nu))] if body.stack is None else []
    if body.stack is not None:
        parts = list(zip(body.stack.heights, body.stack.materials, strict=True))
    through = mpmath.eye(6)
    for height, material in parts:
        nu = mpmath.mpf(material.poissons_ratio)
        shear = mpmath.mpf(modulus) * mpmath.mpf(material.modulus) * (1 - nu) / 2
        lame, (a, b) = 2 * shear * nu / (1 - 2 * nu), (mpmath.mpc(0, each) for each in q)
        p_wave = lame + 2 * shear
        across = mpmath.mpf(4) * shear * (lame + shear) / p_wave
        slope = mpmath.matrix(
            [
                [0, 0, -a, 1 / shear, 0, 0],
                [0, 0, -b, 0, 1 / shear, 0],
                [-a * lame / p_wave, -b * lame / p_wave, 0, 0, 0, 1 / p_wave],
                [-across * a * a - shear * b * b, -(across - shear) * a * b, 0, 0, 0, -a * lame / p_wave],
                [-(across - shear) * a * b, -across * b * b - shear * a * a, 0, 0, 0, -b * lame / p_wave],
                [0, 0, 0, -a, -b, 0],
            ]
        )
        step = mpmath.mpf(height) * (1 if downwards else -1)
        through = through * mpmath.expm(slope * step, method="taylor")
    return through[:3, 3:] * through[3:, 3:] ** -1


def by_navier(own, other, share, qx, qy):
    """Stiffness for the approach and the relative sliding of the surfaces, E* of both being 1."""
    with mpmath.workdps(60):
        q = (2 * mpmath.pi * qx, 2 * mpmath.pi * qy)
        below = compliance_by_navier(own, 1 / (1 - mpmath.mpf(share)), q, True)
        above = compliance_by_navier(other, 1 / mpmath.mpf(share), q, False)
        found = (below - above) ** -1
        return np.array([[complex(found[i, j]) for j in range(3)] for i in range(3)])


@pytest.mark.parametrize(("own", "other", "share"), some_of(PAIRS, 0, 3))
def test_two_bodies_give_way_as_naviers_equations_say(own, other, share):
    nx = 16
    of_map = own.response((nx, nx)).in_series(other.response((nx, nx)), share)
    xx, xy, yy, xz, yz, zz = of_map.elements
    found = np.moveaxis([[xx + 0j, xy, 1j * xz], [xy, yy, 1j * yz], [-1j * xz, -1j * yz, zz]], (0, 1), (-2, -1))
    for ky, kx in ((0, 1), (-2, 3), (5, 0)):
        true = by_navier(own, other, share, kx, ky)
        np.testing.assert_allclose(found[ky, kx], true, atol=1e-11 * abs(true).max())
    profile = own.response((nx,)).in_series(other.response((nx,)), share)
    for k in (1, 5):
        true = by_navier(own, other, share, k, 0)
        for element, value in zip(profile.elements, (true[0, 0].real, true[0, 2].imag, true[2, 2].real), strict=True):
            assert element[k] == pytest.approx(value, abs=1e-11 * abs(true).max())


def test_half_spaces_couple_by_dundurs_constant():
    nu, other, e, e_other, n = 0.1, 0.45, 3.0, 2.0, 31  # odd: without the Nyquist wave, which couples nothing
    g, g_other = e / (2 * (1 + nu)), e_other / (2 * (1 + other))
    beta = 0.5 * ((1 - 2 * nu) / g - (1 - 2 * other) / g_other) / ((1 - nu) / g + (1 - other) / g_other)
    softness, softness_other = (1 - nu**2) / e, (1 - other**2) / e_other
    share = softness_other / (softness + softness_other)
    assert moduli.dundurs_beta(nu, other, share) == pytest.approx(beta, abs=1e-15)
    pair = ElasticBody(nu, None).response((n,)).in_series(ElasticBody(other, None).response((n,)), share)
    (s11, s13, s33), q = pair.inverse(), grid.wavenumbers(n)[1:]
    np.testing.assert_allclose(-s13[1:] * q, 2 * beta, rtol=1e-13)
    np.testing.assert_allclose(s11[1:] * q, 2.0, rtol=1e-13)
    np.testing.assert_allclose(s33[1:] * q, 2.0, rtol=1e-13)
    assert pair.elements[0][0] == pair.normal[0] == 0.0


@pytest.mark.parametrize("nx", [24, 25])
@pytest.mark.parametrize(
    ("own", "other"), [(HALF_SPACE, SLAB), (COATED, HALF_SPACE), (ElasticBody(0.5, 0.3), ElasticBody(0.5, 0.1))]
)
def test_free_of_shear_two_bodies_are_as_stiff_as_without_friction(own, other, nx):
    """The condensed stiffness of both, also of means that nothing holds or that are rigid, and along either axis."""
    share = 0.3
    pair = own.response((nx,)).in_series(other.response((nx,)), share)
    q = grid.wavenumbers(nx)
    expected = 1.0 / pair.inverse()[2, 1:]
    separate = stiffness.in_series(own.condensed_stiffness(q), other.condensed_stiffness(q), share)
    np.testing.assert_allclose(expected, separate[1:], rtol=1e-12)
    assert pair.normal[0] == separate[0]
    of_map = own.response((nx, nx)).in_series(other.response((nx, nx)), share)
    along_x, along_y = of_map.elements[:, 0], of_map.elements[:, : nx // 2 + 1, 0]
    for k, x, y in zip(pair.elements, (0, 3, 5), (2, 4, 5), strict=True):
        scale = abs(pair.normal[1:]).max()
        np.testing.assert_allclose(along_x[x][: nx // 2 + 1], k, atol=1e-12 * scale)
        np.testing.assert_allclose(along_y[y], k, atol=1e-12 * scale)
