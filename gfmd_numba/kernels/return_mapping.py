"""Compiled plastic flow at points: the return to the yield surface of von Mises (Simo and Hughes 1998, 3.3)."""

import math
from typing import NamedTuple

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.kernels.compilation import jit


class Hardening(NamedTuple):
    """Isotropic hardening: yield stress = stress + slope e + rise (1 - exp(-e / strain)), after Voce.

    Stresses are in g E*, strains like the equivalent plastic one e in g.
    """

    stress: float
    slope: float = 0.0
    rise: float = 0.0
    strain: float = np.inf


@jit
def flow(equivalent: float, trial: float, hardening: Hardening, shear: float) -> float:
    """Equivalent plastic strain d of a step, trial - 3 G d = Y(equivalent + d), by Newton's method from below.

    The `trial` is the equivalent stress without flow in the step, Y the yield stress of `Hardening`.
    """
    flow_strain = 0.0
    for _ in range(100):
        fade = np.exp(-(equivalent + flow_strain) / hardening.strain)
        bears = hardening.stress + hardening.slope * (equivalent + flow_strain) + hardening.rise * (1.0 - fade)
        overstress = trial - 3.0 * shear * flow_strain - bears
        if overstress <= 4e-16 * trial:
            break
        flow_strain += overstress / (3.0 * shear + hardening.slope + hardening.rise / hardening.strain * fade)
    return flow_strain


@jit
def return_to_yield(strain: Reals, plastic: Reals, equivalent: Reals, hardening: Hardening, shear: float) -> None:
    """Turn deviatoric strains e `[component, point]` at the end of a step into the plastic strains e_p there.

    The step began with the `plastic` strains e_p0 and the `equivalent` one `[point]`. With the trial strain
    t = e - e_p0 and the strain d that `flow` finds,

        trial = 2 G (3 (xx^2 + zz^2 + xx zz + sum of shear^2))^(1/2) of t,    e_p = e_p0 + (3 G d / trial) t.

    Components are xx, zz, xz and on maps xy, yz of a tensor, shear once, with yy = -xx - zz.
    """
    n, least = strain.shape[0], hardening.stress / (2.0 * shear)
    for i in range(strain.shape[1]):
        for c in range(n):
            strain[c, i] -= plastic[c, i]
        xx, zz = strain[0, i], strain[1, i]
        square = xx * xx + zz * zz + xx * zz
        for c in range(2, n):
            square += strain[c, i] * strain[c, i]
        size = math.sqrt(3.0 * square)
        flow_strain = flow(equivalent[i], 2.0 * shear * size, hardening, shear) if size > least else 0.0
        factor = 1.5 * flow_strain / size if flow_strain > 0.0 else 0.0
        for c in range(n):
            strain[c, i] = plastic[c, i] + factor * strain[c, i]
