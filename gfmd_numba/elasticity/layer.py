"""One elastic layer: what it makes of the compliance of all that lies below it, and of a wave on its way down.

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

All matrices are `[2, 2, wave]`, rows and columns being component 1 and 3.
"""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.stiffness import scaled_sinh_minus_x

THIN = 1.0  # q h below which a layer is taken as a whole


@dataclass(frozen=True)
class Material:
    """Modulus E* in units of that of the topmost layer, and Poisson's ratio up to 1/2."""

    modulus: float
    poissons_ratio: float

    @property
    def shear(self) -> float:
        """Shear modulus C44."""
        return self.modulus * float(moduli.c44(self.poissons_ratio))

    @property
    def c11(self) -> float:
        """Modulus C11 of uniaxial strain; infinite for nu = 1/2."""
        return self.modulus * float(moduli.c11(self.poissons_ratio))


@dataclass(frozen=True)
class State:
    """Displacements U and tractions t on a plane, in units of 2 G q `[component, load, wave]`."""

    displacement: Reals
    traction: Reals


class Layer:
    """A layer of thickness k = q h `[wave]` on something of compliance S `[2, 2, wave]`, in 1/(2 G q)."""

    def __init__(self, k: Reals, poissons_ratio: float, below: Reals) -> None:
        self._k, self._nu, self._below = k, poissons_ratio, below
        self._thin = k < THIN
        self._b = poissons_ratio / (1.0 - poissons_ratio)
        thin = self._thin
        top = np.empty((2, 2, 2, len(k)))  # displacement and traction at the top, for two independent loads
        top[..., thin] = self._of_bottom(k[thin], below[..., thin])
        self._reflection = self._reflected(below[..., ~thin])
        top[..., ~thin] = self._of_waves(
            _decaying(np.zeros_like(k[~thin])), self._returned(k[~thin], np.zeros_like(k[~thin]))
        )
        self._top_displacement, self._to_loads = top[0], inverse(top[1])

    def compliance(self) -> Reals:
        """Compliance `[2, 2, wave]` of the top, in 1/(2 G q)."""
        return symmetric(product(self._top_displacement, self._to_loads))

    def state(self, d: Reals, traction: Reals) -> State:
        """State at d = q depth `[wave]` below the top, from tractions there `[component, load, wave]`."""
        loads = product(self._to_loads, traction)
        thin, k = self._thin, self._k
        found = np.empty((2, 2, 2, len(k)))
        found[..., thin] = self._of_bottom(k[thin] - d[thin], self._below[..., thin])
        found[..., ~thin] = self._of_waves(_decaying(d[~thin]), self._returned(k[~thin], d[~thin]))
        return State(product(found[0], loads), product(found[1], loads))

    def _of_bottom(self, y: Reals, below: Reals) -> Reals:
        """Displacements and tractions at q times a height y above the bottom, for unit tractions there."""
        b, half = self._b, 0.5 * (1.0 + self._b)
        sinh, cosh = np.sinh(y), np.cosh(y)
        bend, shear = half * (2.0 * y * np.sinh(0.5 * y) ** 2 - scaled_sinh_minus_x(y) * np.exp(y)), half * y * sinh
        own = np.array([[cosh + shear, -sinh - bend], [b * sinh + bend, cosh - shear]])
        soft = np.array([[2.0 * sinh + bend, -shear], [shear, (1.0 - b) * sinh - bend]])
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

    def _of_waves(self, v: Reals, w: Reals) -> Reals:
        return of_waves(v, w, self._nu)


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


def half_space(poissons_ratio: float) -> Reals:
    """Compliance `[2, 2, 1]` of a half-space, in 1/(2 G q) (6.83)."""
    nu = poissons_ratio
    lead = -(1.0 - 2.0 * nu)
    return np.array([[2.0 * (1.0 - nu), lead], [lead, 2.0 * (1.0 - nu)]])[..., np.newaxis]


def half_space_state(d: Reals, poissons_ratio: float, traction: Reals) -> State:
    """State at d = q depth in a half-space, from tractions `[component, load, wave]` on its surface."""
    nu = poissons_ratio
    v = np.array([2.0 * (1.0 - nu) * traction[0] - (1.0 - 2.0 * nu) * traction[1], traction[0] - traction[1]])
    v = product(_decaying(d), v)
    return State(*of_waves(v, np.zeros_like(v), nu))


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
