"""Interaction laws between the surfaces: energy, traction and curvature against the gap."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import lambertw

from gfmd_numba import kernels

Reals = npt.NDArray[np.float64]
Rows = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Interface:
    """What keeps the surfaces apart or together; an absent effect is None.

    `friction` is Coulomb's coefficient, infinite for touching nodes that stick, None for a frictionless interface.
    """

    hard_wall: bool
    law: "Exponential | None" = None
    friction: float | None = None
    cohesion: "XuNeedleman | None" = None

    @property
    def couples(self) -> bool:
        """Whether tangential tractions act, so that both displacements have to be followed."""
        return self.friction is not None or self.cohesion is not None

    @property
    def softening(self) -> float:
        """How fast its law softens at most as the gap opens, the largest -d2(energy)/d(gap)2; 0 without one."""
        law = self.law or self.cohesion
        return 0.0 if law is None else law.softening


@dataclass(frozen=True)
class Exponential:
    """Finite-range law with energy -work exp(-gap / length) per area (6.109): work > 0 attracts, < 0 repels.

    Lengths in g L_x, work in g^2 E* L_x (whatever the displacements and stresses are in).
    """

    work: float
    length: float

    @property
    def strength(self) -> float:
        """Traction at zero gap."""
        return self.work / self.length

    @property
    def softening(self) -> float:
        """Largest -d2(energy)/d(gap)2 where no gap is negative, work / length^2 at zero gap; 0 for repulsion."""
        return max(self.strength / self.length, 0.0)

    def energy(self, gap: Reals) -> Reals:
        """Energy per area of the surfaces at a gap."""
        return np.asarray(-self.work * np.exp(-gap / self.length))

    def traction(self, gap: Reals) -> Reals:
        """Traction that pulls the body towards the punch (6.110)."""
        return np.asarray(self.strength * np.exp(-gap / self.length))

    def stiffness(self, gap: Reals) -> Reals:
        """Restoring stiffness -d traction / du at a gap; an attractive law softens."""
        return -self.traction(gap) / self.length

    def stiffest(self, pressure: float, hard_wall: bool) -> float:
        """Largest stiffness the law adds where it repels with at most `pressure`, or no gap is negative."""
        strongest = min(pressure, -self.strength) if hard_wall else pressure
        return max(strongest, 0.0) / self.length if self.work < 0.0 else 0.0

    def pull(self, u: Reals, ku: Reals, punch: Reals, active: Rows, n: int) -> None:
        """Take the traction of the law off the restoring traction `ku` in the active rows."""
        kernels.exponential_pull(u, ku, punch, active, n, self.strength, self.length)


@dataclass(frozen=True)
class XuNeedleman:
    """Cohesive law of Xu and Needleman (Modelling Simul. Mater. Sci. Eng. 1:111, 1993) with q = 1, r = 0.

    Its energy per area is -work (1 + gap / normal) exp(-gap / normal) exp(-slip^2 / tangential^2): it attracts across
    an open gap, repels where the gap is negative, and resists slip. Lengths in g L_x, work in g^2 E* L_x.
    """

    work: float
    normal: float
    tangential: float

    @property
    def softening(self) -> float:
        """Largest -d2(energy)/d(gap)2, work / normal^2 exp(-2) at the gap 2 normal without slip."""
        return self.work / self.normal / self.normal * float(np.exp(-2.0))

    def energy(self, gap: Reals, slip: Reals) -> Reals:
        """Energy per area at a gap and a slip of the punch over the body."""
        return np.asarray(-self.work * (1.0 + gap / self.normal) * self._decay(gap, slip))

    def normal_traction(self, gap: Reals, slip: Reals) -> Reals:
        """Traction that pulls the body towards the punch."""
        return np.asarray(self.work * gap / self.normal**2 * self._decay(gap, slip))

    def tangential_traction(self, gap: Reals, slip: Reals) -> Reals:
        """Traction that drags the body along with the punch."""
        scale = 2.0 * self.work * slip / self.tangential**2
        return np.asarray(scale * (1.0 + gap / self.normal) * self._decay(gap, slip))

    def stiffest(self, pressure: float, hard_wall: bool) -> float:
        """Bound of the stiffness the law adds where it repels with at most `pressure`, or no gap is negative."""
        depth = 0.0 if hard_wall else float(lambertw(pressure * self.normal / self.work).real)
        normal = self.work / self.normal**2 * (1.0 + depth) * np.exp(depth)
        # the coupling is largest at gap = normal, slip = tangential / sqrt 2
        coupling = self.work / (self.normal * self.tangential) * np.sqrt(2.0) * np.exp(-1.5)
        return float(max(normal, 2.0 * self.work / self.tangential**2) + coupling * np.exp(depth))

    def pull(
        self, u1: Reals, k1: Reals, u3: Reals, k3: Reals, punch: Reals, sliding: float, active: Rows, n: int
    ) -> None:
        """Take the tractions of the law off the restoring tractions of both displacements in the active rows."""
        kernels.xu_needleman_pull(u1, k1, u3, k3, punch, sliding, active, n, self.work, self.normal, self.tangential)

    def _decay(self, gap: Reals, slip: Reals) -> Reals:
        return np.asarray(np.exp(-gap / self.normal - (slip / self.tangential) ** 2))
