"""The spectrum of self-affine surfaces in closed form, beside which measured and drawn ones are laid."""

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

_SPHERE = {1: 2.0, 2: 2.0 * np.pi}  # surface of the unit sphere in d dimensions


@dataclass(frozen=True)
class SelfAffineSpectrum:
    """Power law q^-(d + 2H) between the cut-on and roll-off wavelengths, then a plateau or nothing (thesis 3.5.2.1).

    Lengths in the unit of the period; the plateau ends at `longest`.
    """

    isotropic: ClassVar[Literal[True]] = True
    dimension: int
    hurst: float
    cut_on: float
    roll_off: float
    longest: float

    @property
    def _wavenumbers(self):
        return (2.0 * np.pi / length for length in (self.longest, self.roll_off, self.cut_on))

    def psd(self, q):
        """Spectral density `[...]` at wave numbers q (3.8, 3.28)."""
        longest, roll_off, cut_on = self._wavenumbers
        inside = (q >= longest * (1.0 - 1e-12)) & (q <= cut_on * (1.0 + 1e-12))
        law = np.maximum(q, roll_off) ** -(self.dimension + 2.0 * self.hurst)
        return np.where(inside, law, 0.0) / self._moment(0)

    def moment(self, order):
        """Integral of q^n C over all of q-space, in length^-n."""
        return self._moment(order) / self._moment(0)

    def _moment(self, order):
        longest, roll_off, cut_on = self._wavenumbers
        d, rise = self.dimension, order - 2.0 * self.hurst
        plateau = roll_off ** -(d + 2.0 * self.hurst) * (roll_off ** (d + order) - longest ** (d + order)) / (d + order)
        law = np.log(cut_on / roll_off) if rise == 0.0 else (cut_on**rise - roll_off**rise) / rise
        return float(_SPHERE[d] * (plateau + law))
