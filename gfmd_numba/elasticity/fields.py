"""Displacement, strain and stress inside a body from the displacements of its surface (thesis 2.2, (2.6)).

Lengths in L_x, stresses in E*; z counts from the undeformed surface and is negative inside. Stresses are tensions. At
an interface of layers the fields are those just above it.
"""

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.elasticity import moduli
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.fourier import grid

Values = TypeVar("Values", float, Reals, Complexes)


@dataclass(frozen=True)
class DeformedSurface:
    """Coefficients `[nx // 2 + 1]` of both displacements of a surface (L_x) and its mean tractions (E*)."""

    u1: Complexes
    u3: Complexes
    mean_traction: tuple[float, float]


@dataclass(frozen=True)
class Fields(Generic[Values]):
    """Displacements (L_x), strains (engineering shear) and stresses (E*) in Voigt's order.

    Each is `[z, x]`, or holds the coefficients `[nx // 2 + 1]` or the mean at one depth.
    """

    u1: Values
    u3: Values
    strain1: Values
    strain3: Values
    strain5: Values
    stress1: Values
    stress2: Values
    stress3: Values
    stress5: Values


def stacked(waves: Fields[Complexes]) -> Complexes:
    """Coefficients of all fields in one array `[field, nx // 2 + 1]`, in the order of the record."""
    return np.array(list(vars(waves).values()))


def von_mises(stress1: Reals, stress2: Reals, stress3: Reals, *shear: Reals) -> Reals:
    """Equivalent stress of the three normal stresses and the shear stresses: one in a plane problem, else three."""
    squares = 0.5 * ((stress1 - stress2) ** 2 + (stress2 - stress3) ** 2 + (stress3 - stress1) ** 2)
    for each in shear:
        squares += 3.0 * each**2
    return np.asarray(np.sqrt(squares))


def surface_under_tractions(tangential: Reals, normal: Reals, body: ElasticBody) -> DeformedSurface:
    """Surface `[nx]` under tractions, along x and out of the body; a half-space's displacements have zero mean."""
    t1, t3 = grid.coefficients(tangential), grid.coefficients(normal)
    u1, u3 = body.compliance(len(normal)).displacements(t1, t3)
    return DeformedSurface(u1, u3, (float(t1[0].real), float(t3[0].real)))


def surface_with_displacements(tangential: Reals, normal: Reals, body: ElasticBody) -> DeformedSurface:
    """Surface `[nx]` of given displacements; a mean held by no traction, or an infinite one, is taken to need none."""
    u1, u3 = grid.coefficients(tangential), grid.coefficients(normal)
    compliance = body.compliance(len(normal))
    s11, s13, s33 = compliance.s11, compliance.s13, compliance.s33
    along, out = (float(u[0].real / s[0]) if s[0] > 0.0 else 0.0 for u, s in ((u1, s11), (u3, s33)))
    if len(normal) % 2 == 0:
        # of the Nyquist wave the nodes know one phase only; what is a quarter wave off follows as if it were free
        u1[-1], u3[-1] = u1[-1] - 1j * s13[-1] / s33[-1] * u3[-1], u3[-1] + 1j * s13[-1] / s11[-1] * u1[-1]
    return DeformedSurface(u1, u3, (along, out))


def surface_tractions(surface: DeformedSurface, nx: int, body: ElasticBody) -> tuple[Reals, Reals]:
    """Tractions `[nx]` on a surface, along x and out of the body."""
    waves = waves_at_depth(surface, 0.0, nx, body)
    return grid.signal(waves.stress5, nx), grid.signal(waves.stress3, nx)


def fields_inside(surface: DeformedSurface, nx: int, z: Reals, body: ElasticBody) -> Fields[Reals]:
    """Fields `[z, x]` of a surface on nx points; raises ValueError for z outside the body."""
    if not (np.isfinite(z) & (z <= 0.0) & (z >= body.base * (1.0 + 1e-12))).all():
        raise ValueError("z outside the body")
    levels = [stacked(waves_at_depth(surface, max(-float(height), 0.0), nx, body)) for height in z]
    return Fields(*(grid.signal(waves, nx) for waves in np.stack(levels, axis=1)))


def waves_at_depth(surface: DeformedSurface, depth: float, nx: int, body: ElasticBody) -> Fields[Complexes]:
    """Coefficients `[nx // 2 + 1]` of all fields at one depth."""
    q, material = grid.wavenumbers(nx)[1:], body.material(depth)
    shear, kolosov = material.shear, moduli.kolosov(material.poissons_ratio)
    waves = body.transfer(depth, q)
    # a term X sin(qx) has the coefficient -i X
    cosine, sine = surface.u1[1:], 1j * surface.u3[1:]
    u1, u3, p, w = (along * cosine + across * sine for along, across in (waves.u1, waves.u3, waves.p, waves.w))
    dilatation = (3.0 - kolosov) * p
    means = _means(surface, depth, body)
    return Fields(
        u1=_with_mean(means.u1, u1),
        u3=_with_mean(means.u3, -1j * u3),
        strain1=_with_mean(means.strain1, 1j * q * u1),
        strain3=_with_mean(means.strain3, -1j * q * (u1 + (kolosov - 1.0) * p)),
        strain5=_with_mean(means.strain5, q * (2.0 * u3 + (kolosov + 1.0) * w)),
        stress1=_with_mean(means.stress1, -1j * shear * q * (dilatation - 2.0 * u1)),
        stress2=_with_mean(means.stress2, -1j * shear * q * dilatation),
        stress3=_with_mean(means.stress3, -1j * shear * q * (2.0 * u1 + (kolosov + 1.0) * p)),
        stress5=_with_mean(means.stress5, shear * q * (2.0 * u3 + (kolosov + 1.0) * w)),
    )


def _with_mean(mean: float, waves: Complexes) -> Complexes:
    return np.concatenate(([mean], waves))


def _means(surface: DeformedSurface, depth: float, body: ElasticBody) -> Fields[float]:
    """The uniform part: tractions do not change with depth, the periodic body cannot widen."""
    along, normal = surface.mean_traction
    material, (sheared, stretched) = body.material(depth), body.uniform_displacement(depth)
    nu, strain3, strain5 = material.poissons_ratio, normal / material.c11, along / material.shear
    across = nu / (1.0 - nu) * normal
    return Fields(
        u1=float(surface.u1[0].real) - along * sheared,
        u3=float(surface.u3[0].real) - normal * stretched,
        strain1=0.0,
        strain3=strain3,
        strain5=strain5,
        stress1=across,
        stress2=across,
        stress3=normal,
        stress5=along,
    )
