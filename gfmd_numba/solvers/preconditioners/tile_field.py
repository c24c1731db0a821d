"""The preconditioner of `far_field.py` on tiles of a map, four to a block."""

import math

import numpy as np

from gfmd_numba import kernels
from gfmd_numba.arrays import Flags, Indices, Reals
from gfmd_numba.kernels.tiles import TILE
from gfmd_numba.solvers.preconditioners.blocks import Blocks
from gfmd_numba.solvers.preconditioners.near_field import near_stencil

_SIDE = (
    16  # nodes along each side of a block, two tiles: larger blocks cost iterations, smaller ones more than they save
)


class TileField:
    """Preconditioner of the compliance on the nodes in contact of some tiles: near neighbours and blocks.

    Values on m tiles are `[m + 1, TILE, TILE]`. `stiffness` is `[ny, nx // 2 + 1]`; at q = 0 zero or infinite if it
    does not count.
    """

    def __init__(self, stiffness: Reals, shape: tuple[int, ...]) -> None:
        self._stencil, self._blocks = near_stencil(stiffness, shape), Blocks(stiffness, shape, _SIDE)
        self.stiffest = float(self._stencil.max())  # of a node between its neighbours
        self._across = shape[1] // TILE
        self._tiles = self._around = np.empty(0, dtype=np.int64)
        self._contact = np.empty(0, dtype=np.bool_)
        self._isolated, self._sums, self._stiff = np.empty(0), np.empty(0), np.empty(0)

    @property
    def transforms(self) -> int:
        """Transforms of blocks made so far."""
        return self._blocks.made

    @property
    def nodes(self) -> int:
        """Number of blocks."""
        return math.prod(self._blocks.shape)

    def place(self, tiles: Indices, around: Indices) -> None:
        """Prepare `factor` for some tiles and the places of those around them."""
        self._tiles, self._around = tiles, around

    def factor(self, contact: Flags) -> None:
        """Prepare `solve` for the nodes in contact."""
        self._contact = contact
        if not self._blocks.useful:
            return
        self._sums, self._stiff = np.zeros((2, *self._blocks.shape))
        self._isolated = np.zeros(contact.shape)
        kernels.tile_stencil(contact.astype(np.float64), self._around, self._stencil, self._isolated)
        kernels.sum_tiles(self._isolated, contact, self._tiles, self._across, self._stiff)

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes in contact that about causes the displacement there; elsewhere it is zero."""
        kernels.tile_stencil(displacement, self._around, self._stencil, pressure)
        if self._blocks.useful:
            kernels.sum_tiles(self._isolated, displacement, self._tiles, self._across, self._sums)
            shared = self._blocks.shared(self._sums, self._stiff)
            kernels.soften_tiles(pressure, self._isolated, shared, self._tiles, self._across, self._contact)
        else:
            pressure *= self._contact
