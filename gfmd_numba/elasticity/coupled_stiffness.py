"""Stiffness of both displacements of a profile, wave by wave."""

from dataclasses import dataclass, replace

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity.compliance import Compliance
from gfmd_numba.elasticity.stiffness import in_series
from gfmd_numba.fourier import grid


@dataclass(frozen=True)
class CoupledStiffness:
    """Elements K11, K13, K33 of the stiffness of both displacements `[nx // 2 + 1]`, in E*/L_x (6.57)."""

    k11: Reals
    k13: Reals
    k33: Reals

    @classmethod
    def on_grid(cls, nx: int, k11: Reals, k13: Reals, k33: Reals) -> "CoupledStiffness":
        """Stiffness on nx nodes, from elements `[nx // 2 + 1]` that are overwritten at Nyquist.

        There the grid knows only one phase of the wave: its partner in the other component, a quarter wave off,
        vanishes on every node. It is condensed out, as if it were free.
        """
        if nx % 2 == 0:
            k11[-1], k33[-1] = k11[-1] - k13[-1] ** 2 / k33[-1], k33[-1] - k13[-1] ** 2 / k11[-1]
            k13[-1] = 0.0
        return cls(k11, k13, k33)

    @property
    def elements(self) -> tuple[Reals, Reals, Reals]:
        """The elements in this order."""
        return self.k11, self.k13, self.k33

    def condensed(self) -> Reals:
        """Stiffness of the normal displacement where no tangential traction acts (Schur complement, 6.75)."""
        softening = np.divide(self.k13**2, self.k11, out=np.zeros_like(self.k13), where=self.k13 != 0.0)
        return np.asarray(self.k33 - softening)

    def compliance(self) -> Compliance:
        """Inverse of the stiffness; zero for a mean displacement that nothing restores, or that is rigid."""
        determinant = self.k11[1:] * self.k33[1:] - self.k13[1:] ** 2
        s11, s13, s33 = np.zeros((3, len(self.k11)))
        s11[1:], s13[1:], s33[1:] = self.k33[1:] / determinant, self.k13[1:] / determinant, self.k11[1:] / determinant
        for s, k in ((s11, self.k11), (s33, self.k33)):
            s[0] = 1.0 / k[0] if k[0] > 0.0 else 0.0
        return Compliance(s11, s13, s33)

    def inverse(self) -> tuple[Reals, Reals, Reals]:
        """The same elements of the compliance; zero for a mean displacement that nothing restores, or that is rigid."""
        return self.compliance().elements

    def deflection(self, tangential: Reals, normal: Reals) -> tuple[Reals, Reals]:
        """Displacements `[nx]` (tangential, normal) under tractions `[nx]` in E*; 0 in a mean that nothing restores."""
        t1, t3 = grid.coefficients(tangential), grid.coefficients(normal)
        k11, k13, k33 = self.k11[1:], self.k13[1:], self.k33[1:]
        determinant = k11 * k33 - k13**2
        u1, u3 = np.zeros_like(t1), np.zeros_like(t3)
        u1[1:] = (k33 * t1[1:] - 1j * k13 * t3[1:]) / determinant
        u3[1:] = (k11 * t3[1:] + 1j * k13 * t1[1:]) / determinant
        for u, t, k in ((u1, t1, self.k11), (u3, t3, self.k33)):
            u[0] = t[0] / k[0] if k[0] > 0.0 else 0.0
        return grid.signal(u1, len(tangential)), grid.signal(u3, len(normal))

    def in_series(self, other: "CoupledStiffness", share: float) -> "CoupledStiffness":
        """Stiffness of two bodies that face each other, for how far they approach and slide past each other.

        Compliances add up wave by wave, but S13 subtracts: one pressure moves both surfaces along x the same way. What
        is left on half-spaces is 2 beta/q with Dundurs' beta. Each body is given in its own E*, the result is in that
        of both together; `share` is the other's part of 1/E*.
        """
        own, facing = self.compliance(), other.compliance()
        s11 = (1.0 - share) * own.s11 + share * facing.s11
        s13 = (1.0 - share) * own.s13 - share * facing.s13
        s33 = (1.0 - share) * own.s33 + share * facing.s33
        k11, k13, k33 = np.zeros((3, len(s11)))
        determinant = s11[1:] * s33[1:] - s13[1:] ** 2
        k11[1:], k13[1:], k33[1:] = s33[1:] / determinant, s13[1:] / determinant, s11[1:] / determinant
        k11[0] = in_series(self.k11[:1], other.k11[:1], share)[0]
        k33[0] = in_series(self.k33[:1], other.k33[:1], share)[0]
        return CoupledStiffness(k11, k13, k33)

    def coarsened(self, nx: int) -> "CoupledStiffness":
        """Return the stiffness of the waves that a coarser grid of nx nodes holds."""
        return self.on_grid(nx, *(k[: nx // 2 + 1].copy() for k in self.elements))

    def with_free_mean(self) -> "CoupledStiffness":
        """The same without the restoring force of the mean normal displacement, which then follows the load."""
        return replace(self, k33=np.concatenate(([0.0], self.k33[1:])))

    def principal(self) -> tuple[Reals, Reals]:
        """Smaller and larger stiffness of the two decoupled modes of each wave number (6.84)."""
        mean, half = 0.5 * (self.k11 + self.k33), 0.5 * (self.k11 - self.k33)
        larger = mean + np.hypot(half, self.k13)
        smaller = np.divide(self.k11 * self.k33 - self.k13**2, larger, out=np.zeros_like(larger), where=larger > 0.0)
        return smaller, larger
