"""Displacement, strain and stress inside a body without a period, under tractions on a window of its surface.

In a window of length 1 they are an integral over all wave vectors q of what `fields.py` finds of each wave. A sum over
the waves of a period P is that integral to all digits, if what is summed is smooth: beyond a distance of P - 1, where
the images of the window are, its kernel is then zero. Near q = 0 it is not smooth, as bodies give way like 1/|q|. So
the sum over the waves of P = 2 has the share 1 - X(q) alone, where X((P - 1) q) falls from 1 to 0 around some waves.
The share X(q) - X(3 q) is summed over the few waves of P = 4, X(3 q) - X(7 q) over those of P = 8, and so on. What is
left in the end are waves so long that the displacement by them is uniform, and known: on profiles it is the logarithm
of the last period. Along an axis with a period, P stays 1: the longest waves are then those of a profile.

Each sum is one of periodic tractions, all lengths in L_x and stresses in E*.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil

import numpy as np
from scipy.special import erfc

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.elasticity import fields
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.fields import DISPLACEMENTS, Axis, Largest, Surface
from gfmd_numba.elasticity.free_body import displaced_by_layers
from gfmd_numba.fourier import grid

_PERIOD = 2.0  # of the first sum, in windows
_FALLS, _WITHIN = 32.0, 8.0  # wave number (1/L_x) around which X falls, and half the way on which it does
_HIGHEST = _FALLS + 4.0 * _WITHIN  # beyond which X is below 1e-8
_SUMS = {
    1: 30,
    2: 18,
}  # by the axes that end: what stresses miss falls with the period, or its square
_LEAST = 64  # places along a side of a window where the largest stress is looked for


def _share(q: Reals, period: float) -> Reals:
    """X of wave numbers, in the sums of longer periods than this."""
    return np.asarray(0.5 * erfc(((period - 1.0) * q - _FALLS) / _WITHIN))


@dataclass(frozen=True)
class Free:
    """The inside of a body under tractions on a window of ny, nx nodes, as a sum of `parts`, each of its own periods.

    `uniform` are displacements along x, y and z that are left (L_x).
    """

    shape: tuple[int, ...]
    parts: tuple[Surface, ...]
    uniform: Reals
    body: ElasticBody

    def section(self, z: Reals, names: tuple[str, ...], across: Axis = "y", at: float = 0.0) -> Reals:
        """Named fields `[field, z, node]` on the vertical section x = at, or y = at (L_x), over the nodes along it."""
        spectrum, along = (fields.spectrum_at_x, 0) if across == "x" else (fields.spectrum_at_y, 1)
        nodes = np.arange(self.shape[along]) / self.shape[along]

        def on_line(depth: float) -> Reals:
            def of(part: Surface) -> Complexes:
                return spectrum(part, depth, self.body, at / part.periods[1 - along], names)

            return self._sum(of, {along: nodes}, names)

        return np.stack([on_line(fields.depth_of(each, self.body)) for each in z], axis=1)

    def plane(self, z: float, names: tuple[str, ...]) -> Reals:
        """Named fields `[field, y, x]` on the plane z, on the nodes of the window; ValueError for z outside it."""
        return self._plane(fields.depth_of(z, self.body), names, self.shape)

    def largest_von_mises(self, z: Reals) -> Largest:
        """Largest von Mises stress of the window on whole planes z `[z]`, on grids that resolve the waves there."""
        return fields.largest_of_planes(z, self.body, self._shape_at, self._plane)

    def _shape_at(self, depth: float) -> tuple[int, ...]:
        first = self.parts[0]
        places = max(max(fields.waves_kept(first.shape, depth, first.periods)) + 1, _LEAST)
        return tuple(min(n, places) for n in self.shape)

    def _plane(self, depth: float, names: tuple[str, ...], shape: tuple[int, ...]) -> Reals:
        first = self.parts[0]

        def of(part: Surface) -> Complexes:
            periods = part.periods
            waves = tuple(round(p) * n for p, n in zip(periods, shape, strict=True)) if part is first else part.shape
            return fields.spectrum_of_plane(part, depth, self.body, names, waves)

        return self._sum(of, {axis: np.arange(n) / n for axis, n in enumerate(shape)}, names)

    def _sum(self, of: Callable[[Surface], Complexes], places: dict[int, Reals], names: tuple[str, ...]) -> Reals:
        """Named fields `[field, ...]` at places (L_x) along axes 0 (y) and 1 (x), of the parts' coefficients.

        The first part has a grid there.
        """
        first, *others = self.parts
        window = (slice(None), *(slice(each.size) for each in places.values()))
        found = grid.signal(of(first), *(round(first.periods[i]) * each.size for i, each in places.items()))[window]
        for part in others:
            found += grid.signal_at(of(part), *(each / part.periods[i] for i, each in places.items()))
        for i, name in enumerate(names):
            if name in DISPLACEMENTS:
                found[i] += self.uniform[DISPLACEMENTS.index(name)]
        return found


def under_tractions(tractions: Reals, body: ElasticBody, ends: tuple[bool, ...] = ()) -> Free:
    """Inside of a body under tractions `[component, (y,) x]` (E*), along its surface and out of it, of a window.

    The window `ends` along (y,) x, or along all axes.
    """
    rows, ends = fields.in_rows(tractions), ends or (True,) * (tractions.ndim - 1)
    shape, both = rows.shape[1:], ends if len(ends) > 1 else (False, *ends)
    parts: list[Surface] = []
    shorter, period = 1.0, _PERIOD
    for _ in range(_SUMS[sum(both)]):
        periods = period if both[0] else 1.0, period if both[1] else 1.0
        waves = tuple(round(each) * n for each, n in zip(periods, shape, strict=True))
        if parts:  # fewer waves are left
            most = [2 * ceil(_HIGHEST / (shorter - 1.0) * each / (2.0 * np.pi)) for each in periods]
            waves = tuple(min(some, n) for some, n in zip(most, waves, strict=True))
        q = grid.magnitudes(waves, periods)
        loaded = grid.coefficients_of_window(rows, waves, periods) if parts else _padded(rows, waves)
        share = (_share(q, shorter) if parts else 1.0) - _share(q, period)
        parts.append(fields.surface_under_waves(share * loaded, waves, body, periods))
        shorter, period = period, 2.0 * period
    return Free(shape, tuple(parts), _left(rows, body, both, shorter), body)


def _padded(rows: Reals, shape: tuple[int, ...]) -> Complexes:
    padded = np.zeros((len(rows), *shape))
    padded[:, : rows.shape[1], : rows.shape[2]] = rows
    return grid.coefficients(padded, 2)


def _left(rows: Reals, body: ElasticBody, ends: tuple[bool, ...], period: float) -> Reals:
    """Displacement along x, y and z `[component]` in all waves of a half-space that are longer than those of the sums.

    They feel the base of layers alone. Under a line load the surface is displaced by zero at a distance of one window.
    """
    force = rows.mean(axis=(1, 2))
    if body.aspect_ratio is not None:
        return np.zeros(3)
    base = body.material(np.inf)
    along, across = 1.0 / base.modulus, 0.5 / base.shear
    if all(ends):
        softness = np.array([along + across, along + across, 2.0 * along])
        return np.asarray(_FALLS / (period - 1.0) / (2.0 * np.pi) * force * softness)
    nodes, weights = np.polynomial.hermite.hermgauss(12)
    of_share = float(weights @ np.log(_FALLS + _WITHIN * nodes)) / np.sqrt(np.pi) - np.log(period - 1.0)
    softness = np.array([along, across, along] if ends[1] else [across, along, along])
    by_layers = np.array([0.0, 0.0, displaced_by_layers(body)])
    return np.asarray((2.0 / np.pi * (np.euler_gamma + of_share) * softness - by_layers) * force)
