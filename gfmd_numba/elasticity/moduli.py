"""Moduli of an isotropic body in units of its effective modulus E*: in plane strain but for `plane_modulus` (6.1.4)."""

from dataclasses import dataclass
from typing import Literal, TypeVar

import numpy as np

from gfmd_numba.arrays import Reals

Number = TypeVar("Number", float, Reals)


def plane_modulus(
    youngs_modulus: float, poissons_ratio: float, state: Literal["plane_strain", "plane_stress"]
) -> float:
    """Effective modulus E*, in the unit of E: E / (1 - nu^2) in plane strain and E in plane stress."""
    return youngs_modulus / (1.0 - poissons_ratio**2) if state == "plane_strain" else youngs_modulus


def kolosov(poissons_ratio: Number) -> Number:
    """Kolosov's constant 3 - 4 nu of plane strain."""
    return 3.0 - 4.0 * poissons_ratio


def c11(poissons_ratio: Reals | float, height: float = 1.0) -> Reals:
    """C11 in E* (6.48), over a height if one is given; infinite for nu = 1/2."""
    nu = np.asarray(poissons_ratio, dtype=np.float64)
    softness = (1.0 - 2.0 * nu) * height
    return np.divide((1.0 - nu) ** 2, softness, out=np.full_like(softness, np.inf), where=softness > 0.0)


def c44(poissons_ratio: Reals | float) -> Reals:
    """Shear modulus C44 in E* (6.48)."""
    return 0.5 * (1.0 - np.asarray(poissons_ratio, dtype=np.float64))


def dundurs_beta(poissons_ratio: float, other: float, compliance_fraction: float) -> float:
    """Dundurs' second constant of two bodies in plane strain (Johnson 1985, 5.1).

    The other body has the `compliance_fraction` of 1/E*. On half-spaces the constant couples pressure and relative
    tangential displacement. It is 0 for two equal bodies.
    """
    own, facing = ((1.0 - 2.0 * nu) / (1.0 - nu) for nu in (poissons_ratio, other))
    return 0.5 * ((1.0 - compliance_fraction) * own - compliance_fraction * facing)


@dataclass(frozen=True)
class Material:
    """Modulus E* in units of that of the topmost layer, and Poisson's ratio up to 1/2."""

    modulus: float
    poissons_ratio: float

    @property
    def shear(self) -> float:
        """Shear modulus C44."""
        return self.modulus * float(c44(self.poissons_ratio))

    @property
    def c11(self) -> float:
        """Modulus C11 of uniaxial strain; infinite for nu = 1/2."""
        return self.modulus * float(c11(self.poissons_ratio))
