"""The certificate of a contact: how far displacement and traction are from static equilibrium."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import grid

Reals = npt.NDArray[np.float64]


def pressure_scale(punch: Reals, stiffness: Reals) -> Reals:
    """Root-mean-square pressure fluctuation of full contact `[realisation]`, in E*: the unit of the residual."""
    weight = grid.multiplicity(punch.shape[-1])[1:] * stiffness[1:] ** 2
    return np.asarray(np.sqrt((np.abs(grid.coefficients(punch)[..., 1:]) ** 2 * weight).sum(axis=-1)))
