"""Which mode of the elastic body is softest, hence slowest and decisive for the damping: the cases of thesis 6.3.

Stiffness in E*/L_x, aspect ratio a = z_m/L_x, waves q = 2 pi k / L_x. The critical damping of a case is
`critical_damping(case.stiffness, dt)`, (6.41).
The thesis compares the uniform mode with k = 1; in thin slabs with nu > 1/4 (normal load), nu < -3/4 (tangential)
or nu < -0.184 (coupled) the softest wave is where q z_m is 0 to 3, whatever its index: all candidates are compared.
"""

from typing import Literal, NamedTuple

import numpy as np
import slab_stiffness
import textbook

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import moduli

Direction = Literal["tangential", "normal", "mixed"]


class SlowestMode(NamedTuple):
    """Stiffness in E*/L_x, wave index k (0: uniform displacement) and direction of the softest mode."""

    stiffness: float
    wave_index: int
    direction: Direction


def uniform_slab(poissons_ratio: float, aspect_ratio: float) -> SlowestMode:
    """Uniform displacement of a slab, both directions free: always the tangential one, C44/z_m (6.66)."""
    return SlowestMode(float(slab_stiffness.uniform_stiffness(poissons_ratio, aspect_ratio)[0]), 0, "tangential")


def half_space_normal() -> SlowestMode:
    """Normal displacement of the half-space, (6.70) with k = 1; its uniform displacement is free of stiffness."""
    return SlowestMode(np.pi, 1, "normal")


def incompressible_slab(aspect_ratio: float) -> SlowestMode:
    """Normal displacement of an incompressible slab (6.74), whose uniform displacement is rigid."""
    return one_direction(0.5, aspect_ratio, "normal")


def one_direction(
    poissons_ratio: float, aspect_ratio: float, direction: Literal["tangential", "normal"]
) -> SlowestMode:
    """Slab loaded in one direction, free of traction in the other (6.76)-(6.82); the uniform mode wins a tie."""
    component = 0 if direction == "tangential" else 1
    index = _indices(poissons_ratio, aspect_ratio)
    over_q = slab_stiffness.condensed_elements(2.0 * np.pi * index * aspect_ratio, poissons_ratio)[component]
    waves = 2.0 * np.pi * index * over_q
    uniform = float(slab_stiffness.uniform_stiffness(poissons_ratio, aspect_ratio)[component])
    return _softer(uniform, direction, waves, direction)


def half_space_coupled(poissons_ratio: float) -> SlowestMode:
    """Both components of the half-space: kappa_3' of (6.84) with k = 1."""
    a11, a13, _ = slab_stiffness.half_space_elements(poissons_ratio)
    return SlowestMode(float(2.0 * np.pi * (a11 - abs(a13))), 1, "mixed")


def slab_coupled(poissons_ratio: float, aspect_ratio: float) -> SlowestMode:
    """Both components of the slab (6.90): C44/z_m for -0.184 < nu <= 1/2, a wave in a thin slab with lower nu."""
    index = _indices(poissons_ratio, aspect_ratio)
    waves = 2.0 * np.pi * index * textbook.principal_elements(2.0 * np.pi * index * aspect_ratio, poissons_ratio)[0]
    return _softer(
        float(slab_stiffness.uniform_stiffness(poissons_ratio, aspect_ratio)[0]), "tangential", waves, "mixed"
    )


def switch(
    case: Literal["f1", "f3", "f1'", "f3'", "f3''"], aspect_ratio: Reals | float, s: Reals | float, wave_index: int = 1
) -> Reals:
    """Stiffness of a wave less that of the uniform mode, in C44/L_x: f of (6.82) and of Fig. 6.18; zero on the curve.

    f1 and f3: loaded tangentially, normally; f1' and f3': kappa_1' (larger) and kappa_3' (smaller) of the coupled slab
    against the uniform normal mode; f3'': kappa_3' against the uniform tangential mode. s = C44/C11, 0 < s < 1.
    """
    nu = 1.0 - 0.5 / (1.0 - np.asarray(s, dtype=np.float64))  # (6.51)
    q = 2.0 * np.pi * wave_index
    pair = slab_stiffness.condensed_elements if case in ("f1", "f3") else textbook.principal_elements
    component = {"f1": 0, "f3": 1, "f1'": 1, "f3'": 0, "f3''": 0}[case]
    wave = q * pair(np.asarray(q * aspect_ratio), nu)[component]
    tangential, normal = slab_stiffness.uniform_stiffness(nu, aspect_ratio)
    return (wave - (tangential if case in ("f1", "f3''") else normal)) / moduli.c44(nu)


def _indices(poissons_ratio: float, aspect_ratio: float) -> Reals:
    """Waves among which the softest is: beyond q z_m = 4 + ln(kolosov) every branch rises with q."""
    last = (4.0 + np.log(moduli.kolosov(poissons_ratio))) / (2.0 * np.pi * aspect_ratio)
    return np.arange(1.0, np.ceil(last) + 1.0)


def _softer(uniform: float, direction: Direction, waves: Reals, wave_direction: Direction) -> SlowestMode:
    softest = int(waves.argmin())
    # long waves tend to the uniform mode, and rounding must not choose between equals
    if uniform <= waves[softest] * (1.0 + 1e-12):
        return SlowestMode(uniform, 0, direction)
    return SlowestMode(float(waves[softest]), softest + 1, wave_direction)
