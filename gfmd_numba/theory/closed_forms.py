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
