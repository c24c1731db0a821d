"""Generator of self-affine surfaces by the recursive methods (thesis 3.5.1)."""

from dataclasses import dataclass, replace
from typing import ClassVar, Self

from gfmd_numba.arrays import Reals
from gfmd_numba.roughness import recursive, spectral
from gfmd_numba.roughness.generators import Shape
from gfmd_numba.roughness.power_law import band
from gfmd_numba.roughness.recursive import Recursion
from gfmd_numba.roughness.spectra import SelfAffineSpectrum
from gfmd_numba.scene.records import Discretisation
from gfmd_numba.scene.surfaces import MidpointDisplacement, SuccessiveAddition


@dataclass(frozen=True)
class RecursiveSubdivision:
    """Random midpoint displacement or successive random addition (thesis 3.5.1)."""

    unit_gradient: ClassVar = False
    recursion: Recursion

    @property
    def hurst(self) -> float:
        """Hurst exponent."""
        return self.recursion.hurst

    @property
    def band(self) -> tuple[float, float]:
        """Wave indices of the roll-off and of the cut-on wavelength."""
        return 1.0 / self.recursion.roll_off, 1.0 / self.recursion.cut_on

    def heights(self, shape: Shape, seed: int, realisations: range) -> Reals:
        """Heights `[realisation, (y,) x]` of period 1 and unit rms height in the ensemble."""
        return recursive.surfaces(self.recursion, shape[0], seed, realisations)

    def mean_square_height(self, shape: Shape) -> float:
        """Mean square height of the ensemble, to which the recursion is scaled."""
        return 1.0

    def without_shortest(self, halvings: int) -> Self | None:
        """The same from twice its cut-on wavelength, so often."""
        cut_on = self.recursion.cut_on * 2**halvings
        too_long = 2.0 * cut_on > self.recursion.roll_off
        return None if too_long else replace(self, recursion=replace(self.recursion, cut_on=cut_on))

    def power(self, shape: Shape) -> Reals:
        """Mean power that is asked for, a power law with a plateau; `recursive.power` is that of the recursion."""
        asked = SelfAffineSpectrum(len(shape), self.hurst, self.recursion.cut_on, self.recursion.roll_off, 1.0)
        return spectral.psd_power(asked, shape[0], (shape[0] - 1) // 2)


def generator(
    record: MidpointDisplacement | SuccessiveAddition,
    discretisation: Discretisation | None,
    period: float,
    dimension: int,
    nx: int,
) -> RecursiveSubdivision:
    """Subdivision of a record between its wavelengths, or those of the discretisation."""
    longest, shortest = band(record, discretisation, period)
    return RecursiveSubdivision(Recursion(record.method, dimension, record.hurst, 1.0 / shortest, 1.0 / longest))
