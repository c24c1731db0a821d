"""Yield stress of a body that may flow, and the sublayers in which it may."""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.kernels import Hardening


@dataclass(frozen=True)
class PlasticSublayers:
    """J2 plasticity (g E*, g) in sublayers down to a depth (L_x), None: as deep as the largest load needs.

    Each step of a loading is solved in so many `increments`.
    """

    hardening: Hardening
    depth: float | None
    sublayers: int
    increments: int

    def thicknesses(self, depth: float, nx: int) -> Reals:
        """Thicknesses `[sublayer]` down to a depth below nx nodes: the first at most one node spacing.

        If needed, each is thicker than the one above it by the same factor.
        """
        first, powers = 1.0 / nx, np.arange(self.sublayers)
        if depth <= self.sublayers * first:
            return np.full(self.sublayers, depth / self.sublayers)
        from scipy.optimize import brentq  # which contacts that do not flow never need

        growth = brentq(lambda factor: first * float((factor**powers).sum()) - depth, 1.0, depth / first)
        found = growth**powers
        return np.asarray(depth / found.sum() * found)
