"""Persson's theory of contacts without adhesion and friction, for any elastic body (thesis appendix 4.A, corrected).

The one property of surface and body it knows is the rms fluctuation s of the pressure in full contact,
s^2 = sum_q K(q)^2 |h~(q)|^2 over all waves but the mean. On a half-space s = g E*/2, whatever the spectrum; on a slab s
is larger. Campaigns record it as `full_contact_rms_pressure`. The thesis's G is s^2 / 2, so (g E*)^2 / 8 in its (4.18).
"""

import numpy as np
import numpy.typing as npt
import scipy  # its modules load with their first use

from gfmd_numba.arrays import Reals


def contact_area_fraction(mean_pressure: npt.ArrayLike, full_contact_rms_pressure: npt.ArrayLike) -> Reals:
    """Contact area over nominal area erf(p / (s sqrt 2)), of arrays that broadcast, in one unit (4.16)."""
    ratio = np.asarray(mean_pressure, dtype=np.float64) / np.asarray(full_contact_rms_pressure, dtype=np.float64)
    return np.asarray(scipy.special.erf(ratio / np.sqrt(2.0)))


def pressure_density(
    pressure: npt.ArrayLike, mean_pressure: npt.ArrayLike, full_contact_rms_pressure: npt.ArrayLike
) -> Reals:
    """Density of the pressures above 0 (4.9), in one over their unit: a Gaussian less its mirror image at p = 0.

    Its integral is the contact area fraction, its first moment the mean pressure; arrays broadcast.
    """
    s = np.asarray(full_contact_rms_pressure, dtype=np.float64)
    p, mean = np.asarray(pressure, dtype=np.float64) / s, np.asarray(mean_pressure, dtype=np.float64) / s
    # the two exponentials of (4.9) in one product: at light loads they are almost equal
    density = -np.expm1(-2.0 * p * mean) * np.exp(-0.5 * (p - mean) ** 2) / (s * np.sqrt(2.0 * np.pi))
    return np.asarray(np.where(p > 0.0, density, 0.0))
