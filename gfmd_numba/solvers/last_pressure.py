"""The pressure before the present one, to which a step that increases the energy goes back."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels

Reals = npt.NDArray[np.float64]


class LastPressure:
    """Pressures between two bounds and their gaps `[realisation, x]`, up to the approach, as they last were."""

    def __init__(self, pressure: Reals) -> None:
        self._pressure, self._gap = np.zeros((2, *pressure.shape), dtype=pressure.dtype)
        self._known = np.zeros(len(pressure), dtype=np.bool_)

    def damp(self, i: int, pressure: Reals, gap: Reals, n: int) -> bool:
        """Go back to the least energy on the way from the last pressure of row i, if it has increased; whether."""
        if not self._known[i]:
            self._pressure[i], self._gap[i], self._known[i] = pressure, gap, True
            return False
        return bool(kernels.damp(pressure, gap, self._pressure[i], self._gap[i], n))
