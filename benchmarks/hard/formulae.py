"""Formulae where the textbook's lose their digits: stiffness of a slab, rms gradient."""

import time

import mpmath
import numpy as np
import slab_stiffness

from gfmd_numba.roughness import self_affine, statistics
from hard.rows import row


def textbook(k, nu):
    """Ratio of slab to half-space by hyperbolic functions as (6.58) has them."""
    r, s = 1 / (3 - 4 * nu), (1 - 2 * nu) / (2 * (1 - nu))
    f = np.sinh(k) ** 2 - (r * k) ** 2
    m11, m33 = ((1 - r) * (np.cosh(k) * np.sinh(k) + sign * r * k) / f for sign in (-1, 1))
    m13 = (1 - r) / (1 + r) * ((1 - r) * np.sinh(k) ** 2 - 2 * (r * k) ** 2) / f
    return 2 * (1 - nu) ** 2 / (1 - 2 * nu) * (m33 - m13**2 / m11) if s else np.full_like(k, np.nan)


def exact(k, nu):
    with mpmath.workdps(60):
        k, kappa = mpmath.mpf(k), 3 - 4 * mpmath.mpf(nu)
        if k > 500:
            return 1.0
        x = 2 * k
        top = 2 * kappa * mpmath.cosh(x) + 1 + kappa**2 + x**2
        return float(top / (2 * kappa * mpmath.sinh(x) - 2 * x))


def slabs():
    k = np.logspace(-8, 8, 161)
    for nu in (0.33, 0.499999, 0.5):
        truth = np.array([exact(one, nu) for one in k])
        naive = textbook(k, nu)
        usable = np.isfinite(naive)
        worst = abs(naive / truth - 1)[usable]
        said = f"nan for {(~usable).sum()} of {k.size} wave numbers"
        said += f", {(worst > 0.01).sum()} more off by over 1 %" if usable.any() else ""
        begun = time.perf_counter()
        ours = slab_stiffness.slab_factor(k, nu)
        cost = (time.perf_counter() - begun) / k.size
        error = abs(ours / truth - 1).max()
        row(
            f"slab, ν = {nu:g}, q z_m from 1e-8 to 1e8",
            said,
            "a number for each",
            f"{error:.0e}",
            f"{cost * 1e9:.0f} ns",
        )


def gradients():
    for hurst in (0.0, 1.0):
        heights = self_affine.SelfAffineWaves(hurst, 2, 256).heights((1024,), 1, range(1))[0]
        naive = np.sqrt((np.gradient(heights, 1 / 1024) ** 2).mean())
        begun = time.perf_counter()
        ours = float(statistics.rms_gradient(heights))
        row(
            f"rms gradient, H = {hurst:g}, 4 nodes a wave",
            f"finite differences {naive - 1:+.0%}",
            "Parseval's sum",
            f"{abs(ours - 1):.0e}",
            f"{(time.perf_counter() - begun) * 1e6:.0f} µs",
        )
