"""What the error of an extrapolated kappa is made of, source by source."""

from collections.abc import Sequence

import numpy as np

from gfmd_numba.analysis.least_squares import Block, project, search
from gfmd_numba.analysis.selection import LIMITS, Array

SOURCES = (*LIMITS, "sampling", "residual")
_POINTS = 8  # of a quadrature over the range of an exponent, in which kappa_tfc is nearly linear


def error_budget(
    blocks: Sequence[Block],
    names: Sequence[str],
    ends: Array,
    alpha: Array,
    sampling: Array,
    residuals: Sequence[Array],
) -> Array:
    """Return what each of `SOURCES` adds to the error of kappa_tfc (group, source), nan for limits not varied.

    A limit: the standard deviation as the guess of its exponent goes over the range `ends`, others in the middle of
    theirs; zero for an exact one and for one without a range, whose uncertainty is part of the `sampling` (group), a
    standard error. The residual: the most that errors of the cases' means `residuals` (case) can add up to.
    """
    budget = np.full((len(blocks), len(SOURCES)), np.nan)
    points, weights = np.polynomial.legendre.leggauss(_POINTS)
    for index, name in enumerate(names):
        low, high = ends[index]
        kappa = np.zeros((_POINTS, len(blocks)))
        if low < high:
            for row, point in zip(kappa, points, strict=True):
                guess = ends.mean(axis=1)
                guess[index] = low + (high - low) * (1 + point) / 2
                row[:] = limits(blocks, search(blocks, alpha, ends, guess)[0])
        spread = np.sqrt(weights / 2 @ (kappa - weights / 2 @ kappa) ** 2)
        varied = [index in block.limits for block in blocks]
        budget[varied, SOURCES.index(name)] = spread[varied]
    budget[:, SOURCES.index("sampling")] = sampling
    for row, block, residual in zip(budget, blocks, residuals, strict=True):
        row[SOURCES.index("residual")] = abs(_weights(block, ends, alpha)) @ residual
    return budget


def limits(blocks: Sequence[Block], alpha: Array) -> list[float]:
    """Return kappa_tfc of each block at given exponents."""
    return [float(beta[0]) for beta in project(blocks, alpha)[2]]


def _weights(block: Block, ends: Array, alpha: Array) -> Array:
    """Return how much of each case's mean enters kappa_tfc, exponents that are searched for moving along."""
    powers = np.exp(block.log_ratio * alpha[block.limits])
    slopes = block.log_ratio * powers * project([block], alpha)[2][0][1:]
    known = ends[block.limits]
    moving = ~(known[:, 0] == known[:, 1])
    columns = block.whitener @ np.column_stack([np.ones(len(powers)), powers, slopes[:, moving]])
    certainty = np.nan_to_num(np.sqrt(12.0) / np.diff(known[moving]).ravel())
    prior = np.hstack([np.zeros((moving.sum(), 1 + len(known))), np.diag(certainty)])
    return np.asarray(np.linalg.pinv(np.vstack([columns, prior]))[0, : len(powers)] @ block.whitener)
