"""Displacement, strain and stress inside a body from the displacements of its surface (thesis 2.2, (2.6)).

Lengths in L_x, stresses in E*; z counts from the undeformed surface and is negative inside. Stresses are tensions.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gfmd_numba import grid
from gfmd_numba.elasticity import coupled, transfer

Reals = npt.NDArray[np.float64]
Spectrum = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class Surface:
    """Fourier coefficients `[nx // 2 + 1]` of both displacements of a surface (L_x) and its mean tractions (E*)."""

    u1: Spectrum
    u3: Spectrum
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


def frictionless(normal: Reals, mean_pressure: float, body: Elastic) -> Surface:
    """Surface `[nx]` of normal displacements that is free of shear: the tangential one follows (6.75)."""
    u3 = grid.coefficients(normal)
    u1 = 1j * _lead(len(normal), body)[0] * u3
    return Surface(u1, u3, (0.0, -mean_pressure))


def with_friction(
    tangential: Reals, normal: Reals, mean_traction: float, mean_pressure: float, body: Elastic
) -> Surface:
    """Surface `[nx]` of both displacements."""
    u1, u3 = grid.coefficients(tangential), grid.coefficients(normal)
    if len(normal) % 2 == 0:
        # of the Nyquist wave the nodes know one phase only; what is a quarter wave off follows as if it were free
        along, across = (lead[-1] for lead in _lead(len(normal), body))
        u1[-1], u3[-1] = u1[-1] + 1j * along * u3[-1], u3[-1] - 1j * across * u1[-1]
    return Surface(u1, u3, (mean_traction, -mean_pressure))


def fields(surface: Surface, nx: int, z: Reals, body: Elastic) -> Fields:
    """Fields `[z, x]` of a surface on nx points; raises ValueError for z outside the body."""
    lowest = -np.inf if body.aspect_ratio is None else -body.aspect_ratio
    if not (np.isfinite(z) & (z <= 0.0) & (z >= lowest * (1.0 + 1e-12))).all():
        raise ValueError("z outside the body")
    rows = [spectra(surface, max(-float(height), 0.0), nx, body) for height in z]
    return Fields(*(grid.signal(np.array(spectra), nx) for spectra in zip(*rows, strict=True)))


def _lead(nx: int, body: Elastic) -> tuple[Reals, Reals]:
    """U_1 over U_3 free of shear, and U_3 over U_1 free of normal traction, for waves as in (2.3)."""
    q = grid.wavenumbers(nx)
    if body.aspect_ratio is None:
        a11, a13, a33 = (np.full(len(q), float(element)) for element in coupled.half_space(body.poissons_ratio))
    else:
        a11, a13, a33 = np.ones((3, len(q)))
        a11[1:], a13[1:], a33[1:] = coupled.slab(q[1:] * body.aspect_ratio, body.poissons_ratio)
    a13[0] = 0.0
    return -a13 / a11, -a13 / a33


def spectra(surface: Surface, depth: float, nx: int, body: Elastic) -> tuple[Spectrum, ...]:
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
