"""Stiffness of all three displacements of a map, wave by wave.

A wave of wave vector q = |q| (c, s) splits in two. Along q and out of the surface it is the wave of a profile, with
K11, K13 and K33 of (6.57). Across q it is one of shear alone, which nothing couples to, of stiffness K22, G |q| for a
half-space. In the axes x, y of the map, with z out of the surface, the stiffness is the Hermitian matrix

    [[xx, xy, i xz], [xy, yy, i yz], [-i xz, -i yz, zz]],    xx = K11 c^2 + K22 s^2,    xy = (K11 - K22) c s,
    yy = K11 s^2 + K22 c^2,    xz = K13 c,    yz = K13 s,    zz = K33,

and the compliance, its inverse, is of the same form: the phases drop out, so that real symmetric matrices are inverted.
"""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity.stiffness import in_series
from gfmd_numba.fourier import grid

_X, _Y = [1, 3], [1, 4]  # elements that change sign with q_x, and with q_y


@dataclass(frozen=True)
class MapStiffness:
    """Elements xx, xy, yy, xz, yz and zz `[element, ny, nx // 2 + 1]` of the stiffness of a map, in E*/L_x."""

    elements: Reals

    @classmethod
    def on_grid(cls, shape: tuple[int, ...], k11: Reals, k13: Reals, k33: Reals, k22: Reals) -> "MapStiffness":
        """Stiffness on ny, nx nodes from that of waves along q, and from K22 of those across `[ny, nx // 2 + 1]`.

        At Nyquist the grid does not tell the waves q_x and -q_x (or q_y and -q_y): what both give way is averaged, as
        if all that vanishes on every node were free.
        """
        qy, qx = grid.wavevectors(shape, (1.0, 1.0))
        q = np.hypot(qy, qx)
        q[0, 0] = 1.0
        c, s = qx / q, qy / q
        c[0, 0] = 1.0  # the uniform displacements, one as stiff as the other
        elements = np.array(
            [k11 * c**2 + k22 * s**2, (k11 - k22) * c * s, k11 * s**2 + k22 * c**2, k13 * c, k13 * s, k33]
        )
        for of_axis, nodes, odd in ((elements.swapaxes(1, 2), shape[1], _X), (elements, shape[0], _Y)):
            if nodes % 2 == 0:
                compliance = _inverse(of_axis[:, nodes // 2])
                compliance[odd] = 0.0
                of_axis[:, nodes // 2] = _inverse(compliance)
        return cls(elements)

    @property
    def k11(self) -> Reals:
        """Stiffness of either tangential displacement alone `[component, ny, nx // 2 + 1]`."""
        return self.elements[[0, 2]]

    @property
    def k33(self) -> Reals:
        """Stiffness of the normal displacement alone `[ny, nx // 2 + 1]`."""
        return np.asarray(self.elements[5])

    def condensed(self) -> Reals:
        """Stiffness of the normal displacement where no tangential traction acts (Schur complement, 6.75)."""
        xx, xy, yy, xz, yz, zz = self.elements
        plane = xx * yy - xy**2
        softer = xz**2 * yy - 2.0 * xy * xz * yz + yz**2 * xx
        return np.asarray(zz - np.divide(softer, plane, out=np.zeros_like(plane), where=softer != 0.0))

    def inverse(self) -> Reals:
        """Elements of the inverse, in the same order; zero for a mean displacement that nothing restores, or rigid."""
        found = self.elements.copy()
        found[:, 0, 0] = 1.0, 0.0, 1.0, 0.0, 0.0, 1.0
        found = _inverse(found)
        for element in (0, 2, 5):
            k = self.elements[element, 0, 0]
            found[element, 0, 0] = 1.0 / k if k > 0.0 else 0.0
        return found

    def deflection(self, tangential: Reals, normal: Reals) -> tuple[Reals, Reals]:
        """Displacements `[2, ny, nx]` and `[ny, nx]` under tractions in E*; 0 in a mean that nothing restores."""
        x, y = grid.coefficients(tangential, 2)
        z = grid.coefficients(normal, 2)
        xx, xy, yy, xz, yz, zz = self.inverse()
        along = np.stack((xx * x + xy * y + 1j * xz * z, xy * x + yy * y + 1j * yz * z))
        out = zz * z - 1j * (xz * x + yz * y)
        return grid.signal(along, *normal.shape), grid.signal(out, *normal.shape)

    def in_series(self, other: "MapStiffness", share: float) -> "MapStiffness":
        """Stiffness of two bodies that face each other, for how far they approach and slide past each other.

        As for profiles (`CoupledStiffness.in_series`) compliances add up, and their couplings xz and yz subtract. Each
        body is given in its own E*, the result is in that of both; `share` is the other's part of 1/E*.
        """
        facing = other.inverse()
        facing[[3, 4]] *= -1.0
        compliance = (1.0 - share) * self.inverse() + share * facing
        compliance[:, 0, 0] = 1.0, 0.0, 1.0, 0.0, 0.0, 1.0
        found = _inverse(compliance)
        found[:, 0, 0] = 0.0
        for element in (0, 2, 5):
            mean = in_series(self.elements[element, 0, :1], other.elements[element, 0, :1], share)
            found[element, 0, 0] = mean[0]
        return MapStiffness(found)

    def with_free_mean(self) -> "MapStiffness":
        """The same without the restoring force of the mean normal displacement, which then follows the load."""
        elements = self.elements.copy()
        elements[5, 0, 0] = 0.0
        return MapStiffness(elements)

    def principal(self) -> tuple[Reals, Reals]:
        """Smallest and largest stiffness of the three decoupled modes of each wave vector `[ny, nx // 2 + 1]`."""
        xx, xy, yy, xz, yz, zz = self.elements
        found = np.linalg.eigvalsh(np.moveaxis(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), (0, 1), (-2, -1)))
        return found[..., 0], found[..., 2]


def _inverse(elements: Reals) -> Reals:
    """Inverses of real symmetric matrices `[element, ...]`, by their adjugates."""
    xx, xy, yy, xz, yz, zz = elements
    adjugate = np.array(
        [
            yy * zz - yz**2,
            xz * yz - xy * zz,
            xx * zz - xz**2,
            xy * yz - xz * yy,
            xy * xz - xx * yz,
            xx * yy - xy**2,
        ]
    )
    return np.asarray(adjugate / (xx * adjugate[0] + xy * adjugate[1] + xz * adjugate[3]))
