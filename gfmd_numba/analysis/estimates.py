"""What a fit of thesis (4.3) finds: the parameters it estimates, and all that is said of one group."""

from dataclasses import dataclass
from itertools import combinations
from typing import Literal, Self

import numpy as np

from gfmd_numba.analysis.selection import LIMITS
from gfmd_numba.arrays import Reals

PAIRS = tuple(combinations(LIMITS, 2))
STEPS = 48  # of the curve through the levels of a limit

_CORRECTION, _COEFFICIENT, _EXPONENT = (slice(1 + i * len(LIMITS), 1 + (i + 1) * len(LIMITS)) for i in range(3))
_INTERACTION = slice(1 + 3 * len(LIMITS), 1 + 3 * len(LIMITS) + len(PAIRS))


@dataclass(frozen=True)
class Estimates:
    """The parameters (..., parameter) of fits, or their errors; nan for those of limits that do not enter.

    Its properties are views: writing to them changes the table.
    """

    table: Reals

    @classmethod
    def unknown(cls, *shape: int) -> Self:
        """Return parameters (*shape, parameter) that are all nan."""
        return cls(np.full((*shape, _INTERACTION.stop), np.nan))

    @property
    def tfc(self) -> Reals:
        """Values (...) in the TFC limit."""
        return self.table[..., 0]

    @property
    def correction(self) -> Reals:
        """Values C x (..., limit) at the reference discretisation."""
        return self.table[..., _CORRECTION]

    @property
    def interaction(self) -> Reals:
        """Values C_ij x_i x_j (..., pair) at the reference discretisation."""
        return self.table[..., _INTERACTION]

    @property
    def coefficient(self) -> Reals:
        """Coefficients C (..., limit)."""
        return self.table[..., _COEFFICIENT]

    @property
    def exponent(self) -> Reals:
        """Exponents alpha (..., limit), of other laws than powers that of the tangent at the reference."""
        return self.table[..., _EXPONENT]


@dataclass(frozen=True)
class GroupFit:
    """What a fit says of one group: `budget` is the error of the TFC limit (source); nan where the fit is refused."""

    status: Literal["ok", "refused"]
    message: str
    estimate: Estimates
    error: Estimates
    low: float  # ends of the 90 % interval of the TFC limit
    high: float
    budget: Reals
    rms_residual: float
    chi2: float
    misfit: float  # factor on the errors of the means that makes the laws describe them, 1 where they do
    freedom: int  # means less coefficients
    laws: list[str]  # (limit)
    extrapolated: Reals  # fit at the finest level of each limit less the limit (limit)
    extrapolation_error: Reals  # what this distance adds to the error of the TFC limit (limit)
    contradiction: Reals  # what the TFC limit differs by where an asserted exponent may have its range (limit)
    curve: tuple[Reals, Reals]  # eps and values (limit, step) along each limit
