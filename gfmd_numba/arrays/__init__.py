"""Array types: what the elements of an array are; docstrings say its shape, as in `[realisation, (y,) x]`."""

from typing import TypeVar

import numpy as np
import numpy.typing as npt

Reals = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
Flags = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.int64]
Numbers = TypeVar("Numbers", Reals, Complexes)
