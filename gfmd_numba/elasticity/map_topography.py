"""A body whose stress-free surface is a map that is not flat: order 0 in its slope, and how much order 1 would add.

`topography.py` has the method for profiles. On maps a traction on the plane z = 0 obeys, to first order in the heights,

    s_b = sum_a d/dx_a (h sigma_ab),    a, b = x, y,

under a pressure on the true surface z = h. The tangential displacement under a pressure lies along the wave vector, and
of the traction s only the part along the wave vector moves the surface up, so that the compliance of a profile of the
wave number |q| is all that is needed. Lengths in L_x, stresses in E*.
"""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.compliance import Compliance
from gfmd_numba.fourier import grid


@dataclass(frozen=True)
class MapResponse:
    """What the topography adds to the response of a flat body: `u3` `[y, x]`, the normal displacement of the surface.

    `highest_order` is the largest part of it that is of the highest order.
    """

    u3: Reals
    highest_order: float


def respond(pressure: Reals, heights: Reals, body: ElasticBody, order: int) -> MapResponse:
    """Response to a pressure `[y, x]` of a body with topography `[y, x]` of zero mean, to order 0 or 1."""
    if order == 0 or not heights.any():
        return MapResponse(np.zeros_like(heights), 0.0)
    added = _first_order(pressure, heights, body)
    return MapResponse(added, float(abs(added).max()))


def flat_displacement(normal: Reals, body: ElasticBody) -> Reals:
    """Normal displacement `[y, x]` of a flat body under a traction out of it; zero mean on a half-space."""
    return grid.signal(_compliance(normal.shape, body).s33 * grid.coefficients(normal, 2), *normal.shape)


def _compliance(shape: tuple[int, ...], body: ElasticBody) -> Compliance:
    q = grid.magnitudes(shape)
    found = body.compliance_along(q.ravel())
    return Compliance(found.s11.reshape(q.shape), found.s13.reshape(q.shape), found.s33.reshape(q.shape))


def _first_order(pressure: Reals, heights: Reals, body: ElasticBody) -> Reals:
    shape, nu = heights.shape, body.nu
    q, components = grid.magnitudes(shape), grid.wavevectors(shape, (1.0, 1.0))
    compliance = _compliance(shape, body)
    h = _on_finer_grid(_band(heights, shape), shape)
    stress3 = -_band(pressure, shape)
    along = compliance.displacements(np.zeros_like(stress3), stress3)[0]
    strain = 1j * q * along  # strain_ab is q_a q_b / q^2 of it, and their trace this
    directions = [np.divide(each, q, out=np.zeros_like(q), where=q > 0.0) for each in components]
    equal = nu / (1.0 - nu) * stress3 + nu * strain  # part of both normal stresses along the surface
    pulled = np.zeros_like(strain)
    for a, across in enumerate(directions):
        for b, other in enumerate(directions):
            stress = (equal if a == b else 0.0) + (1.0 - nu) * across * other * strain
            carried = _band(h * _on_finer_grid(stress, shape), shape)
            pulled += other * 1j * components[a] * carried
    squeezed = stress3 / moduli.c11(nu) - nu / (1.0 - nu) * strain  # strain_33
    up = compliance.displacements(pulled, np.zeros_like(pulled))[1]
    return grid.signal(up + _band(h * _on_finer_grid(squeezed, shape), shape), *shape)


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
