"""Stiffness of a half-space, compliances of waves, and what bodies that face each other do, in E*/L_x.

The formulas of half-space and slab stand together in `body.py`, whose `ElasticBody` chooses.
"""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals

_SERIES = 1.0 / np.array([6.0, 120.0, 5040.0, 362880.0, 39916800.0, 6227020800.0, 1307674368000.0])


def half_space(q: Reals) -> Reals:
    """Stiffness q/2 of the half-space, in E*/L_x (thesis (6.75) for an infinite height)."""
    return 0.5 * q


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
