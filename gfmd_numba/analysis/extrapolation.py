"""How far each limit lies beyond its finest level, and what that distance adds to the error.

A law that fits the levels need not hold beyond them, so the error of a limit counts a part of the distance that the
law bridges. A power is off in proportion to this distance: exponents drift, because a correction is a sum of several
powers. The law of the unseen slope has no exponent that could drift. It errs by less where the distance is short, and
never by more than a small part of the limit.
"""

from collections.abc import Collection, Sequence

import numpy as np
import xarray as xr

from gfmd_numba.analysis.fit_dataset import in_the_limit
from gfmd_numba.analysis.laws import UNSEEN_SLOPE
from gfmd_numba.analysis.linear_fit import Means, excess
from gfmd_numba.analysis.posterior import Choice
from gfmd_numba.analysis.selection import LIMITS, Group
from gfmd_numba.arrays import Reals

# Standard error over the distance that a law bridges, and for the law of the unseen slope the most over the limit.
# Measured on lines (H = 0.5, 0.8, 1; p* = 0.007, 0.05, 0.3; half-space and a = 0.1) by fits whose levels end at 1/eps_f
# = 128 to 4096, against their limits: fits that bridge less than 4 % are off by a tenth of the distance
_OF_THE_DISTANCE = 0.3
_OF_THE_LIMIT = 0.02
_OF_MEASURED = 0.2  # of this where k_c and m were measured on contacts of the same kind
# Standard error over the limit, for a layer as high as the longest wave of the power law: a thin layer is stiffer for
# long waves than the half-space that it becomes where eps_t goes to 0, by no law of eps_t. Measured on the same lines
# as the difference of slabs from half-spaces (a = 0.02 to 0.3, 1/eps_t = 2 to 8, 1/eps_f = 1024)
_OF_A_LAYER, _MOST_OF_A_LAYER = 0.01, 0.3


def distances(index: int, means: Means, choice: Choice) -> Reals:
    """Return how far the fit at each limit's finest level is from its limit (node, limit), nan for limits not varied.

    The other discretisations are at the reference or in their limits, whichever is further.
    """
    found = np.full((len(choice.nodes), len(LIMITS)), np.nan)
    coefficients = choice.fits[index].coefficients
    for row, limit in enumerate(means.levels, start=1):
        finest = min(means.levels[limit].min(), means.reference[limit])
        at = excess(choice.laws, limit, np.array([finest, means.reference[limit]]), choice.nodes)
        ratio = at[:, :1] / at[:, 1:]
        alone = coefficients[:, row] * ratio[:, 0]
        together = alone + means.of_pairs(limit, ratio, coefficients)[:, 0]
        found[:, LIMITS.index(limit)] = np.where(abs(together) > abs(alone), together, alone)
    return found


def doubt(distance: Reals, limit: Reals, is_whole: bool) -> Reals:
    """Return the standard error (...) of limits by the distances (...) that laws, powers or whole ones, bridge."""
    found: Reals = _OF_THE_DISTANCE * abs(distance)
    if not is_whole:
        return found
    most = _OF_THE_LIMIT * abs(limit)
    found = found * abs(distance) / (abs(distance) + most)
    return found * most / (most + found)


def doubts(index: int, group: Group, means: Means, choice: Choice, at_an_end: Collection[str] = ()) -> Reals:
    """Return the standard error of each limit by the distance that its law bridges (node, limit), 0 if not varied.

    It is the whole distance if data press an exponent against an end of its range. Layers add to that in eps_t.
    """
    found = abs(np.nan_to_num(distances(index, means, choice)))
    limit = choice.fits[index].coefficients[:, 0]
    for column, name in enumerate(LIMITS):
        if name in choice.laws and name not in at_an_end:
            is_whole = choice.laws[name].whole
            share = _OF_MEASURED if is_whole and group.has_measured_slope_law else 1.0
            found[:, column] = share * doubt(found[:, column], limit, is_whole)
    column = LIMITS.index("eps_t")
    found[:, column] = np.hypot(found[:, column], doubt_of_layers(group, means) * limit)
    return found


def doubt_of_layers(group: Group, means: Means) -> float:
    """Return the relative standard error of the limit in eps_t by layers that become thick in it; 0 without any."""
    if "eps_t" not in means.levels:
        return 0.0
    finest = min(float(means.levels["eps_t"].min()), means.reference["eps_t"])
    return min(_OF_A_LAYER * finest / group.thinnest_layer, _MOST_OF_A_LAYER)


def of_thin_layers(group: Group, means: Means) -> list[str]:
    """Return a note if the thinnest layer is lower than the longest waves at the finest eps_t."""
    share = doubt_of_layers(group, means)
    if share <= _OF_A_LAYER:
        return []
    return [
        f"the thinnest layer is lower than the longest waves at the finest eps_t, but thick in the limit: the error "
        f"counts {share:.2g} of {group.variable}_tfc for that; take a finer eps_t, or leave eps_t out of the limits "
        "if the layer is to stay thin"
    ]


def expected_doubts(fitted: xr.Dataset, limit: str, finer: float) -> Reals:
    """Return the standard errors (group) of a fit by one distance where the finest level is a factor finer."""
    at, value = fitted.sel(limit=limit), in_the_limit(fitted)[0].values
    is_whole, distance = (at["law"] == UNSEEN_SLOPE).values, at["extrapolated"].values
    now, then = (
        np.where(is_whole, doubt(each, value, True), doubt(each, value, False))
        for each in (distance, distance * finer ** -at["alpha"].values)
    )
    less: Reals = np.divide(then, now, where=now > 0, out=np.zeros(len(now)))
    return np.asarray(less * np.nan_to_num(at["extrapolation_error"].values))


def mean_distances(index: int, means: Means, choices: Sequence[Choice], shares: Sequence[Reals]) -> Reals:
    """Return the distances (limit), weighed by how well the laws fit."""
    return np.asarray(
        sum(share @ distances(index, means, choice) for choice, share in zip(choices, shares, strict=True))
    )
