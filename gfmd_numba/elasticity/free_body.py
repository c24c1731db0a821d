"""A body without a period: what its surface does under tractions on a window of nodes.

The displacement at a distance r of a line load on a profile is (2/pi E*) ln(R/r) into the body, of a force on a map
1/(pi E* r). Cut off at r = R, the second one less its value there, these kernels have the Fourier transforms

    C(q) = 4 Si(q R) / (pi E* q),                               C(0) = 4 R / (pi E*)    and
    C(q) = (2 / E* q) (int_0^(q R) J0(t) dt - J1(q R)),         C(0) = R / E*.

On a grid that is twice as wide as the window, no image of a node is nearer to another node of the window than half its
period. A kernel that is right up to there, on a pressure that is zero beyond the window, gives the displacements in the
window: those of a free body, with nothing periodic left. The waves of the kernel end at Nyquist as on a periodic
grid, so that nodes mean the same. What a node does to itself follows from this, and is no average over a pixel (Love).

Profiles are cut at the length of the window: R = L_x, where the displacement is zero. Maps have to be cut beyond the
diagonal. Their kernel is therefore sampled on four windows, cut at two, and kept up to the width of one. What is
sampled is 1/r - 1/R, which ends without a jump; 1/R is then added, so that displacements count from infinity.

Tangential tractions displace the surface in the same way. The compliance of a wave (q_x, q_y) = q (cos f, sin f) is
1 / q times a constant, cos f, cos 2f or sin 2f (Boussinesq, Cerruti: Johnson, Contact Mechanics, 3.2 and 3.6), and its
kernel 1 / (2 pi r) times the same of the direction in the plane. The kernel of m f, less (r/R)^m / R, is cut at R: its
transform is int_0^(q R) J_m(t) dt - J_(m+1)(q R) over q.

The kernel of a slab on a rigid base decays by itself within some of its heights, and where a map has a period along
one axis, those of waves along that axis do so within half a period. They are sampled on so many windows that their
images are farther away than that, and kept up to the width of one, along each axis without a period. Where y has a
period, waves along x alone are those of a profile.

Layers on a half-space, and slabs higher than the window, give way to short waves as a half-space of their topmost
material does. The difference g(q) / q of the compliances is split in two. Long waves, below some tens of waves in the
window, make a smooth kernel, which is an integral over q at each distance: (1 / 2 pi) int g(q) J0(q r) dq. What short
waves add decays within the window, so that it is taken as it is on the padded grid. On profiles, where g(0) is g0,

    -(g0 / 2 pi) ln(1 + x^2) + (1 / pi) int (g(q) - g0 exp(-q)) cos(q x) / q dq,

which counts displacements of slabs from their base. Those of half-spaces count from where x = 1, as without layers.
"""

from collections.abc import Callable
from functools import lru_cache, reduce
from math import ceil, hypot

import numpy as np
import scipy  # its modules load with their first use

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.spectral_response import FOLLOWED, SpectralResponse, Window, inverse
from gfmd_numba.fourier import grid
from gfmd_numba.fourier.grid import of_half_a_period

HALF_SPACE = ElasticBody(None, None)
WIDER = 2  # the padded grid over the window, along each direction
_HEIGHTS = 12.0  # of a slab, beyond which its kernel is 0
_STRIPS = 3  # half the windows on which waves along a period are sampled: exp(-2 pi 5) is left of them
TALLEST = 1.0  # slab, over the window, whose kernel is sampled
_LONG, _WITHIN = 72.0, 12.0  # wave number (1/L_x) up to which waves count as long, and half the way on which that ends
_LONGEST, _PANEL = 1e-8, 5.0  # wave number where panels of quadrature begin to double, and their largest width
_FINE = 0.4  # distances at which long waves are summed up, over 1 / their largest number
_SAMPLED, _CUT = 4, 2.0  # windows over which the kernel of maps is sampled, and at which it is cut
_ODD = {  # of each element of a compliance, by their number: whether it changes its sign with q_y, and with q_x
    1: ((False, False),),
    3: ((False, False), (False, True), (False, False)),
    6: ((False, False), (True, True), (False, False), (False, True), (True, False), (False, False)),
}
_X_FOR_Y = {1: [0], 6: [2, 1, 0, 4, 3, 5]}  # elements, where x and y have changed places


