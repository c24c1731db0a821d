"""Slopes of cubic splines through heights at equal distances."""

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.kernels.compilation import jit


@jit
def spline_slopes(heights: Reals, slopes: Reals) -> None:
    """Slopes `[node, row]` per node of cubic splines through heights, the third derivative continuous next to the ends.

    Between the ends s_(i-1) + 4 s_i + s_(i+1) = 3 (h_(i+1) - h_(i-1)), and s_0 + 2 s_1 = (h_2 + 4 h_1 - 5 h_0) / 2.
    """
    n, rows = heights.shape
    above = np.empty(n)  # of what elimination leaves above the diagonal
    above[0] = 2.0
    for j in range(rows):
        slopes[0, j] = 0.5 * (heights[2, j] + 4.0 * heights[1, j] - 5.0 * heights[0, j])
    for i in range(1, n - 1):
        above[i] = 1.0 / (4.0 - above[i - 1])
        for j in range(rows):
            slopes[i, j] = (3.0 * (heights[i + 1, j] - heights[i - 1, j]) - slopes[i - 1, j]) * above[i]
    last = 1.0 / (1.0 - 2.0 * above[n - 2])
    for j in range(rows):
        end = 0.5 * (5.0 * heights[n - 1, j] - 4.0 * heights[n - 2, j] - heights[n - 3, j])
        slopes[n - 1, j] = (end - 2.0 * slopes[n - 2, j]) * last
    for i in range(n - 2, -1, -1):
        for j in range(rows):
            slopes[i, j] -= above[i] * slopes[i + 1, j]
