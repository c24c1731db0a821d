"""A body whose stress-free surface is a map that is not flat: its response to a pressure, order by order in heights.

`topography.py` has the method for profiles; here are its terms along x and y. With s the traction on the plane z = 0,
on which the flat body is known, the traction t on the surface z = h(x, y), per area of the plane, is

    t_i = s_i - sum_a d/dx_a integral from 0 to h of sigma_ia dz,    a = x, y,

and that and the displacement at z = h are Taylor series about z = 0 of the state (u, sigma_13, sigma_23, sigma_33),
which obeys a linear equation in z with derivatives along x and y only. The Nyquist waves stay at order 0.
Lengths in L_x, stresses in E*.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import factorial

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.compliance import Compliance
from gfmd_numba.elasticity.layer import Material
from gfmd_numba.fourier import grid

_OUT = (2,)  # component of a state that is followed where no traction acts along the surface
_ALL = (0, 1, 2)


@dataclass(frozen=True)
class MapResponse:
    """What the topography adds to the displacement of a flat body's surface, normal `[y, x]` and along it `[2, y, x]`.

    `along` is None where no traction acts along the surface: no node is held there. `highest_order` is the largest part
    of all these that is of the highest order.
    """

    u3: Reals
    along: Reals | None
    highest_order: float


def respond(
    pressure: Reals, heights: Reals, body: ElasticBody, order: int, tangential: Reals | None = None
) -> MapResponse:
    """Response of a body with topography `[y, x]` of zero mean to a pressure `[y, x]`, to an order of 0 or more.

    `tangential` is a traction `[component, y, x]` that acts too; all are per area of the plane. Interfaces of
    layers are flat.
    """
    followed = _OUT if tangential is None else _ALL
    added, highest_order = np.zeros((len(followed), *heights.shape)), 0.0
    if order > 0 and heights.any():
        fine = finer(heights.shape, order)
        powers = _powers(heights, order, fine)
        derivatives = _states(pressure, powers, body, order, tangential)
        for total in range(1, order + 1):
            of_order = np.empty_like(added)
            for i, component in enumerate(followed):  # one by one: the finer grid takes most of the memory
                lifted = np.zeros(fine)
                for m in range(total + 1):
                    lifted += powers[m] * on_finer_grid(derivatives[total - m][m][component], fine)
                of_order[i] = grid.signal(band(lifted, heights.shape), *heights.shape)
            added += of_order
        highest_order = float(abs(of_order).max())
    return MapResponse(added[-1], None if tangential is None else added[:2], highest_order)


def tractions_of_orders(
    pressure: Reals, heights: Reals, body: ElasticBody, order: int, tangential: Reals
) -> tuple[Complexes, ...]:
    """Coefficients `[component, k_y, k_x]` of what the flat body bears on z = 0 at each order, from 1 on."""
    powers = _powers(heights, order, finer(heights.shape, order))
    derivatives = _states(pressure, powers, body, order, tangential)
    return tuple(of_order[0][3:] for of_order in derivatives[1:])


def flat_displacement(normal: Reals, body: ElasticBody) -> Reals:
    """Normal displacement `[y, x]` of a flat body under a traction out of it alone; zero mean on a half-space."""
    return grid.signal(_compliance(normal.shape, body).s33 * grid.coefficients(normal, 2), *normal.shape)


def _powers(heights: Reals, order: int, fine: tuple[int, ...]) -> list[Reals]:
    """Powers of the topography over their factorials, on a finer grid."""
    topography = on_finer_grid(band(heights, heights.shape), fine)
    return [topography**m / factorial(m) for m in range(order + 1)]


def _states(
    pressure: Reals, powers: list[Reals], body: ElasticBody, order: int, tangential: Reals | None
) -> list[list[Complexes]]:
    """States on z = 0 of each order, and of each its derivatives in z up to the highest that counts."""
    shape, fine = pressure.shape, powers[0].shape
    planes, flat = Planes.of(shape, body.material(0.0)), _FlatBody.of(shape, body)
    along = np.zeros((2, *shape)) if tangential is None else tangential
    traction = np.stack([band(each, shape) for each in (*along, -pressure)])
    derivatives: list[list[Complexes]] = []
    for n in range(order + 1):
        if n > 0:
            traction = planes.divergence(_carried(planes, derivatives, powers, n, fine))
        state = np.concatenate((flat.displacements(traction), traction))
        derivatives.append(list(planes.derivatives_in_z(state, order - n)))
    return derivatives


def _carried(
    planes: "Planes", derivatives: list[list[Complexes]], powers: list[Reals], n: int, fine: tuple[int, ...]
) -> Complexes:
    """Forces of order n along x and y, per length, of the material between z = 0 and the surface, by stresses."""
    orders = [(powers[m], planes.stresses(derivatives[n - m][m - 1])) for m in range(1, n + 1)]
    found = []
    for i in range(5):  # one by one: the finer grid takes most of the memory
        of_stress = sum((power * on_finer_grid(stresses[i], fine) for power, stresses in orders), np.zeros(fine))
        found.append(band(of_stress, planes.shape))
    return np.stack(found)


@dataclass(frozen=True)
class _FlatBody:
    """Compliance `[k_y, k_x]` of the surface of a flat body."""

    q: Reals
    qy: Reals
    qx: Reals
    compliance: Compliance
    across: Reals

    @classmethod
    def of(cls, shape: tuple[int, ...], body: ElasticBody) -> "_FlatBody":
        q = grid.magnitudes(shape)
        across = np.zeros_like(q)
        across[q > 0.0] = body.compliance_across(q[q > 0.0])
        qy, qx = grid.wavevectors(shape, (1.0, 1.0))
        return cls(q, qy, qx, _compliance(shape, body), across)

    def displacements(self, traction: Complexes) -> Complexes:
        """Displacements `[component, k_y, k_x]` under tractions on z = 0; waves across q shear the body."""
        t1, t2, t3 = traction
        c, s = (np.divide(each, self.q, out=np.zeros_like(self.q), where=self.q > 0.0) for each in (self.qx, self.qy))
        along, out = self.compliance.displacements(c * t1 + s * t2, t3)
        sideways = self.across * (c * t2 - s * t1)
        return np.stack([c * along - s * sideways, s * along + c * sideways, out])


@dataclass(frozen=True)
class Planes:
    """States on planes of constant z `[component, k_y, k_x]`: u_1, u_2, u_3, sigma_13, sigma_23 and sigma_33."""

    shape: tuple[int, ...]
    material: Material
    qy: Reals
    qx: Reals

    @classmethod
    def of(cls, shape: tuple[int, ...], material: Material) -> "Planes":
        """Planes of maps of this shape in a material."""
        qy, qx = grid.wavevectors(shape, (1.0, 1.0))
        return cls(shape, material, qy, qx)

    def stresses(self, state: Complexes) -> tuple[Complexes, ...]:
        """Stresses 11, 12, 22, 13 and 23 of a state."""
        u1, u2, _, s5, s4, s3 = state
        stretch1, stretch2 = 1j * self.qx * u1, 1j * self.qy * u2
        nu, shear = self.material.poissons_ratio, self.material.shear
        equal = nu / (1.0 - nu) * s3 + self.material.modulus * nu * (stretch1 + stretch2)
        twist = shear * 1j * (self.qy * u1 + self.qx * u2)
        return equal + 2.0 * shear * stretch1, twist, equal + 2.0 * shear * stretch2, s5, s4

    def divergence(self, stresses: Complexes | tuple[Complexes, ...]) -> Complexes:
        """Divergence along x and y of stresses 11, 12, 22, 13 and 23: forces along x, y and z."""
        s1, s6, s2, s5, s4 = stresses
        pairs = ((s1, s6), (s6, s2), (s5, s4))
        return np.stack([1j * (self.qx * along_x + self.qy * along_y) for along_x, along_y in pairs])

    def derivatives_in_z(self, state: Complexes, highest: int) -> Iterator[Complexes]:
        """A state and its derivatives in z up to the highest, by strains and equilibrium."""
        yield state
        for _ in range(highest):
            u1, u2, u3, s5, s4, s3 = state
            strain = 1j * (self.qx * u1 + self.qy * u2)
            nu, shear = self.material.poissons_ratio, self.material.shear
            rise = s3 / self.material.c11 - nu / (1.0 - nu) * strain
            moved = (s5 / shear - 1j * self.qx * u3, s4 / shear - 1j * self.qy * u3, rise)
            state = np.stack([*moved, *-self.divergence(self.stresses(state))])
            yield state


def _compliance(shape: tuple[int, ...], body: ElasticBody) -> Compliance:
    q = grid.magnitudes(shape)
    found = body.compliance_along(q.ravel())
    return Compliance(found.s11.reshape(q.shape), found.s13.reshape(q.shape), found.s33.reshape(q.shape))


def finer(shape: tuple[int, ...], order: int) -> tuple[int, ...]:
    """Nodes of a grid on which products of order + 1 factors are free of aliasing within the waves of a shape."""
    return tuple(-(-(order + 2) * n // 2) for n in shape)


def on_finer_grid(waves: Complexes, fine: tuple[int, ...]) -> Reals:
    """Samples on a finer grid of waves without the Nyquist ones."""
    shape = waves.shape[0], 2 * waves.shape[1] - 2
    padded = np.zeros((fine[0], fine[1] // 2 + 1), dtype=np.complex128)
    padded[grid.wave_indices(shape)] = waves
    return grid.signal(padded, *fine)


def band(samples: Reals, shape: tuple[int, ...]) -> Complexes:
    """Coefficients of the waves of a grid of this shape, without the Nyquist waves."""
    return grid.without_nyquist(grid.coefficients(samples, 2)[grid.wave_indices(shape)], shape)
