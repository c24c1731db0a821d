"""Displacement, strain and stress inside a body below a map, wave by wave, at one depth at a time.

A wave of wave vector q = |q| (c, s) splits in two, as in `spectral_response.py`: along q and z it is that of a profile
(`fields.py`), and across q it is one of shear alone. Both are turned back into the axes x and y. Waves that have died
out at a depth are left out there. The Nyquist wave k_y = ny/2 is kept as both ny/2 and -ny/2, half of it each.
Lengths in L_x, stresses in E*; z counts from the undeformed surface and is negative inside.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Complexes, Indices, Reals
from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid

DISPLACEMENTS = ("u1", "u2", "u3")
STRAINS = ("strain1", "strain2", "strain3", "strain4", "strain5", "strain6")
STRESSES = ("stress1", "stress2", "stress3", "stress4", "stress5", "stress6")

_FADED = 50.0  # q depth beyond which nothing is felt: exp(-50) (1 + 50^2) < 1e-18
_CHUNK = 2**17  # waves taken at once, which bounds the memory


@dataclass(frozen=True)
class MapSurface:
    """Displacements of the surface of a map of ny, nx nodes, and its uniform traction (E*) along x, y and z.

    `along`, `across` (both in the surface) and `out` are coefficients `[k_y, k_x]` in L_x along each wave vector,
    across it and out of the body; `uniform` are mean displacements along x, y and z. k_y is 0 to ny//2, then -(ny//2)
    to -1. `q` are the different magnitudes of the wave vectors, from 0 on, and `places` `[k_y, k_x]` is where each is.
    """

    shape: tuple[int, ...]
    along: Complexes
    across: Complexes
    out: Complexes
    uniform: tuple[float, float, float]
    traction: tuple[float, float, float]
    q: Reals
    places: Indices


def surface_under_tractions(tractions: Reals, body: ElasticBody) -> MapSurface:
    """Surface under tractions `[component, y, x]` along x, y and out of the body; a half-space's mean is held."""
    return surface_under_waves(grid.coefficients(tractions, 2), tractions.shape[1:], body)


def surface_under_waves(waves: Complexes, shape: tuple[int, ...], body: ElasticBody) -> MapSurface:
    """Surface of a map of this shape under tractions of coefficients `[component, k_y, k_x]`, rows as in the grid."""
    q, places = _magnitudes(shape)
    t1, t2, t3 = (_both_nyquist_rows(each, shape) for each in waves)
    c, s = _directions(shape)
    compliance = body.compliance_along(q)
    s11, s13, s33 = (element[places] for element in (compliance.s11, compliance.s13, compliance.s33))
    along = c * t1 + s * t2
    softness = np.concatenate(([0.0], body.compliance_across(q[1:])))
    means = tuple(float(each[0, 0].real) for each in (t1, t2, t3))
    soft, normal = float(compliance.s11[0]), float(compliance.s33[0])
    return MapSurface(
        shape,
        s11 * along - 1j * s13 * t3,
        softness[places] * (c * t2 - s * t1),
        s33 * t3 + 1j * s13 * along,
        (soft * means[0], soft * means[1], normal * means[2]),
        (means[0], means[1], means[2]),
        q,
        places,
    )


def formed_surface(heights: Reals) -> MapSurface:
    """Surface of a body displaced by (0, 0, h), `[y, x]` of zero mean and without its Nyquist waves (thesis 5.15)."""
    shape = heights.shape
    out = _both_nyquist_rows(grid.without_nyquist(grid.coefficients(heights, 2), shape), shape)
    none = (0.0, 0.0, 0.0)
    return MapSurface(shape, np.zeros_like(out), np.zeros_like(out), out, none, none, *_magnitudes(shape))


