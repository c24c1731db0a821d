"""Compiled loops over spectra: the stiffness of one displacement or of all."""

import numpy as np

from gfmd_numba.arrays import Complexes, Indices, Reals
from gfmd_numba.kernels.compilation import jit


@jit
def multiply(spectrum: Complexes, symbol: Reals | Complexes, active: Indices) -> None:
    """Multiply each active spectrum by a symbol of the wave number."""
    for i in active:
        for k in range(symbol.size):
            spectrum[i, k] *= symbol[k]


@jit
def count(numbers: Indices, active: Indices, more: int) -> None:
    """Raise the numbers of the active rows; NumPy takes a tenth of a short transform for that."""
    for i in active:
        numbers[i] += more


@jit
def power(spectrum: Complexes, symbol: Reals) -> float:
    """Sum of the squares of a spectrum times a real symbol, without that of the mean."""
    total = 0.0
    for k in range(1, symbol.size):
        wave = spectrum[k] * symbol[k]
        total += wave.real**2 + wave.imag**2
    return total


@jit
def couple(spectrum: Complexes, elements: Reals, active: Indices) -> None:
    """Restoring tractions of all displacements `[realisation, component, wave]` in place (6.57), the normal one last.

    `elements` `[element, wave]` are k11, k13 and k33, or on maps, with components along x and y, xx, xy, yy, xz, yz and
    zz. The phase is that of coefficients of exp(+i q x) with the normal displacement out of the body: a compressed
    stretch draws the surface together.
    """
    for i in active:
        for k in range(elements.shape[1]):
            x, z = spectrum[i, 0, k], spectrum[i, -1, k]
            if elements.shape[0] == 3:
                spectrum[i, 0, k] = elements[0, k] * x + 1j * elements[1, k] * z
                spectrum[i, 1, k] = elements[2, k] * z - 1j * elements[1, k] * x
            else:
                y, xz, yz = spectrum[i, 1, k], elements[3, k], elements[4, k]
                spectrum[i, 0, k] = elements[0, k] * x + elements[1, k] * y + 1j * xz * z
                spectrum[i, 1, k] = elements[1, k] * x + elements[2, k] * y + 1j * yz * z
                spectrum[i, 2, k] = elements[5, k] * z - 1j * (xz * x + yz * y)


@jit
def multiply_map(spectrum: Complexes, symbol: Reals, n: int, divide: bool) -> None:
    """Multiply the transform of a map by a real symbol, or divide it; and by 1/n. Waves of `factor` 0 vanish."""
    rows, columns = symbol.shape
    for y in range(rows):
        for x in range(columns):
            spectrum[y, x] *= factor(symbol[y, x], n, divide)


@jit
def factor(value: float, n: int, divide: bool) -> float:
    """Value of a symbol over n, or its inverse; 0 for infinity, and for what would be."""
    if divide:
        return 1.0 / (value * n) if value > 0.0 else 0.0
    return value / n if value < np.inf else 0.0


@jit
def take_columns(waves: Complexes, rows: int, first: int, block: Complexes) -> None:
    """Fill the first rows of a block `[x, y]` from columns of a map from `first` on, and the rest with zeros."""
    columns = min(block.shape[0], waves.shape[1] - first)
    for y in range(rows):
        for x in range(columns):
            block[x, y] = waves[y, first + x]
    block[:, rows:] = 0.0
    block[columns:] = 0.0


@jit
def multiply_columns(block: Complexes, symbol: Reals, first: int, n: int, divide: bool) -> None:
    """Multiply the transforms `[x, y]` of columns from `first` on as `multiply_map` does, by a symbol even along y."""
    rows = block.shape[1]
    half = rows // 2 + 1
    columns = min(block.shape[0], symbol.shape[1] - first)
    shares = np.empty((columns, half))
    for y in range(half):  # which are far apart in the memory: no work in between
        for x in range(columns):
            shares[x, y] = symbol[y, first + x]
    for x in range(columns):
        share, column = shares[x], block[x]
        for y in range(half):
            share[y] = factor(share[y], n, divide)
        for y in range(half):
            column[y] *= share[y]
        for y in range(half, rows):
            column[y] *= share[rows - y]


@jit
def put_columns(block: Complexes, first: int, waves: Complexes, rows: int) -> None:
    """Fill columns of a map from `first` on, in its first rows, from a block `[x, y]`."""
    columns = min(block.shape[0], waves.shape[1] - first)
    for y in range(rows):
        for x in range(columns):
            waves[y, first + x] = block[x, y]


@jit
def restoring_power(columns: Complexes, stiffness: Reals, first: int) -> float:
    """Sum of the squares of K times the transform `[x, y]` of a real map, for its columns from the `first` on.

    Each column counts as often as in a sum over all waves; the mean does not count.
    """
    nyquist = stiffness.shape[1] - 1
    total = 0.0
    for c in range(min(columns.shape[0], stiffness.shape[1] - first)):
        x = first + c
        power = 0.0
        for y in range(stiffness.shape[0]):
            if x > 0 or y > 0:
                value = columns[c, y]
                power += (value.real**2 + value.imag**2) * stiffness[y, x] ** 2
        total += power if x == 0 or x == nyquist else 2.0 * power
    return total
