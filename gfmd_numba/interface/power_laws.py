"""Laws whose energy is a sum of powers of a distance: energy, traction and curvature."""

from dataclasses import dataclass
from typing import Self

import numpy as np
import scipy  # its modules load with their first use

from gfmd_numba.arrays import Reals
from gfmd_numba.interface.normal_law import NormalLaw
from gfmd_numba.scene.interface_records import LennardJones, PowerLawOfTheGap


@dataclass(frozen=True)
class SumOfPowers(NormalLaw):
    """Energy per area of the sum of work (length / z)^power, at a distance z that is the gap and an `offset`.

    Below a distance of `shortest` times the length the traction goes on in a line, as no grid could hold its pole.
    Lengths in g L_x, work in g^2 E* L_x.
    """

    works: tuple[float, ...]
    powers: tuple[float, ...]
    length: float
    offset: float
    shortest: float

    @property
    def strength(self) -> float:
        """Largest attraction where no gap is negative, or minus the largest repulsion where nothing attracts."""
        tractions = self.traction(np.array([0.0, self._extreme(1)]))
        return float(tractions.max() if tractions.max() > 0.0 else tractions.min())

    @property
    def reach(self) -> float:
        """Length over which an attraction falls off; 0 for repulsion."""
        return self.length if self.softening > 0.0 else 0.0

    @property
    def softening(self) -> float:
        """Largest -d2(energy)/d(gap)2 where no gap is negative; 0 for repulsion."""
        return max(0.0, -float(self.stiffness(np.array([0.0, self._extreme(2)])).min()))

    def energy(self, gap: Reals) -> Reals:
        """Energy per area of the surfaces at a gap."""
        inside, kink = self._split(gap)
        line = inside * (self._derivative(kink, 1) + 0.5 * inside * self._derivative(kink, 2))
        return np.asarray(self._derivative(self._distance(gap), 0) + line)

    def traction(self, gap: Reals) -> Reals:
        """Traction that pulls the body towards the punch."""
        inside, kink = self._split(gap)
        return np.asarray(self._derivative(self._distance(gap), 1) + inside * self._derivative(kink, 2))

    def stiffness(self, gap: Reals) -> Reals:
        """Restoring stiffness -d traction / du at a gap."""
        return self._derivative(self._distance(gap), 2)

    def energy_change(self, gap: Reals, closing: Reals) -> Reals:
        """Change of the energy per area as a gap closes by some more, without cancellation where that is little."""
        inside, kink = self._split(gap)
        room = np.maximum(gap + (self.offset - kink), 0.0)  # before the kink
        beyond = np.maximum(closing - room, inside)  # the part of the way that is
        begun = self._distance(gap)
        steps = np.log1p((beyond - closing) / begun)
        change = sum(
            work * (begun / self.length) ** -power * np.expm1(-power * steps)
            for work, power in zip(self.works, self.powers, strict=True)
        )
        line = self._derivative(kink, 1) + self._derivative(kink, 2) * (inside - 0.5 * beyond)
        return np.asarray(change - beyond * line)

    def stiffest(self, pressure: float, hard_wall: bool) -> float:
        """Largest stiffness the law adds where it repels with at most `pressure`, or no gap is negative."""
        kink = self.shortest * self.length - self.offset
        nearest, far = max(kink, 0.0) if hard_wall else kink, self.length
        if self._excess(nearest, pressure) > 0.0:
            while self._excess(far, pressure) > 0.0:
                far *= 2.0
            nearest = scipy.optimize.brentq(self._excess, nearest, far, (pressure,))
        return max(0.0, float(self.stiffness(np.asarray(nearest))))

    def _excess(self, gap: float, pressure: float) -> float:
        """Repulsion at a gap over a pressure."""
        return -float(self.traction(np.asarray(gap))) - pressure

    def _distance(self, gap: Reals) -> Reals:
        return np.maximum(gap + self.offset, self.shortest * self.length)

    def _split(self, gap: Reals) -> tuple[Reals, float]:
        """How far beyond the kink a gap is, none or negative, and the distance of the kink."""
        kink = self.shortest * self.length
        return np.minimum(gap + self.offset - kink, 0.0), kink

    def _derivative(self, distance: Reals | float, order: int) -> Reals:
        """Energy, traction or stiffness at distances that the powers hold for."""
        found = np.zeros(np.shape(distance))
        for work, power in zip(self.works, self.powers, strict=True):
            factor = work * np.prod([-(power + k) / self.length for k in range(order)])
            found += factor * (distance / self.length) ** -(power + order)
        return found

    def _extreme(self, order: int) -> float:
        """Gap where a derivative of two powers has an extreme; 0 of one power, which has its largest there."""
        if len(self.powers) == 1:
            return 0.0
        first, last = (
            w * np.prod([p + k for k in range(order + 1)]) for w, p in zip(self.works, self.powers, strict=True)
        )
        ratio = (-last / first) ** (1.0 / (self.powers[1] - self.powers[0]))
        return float(self.length * ratio - self.offset)


class LennardJonesLaw(SumOfPowers):
    """Traction 8 work / (3 z) ((z / gap)^3 - (z / gap)^9) of half-spaces whose atoms attract as (12, 6).

    z is the gap at which nothing acts (Johnson and Greenwood, J. Colloid Interface Sci. 192:326, 1997, eq. 1). Below
    z / 2, where 1300 work / z repel, the traction goes on in a line.
    """

    @classmethod
    def of(cls, asked: LennardJones) -> Self:
        """Law of a record in units of g L_x and g E*."""
        work = asked.work_of_adhesion
        return cls((-4.0 / 3.0 * work, work / 3.0), (2.0, 8.0), asked.range, 0.0, 0.5)


class ShiftedPowerLaw(SumOfPowers):
    """Energy -work (1 + gap / length)^-exponent per area: van der Waals forces with a cut-off have the exponent 2.

    Overlaps of more than 9/10 of the length, which no hard wall stops, are repelled by a force linear in them.
    """

    @classmethod
    def of(cls, asked: PowerLawOfTheGap) -> Self:
        """Law of a record in units of g L_x and g E*."""
        return cls((-asked.work_of_adhesion,), (asked.exponent,), asked.range, asked.range, 0.1)
