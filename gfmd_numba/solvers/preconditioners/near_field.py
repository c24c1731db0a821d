"""The stiffness between near neighbours of a map, close to the inverse of the compliance on any set of nodes."""

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier import grid

_REACH = 1  # nodes in each direction: more saves a transform in twenty, and costs more than that

_SAMPLES = 64  # nodes in each direction, of a grid on which the stiffness between neighbours is what it is


class NearField:
    """Preconditioner of the compliance on some nodes: the stiffness between those that are near neighbours.

    In two dimensions stiffness decays with the cube of the distance, so that the rest is small. `stiffness` is
    `[ny, nx // 2 + 1]`; at q = 0 zero or infinite if it does not count.
    """

    transforms = 0.0  # it takes none
    takes_own = False  # compliances that nodes have in addition

    def __init__(self, stiffness: Reals, shape: tuple[int, ...]) -> None:
        self._stencil = near_stencil(stiffness, shape)
        self._shape = shape
        self._map = np.zeros(shape)
        self._nodes, self._count = np.empty(0, dtype=np.int64), 0

    def factor(self, nodes: Indices, count: int, own: Reals | None = None) -> None:
        """Prepare `solve` for the first `count` of the nodes; compliances of their `own` do not count."""
        self._nodes, self._count = nodes, count

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes that about causes the displacement there."""
        kernels.near_field_pressure(displacement, self._nodes, self._count, self._stencil, self._map, pressure)


def near_stencil(stiffness: Reals, shape: tuple[int, ...]) -> Reals:
    """Stiffness between near neighbours `[2 m + 1, 2 m + 1]`, positive definite on any nodes."""
    few = tuple(min(n, _SAMPLES) for n in shape)
    symbol = stiffness[grid.some_waves(shape, few)]
    if not 0.0 < symbol[0, 0] < np.inf:
        symbol[0, 0] = stiffness[0, 1]
    near = np.roll(grid.influence(symbol, *few), (_REACH, _REACH), axis=(0, 1))
    stencil = near[: 2 * _REACH + 1, : 2 * _REACH + 1]
    others = stencil.copy()
    others[_REACH, _REACH] = 0.0
    # otherwise it may not be positive definite, nor stiffer than its own sum of rows: the node alone is
    if np.abs(others).sum() >= stencil[_REACH, _REACH] or others.max() > 0.0:
        stencil = stencil[_REACH:-_REACH, _REACH:-_REACH]
    return np.ascontiguousarray(stencil)
