"""Compiled waves of strain below a surface whose sublayers have eigenstrains, each constant over its thickness.

Along one wave vector q, with s = q depth, displacements i U along q and W downwards (times 1/q) and tractions i S and T
on planes of equal depth obey y' = N y + F tau, y = (U, W, S, T). Solutions fade downwards as exp(-s) (a_1 v_1 + a_2
(v_2 + s v_1)) with v_1 = (1, -1, -2 mu, 2 mu) and v_2 = (0, -kolosov, mu (1 - kolosov), mu (1 + kolosov)), and upwards
as their mirror images with b_1 and b_2. Across q there is one wave of shear, a_3 and b_3. A sublayer adds its
eigenstrain to all of them, and strains are averaged over it exactly: one pass upwards and one downwards do it all.
"""

from typing import NamedTuple

import numpy as np

from gfmd_numba.arrays import Complexes, Reals
from gfmd_numba.kernels.compilation import jit

_Three = tuple[complex, complex, complex]
_Five = tuple[complex, complex, complex, complex, complex]


class Waves(NamedTuple):
    """Wave numbers `[wave]`, cosine and sine of their directions `[wave]`, and thicknesses `[sublayer]` below them.

    Waves of a negative number are left out. The material has a Poisson's ratio and a shear modulus (E*). A wave that
    fades downwards as exp(-s) has fallen by the factor `decay` `[sublayer, wave]` behind a sublayer, and by the factor
    `mean` on average within it.
    """

    q: Reals
    cosine: Reals
    sine: Reals
    thickness: Reals
    poissons_ratio: float
    shear: float
    decay: Reals
    mean: Reals

    @classmethod
    def of(cls, q: Reals, cosine: Reals, sine: Reals, thickness: Reals, poissons_ratio: float, shear: float) -> "Waves":
        """Waves of these numbers and directions in sublayers of these thicknesses."""
        h = np.outer(thickness, np.maximum(q, 0.0))
        mean = np.divide(-np.expm1(-h), h, out=np.ones_like(h), where=h > 0.0)
        return cls(q, cosine, sine, thickness, poissons_ratio, shear, np.exp(-h), mean)


@jit
def _turned(tau: Complexes, j: int, w: int, c: float, s: float) -> _Five:
    """Components 11, 33, 13 / i, 12 and 23 / i along and across a wave, axis 3 downwards."""
    xx, zz, xz = tau[0, j, w], tau[1, j, w], tau[2, j, w]
    if tau.shape[0] == 3:
        return xx, zz, 1j * xz, 0j, 0j
    xy, yz, yy = tau[3, j, w], tau[4, j, w], -xx - zz
    in_plane = c * c * xx + s * s * yy + 2.0 * c * s * xy
    across = c * s * (yy - xx) + (c * c - s * s) * xy
    return in_plane, zz, 1j * (c * xz + s * yz), across, 1j * (c * yz - s * xz)


@jit
def _sources(turned: _Five, nu: float, mu: float, way: float) -> _Three:
    """Source of the waves that fade downwards (1), or upwards (-1), by a stress of eigenstrain, per s."""
    t11, t33, t13, t12, t23 = turned
    # 1 / C_11, in 1 / E*
    uniaxial, kolosov, weight = (1.0 - 2.0 * nu) / (1.0 - nu) ** 2, 3.0 - 4.0 * nu, 0.25 / (1.0 - nu) ** 2
    first = 0.5 * (way * t13 / mu - uniaxial * t33) - kolosov * weight * (t11 - t33)
    return first, weight * (t11 - t33 - 2.0 * way * t13), 0.5 * (way * t23 - t12) / mu


@jit
def _through(wave: _Three, source: _Three, h: float, decay: float, mean: float) -> tuple[_Three, _Three]:
    """Waves behind a sublayer of thickness h = q depth > 0, and their mean in it."""
    (a1, a2, a3), (f1, f2, f3) = wave, source
    less, rest = h * mean, 1.0 - mean
    behind = decay * (a1 + h * a2) + less * f1 + (less - h * decay) * f2, decay * a2 + less * f2, decay * a3 + less * f3
    within = mean * a1 + (mean - decay) * a2 + rest * f1 + (rest - mean + decay) * f2
    return behind, (within, mean * a2 + rest * f2, mean * a3 + rest * f3)


