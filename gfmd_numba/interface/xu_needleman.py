"""Cohesive law of gap and slip together: energy, both tractions and a bound of the curvature."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
import numpy.typing as npt
from scipy.special import lambertw

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.scene.interface_records import Cohesive
from gfmd_numba.scene.reduced_units import rounded

Rows = npt.NDArray[np.int64]


@dataclass(frozen=True)
class XuNeedlemanLaw:
    """Cohesive law of Xu and Needleman (Modelling Simul. Mater. Sci. Eng. 1:111, 1993) with q = 1, r = 0.

    Its energy per area is -work (1 + gap / normal) exp(-gap / normal) exp(-slip^2 / tangential^2): it attracts across
    an open gap, repels where the gap is negative, and resists slip. Lengths in g L_x, work in g^2 E* L_x.
    """

    work: float
    normal: float
    tangential: float

    @classmethod
    def scaled(cls, asked: Cohesive, length: float, energy: float) -> Self:
        """Law of a scene, its lengths and its energies per area over these."""
        lengths = (rounded(each / length) for each in (asked.normal_length, asked.tangential_length))
        return cls(rounded(asked.work_of_adhesion / energy), *lengths)

    @property
    def strength(self) -> float:
        """Largest attraction, at a gap of the normal length."""
        return self.work / self.normal / math.e

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
