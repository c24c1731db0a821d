"""Law of the gap alone that decays exponentially, without a cut-off: energy, traction and curvature."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.interface.normal_law import LawOfRange


class ExponentialLaw(LawOfRange):
    """Law with the energy -work exp(-gap / length) per area (thesis 6.109): work > 0 attracts, < 0 repels."""

    @property
    def softening(self) -> float:
        """Largest -d2(energy)/d(gap)2 where no gap is negative, work / length^2 at zero gap; 0 for repulsion."""
        return max(self.strength / self.length, 0.0)

    def energy(self, gap: Reals) -> Reals:
        """Energy per area of the surfaces at a gap."""
        return np.asarray(-self.work * np.exp(-gap / self.length))

    def traction(self, gap: Reals) -> Reals:
        """Traction that pulls the body towards the punch (thesis 6.110)."""
        pull = np.asarray(gap / -self.length)  # in place, for large maps
        np.exp(pull, out=pull)
        pull *= self.strength
        return pull

    def stiffness(self, gap: Reals) -> Reals:
        """Restoring stiffness -d traction / du at a gap; an attractive law softens."""
        softening = self.traction(gap)
        softening /= -self.length
        return softening

    def energy_change(self, gap: Reals, closing: Reals) -> Reals:
        """Change of the energy per area as a gap closes by some more, without cancellation where that is little."""
        larger = np.maximum(closing, 0.0)  # of the gap before and after, so that nothing overflows
        larger -= gap
        larger /= self.length
        np.exp(larger, out=larger)
        larger *= self.work
        change = np.abs(closing)
        change /= -self.length
        np.expm1(change, out=change)
        change *= larger
        return np.asarray(np.negative(change, out=change, where=closing < 0.0))

    def stiffest(self, pressure: float, hard_wall: bool) -> float:
        """Largest stiffness the law adds where it repels with at most `pressure`, or no gap is negative."""
        strongest = min(pressure, -self.strength) if hard_wall else pressure
        return max(strongest, 0.0) / self.length if self.work < 0.0 else 0.0

    def pull(self, u: Reals, restoring: Reals, punch: Reals, active: Indices, n: int) -> None:
        """Take the traction of the law off the normal traction `restoring` in the active rows, as compiled."""
        kernels.exponential_pull(u, restoring, punch, active, n, self.strength, self.length)
