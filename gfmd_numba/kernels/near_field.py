"""Compiled product of a short stencil with values on some nodes of a map."""

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.kernels.compilation import jit


@jit
def near_field_pressure(u: Reals, nodes: Indices, count: int, stencil: Reals, scratch: Reals, p: Reals) -> None:
    """Pressure p on the nodes from the displacement u there by the `[2 m + 1, 2 m + 1]` stencil of a stiffness.

    `scratch` is a map of zeros, and is left so.
    """
    ny, nx = scratch.shape
    reach = stencil.shape[0] // 2
    for k in range(count):
        scratch[nodes[k] // nx, nodes[k] % nx] = u[k]
    for k in range(count):
        y, x = nodes[k] // nx, nodes[k] % nx
        total = 0.0
        for j in range(-reach, reach + 1):
            row = y + j  # wrapped by hand: divisions would take most of the time
            row += ny if row < 0 else (-ny if row >= ny else 0)
            for i in range(-reach, reach + 1):
                column = x + i
                column += nx if column < 0 else (-nx if column >= nx else 0)
                total += stencil[reach + j, reach + i] * scratch[row, column]
        p[k] = total
    for k in range(count):
        scratch[nodes[k] // nx, nodes[k] % nx] = 0.0
