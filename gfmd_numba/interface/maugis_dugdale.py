"""Constant attraction up to a range: energy, traction and curvature."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.interface.normal_law import LawOfRange
from gfmd_numba.scene.interface_records import LawOfTheGap, MaugisDugdale


@dataclass(frozen=True)
class MaugisDugdaleLaw(LawOfRange):
    """Traction work / length up to a gap of that length (Maugis, J. Colloid Interface Sci. 150:243, 1992), then none.

    The traction falls in a line, over a `taper` times the length about there, so that the work stays the same. It
    cannot jump: on a grid each node would then be in or out on its own, with as many equilibria.
    """

    taper: float

    @classmethod
    def of(cls, asked: LawOfTheGap) -> Self:
        """Law of a record in units of g L_x and g E*."""
        assert isinstance(asked, MaugisDugdale)
        return cls(asked.work_of_adhesion, asked.range, asked.taper)

    @property
    def softening(self) -> float:
        """Slope where the traction falls."""
        return self.strength / (self.taper * self.length)

    @property
    def _ends(self) -> tuple[float, float]:
        """Gaps between which the traction falls."""
        half = 0.5 * self.taper
        return (1.0 - half) * self.length, (1.0 + half) * self.length

    def energy(self, gap: Reals) -> Reals:
        """Energy per area of the surfaces at a gap."""
        first, last = self._ends
        falling = -0.5 * self.softening * (last - np.clip(gap, first, last)) ** 2
        return np.asarray(falling - self.strength * np.maximum(first - gap, 0.0))

    def traction(self, gap: Reals) -> Reals:
        """Traction that pulls the body towards the punch."""
        return np.asarray(self.softening * (self._ends[1] - np.clip(gap, *self._ends)))

    def stiffness(self, gap: Reals) -> Reals:
        """Restoring stiffness -d traction / du at a gap."""
        first, last = self._ends
        return np.where((gap > first) & (gap < last), -self.softening, 0.0)

    def energy_change(self, gap: Reals, closing: Reals) -> Reals:
        """Change of the energy per area as a gap closes by some more, without cancellation where that is little."""
        least, most = np.minimum(closing, 0.0), np.maximum(closing, 0.0)
        full, none = (np.clip(gap - end, least, most) for end in self._ends)  # beyond how much closing
        falls = (full - none) * (self._ends[1] - gap + 0.5 * (full + none))
        gained = self.strength * (most - full) + self.softening * falls
        return np.asarray(np.where(closing < 0.0, gained, -gained))

    def stiffest(self, pressure: float, hard_wall: bool) -> float:
        """None: the law nowhere stiffens."""
        return 0.0
