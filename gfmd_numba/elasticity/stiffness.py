"""Stiffness of a half-space and of a slab bonded to a rigid base, wave by wave, in E*/L_x.

Under a frictionless normal load p~(q) = K(q) w~(q). The tangential displacement is eliminated exactly (Schur
complement, thesis (6.75)), which leaves, with x = 2 q z_m and kolosov = 3 - 4 nu,

    K = q E*/2 * (2 kolosov cosh x + 1 + kolosov^2 + x^2) / (2 kolosov sinh x - 2 x).

The stiffness of both displacements of one wave is q C11 times the Hermitian matrix [[M11, -i M13], [i M13, M33]] of
(6.57). With k = q z_m > 0, and in E* instead of C11 so that nothing is infinite at nu = 1/2, its elements are (6.58)

    C11 M11 / E* = 2 (1 - nu)^2 (kolosov sinh k cosh k - k) / D,    D = (kolosov sinh k - k) (kolosov sinh k + k),
    C11 M33 / E* = 2 (1 - nu)^2 (kolosov sinh k cosh k + k) / D,
    C11 M13 / E* = (1 - nu) / 2 * (kolosov (kolosov - 1) sinh^2 k - 2 k^2) / D.

Below, sinh k and cosh k are scaled by exp(-k), and a difference is a sum of terms of one sign wherever it can be: only
M13, which passes through zero for 1/4 < nu < 1/2, loses digits, and only there. Of these elements `poissons_ratio` may
be an array that broadcasts with k; it is at most 1/2, and any lower value is served (s = C44/C11 -> 1 for
nu -> -infinity).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
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


def slab_elements(k: Reals, poissons_ratio: Reals | float) -> tuple[Reals, Reals, Reals]:
    """C11 M11, C11 M13 and C11 M33 of a slab bonded to a rigid base, in E*, for k = q z_m > 0 and nu <= 1/2 (6.58).

    (2.12) and (5.11) print the second term of M13 with the wrong sign. Raises ValueError for other k and nu.
    """
    terms = _Terms(k, poissons_ratio)
    scale = 2.0 * (1.0 - terms.nu) ** 2 / terms.d
    return scale * terms.n11, 0.5 * (1.0 - terms.nu) * terms.n13 / terms.d, scale * terms.n33


def half_space_elements(poissons_ratio: Reals | float) -> tuple[Reals, Reals, Reals]:
    """C11 M11, C11 M13 and C11 M33 of the half-space, in E*, for nu <= 1/2 (6.83)."""
    nu = np.asarray(poissons_ratio, dtype=np.float64)
    kolosov = moduli.kolosov(nu)
    diagonal = 2.0 * (1.0 - nu) ** 2 / kolosov
    return diagonal, (1.0 - nu) * (1.0 - 2.0 * nu) / kolosov, diagonal


def uniform_stiffness(poissons_ratio: Reals | float, aspect_ratio: Reals | float) -> tuple[Reals, Reals]:
    """Stiffness C44/z_m and C11/z_m of uniform tangential and normal displacement, in E*/L_x (6.66)."""
    return moduli.c44(poissons_ratio) / aspect_ratio, moduli.c11(poissons_ratio) / aspect_ratio


def condensed_elements(k: Reals, poissons_ratio: Reals | float) -> tuple[Reals, Reals]:
    """Stiffness over q, in E*, of a slab loaded only tangentially and only normally (6.75), (6.78)."""
    terms = _Terms(k, poissons_ratio)
    return terms.det / (8.0 * terms.n33), terms.det / (8.0 * terms.n11)


class _Terms:
    """Numerators, denominator and determinant of (6.58), all scaled by exp(-2 k)."""

    def __init__(self, k: Reals, poissons_ratio: Reals | float) -> None:
        self.nu = nu = np.asarray(poissons_ratio, dtype=np.float64)
        if not (nu <= 0.5).all():
            raise ValueError("poissons_ratio must be at most 1/2")
        if not (np.asarray(k) > 0.0).all():
            raise ValueError("k = q z_m must be positive; the uniform modes have uniform_stiffness()")
        kolosov, excess = moduli.kolosov(nu), 2.0 * (1.0 - 2.0 * nu)  # excess = kolosov - 1, exact near nu = 1/2
        decay = np.exp(-k)
        damped = np.where(decay > 0.0, k, 0.0) * decay  # k exp(-k)
        sinh, less = -0.5 * np.expm1(-2.0 * k), scaled_sinh_minus_x(k)
        self.decayed_k = damped * decay
        self.d = (kolosov * less + excess * damped) * (kolosov * sinh + damped)
        self.n11 = 0.5 * kolosov * scaled_sinh_minus_x(2.0 * k) + excess * self.decayed_k
        self.n33 = 0.5 * kolosov * sinh * (1.0 + decay**2) + self.decayed_k
        # kolosov (kolosov - 1) - 2 = 4 (1 - 4 nu) (1 - nu)
        self.n13 = kolosov * excess * less * (sinh + damped) + 4.0 * (1.0 - 4.0 * nu) * (1.0 - nu) * damped**2
        self.det = kolosov * (1.0 + decay**4) + (1.0 + kolosov**2) * decay**2 + 4.0 * damped**2


@dataclass(frozen=True)
class Compliance:
    """Elements S11, S13, S33 of the inverse of the stiffness (6.57) `[nx // 2 + 1]`, in L_x/E*."""

    s11: Reals
    s13: Reals
    s33: Reals

    @property
    def elements(self) -> tuple[Reals, Reals, Reals]:
        """The elements of the inverse matrix, in the order and with the signs of those of the stiffness."""
        return self.s11, -self.s13, self.s33

    def displacements(self, tangential: Complexes, normal: Complexes) -> tuple[Complexes, Complexes]:
        """Coefficients `[nx // 2 + 1]` of both displacements, tangential and normal, under those of both tractions."""
        return self.s11 * tangential - 1j * self.s13 * normal, self.s33 * normal + 1j * self.s13 * tangential
