"""A body whose stress-free surface is a map that is not flat: order 0 in its slope, and how much order 1 would add.

`topography.py` has the method for profiles. On maps a traction on the plane z = 0 obeys, to first order in the heights,

    s_b = t_b + sum_a d/dx_a (h sigma_ab),    a = x, y,    b = x, y, z,

under a traction t on the true surface z = h. Lengths in L_x, stresses in E*.
"""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid


@dataclass(frozen=True)
class MapResponse:
    """What the topography adds to the response of a flat body: `u3` `[y, x]`, the normal displacement of the surface.

    `highest_order` is the largest part of it that is of the highest order.
    """

    u3: Reals
    highest_order: float


def respond(
    pressure: Reals, heights: Reals, body: ElasticBody, order: int, tangential: Reals | None = None
) -> MapResponse:
    """Response of a body with topography `[y, x]` of zero mean to a pressure `[y, x]`, to order 0 or 1.

    `tangential` is a traction `[component, y, x]` beside it. Of a layered body only the topmost material is known.
    """
    if order == 0 or not heights.any():
        return MapResponse(np.zeros_like(heights), 0.0)
    along = np.zeros((2, *heights.shape)) if tangential is None else tangential
    added = _first_order(np.array([*along, -pressure]), heights, body)
    return MapResponse(added, float(abs(added).max()))


def flat_displacement(normal: Reals, body: ElasticBody) -> Reals:
    """Normal displacement `[y, x]` of a flat body under a traction out of it alone; zero mean on a half-space."""
    q = grid.magnitudes(normal.shape)
    s33 = body.compliance_along(q.ravel()).s33.reshape(q.shape)
    return grid.signal(s33 * grid.coefficients(normal, 2), *normal.shape)


def flat_displacements(traction: Reals, body: ElasticBody) -> Reals:
    """Displacements `[component, y, x]` of a flat body under tractions of that shape, along x, y and out of it.

    They have zero mean on a half-space.
    """
    shape = traction.shape[1:]
    waves = np.array([grid.coefficients(each, 2) for each in traction])
    moved = _displaced(waves, body.coupled_stiffness_of_map(shape).compliance())
    return np.array([grid.signal(each, *shape) for each in moved])


def _displaced(traction: Complexes, compliance: Reals) -> Complexes:
    """Coefficients of the displacements `[component, ny, nx // 2 + 1]` under those of the tractions."""
    xx, xy, yy, xz, yz, zz = compliance
    x, y, z = traction
    return np.array([xx * x + xy * y + 1j * xz * z, xy * x + yy * y + 1j * yz * z, zz * z - 1j * (xz * x + yz * y)])


def _first_order(traction: Reals, heights: Reals, body: ElasticBody) -> Reals:
    shape, nu = heights.shape, body.material(0.0).poissons_ratio
    qy, qx = grid.wavevectors(shape, (1.0, 1.0))
    q = (1j * qx, 1j * qy)
    compliance = body.coupled_stiffness_of_map(shape).compliance()
    h = _on_finer_grid(_band(heights, shape), shape)
    waves = np.array([_band(each, shape) for each in traction])
    moved = _displaced(waves, compliance)
    strain = q[0] * moved[0] + q[1] * moved[1]  # in the plane of the surface
    equal = nu / (1.0 - nu) * waves[2] + nu * strain  # part of both normal stresses along the surface
    carried = np.zeros_like(waves)
    for a in (0, 1):
        for b in (0, 1):
            stress = (equal if a == b else 0.0) + 0.5 * (1.0 - nu) * (q[a] * moved[b] + q[b] * moved[a])
            carried[b] += q[a] * _band(h * _on_finer_grid(stress, shape), shape)
        carried[2] += q[a] * _band(h * _on_finer_grid(waves[a], shape), shape)
    squeezed = waves[2] / moduli.c11(nu) - nu / (1.0 - nu) * strain  # strain_33
    up = _displaced(carried, compliance)[2] + _band(h * _on_finer_grid(squeezed, shape), shape)
    return grid.signal(up, *shape)


def _on_finer_grid(waves: Complexes, shape: tuple[int, ...]) -> Reals:
    """Samples on a grid half as fine again, on which products of two factors are free of aliasing."""
    finer = tuple(-(-3 * n // 2) for n in shape)
    padded = np.zeros((finer[0], finer[1] // 2 + 1), dtype=np.complex128)
    padded[grid.wave_indices(shape)] = waves
    return grid.signal(padded, *finer)


def _band(samples: Reals, shape: tuple[int, ...]) -> Complexes:
    """Coefficients of the waves of a grid of this shape, without the Nyquist waves."""
    kept = grid.coefficients(samples, 2)[grid.wave_indices(shape)].copy()
    if shape[0] % 2 == 0:
        kept[shape[0] // 2] = 0.0
    if shape[1] % 2 == 0:
        kept[:, -1] = 0.0
    return kept
