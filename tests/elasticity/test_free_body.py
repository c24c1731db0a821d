"""The kernel of a half-space without a period: against closed forms, high-precision integrals and convolutions."""

import mpmath
import numpy as np
import pytest

from gfmd_numba.elasticity import free_body
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse


def influence(n, dimension):
    """Displacement `[(y,) x]` at 0 ... n - 1 nodes from a node that bears a pressure of E*, in L_x."""
    shape = (2 * n,) * dimension
    found = np.fft.irfftn(free_body.compliance((n,) * dimension)[0], shape, axes=range(dimension))
    return found[(slice(n),) * dimension]


def test_the_transform_of_a_profile_s_kernel_is_that_of_a_cut_logarithm():
    """Int_0^1 (4 / pi) ln(1 / x) cos(q x) dx, by parts and to 30 digits."""
    found = free_body.compliance((64,))[0]
    with mpmath.workdps(30):
        for k in (1, 2, 17):
            q = mpmath.pi * k
            exact = (
                4 / mpmath.pi * mpmath.quad(lambda x, q=q: mpmath.sin(q * x) / (q * x), mpmath.linspace(0, 1, k + 1))
            )
            assert found[k] == pytest.approx(float(exact), rel=1e-13)
    assert found[0] == pytest.approx(4.0 / np.pi, rel=1e-15)


@pytest.mark.parametrize("n", [4, 7, 16, 33, 128])
def test_compliances_are_positive_and_those_of_short_waves_nearly_a_periodic_half_space_s(n):
    line, surface = (free_body.compliance((n,) * dimension)[0] for dimension in (1, 2))
    assert line.shape == (n + 1,)
    assert surface.shape == (2 * n, n + 1)
    assert line.min() > 0.0
    assert surface.min() > 0.0
    q = np.pi * np.arange(1, n + 1)
    np.testing.assert_allclose(line[1:] * q / 2.0, 1.0, atol=0.2)
    np.testing.assert_allclose(surface[0, 1:] * q / 2.0, 1.0, atol=0.2)


def test_a_window_is_square():
    with pytest.raises(ValueError, match="not as many along y as along x"):
        free_body.compliance((8, 16))


def test_a_map_s_kernel_is_that_of_waves_up_to_nyquist_all_over_the_plane():
    """(1 / (2 pi)^2) int 2 / q exp(i q r) over the square |q_x|, |q_y| < pi n, at the distances of the nodes."""
    n = 16
    found = influence(n, 2)
    with mpmath.workdps(20):
        for y, x in ((0, 0), (3, 5), (15, 15)):

            def along(phi, y=y, x=x):  # the integral over q is known
                way = mpmath.cos(phi) * x + mpmath.sin(phi) * y
                edge = mpmath.pi / max(abs(mpmath.cos(phi)), abs(mpmath.sin(phi)))
                return mpmath.sin(edge * way) / way if abs(way) > mpmath.mpf(10) ** -12 else edge

            ends = [mpmath.pi * i / 16 for i in range(17)]
            exact = mpmath.quad(along, ends) / mpmath.pi**2 / n
            assert found[y, x] == pytest.approx(
                float(exact), abs=1e-4 * found[0, 0]
            )  # waves of a finite period end at Nyquist less sharply


def test_far_from_a_force_the_surface_is_displaced_as_boussinesq_has_it():
    """Along the diagonal: along an axis waves at Nyquist go on and on."""
    n = 64
    diagonal = np.diag(influence(n, 2))[8:]
    r = np.sqrt(2.0) * np.arange(8, n) / n
    np.testing.assert_allclose(diagonal * n**2, 1.0 / (np.pi * r), rtol=5e-5)


def test_smooth_pressures_displace_the_surface_as_their_convolution_does():
    """Hertz's pressures on a sphere and a cylinder, of order 2 in the spacing."""
    a, errors = 0.25, []
    for n in (32, 64, 128):
        x = (np.arange(n) + 0.5) / n - 0.5
        r2 = x**2 + x[:, np.newaxis] ** 2
        of_map = np.zeros((2 * n, 2 * n))
        of_map[:n, :n] = np.sqrt(np.maximum(1.0 - r2 / a**2, 0.0))
        waves = np.fft.rfft2(of_map) * free_body.compliance((n, n))[0]
        u = np.fft.irfft2(waves, of_map.shape)[:n, :n]
        inside = r2 < (0.8 * a) ** 2
        exact = np.pi / (4.0 * a) * (2.0 * a**2 - r2)  # Johnson, Contact Mechanics, (3.41a), p_0 = E*
        errors.append(abs(u - exact)[inside].max() / a)
        of_line = np.zeros(2 * n)
        of_line[:n] = np.sqrt(np.maximum(1.0 - (x / a) ** 2, 0.0))
        line = np.fft.irfft(np.fft.rfft(of_line) * free_body.compliance((n,))[0], 2 * n)[:n]
        close = abs(x) < 0.8 * a
        known = a * (np.log(2.0 / a) + 0.5 - (x / a) ** 2)  # beyond depth L_x nothing moves
        assert abs(line - known)[close].max() < 3.0 / n**1.5
    assert errors[-1] < 2e-3


