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
Lengths in L_x, stresses in E*.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import factorial

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.elasticity import coupled, fields
from gfmd_numba.elasticity.fields import Elastic, Fields, Surface
from gfmd_numba.fourier import grid

State = tuple[Complexes, Complexes, Complexes, Complexes]  # u_1, u_3, sigma_13, sigma_33


@dataclass(frozen=True)
class Response:
    """What the topography adds to the response of a flat body, and the states at z = 0 it is made of, one an order.

    `u1` and `u3` `[nx]` are displacements of the surface; `last` is the largest part of them that is of the highest
    order. `heights` `[nx]` are without the Nyquist wave.
    """

    states: tuple[State, ...]
    heights: Reals
    u1: Reals
    u3: Reals
    last: float


def forming(heights: Reals, body: Elastic) -> Surface:
    """Step 1: the surface `[nx]` of a flat body displaced by (0, h), h of zero mean.

    Its stresses are those of the forces +q C11 M u'' that form the topography (5.15).
    """
    return fields.displaced(np.zeros_like(heights), heights, body)


def respond(pressure: Reals, heights: Reals, body: Elastic, order: int) -> Response:
    """Response to a pressure `[nx]` of a body with topography `[nx]` of zero mean, to an order of 0 or more."""
    nx = len(heights)
    fine = _fine(nx, order)
    topography = _band(heights, nx)
    powers = [grid.signal(topography, fine) ** m / factorial(m) for m in range(order + 1)]
    compliance = fields.compliance(nx, body)
    traction = _band(np.array([np.zeros(nx), -pressure]), nx)
    towers: list[list[State]] = []
    for n in range(order + 1):
        if n > 0:
            turned = np.zeros((2, fine))
            for m in range(1, n + 1):
                state = towers[n - m][m - 1]
                turned += powers[m] * grid.signal(np.array([_stress1(state, body), state[2]]), fine)
            traction = grid.derivative(_band(turned, nx))
        along, normal = traction
        state = (*fields.deflection(along, normal, compliance), along, normal)
        towers.append(list(_tower(state, order - n, body)))
    added = np.zeros((order + 1, 2, fine))
    for n, tower in enumerate(towers):
        for m, state in enumerate(tower):
            added[n + m] += powers[m] * grid.signal(np.array(state[:2]), fine)
    added[0] = 0.0
    added = grid.signal(_band(added, nx), nx)
    u1, u3 = added.sum(axis=0)
    states = tuple(tower[0] for tower in towers)
    return Response(states, grid.signal(topography, nx), u1, u3, float(abs(added[-1]).max()))


def rough_fields(flat: Surface, response: Response, z: Reals, body: Elastic) -> Fields:
    """Fields `[z, x]` at the labels (x, z) of a rough body, whose flat body has the surface `flat`."""
    nx, order = len(response.heights), len(response.states) - 1
    fine = _fine(nx, order)
    lowest = fields.fields(flat, nx, z, body)
    added = np.zeros((len(vars(lowest)), len(z), fine))
    formed = forming(response.heights, body)
    for level, height in enumerate(z):
        u1, u3, *_ = (grid.signal(waves, fine) for waves in fields.spectra(formed, -float(height), nx, body))
        for n, at_surface in enumerate(response.states):
            for m, state in enumerate(_tower(_inside(at_surface, float(height), nx, body), order - n, body)):
                waves = np.array(_all_fields(state, body))
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
    kept = grid.coefficients(samples)[..., : nx // 2 + 1].copy()
    if nx % 2 == 0:
        kept[..., -1] = 0.0
    return kept


def _inside(state: State, z: float, nx: int, body: Elastic) -> State:
    """State at a height below z = 0."""
    means = float(state[2][0].real), float(state[3][0].real)
    at_depth = fields.spectra(Surface(state[0], state[1], means), -z, nx, body)
    return at_depth[0], at_depth[1], at_depth[8], at_depth[7]


def _tower(state: State, height: int, body: Elastic) -> Iterator[State]:
    """A state and its derivatives in z, by strains and equilibrium."""
    yield state
    for _ in range(height):
        stress1 = _stress1(state, body)
        _, _, _, strain3, strain5, *_ = _all_fields(state, body)
        state = strain5 - grid.derivative(state[1]), strain3, -grid.derivative(stress1), -grid.derivative(state[2])
        yield state


def _stress1(state: State, body: Elastic) -> Complexes:
    nu = body.poissons_ratio
    return nu / (1.0 - nu) * state[3] + grid.derivative(state[0])


def _all_fields(state: State, body: Elastic) -> tuple[Complexes, ...]:
    """Displacements, strains and stresses of a state in plane strain, in the order of `Fields`."""
    u1, u3, shear, normal = state
    nu, strain1, stress1 = body.poissons_ratio, grid.derivative(u1), _stress1(state, body)
    strain3 = normal / coupled.c11(nu) - nu / (1.0 - nu) * strain1
    strain5 = shear / coupled.c44(nu)
    return u1, u3, strain1, strain3, strain5, stress1, nu * (stress1 + normal), normal, shear
