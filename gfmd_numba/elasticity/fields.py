"""Displacement, strain and stress inside a body from the displacements of its surface (thesis 2.2, (2.6)).

Lengths in L_x, stresses in E*; z counts from the undeformed surface and is negative inside. Stresses are tensions.
"""

from dataclasses import dataclass

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.elasticity import coupled, transfer
from gfmd_numba.fourier import grid


@dataclass(frozen=True)
class Surface:
    """Fourier coefficients `[nx // 2 + 1]` of both displacements of a surface (L_x) and its mean tractions (E*)."""

    u1: Complexes
    u3: Complexes
    mean_traction: tuple[float, float]


@dataclass(frozen=True)
class Elastic:
    """The body: Poisson's ratio up to 1/2 inclusive, height in L_x or None for a half-space."""

    poissons_ratio: float
    aspect_ratio: float | None


@dataclass(frozen=True)
class Fields:
    """Displacements (L_x), strains (engineering shear) and stresses (E*) in Voigt's order, each `[z, x]`."""

    u1: Reals
    u3: Reals
    strain1: Reals
    strain3: Reals
    strain5: Reals
    stress1: Reals
    stress2: Reals
    stress3: Reals
    stress5: Reals


def von_mises(stress1: Reals, stress2: Reals, stress3: Reals, stress5: Reals) -> Reals:
    """Equivalent stress of the three normal stresses and the one shear stress of a plane problem."""
    differences = (stress1 - stress2) ** 2 + (stress2 - stress3) ** 2 + (stress3 - stress1) ** 2
    return np.asarray(np.sqrt(0.5 * differences + 3.0 * stress5**2))


def loaded(tangential: Reals, normal: Reals, body: Elastic) -> Surface:
    """Surface `[nx]` under tractions, along x and out of the body; a half-space's displacements have zero mean."""
    t1, t3 = grid.coefficients(tangential), grid.coefficients(normal)
    u1, u3 = deflection(t1, t3, compliance(len(normal), body))
    return Surface(u1, u3, (float(t1[0].real), float(t3[0].real)))


def displaced(tangential: Reals, normal: Reals, body: Elastic) -> Surface:
    """Surface `[nx]` of given displacements; a mean held by no traction, or an infinite one, is taken to need none."""
    u1, u3 = grid.coefficients(tangential), grid.coefficients(normal)
    yielding = compliance(len(normal), body)
    traction = tuple(
        float(mean.real / soft) if soft > 0.0 else 0.0
        for mean, soft in ((u1[0], yielding[0][0]), (u3[0], yielding[2][0]))
    )
    if len(normal) % 2 == 0:
        # of the Nyquist wave the nodes know one phase only; what is a quarter wave off follows as if it were free
        c11, c13, c33 = (element[-1] for element in yielding)
        u1[-1], u3[-1] = u1[-1] - 1j * c13 / c33 * u3[-1], u3[-1] + 1j * c13 / c11 * u1[-1]
    return Surface(u1, u3, (traction[0], traction[1]))


def compliance(nx: int, body: Elastic) -> tuple[Reals, Reals, Reals]:
    """Inverse of the stiffness (6.57), elements 11, 13 and 33 `[nx // 2 + 1]`; a half-space's mean is held."""
    nu, q = body.poissons_ratio, grid.wavenumbers(nx)
    tangential, normal, lead = np.empty((3, len(q)))
    if body.aspect_ratio is None:
        a11, a13, _ = coupled.half_space(nu)
        tangential[1:], normal[1:], lead[1:] = 0.5 * q[1:], 0.5 * q[1:], a13 / a11
        tangential[0] = normal[0] = np.inf
    else:
        k = q[1:] * body.aspect_ratio
        a11, a13, _ = coupled.slab(k, nu)
        tangential[1:], normal[1:] = (q[1:] * over_q for over_q in coupled.condensed(k, nu))
        lead[1:] = a13 / a11
        tangential[0], normal[0] = coupled.uniform(nu, body.aspect_ratio)
    lead[0] = 0.0
    return 1.0 / tangential, lead / normal, 1.0 / normal


def deflection(t1: Complexes, t3: Complexes, yielding: tuple[Reals, Reals, Reals]) -> tuple[Complexes, Complexes]:
    """Coefficients of both displacements under those of both tractions."""
    c11, c13, c33 = yielding
    return c11 * t1 - 1j * c13 * t3, c33 * t3 + 1j * c13 * t1


def tractions(surface: Surface, nx: int, body: Elastic) -> tuple[Reals, Reals]:
    """Tractions `[nx]` on a surface, along x and out of the body."""
    *_, normal, along = (grid.signal(waves, nx) for waves in spectra(surface, 0.0, nx, body))
    return along, normal


def fields(surface: Surface, nx: int, z: Reals, body: Elastic) -> Fields:
    """Fields `[z, x]` of a surface on nx points; raises ValueError for z outside the body."""
    lowest = -np.inf if body.aspect_ratio is None else -body.aspect_ratio
    if not (np.isfinite(z) & (z <= 0.0) & (z >= lowest * (1.0 + 1e-12))).all():
        raise ValueError("z outside the body")
    rows = [spectra(surface, max(-float(height), 0.0), nx, body) for height in z]
    return Fields(*(grid.signal(np.array(spectra), nx) for spectra in zip(*rows, strict=True)))


def spectra(surface: Surface, depth: float, nx: int, body: Elastic) -> tuple[Complexes, ...]:
    """Coefficients of all fields at one depth, in the order of `Fields`."""
    nu, aspect_ratio = body.poissons_ratio, body.aspect_ratio
    q, shear, kappa = grid.wavenumbers(nx)[1:], float(coupled.c44(nu)), 3.0 - 4.0 * nu
    waves = transfer.half_space(q * depth, nu) if aspect_ratio is None else transfer.slab(depth, q, aspect_ratio, nu)
    # a term X sin(qx) has the coefficient -i X
    cosine, sine = surface.u1[1:], 1j * surface.u3[1:]
    u1, u3, p, w = (along * cosine + across * sine for along, across in (waves.u1, waves.u3, waves.p, waves.w))
    dilatation = (3.0 - kappa) * p
    waves_of = (
        *(u1, -1j * u3),
        *(1j * q * u1, -1j * q * (u1 + (kappa - 1.0) * p), q * (2.0 * u3 + (kappa + 1.0) * w)),
        *(-1j * shear * q * (dilatation - 2.0 * u1), -1j * shear * q * dilatation),
        *(-1j * shear * q * (2.0 * u1 + (kappa + 1.0) * p), shear * q * (2.0 * u3 + (kappa + 1.0) * w)),
    )
    return tuple(
        np.concatenate(([mean], wave)) for mean, wave in zip(_means(surface, depth, body), waves_of, strict=True)
    )


def _means(surface: Surface, depth: float, body: Elastic) -> tuple[float, ...]:
    """The uniform part: tractions do not change with depth, the periodic body cannot widen."""
    nu, (along, normal) = body.poissons_ratio, surface.mean_traction
    strain3, strain5 = normal / float(coupled.c11(nu)), along / float(coupled.c44(nu))
    across = nu / (1.0 - nu) * normal
    u1, u3 = surface.u1[0].real - strain5 * depth, surface.u3[0].real - strain3 * depth
    return u1, u3, 0.0, strain3, strain5, across, across, normal, along
