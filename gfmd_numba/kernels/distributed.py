"""Compiled loop over the nodes in contact of a slab."""

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit


@jit
def near_tractions(stencil: Reals, displacement: Reals, nodes: Indices, tractions: Reals) -> None:
    """Tractions on the nodes of a slab of the neighbours that a stencil `[y, x]` holds, alone.

    The displacement `[row, x]` has as many more rows before and after those of the slab as the stencil reaches.
    """
    reach = stencil.shape[0] // 2
    nx = displacement.shape[1]
    for k in range(nodes.size):
        y, x = nodes[k] // nx, nodes[k] % nx
        total = 0.0
        for dy in range(2 * reach + 1):
            for dx in range(2 * reach + 1):
                total += stencil[dy, dx] * displacement[y + dy, (x + dx - reach) % nx]
        tractions[k] = total
