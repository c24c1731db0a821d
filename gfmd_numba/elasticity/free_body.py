"""A body without a period: what its surface does under tractions on a window of nodes.

The displacement at a distance r of a line load on a profile is (2/pi E*) ln(R/r) into the body, of a force on a map
1/(pi E* r). Cut off at r = R, these kernels have Fourier transforms in closed form,

    C(q) = 4 Si(q R) / (pi E* q),  C(0) = 4 R / (pi E*)    and    C(q) = (2 / E* q) int_0^(q R) J0(t) dt.

On a grid that is twice as wide as the window, no image of a node is nearer to another node of the window than half its
period. A kernel that is right up to there, on a pressure that is zero beyond the window, gives the displacements in the
window: those of a free body, with nothing periodic left. The waves of the kernel end at Nyquist as on a periodic
grid, so that nodes mean the same.

Profiles are cut at the length of the window: R = L_x, where the displacement is zero. Maps have to be cut beyond the
diagonal. Their kernel is therefore sampled on four windows, cut at two, and kept up to the width of one. What is
sampled is 1/r - 1/R, which ends without a jump; 1/R is then added, so that displacements count from infinity.

Tangential tractions displace the surface in the same way. The compliance of a wave (q_x, q_y) = q (cos f, sin f) is
1 / q times a constant, cos f, cos 2f or sin 2f (Boussinesq, Cerruti: Johnson, Contact Mechanics, 3.2 and 3.6), and its
kernel 1 / (2 pi r) times the same of the direction in the plane. The kernel of m f, less (r/R)^m / R, is cut at R: its
transform is int_0^(q R) J_m(t) dt - J_(m+1)(q R) over q.

A window may have a period along y and none along x. Waves along y alone are then those of a profile. Kernels of all
others decay within half a period along x, like K0(q_y x). They are sampled on some windows, as those of a slab.

On a rigid base the kernel of a slab decays within some of its heights. It is sampled on so many windows that its images
are farther away than that, and kept up to the width of one.
"""

from collections.abc import Callable
from functools import lru_cache
from math import ceil

import numpy as np
from scipy.special import itj0y0, j0, j1, jn, sici

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import moduli, stiffness
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import SpectralResponse, Window
from gfmd_numba.fourier.grid import of_half_a_period

WIDER = 2  # the padded grid over the window, along each direction
_HEIGHTS = 12.0  # of a slab, beyond which its kernel is 0
_STRIPS = (
    3  # half the windows along x over which the kernels of waves along y are sampled: exp(-2 pi 5) is left of them
)
_SAMPLED, _CUT = 4, 2.0  # windows over which the kernel of maps is sampled, and at which it is cut


def padded_shape(shape: tuple[int, ...], ends: tuple[bool, ...] = ()) -> tuple[int, ...]:
    """Shape of the grid on which a window of (ny,) nx nodes has no period along the axes where it `ends`, or all."""
    return tuple(WIDER * n if end else n for n, end in zip(shape, ends or (True,) * len(shape), strict=True))


def _side(shape: tuple[int, ...]) -> int:
    """Nodes along each side of a window; raises ValueError for a map that is not square."""
    if len(set(shape)) > 1:
        raise ValueError(f"a window of {' x '.join(map(str, shape))} nodes, not as many along y as along x")
    return shape[-1]


def normal_response(shape: tuple[int, ...], body: ElasticBody) -> SpectralResponse:
    """Response of the normal displacement alone on the padded grid of a window, in E*/L_x."""
    stiff = _of_half_space(shape) if body.aspect_ratio is None else 1.0 / _of_slab(shape, body)
    return SpectralResponse.of_normal(stiff, _window(shape, body))


def _window(shape: tuple[int, ...], body: ElasticBody) -> Window:
    return Window(shape, lambda index: body.condensed_stiffness(2.0 * np.pi / WIDER * index))


