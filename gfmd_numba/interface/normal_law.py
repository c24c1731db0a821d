"""What a law of the gap alone has to say of itself."""

from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.scene.interface_records import LawOfTheGap


class NormalLaw(Protocol):
    """A law of the gap alone; lengths in g L_x, stresses in g E*, work in g^2 E* L_x, whatever displacements are in."""

    @property
    def strength(self) -> float:
        """Largest attraction where no gap is negative, or minus the largest repulsion where nothing attracts."""

    @property
    def reach(self) -> float:
        """Gap over which its attraction falls off; 0 for repulsion."""

    @property
    def softening(self) -> float:
        """Largest -d2(energy)/d(gap)2 where no gap is negative; 0 for repulsion."""

    def energy(self, gap: Reals) -> Reals:
        """Energy per area of the surfaces at a gap."""

    def traction(self, gap: Reals) -> Reals:
        """Traction that pulls the body towards the punch."""

    def stiffness(self, gap: Reals) -> Reals:
        """Restoring stiffness -d traction / du at a gap; an attractive law softens."""

    def energy_change(self, gap: Reals, closing: Reals) -> Reals:
        """Change of the energy per area as a gap closes by some more, without cancellation where that is little."""

    def stiffest(self, pressure: float, hard_wall: bool) -> float:
        """Largest stiffness the law adds where it repels with at most `pressure`, or no gap is negative."""

    def pull(self, u: Reals, restoring: Reals, punch: Reals, active: Indices, n: int) -> None:
        """Take the traction of the law off the normal traction `restoring` of displacements u in the active rows.

        Both are `[realisation, component, node]`, the `punch` `[realisation, node]`, of which n nodes count.
        """
        with np.errstate(over="ignore", invalid="ignore"):  # of a run that diverges, as its status says
            restoring[active, -1, :n] -= self.traction(punch[active, :n] - u[active, -1, :n])


@dataclass(frozen=True)
class LawOfRange(NormalLaw):
    """A law of a work of adhesion, in g^2 E* L_x, and a range `length`, in g L_x."""

    work: float
    length: float

    @classmethod
    def of(cls, asked: LawOfTheGap) -> Self:
        """Law of a record in units of g L_x and g E*."""
        return cls(asked.work_of_adhesion, asked.range)

    @property
    def strength(self) -> float:
        """Work over range: the largest traction where no gap is negative, if that is at no gap."""
        return self.work / self.length

    @property
    def reach(self) -> float:
        """Its range; 0 for repulsion."""
        return self.length if self.work > 0.0 else 0.0
