"""Displacement, strain and stress inside a body without a period, under tractions on a window of its surface.

In a window of length 1 the fields are an integral over all wave vectors q of the waves of `fields.py`. A sum over the
waves of a period P equals this integral to all digits if the integrand is smooth: the kernel is then zero beyond a
distance of P - 1, where the images of the window are. Near q = 0 the integrand is not smooth, as compliances go as
1/|q|. So the integrand is divided by a function X, where X((P - 1) q) falls from 1 to 0 around some waves. The part 1 -
X(q) is summed over the waves of P = 2, the part X(q) - X(3 q) over the few waves of P = 4, X(3 q) - X(7 q) over those
of P = 8, and so on. The waves that are left are so long that their displacement is uniform, and known: on profiles it
is the logarithm of the last period. Along an axis with a period, P stays 1: the longest waves are then those of a
profile.

Each sum is one of periodic tractions, all lengths in L_x and stresses in E*.
"""

from math import ceil

import numpy as np
from scipy.special import erfc

from gfmd_numba.arrays import Reals
from gfmd_numba.elasticity import fields
from gfmd_numba.elasticity.body import ElasticBody
from gfmd_numba.elasticity.fields import Inside, Surface
from gfmd_numba.elasticity.free_body import beyond_half_space
from gfmd_numba.fourier import grid

_PERIOD = 2.0  # of the first sum, in windows
_FALLS, _WITHIN = 32.0, 8.0  # wave number (1/L_x) around which X falls, and half the way on which it does
_HIGHEST = _FALLS + 4.0 * _WITHIN  # beyond which X is below 1e-8
_SUMS = {1: 30, 2: 18}  # by the axes that end: what stresses miss falls with the period, or its square


def _share(q: Reals, period: float) -> Reals:
    """X of wave numbers, in the sums of longer periods than this."""
    return np.asarray(0.5 * erfc(((period - 1.0) * q - _FALLS) / _WITHIN))


def under_tractions(tractions: Reals, body: ElasticBody, ends: tuple[bool, ...] = ()) -> Inside:
    """Inside of a body under tractions `[component, (y,) x]` (E*), along its surface and out of it, of a window.

    The window `ends` along (y,) x, or along all axes.
    """
    rows, both = fields.in_rows(tractions), (False, *(ends or (True,) * (tractions.ndim - 1)))[-2:]
    shape = rows.shape[1:]
    parts: list[Surface] = []
    shorter, period = 1.0, _PERIOD
    for _ in range(_SUMS[sum(both)]):
        periods = period if both[0] else 1.0, period if both[1] else 1.0
        waves = tuple(round(each) * n for each, n in zip(periods, shape, strict=True))
        if parts:  # fewer waves are left
            most = [2 * ceil(_HIGHEST / (shorter - 1.0) * each / (2.0 * np.pi)) for each in periods]
            waves = tuple(min(some, n) for some, n in zip(most, waves, strict=True))
        q = grid.magnitudes(waves, periods)
        if parts:
            waves_of_window = grid.coefficients_of_window(rows, waves, periods)
        else:
            around = ((0, 0), *((0, n - held) for n, held in zip(waves, shape, strict=True)))
            waves_of_window = grid.coefficients(np.pad(rows, around), 2)
        share = (_share(q, shorter) if parts else 1.0) - _share(q, period)
        parts.append(fields.surface_under_waves(share * waves_of_window, waves, body, periods))
        shorter, period = period, 2.0 * period
    x, y, z = map(float, _left(rows, body, both, shorter))
    return Inside(tuple(parts), body, (x, y, z))


def _left(rows: Reals, body: ElasticBody, ends: tuple[bool, ...], period: float) -> Reals:
    """Displacement along x, y and z `[component]` in all waves of a half-space that are longer than those of the sums.

    These waves feel the base of layers alone. The displacement by a line load is zero at a distance of one window.
    """
    force = rows.mean(axis=(1, 2))
    if body.aspect_ratio is not None:
        return np.zeros(3)
    base = body.material(np.inf)
    along, across = 1.0 / base.modulus, 0.5 / base.shear
    if all(ends):
        softness = np.array([along + across, along + across, 2.0 * along])
        return np.asarray(_FALLS / (period - 1.0) / (2.0 * np.pi) * force * softness)
    nodes, weights = np.polynomial.hermite.hermgauss(12)
    of_share = float(weights @ np.log(_FALLS + _WITHIN * nodes)) / np.sqrt(np.pi) - np.log(period - 1.0)
    softness = np.array([along, across, along] if ends[1] else [across, along, along])
    by_layers = np.array([0.0, 0.0, 0.0 if body.stack is None else beyond_half_space(body, np.ones(1))[0]])
    return np.asarray((2.0 / np.pi * (np.euler_gamma + of_share) * softness - by_layers) * force)
