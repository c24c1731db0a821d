"""Waves inside a body from its surface: the matrix of (2.4), free of overflow and of cancellation.

One wave of the body is u_1 = U_1(z) cos(qx), u_3 = U_3(z) sin(qx). With k = q z_m, y = q (z_m - depth),
kolosov = 3 - 4 nu, S = sinh and C = cosh, (2.4) says U_1 = g_1 A_1 - g_2 A_2 and U_3 = g_2 A_1 + g_3 A_2 with
g_1 = kolosov S + y C, g_2 = y S, g_3 = kolosov S - y C. Two conjugate harmonic functions hold all the rest:

    P = -S A_1 + C A_2 (dilatation 2 (1 - 2 nu) q P),    W = C A_1 - S A_2 (rotation 2 (1 - nu) q W),    P' = -q W,

so that stresses over the shear modulus stay finite at nu = 1/2. A_1 and A_2 are eliminated for the displacements of the
surface; what is left is a quotient over D = kolosov^2 S(k)^2 - k^2, in depths as exp(-q depth), in thin slabs without
differences of nearly equal terms.
"""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.stiffness import scaled_sinh_minus_x


@dataclass(frozen=True)
class Transfer:
    """What one unit of U_1 and of U_3 at the surface makes of U_1, U_3, P and W at a depth, wave by wave."""

    u1: tuple[Reals, Reals]
    u3: tuple[Reals, Reals]
    p: tuple[Reals, Reals]
    w: tuple[Reals, Reals]


def half_space_transfer(d: Reals, poissons_ratio: float) -> Transfer:
    """Transfer to d = q depth in the half-space, the limit of (2.4) for z_m -> infinity."""
    kolosov = moduli.kolosov(poissons_ratio)
    decay = np.exp(-d)
    slope, inverse = d / kolosov * decay, decay / kolosov
    return Transfer((decay - slope, slope), (-slope, decay + slope), (-inverse, inverse), (inverse, -inverse))


def slab_transfer(depth: float, q: Reals, aspect_ratio: float, poissons_ratio: float) -> Transfer:
    """Transfer to a depth (L_x) for q > 0 (1/L_x) in a slab on a rigid base, -1 < nu <= 1/2 (2.4)."""
    k, d = q * aspect_ratio, q * depth
    y = q * (aspect_ratio - depth)
    thin, kolosov = k < 1.0, moduli.kolosov(poissons_ratio)
    parts = np.empty((8, len(q)))
    parts[:, thin] = _thin(y[thin], k[thin], d[thin], kolosov)
    parts[:, ~thin] = _thick(y[~thin], k[~thin], d[~thin], kolosov)
    return Transfer(*((parts[2 * i], parts[2 * i + 1]) for i in range(4)))


def _thick(y: Reals, k: Reals, d: Reals, kolosov: float) -> list[Reals]:
    """All numerators and D times 4 exp(-2k)."""
    at_depth, at_image = np.exp(-d), np.exp(-(k + y))
    less_y, less_k, less_d = -np.expm1(-2.0 * y), -np.expm1(-2.0 * k), -np.expm1(-2.0 * d)
    ss, cs = at_depth * less_y * less_k, at_depth * (2.0 - less_y) * less_k  # S(y) S(k) and C(y) S(k)
    sinh_d, cosh_d = 2.0 * at_image * less_d, 2.0 * at_image * (2.0 - less_d)
    # k S(y) C(k) - y C(y) S(k)
    crossed = d * at_depth * -np.expm1(-2.0 * (k + y)) - (k + y) * at_image * less_d
    even, odd = kolosov**2 * ss - y * k * cosh_d, kolosov * crossed
    shear, image = kolosov * d * ss, y * k * sinh_d
    determinant = (kolosov * less_k - 2.0 * k * np.exp(-k)) * (kolosov * less_k + 2.0 * k * np.exp(-k))
    numerators = [
        *(even - odd, shear + image),
        *(image - shear, even + odd),
        *(-kolosov * ss - k * sinh_d, kolosov * cs + k * cosh_d),
        *(kolosov * cs - k * cosh_d, k * sinh_d - kolosov * ss),
    ]
    return [numerator / determinant for numerator in numerators]


def _thin(y: Reals, k: Reals, d: Reals, kolosov: float) -> list[Reals]:
    """For k < 1: with g_3 free of cancellation every term is of the order of the result."""
    excess = kolosov - 1.0
    sinh_y, cosh_y, sinh_k = np.sinh(y), np.cosh(y), np.sinh(k)
    g3_y, g3_k = excess * sinh_y - _bend(y), excess * sinh_k - _bend(k)
    ss, yk = sinh_y * sinh_k, y * k
    determinant = (kolosov * scaled_sinh_minus_x(k) * np.exp(k) + excess * k) * (kolosov * sinh_k + k)
    numerators = [
        *((kolosov * sinh_y + y * cosh_y) * g3_k + yk * ss, kolosov * d * ss + yk * np.sinh(d)),
        *(y * sinh_y * g3_k - k * sinh_k * g3_y, yk * ss + g3_y * (kolosov * sinh_k + k * np.cosh(k))),
        *(-kolosov * ss - k * np.sinh(d), kolosov * cosh_y * sinh_k + k * np.cosh(d)),
        *(cosh_y * g3_k + k * ss, k * np.sinh(d) - kolosov * ss),
    ]
    return [numerator / determinant for numerator in numerators]


def _bend(x: Reals) -> Reals:
    """Return x cosh x - sinh x for 0 <= x < 1."""
    return np.asarray(2.0 * x * np.sinh(0.5 * x) ** 2 - scaled_sinh_minus_x(x) * np.exp(x))


def across_transfer(depth: float, q: Reals, height: float, below: Reals | float) -> tuple[Reals, Reals]:
    """Transfer of waves of shear, u'' = q^2 u, from the top of a layer to a depth in it (L_x), for q > 0 `[wave]`.

    Return the displacement at the depth and its slope in z over q, both over the displacement on top. `below` is q
    times the compliance of what lies below the layer, times the layer's shear modulus: 0 if rigid, 1 if the same.
    """
    less, less_on_top = -np.expm1(-2.0 * q * (height - depth)), -np.expm1(-2.0 * q * height)
    scale = np.exp(-q * depth) / (less_on_top + below * (2.0 - less_on_top))
    return scale * (less + below * (2.0 - less)), scale * (2.0 - less + below * less)
