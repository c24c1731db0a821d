"""The elastic body: a half-space, or a slab bonded to a rigid base, whose surface is flat.

Lengths in L_x, stresses in E*. Nothing beyond this file needs to know which of the two a body is.
"""

from dataclasses import dataclass
from math import inf

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import coupled, stiffness, transfer
from gfmd_numba.elasticity.compliance import Compliance
from gfmd_numba.elasticity.coupled_stiffness import CoupledStiffness
from gfmd_numba.elasticity.transfer import Transfer
from gfmd_numba.fourier import grid


@dataclass(frozen=True)
class ElasticBody:
    """Poisson's ratio up to 1/2, None where it does not matter; height over L_x, None for a half-space."""

    poissons_ratio: float | None
    aspect_ratio: float | None

    @property
    def nu(self) -> float:
        """Poisson's ratio where it matters; raises ValueError if the body has none."""
        if self.poissons_ratio is None:
            raise ValueError("this needs a Poisson's ratio, which the body was said not to depend on")
        return self.poissons_ratio

    @property
    def base(self) -> float:
        """Place of the rigid base, z = -a; minus infinity for a half-space."""
        return -inf if self.aspect_ratio is None else -self.aspect_ratio

    def uniform_stiffness(self) -> tuple[float, float]:
        """Stiffness of uniform tangential and normal displacement, in E*/L_x (6.66); a half-space has none."""
        if self.aspect_ratio is None:
            return 0.0, 0.0
        tangential, normal = coupled.uniform_stiffness(self.nu, self.aspect_ratio)
        return float(tangential), float(normal)

    def condensed_stiffness(self, q: Reals) -> Reals:
        """Stiffness at wave numbers q of the normal displacement without tangential tractions, in E*/L_x (6.75)."""
        return stiffness.half_space(q) if self.aspect_ratio is None else stiffness.slab(q, self.nu, self.aspect_ratio)

    def coupled_stiffness(self, nx: int) -> CoupledStiffness:
        """Stiffness of both displacements of a profile of nx nodes, in E*/L_x (6.58), (6.83)."""
        q = grid.wavenumbers(nx)[1:]
        tangential, normal = self.uniform_stiffness()
        elements = np.empty((3, len(q) + 1))
        elements[:, 0] = tangential, 0.0, normal
        for element, over_q in zip(elements, self._elements(q), strict=True):
            element[1:] = q * over_q
        return CoupledStiffness.on_grid(nx, *elements)

    def compliance(self, nx: int) -> Compliance:
        """Inverse of the stiffness of a profile of nx nodes, in L_x/E*; a half-space's mean displacement is held."""
        q = grid.wavenumbers(nx)[1:]
        tangential, normal, lead = np.zeros((3, len(q) + 1))
        tangential[0], normal[0] = (uniform or inf for uniform in self.uniform_stiffness())
        tangential[1:], normal[1:] = (q * over_q for over_q in self._condensed_elements(q))
        a11, a13, _ = self._elements(q)
        lead[1:] = a13 / a11
        return Compliance(1.0 / tangential, lead / normal, 1.0 / normal)

    def transfer(self, depth: float, q: Reals) -> Transfer:
        """Transfer of waves q > 0 from the surface to a depth (2.4)."""
        if self.aspect_ratio is None:
            return transfer.half_space_transfer(q * depth, self.nu)
        return transfer.slab_transfer(depth, q, self.aspect_ratio, self.nu)

    def _elements(self, q: Reals) -> tuple[Reals, Reals, Reals]:
        if self.aspect_ratio is None:
            return coupled.half_space_elements(self.nu)
        return coupled.slab_elements(q * self.aspect_ratio, self.nu)

    def _condensed_elements(self, q: Reals) -> tuple[Reals, Reals] | tuple[float, float]:
        if self.aspect_ratio is None:
            return 0.5, 0.5
        return coupled.condensed_elements(q * self.aspect_ratio, self.nu)
