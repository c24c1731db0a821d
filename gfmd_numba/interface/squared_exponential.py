"""Attraction that falls off as a Gauss curve of the gap: energy, traction and curvature."""

from math import exp

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.interface.normal_law import LawOfRange


class SquaredExponentialLaw(LawOfRange):
    """Law with energy -work exp(-(gap / length)^2 / 2) per area, which pulls most at a gap of its length."""

    @property
    def strength(self) -> float:
        """Largest traction, at a gap of one length."""
        return exp(-0.5) * self.work / self.length

    @property
    def softening(self) -> float:
        """Largest -d2(energy)/d(gap)2, at a gap of 3^(1/2) lengths."""
        return 2.0 * exp(-1.5) * self.work / self.length**2

    def energy(self, gap: Reals) -> Reals:
        """Energy per area of the surfaces at a gap."""
        return np.asarray(-self.work * np.exp(-0.5 * (gap / self.length) ** 2))

    def traction(self, gap: Reals) -> Reals:
        """Traction that pulls the body towards the punch."""
        return np.asarray(-self.energy(gap) * gap / self.length**2)

    def stiffness(self, gap: Reals) -> Reals:
        """Restoring stiffness -d traction / du at a gap; beyond one length the law softens."""
        return np.asarray(-self.energy(gap) * (1.0 - (gap / self.length) ** 2) / self.length**2)

    def energy_change(self, gap: Reals, closing: Reals) -> Reals:
        """Change of the energy per area as a gap closes by some more, without cancellation where that is little."""
        gain = closing * (gap - 0.5 * closing) / self.length**2  # of the exponent
        deepest = np.where(gain > 0.0, self.energy(gap - closing), self.energy(gap))
        return np.asarray(-np.sign(gain) * deepest * np.expm1(-np.abs(gain)))

    def stiffest(self, pressure: float, hard_wall: bool) -> float:
        """Largest stiffness the law adds, at no gap."""
        return self.work / self.length**2
