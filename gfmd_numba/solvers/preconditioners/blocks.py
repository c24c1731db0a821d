"""What the pressures of blocks of nodes do to each other through the waves that a grid of blocks holds."""

import math

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.transform import Transform

_FEWEST = 256  # nodes of the map in each direction: on smaller ones blocks save less than they cost
_TOLERANCE, _ITERATIONS = 1e-2, 50  # of the coarse problem: ten times that shows in the conjugate gradients
_ONE = np.zeros(1, dtype=np.int64)


class Blocks:
    """Compliance S between blocks of a map: the sum of pressures is all that is far away felt of a block.

    `stiffness` is `[ny, nx // 2 + 1]` of a map of the shape `nodes`, at q = 0 zero or infinite if it does not count;
    `side` the number of nodes along each side of a block, `shape` that of the grid of blocks.
    """

    def __init__(self, stiffness: Reals, nodes: tuple[int, ...], side: int) -> None:
        self.shape = tuple(-(-n // side) for n in nodes)
        self.useful = min(nodes) >= _FEWEST
        if not self.useful:
            return
        self._nodes = math.prod(nodes)
        self._field = Transform(1, *self.shape)
        coarse = stiffness[grid.wave_indices(self.shape)]
        with np.errstate(divide="ignore"):
            compliance = np.where(coarse > 0.0, 1.0 / coarse, 0.0) * self._field.n / self._nodes
        self._compliance = self._field.symbol(compliance)

    @property
    def made(self) -> int:
        """Transforms made so far."""
        return int(self._field.n_transforms[0]) if self.useful else 0

    @property
    def transforms(self) -> float:
        """Transforms made so far, in proportion to the cost of one of the map."""
        if not self.useful:
            return 0.0
        return self.made * grid.relative_cost(self._field.n, self._nodes)

    def shared(self, load: Reals, stiff: Reals) -> Reals:
        """Displacement y of blocks with S^-1 y + stiff y = load, by conjugate gradients preconditioned by S.

        S^-1 of a direction is the sum that the direction is of the residuals, so it is never applied.
        """
        y, r = np.zeros_like(load), load
        z = self._soft(r)
        energy = first = float((r * z).sum())
        direction, unsmoothed = z, r
        for _ in range(_ITERATIONS):
            if energy <= _TOLERANCE**2 * first:
                break
            reaction = unsmoothed + stiff * direction
            step = energy / float((direction * reaction).sum())
            y, r = y + step * direction, r - step * reaction
            z, last = self._soft(r), energy
            energy = float((r * z).sum())
            direction, unsmoothed = z + energy / last * direction, r + energy / last * unsmoothed
        return y

    def _soft(self, load: Reals) -> Reals:
        field = self._field
        field.sources[0][0, : field.n] = load.ravel()
        field.apply(self._compliance, _ONE, source=0)
        return field.result[0, : field.n].reshape(self.shape).copy()
