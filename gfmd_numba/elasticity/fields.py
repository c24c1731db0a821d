"""Displacement, strain and stress inside a body below its loaded surface, one plane at a time (thesis 2.2, (2.6)).

A wave of wave vector q = |q| (c, s) splits in two, as in `spectral_response.py`: the part along q and z is a wave of
`layers.py`, the part across q a wave of shear alone. Both are turned back into the axes x and y. A profile is a map of
one row, whose waves all go along x. Waves that have died out at a depth are left out there. The Nyquist wave k_y = ny/2
is kept as both ny/2 and -ny/2, half of it each. One plane at a time is in memory.

Under a pressure p cos(q x) on a half-space, the stresses at a depth d are

    zz = -p (1 + q d) exp(-q d) cos(q x),    xx = -p (1 - q d) exp(-q d) cos(q x),    yy = nu (xx + zz),
    xz = p q d exp(-q d) sin(q x).

Lengths in L_x, stresses in E*; z counts from the undeformed surface and is negative inside. Stresses are tensions. At
an interface of layers the fields are those just above it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil
from typing import Literal, Protocol

import numpy as np

from gfmd_numba.arrays import Complexes, Indices, Reals
from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.fourier import grid

DISPLACEMENTS = ("u1", "u2", "u3")
# xx, yy, zz, yz, xz, xy, as Voigt numbers them; strains of shear are twice the tensor's
STRAINS = ("strain1", "strain2", "strain3", "strain4", "strain5", "strain6")
STRESSES = ("stress1", "stress2", "stress3", "stress4", "stress5", "stress6")

Axis = Literal["x", "y"]

_ONE = (1.0, 1.0)  # the periods of a surface, unless it has others
_FADED = 50.0  # q depth beyond which nothing is felt: exp(-50) (1 + 50^2) < 1e-18
_LEAST = 64  # nodes along a side of a window on which the largest stress is looked for
_CHUNK = 2**16  # waves taken at once, which bounds the memory


class LoadedSurface(Protocol):
    """A loaded surface, from which the waves below it are known."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Nodes along y and x."""

    @property
    def periods(self) -> tuple[float, float]:
        """Periods along y and x (L_x)."""

    def waves(
        self, depth: float, body: ElasticBody, names: tuple[str, ...]
    ) -> Iterator[tuple[Indices, Indices, Complexes]]:
        """Waves k_y `[row]` and k_x at a depth, coefficients `[field, row, k_x]` of named fields: parts of a sum."""


