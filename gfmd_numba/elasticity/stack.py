"""A stack of layers on a rigid base or a half-space: compliance of its surface and waves inside it.

Lengths in L_x, stresses in E* of the topmost layer. The layers are taken from the base upwards, each adding itself to
the compliance of all below it, as in layered acoustics (Rokhlin & Wang, J. Acoust. Soc. Am. 112:822, 2002).
"""

from dataclasses import dataclass
from itertools import accumulate
from math import inf, isinf

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.layer import Layer, Material, half_space, half_space_state, inverse
from gfmd_numba.elasticity.transfer import Transfer, across_transfer

_FADED = 40.0  # q depth below which nothing is felt at the surface: exp(-2 q depth) (q depth)^2 < 1e-31
_CHUNK = 2**14  # waves taken at once, whose matrices stay in the cache


@dataclass(frozen=True)
class Stack:
    """Heights in L_x and materials from the surface downwards; the material of the base is None if it is rigid."""

    heights: tuple[float, ...]
    materials: tuple[Material, ...]
    base: Material | None

    @property
    def top(self) -> Material:
        """Material of the surface."""
        return self.materials[0] if self.materials else self._lowest

    @property
    def height(self) -> float:
        """Height of all layers (L_x)."""
        return sum(self.heights)

    def material(self, depth: float) -> Material:
        """Material at a depth (L_x), at an interface that above it."""
        for bottom, material in zip(accumulate(self.heights), self.materials, strict=True):
            if depth <= bottom * (1.0 + 1e-12):
                return material
        return self._lowest

    @property
    def _lowest(self) -> Material:
        return self.materials[-1] if self.base is None else self.base

    def softness(self, depth: float = inf) -> tuple[float, float]:
        """Uniform tangential and normal displacement of the layers down to a depth under unit traction, in L_x/E*."""
        tangential, normal, left = 0.0, 0.0, depth
        for height, material in zip(self.heights, self.materials, strict=True):
            part = min(height, left)
            tangential, normal, left = tangential + part / material.shear, normal + part / material.c11, left - part
        if self.base is not None and left > 0.0 and not isinf(left):
            tangential, normal = tangential + left / self.base.shear, normal + left / self.base.c11
        return tangential, normal

    def compliance(self, q: Reals) -> tuple[Reals, Reals, Reals]:
        """Elements S11, S13 and S33 of the compliance times q of waves q > 0 `[wave]`, in 1/E*."""
        found = np.empty((3, len(q)))
        for first in range(0, len(q), _CHUNK):
            some = slice(first, first + _CHUNK)
            surface = self._compliances(q[some])[0]
            # U_3 sin(qx) has the coefficient -i U_3, which turns the sign
            found[:, some] = surface[0, 0], -surface[0, 1], surface[1, 1]
        return found[0], found[1], found[2]

    def compliance_across(self, q: Reals) -> Reals:
        """Compliance times q of waves q > 0 of shear across q, in 1/E*: displacement along the surface, u'' = q^2 u."""
        return self._compliances_across(q)[0]

    def transfer_across(self, depth: float, q: Reals) -> tuple[Reals, Reals]:
        """Displacement and its slope over q of waves q > 0 of shear across q at a depth, over that of the surface."""
        compliances = self._compliances_across(q)
        reached, above = np.ones_like(q), 0.0
        for height, material, below in zip(self.heights, self.materials, compliances[1:], strict=True):
            inside = depth <= (above + height) * (1.0 + 1e-12)
            deep = min(depth - above, height) if inside else height
            found, slope = across_transfer(deep, q, height, material.shear * below)
            if inside:
                return reached * found, reached * slope
            reached, above = reached * found, above + height
        if self.base is None:
            raise ValueError("depth below the rigid base")
        reached = reached * np.exp(-q * (depth - above))
        return reached, reached

    def transfer(self, depth: float, q: Reals) -> Transfer:
        """Transfer of waves q > 0 from the surface to a depth."""
        compliances = self._compliances(q)
        traction = inverse(compliances[0])  # over q, of unit displacements at the surface
        above = 0.0
        for i, (height, material) in enumerate(zip(self.heights, self.materials, strict=True)):
            scale = 2.0 * material.shear
            layer = Layer(q * height, material.poissons_ratio, scale * compliances[i + 1])
            inside = depth <= (above + height) * (1.0 + 1e-12)
            # to the last digit at the bottom, as a wave may decay within less than the rounding of a depth
            state = layer.state(q * min(depth - above, height) if inside else q * height, traction / scale)
            if inside:
                break
            traction, above = scale * state.traction, above + height
        else:
            if self.base is None:
                raise ValueError("depth below the rigid base")
            material = self.base
            state = half_space_state(q * (depth - above), material.poissons_ratio, traction / (2.0 * material.shear))
        (u1, u3), (t1, t3) = state.displacement, 2.0 * state.traction
        over = moduli.kolosov(material.poissons_ratio) + 1.0
        # sigma_33 = G q (2 U_1 + (kolosov + 1) P) and sigma_13 = G q (2 U_3 + (kolosov + 1) W)
        p, w = (t3 - 2.0 * u1) / over, (t1 - 2.0 * u3) / over
        return Transfer(*((each[0], each[1]) for each in (u1, u3, p, w)))

    def _compliances_across(self, q: Reals) -> list[Reals]:
        """Compliance times q of waves of shear across q, from each layer's top downwards, the base's last, in 1/E*."""
        found = [np.full_like(q, 0.0 if self.base is None else 1.0 / self.base.shear)]
        for height, material in reversed(list(zip(self.heights, self.materials, strict=True))):
            decay, below = np.tanh(q * height), found[-1]
            found.append((below + decay / material.shear) / (1.0 + material.shear * decay * below))
        return found[::-1]

    def _compliances(self, q: Reals) -> list[Reals]:
        """Compliance times q `[2, 2, wave]` of all from each layer's top downwards, the base's last, in 1/E*."""
        if self.base is None:
            below = np.zeros((2, 2, len(q)))
        else:
            below = np.broadcast_to(half_space(self.base.poissons_ratio), (2, 2, len(q))) / (2.0 * self.base.shear)
        found = [below]
        tops = [0.0, *accumulate(self.heights)]
        for top, height, material in reversed(list(zip(tops, self.heights, self.materials, strict=False))):
            scale, nu = 2.0 * material.shear, material.poissons_ratio
            compliance = np.broadcast_to(half_space(nu), (2, 2, len(q))).copy()  # of waves that fade above it
            felt = q * top < _FADED
            compliance[..., felt] = Layer(q[felt] * height, nu, scale * found[-1][..., felt]).compliance()
            found.append(compliance / scale)
        return found[::-1]


def merged(heights: tuple[float, ...], materials: tuple[Material, ...], base: Material | None) -> Stack:
    """Stack whose neighbours differ: equal ones are one layer, and lowest layers of the base's material the base.

    Heights are rounded to 15 digits, so that neither their sums nor their units make two bodies of one.
    """
    kept: list[tuple[float, Material]] = []
    for height, material in zip(heights, materials, strict=True):
        if kept and kept[-1][1] == material:
            height += kept.pop()[0]
        kept.append((height, material))
    if kept and kept[-1][1] == base:
        kept.pop()
    return Stack(tuple(float(f"{height:.15g}") for height, _ in kept), tuple(material for _, material in kept), base)
