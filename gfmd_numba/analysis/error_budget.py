"""What the error of a TFC limit is made of, source by source."""

from collections.abc import Sequence

import numpy as np

from gfmd_numba.analysis.linear_fit import Means, as_if_exact, known_before, linear
from gfmd_numba.analysis.posterior import Choice
from gfmd_numba.analysis.selection import LIMITS
from gfmd_numba.arrays import Reals

SOURCES = (*LIMITS, "interaction", "sampling", "extrapolation", "rivals", "residual")


def error_budget(
    index: int, means: Means, choices: Sequence[Choice], shares: Sequence[Reals], residuals: Reals
) -> Reals:
    """Return what each of `SOURCES` adds to the error of a group's TFC limit (source), nan for limits not varied.

    A limit: its law and the parameters of it, which are not known. The interaction: that what is known before of
    corrections taken together is not exact. Sampling: the surfaces. In quadrature these make the whole error of the
    fit. What is added to it, for the distance of extrapolation and for rivals that disagree, is left at 0. The
    residual: the most that errors of the cases' means `residuals` (case), also by divisions of time, can add up to.
    """
    weight = np.concatenate(shares)
    kappa = [choice.fits[index].coefficients[:, 0] for choice in choices]
    spread = _variance(weight, np.concatenate(kappa))
    sampling = variance = 0.0
    effects = dict.fromkeys(means.levels, 0.0)
    for choice, share, value in zip(choices, shares, kappa, strict=True):
        exact = linear(means, choice.laws, choice.nodes, as_if_exact(known_before(means, choice.laws)))
        variance += float(share @ choice.fits[index].covariance[:, 0, 0])
        sampling += float(share @ exact.covariance[:, 0, 0])
        for limit in effects:
            effects[limit] += _main_effect(limit, choice, share, value)
    if len(choices) > 1:  # which differ in the law of eps_f
        each = np.array([share.sum() for share in shares])
        inside = [share @ value for share, value in zip(shares, kappa, strict=True)]
        effects["eps_f"] += _variance(each, np.divide(inside, each, out=np.zeros(len(each)), where=each > 0))
    scale = spread / sum(effects.values()) if spread > 0 and sum(effects.values()) > 0 else 0.0
    budget = np.full(len(SOURCES), np.nan)
    for limit, effect in effects.items():
        budget[SOURCES.index(limit)] = np.sqrt(scale * effect)
    sampling = min(sampling, variance)
    budget[SOURCES.index("interaction")] = np.sqrt(variance - sampling)
    budget[SOURCES.index("sampling")] = np.sqrt(sampling)
    budget[[SOURCES.index("extrapolation"), SOURCES.index("rivals")]] = 0.0
    if not np.isnan(residuals).any():
        budget[SOURCES.index("residual")] = abs(_influence(index, choices, shares)) @ abs(residuals)
    return budget


def _variance(weight: Reals, value: Reals) -> float:
    return float(weight @ (value - weight @ value) ** 2)


def _main_effect(limit: str, choice: Choice, share: Reals, value: Reals) -> float:
    """Return the variance of the mean of the TFC limit at given parameters of a limit's law."""
    mine = [index for index, parameter in enumerate(choice.parameters) if parameter.limit == limit]
    _, same = np.unique(choice.nodes[:, mine], axis=0, return_inverse=True)
    weight = np.bincount(same.ravel(), share)
    mean = np.divide(np.bincount(same.ravel(), share * value), weight, out=np.zeros(len(weight)), where=weight > 0)
    total = weight.sum()
    return float(weight @ (mean - (weight @ mean) / total) ** 2) if total > 0 else 0.0


def _influence(index: int, choices: Sequence[Choice], shares: Sequence[Reals]) -> Reals:
    """Return the derivative of the TFC limit to each mean (case): of the fits, and of the weights of the nodes."""
    weight = np.concatenate(shares)
    value, influence, pull = (
        np.concatenate([getattr(choice.fits[index], name) for choice in choices])
        for name in ("coefficients", "influence", "pull")
    )
    kappa = value[:, 0]
    return np.asarray(weight @ influence - 0.5 * (weight * (kappa - weight @ kappa)) @ pull)
