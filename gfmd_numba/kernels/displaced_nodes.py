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
def read(splines: Reals, ways: Reals, found: Reals) -> None:
    """Values `[y, x]` of splines, known by their coefficients, at the displaced nodes."""
    ny, nx = found.shape
    along_x, along_y = np.empty(6), np.empty(6)
    for j in range(ny):
        for i in range(nx):
            x, y = np.floor(ways[0, j, i]), np.floor(ways[1, j, i])
            weigh(ways[0, j, i] - x, along_x)
            weigh(ways[1, j, i] - y, along_y)
            value = 0.0
            for b in range(6):
                row = (j + int(y) + b - 2) % ny
                of_row = 0.0
                for a in range(6):
                    of_row += along_x[a] * splines[row, (i + int(x) + a - 2) % nx]
                value += along_y[b] * of_row
            found[j, i] = value


@jit
def hand_back(forces: Reals, ways: Reals, found: Reals) -> None:
    """Add to the coefficients `[y, x]` of splines what forces on the displaced nodes are to them."""
    ny, nx = found.shape
    along_x, along_y = np.empty(6), np.empty(6)
    for j in range(ny):
        for i in range(nx):
            x, y = np.floor(ways[0, j, i]), np.floor(ways[1, j, i])
            weigh(ways[0, j, i] - x, along_x)
            weigh(ways[1, j, i] - y, along_y)
            for b in range(6):
                row = (j + int(y) + b - 2) % ny
                share = along_y[b] * forces[j, i]
                for a in range(6):
                    found[row, (i + int(x) + a - 2) % nx] += along_x[a] * share