def waves_kept(shape: tuple[int, ...], depth: float) -> tuple[int, int]:
    """Largest k_y and k_x that are felt at a depth."""
    felt = _FADED / (2.0 * np.pi * depth) if depth > 0.0 else np.inf
    most_y, most_x = (int(min(n // 2, max(felt, 1.0))) for n in shape)
    return most_y, most_x


def rows_kept(shape: tuple[int, ...], most: int) -> Indices:
    """Rows of the coefficients whose k_y is at most so large, in order."""
    rows = 2 * (shape[0] // 2) + 1
    return np.concatenate((np.arange(most + 1), np.arange(rows - most, rows)))


def waves_at_depth(
    surface: MapSurface, depth: float, body: ElasticBody, names: tuple[str, ...]
) -> Iterator[tuple[Indices, Indices, Complexes]]:
    """Waves k_y `[row]` and k_x, and coefficients `[field, row, k_x]` of the named fields, some rows after the others.

    Together the rows are all those whose waves are felt at the depth.
    """
    most_y, most_x = waves_kept(surface.shape, depth)
    rows, columns = rows_kept(surface.shape, most_y), np.arange(most_x + 1)
    transfer = _transfer(surface, depth, body, most_y, most_x)
    means = _means(surface, depth, body)
    for some in np.array_split(rows, max(1, rows.size * columns.size // _CHUNK)):
        k_y = np.where(some <= surface.shape[0] // 2, some, some - 2 * (surface.shape[0] // 2) - 1)
        waves = _waves(surface, np.ix_(some, columns), k_y, columns, transfer)
        found = np.stack([_FIELDS[name](waves) for name in names])
        if some[0] == 0:
            found[:, 0, 0] = [means[name] for name in names]
        yield k_y, columns, found


@dataclass(frozen=True)
class _Transfer:
    """What unit displacements of the surface make at a depth, for each magnitude q `[q]`, and the material there."""

    q: Reals
    u1: tuple[Reals, Reals]
    u3: tuple[Reals, Reals]
    p: tuple[Reals, Reals]
    w: tuple[Reals, Reals]
    across: tuple[Reals, Reals]
    shear: float
    kolosov: float


def _transfer(surface: MapSurface, depth: float, body: ElasticBody, most_y: int, most_x: int) -> _Transfer:
    last = int(np.searchsorted(surface.q, 2.0 * np.pi * np.hypot(most_y, most_x) * (1.0 + 1e-12)))
    q, material = surface.q[:last], body.material(depth)
    found = body.transfer(depth, q[1:])
    pairs = (found.u1, found.u3, found.p, found.w, body.transfer_across(depth, q[1:]))
    u1, u3, p, w, across = ((np.append(0.0, first), np.append(0.0, second)) for first, second in pairs)
    return _Transfer(q, u1, u3, p, w, across, material.shear, float(moduli.kolosov(material.poissons_ratio)))


@dataclass(frozen=True)
class _Waves:
    """Waves `[k_y, k_x]` at a depth in axes along the wave vector (c, s), across it and out of the body.

    `along`, `across` and `out` are displacements; `stretch`, `rise`, `sheared`, `turned` and `sloped` strains, along
    q, along z, and of shear of q and z, of q and across, and of z and across. `equal` is the stress across q.
    """

    c: Reals
    s: Reals
    shear: float
    along: Complexes
    across: Complexes
    out: Complexes
    stretch: Complexes
    rise: Complexes
    sheared: Complexes
    turned: Complexes
    sloped: Complexes
    equal: Complexes
    normal: Complexes

    def strain1(self) -> Complexes:
        return np.asarray(self.c**2 * self.stretch - self.c * self.s * self.turned)

    def strain2(self) -> Complexes:
        return np.asarray(self.s**2 * self.stretch + self.c * self.s * self.turned)

    def strain4(self) -> Complexes:
        return np.asarray(self.s * self.sheared + self.c * self.sloped)

    def strain5(self) -> Complexes:
        return np.asarray(self.c * self.sheared - self.s * self.sloped)

    def strain6(self) -> Complexes:
        return np.asarray(2.0 * self.c * self.s * self.stretch + (self.c**2 - self.s**2) * self.turned)


_FIELDS: dict[str, Callable[[_Waves], Complexes]] = {
    "u1": lambda wave: wave.c * wave.along - wave.s * wave.across,
    "u2": lambda wave: wave.s * wave.along + wave.c * wave.across,
    "u3": lambda wave: wave.out,
    "strain1": _Waves.strain1,
    "strain2": _Waves.strain2,
    "strain3": lambda wave: wave.rise,
    "strain4": _Waves.strain4,
    "strain5": _Waves.strain5,
    "strain6": _Waves.strain6,
    "stress1": lambda wave: wave.equal + 2.0 * wave.shear * wave.strain1(),
    "stress2": lambda wave: wave.equal + 2.0 * wave.shear * wave.strain2(),
    "stress3": lambda wave: wave.normal,
    "stress4": lambda wave: wave.shear * wave.strain4(),
    "stress5": lambda wave: wave.shear * wave.strain5(),
    "stress6": lambda wave: wave.shear * wave.strain6(),
}


def _waves(surface: MapSurface, chosen: tuple[Indices, ...], k_y: Indices, k_x: Indices, transfer: _Transfer) -> _Waves:
    """Waves of a surface at a depth, as `fields.waves_at_depth` has them along each wave vector."""
    places, shear, kolosov = surface.places[chosen], transfer.shear, transfer.kolosov
    q = transfer.q[places]
    cosine, sine = surface.along[chosen], 1j * surface.out[chosen]
    u1, u3, p, w = (
        first[places] * cosine + second[places] * sine
        for first, second in (transfer.u1, transfer.u3, transfer.p, transfer.w)
    )
    across, slope = (each[places] * surface.across[chosen] for each in transfer.across)
    return _Waves(
        *_unit_vectors(k_y, k_x),
        shear,
        along=u1,
        across=across,
        out=-1j * u3,
        stretch=1j * q * u1,
        rise=-1j * q * (u1 + (kolosov - 1.0) * p),
        sheared=q * (2.0 * u3 + (kolosov + 1.0) * w),
        turned=1j * q * across,
        sloped=q * slope,
        equal=-1j * shear * q * (3.0 - kolosov) * p,
        normal=-1j * shear * q * (2.0 * u1 + (kolosov + 1.0) * p),
    )


def _means(surface: MapSurface, depth: float, body: ElasticBody) -> dict[str, float]:
    """The uniform part: tractions do not change with depth, the periodic body cannot widen."""
    (u1, u2, u3), (t1, t2, t3) = surface.uniform, surface.traction
    material, (sheared, stretched) = body.material(depth), body.uniform_displacement(depth)
    nu = material.poissons_ratio
    displacements = (u1 - t1 * sheared, u2 - t2 * sheared, u3 - t3 * stretched)
    strains = (0.0, 0.0, t3 / material.c11, t2 / material.shear, t1 / material.shear, 0.0)
    stresses = (nu / (1.0 - nu) * t3, nu / (1.0 - nu) * t3, t3, t2, t1, 0.0)
    return dict(zip(DISPLACEMENTS + STRAINS + STRESSES, displacements + strains + stresses, strict=True))


def _all_waves(shape: tuple[int, ...]) -> tuple[Indices, Indices]:
    half = shape[0] // 2
    return np.concatenate((np.arange(half + 1), np.arange(-half, 0))), np.arange(shape[1] // 2 + 1)


def _magnitudes(shape: tuple[int, ...]) -> tuple[Reals, Indices]:
    """Different magnitudes of the wave vectors, and where each wave's is; many waves have one magnitude."""
    k_y, k_x = _all_waves(shape)
    squares, places = np.unique(k_y[:, np.newaxis] ** 2 + k_x**2, return_inverse=True)
    return 2.0 * np.pi * np.sqrt(squares), places.reshape(k_y.size, k_x.size)


def _directions(shape: tuple[int, ...]) -> tuple[Reals, Reals]:
    return _unit_vectors(*_all_waves(shape))


def _unit_vectors(k_y: Indices, k_x: Indices) -> tuple[Reals, Reals]:
    """Cosine and sine `[k_y, k_x]` of the direction of each wave vector, zero for the mean."""
    magnitude = np.hypot(k_y[:, np.newaxis], k_x)
    magnitude[magnitude == 0.0] = 1.0
    return k_x / magnitude, k_y[:, np.newaxis] / magnitude


def _both_nyquist_rows(coefficients: Complexes, shape: tuple[int, ...]) -> Complexes:
    """Coefficients `[k_y, k_x]` with half of the Nyquist wave of even ny at ny/2 and half at -ny/2."""
    k_y, _ = _all_waves(shape)
    found = coefficients[k_y % shape[0]]
    if shape[0] % 2 == 0:
        found[abs(k_y) == shape[0] // 2] *= 0.5
    return found
