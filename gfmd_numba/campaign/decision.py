"""How many realisations the next round of a run has, from the results so far.

A run that was killed and resumes must decide as it would have done, so nothing that is measured in seconds enters.
Instead work has a price, which follows from transforms and grids. Decisions follow from the predicted error, hence from
the covariance of all results. The rounds are few and each is much larger than the one before, so that stopping hardly
biases a mean (Collier, Haji-Ali, Nobile, von Schwerin & Tempone 2015 lower their tolerance in the same way).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, nan, sqrt
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gfmd_numba.analysis import Design, UnusableDataError, cheapest_design, predictions
from gfmd_numba.analysis.allocation import level_of_case
from gfmd_numba.analysis.fit_dataset import in_the_limit
from gfmd_numba.analysis.selection import LIMITS, groups
from gfmd_numba.arrays import Reals
from gfmd_numba.campaign.cost import price_of_transform
from gfmd_numba.campaign.limits import CROSS, MOST
from gfmd_numba.theory.exponents import exponent_ranges

_GROWTH = 4.0  # of the price at most, from one round to the next: few looks, and none far off for a poor pilot
_LEAST_GROWTH = 1.25  # of the price: less is not worth a look
_HALVINGS = 4  # of a factor of 1.3 on the error: to 2 %
_LOOSER = 2.0  # than the target: an error that a round has to come near, for a target that cannot be predicted yet

Counts = NDArray[np.intp]


class UnknownExponentsError(UnusableDataError):
    """No number of realisations reaches a target, because of the ranges of exponents."""


@dataclass(frozen=True)
class Fit:
    """What is fitted: the variable, and the exponents that are known."""

    variable: str
    fixed: Mapping[str, Any]


@dataclass(frozen=True)
class Judgement:
    """Errors of the worst group after a round, relative to the limit.

    `error` is that of the fit (inf if it was refused), `sampling` the part of it that comes from the surfaces, `factor`
    allows for the uncertainty of that part, and `predicted` was to be expected.
    """

    error: float
    sampling: float
    factor: float
    predicted: float

    @property
    def sure_error(self) -> float:
        """Error that is not exceeded with 90 % probability."""
        return float(np.sqrt(self.error**2 + (self.factor**2 - 1.0) * self.sampling**2))

    @property
    def sure_factor(self) -> float:
        """What the sure error is over that of the fit."""
        return self.sure_error / self.error if 0.0 < self.error < inf else self.factor


@dataclass(frozen=True)
class Decision:
    """Realisations (case) of the next round, the error and the whole price to expect, and the price of the target.

    `is_last` if the round is meant to reach the target, or to use up the price there is.
    """

    realisations: Counts
    predicted_error: float
    price: float
    target_price: float | None
    is_last: bool


def judge(results: xr.Dataset, fitted: xr.Dataset, fit: Fit) -> Judgement:
    """Return the errors of the worst group; raises UnusableDataError for results that do not tell."""
    expected = predictions(results, results["realisations"].values.tolist(), fit.variable, fit.fixed)
    limit, error = in_the_limit(fitted)
    errors = (error / abs(limit)).fillna(inf).values
    sampling = (fitted["error_budget"].sel(source="sampling") / abs(limit)).fillna(0.0).values
    found = [
        Judgement(float(whole), float(part), each.factor, max(one.error for one in expected))
        for whole, part, each in zip(errors, sampling, expected, strict=True)
    ]
    return max(found, key=lambda each: each.sure_error)


def decide(
    results: xr.Dataset, found: Judgement, target: float, fit: Fit, most: float = inf, after_pilot: bool = True
) -> Decision | None:
    """Return the realisations of the next round, for a price of at most `most` in all; None if that allows no more.

    The error of a pilot is larger than predicted while several laws still fit; more surfaces cure that. If a later
    error is larger than predicted, the next may be so again, and the round makes up for it. Raises UnusableDataError
    if no number of realisations reaches the target.
    """
    held = results["realisations"].values.astype(np.intp)
    price = price_of_realisations(results)
    spent = whole_price(results, price, held)
    limit = min(most, _GROWTH * spent)
    if most < _LEAST_GROWTH * spent:
        return None
    goal = target
    if not after_pilot and target < found.sure_error < inf:
        goal = target * min(1.0, found.predicted / found.sure_error)
    try:
        wanted, asked = _wanted(results, held, price, goal, fit), goal
    except UnusableDataError:
        wanted, asked = _looser(results, held, price, goal, fit), _LOOSER * goal
    while whole_price(results, price, wanted) < _LEAST_GROWTH * spent:
        goal = asked = 0.9 * asked
        wanted = _wanted(results, held, price, asked, fit)
    total = whole_price(results, price, wanted)
    target_price = total if asked == goal else None
    if total > limit:
        asked, wanted, total = _within(limit, results, held, price, asked, fit)
    expected = max(each.error for each in predictions(results, wanted.tolist(), fit.variable, fit.fixed))
    return Decision(
        wanted, expected, total, target_price, is_last=min(asked / goal, expected / target) <= 1.0 or limit == most
    )


def price_of_realisations(results: xr.Dataset) -> Reals:
    """Return the price of a realisation of each case (case): its mean number of transforms times the price of one."""
    nodes = results["nx"].values.astype(float) ** results["dimension"].values
    transforms = results["n_transforms"].where(results["status"] == 0).mean("realisation").values
    known = np.isfinite(transforms)
    if not known.any():
        raise UnusableDataError("you gave no good realisation; gfmd allows some of every case")
    return np.asarray(np.where(known, transforms, np.mean(transforms[known])).clip(1) * price_of_transform(nodes))


def whole_price(results: xr.Dataset, price: Reals, counts: Counts) -> float:
    """Return the price of some realisations (case); equal problems count once."""
    of_problem: dict[str, float] = {}
    for identity, each in zip(results["case_id"].values.tolist(), (price * counts).tolist(), strict=True):
        of_problem[identity] = max(each, of_problem.get(identity, 0.0))
    return sum(of_problem.values())


def _wanted(results: xr.Dataset, held: Counts, price: Reals, target: float, fit: Fit) -> Counts:
    """Return the realisations (case) with which every group meets a target, none fewer than it has."""
    counts = held.copy()
    results = results.assign_coords(case=np.arange(results.sizes["case"]))
    known: dict[tuple[str, ...], Counts] = {}  # groups of the same problems have the same results
    for parameters, cases in groups(results):
        where, identities = cases["case"].values, tuple(cases["case_id"].values.tolist())
        if identities not in known:
            expected = predictions(cases, held[where].tolist(), fit.variable, fit.fixed)  # along a path of every step
            promise = target * min(each.caution for each in expected)
            try:
                design = cheapest_design(cases, price[where].tolist(), promise, fit.variable, fit.fixed)
            except UnusableDataError:
                raise _out_of_reach(cases, _named(results, parameters), target, fit) from None
            known[identities] = _of_cases(design, cases)
        counts[where] = np.maximum(held[where], known[identities])
    return counts


def _within(
    limit: float, results: xr.Dataset, held: Counts, price: Reals, target: float, fit: Fit
) -> tuple[float, Counts, float]:
    """Return the least error above a target that a limit on the price allows, its realisations (case), their price."""
    tight, loose, found = target, target, held
    total = inf
    while total > limit:
        tight, loose = loose, 1.3 * loose
        found = _wanted(results, held, price, loose, fit)
        total = whole_price(results, price, found)
    for _ in range(_HALVINGS):
        middle = sqrt(tight * loose)
        trial = _wanted(results, held, price, middle, fit)
        trial_price = whole_price(results, price, trial)
        if trial_price <= limit:
            loose, found, total = middle, trial, trial_price
        else:
            tight = middle
    return loose, found, total


def _looser(results: xr.Dataset, held: Counts, price: Reals, target: float, fit: Fit) -> Counts:
    """Return realisations for an error not far above a target that seems out of reach.

    A few results tell only roughly how large the corrections are. Raises UnusableDataError if more would not help.
    """
    counts = _wanted(results, held, price, _LOOSER * target, fit)
    if whole_price(results, price, counts) < _LEAST_GROWTH * whole_price(results, price, held):
        _wanted(results, held, price, target, fit)  # which says why
    return counts


def _of_cases(design: Design, cases: xr.Dataset) -> Counts:
    """Return the realisations (case) of the cases of one group in a design."""
    number, limits = level_of_case(cases), cases["limit"].values.tolist()
    crossed = np.unique([each for each, limit in zip(number, limits, strict=True) if limit == CROSS])
    cross = dict(zip(crossed.tolist(), design.cross, strict=True))
    counts = []
    for i, limit in enumerate(limits):
        if limit == CROSS:
            counts.append(cross[number[i]])
        else:
            counts.append(design.levels[limit][float(cases[limit][i])] if limit in design.levels else design.reference)
    return np.array(counts, dtype=np.intp)


def _out_of_reach(cases: xr.Dataset, whom: str, target: float, fit: Fit) -> UnusableDataError:
    """Return the error that says why the most realisations do not reach a target, and what helps."""
    least, further = (
        max(predictions(cases, [number] * cases.sizes["case"], fit.variable, fit.fixed), key=lambda each: each.error)
        for number in (MOST, 100 * MOST)
    )
    if least.error <= target:
        return UnusableDataError(
            f"{whom}it would take more than {MOST} realisations of a level; gfmd allows a larger target, or levels "
            "further from the reference"
        )
    left = f"{whom}{MOST} realisations of every case would leave an error of {100 * least.error:.2g}%"
    if 2.0 * further.interactions**2 > least.error**2:
        return UnusableDataError(
            f"{left}, as no cross level tells whether corrections add up; gfmd allows a larger target, or a cross "
            "level for every pair of limits under `limits: {cross: ...}`"
        )
    if 3.0 * least.exponents**2 > least.error**2:
        return UnknownExponentsError(
            f"{left}, as the exponents are not known better than that; gfmd allows a larger target, finer levels, or "
            f"{_narrower(cases, fit)}"
        )
    return UnusableDataError(f"{left}; gfmd allows a larger target, or levels further from the reference")


def _narrower(cases: xr.Dataset, fit: Fit) -> str:
    """Return which ranges of exponents to give, in full if some have none."""
    limits = [name for name in LIMITS if name in cases["limit"].values]
    hurst = float(cases["hurst"].max()) if "hurst" in cases.coords else nan
    usual = exponent_ranges(fit.variable, int(cases["dimension"].values[0]), hurst)
    if fit.fixed.keys() >= set(limits):
        return "narrower ranges under `fit: {fixed: ...}`"
    unknown = ", ".join(f"{name}: [{usual[name][0]:g}, {usual[name][1]:g}]" for name in limits if name not in fit.fixed)
    return f"the ranges in which exponents of {fit.variable} lie in our campaigns, `fit: {{fixed: {{{unknown}}}}}`"


def _named(results: xr.Dataset, parameters: Mapping[str, float]) -> str:
    """Return which of several groups is meant."""
    varied = [name for name in parameters if len(set(results[name].values.tolist())) > 1]
    named = [f"{name} = {parameters[name]:g}" for name in varied]
    return f"{', '.join(named)}: " if named else ""
