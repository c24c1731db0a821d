"""Prescribed tractions and displacements: closed forms, manufactured solutions and reciprocity."""

import numpy as np
import pytest

from gfmd_numba.fourier import grid
from support.coupled_bodies import FREE, NX, X, body, compliance_of_wave, settled

BODIES = {
    "half-space": (0.3, np.inf),
    "slab": (0.3, 0.1),
    "incompressible half-space": (0.5, np.inf),
    "incompressible slab": (0.5, 0.2),
}
bodies = pytest.mark.parametrize(("nu", "aspect_ratio"), BODIES.values(), ids=BODIES)


def restored(stiffness, u):
    """Tractions [component, x] that displacements call up; the mean normal one of an incompressible slab is left 0."""
    c1, c3 = grid.coefficients(np.asarray(u))
    k33 = np.where(np.isfinite(stiffness.normal), stiffness.normal, 0.0)
    f1, f3 = stiffness.elements[0] * c1 + 1j * stiffness.elements[1] * c3, k33 * c3 - 1j * stiffness.elements[1] * c1
    return np.stack([grid.signal(f1, len(u[0])), grid.signal(f3, len(u[0]))])


def fields(seed, nx=NX):
    """Smooth random displacements [component, x] without means."""
    rng = np.random.default_rng(seed)
    waves = np.arange(1, 9)
    amplitudes, phases = rng.normal(size=(2, 8, 1)) / waves[:, None], rng.uniform(0, 2 * np.pi, (2, 8, 1))
    x = np.arange(nx) / nx
    return (amplitudes * np.cos(2 * np.pi * waves[:, None] * x + phases)).sum(axis=1)


def mixed(u, traction, seed, share=0.3):
    """Displacements at random nodes of each component, tractions at the others."""
    held = np.random.default_rng(seed).random(u.shape) < share
    held[:, 0] = True
    return np.where(held, np.nan, traction), np.where(held, u, np.nan)


@bodies
@pytest.mark.parametrize("k", [1, 5, 40])
def test_one_wave_of_traction_moves_the_surface_as_the_compliance_says(nu, aspect_ratio, k):
    phase = 2 * np.pi * k * X
    t = np.array([0.3, 0.7])
    result = settled(body(nu, aspect_ratio), t[:, None] * np.stack([np.sin(phase), np.cos(phase)]), FREE)
    u = compliance_of_wave(k, nu, aspect_ratio) @ t
    expected = u[:, None] * np.stack([np.sin(phase), np.cos(phase)])
    np.testing.assert_allclose(result.displacement, expected, atol=1e-13 * abs(u).max())


@pytest.mark.parametrize(("nu", "normal"), [(0.3, 0.4 * 0.2 / (0.7**2 / 0.4)), (0.5, 0.0)])
def test_uniform_tractions_shear_and_stretch_the_slab(nu, normal):
    result = settled(body(nu, 0.2), np.array([0.1, 0.4])[:, None] + np.zeros((2, NX)), FREE)
    shear = (1 - nu) / 2  # in E*
    np.testing.assert_allclose(result.displacement[0], 0.1 * 0.2 / shear, rtol=1e-13)
    np.testing.assert_allclose(result.displacement[1], normal, rtol=1e-13, atol=1e-16)
    np.testing.assert_allclose(result.traction[1], 0.4, rtol=1e-12)


@bodies
def test_mixed_boundaries_recover_the_fields_they_were_cut_from(nu, aspect_ratio):
    stiffness, u = body(nu, aspect_ratio), fields(0)
    if np.isfinite(aspect_ratio):
        u[0] += 0.4
        u[1] += 0.0 if nu == 0.5 else -0.3
    t = restored(stiffness, u)
    uniform = 0.2 if nu == 0.5 and np.isfinite(aspect_ratio) else 0.0
    t[1] += uniform  # a pressure that an incompressible slab bears without moving
    for seed in range(2):
        result = settled(stiffness, *mixed(u, t, seed))
        np.testing.assert_allclose(result.displacement, u, atol=1e-8 * abs(u).max())
        np.testing.assert_allclose(result.traction, t, atol=1e-8 * abs(t).max())


@bodies
def test_prescribed_boundaries_are_reciprocal_superpose_and_balance(nu, aspect_ratio):
    stiffness, held = body(nu, aspect_ratio), mixed(np.ones((2, NX)), FREE, 3)[1] == 1
    cases = []
    for seed in (1, 2):
        t, u = np.random.default_rng(seed).normal(size=(2, 2, NX))
        cases.append((np.where(held, np.nan, t), np.where(held, u, np.nan)))
    one, two, both = (settled(stiffness, *case) for case in (*cases, [a + b for a, b in zip(*cases, strict=True)]))
    np.testing.assert_allclose(one.displacement + two.displacement, both.displacement, atol=1e-7)
    work = (one.traction * two.displacement).mean()
    assert work == pytest.approx((two.traction * one.displacement).mean(), rel=1e-7)
    (shift, rise), (shear, pull) = one.displacement.mean(axis=1), one.traction.mean(axis=1)
    assert shear == pytest.approx(stiffness.elements[0][0] * shift, abs=1e-9)  # the base bears what the surface does
    if np.isinf(stiffness.normal[0]):
        assert abs(rise) < 1e-14
    else:
        assert pull == pytest.approx(stiffness.normal[0] * rise, abs=1e-9)
