"""Compliance of both displacements of a profile, the inverse of the coupled stiffness, wave by wave."""

from dataclasses import dataclass

from gfmd_numba.arrays import Complexes, Reals


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

    def displacements(self, tangential: Complexes, normal: Complexes) -> tuple[Complexes, Complexes]:
        """Coefficients `[nx // 2 + 1]` of both displacements, tangential and normal, under those of both tractions."""
        return self.s11 * tangential - 1j * self.s13 * normal, self.s33 * normal + 1j * self.s13 * tangential
