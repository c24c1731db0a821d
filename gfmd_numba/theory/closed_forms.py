"""Closed forms that contacts are checked against; lengths in L_x, stresses in E*, x measured from the summit."""

import numpy as np

from gfmd_numba.arrays import Reals


def westergaard_half_width(mean_pressure: float, amplitude: float) -> float:
    """Half the contact length of the wave `amplitude` cos(2 pi x) under a mean pressure (Westergaard 1939)."""
    full_contact = np.pi * amplitude
    return float(np.arcsin(np.sqrt(min(mean_pressure / full_contact, 1.0))) / np.pi)


def westergaard_pressure(x: Reals, mean_pressure: float, amplitude: float) -> Reals:
    """Pressure under the wave `amplitude` cos(2 pi x) before full contact (Westergaard 1939)."""
    edge = np.sin(np.pi * westergaard_half_width(mean_pressure, amplitude)) ** 2
    inside = np.maximum(edge - np.sin(np.pi * x) ** 2, 0.0)
    return np.asarray(2.0 * mean_pressure * np.cos(np.pi * x) * np.sqrt(inside) / edge)


def westergaard_mean_gap(mean_pressure: float, amplitude: float) -> float:
    """Mean gap under the wave `amplitude` cos(2 pi x) before full contact, without pressure the amplitude.

    Its slope -ln(p_full/p) / pi is the compliance of a row of flat punches as wide as the contacts (Koiter 1959, for
    the cracks between them), as contacts grow by strips without pressure.
    """
    load = min(mean_pressure / (np.pi * amplitude), 1.0)
    return float(amplitude * (1.0 - load * (1.0 - np.log(load)))) if load > 0.0 else amplitude


def hertz_line_half_width(mean_pressure: float, radius: float) -> float:
    """Half width of a row of parabolic cylinders at distance 1 (Johnson 1985, 4.43, with the nearest correction).

    The neighbours displace the surface by -(2 p / pi E*) ln |2 sin(pi x)|, whose curvature at the summit adds
    2 pi p / (3 E* L_x^2) to 1 / radius; what is left out is of fourth order in width over L_x.
    """
    curvature = 1.0 / radius + 2.0 * np.pi * mean_pressure / 3.0
    return float(np.sqrt(4.0 * mean_pressure / (np.pi * curvature)))


def hertz_line_pressure(x: Reals, mean_pressure: float, radius: float) -> Reals:
    """Pressure under the summit at x = 0 of that row of cylinders (Johnson 1985, 4.44)."""
    half_width = hertz_line_half_width(mean_pressure, radius)
    inside = np.maximum(1.0 - (x / half_width) ** 2, 0.0)
    return np.asarray(2.0 * mean_pressure / (np.pi * half_width) * np.sqrt(inside))


def hertz_ball_radius(mean_pressure: float, radius: float) -> float:
    """Contact radius of paraboloids at distance 1 both ways (Johnson 1985, 4.22, with the nearest correction).

    The neighbours displace the surface by -p / (pi E* r), whose curvature at the summit adds p sum(1 / r^3) / (2 pi E*)
    to 1 / radius, with a sum of 9.0336 over a square lattice; what is left out is of fifth order in radius over L_x.
    """
    curvature = 1.0 / radius + 9.0336 * mean_pressure / (2.0 * np.pi)
    return float((0.75 * mean_pressure / curvature) ** (1.0 / 3.0))
