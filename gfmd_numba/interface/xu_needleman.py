"""Cohesive law of gap and slip together: energy, both tractions and a bound of the curvature."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy  # its modules load with their first use

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.scene.interface_records import Cohesive


@dataclass(frozen=True)
class XuNeedlemanLaw:
    """Cohesive law of Xu and Needleman (Modelling Simul. Mater. Sci. Eng. 1:111, 1993) with q = 1, r = 0.

    Where the gap is open its energy per area is -work (1 + gap / normal) exp(-gap / normal) exp(-slip^2 /
    tangential^2): it attracts and resists slip. Surfaces that overlap repel each other as they do there without slip,
    and resist slip as they do at zero gap. (In the paper that repulsion decays with slip, and an overlap by more than
    the normal length drives slip, so that surfaces under pressure pass through each other.) Energy and both tractions
    are continuous. Lengths in g L_x, work in g^2 E* L_x.
    """

    work: float
    normal: float
    tangential: float

    @classmethod
    def of(cls, asked: Cohesive) -> Self:
        """Law of a record in units of g L_x and g E*."""
        return cls(asked.work_of_adhesion, asked.normal_length, asked.tangential_length)

    @property
    def strength(self) -> float:
        """Largest attraction, at a gap of the normal length."""
        return self.work / self.normal / math.e

    @property
    def softening(self) -> float:
        """Largest -d2(energy)/d(gap)2, work / normal^2 exp(-2) at the gap 2 normal without slip."""
        return self.work / self.normal / self.normal * float(np.exp(-2.0))

    @property
    def slip_softening(self) -> float:
        """Largest -d2(energy)/d(slip)2, 4 work / tangential^2 exp(-3/2) at the slip sqrt(3/2) tangential, no gap."""
        return 4.0 * self.work / self.tangential / self.tangential * float(np.exp(-1.5))

    def energy(self, gap: Reals, slip: Reals) -> Reals:
        """Energy per area at a gap and a slip of the punch over the body."""
        g, overlap = np.maximum(gap, 0.0) / self.normal, np.minimum(gap, 0.0) / self.normal
        return np.asarray(self.work * (1.0 - (1.0 + overlap) * np.exp(-overlap) - (1.0 + g) * self._decay(g, slip)))

    def normal_traction(self, gap: Reals, slip: Reals) -> Reals:
        """Traction that pulls the body towards the punch."""
        g, overlap = np.maximum(gap, 0.0) / self.normal, np.minimum(gap, 0.0) / self.normal
        return np.asarray(self.work / self.normal * (g * self._decay(g, slip) + overlap * np.exp(-overlap)))

    def tangential_traction(self, gap: Reals, slip: Reals) -> Reals:
        """Traction that drags the body along with the punch."""
        g = np.maximum(gap, 0.0) / self.normal
        return np.asarray(2.0 * self.work * slip / self.tangential**2 * (1.0 + g) * self._decay(g, slip))

    def stiffness(self, gap: Reals, slip: Reals) -> tuple[Reals, ...]:
        """Second derivatives of the energy by the displacements of the body, at a slip `[component, ...]`.

        Those are xx, xy, yy, xz, yz and zz, or on profiles xx, xz and zz.
        """
        g, overlap, s = np.maximum(gap, 0.0) / self.normal, np.minimum(gap, 0.0) / self.normal, slip / self.tangential
        decay = self.work * np.exp(-g - (s**2).sum(axis=0))
        drag = 2.0 * decay / self.tangential**2 * (1.0 + g)
        pairs = [(i, j) for i in range(len(s)) for j in range(i + 1)]
        both = -2.0 * decay / (self.normal * self.tangential) * s * g
        repulsion = self.work * (1.0 - overlap) * np.exp(-overlap)
        normal = np.where(overlap < 0.0, repulsion, decay * (1.0 - g)) / self.normal**2
        return (*(drag * ((i == j) - 2.0 * s[i] * s[j]) for i, j in pairs), *both, normal)

    def energy_change(self, gap: Reals, slip: Reals, closing: Reals, dragged: Reals) -> Reals:
        """Change of the energy per area as the body closes gaps and is dragged along, without cancellation.

        Slip and what is `dragged` are `[component, ...]`.
        """
        g, closer = gap / self.normal, closing / self.normal
        s, along = slip / self.tangential, dragged / self.tangential
        back = (along * (2.0 * s - along)).sum(axis=0)
        overlapping = np.where(g < 0.0, np.maximum(closer, g), np.maximum(closer - g, 0.0))  # what closes below zero
        opens = _envelope_change(np.maximum(g, 0.0), (s**2).sum(axis=0), closer - overlapping, back)
        overlaps = _envelope_change(np.minimum(g, 0.0), 0.0, overlapping, 0.0)
        return np.asarray(-self.work * (opens + overlaps))

    def stiffest(self, pressure: float, hard_wall: bool) -> float:
        """Bound of the stiffness the law adds where it repels with at most `pressure`, or no gap is negative."""
        depth = 0.0 if hard_wall else float(scipy.special.lambertw(pressure * self.normal / self.work).real)
        normal = self.work / self.normal**2 * (1.0 + depth) * np.exp(depth)
        # the coupling is largest at gap = normal, slip = tangential / sqrt 2
        coupling = self.work / (self.normal * self.tangential) * np.sqrt(2.0) * np.exp(-1.5)
        return float(max(normal, 2.0 * self.work / self.tangential**2) + coupling)

    def pull(self, state: kernels.SurfaceState, punch: Reals, sliding: Reals, active: Indices, n: int) -> None:
        """Take the tractions of the law off the restoring tractions of a state in the active rows.

        `sliding` `[component, x]` is how far the punch has moved over each of the n nodes: in x, and on maps in y.
        """
        kernels.xu_needleman_pull(state, punch, sliding, active, n, self.work, self.normal, self.tangential)

    def _decay(self, g: Reals, slip: Reals) -> Reals:
        return np.asarray(np.exp(-g - (slip / self.tangential) ** 2))


def _envelope_change(g: Reals, slipped: Reals | float, closing: Reals, back: Reals | float) -> Reals:
    """Change of (1 + g) exp(-g - slipped) as g decreases by `closing` and what has slipped by `back`."""
    before, more = np.exp(-g - slipped), closing + back
    small = before * np.expm1(np.minimum(more, 1.0))
    growth = np.where(more > 1.0, np.exp(more - g - slipped) - before, small)  # `before` may be less than any number
    return np.asarray((g - closing) * growth + growth - closing * before)
