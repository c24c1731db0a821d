"""Array types of the kernels, and how they are compiled.

Kernels work in place on batches `[realisation, x]`, on the rows listed in `active`. Rows may be longer than the `n`
samples they hold (padding keeps each row aligned for the transforms).
"""

import os
from collections.abc import Callable
from typing import Any

import numba
import numpy as np
import numpy.typing as npt

from gfmd_numba import kernel_cache

Reals = npt.NDArray[np.float64]
Complexes = npt.NDArray[np.complex128]
Flags = npt.NDArray[np.bool_]
Rows = npt.NDArray[np.int64]


_config: Any = numba.config


def jit(function: Callable[..., Any]) -> Any:
    """Compile a kernel on its first call, or find it compiled; NUMBA_CACHE_DIR goes before our own folder."""
    before = _config.CACHE_DIR
    if "NUMBA_CACHE_DIR" not in os.environ:
        _config.CACHE_DIR = str(kernel_cache.folder())
    try:
        return numba.njit(cache=True, error_model="numpy")(function)
    finally:
        _config.CACHE_DIR = before
