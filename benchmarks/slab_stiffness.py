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

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.layers import scaled_sinh_minus_x


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
