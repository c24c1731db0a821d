"""Compiled least squares whose last digits depend on nothing but the numbers given."""

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.kernels.compilation import jit


@jit
def least_squares(matrix: Reals, right: Reals, solution: Reals) -> None:
    """Solve `matrix` `[row, column]` times the solution = `right` by Householder's reflections, in place.

    Libraries take the order of sums from where arrays lie in memory.
    """
    rows, columns = matrix.shape
    for k in range(columns):
        norm = 0.0
        for i in range(k, rows):
            norm += matrix[i, k] ** 2
        norm = np.sqrt(norm)
        if matrix[k, k] > 0.0:
            norm = -norm
        matrix[k, k] -= norm  # the column becomes the reflector
        square = -norm * matrix[k, k]
        for c in range(k + 1, columns):
            along = 0.0
            for i in range(k, rows):
                along += matrix[i, k] * matrix[i, c]
            along /= square
            for i in range(k, rows):
                matrix[i, c] -= along * matrix[i, k]
        along = 0.0
        for i in range(k, rows):
            along += matrix[i, k] * right[i]
        along /= square
        for i in range(k, rows):
            right[i] -= along * matrix[i, k]
        matrix[k, k] = norm
    for k in range(columns - 1, -1, -1):
        value = right[k]
        for c in range(k + 1, columns):
            value -= matrix[k, c] * solution[c]
        solution[k] = value / matrix[k, k]
