"""Models of roughness: power spectral density, autocorrelation and moments, all per w^2.

The spectral density C(q) is two-sided and integrates to 1 over all of q-space, so that a surface of rms height w and
period L has the mean power <|h~(q)|^2> = w^2 C(q) (2 pi / L)^d. The height-height correlation is 2 w^2 (1 - R).

Of the two models of maps whose directions differ, the thesis prints the spectra 2 pi times too large for its own
(3.14), and leaves sqrt(2H) out of the lengths.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
import scipy  # its modules load with their first use

from gfmd_numba.arrays import Reals

# mean of a wave over the directions from a point, by the dimension
_RIPPLE: dict[int, Callable[[Reals], Reals]] = {1: np.cos, 2: lambda phase: scipy.special.j0(phase)}
_FAR = 30.0
_TERMS = 60  # of the series for q > 30; they fall by more than a half from one to the next
_STEP = 0.06  # in log r: the trapezoidal rule is then right to rounding
_REACH = 700  # steps below log r = 0, to r = 6e-19
_FADED = 1e3  # phase at which the waves have decayed to less than 1e-160 along the ray
_TABLE = 150  # points a decade; a cubic spline through them errs by 1e-9


@dataclass(frozen=True)
class _Correlated:
    """Isotropic model of a Hurst exponent 0 < H <= 1 and a correlation length."""

    isotropic: ClassVar[Literal[True]] = True
    dimension: int
    hurst: float
    correlation_length: float


class ExponentialSpectrum(_Correlated):
    """Exponential correlation model R = exp(-(r/xi)^(2H)) (3.10, its exponent as in 3.9)."""

    def autocorrelation(self, distance: Reals) -> Reals:
        """Autocorrelation R `[...]` at distances r >= 0 (3.10)."""
        return np.exp(-((distance / self.correlation_length) ** (2.0 * self.hurst)))

    def psd(self, q: Reals) -> Reals:
        """Spectral density `[...]` at wave numbers q (3.11)."""
        scale = self.correlation_length
        return scale**self.dimension * stretched_exponential(q * scale, self.hurst, self.dimension)


class KCorrelationSpectrum(_Correlated):
    """K-correlation model, whose spectrum is (1 + q^2 xi^2 / 2H)^-(H + d/2) (3.12-3.14)."""

    def autocorrelation(self, distance: Reals) -> Reals:
        """Autocorrelation R `[...]` at distances r >= 0 (3.13)."""
        return matern(distance * np.sqrt(2.0 * self.hurst) / self.correlation_length, self.hurst)

    def psd(self, q: Reals) -> Reals:
        """Spectral density `[...]` at wave numbers q (3.14)."""
        a = self.correlation_length**2 / (2.0 * self.hurst)
        return _k_correlation_peak(self) * (1.0 + a * q**2) ** (-self.hurst - self.dimension / 2.0)


@dataclass(frozen=True)
class Mounded:
    """Mounds of mean separation lambda on a self-affine model: its correlation times cos or J0 (3.17)."""

    isotropic: ClassVar[Literal[True]] = True
    model: ExponentialSpectrum | KCorrelationSpectrum
    separation: float

    @property
    def dimension(self) -> int:
        """Dimension of the reference plane."""
        return self.model.dimension

    @property
    def hurst(self) -> float:
        """Hurst exponent of the model under the mounds."""
        return self.model.hurst

    @property
    def correlation_length(self) -> float:
        """Correlation length of the mounds, in the unit of the period."""
        return self.model.correlation_length

    def autocorrelation(self, distance: Reals) -> Reals:
        """Autocorrelation R `[...]` at distances r >= 0 (3.17, with the minus its exponent lacks)."""
        wave = 2.0 * np.pi * distance / self.separation
        return np.asarray(self.model.autocorrelation(distance) * _RIPPLE[self.dimension](wave))

    def psd(self, q: Reals) -> Reals:
        """Spectral density `[...]` at wave numbers q (3.18, 3.20, 3.22).

        The factor cos or J0 is the transform of two points or of a ring at q_m = 2 pi/lambda: the spectrum is that
        of the model averaged over them, a sum of positive terms where (3.18) is a difference of huge ones.
        """
        return _AROUND[self.dimension](self.model, q, 2.0 * np.pi / self.separation)


def matern(z: Reals, order: float) -> Reals:
    """Correlation 2^(1-H) / Gamma(H) z^H K_H(z) `[...]` of z >= 0, which is 1 at z = 0 (3.13)."""
    with np.errstate(invalid="ignore"):
        found = 2.0 * np.exp(-scipy.special.gammaln(order)) * (z / 2.0) ** order * scipy.special.kv(order, z)
    return np.where(z == 0.0, 1.0, found)


class _Anisotropic:
    """Model of two correlation lengths (x, y)."""

    isotropic: ClassVar[Literal[False]] = False
    dimension: ClassVar[int] = 2
    correlation_lengths: tuple[float, float]

    @property
    def correlation_length(self) -> float:
        """Mean of both correlation lengths."""
        return sum(self.correlation_lengths) / 2.0


@dataclass(frozen=True)
class LengthAnisotropicSpectrum(_Anisotropic):
    """One Hurst exponent, two correlation lengths (x, y) (3.15)."""

    hurst: float
    correlation_lengths: tuple[float, float]

    def psd(self, q_x: Reals, q_y: Reals) -> Reals:
        """Spectral density `[...]` at wave vectors (q_x, q_y) (3.15 over 2 pi)."""
        x, y = self.correlation_lengths
        ellipse = (q_x * x) ** 2 + (q_y * y) ** 2
        return np.asarray(self.hurst * x * y / np.pi * (1.0 + ellipse) ** (-1.0 - self.hurst))

    def autocorrelation(self, x: Reals, y: Reals) -> Reals:
        """Autocorrelation `[...]` at shifts (x, y)."""
        return matern(np.hypot(x / self.correlation_lengths[0], y / self.correlation_lengths[1]), self.hurst)


@dataclass(frozen=True)
class ScalingAnisotropicSpectrum(_Anisotropic):
    """Hurst exponent and correlation length of each direction (x, y) (3.16)."""

    hursts: tuple[float, float]
    correlation_lengths: tuple[float, float]

    @property
    def hurst(self) -> float:
        """Mean of both Hurst exponents."""
        return sum(self.hursts) / 2.0

    def psd(self, q_x: Reals, q_y: Reals) -> Reals:
        """Spectral density `[...]` at wave vectors (q_x, q_y) (3.16 over 2 pi)."""
        found = np.ones(())
        for q, length, hurst in zip((q_x, q_y), self.correlation_lengths, self.hursts, strict=True):
            peak = length * scipy.special.gamma(hurst + 0.5) / (np.sqrt(np.pi) * scipy.special.gamma(hurst))
            found = found * peak * (1.0 + (q * length) ** 2) ** (-0.5 - hurst)
        return np.asarray(found)

    def autocorrelation(self, x: Reals, y: Reals) -> Reals:
        """Autocorrelation `[...]` at shifts (x, y): the product of those of the two directions."""
        first, second = (
            matern(abs(shift) / length, hurst)
            for shift, length, hurst in zip((x, y), self.correlation_lengths, self.hursts, strict=True)
        )
        return np.asarray(first * second)


# models with an autocorrelation function in closed form, and the correlation length that they are built on
Isotropic = ExponentialSpectrum | KCorrelationSpectrum | Mounded
Anisotropic = LengthAnisotropicSpectrum | ScalingAnisotropicSpectrum  # of maps whose two directions differ


def _k_correlation_peak(model: KCorrelationSpectrum) -> float:
    scale, h, d = model.correlation_length / np.sqrt(2.0 * model.hurst), model.hurst, model.dimension
    return float(scale**d * np.exp(scipy.special.gammaln(h + d / 2.0) - scipy.special.gammaln(h)) / np.pi ** (d / 2.0))


def _pair(model: KCorrelationSpectrum | ExponentialSpectrum, q: Reals, mound: float) -> Reals:
    """Mean of a model over the two places so far from the origin."""
    return 0.5 * (model.psd(abs(q - mound)) + model.psd(q + mound))


def _ring(model: KCorrelationSpectrum | ExponentialSpectrum, q: Reals, mound: float) -> Reals:
    """Mean of a model over the ring of all places so far from the origin."""
    if isinstance(model, KCorrelationSpectrum):
        # the hypergeometric series (3.20, 3.21), transformed to one that converges for every q
        h, a = model.hurst, model.correlation_length**2 / (2.0 * model.hurst)
        centre = 1.0 + a * (q**2 + mound**2)
        # (1 - b^2) without cancellation: the density at the nearest and furthest point of the ring
        ends = (1.0 + a * (q - mound) ** 2) * (1.0 + a * (q + mound) ** 2)
        b_squared = (2.0 * a * q * mound / centre) ** 2
        series = scipy.special.hyp2f1((1.0 - h) / 2.0, -h / 2.0, 1.0, b_squared)
        return np.asarray(_k_correlation_peak(model) * centre**h * ends ** (-h - 0.5) * series)
    # tanh-sinh points gather where the circle comes nearest to the peak, which is sharp for small H
    t = np.arange(-60, 61) / 16.0
    part = 1.0 / (1.0 + np.exp(-np.pi * np.sinh(t)))
    angles, weights = np.pi * part, np.pi * np.cosh(t) * part * (1.0 - part) / 16.0
    q = np.asarray(q, dtype=np.float64)
    apart = np.sqrt((q[..., np.newaxis] - mound) ** 2 + 4.0 * q[..., np.newaxis] * mound * np.sin(angles / 2.0) ** 2)
    return np.asarray(model.psd(apart.ravel()).reshape(apart.shape) @ weights)


_AROUND = {1: _pair, 2: _ring}
# outgoing wave, by the dimension, of a phase
_WAVE = {1: lambda phase: np.exp(1j * phase), 2: lambda phase: scipy.special.hankel1(0, phase)}
_LOG_SIZE = {  # of the terms of the series, by the dimension, of alpha k and ln k!
    1: lambda alpha_k, factorial: scipy.special.gammaln(alpha_k + 1.0) - factorial,
    2: lambda alpha_k, factorial: 2.0 * scipy.special.gammaln(1.0 + alpha_k / 2.0) - factorial + alpha_k * np.log(2.0),
}


def stretched_exponential(q: Reals, hurst: float, dimension: int) -> Reals:
    """C(q) = (2 pi)^-d times the integral of exp(-r^(2H) - i q.r), 0 < H <= 1 and q >= 0 dimensionless.

    The series in powers of q, thesis (3.11), diverges for H < 1/2 and loses all digits for q > 10 otherwise. Below
    q = 30 the transform is an integral along a ray in the complex plane, where the waves decay and nothing cancels;
    above, the series in inverse powers of q has more than enough digits.
    """
    q = np.asarray(q, dtype=np.float64)
    if hurst == 1.0:
        return np.asarray(np.exp(-(q**2) / 4.0) / (4.0 * np.pi) ** (dimension / 2.0))
    far = q > _FAR
    near_q = q[~far]
    found = np.empty_like(q)
    found[far] = _far(q[far], 2.0 * hurst, dimension)
    positive = near_q[near_q > 0.0]
    low, high = positive.min(initial=np.inf), positive.max(initial=0.0)
    if positive.size <= (count := 4 + int(_TABLE * np.log10(high / low)) if positive.size else 0):
        found[~far] = _near(near_q, 2.0 * hurst, dimension)
        return found
    from scipy.interpolate import CubicSpline  # it takes longer to import than most contacts to solve

    table = np.geomspace(low, high, count)
    spline = CubicSpline(np.log(table), np.log(_near(table, 2.0 * hurst, dimension)))
    found[q == 0.0] = _near(np.zeros(1), 2.0 * hurst, dimension)[0]
    found[~far & (q > 0.0)] = np.exp(spline(np.log(positive)))
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
        ripple = _WAVE[dimension](phase)
        found[i] = (kernel[: phase.size] * ripple).real.sum()
    return found / (dimension * np.pi)


def _far(q: Reals, alpha: float, dimension: int) -> Reals:
    k = np.arange(1, _TERMS + 1)
    log_size = _LOG_SIZE[dimension](alpha * k, scipy.special.gammaln(k + 1.0)) - dimension * np.log(np.pi)
    sign = -((-1.0) ** k) * np.sin(np.pi * alpha * k / 2.0)
    terms = log_size - (alpha * k + dimension) * np.log(q)[:, np.newaxis]
    return np.asarray((sign * np.exp(terms)).sum(axis=1))