@dataclass(frozen=True)
class Surface:
    """Displacements of the surface of a map of ny, nx nodes, and its uniform traction (E*) along x, y and z.

    `along`, `across` (both in the surface) and `out` are coefficients `[k_y, k_x]` in L_x along each wave vector,
    across it and out of the body; `uniform` are mean displacements along x, y and z. k_y is 0 to ny//2, then -(ny//2)
    to -1. `q` are the different magnitudes of the wave vectors, from 0 on, and `places` `[k_y, k_x]` is where each is.
    The `periods` along y and x are in L_x.
    """

    shape: tuple[int, ...]
    along: Complexes
    across: Complexes
    out: Complexes
    uniform: tuple[float, float, float]
    traction: tuple[float, float, float]
    q: Reals
    places: Indices
    periods: tuple[float, float] = _ONE

    def waves(
        self, depth: float, body: ElasticBody, names: tuple[str, ...]
    ) -> Iterator[tuple[Indices, Indices, Complexes]]:
        """Waves that are felt at a depth, as in `LoadedSurface`, some rows after the others."""
        (most_y, most_x), half = waves_kept(self.shape, depth, self.periods), self.shape[0] // 2
        rows = np.concatenate((np.arange(most_y + 1), 2 * half + 1 + np.arange(-most_y, 0)))
        columns = np.arange(most_x + 1)
        highest = 2.0 * np.pi * np.hypot(most_y / self.periods[0], most_x / self.periods[1])
        last = int(np.searchsorted(self.q, highest * (1.0 + 1e-12)))
        transfer = _transfer(self.q[:last], depth, body)
        means = _means(self, depth, body)
        for some in np.array_split(rows, min(rows.size, max(1, rows.size * columns.size // _CHUNK))):
            k_y, chosen = np.where(some <= half, some, some - 2 * half - 1), np.ix_(some, columns)
            waves = _turned(self, transfer[:, self.places[chosen]], chosen, (k_y, columns), body.material(depth), names)
            if some[0] == 0:
                waves[:, 0, 0] = [means[name] for name in names]
            yield k_y, columns, waves


def in_rows(fields: Reals) -> Reals:
    """Fields `[component, y, x]` of a map, or those `[component, x]` of a profile as of a map of one row."""
    if fields.ndim == 3:
        return fields
    along, out = fields
    return np.stack((along, np.zeros_like(along), out))[:, np.newaxis]


def surface_under_tractions(tractions: Reals, body: ElasticBody) -> Surface:
    """Surface under tractions `[component, (y,) x]`, along it and out of the body; a half-space's mean is held."""
    rows = in_rows(tractions)
    return surface_under_waves(grid.coefficients(rows, 2), rows.shape[1:], body)


def surface_under_waves(
    waves: Complexes, shape: tuple[int, ...], body: ElasticBody, periods: tuple[float, float] = _ONE
) -> Surface:
    """Surface of a map of this shape under tractions of coefficients `[component, k_y, k_x]`, rows as in the grid."""
    q, places = _magnitudes(shape, periods)
    compliance, softness = body.compliance(q), np.append(0.0, body.compliance_across(q[1:]))
    t, sideways, t3 = _along_waves(waves, shape, periods)
    s11, s13, s33 = (element[places] for element in (compliance.s11, compliance.s13, compliance.s33))
    along, out = s11 * t - 1j * s13 * t3, s33 * t3 + 1j * s13 * t
    means, soft = waves[:, 0, 0].real, (compliance.s11[0], compliance.s11[0], compliance.s33[0])
    uniform, sideways = _three(means * soft), softness[places] * sideways
    return Surface(shape, along, sideways, out, uniform, _three(means), q, places, periods)


def displaced_surface(displacements: Reals, body: ElasticBody) -> Surface:
    """Surface of given displacements `[component, (y,) x]`, along it and out of the body.

    A mean displacement that no traction restores, or only an infinite one, is assumed to take none. The nodes sample
    one phase of the Nyquist wave of a profile; the phase a quarter wave off follows as if it were free. The Nyquist
    waves of a map are left out.
    """
    rows = in_rows(displacements)
    waves, shape = grid.coefficients(rows, 2), rows.shape[1:]
    q, places = _magnitudes(shape, _ONE)
    found = body.compliance(q)
    if shape[0] > 1:
        waves = grid.without_nyquist(waves, shape)
    elif shape[1] % 2 == 0:
        u1, _, u3 = waves[:, 0, -1].copy()
        lead = 1j * found.s13[-1]
        waves[0, 0, -1], waves[2, 0, -1] = u1 - lead / found.s33[-1] * u3, u3 + lead / found.s11[-1] * u1
    means, soft = waves[:, 0, 0].real, np.array((found.s11[0], found.s11[0], found.s33[0]))
    tractions = np.divide(means, soft, out=np.zeros(3), where=soft > 0.0)
    return Surface(shape, *_along_waves(waves, shape, _ONE), _three(means), _three(tractions), q, places)


@dataclass(frozen=True)
class Largest:
    """Largest von Mises stress (E*) of each plane z `[z]`, and where it is (L_x)."""

    von_mises: Reals
    x: Reals
    y: Reals


@dataclass(frozen=True)
class Inside:
    """The inside of a body below its periodic surface, or below a window as a sum of `parts`, each of its own periods.

    `uniform` are displacements along x, y and z that are left (L_x).
    """

    parts: tuple[LoadedSurface, ...]
    body: ElasticBody
    uniform: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def shape(self) -> tuple[int, ...]:
        """Nodes along y and x of the period, or of the window."""
        return tuple(n // round(period) for n, period in zip(self.parts[0].shape, self.parts[0].periods, strict=True))

    def section(self, z: Reals, names: tuple[str, ...], across: Axis = "y", at: float = 0.0) -> Reals:
        """Named fields `[field, z, node]` on the vertical section x = at, or y = at (L_x), over the nodes along it.

        The section of a profile is y = 0. Raises ValueError for z outside the body.
        """
        on_line, along = (spectrum_at_x, 0) if across == "x" else (spectrum_at_y, 1)

        def at_depth(depth: float) -> Reals:
            spectra = (on_line(part, depth, self.body, at / part.periods[1 - along], names) for part in self.parts)
            return self._sum(spectra, {along: self.shape[along]}, names)

        return np.stack([at_depth(depth_of(each, self.body)) for each in z], axis=1)

    def plane(self, z: float, names: tuple[str, ...]) -> Reals:
        """Named fields `[field, y, x]` on the plane z, on the nodes of the map; ValueError for z outside the body."""
        return self._plane(depth_of(z, self.body), names, self.shape)

    def largest_von_mises(self, z: Reals) -> Largest:
        """Largest von Mises stress of whole planes z `[z]`, on grids that resolve the waves that are felt there."""
        found = np.empty((3, z.size))
        for i, depth in enumerate(depth_of(each, self.body) for each in z):
            shape = self._shape_at(depth)
            stress = von_mises(*self._plane(depth, STRESSES, shape))
            row, column = np.unravel_index(int(stress.argmax()), shape)
            found[:, i] = stress[row, column], column / shape[1], row / shape[0]
        return Largest(*found)

    def _shape_at(self, depth: float) -> tuple[int, ...]:
        first, least = self.parts[0], _LEAST if len(self.parts) > 1 else 1
        kept = waves_kept(first.shape, depth, first.periods)
        needed = (max(ceil((2 * k + 2) / period), least) for k, period in zip(kept, first.periods, strict=True))
        return tuple(min(n, some) for n, some in zip(self.shape, needed, strict=True))

    def _plane(self, depth: float, names: tuple[str, ...], shape: tuple[int, ...]) -> Reals:
        first, *others = self.parts
        grid_of_first = tuple(round(period) * n for period, n in zip(first.periods, shape, strict=True))
        grids = grid_of_first, *(part.shape for part in others)
        parts = zip(self.parts, grids, strict=True)
        spectra = (spectrum_of_plane(part, depth, self.body, names, waves) for part, waves in parts)
        return self._sum(spectra, dict(enumerate(shape)), names)

    def _sum(self, spectra: Iterator[Complexes], nodes: dict[int, int], names: tuple[str, ...]) -> Reals:
        """Named fields `[field, ...]` on so many nodes along axes 0 (y) and 1 (x), of the coefficients of each part.

        The first part has a grid there.
        """
        first, *others = self.parts
        window = (slice(None), *(slice(n) for n in nodes.values()))
        found = grid.signal(next(spectra), *(round(first.periods[i]) * n for i, n in nodes.items()))[window]
        for part, spectrum in zip(others, spectra, strict=True):
            found += grid.signal_at(spectrum, *(np.arange(n) / n / part.periods[i] for i, n in nodes.items()))
        for i, name in enumerate(names):
            if name in DISPLACEMENTS:
                found[i] += self.uniform[DISPLACEMENTS.index(name)]
        return found


def von_mises(stress1: Reals, stress2: Reals, stress3: Reals, *shear: Reals) -> Reals:
    """Equivalent stress of the three normal stresses and the shear stresses: one in a plane problem, else three."""
    squares = 0.5 * ((stress1 - stress2) ** 2 + (stress2 - stress3) ** 2 + (stress3 - stress1) ** 2)
    for each in shear:
        squares += 3.0 * each**2
    return np.asarray(np.sqrt(squares))


def waves_kept(shape: tuple[int, ...], depth: float, periods: tuple[float, float] = _ONE) -> tuple[int, int]:
    """Largest k_y and k_x that are felt at a depth."""
    felt = _FADED / (2.0 * np.pi * depth) if depth > 0.0 else np.inf
    most_y, most_x = (int(min(n // 2, max(felt * period, 1.0))) for n, period in zip(shape, periods, strict=True))
    return most_y, most_x


def depth_of(z: float, body: ElasticBody) -> float:
    """Depth below the surface; raises ValueError for z outside the body."""
    if not (np.isfinite(z) and z >= body.base_z * (1.0 + 1e-12) and z <= 0.0):
        raise ValueError("z outside the body")
    return max(-float(z), 0.0)


def spectrum_at_y(
    surface: LoadedSurface, depth: float, body: ElasticBody, y: float, names: tuple[str, ...]
) -> Complexes:
    """Coefficients `[field, k_x]` of named fields on a line y (in periods) at a depth."""
    spectrum = np.zeros((len(names), surface.shape[1] // 2 + 1), dtype=np.complex128)
    for k_y, k_x, waves in surface.waves(depth, body, names):
        spectrum[:, : k_x.size] += np.exp(2j * np.pi * k_y * y) @ waves
    return spectrum


def spectrum_at_x(
    surface: LoadedSurface, depth: float, body: ElasticBody, x: float, names: tuple[str, ...]
) -> Complexes:
    """Coefficients `[field, k_y]` of named fields on a line x (in periods) at a depth."""
    ny, nx = surface.shape
    spectrum = np.zeros((len(names), ny), dtype=np.complex128)
    for k_y, k_x, waves in surface.waves(depth, body, names):
        weights = grid.multiplicity(nx)[k_x] * np.exp(2j * np.pi * k_x * x)
        for half in (k_y >= 0, k_y < 0):  # both Nyquist rows are one of the spectrum
            spectrum[:, k_y[half] % ny] += (waves @ weights)[:, half]
    mirrored = np.roll(spectrum[:, ::-1], 1, axis=1).conj()  # the real part is the mean with waves of the other sign
    return np.asarray(0.5 * (spectrum + mirrored)[:, : ny // 2 + 1])


def spectrum_of_plane(
    surface: LoadedSurface, depth: float, body: ElasticBody, names: tuple[str, ...], shape: tuple[int, ...]
) -> Complexes:
    """Coefficients `[field, k_y, k_x]` of named fields at a depth, rows as those of a grid of a shape."""
    spectrum = np.zeros((len(names), shape[0], shape[1] // 2 + 1), dtype=np.complex128)
    for k_y, k_x, waves in surface.waves(depth, body, names):
        for half in (k_y >= 0, k_y < 0):
            spectrum[:, k_y[half] % shape[0], : k_x.size] += waves[:, half]
    return spectrum


def _transfer(q: Reals, depth: float, body: ElasticBody) -> Reals:
    """Wave number, and the response at a depth to unit displacements of the surface, `[11, q]`, 0 for the mean.

    For displacements along q and out of the surface these are U_1, U_3, P and W (2.4), in pairs; for displacements
    across q, the displacement and its slope over q.
    """
    found = np.zeros((11, q.size))
    found[0] = q
    waves = body.layers.transfer(depth, q[1:])
    pairs = waves.u1, waves.u3, waves.p, waves.w, body.layers.transfer_across(depth, q[1:])
    found[1:, 1:] = [each for pair in pairs for each in pair]
    return found


def _turned(
    surface: Surface,
    transfer: Reals,
    chosen: tuple[Indices, ...],
    waves: tuple[Indices, Indices],
    material: Material,
    names: tuple[str, ...],
) -> Complexes:
    """Named fields `[field, k_y, k_x]` at a depth, along x, y and z, of the waves that are `chosen`."""
    (c, s), shear = _unit_vectors(*waves, surface.periods), material.shear
    kolosov = float(moduli.kolosov(material.poissons_ratio))
    q, pairs = transfer[0], transfer[1:9].reshape(4, 2, *transfer.shape[1:])
    cosine, sine = surface.along[chosen], 1j * surface.out[chosen]  # a term X sin(qx) has the coefficient -i X
    u1, u3, p, w = (first * cosine + second * sine for first, second in pairs)
    across, slope = transfer[9:] * surface.across[chosen]
    found: dict[str, Complexes] = {}
    # q runs along q, t across it
    stretch, slide_qz, slide_qt, slide_tz = (
        1j * q * u1,
        q * (2.0 * u3 + (kolosov + 1.0) * w),
        1j * q * across,
        q * slope,
    )
    if not set(names).isdisjoint(DISPLACEMENTS):
        found |= zip(DISPLACEMENTS, (c * u1 - s * across, s * u1 + c * across, -1j * u3), strict=True)
    if not set(names).isdisjoint(STRAINS):
        rise = -1j * q * (u1 + (kolosov - 1.0) * p)
        strains = _tensor(c, s, stretch, 0.0, rise, 0.5 * slide_tz, 0.5 * slide_qz, 0.5 * slide_qt)
        found |= zip(STRAINS, (*strains[:3], *(2.0 * each for each in strains[3:])), strict=True)
    if not set(names).isdisjoint(STRESSES):
        equal = -1j * shear * q * (3.0 - kolosov) * p
        normal = -1j * shear * q * (2.0 * u1 + (kolosov + 1.0) * p)
        slides = (shear * each for each in (slide_tz, slide_qz, slide_qt))
        found |= zip(STRESSES, _tensor(c, s, equal + 2.0 * shear * stretch, equal, normal, *slides), strict=True)
    return np.stack([found[name] for name in names])


def _tensor(
    c: Reals, s: Reals, qq: Complexes, tt: Complexes | float, zz: Complexes, tz: Complexes, qz: Complexes, qt: Complexes
) -> tuple[Complexes, ...]:
    """Elements in Voigt's order along x, y and z of a symmetric tensor along q, across it (t) and z."""
    twist = 2.0 * c * s * qt
    x, y = c**2 * qq + s**2 * tt - twist, s**2 * qq + c**2 * tt + twist
    return x, y, zz, s * qz + c * tz, c * qz - s * tz, c * s * (qq - tt) + (c**2 - s**2) * qt


def _means(surface: Surface, depth: float, body: ElasticBody) -> dict[str, float]:
    """The uniform part: tractions do not change with depth, the periodic body cannot widen."""
    (u1, u2, u3), (t1, t2, t3) = surface.uniform, surface.traction
    material, (sheared, stretched) = body.material(depth), body.layers.uniform_compliance(depth)
    nu = material.poissons_ratio
    displacements = (u1 - t1 * sheared, u2 - t2 * sheared, u3 - t3 * stretched)
    strains = (0.0, 0.0, t3 / material.c11, t2 / material.shear, t1 / material.shear, 0.0)
    stresses = (nu / (1.0 - nu) * t3, nu / (1.0 - nu) * t3, t3, t2, t1, 0.0)
    return dict(zip(DISPLACEMENTS + STRAINS + STRESSES, displacements + strains + stresses, strict=True))


def _all_waves(shape: tuple[int, ...]) -> tuple[Indices, Indices]:
    half = shape[0] // 2
    return np.concatenate((np.arange(half + 1), np.arange(-half, 0))), np.arange(shape[1] // 2 + 1)


def _magnitudes(shape: tuple[int, ...], periods: tuple[float, float]) -> tuple[Reals, Indices]:
    """Different magnitudes of the wave vectors, and where each wave's is; many waves have one magnitude."""
    k_y, k_x = _all_waves(shape)
    squares, places = np.unique((k_y[:, np.newaxis] / periods[0]) ** 2 + (k_x / periods[1]) ** 2, return_inverse=True)
    return 2.0 * np.pi * np.sqrt(squares), places.reshape(k_y.size, k_x.size)


def _unit_vectors(k_y: Indices, k_x: Indices, periods: tuple[float, float]) -> tuple[Reals, Reals]:
    """Cosine and sine `[k_y, k_x]` of the direction of each wave vector, zero for the mean."""
    along_y, along_x = k_y[:, np.newaxis] / periods[0], k_x / periods[1]
    magnitude = np.hypot(along_y, along_x)
    magnitude[magnitude == 0.0] = 1.0
    return along_x / magnitude, along_y / magnitude


def _along_waves(
    waves: Complexes, shape: tuple[int, ...], periods: tuple[float, float]
) -> tuple[Complexes, Complexes, Complexes]:
    """Coefficients `[component, k_y, k_x]` along each wave vector, across it and out, rows as in `Surface`.

    Of the Nyquist wave of even ny half is at ny/2 and half at -ny/2.
    """
    k_y, k_x = _all_waves(shape)
    found = waves[:, k_y % shape[0]]
    if shape[0] % 2 == 0:
        found[:, abs(k_y) == shape[0] // 2] *= 0.5
    c, s = _unit_vectors(k_y, k_x, periods)
    return c * found[0] + s * found[1], c * found[1] - s * found[0], found[2]


def _three(values: Reals) -> tuple[float, float, float]:
    x, y, z = map(float, values)
    return x, y, z