@pytest.mark.parametrize("nu", [0.05, 0.3, 0.5])
@pytest.mark.parametrize("shape", [(16,), (33,), (16, 16), (33, 33)])
def test_a_wave_of_tractions_does_positive_work_on_all_displacements(shape, nu):
    softest, stiffest = free_body.response(shape, ElasticBody(nu, None), couples=True).extremes()
    assert softest > 0.2
    assert stiffest < 2.0 * np.pi * shape[0] * 20.0
    condensed = free_body.response(shape, ElasticBody(nu, None)).normal
    np.testing.assert_allclose(
        1.0 / free_body.response(shape, ElasticBody(nu, None), couples=True).inverse()[-1], condensed, rtol=1e-12
    )  # no pressure is borne by tangential tractions


def test_a_line_load_along_the_surface_moves_it_as_one_across_does_and_by_poisson_s_ratio_out_of_it():
    """Of a half-space; the tractions add up to 0, so that its place does not matter (Johnson, 2.4 and 2.22)."""
    n, nu, load = 64, 0.2, np.zeros(64)
    load[[20, 40]] = n, -n
    along, out = free_body.displaced(np.stack((load, 0.0 * load)), ElasticBody(nu, None), (True,))
    across = free_body.displaced(load[np.newaxis], ElasticBody(nu, None), (True,))[0]
    np.testing.assert_allclose(along, across, atol=1e-2 * np.ptp(across))  # but for the wave at Nyquist
    between = out[25:36].mean() - 0.5 * (out[5:15].mean() + out[45:55].mean())
    assert abs(between) == pytest.approx((1.0 - 2.0 * nu) / (1.0 - nu), rel=1e-2)


def test_tangential_forces_displace_the_surface_as_cerruti_has_it():
    """A smooth traction along x, far away: Johnson, Contact Mechanics, (3.91), E* = 1."""
    n, nu = 64, 0.3
    traction = np.zeros((3, 2 * n, 2 * n))
    i = np.arange(9)
    bump = np.sin(np.pi * (i + 0.5) / 9) ** 2
    traction[0, 20:29, 10:19] = bump[:, np.newaxis] * bump
    force = traction[0].sum() / n**2
    u = free_body.response((n, n), ElasticBody(nu, None), couples=True).apply(traction)[:, :n, :n]
    modulus = 0.5 * (1.0 - nu)  # G
    for y, x in ((24, 50), (24, 62), (60, 50), (50, 14), (60, 60)):
        dx, dy = (x - 14) / n, (y - 24) / n
        r = np.hypot(dx, dy)
        scale = force / (2.0 * np.pi * modulus * r)
        expected = ((1.0 - nu) + nu * dx**2 / r**2, nu * dx * dy / r**2, (0.5 - nu) * dx / r)
        np.testing.assert_allclose(u[:2, y, x] / scale, expected[:2], atol=0.01)
        # into the body ahead of the force in Johnson's axes, out of it in ours: z points out
        assert abs(u[2, y, x] / scale) == pytest.approx(abs(expected[2]), abs=0.01)


@pytest.mark.parametrize("shape", [(64,), (64, 64)])
def test_short_waves_meet_the_stiffness_of_a_periodic_half_space(shape):
    wide = free_body.padded_shape(shape)
    found = free_body.response(shape, ElasticBody(0.3, None), couples=True).inverse()
    periodic = SpectralResponse(ElasticBody(0.3, None).response(wide).elements / 2.0)  # in L_x, half the period
    elsewhere = tuple(slice(8, 20) for _ in shape)
    for one, other in zip(found, periodic.inverse(), strict=True):
        assert (one[elsewhere] / other[elsewhere]).mean() == pytest.approx(1.0, abs=0.02)
