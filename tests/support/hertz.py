"""Hertz's contact of an ellipsoid with a half-space of E* = 1."""

from typing import NamedTuple

import numpy as np
from scipy.special import ellipe, ellipk


class Ellipse(NamedTuple):
    """Form of the punch, the load on it, and how far it sinks in."""

    form: dict[str, float]
    load: float
    approach: float


def ellipse(a, ratio, peak):
    """Contact of half-axes a along x and a / ratio along y, by its peak pressure (Johnson 1985, 4.26 to 4.32)."""
    m, b = 1.0 - ratio**-2, a / ratio
    k, e = ellipk(m), ellipe(m)
    half_curvatures = (peak * b / (a**2 * m) * each for each in (k - e, ratio**2 * e - k))
    form = dict(zip(("radius", "radius_y"), (float(0.5 / each) for each in half_curvatures), strict=True))
    return Ellipse(form, float(2.0 / 3.0 * np.pi * a * b * peak), float(peak * b * k))
