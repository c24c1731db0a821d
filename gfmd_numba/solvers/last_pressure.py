"""The pressure before the present one, to which a step that increases the energy goes back."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals

UPHILL_FROM_THE_START = 2  # of what `kernels.damp` returns


class LastPressure:
    """Pressures between two bounds and their gaps `[realisation, x]`, up to the approach, as they last were."""

    def __init__(self, pressure: Reals) -> None:
        self.pressure, self.gap = np.zeros((2, *pressure.shape), dtype=pressure.dtype)
        self._known = np.zeros(len(pressure), dtype=np.bool_)

    def damp(self, i: int, pressure: Reals, gap: Reals, n: int) -> int:
        """What `kernels.damp` does and returns for row i; 0 for its first pressure."""
        if self._known[i]:
            return int(kernels.damp(pressure, gap, self.pressure[i], self.gap[i], n))
        self.remember(i, pressure, gap)
        return 0

    def remember(self, i: int, pressure: Reals, gap: Reals) -> None:
        """Make a pressure the last one of row i."""
        self.pressure[i], self.gap[i], self._known[i] = pressure, gap, True