@lru_cache(maxsize=2)
def _of_half_space(shape: tuple[int, ...]) -> Reals:
    return np.asarray(1.0 / compliance(shape))


@lru_cache(maxsize=2)
def _of_slab(shape: tuple[int, ...], slab: ElasticBody) -> Reals:
    """Compliance `[(2 ny,) nx + 1]` of the normal displacement of a slab, or layers, on a rigid base, in L_x/E*."""
    n, height = _side(shape), slab.aspect_ratio
    assert height is not None
    half = ceil(0.5 + 0.5 * _HEIGHTS * height) + 1  # of the windows that are sampled
    k = np.arange(half * n + 1) * (np.pi / half)
    across = k if len(shape) > 1 else k[:1]
    kernel = np.empty((across.size, n + 1))
    for row, q in zip(kernel, across, strict=True):
        row[:] = of_half_a_period(1.0 / slab.condensed_stiffness(np.hypot(q, k)))[: n + 1] / (2 * half * n)
    if len(shape) == 1:
        return of_half_a_period(kernel[0])
    kernel = of_half_a_period(kernel, 0)[: n + 1] / (2 * half * n)
    quarter = of_half_a_period(of_half_a_period(kernel, 0), 1)
    return np.concatenate((quarter, quarter[-2:0:-1]))


def response_along_y(shape: tuple[int, ...]) -> SpectralResponse:
    """Response of the normal displacement alone of a half-space in a window that has a period along y, in E*/L_x."""
    return SpectralResponse.of_normal(1.0 / _of_strips(_side(shape)), _window(shape, ElasticBody(None, None)))


