"""What is known of the exponents of thesis (4.3) before they are fitted: a value, a range, or nothing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Self

import numpy as np
from numpy.typing import NDArray

from gfmd_numba.analysis.selection import LIMITS
from gfmd_numba.arrays import Flags, Reals

Given = Mapping[str, tuple[float, float]]  # ends of the range of each exponent that is not free


@dataclass(frozen=True)
class Ranges:
    """Ends (limit) of the range each exponent lies in: equal if it is exact, nan if it is free."""

    names: Sequence[str]
    low: Reals
    high: Reals

    @classmethod
    def of(cls, names: Sequence[str], given: Given) -> Self:
        """Return the ranges of some limits' exponents."""
        low, high = np.array([given.get(name, (np.nan, np.nan)) for name in names]).T
        return cls(names, low, high)

    @property
    def free(self) -> NDArray[np.intp]:
        """Exponents of which nothing is known."""
        return np.flatnonzero(np.isnan(self.low))

    @property
    def exact(self) -> Flags:
        """Which exponents are known exactly (limit)."""
        return np.asarray(self.low == self.high)

    @property
    def any_wide(self) -> bool:
        """Whether any exponent is known to a range only."""
        return bool((self.low < self.high).any())

    @property
    def middle(self) -> Reals:
        """Best guesses (limit), nan of free exponents."""
        return (self.low + self.high) / 2

    @property
    def width(self) -> Reals:
        """Width (limit) of each range."""
        return self.high - self.low

    @property
    def certainty(self) -> Reals:
        """One over the standard deviation (limit) of a uniform distribution over each range, else 0."""
        return np.divide(np.sqrt(12.0), self.width, out=np.zeros(len(self.width)), where=self.width > 0)

    def drawn(self, uniform: Reals) -> Reals:
        """Return guesses (draw, limit) at shares (draw, limit) of the ranges."""
        return self.low + self.width * uniform


def exponent_range(limit: str, value: float | Sequence[float]) -> tuple[float, float]:
    """Return the ends of the range of a fixed exponent; ValueError for another limit or no positive numbers."""
    ends = tuple(value) if isinstance(value, Sequence) else (value, value)
    numbers = len(ends) == 2 and all(isinstance(end, Real) for end in ends)
    if limit not in LIMITS or not numbers or not 0 < ends[0] <= ends[1] < np.inf:
        raise ValueError(
            f"fixed takes a positive exponent, or a range of them as (low, high), for {', '.join(LIMITS)}, "
            f"not {limit!r}: {value!r}"
        )
    return float(ends[0]), float(ends[1])
