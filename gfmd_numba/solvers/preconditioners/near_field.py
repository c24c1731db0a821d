"""The stiffness between near neighbours of a map, close to the inverse of the compliance on any set of nodes."""

import numpy as np
import numpy.typing as npt

from gfmd_numba import kernels
from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid

Rows = npt.NDArray[np.int64]

_REACH = 1  # nodes in each direction: more saves a transform in twenty, and costs more than that


class NearField:
    """Preconditioner of the compliance on some nodes: the stiffness between those that are near neighbours.

    In two dimensions stiffness decays with the cube of the distance, so that the rest is small. `stiffness` is
    `[ny, nx // 2 + 1]`; at q = 0 zero or infinite if it does not count.
    """

    def __init__(self, stiffness: Reals, shape: tuple[int, ...]) -> None:
        symbol = stiffness.copy()
        if not 0.0 < symbol[0, 0] < np.inf:
            symbol[0, 0] = symbol[0, 1]
        near = np.roll(grid.influence(symbol, *shape), (_REACH, _REACH), axis=(0, 1))
        self._stencil = np.ascontiguousarray(near[: 2 * _REACH + 1, : 2 * _REACH + 1])
        around = np.abs(self._stencil).sum() - self._stencil[_REACH, _REACH]
        beside = self._stencil.copy()
        beside[_REACH, _REACH] = 0.0
        # otherwise it may not be positive definite, nor stiffer than its own sum of rows: the node alone is
        if around >= self._stencil[_REACH, _REACH] or beside.max() > 0.0:
            self._stencil = np.ascontiguousarray(self._stencil[_REACH:-_REACH, _REACH:-_REACH])
        self._shape = shape
        self._map = np.zeros(shape)
        self._nodes, self._count = np.empty(0, dtype=np.int64), 0

    def factor(self, nodes: Rows, count: int) -> None:
        """Prepare `solve` for the first `count` of the nodes."""
        self._nodes, self._count = nodes, count

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes that about causes the displacement there."""
        kernels.near_field_pressure(displacement, self._nodes, self._count, self._stencil, self._map, pressure)
