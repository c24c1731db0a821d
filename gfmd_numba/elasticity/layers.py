"""A stack of layers on a rigid base or a half-space: compliance of its surface and waves inside it.

Lengths in L_x, stresses in E* of the topmost layer. The compliance is found from the base upwards, layer by layer: from
the compliance at the bottom of a layer follows the one at its top, as in layered acoustics (Rokhlin & Wang, J. Acoust.
Soc. Am. 112:822, 2002).

A wave of wave number q is u_1 = U_1(z) cos(qx), u_3 = U_3(z) sin(qx), with the tractions sigma_13 = 2 G q t_1 cos(qx)
and sigma_33 = 2 G q t_3 sin(qx) on planes of constant z, which points out of the body. Hooke's law in plane strain and
equilibrium say, with b = nu / (1 - nu) and y = q z,

    U_1' = 2 t_1 - U_3,    U_3' = b U_1 + (1 - b) t_3,    t_1' = (1 + b) U_1 - b t_3,    t_3' = t_1,

which is finite for all -1 < nu <= 1/2. The matrix A of this system has (A^2 - 1)^2 = 0, so that its solutions are

    exp(y A) = cosh y + A sinh y + (1 + b)/2 (y sinh y + A (y cosh y - sinh y)) N,    (1 + b) N = A^2 - 1.

A layer with q h < 1 takes the compliance S of what lies below, U = S t, from its bottom to its top by this matrix: no
term is far larger than the result. In a thicker layer the two waves v that decay downwards and the two waves w that
decay upwards are followed, each in its own direction, so that only exp(-q h) occurs; R is the reflection of v into w at
the bottom. Transfer matrices of several layers are never multiplied: they lose all digits once exp(2 q h) exceeds the
inverse of the rounding.

All matrices are `[2, 2, wave]`, rows and columns being component 1 and 3. For one layer on a rigid base S33 is the
formula of a slab at the head of `body.py`. Layers are bonded to each other and to the base: at a rigid base
U_1 = U_3 = 0. A base without friction, U_3 = t_1 = 0, is not built.
"""

from dataclasses import dataclass
from itertools import accumulate
from math import inf, isinf

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.moduli import Material

_FADED = 40.0  # q depth below which nothing is felt at the surface: exp(-2 q depth) (q depth)^2 < 1e-31
_CHUNK = 2**14  # waves taken at once, whose matrices stay in the cache
_THIN = 1.0  # q h below which a layer is taken as a whole

_SERIES = 1.0 / np.array([6.0, 120.0, 5040.0, 362880.0, 39916800.0, 6227020800.0, 1307674368000.0])


