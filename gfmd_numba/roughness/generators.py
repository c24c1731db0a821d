"""What every generator of random surfaces is, and the ensemble that a record of one describes.

Lengths are in periods, wave indices count them. Each kind of generator has a file of its own, and its record in
`gfmd_numba.scene.surfaces` names the function there that makes it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import Any, Protocol, Self

import numpy as np

from gfmd_numba.arrays import Indices, Reals
from gfmd_numba.roughness import statistics
from gfmd_numba.scene.records import Discretisation
from gfmd_numba.scene.surfaces import PowerLaw, Random

Shape = tuple[int, ...]


class Generator(Protocol):
    """A way to draw surfaces whose random numbers belong to (seed, realisation, wave)."""

    @property
    def unit_gradient(self) -> bool:
        """Whether each surface that it draws has an rms gradient of 1."""

    @property
    def hurst(self) -> float:
        """Hurst exponent."""

    @property
    def band(self) -> tuple[float, float]:
        """Wave indices between which the spectrum falls as a power law: below it rolls off, above it ends."""

    def heights(self, shape: Shape, seed: int, realisations: range) -> Reals:
        """Heights `[realisation, (y,) x]` of period 1 and zero mean, on no particular scale."""

    def mean_square_height(self, shape: Shape) -> float:
        """Mean square height that theory expects of what `heights` draws, averaged over the ensemble."""

    def power(self, shape: Shape) -> Reals:
        """Mean power `[(y,) nx // 2 + 1]` of the coefficients that theory expects, on no particular scale."""

    def without_shortest(self, halvings: int) -> Self | None:
        """The same with its largest wave index halved so often, or None where no waves would be left."""


@dataclass(frozen=True)
class RandomSurface:
    """An ensemble of periodic surfaces `[nx]` or `[nx, nx]` in units of their period and their rms gradient.

    Each surface is scaled to the same rms gradient, 1, or, where `by_height`, to the same rms height: that of an
    ensemble whose rms gradient is 1 in theory. Where `by_theory`, all surfaces are scaled by one factor, with
    which theory expects of the ensemble what each surface has otherwise. A patch without a period, of nx nodes a side,
    is the corner of a surface of that many `periods` of its length, which its generator and its scale belong to.
    """

    generator: Generator
    nx: int
    seed: int
    dimension: int = 1
    by_height: bool = False
    by_theory: bool = False
    periods: int = 1

    @property
    def shape(self) -> Shape:
        """Shape of a surface, (nx,) or (ny, nx)."""
        return (self.nx,) * self.dimension

    @property
    def whole(self) -> Shape:
        """Shape of the periodic surface that a patch is cut from; the same without one."""
        return tuple(self.periods * n for n in self.shape)

    @property
    def nodes(self) -> int:
        """Number of its nodes."""
        return math.prod(self.shape)

    def heights(self, realisations: range) -> Reals:
        """Heights `[realisation, (y,) x]` of zero mean; raises ValueError for a grid that cannot hold the waves."""
        drawn = self._periodic(realisations)
        if self.periods == 1:
            return drawn
        corner: Any = (..., *(slice(n) for n in self.shape))
        patch = self.periods * drawn[corner]
        return np.asarray(patch - patch.mean(axis=tuple(range(1, patch.ndim)), keepdims=True))

    def _periodic(self, realisations: range) -> Reals:
        drawn = self.generator.heights(self.whole, self.seed, realisations)
        periods = (1.0,) * self.dimension
        if self.by_theory:
            height = np.sqrt(self.generator.mean_square_height(self.whole))
            centred = drawn - drawn.mean(axis=tuple(range(1, drawn.ndim)), keepdims=True)
            return np.asarray(centred / (height * gradient_over_height(self.generator, self.whole)))
        if self.by_height:
            return statistics.scaled(drawn, periods, rms_height=1.0 / gradient_over_height(self.generator, self.whole))
        return drawn if self.generator.unit_gradient else statistics.scaled(drawn, periods, rms_gradient=1.0)


def gradient_over_height(generator: Generator, shape: Shape) -> float:
    """Rms gradient that theory expects of surfaces of unit rms height, per period."""
    power, periods = generator.power(shape), (1.0,) * len(shape)
    second, zeroth = (statistics.moment_of_power(power, shape, order, periods) for order in (2, 0))
    return float(np.sqrt(second / zeroth))


def band(record: PowerLaw, discretisation: Discretisation | None) -> tuple[float, float]:
    """Wave indices of the longest and the shortest wavelength: those of the record, or of the discretisation."""
    if record.cut_on is not None and record.roll_off is not None:
        return 1.0 / record.roll_off, 1.0 / record.cut_on
    assert discretisation is not None  # the loader's promise
    return float(discretisation.longest_wave_index), discretisation.shortest_wave_index


def power_law(index: Reals | Indices, exponent: float, band: tuple[float, float], plateau: bool = True) -> Reals:
    """Power law `[...]` of wave indices between the two of a band, with a plateau below it or nothing (3.28)."""
    longest, shortest = band
    kept = (index >= (0.5 if plateau else longest) * (1.0 - 1e-12)) & (index <= shortest * (1.0 + 1e-12))
    return np.where(kept, np.maximum(index, longest) ** -exponent, 0.0)


def random_surface(
    record: Random, discretisation: Discretisation | None, dimension: int, seed: int, periods: int = 1
) -> tuple[RandomSurface, float]:
    """Ensemble of a record, or of patches of so many periods, and the rms gradient asked of it.

    Lengths of the record are in all these periods. Grid and wavelengths that it leaves open are those of the
    discretisation. Where it asks for an rms height, theory tells the gradient. Raises ValueError for lengths that do
    not go with the period.
    """
    if discretisation is not None and periods > 1:
        discretisation = discretisation.model_copy(update={"eps_t": discretisation.eps_t / periods})
    nx = discretisation.nx if record.points is None and discretisation is not None else record.points
    assert nx is not None  # the records' promise
    if record.points is not None:
        nx *= periods
    make: Callable[..., Generator] = resolve_name(record.implementation)
    surface = RandomSurface(
        make(record, discretisation, dimension, nx),
        nx // periods,
        seed,
        dimension,
        by_height=record.rms_height is not None and record.scaling == "each",
        by_theory=record.scaling == "ensemble",
        periods=periods,
    )
    if record.rms_gradient is None:
        assert record.rms_height is not None  # the record's promise
        return surface, record.rms_height * gradient_over_height(surface.generator, surface.whole)
    if record.points is not None and not record.by_columns:
        surface.generator.power(surface.whole)  # which may refuse the record
    return surface, record.rms_gradient
