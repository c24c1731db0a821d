"""Waves inside a body from its surface: the matrix of (2.4), free of overflow and of cancellation.

One wave of the body is u_1 = U_1(z) cos(qx), u_3 = U_3(z) sin(qx). With k = q z_m, y = q (z_m - depth),
kappa = 3 - 4 nu, S = sinh and C = cosh, (2.4) says U_1 = g_1 A_1 - g_2 A_2 and U_3 = g_2 A_1 + g_3 A_2 with
g_1 = kappa S + y C, g_2 = y S, g_3 = kappa S - y C. Two conjugate harmonic functions hold all the rest:

    P = -S A_1 + C A_2 (dilatation 2 (1 - 2 nu) q P),    W = C A_1 - S A_2 (rotation 2 (1 - nu) q W),    P' = -q W,

so that stresses over the shear modulus stay finite at nu = 1/2. A_1 and A_2 are eliminated for the displacements of the
surface; what is left is a quotient over D = kappa^2 S(k)^2 - k^2, in depths as exp(-q depth), in thin slabs without
differences of nearly equal terms.
"""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity.stiffness import scaled_sinh_minus_x


@dataclass(frozen=True)
class Transfer:
    """What one unit of U_1 and of U_3 at the surface makes of U_1, U_3, P and W at a depth, wave by wave."""

    u1: tuple[Reals, Reals]
    u3: tuple[Reals, Reals]
    p: tuple[Reals, Reals]
    w: tuple[Reals, Reals]


def half_space(d: Reals, poissons_ratio: float) -> Transfer:
    """Transfer to d = q depth in the half-space, the limit of (2.4) for z_m -> infinity."""
    kappa = 3.0 - 4.0 * poissons_ratio
    decay = np.exp(-d)
    slope, inverse = d / kappa * decay, decay / kappa
    return Transfer((decay - slope, slope), (-slope, decay + slope), (-inverse, inverse), (inverse, -inverse))


def slab(depth: float, q: Reals, aspect_ratio: float, poissons_ratio: float) -> Transfer:
    """Transfer to a depth (L_x) for q > 0 (1/L_x) in a slab on a rigid base, -1 < nu <= 1/2 (2.4)."""
    k, d = q * aspect_ratio, q * depth
    y = q * (aspect_ratio - depth)
    thin, kappa = k < 1.0, 3.0 - 4.0 * poissons_ratio
    parts = np.empty((8, len(q)))
    parts[:, thin] = _thin(y[thin], k[thin], d[thin], kappa)
    parts[:, ~thin] = _thick(y[~thin], k[~thin], d[~thin], kappa)
    return Transfer(*((parts[2 * i], parts[2 * i + 1]) for i in range(4)))


def _thick(y: Reals, k: Reals, d: Reals, kappa: float) -> list[Reals]:
    """All numerators and D times 4 exp(-2k)."""
    at_depth, at_image = np.exp(-d), np.exp(-(k + y))
    less_y, less_k, less_d = -np.expm1(-2.0 * y), -np.expm1(-2.0 * k), -np.expm1(-2.0 * d)
    ss, cs = at_depth * less_y * less_k, at_depth * (2.0 - less_y) * less_k  # S(y) S(k) and C(y) S(k)
    sinh_d, cosh_d = 2.0 * at_image * less_d, 2.0 * at_image * (2.0 - less_d)
    # k S(y) C(k) - y C(y) S(k)
    crossed = d * at_depth * -np.expm1(-2.0 * (k + y)) - (k + y) * at_image * less_d
    even, odd = kappa**2 * ss - y * k * cosh_d, kappa * crossed
    shear, image = kappa * d * ss, y * k * sinh_d
    determinant = (kappa * less_k - 2.0 * k * np.exp(-k)) * (kappa * less_k + 2.0 * k * np.exp(-k))
    numerators = [
        *(even - odd, shear + image),
        *(image - shear, even + odd),
        *(-kappa * ss - k * sinh_d, kappa * cs + k * cosh_d),
        *(kappa * cs - k * cosh_d, k * sinh_d - kappa * ss),
    ]
    return [numerator / determinant for numerator in numerators]


def _thin(y: Reals, k: Reals, d: Reals, kappa: float) -> list[Reals]:
    """For k < 1: with g_3 free of cancellation every term is of the order of the result."""
    excess = kappa - 1.0
    sinh_y, cosh_y, sinh_k = np.sinh(y), np.cosh(y), np.sinh(k)
    g3_y, g3_k = excess * sinh_y - _bend(y), excess * sinh_k - _bend(k)
    ss, yk = sinh_y * sinh_k, y * k
    determinant = (kappa * scaled_sinh_minus_x(k) * np.exp(k) + excess * k) * (kappa * sinh_k + k)
    numerators = [
        *((kappa * sinh_y + y * cosh_y) * g3_k + yk * ss, kappa * d * ss + yk * np.sinh(d)),
        *(y * sinh_y * g3_k - k * sinh_k * g3_y, yk * ss + g3_y * (kappa * sinh_k + k * np.cosh(k))),
        *(-kappa * ss - k * np.sinh(d), kappa * cosh_y * sinh_k + k * np.cosh(d)),
        *(cosh_y * g3_k + k * ss, k * np.sinh(d) - kappa * ss),
    ]
    return [numerator / determinant for numerator in numerators]


def _bend(x: Reals) -> Reals:
    """Return x cosh x - sinh x for 0 <= x < 1."""
    return np.asarray(2.0 * x * np.sinh(0.5 * x) ** 2 - scaled_sinh_minus_x(x) * np.exp(x))
