"""A law of the gap that is not the same everywhere: as patches on a surface attract more and less."""

import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from typing import Self

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.interface.normal_law import NormalLaw


@dataclass(frozen=True)
class PatternedLaw(NormalLaw):
    """A law whose work of adhesion is multiplied by a `pattern` `[(y,) x]` of numbers from 0 on, some above 0.

    On the `padded` grid around the window of a punch without a period nothing acts. Of a single gap the strongest node
    is meant.
    """

    law: NormalLaw
    digest: str
    padded: tuple[int, ...]
    pattern: Reals = field(repr=False, compare=False)

    @classmethod
    def of(cls, law: NormalLaw, pattern: Reals, padded: tuple[int, ...]) -> Self:
        """Law under a pattern, with what tells that from others."""
        return cls(law, hashlib.sha256(pattern.tobytes()).hexdigest(), padded, pattern)

    @property
    def strength(self) -> float:
        """Largest attraction where no gap is negative, or minus the largest repulsion where nothing attracts."""
        return float(self.pattern.max()) * self.law.strength

    @property
    def reach(self) -> float:
        """Gap over which its attraction falls off; 0 for repulsion."""
        return self.law.reach

    @property
    def softening(self) -> float:
        """Largest -d2(energy)/d(gap)2 where no gap is negative; 0 for repulsion."""
        return float(self.pattern.max()) * self.law.softening

    def energy(self, gap: Reals) -> Reals:
        """Energy per area of the surfaces at a gap."""
        return np.asarray(self._on(gap) * self.law.energy(gap))

    def traction(self, gap: Reals) -> Reals:
        """Traction that pulls the body towards the punch."""
        return np.asarray(self._on(gap) * self.law.traction(gap))

    def stiffness(self, gap: Reals) -> Reals:
        """Restoring stiffness -d traction / du at a gap; an attractive law softens."""
        return np.asarray(self._on(gap) * self.law.stiffness(gap))

    def energy_change(self, gap: Reals, closing: Reals) -> Reals:
        """Change of the energy per area as a gap closes by some more, without cancellation where that is little."""
        return np.asarray(self._on(gap) * self.law.energy_change(gap, closing))

    def stiffest(self, pressure: float, hard_wall: bool) -> float:
        """Largest stiffness the law adds where it repels with at most `pressure`, or no gap is negative."""
        acting = self.pattern[self.pattern > 0.0]
        return max(float(s * self.law.stiffest(pressure / s, hard_wall)) for s in (acting.min(), acting.max()))

    @cached_property
    def _around(self) -> Reals:
        """The pattern on the padded grid."""
        around = np.zeros(self.padded)
        around[grid.corner(self.pattern.shape)] = self.pattern
        return around

    def _on(self, gap: Reals) -> Reals | float:
        """Pattern on the nodes of gaps `[..., (y,) x]` or `[..., node]`, of the window or of the grid around it."""
        if gap.size == 1:
            return float(self.pattern.max())
        for shares in (self.pattern, self._around):
            if gap.shape[-shares.ndim :] == shares.shape:
                return shares
            if gap.shape[-1] == shares.size:
                return shares.ravel()
        raise ValueError(f"gaps of shape {gap.shape} under a pattern of {self.pattern.shape}")