@lru_cache(maxsize=2)
def _of_strips(n: int) -> Reals:
    """Compliance `[n, n + 1]` of the normal displacement on the grid that is padded along x, in L_x/E*."""
    k = np.arange(_STRIPS * n + 1) * (np.pi / _STRIPS)
    rows = [compliance((n,))]
    for k_y in range(1, n // 2 + 1):
        kernel = of_half_a_period(2.0 / np.hypot(2.0 * np.pi * k_y, k))[: n + 1] / (2 * _STRIPS * n)
        rows.append(of_half_a_period(kernel))
    return np.concatenate((rows, rows[(n - 1) // 2 : 0 : -1]))


def response(shape: tuple[int, ...], poissons_ratio: float) -> SpectralResponse:
    """Response of all displacements of a half-space on the padded grid of a window, in E*/L_x.

    Poisson's ratio is above 0: below that, waves along an axis would give way by themselves where the kernel ends.
    """
    k11, k13, k33 = (float(each) for each in stiffness.half_space_elements(poissons_ratio))
    determinant = k11 * k33 - k13**2
    along, both, out = k33 / determinant, -k13 / determinant, k11 / determinant
    window = _window(shape, ElasticBody(poissons_ratio, None))
    if len(shape) == 1:
        isotropic, odd = _of_profiles(_side(shape))
        elements = np.array([along * isotropic, both * odd, out * isotropic])
        return SpectralResponse.of_compliance(elements, window)
    across = 1.0 / float(moduli.c44(poissons_ratio))
    mean, half = 0.5 * (along + across), 0.5 * (along - across)
    n = _side(shape)
    isotropic, twice, mixed = (_of_maps(n, kind) for kind in ("1", "cos 2f", "sin 2f"))
    in_plane = (mean * isotropic + half * twice, half * mixed, mean * isotropic - half * twice)
    coupled = (both * _of_maps(n, kind) for kind in ("cos f", "sin f"))
    return SpectralResponse.of_compliance(np.array([*in_plane, *coupled, out * isotropic]), window)


def compliance(shape: tuple[int, ...]) -> Reals:
    """Compliance `[(2 ny,) nx + 1]` of the normal displacement of a half-space on the padded grid, in L_x/E*.

    It is positive. A map has as many nodes along y as along x; raises ValueError for another.
    """
    n = _side(shape)
    return np.asarray(2.0 * (_of_profiles(n)[0] if len(shape) == 1 else _of_kernel(n, "1")))


@lru_cache(maxsize=2)
def _of_profiles(n: int) -> tuple[Reals, Reals]:
    """Transforms `[n + 1]` of ln(1 / |x|) / pi and of sgn(x) / 2, both cut at the length of the window."""
    q = np.pi * np.arange(n + 1)
    q[0] = 1.0
    isotropic, odd = 2.0 * sici(q)[0] / (np.pi * q), np.where(np.arange(n + 1) % 2 == 1, 2.0, 0.0) / q
    isotropic[0], odd[0], odd[-1] = 2.0 / np.pi, 0.0, 0.0
    return isotropic, odd


# of each kernel: which direction it changes its sign with, y or x, its number m, and what it is of the direction
_KINDS: dict[str, tuple[tuple[bool, bool], int, Callable[[Reals, Reals], Reals]]] = {
    "1": ((False, False), 0, lambda y, x: np.ones(np.broadcast_shapes(y.shape, x.shape))),
    "cos f": ((False, True), 1, lambda y, x: x + 0.0 * y),
    "sin f": ((True, False), 1, lambda y, x: y + 0.0 * x),
    "cos 2f": ((False, False), 2, lambda y, x: x**2 - y**2),
    "sin 2f": ((True, True), 2, lambda y, x: 2.0 * x * y),
}


@lru_cache(maxsize=5)
def _of_maps(n: int, kind: str) -> Reals:
    return _of_kernel(n, kind)


def _of_kernel(n: int, kind: str) -> Reals:
    """Transform `[2 n, n + 1]` on the padded grid of a kernel of maps, that is 1 / q times its kind far from q = 0."""
    odd, _, _ = _KINDS[kind]
    quarter = kernel_of_maps(n, kind)
    for axis in range(2):
        quarter = of_half_a_period(quarter, axis, odd[axis])
    return np.concatenate((quarter, (-1.0 if odd[0] else 1.0) * quarter[-2:0:-1]))


def kernel_of_maps(n: int, kind: str) -> Reals:
    """Kernel `[y, x]` at 0 ... n nodes from one of the n by n of a window, which bears a pressure of E*, in L_x.

    It is 1 / (2 pi r) times its kind, but that of cos 2f has the other sign.
    """
    odd, m, direction = _KINDS[kind]
    k = np.arange(_SAMPLED * n // 2 + 1) * (2.0 * np.pi / _SAMPLED)
    kernel = np.empty((k.size, k.size))
    for row in range(k.size):  # row by row, so that nothing larger than the padded map is needed
        q = np.hypot(k[row], k[: row + 1])
        q[0] = q[0] or 1.0
        kernel[row, : row + 1] = kernel[: row + 1, row] = _cut(q * _CUT, m) / q
    for row in range(k.size if m > 0 else 0):
        q = np.hypot(k[row], k)
        q[0] = q[0] or 1.0
        kernel[row] *= direction(k[row] / q, k / q)
    kernel[0, 0] = 0.5 * _CUT if m == 0 else 0.0
    for axis in range(2):
        kernel = of_half_a_period(kernel, axis, odd[axis]).take(np.arange(n + 1), axis=axis) / (_SAMPLED * n)
    x = np.arange(n + 1) / n
    sign = -1.0 if kind == "cos 2f" else 1.0
    return np.asarray(kernel + sign * direction(x[:, np.newaxis], x) / (2.0 * np.pi * _CUT ** (m + 1) * n**2))


def _cut(z: Reals, m: int) -> Reals:
    """Share int_0^z J_m(t) dt - J_(m+1)(z) of the transform that is left once its kernel is cut, z = q R."""
    if m == 0:
        return np.asarray(itj0y0(z)[0] - j1(z))
    return np.asarray(1.0 - j0(z) - jn(2, z) if m == 1 else itj0y0(z)[0] - 2.0 * j1(z) - jn(3, z))