@dataclass(frozen=True)
class Transfer:
    """Values of U_1, U_3, P and W at a depth, for unit U_1 and for unit U_3 at the surface, wave by wave.

    P and W are conjugate harmonic functions, P' = -q W: 2 (1 - 2 nu) q P is the dilatation, 2 (1 - nu) q W the
    rotation, so that stresses over the shear modulus stay finite at nu = 1/2 (2.4).
    """

    u1: tuple[Reals, Reals]
    u3: tuple[Reals, Reals]
    p: tuple[Reals, Reals]
    w: tuple[Reals, Reals]


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
        """Material at a depth (L_x), at an interface the upper one."""
        for bottom, material in zip(accumulate(self.heights), self.materials, strict=True):
            if depth <= bottom * (1.0 + 1e-12):
                return material
        return self._lowest

    @property
    def _lowest(self) -> Material:
        return self.materials[-1] if self.base is None else self.base

    def uniform_compliance(self, depth: float = inf) -> tuple[float, float]:
        """Uniform tangential and normal displacement of the layers down to a depth under unit traction, in L_x/E*."""
        tangential, normal, left = 0.0, 0.0, depth
        for height, material in zip(self.heights, self.materials, strict=True):
            part = min(height, left)
            tangential, normal, left = tangential + part / material.shear, normal + part / material.c11, left - part
        if self.base is not None and left > 0.0 and not isinf(left):
            tangential, normal = tangential + left / self.base.shear, normal + left / self.base.c11
        return tangential, normal

    def compliance_times_q(self, q: Reals) -> tuple[Reals, Reals, Reals]:
        """Elements S11, S13 and S33 of the compliance times q of waves q > 0 `[wave]`, in 1/E*."""
        found = np.empty((3, len(q)))
        for first in range(0, len(q), _CHUNK):
            some = slice(first, first + _CHUNK)
            surface = self._surface_compliance(q[some])
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
        below, layers = self._compliance_of_base(q), []
        for height, material in reversed(list(zip(self.heights, self.materials, strict=True))):
            scale = 2.0 * material.shear
            layers.append((height, material, ElasticLayer(q * height, material.poissons_ratio, scale * below)))
            below = layers[-1][2].compliance() / scale
        traction = inverse(below)  # over q, of unit displacements at the surface
        above = 0.0
        for height, material, layer in reversed(layers):
            scale = 2.0 * material.shear
            inside = depth <= (above + height) * (1.0 + 1e-12)
            # to the last digit at the bottom, as a wave may decay within less than the rounding of a depth
            moved, borne = layer.state(q * min(depth - above, height) if inside else q * height, traction / scale)
            if inside:
                break
            traction, above = scale * borne, above + height
        else:
            if self.base is None:
                raise ValueError("depth below the rigid base")
            material = self.base
            moved, borne = half_space_state(
                q * (depth - above), material.poissons_ratio, traction / (2.0 * material.shear)
            )
        (u1, u3), (t1, t3) = moved, 2.0 * borne
        over = moduli.kolosov(material.poissons_ratio) + 1.0
        # sigma_33 = G q (2 U_1 + (kolosov + 1) P) and sigma_13 = G q (2 U_3 + (kolosov + 1) W)
        p, w = (t3 - 2.0 * u1) / over, (t1 - 2.0 * u3) / over
        return Transfer(*((each[0], each[1]) for each in (u1, u3, p, w)))

    def _compliance_of_base(self, q: Reals) -> Reals:
        if self.base is None:
            return np.zeros((2, 2, len(q)))
        return np.broadcast_to(half_space_compliance(self.base.poissons_ratio), (2, 2, len(q))) / (
            2.0 * self.base.shear
        )

    def _compliances_across(self, q: Reals) -> list[Reals]:
        """Compliance times q of waves of shear across q, from each layer's top downwards, the base's last, in 1/E*."""
        found = [np.full_like(q, 0.0 if self.base is None else 1.0 / self.base.shear)]
        for height, material in reversed(list(zip(self.heights, self.materials, strict=True))):
            decay, below = np.tanh(q * height), found[-1]
            found.append((below + decay / material.shear) / (1.0 + material.shear * decay * below))
        return found[::-1]

    def _surface_compliance(self, q: Reals) -> Reals:
        """Compliance times q `[2, 2, wave]` of the surface, in 1/E*."""
        below = self._compliance_of_base(q)
        tops = [0.0, *accumulate(self.heights)]
        for top, height, material in reversed(list(zip(tops, self.heights, self.materials, strict=False))):
            scale, nu = 2.0 * material.shear, material.poissons_ratio
            # of waves that fade above it
            compliance = np.broadcast_to(half_space_compliance(nu), (2, 2, len(q))).copy()
            felt = q * max(top, height) < _FADED  # what is below at the layer's top, and that at the surface
            compliance[..., felt] = ElasticLayer(q[felt] * height, nu, scale * below[..., felt]).compliance()
            below = compliance / scale
        return below


def across_transfer(depth: float, q: Reals, height: float, below: Reals | float) -> tuple[Reals, Reals]:
    """Transfer of waves of shear, u'' = q^2 u, from the top of a layer to a depth in it (L_x), for q > 0 `[wave]`.

    Return the displacement at the depth and its slope in z over q, both over the displacement on top. `below` is q
    times the compliance of what lies below the layer, times the layer's shear modulus: 0 if rigid, 1 if the same.
    """
    less, less_on_top = -np.expm1(-2.0 * q * (height - depth)), -np.expm1(-2.0 * q * height)
    scale = np.exp(-q * depth) / (less_on_top + below * (2.0 - less_on_top))
    return scale * (less + below * (2.0 - less)), scale * (2.0 - less + below * less)


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