def padded_shape(shape: tuple[int, ...], ends: tuple[bool, ...] = ()) -> tuple[int, ...]:
    """Shape of the grid on which a window of (ny,) nx nodes has no period along the axes where it `ends`, or all."""
    return tuple(WIDER * n if end else n for n, end in zip(shape, ends or (True,) * len(shape), strict=True))


def response(
    shape: tuple[int, ...], body: ElasticBody, ends: tuple[bool, ...] = (), couples: bool = False
) -> SpectralResponse:
    """Response of a body on the padded grid of a window of (ny,) nx nodes that `ends` along these axes, in E*/L_x.

    It is that of the normal displacement alone, or of all that tangential tractions couple. Then Poisson's ratio of a
    half-space is above 0: below that, waves along an axis would give way by themselves where the kernel ends. Raises
    ValueError for a map that has not as many nodes along y as along x, and for layers on a half-space that are coupled.
    """
    window = Window(shape, padded_shape(shape, ends), body.condensed_stiffness)
    return SpectralResponse(inverse(compliance(shape, body, ends, couples)), window)


def displaced(tractions: Reals, body: ElasticBody, ends: tuple[bool, ...]) -> Reals:
    """Displacement `[component, (y,) x]` of a window that `ends` along (y,) x under tractions of its shape (L_x, E*).

    The last component is the normal one, which may be alone.
    """
    shape = tractions.shape[1:]
    wide, window = np.zeros((len(tractions), *padded_shape(shape, ends))), grid.corner(shape)
    wide[window] = tractions
    return np.asarray(response(shape, body, ends, len(tractions) > 1).apply(wide)[window])


