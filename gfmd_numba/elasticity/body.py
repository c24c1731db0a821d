"""The elastic body: a half-space, a slab bonded to a rigid base, or a stack of layers on either; its surface is flat.

Lengths in L_x, stresses in E*, of a stack that of its topmost layer. Nothing beyond this file needs to know which of
the three a body is.
"""

from dataclasses import dataclass
from math import inf

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import moduli, stiffness, transfer
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.elasticity.stack import Stack, merged
from gfmd_numba.elasticity.stiffness import Compliance
from gfmd_numba.elasticity.transfer import Transfer
from gfmd_numba.fourier import grid


@dataclass(frozen=True)
class ElasticBody:
    """Poisson's ratio up to 1/2, None where it does not matter; height over L_x, None if no rigid base is below.

    A body of several materials is a `stack`, and has no Poisson's ratio of its own.
    """

    poissons_ratio: float | None
    aspect_ratio: float | None
    stack: Stack | None = None

    @classmethod
    def layered(
        cls, heights: tuple[float, ...], materials: tuple[Material, ...], base: Material | None
    ) -> "ElasticBody":
        """Layers from the surface downwards (heights in L_x) on a half-space of the base, or a rigid one if None.

        Layers that are one slab or half-space together make that.
        """
        stack = merged(heights, materials, base)
        if not stack.heights:
            return cls(stack.top.poissons_ratio, None)
        if len(stack.heights) == 1 and base is None:
            return cls(stack.top.poissons_ratio, stack.height)
        return cls(None, stack.height if base is None else None, stack)

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

    @property
    def top(self) -> "ElasticBody":
        """The topmost layer alone, on a rigid base; a body without layers itself."""
        if self.stack is None:
            return self
        return ElasticBody(self.stack.top.poissons_ratio, self.stack.heights[0])

    def uniform_stiffness(self) -> tuple[float, float]:
        """Stiffness of uniform tangential and normal displacement, in E*/L_x (6.66); on a half-space there is none."""
        if self.aspect_ratio is None:
            return 0.0, 0.0
        if self.stack is not None:
            tangential, normal = self.stack.softness()
            return 1.0 / tangential, 1.0 / normal if normal > 0.0 else inf
        along, out = stiffness.uniform_stiffness(self.nu, self.aspect_ratio)
        return float(along), float(out)

    def uniform_displacement(self, depth: float) -> tuple[float, float]:
        """Tangential and normal displacement over a depth under uniform unit tractions, in L_x/E*."""
        if self.stack is not None:
            return self.stack.softness(depth)
        return depth / float(moduli.c44(self.nu)), depth / float(moduli.c11(self.nu))

    def material(self, depth: float) -> Material:
        """Material at a depth, at an interface that above it; raises ValueError without a Poisson's ratio."""
        return Material(1.0, self.nu) if self.stack is None else self.stack.material(depth)

    def condensed_stiffness(self, q: Reals) -> Reals:
        """Stiffness at wave numbers q of the normal displacement without tangential tractions, in E*/L_x (6.75)."""
        if self.stack is not None:
            found = np.full_like(q, self.uniform_stiffness()[1])
            waves, places = np.unique(q[q > 0.0], return_inverse=True)  # on maps every length occurs several times
            found[q > 0.0] = (waves / self.stack.compliance(waves)[2])[places]
            return found
        return stiffness.half_space(q) if self.aspect_ratio is None else stiffness.slab(q, self.nu, self.aspect_ratio)

    def response(self, shape: tuple[int, ...]) -> SpectralResponse:
        """Response of all displacements of a surface of (ny,) nx nodes, in E*/L_x (6.58), (6.83)."""
        lengths = grid.magnitudes(shape)
        q, places = np.unique(lengths, return_inverse=True)  # on maps every length occurs several times
        tangential, normal = self.uniform_stiffness()
        of_waves: list[Reals | float] = [*self._elements(q[1:])]
        of_means = tangential, 0.0, normal, tangential
        if len(shape) > 1:  # waves may also slip across their own direction
            of_waves.append(self._across(q[1:]))
        elements = np.empty((len(of_waves), len(q)))
        for element, mean, over_q in zip(elements, of_means, of_waves, strict=False):
            element[0], element[1:] = mean, q[1:] * over_q
        return SpectralResponse.on_grid(shape, *elements[:, places.reshape(lengths.shape)])

    def compliance(self, wavenumbers: Reals) -> Compliance:
        """Inverse of the stiffness in the planes of waves of numbers q `[wave]`, of which the first alone is 0.

        In L_x/E*. A half-space's mean displacement is held.
        """
        q = wavenumbers[1:]
        tangential, normal, lead = np.zeros((3, len(q) + 1))
        tangential[0], normal[0] = (uniform or inf for uniform in self.uniform_stiffness())
        tangential[1:], normal[1:] = (q * over_q for over_q in self._condensed_elements(q))
        a11, a13, _ = self._elements(q)
        lead[1:] = a13 / a11
        return Compliance(1.0 / tangential, lead / normal, 1.0 / normal)

    def transfer(self, depth: float, q: Reals) -> Transfer:
        """Transfer of waves q > 0 from the surface to a depth (2.4)."""
        if self.stack is not None:
            return self.stack.transfer(depth, q)
        if self.aspect_ratio is None:
            return transfer.half_space_transfer(q * depth, self.nu)
        return transfer.slab_transfer(depth, q, self.aspect_ratio, self.nu)

    def compliance_across(self, q: Reals) -> Reals:
        """Compliance of waves q > 0 of shear, whose displacement is across q and along the surface, in L_x/E*."""
        return np.asarray(1.0 / (q * self._across(q)))

    def transfer_across(self, depth: float, q: Reals) -> tuple[Reals, Reals]:
        """Displacement of waves q > 0 of shear across q, and its slope over q at a depth, over that of the surface."""
        if self.stack is not None:
            return self.stack.transfer_across(depth, q)
        if self.aspect_ratio is None:
            decay = np.exp(-q * depth)
            return decay, decay
        return transfer.across_transfer(depth, q, self.aspect_ratio, 0.0)

    def _elements(self, q: Reals) -> tuple[Reals, Reals, Reals]:
        if self.stack is not None:
            s11, s13, s33 = self.stack.compliance(q)
            determinant = s11 * s33 - s13**2
            return s33 / determinant, s13 / determinant, s11 / determinant
        if self.aspect_ratio is None:
            return stiffness.half_space_elements(self.nu)
        return stiffness.slab_elements(q * self.aspect_ratio, self.nu)

    def _across(self, q: Reals) -> Reals | float:
        """Stiffness over q of waves of shear, whose displacement is across q and along the surface, in E*."""
        if self.stack is not None:
            return 1.0 / self.stack.compliance_across(q)
        if self.aspect_ratio is None:
            return float(moduli.c44(self.nu))
        return np.asarray(moduli.c44(self.nu) / np.tanh(q * self.aspect_ratio))

    def _condensed_elements(self, q: Reals) -> tuple[Reals, Reals] | tuple[float, float]:
        if self.stack is not None:
            s11, _, s33 = self.stack.compliance(q)
            return 1.0 / s11, 1.0 / s33
        if self.aspect_ratio is None:
            return 0.5, 0.5
        return stiffness.condensed_elements(q * self.aspect_ratio, self.nu)