@jit
def waves_upwards(tau: Complexes, waves: Waves, found: Complexes, surface: Complexes) -> None:
    """Fill the first three components of `found` `[component, sublayer, wave]` with the means of b_1, b_2 and b_3.

    `tau` is the stress 2 mu times the eigenstrain `[component, sublayer, wave]`, of xx, zz, xz and on maps xy and yz;
    yy keeps the volume. `surface` `[3, wave]` becomes the waves that arrive at the surface.
    """
    nu, mu = waves.poissons_ratio, waves.shear
    surface[:] = 0.0
    for j in range(tau.shape[1] - 1, -1, -1):
        for w in range(tau.shape[2]):
            if waves.q[w] > 0.0:
                source = _sources(_turned(tau, j, w, waves.cosine[w], waves.sine[w]), nu, mu, -1.0)
                arriving = surface[0, w], surface[1, w], surface[2, w]
                h = waves.q[w] * waves.thickness[j]
                above, within = _through(arriving, source, h, waves.decay[j, w], waves.mean[j, w])
                surface[0, w], surface[1, w], surface[2, w] = above
                found[0, j, w], found[1, j, w], found[2, j, w] = within
            else:
                found[0, j, w] = found[1, j, w] = found[2, j, w] = 0.0


@jit
def reflect(surface: Complexes, waves: Waves, out: Complexes) -> None:
    """Turn the waves that arrive at a free surface `[3, wave]` into the waves that it reflects downwards.

    `out` `[wave]` becomes the displacement of the surface out of the body; 0 in the mean.
    """
    nu = waves.poissons_ratio
    kolosov, half = 3.0 - 4.0 * nu, 1.0 - 2.0 * nu  # half of kolosov - 1
    for w in range(surface.shape[1]):
        out[w] = 0.0
        if waves.q[w] > 0.0:
            b1, b2 = surface[0, w], surface[1, w]
            second = -2.0 * b1 - kolosov * b2
            first = b1 + half * (b2 - second)
            out[w] = (first + kolosov * second - b1 - kolosov * b2) / waves.q[w]
            surface[0, w], surface[1, w] = first, second


@jit
def strains(tau: Complexes, pressure: Complexes, waves: Waves, found: Complexes, surface: Complexes) -> None:
    """Turn the means of `waves_upwards` into deviatoric strains along x to z, under a pressure `[wave]`.

    `surface` `[3, wave]` are the waves that a free surface reflects downwards, and is overwritten. A component of
    `found` beyond those of `tau` becomes the stress zz.
    """
    nu, mu, n = waves.poissons_ratio, waves.shear, tau.shape[0]
    # 1 / C_11, in 1 / E*
    uniaxial, kolosov, half = (1.0 - 2.0 * nu) / (1.0 - nu) ** 2, 3.0 - 4.0 * nu, 1.0 - 2.0 * nu
    for w in range(tau.shape[2]):
        if waves.q[w] > 0.0:
            pressed = -0.5 * pressure[w] / mu
            surface[0, w] -= half * pressed
            surface[1, w] += pressed
    for j in range(tau.shape[1]):
        for w in range(tau.shape[2]):
            c, s = waves.cosine[w], waves.sine[w]
            b1, b2, b3 = found[0, j, w], found[1, j, w], found[2, j, w]
            if waves.q[w] < 0.0:
                for component in range(found.shape[0]):
                    found[component, j, w] = 0.0
                continue
            turned = _turned(tau, j, w, c, s)
            a1 = a2 = a3 = 0j
            if waves.q[w] > 0.0:
                sent = surface[0, w], surface[1, w], surface[2, w]
                source, h = _sources(turned, nu, mu, 1.0), waves.q[w] * waves.thickness[j]
                below, within = _through(sent, source, h, waves.decay[j, w], waves.mean[j, w])
                surface[0, w], surface[1, w], surface[2, w] = below
                a1, a2, a3 = within
            stress = 2.0 * mu * (a1 + b1) + mu * (1.0 + kolosov) * (a2 + b2)
            if waves.q[w] == 0.0:
                stress -= pressure[w]
            e11, e33 = -a1 - b1, a1 + b1 + 2.0 * half * (a2 + b2) + uniaxial * turned[1]
            if waves.q[w] == 0.0:
                e33 += uniaxial * stress
            e13, e12 = b1 - a1 + half * (b2 - a2) + 0.5 * turned[2] / mu, -0.5 * (a3 + b3)
            e23 = 0.5 * (b3 - a3) + 0.5 * turned[4] / mu
            e22 = -(e11 + e33) / 3.0
            e11, e33 = e11 + e22, e33 + e22
            found[1, j, w] = e33
            if n == 3:
                found[0, j, w], found[2, j, w] = e11, -1j * e13
            else:
                found[0, j, w] = c * c * e11 + s * s * e22 - 2.0 * c * s * e12
                found[2, j, w] = -1j * (c * e13 - s * e23)
                found[3, j, w] = c * s * (e11 - e22) + (c * c - s * s) * e12
                found[4, j, w] = -1j * (s * e13 + c * e23)
            if found.shape[0] > n:
                found[n, j, w] = stress
