"""How many realisations of each level reach an accuracy at the least cost, from a few realisations of every case."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import scipy  # its modules load with their first use
import xarray as xr
from numpy.typing import NDArray

from gfmd_numba.analysis.exponent_posterior import linearised, weighed
from gfmd_numba.analysis.forms import UnusableDataError
from gfmd_numba.analysis.gauss_markov import degrees_of_freedom, means_of, pooled_covariance
from gfmd_numba.analysis.laws import Given, choices, given_ranges
from gfmd_numba.analysis.limit_errors import inseparable
from gfmd_numba.analysis.selection import CROSS, LIMITS, Group, groups_to_fit, steps_of
from gfmd_numba.arrays import Reals
from gfmd_numba.arrays.threads import one_thread_of_algebra

FEWEST = 20  # realisations: fewer do not tell how they go with the cheaper levels
_CONFIDENCE = 0.98  # of the scatter, which a pilot knows roughly, for 0.9 in all: errors of fits have noise, too

Level = tuple[str, tuple[float, ...]]  # a limit and its eps, "cross" and all eps, or "reference" and none
_REFERENCE: Level = ("reference", ())


@dataclass(frozen=True)
class _Ensemble:
    """Statistics of the results of one group, or of one step of its path."""

    covariance: Reals  # (case, case) of one realisation
    columns: Reals  # (case, coefficient) of the fit at the likeliest laws
    slopes: Reals  # (case, parameter) derivatives to the parameters of the laws
    prior_precision: Reals  # (coefficient and parameter) one over the variance of each before the campaign
    level: NDArray[np.intp]  # (case)
    kappa: float
    variance_factor: float  # on the covariance, which a pilot knows roughly
    freedom: float  # degrees of freedom of the variance of kappa


def _ensembles(pilot: xr.Dataset, number: NDArray[np.intp], variable: str, given: Given) -> list[_Ensemble]:
    """Return what results say of each group, along a path at every step; UnusableDataError where they do not tell."""
    steps = steps_of(pilot, variable)
    found: list[_Ensemble] = []
    for step, one in enumerate(steps if len(steps) > 1 else ()):
        try:
            found += _ensembles(one, number, variable, given)
        except UnusableDataError as error:
            advice = "`fit: {step: ...}` names a step that is fitted alone, and `fit: {variable: ...}` something else"
            raise UnusableDataError(f"{variable} at step {step} of the path: {error}; {advice}") from None
    if len(steps) > 1:
        return found
    (pilot,) = steps
    for group in groups_to_fit(pilot, variable, omit_nyquist=True):
        values = group.values[group.complete]
        if not group.levels:
            raise UnusableDataError(
                "you gave cases without a limit to extrapolate to; gfmd allows a campaign with limits"
            )
        fewest = int(np.isfinite(values).sum(axis=0).min())
        if fewest < FEWEST:
            raise UnusableDataError(f"you gave a pilot of {fewest} good realisations; gfmd allows at least {FEWEST}")
        if why := inseparable(group):
            raise UnusableDataError(why)
        found.append(_ensemble(group, values, number[group.cases], given))
    return found


def _ensemble(group: Group, values: Reals, level: NDArray[np.intp], given: Given) -> _Ensemble:
    means = means_of(group, values)
    found = [weighed([means], laws) for laws in choices(list(group.levels), [group], given)]
    likeliest = max(found, key=lambda choice: choice.log_weight.max())
    columns, slopes, prior_precision, kappa = linearised(means, likeliest)
    covariance = pooled_covariance(values)
    freedom = degrees_of_freedom(values, covariance, columns)
    return _Ensemble(
        covariance=covariance,
        columns=columns,
        slopes=slopes,
        prior_precision=prior_precision,
        level=level,
        kappa=kappa,
        # levels' shares are chosen by it, too
        variance_factor=float((freedom + len(level) - 1) / scipy.special.chdtri(freedom, _CONFIDENCE)),
        freedom=freedom,
    )


def _relative_error(ensemble: _Ensemble, counts: Reals, known_exponents: bool = False) -> float:
    """Return the relative error of the TFC limit of nested realisations, or what it were at exponents well known."""
    asked = counts[ensemble.level]
    nested = np.argsort(-asked, kind="stable")[: np.count_nonzero(asked)]  # a realisation has the first of these cases
    asked = asked[nested]
    # of the inverse covariances of the first cases, each row of the inverse factor is in those of as many realisations
    whitener = np.linalg.inv(np.linalg.cholesky(ensemble.covariance[np.ix_(nested, nested)]))
    information = (whitener.T * asked) @ whitener
    # how dear levels go with the cheap ones is told by few surfaces (Lavenberg and Welch 1981)
    fewest = asked[-1]
    controlled = (fewest / asked[asked < asked[0]]).sum()
    information /= ensemble.variance_factor * (fewest - 2) / max(1.0, fewest - controlled - 2)
    columns = ensemble.columns if known_exponents else np.hstack([ensemble.columns, ensemble.slopes])
    columns, prior_precision = columns[nested], np.diag(ensemble.prior_precision[: columns.shape[1]])
    variance = np.linalg.pinv(columns.T @ information @ columns + prior_precision, hermitian=True)[0, 0]
    return float(np.sqrt(variance) / abs(ensemble.kappa))


_WELL_KNOWN = 1e8  # one over the variance of an interaction, in units of its likely scatter
_OF_THE_FACTOR = 0.9  # with which the true error of a fit is no larger than the one it says times the factor


@dataclass(frozen=True)
class Prediction:
    """Relative error of the TFC limit to expect of one group, times the `factor`.

    `exponents` and `interactions` are the parts of the error, in quadrature, that would vanish if these were known. The
    factor allows for the uncertainty of the error of a fit itself. `caution` is the ratio of the error that
    `cheapest_design` promises to this one: a design is chosen once, where a run can go on.
    """

    error: float
    exponents: float
    interactions: float
    factor: float
    caution: float


def _predicted(ensemble: _Ensemble, counts: Reals) -> Prediction:
    """Error of one group for numbers of realisations (level)."""
    factor = float(np.sqrt(ensemble.freedom / scipy.special.chdtri(ensemble.freedom, _OF_THE_FACTOR)))
    # the factor is on the scatter of surfaces, not on the prior
    sober = replace(ensemble, variance_factor=factor**2)
    error, of_surfaces = (_relative_error(sober, counts, known_exponents) for known_exponents in (False, True))
    caution = _relative_error(ensemble, counts) / error
    prior_precision = ensemble.prior_precision.copy()
    coefficients = prior_precision[: ensemble.columns.shape[1]]
    coefficients[coefficients > 0] = _WELL_KNOWN
    additive = _relative_error(replace(sober, prior_precision=prior_precision), counts)  # with interactions known
    exponents, interactions = (float(np.sqrt(max(0.0, error**2 - less**2))) for less in (of_surfaces, additive))
    return Prediction(error, exponents, interactions, factor, caution)


_MOST = 10**6  # realisations: more are no plan
_GAIN = 0.998  # of the error, for which another share of a level is worth taking


@dataclass(frozen=True)
class _Choice:
    """Of what a design is chosen: the groups, the levels, and the seconds of one realisation of each level."""

    ensembles: list[_Ensemble]
    levels: list[Level]
    price: Reals

    def error(self, counts: Reals) -> float:
        """Relative error of the group that has the largest."""
        return max(_relative_error(ensemble, counts) for ensemble in self.ensembles)


@dataclass(frozen=True)
class Pilot:
    """What results say of each group, with as many realisations of every case or fewer of the dear ones."""

    ensembles: list[_Ensemble]
    levels: list[Level]
    number: NDArray[np.intp]  # of each case's level (case), 0 for the reference

    @classmethod
    def of(cls, results: xr.Dataset, variable: str, fixed: Mapping[str, float | Sequence[float]]) -> Self:
        """What results say with some exponents known; UnusableDataError for results that do not tell."""
        # an eps of the grid tells no levels apart, whatever the grid varies
        references = results.isel(case=results["limit"].values == _REFERENCE[0])
        alike = tuple(name for name in LIMITS if np.unique(references[name]).size == 1)
        told_by = {limit: (limit,) for limit in LIMITS} | {CROSS: alike, _REFERENCE[0]: ()}
        eps = {name: results[name].values.astype(float).tolist() for name in LIMITS}
        names = results["limit"].values.astype(str).tolist()
        of_cases: list[Level] = [(name, tuple(eps[each][i] for each in told_by[name])) for i, name in enumerate(names)]
        order = [_REFERENCE[0], *LIMITS, CROSS]
        levels = sorted(dict.fromkeys([_REFERENCE, *of_cases]), key=lambda level: order.index(level[0]))
        number = np.array([levels.index(level) for level in of_cases], dtype=np.intp)
        with one_thread_of_algebra():
            return cls(_ensembles(results, number, variable, given_ranges(fixed)), levels, number)

    def predictions(self, counts: Sequence[int] | NDArray[np.intp]) -> list[Prediction]:
        """Error of each group, along a path of each step, for numbers of realisations (case)."""
        of_level = np.zeros(len(self.levels))
        np.maximum.at(of_level, self.number, np.asarray(counts, dtype=float))
        return [_predicted(ensemble, of_level) for ensemble in self.ensembles]

    def cheapest_design(self, seconds: Reals, target: float) -> NDArray[np.intp]:
        """Return the cheapest realisations by which every group's relative error of the TFC limit is below a target.

        `seconds` is the processor time of one realisation of each case. Cases of levels that are not worth their cost
        have 0 realisations (case). The target is met with 90 % confidence. UnusableDataError where a million
        realisations do not reach it.
        """
        price = np.bincount(self.number, seconds).astype(np.float64)
        fitted = np.unique(np.concatenate([ensemble.level for ensemble in self.ensembles]))
        price[np.setdiff1d(self.number, fitted)] = np.inf  # at eps_c = 1
        choice = _Choice(self.ensembles, self.levels, price)
        least = choice.error(np.full(len(choice.levels), float(_MOST)))
        if least >= target:
            raise UnusableDataError(
                f"you gave a target of {100 * target:.3g}%, where {_MOST} realisations of all cases leave "
                f"{100 * least:.3g}%; gfmd allows a larger one, finer levels, cross levels for every pair of limits "
                "(`cross`), or narrower ranges under `fit: {fixed: ...}`"
            )
        shares = price**-0.5
        for _ in range(2):  # the best shares depend on the budget, hardly
            shares = _best_shares(choice, shares, _enough(choice, shares, target))
        shares = _without_dear_levels(choice, shares, target)
        counts = _cheapest(choice, shares, target)[0]
        if counts.max() > _MOST:
            raise UnusableDataError(
                f"you gave a target of {100 * target:.3g}%, for which {counts.max():.0f} realisations of a level "
                f"would be the cheapest; gfmd allows a larger one, as {_MOST} are the most"
            )
        return counts[self.number].astype(np.intp)


def _counts(choice: _Choice, shares: Reals, budget: float) -> Reals:
    """Return the realisations of each level in the proportion of `shares`, none fewer than the fewest, for a budget."""
    used = shares > 0
    price = choice.price[used]
    counts = np.zeros(len(shares))

    def cost(logarithm: float) -> float:
        counts[used] = np.maximum(FEWEST, np.exp(logarithm) * shares[used])
        return float(counts[used] @ price)

    low, high = np.log(FEWEST / shares[used].max()), np.log(budget / (price @ shares[used]))
    while high - low > 1e-3:
        middle = (low + high) / 2
        low, high = (middle, high) if cost(middle) <= budget else (low, middle)
    cost(low)
    return counts


def _enough(choice: _Choice, shares: Reals, target: float) -> float:
    """Return the least budget by which shares meet a target."""
    high = FEWEST * float(choice.price[shares > 0].sum())
    while choice.error(_counts(choice, shares, high)) > target:
        high *= 2
    low = high / 2
    while high > 1.005 * low:
        middle = np.sqrt(low * high)
        low, high = (low, middle) if choice.error(_counts(choice, shares, middle)) <= target else (middle, high)
    return float(high)


def _best_shares(choice: _Choice, shares: Reals, budget: float) -> Reals:
    """Return the shares of the levels with the least error for a budget, level after level, the dearest first."""
    least, better = choice.error(_counts(choice, shares, budget)), True
    while better:
        better = False
        for level in np.argsort(-choice.price):
            for factor in (0.0, 0.5, 2.0):
                if factor == 0.0 and not _may_go(choice, shares, level):
                    continue
                trial = shares.copy()
                trial[level] *= factor
                if FEWEST * choice.price[trial > 0].sum() > budget:
                    continue
                error = choice.error(_counts(choice, trial, budget))
                if error < _GAIN * least:
                    shares, least, better = trial, error, True
    return shares


def _without_dear_levels(choice: _Choice, shares: Reals, target: float) -> Reals:
    """Return the shares without those levels without which a target is cheaper, the dearest first.

    At a loose target each level has the fewest realisations there may be, so that no error tells that one is too dear.
    """
    least = _cheapest(choice, shares, target)[1]
    for level in np.argsort(-choice.price):
        if shares[level] == 0.0 or not _may_go(choice, shares, level):
            continue
        trial = shares.copy()
        trial[level] = 0.0
        if choice.error(np.where(trial > 0.0, float(_MOST), 0.0)) < target:
            price = _cheapest(choice, trial, target)[1]
            if price < least:
                shares, least = trial, price
    return shares


def _cheapest(choice: _Choice, shares: Reals, target: float) -> tuple[Reals, float]:
    """Return the realisations of each level in the proportion of shares that meet a target, and their seconds."""
    counts = np.ceil(_counts(choice, shares, _enough(choice, shares, target)))
    used = counts > 0
    return counts, float(counts[used] @ choice.price[used])


def _may_go(choice: _Choice, shares: Reals, level: int) -> bool:
    """Whether this is a cross level, or its limit keeps the two that, with the reference, an exponent needs."""
    limit = choice.levels[level][0]
    left = [other for other, (name, _) in enumerate(choice.levels) if name == limit and shares[other] > 0]
    return limit == CROSS or (limit in LIMITS and (shares[level] == 0 or len(left) > 2))
