"""Periodic fields at nodes that are displaced between those of their grid, by quintic splines.

Handing forces back to the grid is the adjoint of reading a field there: the work is the same, and so are the forces.
"""

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.fourier import grid
from gfmd_numba.kernels import displaced_nodes

_AT_NODES = (66.0 / 120.0, 26.0 / 120.0, 1.0 / 120.0)  # a basic spline at its own node, the next one and the one after


class DisplacedNodes:
    """Nodes `[(y,) x]` displaced by `way` `[component, (y,) x]`, along x and on maps along y; all periods are 1."""

    def __init__(self, way: Reals) -> None:
        self._shape = way.shape[1:]
        self._ways = np.zeros((2, *(1, *self._shape)[-2:]))  # a profile is a map of one row
        for along, moved, n in zip(self._ways, way, self._shape[::-1], strict=False):
            along[:] = n * moved

    def values(self, field: Reals) -> Reals:
        """Values `[(y,) x]` of a field on the grid at the displaced nodes."""
        found = np.empty(self._ways.shape[1:])
        displaced_nodes.read(_filtered(field).reshape(found.shape), self._ways, found)
        return found.reshape(self._shape)

    def handed_back(self, forces: Reals) -> Reals:
        """Forces `[(y,) x]` on the grid that do the work of those on the displaced nodes."""
        found = np.zeros(self._ways.shape[1:])
        displaced_nodes.hand_back(np.reshape(forces, found.shape), self._ways, found)
        return _filtered(found.reshape(self._shape))


def _filtered(field: Reals) -> Reals:
    """Field divided by what the splines make of each wave on the nodes; the filter is its own adjoint."""
    spectrum = grid.coefficients(field, field.ndim)
    for wave, n in zip(grid.wave_indices(field.shape), field.shape, strict=True):
        phase = 2.0 * np.pi * wave / n
        own, first, second = _AT_NODES
        spectrum /= own + 2.0 * first * np.cos(phase) + 2.0 * second * np.cos(2.0 * phase)
    return grid.signal(spectrum, *field.shape)
