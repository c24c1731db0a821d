"""What the error of an extrapolated kappa is made of, source by source."""

from collections.abc import Sequence

import numpy as np

from gfmd_numba.analysis.exponents import Ranges
from gfmd_numba.analysis.least_squares import WhitenedGroup, project, search
from gfmd_numba.analysis.selection import LIMITS
from gfmd_numba.arrays import Reals

SOURCES = (*LIMITS, "sampling", "residual")
_POINTS = 8  # of a quadrature over the range of an exponent, in which kappa_tfc is nearly linear


def error_budget(
    blocks: Sequence[WhitenedGroup],
    ranges: Ranges,
    alpha: Reals,
    sampling: Reals,
    residuals: Sequence[Reals],
) -> Reals:
    """Return what each of `SOURCES` adds to the error of kappa_tfc (group, source), nan for limits not varied.

    A limit: the standard deviation as the guess of its exponent goes over its range, others in the middle of
    theirs; zero for an exact one and for one without a range, whose uncertainty is part of the `sampling` (group), a
    standard error. The residual: the most that errors of the cases' means `residuals` (case) can add up to.
    """
    budget = np.full((len(blocks), len(SOURCES)), np.nan)
    points, weights = np.polynomial.legendre.leggauss(_POINTS)
    for index, (name, low, high) in enumerate(zip(ranges.names, ranges.low, ranges.high, strict=True)):
        kappa = np.zeros((_POINTS, len(blocks)))
        if low < high:
            for row, point in zip(kappa, points, strict=True):
                guess = ranges.middle
                guess[index] = low + (high - low) * (1 + point) / 2
                row[:] = limits(blocks, search(blocks, alpha, ranges, guess)[0])
        spread = np.sqrt(weights / 2 @ (kappa - weights / 2 @ kappa) ** 2)
        varied = [index in block.limits for block in blocks]
        budget[varied, SOURCES.index(name)] = spread[varied]
    budget[:, SOURCES.index("sampling")] = sampling
    for row, block, residual in zip(budget, blocks, residuals, strict=True):
        row[SOURCES.index("residual")] = abs(_weights(block, ranges, alpha)) @ residual
    return budget


def limits(blocks: Sequence[WhitenedGroup], alpha: Reals) -> list[float]:
    """Return kappa_tfc of each block at given exponents."""
    return [float(beta[0]) for beta in project(blocks, alpha)[2]]


def _weights(block: WhitenedGroup, ranges: Ranges, alpha: Reals) -> Reals:
    """Return how much of each case's mean enters kappa_tfc, exponents that are searched for moving along."""
    powers = np.exp(block.log_ratio * alpha[block.limits])
    slopes = block.log_ratio * powers * project([block], alpha)[2][0][1:]
    moving = ~ranges.exact[block.limits]
    columns = block.whitener @ np.column_stack([np.ones(len(powers)), powers, slopes[:, moving]])
    certainty = ranges.certainty[block.limits][moving]
    prior = np.hstack([np.zeros((moving.sum(), 1 + len(moving))), np.diag(certainty)])
    return np.asarray(np.linalg.pinv(np.vstack([columns, prior]))[0, : len(powers)] @ block.whitener)
