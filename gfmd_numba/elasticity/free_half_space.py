"""A half-space without a period: what its surface does under tractions on a window of nodes.

The displacement at a distance r of a line load on a profile is (2/pi E*) ln(R/r) into the body, of a force on a map
1/(pi E* r). Cut off at r = R, these kernels have Fourier transforms in closed form,

    C(q) = 4 Si(q R) / (pi E* q),  C(0) = 4 R / (pi E*)    and    C(q) = (2 / E* q) int_0^(q R) J0(t) dt.

On a grid that is twice as wide as the window, no image of a node is nearer to another node of the window than half its
period. A kernel that is right up to there, on a pressure that is zero beyond the window, gives the displacements in the
window: those of a free half-space, with nothing periodic left. The waves of the kernel end at Nyquist as on a periodic
grid, so that nodes mean the same.

Profiles are cut at the length of the window: R = L_x, where the displacement is zero. Maps have to be cut beyond the
diagonal. Their kernel is therefore sampled on four windows, cut at two, and kept up to the width of one. What is
sampled is 1/r - 1/R, which ends without a jump; 1/R is then added, so that displacements count from infinity.
"""

from functools import lru_cache

import numpy as np
from scipy.fft import dct
from scipy.special import itj0y0, j1, sici

from gfmd_numba.arrays import Reals

WIDER = 2  # the padded grid over the window, along each direction
_SAMPLED, _CUT = 4, 2.0  # windows over which the kernel of maps is sampled, and at which it is cut


def padded_shape(shape: tuple[int, ...]) -> tuple[int, ...]:
    """Shape of the grid on which a window of (ny,) nx nodes has no period."""
    return tuple(WIDER * n for n in shape)


@lru_cache(maxsize=2)
def compliance(shape: tuple[int, ...]) -> Reals:
    """Compliance `[(2 ny,) nx + 1]` of the normal displacement on the padded grid of a window, in L_x/E*.

    It is positive. A map has as many nodes along y as along x.
    """
    n = shape[-1]
    if len(shape) == 1:
        q = np.pi * np.arange(n + 1)
        q[0] = 1.0
        found = 4.0 * sici(q)[0] / (np.pi * q)
        found[0] = 4.0 / np.pi
        return np.asarray(found)
    quarter = _kernel_of_maps(n)
    for axis in range(2):
        quarter = dct(quarter, type=1, axis=axis)
    return np.concatenate((quarter, quarter[-2:0:-1]))


def _kernel_of_maps(n: int) -> Reals:
    """Displacement `[y, x]` at 0 ... n nodes from a node of n to a window that bears a pressure of E*, in L_x."""
    k = np.arange(_SAMPLED * n // 2 + 1)
    kernel = np.empty((k.size, k.size))
    for row in k:  # symmetric; row by row, so that nothing larger than the padded map is needed
        kernel[row, : row + 1] = kernel[: row + 1, row] = _cut_kernel(
            np.hypot(row, k[: row + 1]) * (2.0 * np.pi / _SAMPLED)
        )
    for axis in range(2):
        kernel = dct(kernel, type=1, axis=axis).take(np.arange(n + 1), axis=axis) / (_SAMPLED * n)
    return kernel + 1.0 / (np.pi * _CUT * n**2)


def _cut_kernel(q: Reals) -> Reals:
    """Transform at wave numbers q (1/L_x) of the kernel (1/r - 1/R) / pi cut at R, in L_x/E*."""
    first = q[0] == 0.0
    q = np.where(q > 0.0, q, 1.0)
    found = 2.0 / q * (itj0y0(q * _CUT)[0] - j1(q * _CUT))
    if first:
        found[0] = _CUT
    return np.asarray(found)
