"""A body whose stress-free surface is not flat: its response to tractions, order by order in the topography.

Two-step GFMD (thesis chapter 5) forms the topography h by displacing a flat body by u'' (5.15), and lets the strains
of a later load superpose. That is order 0 here; its error is of the order of the slope. The higher orders continue the
field of a flat body to the true surface. With s the traction on the plane z = 0, on which the flat body is known, the
traction t on the surface z = h(x, y), per area of the plane, is

    t_i = s_i - sum_a d/dx_a integral from 0 to h of sigma_ia dz,    a = x, y,

and t and the displacement at z = h are Taylor series about z = 0. The state (u, sigma_13, sigma_23, sigma_33) obeys a
linear equation in z whose coefficients hold derivatives along x and y only, so that every order needs just transforms.
The terms of an order cancel but for the slope at waves far shorter than h; products are therefore taken on a finer
grid, free of aliasing. The Nyquist waves stay at order 0. A profile is a map of one row.

Points inside have labels (x, y, z), their places in the flat body; u'' takes them to the stress-free rough one. The
field of each order is continued from the label to that place, a Taylor series in u''. Of a layered body the field of
the topmost layer is continued: the topography is that of the surface alone, and the interfaces below are flat.
Lengths in L_x, stresses in E*.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import accumulate
from math import factorial

import numpy as np

from gfmd_numba.arrays import Complexes, Indices, Reals
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.fields import (
    DISPLACEMENTS,
    STRESSES,
    Axis,
    Inside,
    LoadedSurface,
    Surface,
    displaced_surface,
    in_rows,
    surface_under_tractions,
    surface_under_waves,
    waves_kept,
)
from gfmd_numba.elasticity.moduli import Material
from gfmd_numba.fourier import grid

_STATE = ("u1", "u2", "u3", "stress5", "stress4", "stress3")
_PLANE = ("stress1", "stress6", "stress2")  # stresses that a state tells by Hooke's law


@dataclass(frozen=True)
class Response:
    """Displacement that the topography adds to that of a flat body, normal `[(y,) x]` and along the surface.

    `along` `[component, (y,) x]` is None if it is not followed. `highest_order` is the largest displacement of the
    highest order alone.
    """

    u3: Reals
    along: Reals | None
    highest_order: float


def respond(
    pressure: Reals, heights: Reals, body: ElasticBody, order: int, tangential: Reals | None = None
) -> Response:
    """Response of a body with topography `[(y,) x]` of zero mean to a pressure `[(y,) x]`, to an order of 0 or more.

    `tangential` is a traction `[component, (y,) x]` that acts too, without which a map is not followed along its plane;
    all are per area of the plane. Interfaces of layers are flat.
    """
    rows = heights.reshape((1, *heights.shape)[-2:])
    sideways = np.zeros((heights.ndim, *heights.shape)) if tangential is None else tangential
    followed = (0, 2) if heights.ndim == 1 else (2,) if tangential is None else (0, 1, 2)
    added, highest_order = np.zeros((len(followed), *rows.shape)), 0.0
    if order > 0 and heights.any():
        powers = _powers(rows, order)
        derivatives = _states(in_rows(np.stack((*sideways, -pressure))), powers, body, order)
        for total in range(1, order + 1):
            of_order = np.empty_like(added)
            for i, component in enumerate(followed):  # one by one: the finer grid takes most of the memory
                lifted = np.zeros_like(powers[0])
                for n in range(total + 1):
                    m = total - n
                    lifted += powers[m] * _on_finer_grid(derivatives[n][m][component], lifted.shape)
                of_order[i] = grid.signal(_band(lifted, rows.shape), *rows.shape)
            added += of_order
        highest_order = float(abs(of_order).max())
    *along, out = added.reshape(len(followed), *heights.shape)
    return Response(out, np.stack(along) if along else None, highest_order)


def formed_surface(heights: Reals, body: ElasticBody) -> Surface:
    """Step 1: the surface of a flat body displaced by h along z, `[(y,) x]` of zero mean.

    Its stresses are those of the forces +q C11 M u'' that form the topography (5.15).
    """
    return displaced_surface(np.stack((*np.zeros((heights.ndim, *heights.shape)), heights)), body)


def forming(body: ElasticBody, order: int) -> ElasticBody:
    """Body that step 1 deforms, so that its displacements u'' take labels to places in the rough one.

    From order 1 on it is the topmost layer on a rigid base, as interfaces are flat: labels below it are places.
    """
    return body if order == 0 else body.top


def formed_at(
    heights: Reals, z: Reals, body: ElasticBody, order: int, names: tuple[str, ...], across: Axis = "y", at: float = 0.0
) -> Reals:
    """Displacements u'' `[component, z, node]` of these names on a section, as `Inside.section` has them."""
    former = forming(body, order)
    # labels below the body that was formed are places
    return Inside((formed_surface(heights, former),), former).section(np.maximum(z, former.base_z), names, across, at)


@dataclass(frozen=True)
class RoughSurface:
    """Surface of the flat body from which the rough one is continued, under its load, and the parts of further orders.

    `formed` is the surface as the topography was formed.
    """

    flat: Surface
    orders: tuple[Surface, ...]
    formed: Surface

    @property
    def shape(self) -> tuple[int, ...]:
        """Nodes along y and x."""
        return self.flat.shape

    @property
    def periods(self) -> tuple[float, float]:
        """Periods along y and x (L_x)."""
        return self.flat.periods

    def waves(
        self, depth: float, body: ElasticBody, names: tuple[str, ...]
    ) -> Iterator[tuple[Indices, Indices, Complexes]]:
        """Waves that are felt at a depth, as in `fields.LoadedSurface`."""
        yield from self.flat.waves(depth, body, names)
        kept = waves_kept(self.shape, depth)
        shape = tuple(min(n, 2 * k + 2) for n, k in zip(self.shape, kept, strict=True))
        found = _added(self, depth, body, names, shape)
        yield grid.wave_indices(shape)[0].ravel(), np.arange(kept[1] + 1), found[..., : kept[1] + 1]


def rough_surface(tractions: Reals, heights: Reals, body: ElasticBody, order: int) -> LoadedSurface:
    """Surface of a body with a topography `[(y,) x]` of zero mean under tractions `[component, (y,) x]`, to an order.

    Its fields are those at labels.
    """
    flat = surface_under_tractions(tractions, body)
    if order == 0:
        return flat
    rows = heights.reshape(flat.shape)
    states = _states(in_rows(tractions), _powers(rows, order), body, order)
    level = grid.signal(_band(rows, flat.shape), *flat.shape).reshape(heights.shape)
    return RoughSurface(
        flat,
        tuple(surface_under_waves(of_order[0][3:], flat.shape, body) for of_order in states[1:]),
        formed_surface(level, forming(body, order)),
    )


def _added(
    surface: RoughSurface, depth: float, body: ElasticBody, names: tuple[str, ...], shape: tuple[int, ...]
) -> Complexes:
    """What the orders from 1 on add to named fields, coefficients `[field, k_y, k_x]` on a grid of a shape."""
    order, planes = len(surface.orders), _Planes.of(shape, body.material(depth))
    fine, former = _finer(shape, order), forming(body, order)
    formed = _spectra(surface.formed, min(depth, -former.base_z), former, DISPLACEMENTS, shape)
    u1, u2, u3 = (_on_finer_grid(each, fine) for each in formed)
    states = [_spectra(each, depth, body, _STATE, shape) for each in (surface.flat, *surface.orders)]
    changing = [planes.derivatives_in_z(state, order - n) for n, state in enumerate(states)]
    stresses = STRESSES if set(names) - set(DISPLACEMENTS) else ()
    wanted = (*(name for name in DISPLACEMENTS if name in names), *stresses)
    of_higher_orders = sum(states[2:], states[1])
    found = {name: planes.field(of_higher_orders, name) for name in wanted}
    raised: Reals | float = 1.0  # u3^m / m!
    for m in range(order + 1):
        sums = list(accumulate(next(each) for each in changing[: order - m + 1]))  # of all orders up to each
        for name in found:  # one by one: the finer grid takes most of the memory
            total = np.zeros(fine)
            for t in range(0 if m else 1, order - m + 1):
                waves = planes.field(sums[order - m - t], name)
                for a in range(t + 1):
                    weight = u1**a * u2 ** (t - a) / (factorial(a) * factorial(t - a))
                    moved = (1j * planes.qx) ** a * (1j * planes.qy) ** (t - a) * waves
                    total += weight * _on_finer_grid(moved, fine)
            found[name] = found[name] + _band(raised * total, shape)
        raised = raised * u3 / (m + 1)
    return np.stack([_named(name, found, planes.material) for name in names])


def _spectra(
    surface: Surface, depth: float, body: ElasticBody, names: tuple[str, ...], shape: tuple[int, ...]
) -> Complexes:
    """Named fields of a flat body, coefficients `[field, k_y, k_x]` on a grid of a shape without its Nyquist waves."""
    ny, nx = shape
    found = np.zeros((len(names), ny, nx // 2 + 1), dtype=np.complex128)
    for k_y, k_x, waves in surface.waves(depth, body, names):
        rows, columns = np.flatnonzero(2 * abs(k_y) < ny), k_x[2 * k_x < nx]
        found[:, k_y[rows, np.newaxis] % ny, columns] = waves[:, rows[:, np.newaxis], columns]
    return found


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


def _states(tractions: Reals, powers: list[Reals], body: ElasticBody, order: int) -> list[list[Complexes]]:
    """States on z = 0 of each order, and of each its derivatives in z up to the highest that counts.

    `tractions` `[component, y, x]` are along the surface and out of the body.
    """
    shape = tractions.shape[1:]
    planes, flat = _Planes.of(shape, body.material(0.0)), body.response(shape)
    traction = np.stack([_band(each, shape) for each in tractions])
    derivatives: list[list[Complexes]] = []
    for n in range(order + 1):
        if n > 0:
            traction = planes.divergence(_carried(planes, derivatives, powers, n))
        state = np.concatenate((flat.displaced(traction), traction))
        derivatives.append(list(planes.derivatives_in_z(state, order - n)))
    return derivatives


def _carried(planes: "_Planes", derivatives: list[list[Complexes]], powers: list[Reals], n: int) -> Complexes:
    """Forces of order n along x and y, per length, of the material between z = 0 and the surface, by stresses."""
    orders = [(powers[m], planes.stresses(derivatives[n - m][m - 1])) for m in range(1, n + 1)]
    found = []
    for i in range(5):  # one by one: the finer grid takes most of the memory
        of_stress = np.zeros_like(powers[0])
        for power, stresses in orders:
            of_stress += power * _on_finer_grid(stresses[i], of_stress.shape)
        found.append(_band(of_stress, planes.shape))
    return np.stack(found)


@dataclass(frozen=True)
class _Planes:
    """States on planes of constant z `[component, k_y, k_x]`: u_1, u_2, u_3, sigma_13, sigma_23 and sigma_33."""

    shape: tuple[int, ...]
    material: Material
    qy: Reals
    qx: Reals

    @classmethod
    def of(cls, shape: tuple[int, ...], material: Material) -> "_Planes":
        return cls(shape, material, *grid.wavevectors(shape, (1.0, 1.0)))

    def stresses(self, state: Complexes) -> tuple[Complexes, ...]:
        """Stresses 11, 12, 22, 13 and 23 of a state."""
        u1, u2, _, s5, s4, s3 = state
        stretch1, stretch2 = 1j * self.qx * u1, 1j * self.qy * u2
        modulus, nu = self.material.modulus, self.material.poissons_ratio
        equal = nu / (1.0 - nu) * s3
        twist = self.material.shear * 1j * (self.qy * u1 + self.qx * u2)
        return equal + modulus * (stretch1 + nu * stretch2), twist, equal + modulus * (stretch2 + nu * stretch1), s5, s4

    def field(self, state: Complexes, name: str) -> Complexes:
        """A displacement or stress of a state on the same plane."""
        if name in _STATE:
            return np.asarray(state[_STATE.index(name)])
        return self.stresses(state)[_PLANE.index(name)]

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


def _powers(heights: Reals, order: int) -> list[Reals]:
    """Powers of the topography `[y, x]` over their factorials, on a finer grid."""
    topography = _on_finer_grid(_band(heights, heights.shape), _finer(heights.shape, order))
    return [topography**m / factorial(m) for m in range(order + 1)]


def _finer(shape: tuple[int, ...], order: int) -> tuple[int, ...]:
    """Nodes of a grid on which products of order + 1 factors are free of aliasing within the waves of a shape."""
    return tuple(-(-(order + 2) * n // 2) if n > 1 else 1 for n in shape)


def _on_finer_grid(waves: Complexes, fine: tuple[int, ...]) -> Reals:
    """Samples on a finer grid of waves without the Nyquist ones."""
    shape = waves.shape[0], 2 * waves.shape[1] - 2
    padded = np.zeros((fine[0], fine[1] // 2 + 1), dtype=np.complex128)
    padded[grid.wave_indices(shape)] = waves
    return grid.signal(padded, *fine)


def _band(samples: Reals, shape: tuple[int, ...]) -> Complexes:
    """Coefficients of the waves of a grid of this shape, without the Nyquist waves."""
    return grid.without_nyquist(grid.coefficients(samples, 2)[grid.wave_indices(shape)], shape)
