"""Strains in a half-space whose sublayers have eigenstrains that keep the volume, under a pressure on its surface.

An eigenstrain is given at the nodes of a map (a profile is a map of one row), and is constant over the thickness of
each sublayer. The strains are means over each sublayer. So the eigenstrains do work on just these strains, and the
operator from eigenstrains to strains is symmetric and positive. It is exact for each wave but the Nyquist wave, which
is left out. Components are xx, zz, xz and on maps xy and yz of deviatoric tensors, with yy = -xx - zz. Lengths are in
L_x, strains and stresses over E* in one unit.
"""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import moduli
from gfmd_numba.fourier import grid


class Sublayers:
    """A half-space with sublayers of a `thickness` `[sublayer]` below a map of a shape (ny, nx)."""

    def __init__(self, shape: tuple[int, int], thickness: Reals, poissons_ratio: float) -> None:
        self.shape, self.components = shape, 3 if shape[0] == 1 else 5
        self.shear = float(moduli.c44(poissons_ratio))
        q_y, q_x = grid.wavevectors(shape, (1.0, 1.0))
        q = grid.magnitudes(shape)
        angle = np.arctan2(q_y, q_x + 0.0 * q_y).ravel()
        for axis, n in zip((1, 0), shape[::-1], strict=True):
            if n % 2 == 0:
                np.moveaxis(q, axis, 0)[n // 2] = -1.0
        self.waves = kernels.Waves.of(q.ravel(), np.cos(angle), np.sin(angle), thickness, poissons_ratio, self.shear)
        self._spectrum = self._found = np.zeros((self.components, thickness.size, q.size), dtype=np.complex128)
        self._surface = np.zeros((3, q.size), dtype=np.complex128)

    def surface_displacement(self, eigenstrain: Reals) -> Reals:
        """Displacement of the free surface out of the body `[y, x]` by an eigenstrain `[component, sublayer, y, x]`.

        Its mean is 0. The eigenstrain is kept for a call of `strains`.
        """
        some = eigenstrain.any(axis=(0, 2, 3))
        waves = self.shape[0], self.shape[1] // 2 + 1
        spectrum = np.zeros((self.components, some.size, *waves), dtype=np.complex128)
        spectrum[:, some] = grid.coefficients(2.0 * self.shear * eigenstrain[:, some], 2)
        self._spectrum = spectrum.reshape(*spectrum.shape[:2], -1)
        self._found, out = np.empty_like(self._spectrum), np.empty(self.waves.q.size, dtype=np.complex128)
        kernels.waves_upwards(self._spectrum, self.waves, self._found, self._surface)
        kernels.reflect(self._surface, self.waves, out)
        return grid.signal(out.reshape(waves), *self.shape)

    def strains(self, pressure: Reals, with_normal: bool = False) -> Reals:
        """Deviatoric strains `[component, sublayer, y, x]` under a pressure `[y, x]` by the last eigenstrain.

        If `with_normal`, the last component is the normal stress zz. Call `surface_displacement` again before a second
        call.
        """
        spectrum = grid.coefficients(pressure, 2)
        if with_normal:
            self._found = np.concatenate((self._found, np.empty_like(self._found[:1])))
        kernels.strains(self._spectrum, spectrum.ravel(), self.waves, self._found, self._surface)
        return grid.signal(self._found.reshape(*self._found.shape[:2], *spectrum.shape), *self.shape)