class ElasticLayer:
    """A layer of thickness k = q h `[wave]` on something of compliance S `[2, 2, wave]`, in 1/(2 G q)."""

    def __init__(self, k: Reals, poissons_ratio: float, below: Reals) -> None:
        self._k, self._nu, self._below = k, poissons_ratio, below
        self._thin = k < _THIN
        self._b = poissons_ratio / (1.0 - poissons_ratio)
        thin = self._thin
        top = np.empty((2, 2, 2, len(k)))  # displacement and traction at the top, for two independent loads
        top[..., thin] = self._of_bottom(k[thin], below[..., thin])
        self._reflection = self._reflected(below[..., ~thin])
        at_top = np.zeros_like(k[~thin])
        top[..., ~thin] = of_waves(_decaying(at_top), self._returned(k[~thin], at_top), poissons_ratio)
        self._top_displacement, self._to_loads = top[0], inverse(top[1])

    def compliance(self) -> Reals:
        """Compliance `[2, 2, wave]` of the top, in 1/(2 G q)."""
        return symmetric(product(self._top_displacement, self._to_loads))

    def state(self, d: Reals, traction: Reals) -> tuple[Reals, Reals]:
        """Displacements and tractions at d = q depth `[wave]` below the top, from tractions there.

        All are `[component, load, wave]`, in units of 2 G q.
        """
        loads = product(self._to_loads, traction)
        thin, k = self._thin, self._k
        found = np.empty((2, 2, 2, len(k)))
        found[..., thin] = self._of_bottom(k[thin] - d[thin], self._below[..., thin])
        found[..., ~thin] = of_waves(_decaying(d[~thin]), self._returned(k[~thin], d[~thin]), self._nu)
        return product(found[0], loads), product(found[1], loads)

    def _of_bottom(self, y: Reals, below: Reals) -> Reals:
        """Displacements and tractions at q times a height y above the bottom, for unit tractions there."""
        b, half = self._b, 0.5 * (1.0 + self._b)
        rest = (1.0 - 2.0 * self._nu) / (1.0 - self._nu)  # 1 - b, to all digits
        sinh, cosh = np.sinh(y), np.cosh(y)
        bend, shear = half * (2.0 * y * np.sinh(0.5 * y) ** 2 - scaled_sinh_minus_x(y) * np.exp(y)), half * y * sinh
        own = np.array([[cosh + shear, -sinh - bend], [b * sinh + bend, cosh - shear]])
        soft = np.array([[2.0 * sinh + bend, -shear], [shear, rest * sinh - bend]])
        stiff = np.array([[2.0 * half * sinh + bend, -shear], [shear, -bend]])
        carried = np.array([[cosh + shear, -b * sinh - bend], [sinh + bend, cosh - shear]])
        return np.array([product(own, below) + soft, product(stiff, below) + carried])

    def _reflected(self, below: Reals) -> Reals:
        """Amplitudes of w at the bottom for unit amplitudes of v there."""
        double, kolosov = 2.0 * (1.0 - self._nu), moduli.kolosov(self._nu)
        both_2 = np.array([below[0, 0], below[0, 1] - 1.0]) / double
        difference_2 = np.array([1.0 - below[1, 0], -below[1, 1]]) / double
        both = np.array([below[0], both_2])
        difference = np.array([below[1] + kolosov * difference_2, difference_2])
        return product(both - difference, inverse(both + difference))

    def _returned(self, k: Reals, d: Reals) -> Reals:
        """Amplitudes of w at d below the top for unit amplitudes of v at the top."""
        return product(product(_decaying(k - d), self._reflection), _decaying(k))


def of_waves(v: Reals, w: Reals, poissons_ratio: float) -> Reals:
    """Displacements and tractions `[2, component, load, wave]` of amplitudes of v and w `[2, load, wave]`.

    With z upwards v_1 = (1, 1, 1, 1) exp(y) and v_2 = (0, -kolosov, 2 nu - 1, 2 nu - 2) exp(y) + y v_1; w mirrors them.
    """
    nu = poissons_ratio
    both, difference = v + w, v - w
    return np.array(
        [
            [both[0], difference[0] - moduli.kolosov(nu) * difference[1]],
            [difference[0] - (1.0 - 2.0 * nu) * difference[1], both[0] - 2.0 * (1.0 - nu) * both[1]],
        ]
    )


def scaled_sinh_minus_x(x: Reals) -> Reals:
    """(sinh x - x) exp(-x) without cancellation at small x or overflow at large x."""
    decay = np.exp(-x)
    small = np.minimum(x, 1.0)
    series = small**3 * np.polynomial.polynomial.polyval(small**2, _SERIES) * decay
    direct = -0.5 * np.expm1(-2.0 * x) - x * decay
    return np.where(x < 1.0, series, direct)


def half_space_compliance(poissons_ratio: float) -> Reals:
    """Compliance `[2, 2, 1]` of a half-space, in 1/(2 G q) (6.83)."""
    nu = poissons_ratio
    lead = -(1.0 - 2.0 * nu)
    return np.array([[2.0 * (1.0 - nu), lead], [lead, 2.0 * (1.0 - nu)]])[..., np.newaxis]


def half_space_state(d: Reals, poissons_ratio: float, traction: Reals) -> Reals:
    """What `ElasticLayer.state` finds, at d = q depth in a half-space under tractions `[component, load, wave]`."""
    nu = poissons_ratio
    v = np.array([2.0 * (1.0 - nu) * traction[0] - (1.0 - 2.0 * nu) * traction[1], traction[0] - traction[1]])
    v = product(_decaying(d), v)
    return of_waves(v, np.zeros_like(v), nu)


def _decaying(d: Reals) -> Reals:
    """Amplitudes of v at d below a plane, or of w at d above it, for unit amplitudes on the plane."""
    decay = np.exp(-d)
    return np.array([[decay, -np.where(decay > 0.0, d, 0.0) * decay], [np.zeros_like(d), decay]])


def product(a: Reals, b: Reals) -> Reals:
    """Products of matrices `[2, 2, wave]`, wave by wave."""
    return np.asarray(np.einsum("ijn,jkn->ikn", a, b))


def inverse(a: Reals) -> Reals:
    """Inverses of matrices `[2, 2, wave]`."""
    adjugate = np.array([[a[1, 1], -a[0, 1]], [-a[1, 0], a[0, 0]]])
    return np.asarray(adjugate / (a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0]))


def symmetric(a: Reals) -> Reals:
    """Matrices `[2, 2, wave]` that are symmetric but for rounding, without that."""
    return np.asarray(0.5 * (a + a.swapaxes(0, 1)))
