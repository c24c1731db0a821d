"""Areal stiffness K(q) of an elastic body under frictionless normal load: p~(q) = K(q) w~(q).

Units: E* / L_x. The tangential displacement is eliminated exactly (Schur complement, thesis (6.75)), which leaves
the closed form of a layer bonded to a rigid base; with x = 2 q z_m and kolosov = 3 - 4 nu it reads

    K = q E*/2 * (2 kolosov cosh x + 1 + kolosov^2 + x^2) / (2 kolosov sinh x - 2 x).
"""

import math
from collections.abc import Callable

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import moduli

_SERIES = 1.0 / np.array([6.0, 120.0, 5040.0, 362880.0, 39916800.0, 6227020800.0, 1307674368000.0])


def half_space(q: Reals) -> Reals:
    """Stiffness q/2 of the half-space, in E*/L_x (6.75 for q z_m -> infinity)."""
    return 0.5 * q


def slab(q: Reals, poissons_ratio: float, aspect_ratio: float) -> Reals:
    """Stiffness of a slab of height `aspect_ratio` L_x on a rigid base, in E*/L_x; infinite at q = 0 if nu = 1/2."""
    k = q * aspect_ratio
    stiffness = np.empty_like(q)
    waves = q > 0.0
    stiffness[waves] = 0.5 * q[waves] * slab_factor(k[waves], poissons_ratio)
    stiffness[~waves] = uniform(poissons_ratio, aspect_ratio)
    return stiffness


def uniform(poissons_ratio: float, aspect_ratio: float) -> float:
    """Stiffness C11/z_m of the slab under uniform pressure, in E*/L_x (6.63); infinite for nu = 1/2."""
    return float(moduli.c11(poissons_ratio, aspect_ratio))


def slab_factor(k: Reals, poissons_ratio: float) -> Reals:
    """Ratio of slab to half-space stiffness at k = q z_m > 0, for -1 < nu <= 1/2."""
    kolosov = moduli.kolosov(poissons_ratio)
    x = 2.0 * k
    decay = np.exp(-x)
    # 2 kolosov sinh x - 2 x = 2 kolosov (sinh x - x) + 2 x (kolosov - 1): both terms are positive, nothing cancels.
    numerator = kolosov * (1.0 + decay**2) + (1.0 + kolosov**2 + np.where(decay > 0.0, x, 0.0) ** 2) * decay
    denominator = 2.0 * kolosov * scaled_sinh_minus_x(x) + 4.0 * (1.0 - 2.0 * poissons_ratio) * x * decay
    return numerator / denominator


def stiffening(poissons_ratio: float, aspect_ratio: float) -> float:
    """Largest relative stiffening of any wave by the rigid base, that of the longest wave."""
    k = min(2.0 * np.pi * aspect_ratio, 1e3)  # far beyond any effect, and its square is a number
    ratio = slab_factor(np.array([k]), poissons_ratio)[0] - 1.0
    # below rounding the exact ratio is out of reach; its leading term is not
    kolosov = moduli.kolosov(poissons_ratio)
    tail = (1.0 + kolosov**2 + 4.0 * k**2 + 4.0 * kolosov * k) * math.exp(-2.0 * k) / kolosov
    return float(ratio) if abs(ratio) > 1e-12 else tail


def deviation(of: Callable[[Reals], Reals], height: float) -> float:
    """Largest relative difference of a stiffness over q from that of the half-space, for waves of one period L_x.

    The difference stems from below the `height`; it fades with exp(-2 q height), so that longer waves have it.
    """
    index = np.unique(np.round(np.geomspace(1.0, max(1.0, 6.0 / height), 256)))
    q = 2.0 * np.pi * index
    return float(np.abs(of(q) / half_space(q) - 1.0).max())


def in_series(own: Reals, other: Reals, share: float) -> Reals:
    """Stiffness `[(ny,) nx // 2 + 1]` of two bodies under one pressure, whose displacements add up wave by wave.

    Each is given in its own E*, the result is in that of both together; `share` is the other's part of 1/E*.
    """
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / ((1.0 - share) / own + share / other))


def scaled_sinh_minus_x(x: Reals) -> Reals:
    """(sinh x - x) exp(-x) without cancellation at small x or overflow at large x."""
    decay = np.exp(-x)
    small = np.minimum(x, 1.0)
    series = small**3 * np.polynomial.polynomial.polyval(small**2, _SERIES) * decay
    direct = -0.5 * np.expm1(-2.0 * x) - x * decay
    return np.where(x < 1.0, series, direct)
