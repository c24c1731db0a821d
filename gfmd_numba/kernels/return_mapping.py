"""Compiled plastic flow at points: the return to the yield surface of von Mises (Simo and Hughes 1998, 3.3)."""

import math
from typing import NamedTuple

import numpy as np

from gfmd_numba.arrays import Reals
from gfmd_numba.kernels.compilation import jit


class Hardening(NamedTuple):
    """Yield stress at an equivalent plastic strain e: stress + slope e + rise (1 - exp(-e / strain)), after Voce."""

    stress: float
    slope: float = 0.0
    rise: float = 0.0
    strain: float = np.inf

    def at(self, equivalent: Reals) -> Reals:
        """Yield stress at an equivalent plastic strain."""
        found: Reals = self.stress + self.slope * equivalent - self.rise * np.expm1(-equivalent / self.strain)
        return found


@jit
def von_mises(xx: float, zz: float, xz: float, xy: float, yz: float) -> float:
    """Equivalent stress of a deviatoric one."""
    return math.sqrt(3.0 * (xx * xx + zz * zz + xx * zz + xz * xz + xy * xy + yz * yz))


@jit
def flow(equivalent: float, trial: float, hardening: Hardening, shear: float) -> float:
    """Equivalent plastic strain that a step adds, whose elastic stress is a trial; Newton's method from below."""
    added = 0.0
    for _ in range(100):
        fade = np.exp(-(equivalent + added) / hardening.strain)
        bears = hardening.stress + hardening.slope * (equivalent + added) + hardening.rise * (1.0 - fade)
        excess = trial - 3.0 * shear * added - bears
        if excess <= 4e-16 * trial:
            break
        added += excess / (3.0 * shear + hardening.slope + hardening.rise / hardening.strain * fade)
    return added


@jit
def return_to_yield(strain: Reals, before: Reals, equivalent: Reals, hardening: Hardening, shear: float) -> None:
    """Turn deviatoric strains `[component, point]` at the end of a step into the plastic ones there.

    `before` are the plastic strains and `equivalent` `[point]` the equivalent one that the step began with.
    """
    n, least = strain.shape[0], hardening.stress / (2.0 * shear)
    for i in range(strain.shape[1]):
        xx, zz, xz = strain[0, i] - before[0, i], strain[1, i] - before[1, i], strain[2, i] - before[2, i]
        xy = strain[3, i] - before[3, i] if n > 3 else 0.0
        yz = strain[4, i] - before[4, i] if n > 3 else 0.0
        size = von_mises(xx, zz, xz, xy, yz)
        added = flow(equivalent[i], 2.0 * shear * size, hardening, shear) if size > least else 0.0
        share = 1.5 * added / size if added > 0.0 else 0.0
        strain[0, i] = before[0, i] + share * xx
        strain[1, i] = before[1, i] + share * zz
        strain[2, i] = before[2, i] + share * xz
        if n > 3:
            strain[3, i] = before[3, i] + share * xy
            strain[4, i] = before[4, i] + share * yz
