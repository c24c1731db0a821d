"""Array types of the kernels, and how they are compiled.

Kernels work in place on batches `[realisation, x]`, on the rows listed in `active`. Rows may be longer than the `n`
samples they hold (padding keeps each row aligned for the transforms).
"""

from typing import Any

import numpy as np
import numpy.typing as npt
from numba import njit

Reals = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
Rows = npt.NDArray[np.int64]
jit: Any = njit(cache=True, error_model="numpy")
