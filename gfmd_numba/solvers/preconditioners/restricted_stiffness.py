"""The stiffness itself between the nodes in contact, as if the others were held: close to the inverse compliance."""

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.fourier.transform import Transform

_ONE = np.zeros(1, dtype=np.int64)


class RestrictedStiffness:
    """Preconditioner of the compliance on some nodes: the stiffness of all, applied to these and read there.

    It is positive definite whatever the stiffness does over q, exact in full contact, and costs two transforms.
    `stiffness` is `[n // 2 + 1]`; at q = 0 zero or infinite if it does not count.
    """

    def __init__(self, stiffness: Reals, n: int) -> None:
        symbol = stiffness.astype(np.float64)
        if not 0.0 < symbol[0] < np.inf:
            symbol[0] = symbol[1]
        self._field = Transform(1, n)
        self._symbol = self._field.symbol(symbol)
        self._nodes, self._count = np.empty(0, dtype=np.int64), 0

    @property
    def transforms(self) -> float:
        """Transforms made so far."""
        return float(self._field.n_transforms[0])

    def factor(self, nodes: Indices, count: int) -> None:
        """Prepare `solve` for the first `count` of the nodes."""
        self._nodes, self._count = nodes, count

    def solve(self, displacement: Reals, pressure: Reals) -> None:
        """Fill the pressure on the nodes that about causes the displacement there."""
        where = self._nodes[: self._count]
        source = self._field.sources[0][0]
        source[:] = 0.0
        source[where] = displacement[: self._count]
        self._field.apply(self._symbol, _ONE)
        pressure[: self._count] = self._field.result[0][where]