def compliance(
    shape: tuple[int, ...], body: ElasticBody = HALF_SPACE, ends: tuple[bool, ...] = (), couples: bool = False
) -> Reals:
    """Elements of the compliance `[element, (y,) x]` that `response` is made of, in L_x/E*."""
    n, padded, components = _side(shape), padded_shape(shape, ends), 1 + couples * len(shape)
    number = components * (components + 1) // 2
    rows, both = (1, *padded)[-2], (False, *(ends or (True,) * len(shape)))[-2:]  # a profile is a map of one row
    if number > 1 and body.stack is not None and body.aspect_ratio is None:
        raise ValueError("layers on a half-space, under tangential tractions without a period")
    if number == 1 and _is_deep(body) and all(both):
        quarter = _of_deep(n, body)[np.newaxis]
    elif body.aspect_ratio is None and all(both):
        quarter = _of_half_space(n, body, number)
    else:
        quarter = _sampled(rows, n, both, body, number)
    whole = np.concatenate((quarter, quarter[:, (rows - 1) // 2 : 0 : -1]), axis=1)
    for element, (odd_y, _) in zip(whole, _ODD[number], strict=True):
        if odd_y:
            np.negative(element[quarter.shape[1] :], out=element[quarter.shape[1] :])
    return whole.reshape(number, *padded[:-1], -1)


def _side(shape: tuple[int, ...]) -> int:
    """Nodes along each side of a window; raises ValueError for a map that is not square."""
    if len(set(shape)) > 1:
        raise ValueError(f"a window of {' x '.join(map(str, shape))} nodes, not as many along y as along x")
    return shape[-1]


def _of_half_space(n: int, body: ElasticBody, number: int) -> Reals:
    """Elements of a half-space around a window of a map `[element, y, x]`, from the waves 0 on along each axis."""
    if number == 1:
        return _of_waves(body, 0.0, np.ones(1), 1) * _of_maps(n, "1")[np.newaxis]
    along, _, across, both, _, out = _of_waves(body, 0.0, np.ones(1), 6)
    mean, half = 0.5 * (along + across), 0.5 * (along - across)
    isotropic, twice, mixed = (_of_maps(n, kind) for kind in ("1", "cos 2f", "sin 2f"))
    in_plane = (mean * isotropic + half * twice, half * mixed, mean * isotropic - half * twice)
    return np.array([*in_plane, *(both * _of_maps(n, kind) for kind in ("cos f", "sin f")), out * isotropic])


def _is_deep(body: ElasticBody) -> bool:
    """Whether it is no half-space of one material, and its kernel decays beyond the window."""
    return body.stack is not None if body.aspect_ratio is None else body.aspect_ratio > TALLEST


@lru_cache(maxsize=2)
def _of_deep_line(n: int, body: ElasticBody) -> Reals:
    """Compliance `[x]` of layers on a half-space, or a tall slab, to line loads from the waves 0 on."""
    smooth = beyond_half_space(body, _positions(n))
    smooth -= smooth[-1] if body.aspect_ratio is None else 0.0
    return _of_parts(body, 2.0 * _of_profiles(n)[0], smooth)


@lru_cache(maxsize=2)
def _of_deep(n: int, body: ElasticBody) -> Reals:
    """Compliance `[y, x]` of the normal displacement of layers on a half-space, or a tall slab, from the waves 0 on."""
    from scipy.interpolate import make_interp_spline  # which loads more of scipy than all other bodies need

    (q, weights), x = _long_waves(), _positions(n)
    r = np.arange(-6.0, hypot(1.0, 1.0) * q[-1] / _FINE + 8.0) * _FINE / q[-1]
    weights = weights * (q / body.condensed_stiffness(q) - 2.0)
    along_r = np.array([weights @ scipy.special.j0(q * each) for each in r]) / (2.0 * np.pi)
    smooth = make_interp_spline(r, along_r, 5)(np.hypot(x[:, np.newaxis], x))
    return _of_parts(body, 2.0 * _of_maps(n, "1"), smooth)


def _positions(n: int) -> Reals:
    """Positions in half a padded period of a window of n nodes, at least as many as bear all long waves."""
    nodes = n * ceil(_LONG / (1.5 * n))
    return np.arange(nodes + 1) / nodes


def _of_parts(body: ElasticBody, of_top: Reals, smooth: Reals) -> Reals:
    """Compliance `[(y,) x]` of a half-space of the topmost material, and what long and short waves add.

    `smooth` is the kernel of the long waves at `_positions`.
    """
    nodes, waves = len(smooth) - 1, np.pi * np.arange(len(of_top), dtype=np.float64)
    for axis in range(smooth.ndim):
        smooth = of_half_a_period(smooth, axis).take(np.arange(len(of_top)), axis=axis) / nodes
    q = reduce(np.hypot, np.ix_(*[waves] * of_top.ndim))
    q.flat[0] = 1.0  # which is long
    return np.asarray(of_top + smooth + _short(q) * (1.0 / body.condensed_stiffness(q) - 2.0 / q))


def beyond_half_space(body: ElasticBody, x: Reals) -> Reals:
    """Displacement by the long waves of a line load at distances x, less that of a half-space of the top (L_x, E*)."""
    q, weights = _long_waves()
    jump = (0.0 if body.aspect_ratio is not None else 2.0 / body.material(np.inf).modulus) - 2.0
    smooth = (q / body.condensed_stiffness(q) - 2.0 - jump * np.exp(-q)) / q
    return np.asarray((np.cos(x[:, np.newaxis] * q) @ (weights * smooth) - 0.5 * jump * np.log1p(x**2)) / np.pi)


def _short(q: Reals) -> Reals:
    """Share of waves of these numbers that counts as short."""
    return np.asarray(0.5 * scipy.special.erfc((_LONG - q) / _WITHIN))


@lru_cache(maxsize=1)
def _long_waves() -> tuple[Reals, Reals]:
    """Wave numbers of all long waves and their shares and weights in an integral over them, denser towards 0."""
    edges = [0.0, _LONGEST]
    while edges[-1] < _LONG + 6.0 * _WITHIN:
        edges.append(edges[-1] + min(edges[-1], _PANEL))
    at, weights = np.polynomial.legendre.leggauss(16)
    halves, middles = 0.5 * np.diff(edges)[:, np.newaxis], 0.5 * (np.array(edges[1:]) + edges[:-1])[:, np.newaxis]
    q = (middles + halves * at).ravel()
    return q, (halves * weights).ravel() * (1.0 - _short(q))


def _of_line_loads(n: int, body: ElasticBody, number: int) -> Reals:
    """Elements of a half-space under what is uniform along y `[element, x]`."""
    if number == 1 and _is_deep(body):
        return _of_deep_line(n, body)[np.newaxis]
    isotropic, odd = _of_profiles(n)
    units = _of_waves(body, 0.0, np.ones(1), number)
    return np.array(
        [unit * (odd if odd_x else isotropic) for unit, (_, odd_x) in zip(units, _ODD[number], strict=True)]
    )


@lru_cache(maxsize=2)
def _sampled(rows: int, n: int, ends: tuple[bool, ...], body: ElasticBody, number: int) -> Reals:
    """Elements `[element, y, x]` of kernels that decay along each axis (y, x) that `ends`, from the waves 0 on.

    Along y, unless that ends, there are so many rows to a period.
    """
    if not ends[1]:
        swapped = _sampled(n, n, ends[::-1], body, number)
        return np.ascontiguousarray(swapped[_X_FOR_Y[number]].swapaxes(1, 2))
    deep = body.aspect_ratio is None or (number == 1 and _is_deep(body))
    half = _STRIPS if deep else ceil(0.5 + 0.5 * _HEIGHTS * (body.aspect_ratio or 0.0)) + 1
    q_x = np.pi / half * np.arange(half * n + 1, dtype=np.float64)
    q_y = q_x if ends[0] else 2.0 * np.pi * np.arange(rows // 2 + 1)
    found = np.empty((number, q_y.size, n + 1))
    if deep:
        found[:, 0] = _of_line_loads(n, body, number)
    for i, each in enumerate(q_y[int(deep) :], int(deep)):
        for row, waves, (_, odd) in zip(
            found[:, i], _of_waves(body, float(each), q_x, number), _ODD[number], strict=True
        ):
            row[:] = _kept(waves, half, odd)
    if ends[0]:
        return np.array([_kept(each.T, half, odd).T for each, (odd, _) in zip(found, _ODD[number], strict=True)])
    if rows % 2 == 0:  # the grid does not tell the waves q_y and -q_y there
        found[[odd for odd, _ in _ODD[number]], -1] = 0.0
    return found


def _kept(waves: Reals, half: int, odd: bool) -> Reals:
    """Waves of a kernel that is sampled on 2 `half` windows, once it is kept up to the width of one."""
    n = (waves.shape[-1] - 1) // half
    return np.asarray(of_half_a_period(of_half_a_period(waves, odd=odd)[..., : n + 1], odd=odd) / (2 * half * n))


def _of_waves(body: ElasticBody, q_y: float, q_x: Reals, number: int) -> Reals:
    """Elements of the compliance of a body `[element, wave]` at wave vectors (q_x, q_y), 0 for a mean that drifts."""
    q = np.hypot(q_y, q_x)
    if number == 1:
        stiffness = body.condensed_stiffness(q)
        return np.divide(1.0, stiffness, out=np.zeros_like(q), where=stiffness > 0.0)[np.newaxis]
    waves = q if q[0] == 0.0 else np.append(0.0, q)
    along, both, out = (element[-q.size :] for element in body.compliance(waves).elements)
    across, safe = along.copy(), np.where(q > 0.0, q, 1.0)  # a mean is as stiff across as along
    across[q > 0.0] = body.compliance_across(q[q > 0.0])
    c, s = np.where(q > 0.0, q_x / safe, 1.0), q_y / safe
    in_plane = along * c**2 + across * s**2, (along - across) * c * s, along * s**2 + across * c**2
    every = (*in_plane, both * c, both * s, out)
    return np.array([every[place] for place in FOLLOWED[number]])


@lru_cache(maxsize=2)
def _of_profiles(n: int) -> tuple[Reals, Reals]:
    """Transforms `[n + 1]` of ln(1 / |x|) / pi and of sgn(x) / 2, both cut at the length of the window."""
    q = np.pi * np.arange(n + 1)
    q[0] = 1.0
    isotropic, odd = 2.0 * scipy.special.sici(q)[0] / (np.pi * q), np.where(np.arange(n + 1) % 2 == 1, 2.0, 0.0) / q
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
    """Transform `[n + 1, n + 1]` on the padded grid of a kernel that is 1 / q times its kind far from q = 0."""
    quarter = kernel_of_maps(n, kind)
    for axis, odd in enumerate(_KINDS[kind][0]):
        quarter = of_half_a_period(quarter, axis, odd)
    return quarter


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
    bessel = scipy.special
    if m == 0:
        return np.asarray(bessel.itj0y0(z)[0] - bessel.j1(z))
    if m == 1:
        return np.asarray(1.0 - bessel.j0(z) - bessel.jn(2, z))
    return np.asarray(bessel.itj0y0(z)[0] - 2.0 * bessel.j1(z) - bessel.jn(3, z))
