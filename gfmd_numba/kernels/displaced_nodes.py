"""Compiled parts of fields at displaced nodes: quintic splines between the nodes of periodic maps `[y, x]`.

`ways` `[component, y, x]` are along x, then along y, in spacings.
"""

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.kernels.compilation import jit


@jit
def weigh(t: float, weights: Reals) -> None:
    """Weights `[6]` of the basic splines around a cell, from its second last node on, at the part t of it."""
    s = 1.0 - t
    weights[0] = s**5 / 120.0
    weights[1] = ((1.0 + s) ** 5 - 6.0 * s**5) / 120.0
    weights[2] = ((2.0 + s) ** 5 - 6.0 * (1.0 + s) ** 5 + 15.0 * s**5) / 120.0
    weights[3] = ((2.0 + t) ** 5 - 6.0 * (1.0 + t) ** 5 + 15.0 * t**5) / 120.0
    weights[4] = ((1.0 + t) ** 5 - 6.0 * t**5) / 120.0
    weights[5] = t**5 / 120.0


@jit
def weigh_around(ways: Reals, j: int, i: int, along_y: Reals, along_x: Reals) -> tuple[int, int]:
    """Fill the weights `[6]` along both directions around a displaced node; the first node of each."""
    x, y = np.floor(ways[0, j, i]), np.floor(ways[1, j, i])
    weigh(ways[0, j, i] - x, along_x)
    weigh(ways[1, j, i] - y, along_y)
    return j + int(y) - 2, i + int(x) - 2


@jit
def read(splines: Reals, ways: Reals, found: Reals) -> None:
    """Values `[y, x]` of splines, known by their coefficients, at the displaced nodes."""
    ny, nx = found.shape
    along_x, along_y = np.empty(6), np.empty(6)
    for j in range(ny):
        for i in range(nx):
            y, x = weigh_around(ways, j, i, along_y, along_x)
            value = 0.0
            for b in range(6):
                row = (y + b) % ny
                of_row = 0.0
                for a in range(6):
                    of_row += along_x[a] * splines[row, (x + a) % nx]
                value += along_y[b] * of_row
            found[j, i] = value


@jit
def hand_back(forces: Reals, ways: Reals, found: Reals) -> None:
    """Add forces on the displaced nodes to the coefficients `[y, x]` of splines: the transpose of `read`."""
    ny, nx = found.shape
    along_x, along_y = np.empty(6), np.empty(6)
    for j in range(ny):
        for i in range(nx):
            y, x = weigh_around(ways, j, i, along_y, along_x)
            for b in range(6):
                row = (y + b) % ny
                share = along_y[b] * forces[j, i]
                for a in range(6):
                    found[row, (x + a) % nx] += along_x[a] * share
