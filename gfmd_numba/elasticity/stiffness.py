"""Stiffness of the normal displacement of a half-space, and of two bodies that face each other, in E*/L_x.

The stiffness of a slab or of layers is that of an `ElasticBody`: the formula of a slab stands at the head of `body.py`,
and `layers.py` computes it.
"""

import numpy as np

from gfmd_numba.arrays import Reals


def half_space(q: Reals) -> Reals:
    """Stiffness q/2 of the half-space, in E*/L_x (thesis (6.75) for an infinite height)."""
    return 0.5 * q


def in_series(own: Reals, other: Reals, compliance_fraction: float) -> Reals:
    """Stiffness `[(ny,) nx // 2 + 1]` of two bodies under one pressure, whose displacements add up wave by wave.

    The stiffnesses `own` and `other` count in the E* of their bodies, the result K in the E* of both together. With the
    `compliance_fraction` f of the other body, its part of 1/E*,

        1 / K = (1 - f) / own + f / other.
    """
    with np.errstate(divide="ignore"):
        return np.asarray(1.0 / ((1.0 - compliance_fraction) / own + compliance_fraction / other))
