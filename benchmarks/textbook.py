"""Closed forms that tests and benchmarks alone need; lengths in L_x, stresses in E*, x measured from the summit."""

import numpy as np
import slab_stiffness

from gfmd_numba.theory.damping import critical_damping


def westergaard_mean_gap(mean_pressure, amplitude):
    """Mean gap under the wave `amplitude` cos(2 pi x) before full contact, without pressure the amplitude.

    Its slope -ln(p_full/p) / pi is the compliance of a row of flat punches as wide as the contacts (Koiter 1959, for
    the cracks between them), as contacts grow by strips without pressure.
    """
    load = min(mean_pressure / (np.pi * amplitude), 1.0)
    return float(amplitude * (1.0 - load * (1.0 - np.log(load)))) if load > 0.0 else amplitude


def hertz_line_half_width(mean_pressure, radius):
    """Half width of a row of parabolic cylinders at distance 1 (Johnson 1985, 4.43, with the nearest correction).

    The neighbours displace the surface by -(2 p / pi E*) ln |2 sin(pi x)|, whose curvature at the summit adds
    2 pi p / (3 E* L_x^2) to 1 / radius; what is left out is of fourth order in width over L_x.
    """
    curvature = 1.0 / radius + 2.0 * np.pi * mean_pressure / 3.0
    return float(np.sqrt(4.0 * mean_pressure / (np.pi * curvature)))


def hertz_line_pressure(x, mean_pressure, radius):
    """Pressure under the summit at x = 0 of that row of cylinders (Johnson 1985, 4.44)."""
    half_width = hertz_line_half_width(mean_pressure, radius)
    inside = np.maximum(1.0 - (x / half_width) ** 2, 0.0)
    return np.asarray(2.0 * mean_pressure / (np.pi * half_width) * np.sqrt(inside))


def hertz_ball_radius(mean_pressure, radius):
    """Contact radius of paraboloids at distance 1 both ways (Johnson 1985, 4.22, with the nearest correction).

    The neighbours displace the surface by -p / (pi E* r), whose curvature at the summit adds p sum(1 / r^3) / (2 pi E*)
    to 1 / radius, with a sum of 9.0336 over a square lattice; what is left out is of fifth order in radius over L_x.
    """
    curvature = 1.0 / radius + 9.0336 * mean_pressure / (2.0 * np.pi)
    return float((0.75 * mean_pressure / curvature) ** (1.0 / 3.0))


def principal_elements(k, poissons_ratio):
    """Smaller and larger eigenvalue of C11 M of a slab, in E*: kappa_3'/q and kappa_1'/q (6.84), section 6.3.6."""
    a11, a13, a33 = slab_stiffness.slab_elements(k, poissons_ratio)
    larger = 0.5 * (a11 + a33) + np.hypot(0.5 * (a11 - a33), a13)
    # the determinant over the larger eigenvalue: subtracting the root would cancel where the slab is thin
    return slab_stiffness.condensed_elements(k, poissons_ratio)[0] * a33 / larger, larger


def scalar_damping(stiffnesses, time_step):
    """Largest eta that over-damps none of the modes (6.3), in 1/time^2.

    (6.41) is concave in sqrt(K), so one of the two extreme modes decides; it is the softest as long as
    dt (sqrt(Kmin) + sqrt(Kmax)) <= 2.
    """
    softest, stiffest = float(stiffnesses.min()), float(stiffnesses.max())
    return min(critical_damping(softest, time_step), critical_damping(stiffest, time_step))
