"""Fourier transform of exp(-r^(2H)) in one and two dimensions, for every wave number.

The series in powers of q, thesis (3.11), diverges for H < 1/2 and loses all digits for q > 10 otherwise. Below q = 30
the transform is an integral along a ray in the complex plane, where the waves decay and nothing cancels; above,
the series in inverse powers of q has more than enough digits.
"""

import numpy as np
from scipy.special import gammaln, hankel1

from gfmd_numba.arrays import Reals

# outgoing wave, by the dimension, of a phase
_RIPPLE = {1: lambda phase: np.exp(1j * phase), 2: lambda phase: hankel1(0, phase)}
_FAR = 30.0
_TERMS = 60  # of the series for q > 30; they fall by more than a half from one to the next
_STEP = 0.06  # in log r: the trapezoidal rule is then right to rounding
_REACH = 700  # steps below log r = 0, to r = 6e-19
_FADED = 1e3  # phase at which the waves have decayed to less than 1e-160 along the ray
_TABLE = 150  # points a decade; a cubic spline through them errs by 1e-9


def transform(q: Reals, hurst: float, dimension: int) -> Reals:
    """C(q) = (2 pi)^-d times the integral of exp(-r^(2H) - i q.r), 0 < H <= 1 and q >= 0 dimensionless."""
    q = np.asarray(q, dtype=np.float64)
    if hurst == 1.0:
        return np.asarray(np.exp(-(q**2) / 4.0) / (4.0 * np.pi) ** (dimension / 2.0))
    far = q > _FAR
    near_q = q[~far]
    found = np.empty_like(q)
    found[far] = _far(q[far], 2.0 * hurst, dimension)
    found[~far] = _tabulated(near_q, 2.0 * hurst, dimension)
    return found


def _tabulated(q: Reals, alpha: float, dimension: int) -> Reals:
    positive = q[q > 0.0]
    if positive.size:
        low, high = positive.min(), positive.max()
        count = 4 + int(_TABLE * np.log10(high / low))
    if positive.size == 0 or positive.size <= count:
        return _near(q, alpha, dimension)
    from scipy.interpolate import CubicSpline  # it takes longer to import than most contacts to solve

    table = np.geomspace(low, high, count)
    spline = CubicSpline(np.log(table), np.log(_near(table, alpha, dimension)))
    found = np.full_like(q, _near(np.zeros(1), alpha, dimension)[0])
    found[q > 0.0] = np.exp(spline(np.log(positive)))
    return found


def _near(q: Reals, alpha: float, dimension: int) -> Reals:
    angle = min(np.pi / 2.0, np.pi / (4.0 * alpha))
    furthest = np.log((60.0 + 12.0 * dimension / alpha) / np.cos(alpha * angle)) / alpha
    r = np.exp(_STEP * np.arange(-_REACH, furthest / _STEP) + 1j * angle)
    kernel = _STEP * r**dimension * np.exp(-(r**alpha))
    found = np.empty_like(q)
    for i, wave in enumerate(q):
        if wave == 0.0:
            found[i] = kernel.real.sum()
            continue
        phase = wave * r[: np.searchsorted(abs(r), _FADED / wave)]
        ripple = _RIPPLE[dimension](phase)
        found[i] = (kernel[: phase.size] * ripple).real.sum()
    return found / (dimension * np.pi)


def _far(q: Reals, alpha: float, dimension: int) -> Reals:
    k = np.arange(1, _TERMS + 1)
    if dimension == 1:
        log_size = gammaln(alpha * k + 1.0) - gammaln(k + 1.0) - np.log(np.pi)
    else:
        log_size = 2.0 * gammaln(1.0 + alpha * k / 2.0) - gammaln(k + 1.0) + alpha * k * np.log(2.0)
        log_size -= 2.0 * np.log(np.pi)
    sign = -((-1.0) ** k) * np.sin(np.pi * alpha * k / 2.0)
    terms = log_size - (alpha * k + dimension) * np.log(q)[:, np.newaxis]
    return np.asarray((sign * np.exp(terms)).sum(axis=1))
