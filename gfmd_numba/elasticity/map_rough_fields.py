"""Fields inside a body whose surface is a map that is not flat, order by order in its heights.

As in `topography.py`, points have labels (x, y, z), their places in the flat body, and the displacement u'' that formed
the topography takes them to their places in the rough one. The field of each order is continued from the label to that
place, a Taylor series in u'': the derivatives along z of a state follow from its waves (`map_topography.Planes`).
One plane at a time is in memory, with the waves that are felt there. Lengths in L_x, stresses in E*.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import accumulate
from math import factorial

import numpy as np

from gfmd_numba.arrays import Complexes, Indices, Reals
from gfmd_numba.elasticity import map_fields, topography
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.layer import Material
from gfmd_numba.elasticity.map_fields import DISPLACEMENTS, STRESSES, MapSurface, waves_kept
from gfmd_numba.elasticity.map_topography import Planes, band, finer, on_finer_grid, tractions_of_orders
from gfmd_numba.fourier import grid

_STATE = ("u1", "u2", "u3", "stress5", "stress4", "stress3")


@dataclass(frozen=True)
class RoughSurface:
    """Surface of the flat body that a rough one is continued from: under its load, what each order from 1 on adds.

    `formed` is the surface as the topography was formed.
    """

    flat: MapSurface
    orders: tuple[MapSurface, ...]
    formed: MapSurface

    @property
    def shape(self) -> tuple[int, ...]:
        """Nodes along y and x."""
        return self.flat.shape


LoadedMap = MapSurface | RoughSurface


def rough_surface(tractions: Reals, heights: Reals, body: ElasticBody, order: int) -> RoughSurface:
    """Surface of a body with a topography `[y, x]` of zero mean under tractions `[component, y, x]`, to an order."""
    added = tractions_of_orders(-tractions[2], heights, body, order, tractions[:2])
    return RoughSurface(
        map_fields.surface_under_tractions(tractions, body),
        tuple(map_fields.surface_under_waves(waves, heights.shape, body) for waves in added),
        map_fields.formed_surface(heights),
    )


def waves_at_depth(
    surface: LoadedMap, depth: float, body: ElasticBody, names: tuple[str, ...]
) -> Iterator[tuple[Indices, Indices, Complexes]]:
    """Waves k_y `[row]` and k_x, and coefficients `[field, row, k_x]` of the named fields, to be added up."""
    if isinstance(surface, MapSurface):
        yield from map_fields.waves_at_depth(surface, depth, body, names)
        return
    yield from map_fields.waves_at_depth(surface.flat, depth, body, names)
    most_y, most_x = waves_kept(surface.shape, depth)
    shape = min(surface.shape[0], 2 * most_y + 2), min(surface.shape[1], 2 * most_x + 2)
    found = _added(surface, depth, body, names, shape)
    yield grid.wave_indices(shape)[0].ravel(), np.arange(most_x + 1), found[..., : most_x + 1]


def _added(
    surface: RoughSurface, depth: float, body: ElasticBody, names: tuple[str, ...], shape: tuple[int, ...]
) -> Complexes:
    """What the orders from 1 on add to named fields, coefficients `[field, k_y, k_x]` on a grid of a shape."""
    order, planes = len(surface.orders), Planes.of(shape, body.material(depth))
    fine = finer(shape, order)
    former = topography.forming(body, order)
    formed = _spectra(surface.formed, min(depth, -former.base), former, DISPLACEMENTS, shape)
    u1, u2, u3 = (on_finer_grid(each, fine) for each in formed)
    states = [_spectra(each, depth, body, _STATE, shape) for each in (surface.flat, *surface.orders)]
    changing = [planes.derivatives_in_z(state, order - n) for n, state in enumerate(states)]
    stresses = STRESSES if set(names) - set(DISPLACEMENTS) else ()
    wanted = (*(name for name in DISPLACEMENTS if name in names), *stresses)
    of_higher_orders = sum(states[2:], states[1])
    found = {name: _of_state(planes, of_higher_orders, name) for name in wanted}
    raised: Reals | float = 1.0  # u3^m / m!
    for m in range(order + 1):
        sums = list(accumulate(next(each) for each in changing[: order - m + 1]))  # of all orders up to each
        for name in found:  # one by one: the finer grid takes most of the memory
            total = np.zeros(fine)
            for t in range(0 if m else 1, order - m + 1):
                waves = _of_state(planes, sums[order - m - t], name)
                for a in range(t + 1):
                    weight = u1**a * u2 ** (t - a) / (factorial(a) * factorial(t - a))
                    moved = (1j * planes.qx) ** a * (1j * planes.qy) ** (t - a) * waves
                    total += weight * on_finer_grid(moved, fine)
            found[name] = found[name] + band(raised * total, shape)
        raised = raised * u3 / (m + 1)
    return np.stack([_named(name, found, planes.material) for name in names])


def _spectra(
    surface: MapSurface, depth: float, body: ElasticBody, names: tuple[str, ...], shape: tuple[int, ...]
) -> Complexes:
    """Named fields of a flat body, coefficients `[field, k_y, k_x]` on a grid of a shape without its Nyquist waves."""
    ny, nx = shape
    found = np.zeros((len(names), ny, nx // 2 + 1), dtype=np.complex128)
    for k_y, k_x, waves in map_fields.waves_at_depth(surface, depth, body, names):
        rows, columns = np.flatnonzero(2 * abs(k_y) < ny), k_x[2 * k_x < nx]
        found[:, k_y[rows, np.newaxis] % ny, columns] = waves[:, rows[:, np.newaxis], columns]
    return found


def _of_state(planes: Planes, state: Complexes, name: str) -> Complexes:
    """A displacement or stress of a state on the same plane."""
    if name in _STATE:
        return np.asarray(state[_STATE.index(name)])
    return planes.stresses(state)[("stress1", "stress6", "stress2").index(name)]


def _named(name: str, found: Mapping[str, Complexes], material: Material) -> Complexes:
    """A field by displacements and stresses; a strain by Hooke's law."""
    if name in found:
        return found[name]
    stress = found[name.replace("strain", "stress")]
    if name in ("strain4", "strain5", "strain6"):
        return stress / material.shear
    nu = material.poissons_ratio
    total = found["stress1"] + found["stress2"] + found["stress3"]
    return np.asarray((stress - nu / (1.0 + nu) * total) / (2.0 * material.shear))
