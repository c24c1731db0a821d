"""Prescribed tractions and displacements on maps: closed forms of waves and slabs, ridges, and reciprocity."""

import numpy as np
import pytest

from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from support.coupled_bodies import compliance_of_wave, settled

SHAPE = 24, 32
Y, X = np.meshgrid(*(np.arange(n) / n for n in SHAPE), indexing="ij")
FREE = np.full((3, *SHAPE), np.nan)
BODIES = {"half-space": (0.3, np.inf), "slab": (0.3, 0.1), "incompressible": (0.5, 0.2)}
bodies = pytest.mark.parametrize(("nu", "aspect_ratio"), BODIES.values(), ids=BODIES)
LAYERS = ElasticBody.layered((0.05, 0.2), (Material(1.0, 0.2), Material(0.1, 0.4)), None)


def stiffness(nu, aspect_ratio, shape=SHAPE):
    return ElasticBody(nu, None if np.isinf(aspect_ratio) else aspect_ratio).response(shape)


@bodies
@pytest.mark.parametrize("wave", [(3, 0), (0, 2), (2, -3), (5, 4)])
def test_one_wave_of_traction_moves_the_surface_as_the_closed_form_says(nu, aspect_ratio, wave):
    """In the plane of the wave as (6.58) says; across it in pure shear, u = t / (G q coth(q z_m))."""
    k = np.hypot(*wave)
    along, phase = np.array(wave) / k, 2.0 * np.pi * (wave[0] * X + wave[1] * Y)
    across = np.array([-along[1], along[0]])
    shear = (1.0 - nu) / 2.0 * 2.0 * np.pi * k / np.tanh(2.0 * np.pi * k * aspect_ratio)
    t1, t2, t3 = 0.3, 0.5, 0.7
    u1, u3 = compliance_of_wave(k, nu, aspect_ratio) @ [t1, t3]

    def field(in_plane, out_of_plane, normal):
        sideways = np.multiply.outer(in_plane * along + out_of_plane * across, np.sin(phase))
        return np.concatenate((sideways, normal * np.cos(phase)[np.newaxis]))

    result = settled(stiffness(nu, aspect_ratio), field(t1, t2, t3), FREE)
    expected = field(u1, t2 / shear, u3)
    np.testing.assert_allclose(result.displacement, expected, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_uniform_tractions_and_displacements_shear_and_stretch_the_slab(nu):
    slab, pull = stiffness(nu, 0.2), np.multiply.outer([0.1, -0.3, 0.4], np.ones(SHAPE))
    c44, c11 = (1.0 - nu) / 2.0, (1.0 - nu) ** 2 / (1.0 - 2.0 * nu) if nu < 0.5 else np.inf
    result = settled(slab, pull, FREE)
    np.testing.assert_allclose(result.displacement[:2], pull[:2] * 0.2 / c44, rtol=1e-12)
    np.testing.assert_allclose(result.displacement[2], 0.4 * 0.2 / c11, rtol=1e-12, atol=1e-16)
    np.testing.assert_allclose(result.traction, pull, rtol=1e-11)
    if nu < 0.5:
        moved = np.multiply.outer([0.02, 0.01, -0.03], np.ones(SHAPE))
        held = settled(slab, FREE, moved)
        np.testing.assert_array_equal(held.displacement, moved)
        expected = moved / 0.2 * np.array([c44, c44, c11])[:, np.newaxis, np.newaxis]
        np.testing.assert_allclose(held.traction, expected, rtol=1e-11)


@pytest.mark.parametrize("along", ["x", "y"])
@pytest.mark.parametrize("body", [ElasticBody(0.3, None), ElasticBody(0.2, 0.3), ElasticBody(0.5, 0.3), LAYERS])
def test_ridges_are_profiles(body, along):
    """Tractions at most nodes and displacements at the others, as those of a profile."""
    n, across = 48, 5
    rng = np.random.default_rng(1)
    held = rng.random((2, n)) < 0.2
    held[:, 0] = True
    t, u = rng.normal(size=(2, 2, n))
    t, u = np.where(held, np.nan, t), np.where(held, 0.1 * u, np.nan)
    one = settled(body.response((n,)), t, u, residual=1e-12)

    def ridge(profile, nothing):
        tangential, normal = (np.tile(row, (across, 1)) for row in profile)
        flat = np.full((across, n), nothing)
        whole = np.stack((tangential, flat, normal))
        return whole if along == "x" else whole[[1, 0, 2]].swapaxes(1, 2)

    shape = (across, n) if along == "x" else (n, across)
    two = settled(body.response(shape), ridge(t, 0.0), ridge(u, np.nan), residual=1e-12)
    for found, profile in ((two.displacement, one.displacement), (two.traction, one.traction)):
        np.testing.assert_allclose(found, ridge(profile, 0.0), atol=1e-10 * np.abs(profile).max())


@bodies
def test_prescribed_boundaries_are_reciprocal_and_what_is_prescribed_holds(nu, aspect_ratio):
    """Two solutions with the same nodes held do the same work on each other (Betti)."""
    shape = 10, 12
    held = np.random.default_rng(3).random((3, *shape)) < 0.3
    cases, body = [], stiffness(nu, aspect_ratio, shape)
    for seed in (1, 2):
        t, u = np.random.default_rng(seed).normal(size=(2, 3, *shape))
        cases.append((np.where(held, np.nan, t), np.where(held, u, np.nan)))
    one, two = (settled(body, *case) for case in cases)
    assert (one.traction * two.displacement).mean() == pytest.approx((two.traction * one.displacement).mean(), rel=1e-7)
    for found, (t, u) in zip((one, two), cases, strict=True):
        np.testing.assert_array_equal(found.displacement[held], u[held])
        np.testing.assert_allclose(found.traction[~held], t[~held], atol=2e-10 * np.abs(found.traction).max())
    if np.isinf(body.normal[0, 0]):
        assert abs(one.displacement[2].mean()) < 1e-14


def test_the_response_of_a_map_is_the_inverse_of_its_stiffness():
    """On grids of odd and even numbers of nodes: what is restored at the displacements found is what was prescribed."""
    for shape in ((5, 7), (6, 8), (6, 7)):
        tractions, body = np.random.default_rng(4).normal(size=(3, *shape)), ElasticBody(0.3, 0.4).response(shape)
        xx, xy, yy, xz, yz, zz = body.elements
        x, y, z = np.fft.rfft2(body.apply(tractions))
        waves = (xx * x + xy * y + 1j * xz * z, xy * x + yy * y + 1j * yz * z, zz * z - 1j * (xz * x + yz * y))
        found = np.fft.irfft2(np.stack(waves), shape)
        np.testing.assert_allclose(found, tractions, atol=1e-12)
