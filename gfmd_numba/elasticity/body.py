"""The elastic body: a half-space, a slab bonded to a rigid base, or a stack of layers on either; its surface is flat.

Slabs and layers are always bonded to what is below them: a rigid base without friction is not available. At the top
surface, `condensed_stiffness` holds without tangential tractions there, and `response` has all displacements. Lengths
in L_x, stresses in E*, of a stack the E* of its topmost layer. Nothing beyond this file needs to know which of the
three a body is.

A pressure wave of wave number q moves a half-space by 2/q times itself. With k = q height and c = 3 - 4 nu, it moves a
slab by (2/q) (2 c sinh 2k - 4 k) / (2 c cosh 2k + 4 k^2 + 1 + c^2), and a uniform one by (1 - 2 nu)/(1 - nu)^2 height.
`layers.py` finds this, and the same of any stack, without a loss of digits.
"""

from dataclasses import dataclass
from functools import cached_property
from math import exp, inf

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.layers import Stack, merged
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.elasticity.spectral_response import SpectralResponse
from gfmd_numba.elasticity.stiffness import half_space
from gfmd_numba.fourier import grid

_SURE = 1e-12  # difference from a half-space below which its leading term is taken, as rounding hides the rest


@dataclass(frozen=True)
class Compliance:
    """Elements S11, S13, S33 of the inverse of the stiffness (6.57) `[nx // 2 + 1]`, in L_x/E*."""

    s11: Reals
    s13: Reals
    s33: Reals

    @property
    def elements(self) -> tuple[Reals, Reals, Reals]:
        """The elements of the inverse matrix, in the order and with the signs of those of the stiffness."""
        return self.s11, -self.s13, self.s33


@dataclass(frozen=True)
class ElasticBody:
    """Poisson's ratio up to 1/2, None where it does not matter, and `aspect_ratio`, the height over L_x.

    Without a rigid base, the aspect ratio is None. A body of several materials is a `stack`, and has no Poisson's ratio
    of its own.
    """

    poissons_ratio: float | None
    aspect_ratio: float | None
    stack: Stack | None = None

    @classmethod
    def layered(
        cls, heights: tuple[float, ...], materials: tuple[Material, ...], base: Material | None
    ) -> "ElasticBody":
        """Layers from the surface downwards (heights in L_x) on a half-space of the base, or a rigid one if None.

        Equal layers merge, so that the body may be a slab or a half-space.
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
    def base_z(self) -> float:
        """Place z of the rigid base, minus the height over L_x; minus infinity for a half-space."""
        return -inf if self.aspect_ratio is None else -self.aspect_ratio

    @property
    def top(self) -> "ElasticBody":
        """The topmost layer alone, on a rigid base; a body without layers itself."""
        if self.stack is None:
            return self
        return ElasticBody(self.stack.top.poissons_ratio, self.stack.heights[0])

    @cached_property
    def layers(self) -> Stack:
        """The body as a stack: a slab is one layer on a rigid base, and a half-space a base without layers.

        Raises ValueError for a body of one material without a Poisson's ratio.
        """
        if self.stack is not None:
            return self.stack
        own = Material(1.0, self.nu)
        return Stack((), (), own) if self.aspect_ratio is None else Stack((self.aspect_ratio,), (own,), None)

    def uniform_stiffness(self) -> tuple[float, float]:
        """Stiffness of uniform tangential and normal displacement, in E*/L_x (6.66): 0 on a half-space."""
        if self.aspect_ratio is None:
            return 0.0, 0.0
        tangential, normal = self.layers.uniform_compliance()
        return 1.0 / tangential, 1.0 / normal if normal > 0.0 else inf

    def material(self, depth: float) -> Material:
        """Material at a depth, at an interface the upper one; raises ValueError without a Poisson's ratio."""
        return self.layers.material(depth)

    def condensed_stiffness(self, q: Reals) -> Reals:
        """Stiffness at wave numbers q of the normal displacement without tangential tractions, in E*/L_x (6.75).

        The tangential displacement is condensed: eliminated, as no traction acts on it at the surface.
        """
        if self.stack is None and self.aspect_ratio is None:
            return half_space(q)
        found = np.full_like(q, self.uniform_stiffness()[1])
        waves, places = np.unique(q[q > 0.0], return_inverse=True)  # on maps every length occurs several times
        found[q > 0.0] = (waves / self.layers.compliance_times_q(waves)[2])[places]
        return found

    def deviation(self) -> float:
        """Largest relative difference of the stiffness of a wave from that of a half-space of the topmost material.

        The difference stems from below the topmost layer, and fades as exp(-2 q height). So in a slab the longest wave
        has the largest one.
        """
        height, count = self.layers.heights[0], 1 if self.stack is None else 256
        q = 2.0 * np.pi * np.unique(np.round(np.geomspace(1.0, max(1.0, 6.0 / height), count)))
        found = float(np.abs(self.condensed_stiffness(q) / half_space(q) - 1.0).max())
        if self.stack is not None or found > _SURE:
            return found
        k, kolosov = min(2.0 * np.pi * height, 1e3), moduli.kolosov(self.nu)  # far beyond any effect at the latter
        return (1.0 + kolosov**2 + 4.0 * k**2 + 4.0 * k) * exp(-2.0 * k) / kolosov

    def response(self, shape: tuple[int, ...]) -> SpectralResponse:
        """Response of all displacements of a surface of (ny,) nx nodes, in E*/L_x (6.58), (6.83)."""
        lengths = grid.magnitudes(shape)
        q, places = np.unique(lengths, return_inverse=True)  # on maps every length occurs several times
        tangential, normal = self.uniform_stiffness()
        s11, s13, s33 = self.layers.compliance_times_q(q[1:])
        determinant = s11 * s33 - s13**2
        across = 1.0 / self.layers.compliance_across(q[1:])  # waves may also slip across their own direction
        of_waves = s33 / determinant, s13 / determinant, s11 / determinant, across
        elements = np.empty((len(of_waves), len(q)))
        for element, mean, over_q in zip(elements, (tangential, 0.0, normal, tangential), of_waves, strict=True):
            element[0], element[1:] = mean, q[1:] * over_q
        return SpectralResponse.on_grid(shape, *elements[:, places.reshape(lengths.shape)])

    def compliance(self, wavenumbers: Reals) -> Compliance:
        """Inverse of the stiffness in the planes of waves of numbers q `[wave]`, of which the first alone is 0.

        In L_x/E*. A half-space's mean displacement is held.
        """
        q, found = wavenumbers[1:], np.zeros((3, wavenumbers.size))
        found[:, 1:] = np.divide(self.layers.compliance_times_q(q), q)
        found[[0, 2], 0] = [1.0 / uniform if uniform else 0.0 for uniform in self.uniform_stiffness()]
        return Compliance(*found)

    def compliance_across(self, q: Reals) -> Reals:
        """Compliance of waves q > 0 of shear, whose displacement is across q and along the surface, in L_x/E*."""
        return self.layers.compliance_across(q) / q
