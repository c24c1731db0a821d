"""Anisotropic K-correlation models in two dimensions, per w^2; normalised like `spectra`.

The thesis prints both spectra 2 pi times too large for its own (3.14), and leaves sqrt(2H) out of the lengths.
"""

from dataclasses import dataclass
from typing import ClassVar, Literal, Protocol

import numpy as np
from scipy.special import gamma

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness.spectra import matern


class AnisotropicModel(Protocol):
    """Model of a map whose two directions differ."""

    @property
    def isotropic(self) -> Literal[False]: ...  # noqa: D102
    @property
    def dimension(self) -> int: ...  # noqa: D102
    @property
    def hurst(self) -> float: ...  # noqa: D102
    @property
    def correlation_length(self) -> float: ...  # noqa: D102
    def psd(self, q_x: Reals, q_y: Reals) -> Reals: ...  # noqa: D102
    def autocorrelation(self, x: Reals, y: Reals) -> Reals: ...  # noqa: D102


@dataclass(frozen=True)
class LengthAnisotropicSpectrum:
    """One Hurst exponent, two correlation lengths (x, y) (3.15); raises ValueError for values out of range."""

    isotropic: ClassVar[Literal[False]] = False
    dimension: ClassVar[int] = 2
    hurst: float
    correlation_lengths: tuple[float, float]

    def __post_init__(self) -> None:
        _check(self.correlation_lengths, (self.hurst,))

    @property
    def correlation_length(self) -> float:
        """Mean of both correlation lengths."""
        return sum(self.correlation_lengths) / 2.0

    def psd(self, q_x: Reals, q_y: Reals) -> Reals:
        """Spectral density `[...]` at wave vectors (q_x, q_y) (3.15 over 2 pi)."""
        x, y = self.correlation_lengths
        ellipse = (q_x * x) ** 2 + (q_y * y) ** 2
        return np.asarray(self.hurst * x * y / np.pi * (1.0 + ellipse) ** (-1.0 - self.hurst))

    def autocorrelation(self, x: Reals, y: Reals) -> Reals:
        """Autocorrelation `[...]` at shifts (x, y)."""
        return matern(np.hypot(x / self.correlation_lengths[0], y / self.correlation_lengths[1]), self.hurst)


@dataclass(frozen=True)
class ScalingAnisotropicSpectrum:
    """Hurst exponent and correlation length of each direction (x, y) (3.16); ValueError for values out of range."""

    isotropic: ClassVar[Literal[False]] = False
    dimension: ClassVar[int] = 2
    hursts: tuple[float, float]
    correlation_lengths: tuple[float, float]

    def __post_init__(self) -> None:
        _check(self.correlation_lengths, self.hursts)

    @property
    def hurst(self) -> float:
        """Mean of both Hurst exponents."""
        return sum(self.hursts) / 2.0

    @property
    def correlation_length(self) -> float:
        """Mean of both correlation lengths."""
        return sum(self.correlation_lengths) / 2.0

    def psd(self, q_x: Reals, q_y: Reals) -> Reals:
        """Spectral density `[...]` at wave vectors (q_x, q_y) (3.16 over 2 pi)."""
        found = np.ones(())
        for q, length, hurst in zip((q_x, q_y), self.correlation_lengths, self.hursts, strict=True):
            peak = length * gamma(hurst + 0.5) / (np.sqrt(np.pi) * gamma(hurst))
            found = found * peak * (1.0 + (q * length) ** 2) ** (-0.5 - hurst)
        return np.asarray(found)

    def autocorrelation(self, x: Reals, y: Reals) -> Reals:
        """Autocorrelation `[...]` at shifts (x, y): the product of those of the two directions."""
        first, second = (
            matern(abs(shift) / length, hurst)
            for shift, length, hurst in zip((x, y), self.correlation_lengths, self.hursts, strict=True)
        )
        return np.asarray(first * second)


def _check(lengths: tuple[float, float], hursts: tuple[float, ...]) -> None:
    for hurst in hursts:
        if not 0.0 < hurst <= 1.0:
            raise ValueError(f"a Hurst exponent of {hurst:g}, not above 0 and at most 1")
    for length in lengths:
        if not 0.0 < length < np.inf:
            raise ValueError(f"a correlation length of {length:g}, not above 0")
