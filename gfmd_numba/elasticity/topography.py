"""A body whose stress-free surface is not flat: its response to a pressure, order by order in the topography.

Two-step GFMD (thesis chapter 5) forms the topography h by displacing a flat body by u'' (5.15), and lets the strains
of a later load superpose. That is order 0 here; its error is of the order of the slope. The higher orders continue the
field of a flat body to the true surface. With s the traction on the plane z = 0, on which the flat body is known, the
traction t on the surface z = h(x), per length of x, is

    t_i = s_i - d/dx integral from 0 to h of sigma_i1 dz,

and both that and the displacement at z = h are Taylor series about z = 0. The state (u_1, u_3, sigma_13, sigma_33)
obeys a linear equation in z whose coefficients hold derivatives along x only, so that every order needs just
transforms. The terms of an order cancel but for the slope at waves far shorter than h; products are therefore taken
on a finer grid, free of aliasing. The Nyquist wave stays at order 0.

Points inside have labels (x, z), their places in the flat body; u''(x, z) takes them to the stress-free rough one.
Of a layered body the field of the topmost layer is continued: the topography is that of the surface alone, and the
interfaces below are flat. Lengths in L_x, stresses in E*.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import factorial

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.elasticity import fields
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.fields import DeformedSurface, Fields
from gfmd_numba.elasticity.layer import Material
from gfmd_numba.fourier import grid


@dataclass(frozen=True)
class PlaneState:
    """Coefficients `[nx // 2 + 1]` of displacements and tractions on a plane of constant z, which decide all fields."""

    u1: Complexes
    u3: Complexes
    stress5: Complexes
    stress3: Complexes


@dataclass(frozen=True)
class Response:
    """What the topography adds to the response of a flat body.

    `orders` are the states of the flat body at z = 0 it is made of, one for each order. `u1` and `u3` `[nx]` are
    displacements of the surface; `highest_order` is the largest part of them that is of the highest order. `heights`
    `[nx]` are without the Nyquist wave.
    """

    orders: tuple[PlaneState, ...]
    heights: Reals
    u1: Reals
    u3: Reals
    highest_order: float


def formed_surface(heights: Reals, body: ElasticBody) -> DeformedSurface:
    """Step 1: the surface `[nx]` of a flat body displaced by (0, h), h of zero mean.

    Its stresses are those of the forces +q C11 M u'' that form the topography (5.15).
    """
    return fields.surface_with_displacements(np.zeros_like(heights), heights, body)


def forming(body: ElasticBody, order: int) -> ElasticBody:
    """Body that step 1 deforms, so that its displacements u'' take labels to places in the rough one.

    From order 1 on it is the topmost layer on a rigid base, as interfaces are flat: labels below it are places.
    """
    return body if order == 0 else body.top


def formed_waves(heights: Reals, depth: float, body: ElasticBody, order: int) -> tuple[Complexes, Complexes]:
    """Coefficients `[nx // 2 + 1]` of both components of u'' at a depth, from heights `[nx]` of zero mean."""
    former, nx = forming(body, order), len(heights)
    if former is not body and depth >= -former.base:
        nothing = np.zeros(nx // 2 + 1, dtype=np.complex128)
        return nothing, nothing
    waves = fields.waves_at_depth(formed_surface(heights, former), depth, nx, former)
    return waves.u1, waves.u3


def respond(
    pressure: Reals, heights: Reals, body: ElasticBody, order: int, tangential: Reals | None = None
) -> Response:
    """Response of a body with topography `[nx]` of zero mean to a pressure `[nx]`, to an order of 0 or more.

    `tangential` is a traction `[nx]` along x that acts too; both are per length of x. Interfaces of layers are flat.
    """
    nx, top = len(heights), body.material(0.0)
    fine = _fine(nx, order)
    topography = _band(heights, nx)
    powers = [grid.signal(topography, fine) ** m / factorial(m) for m in range(order + 1)]
    compliance = body.compliance(nx)
    traction = _band(np.array([np.zeros(nx) if tangential is None else tangential, -pressure]), nx)
    derivatives: list[list[PlaneState]] = []  # of each order, those in z
    for n in range(order + 1):
        if n > 0:
            carried = np.zeros((2, fine))  # by the material between z = 0 and the surface, along x
            for m in range(1, n + 1):
                state = derivatives[n - m][m - 1]
                carried += powers[m] * grid.signal(np.array([_stress1(state, top), state.stress5]), fine)
            traction = grid.derivative(_band(carried, nx))
        along, normal = traction
        state = PlaneState(*compliance.displacements(along, normal), along, normal)
        derivatives.append(list(_derivatives_in_z(state, order - n, top)))
    added = np.zeros((order + 1, 2, fine))
    for n, of_order in enumerate(derivatives):
        for m, state in enumerate(of_order):
            added[n + m] += powers[m] * grid.signal(np.array([state.u1, state.u3]), fine)
    added[0] = 0.0
    added = grid.signal(_band(added, nx), nx)
    u1, u3 = added.sum(axis=0)
    orders = tuple(of_order[0] for of_order in derivatives)
    return Response(orders, grid.signal(topography, nx), u1, u3, float(abs(added[-1]).max()))


def rough_fields(flat: DeformedSurface, response: Response, z: Reals, body: ElasticBody) -> Fields[Reals]:
    """Fields `[z, x]` at the labels (x, z) of a rough body, whose flat body has the surface `flat`."""
    nx, order = len(response.heights), len(response.orders) - 1
    fine = _fine(nx, order)
    lowest = fields.fields_inside(flat, nx, z, body)
    added = np.zeros((len(vars(lowest)), len(z), fine))
    for level, height in enumerate(z):
        depth = -float(height)
        material = body.material(depth)
        u1, u3 = (grid.signal(waves, fine) for waves in formed_waves(response.heights, depth, body, order))
        for n, on_top in enumerate(response.orders):
            below = _state_at_depth(on_top, depth, nx, body)
            for m, state in enumerate(_derivatives_in_z(below, order - n, material)):
                waves = fields.stacked(_fields_of(state, material))
                for along in range(order - n - m + 1):
                    if n + m + along > 0:
                        weight = u1**along / factorial(along) * u3**m / factorial(m)
                        added[:, level] += weight * grid.signal(waves, fine)
                    waves = grid.derivative(waves)
    more = grid.signal(_band(added, nx), nx)
    return Fields(*(values + part for values, part in zip(vars(lowest).values(), more, strict=True)))


def _fine(nx: int, order: int) -> int:
    """Points on which products of order + 1 factors are free of aliasing within the waves of nx points."""
    return -(-(order + 2) * nx // 2)


def _band(samples: Reals, nx: int) -> Complexes:
    """Coefficients `[..., nx // 2 + 1]` of the waves of nx points, without the Nyquist wave."""
    return grid.without_nyquist(grid.coefficients(samples)[..., : nx // 2 + 1], (nx,))


def _state_at_depth(on_top: PlaneState, depth: float, nx: int, body: ElasticBody) -> PlaneState:
    """State on a plane below z = 0, from that on z = 0."""
    means = float(on_top.stress5[0].real), float(on_top.stress3[0].real)
    waves = fields.waves_at_depth(DeformedSurface(on_top.u1, on_top.u3, means), depth, nx, body)
    return PlaneState(waves.u1, waves.u3, waves.stress5, waves.stress3)


def _derivatives_in_z(state: PlaneState, highest: int, material: Material) -> Iterator[PlaneState]:
    """A state and its derivatives in z up to the highest, by strains and equilibrium."""
    yield state
    for _ in range(highest):
        found = _fields_of(state, material)
        state = PlaneState(
            u1=found.strain5 - grid.derivative(state.u3),
            u3=found.strain3,
            stress5=-grid.derivative(found.stress1),
            stress3=-grid.derivative(state.stress5),
        )
        yield state


def _stress1(state: PlaneState, material: Material) -> Complexes:
    nu = material.poissons_ratio
    return nu / (1.0 - nu) * state.stress3 + material.modulus * grid.derivative(state.u1)


def _fields_of(state: PlaneState, material: Material) -> Fields[Complexes]:
    """All fields in plane strain of a state on the same plane."""
    nu, strain1, stress1 = material.poissons_ratio, grid.derivative(state.u1), _stress1(state, material)
    return Fields(
        u1=state.u1,
        u3=state.u3,
        strain1=strain1,
        strain3=state.stress3 / material.c11 - nu / (1.0 - nu) * strain1,
        strain5=state.stress5 / material.shear,
        stress1=stress1,
        stress2=nu * (stress1 + state.stress3),
        stress3=state.stress3,
        stress5=state.stress5,
    )
