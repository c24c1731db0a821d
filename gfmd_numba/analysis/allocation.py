"""How many realisations of each level reach an accuracy at the least cost, from a few realisations of every case."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import chi2

from gfmd_numba.analysis.exponents import Given, Ranges, exponent_range
from gfmd_numba.analysis.least_squares import best_fit, best_means, project, whitened
from gfmd_numba.analysis.pooled_covariance import degrees_of_freedom, pooled_covariance
from gfmd_numba.analysis.selection import LIMITS, Group, UnusableDataError, groups_to_fit
from gfmd_numba.arrays import Reals

_FEWEST = 20  # realisations: fewer do not tell how they go with the cheaper levels
_CONFIDENCE = 0.98  # of the scatter, which a pilot knows roughly, for 0.9 in all: a bootstrap has noise of its own
_LARGE = 2.2  # standard errors: by so much a campaign may find a correction too large
_MOST = 10**6  # realisations: more are no plan
_GAIN = 0.998  # of the error, for which another share of a level is worth taking

Level = tuple[str, float]  # a limit and its eps, or ("reference", nan)


@dataclass(frozen=True)
class Design:
    """Realisations of the reference and of each level, the relative error of kappa_tfc they give, and their cost in s.

    Levels of 0 are not worth their cost. `sampling` and `exponents` are the parts of the error, `limiting` says what
    it mostly comes from.
    """

    reference: int
    levels: dict[str, dict[float, int]]  # limit -> eps -> realisations
    error: float
    sampling: float
    exponents: float
    seconds: float
    limiting: str


@dataclass(frozen=True)
class Ensemble:
    """What a pilot, or results with fewer realisations of some levels, says of one group."""

    covariance: Reals  # (case, case) of one realisation
    columns: Reals  # (case, parameter) of the fit at known exponents
    slopes: Reals  # (case, exponent) of those that are not known, for a correction of 1
    corrections: Reals  # (exponent) size of the correction of each
    correction: NDArray[np.intp]  # (exponent) parameter that is the correction
    known: Reals  # (exponent) what is known of each before the campaign: 1 / variance
    level: NDArray[np.intp]  # (case)
    kappa: float
    doubt: float  # factor on variances
    freedom: float  # degrees of freedom of the variance of kappa


@dataclass(frozen=True)
class _Choice:
    """Of what a design is chosen: the groups, the levels, and the seconds of one realisation of each level."""

    ensembles: list[Ensemble]
    levels: list[Level]
    price: Reals

    def error(self, counts: Reals) -> float:
        """Relative error of the group that has the largest."""
        return max(relative_errors(ensemble, counts)[0] for ensemble in self.ensembles)


def cheapest_design(
    pilot: xr.Dataset,
    seconds: Sequence[float],
    target: float,
    variable: str = "kappa",
    fixed: Mapping[str, float | Sequence[float]] | None = None,
) -> Design:
    """Return the cheapest realisations by which every group's relative error of kappa_tfc is below a target.

    `seconds` is the processor time of one realisation of each case. The target is met with 90 % confidence.
    UnusableDataError where a million realisations do not reach it.
    """
    choice = _choice(pilot, seconds, variable, fixed)
    least = choice.error(np.full(len(choice.levels), float(_MOST)))
    if least >= target:
        raise UnusableDataError(
            f"given a target of {target:.2%}, where {_MOST} realisations of all cases leave {least:.2%}; "
            "allowed: a larger one, finer levels, or narrower ranges under `fit: {fixed: ...}`"
        )
    shares = choice.price**-0.5
    for _ in range(2):  # the best shares depend on the budget, hardly
        budget = _enough(choice, shares, target)
        shares = _best_shares(choice, shares, budget)
    return _described(choice, np.ceil(_counts(choice, shares, _enough(choice, shares, target))))


def best_design(
    pilot: xr.Dataset,
    seconds: Sequence[float],
    budget: float,
    variable: str = "kappa",
    fixed: Mapping[str, float | Sequence[float]] | None = None,
) -> Design:
    """Return the realisations with the least error that cost no more than `budget` seconds of processor time.

    UnusableDataError where the fewest realisations that make sense cost more.
    """
    choice = _choice(pilot, seconds, variable, fixed)
    shares = choice.price**-0.5
    for level in np.argsort(-choice.price):  # the dearest levels go first
        if _FEWEST * choice.price[shares > 0].sum() > budget and _may_go(choice, shares, level):
            shares[level] = 0.0
    least = _FEWEST * choice.price[shares > 0].sum()
    if least > budget:
        raise UnusableDataError(f"given a budget of {budget:.3g} s; allowed: at least {least:.3g} s of processor time")
    return _described(choice, np.floor(_counts(choice, _best_shares(choice, shares, budget), budget)))


def _choice(
    pilot: xr.Dataset, seconds: Sequence[float], variable: str, fixed: Mapping[str, float | Sequence[float]] | None
) -> _Choice:
    found = ensembles(pilot, variable, fixed or {})
    number = level_of_case(pilot)
    price = np.bincount(number, np.asarray(seconds, dtype=float)).astype(np.float64)
    fitted = np.unique(np.concatenate([ensemble.level for ensemble in found]))
    price[np.setdiff1d(number, fitted)] = np.inf  # at eps_c = 1
    return _Choice(found, _levels(pilot), price)


def _levels(pilot: xr.Dataset) -> list[Level]:
    """Return the reference and the levels of each limit in the order of the campaign."""
    found: dict[Level, None] = {("reference", np.nan): None}
    for limit in LIMITS:
        mine = pilot["limit"].values == limit
        found |= {(limit, float(eps)): None for eps in pilot[limit].values[mine]}
    return list(found)


def level_of_case(pilot: xr.Dataset) -> NDArray[np.intp]:
    """Return the number of each case's level (case), 0 for the reference."""
    numbers = {level: number for number, level in enumerate(_levels(pilot))}
    limits = pilot["limit"].values.astype(str)
    where = [
        numbers.get((limit, float(pilot[limit][i])), 0) if limit in LIMITS else 0 for i, limit in enumerate(limits)
    ]
    return np.array(where, dtype=np.intp)


def ensembles(pilot: xr.Dataset, variable: str, fixed: Mapping[str, float | Sequence[float]]) -> list[Ensemble]:
    """Return what results say of each group; UnusableDataError where they do not tell."""
    given = {limit: exponent_range(limit, value) for limit, value in fixed.items()}
    found = []
    for group in groups_to_fit(pilot, variable, omit_nyquist=True):
        values = group.values[group.complete]
        if not group.levels:
            raise UnusableDataError("given cases without a limit to extrapolate to; allowed: a campaign with limits")
        fewest = int(np.isfinite(values).sum(axis=0).min())
        if fewest < _FEWEST:
            raise UnusableDataError(f"given a pilot of {fewest} good realisations; allowed: at least {_FEWEST}")
        found.append(_ensemble(group, values, level_of_case(pilot)[group.cases], given))
    return found


def _ensemble(group: Group, values: Reals, level: NDArray[np.intp], given: Given) -> Ensemble:
    names = list(group.levels)
    log_ratio = np.stack([group.log_ratio(name) for name in names], axis=-1)
    block = whitened(values, log_ratio, np.arange(len(names)))
    ranges = Ranges.of(names, given)
    alpha = best_fit([block], ranges)
    beta = project([block], alpha)[2][0]
    powers = np.exp(log_ratio * alpha)
    unsure = np.flatnonzero(~ranges.exact)
    covariance = pooled_covariance(values)
    of_means = best_means(values, covariance)[1]
    columns = np.column_stack([np.ones(len(powers)), powers])
    # an exponent that is not known costs certainty, by a correction that a pilot may take for too small
    scatter = np.diag(np.linalg.pinv(columns.T @ np.linalg.inv(of_means) @ columns, hermitian=True))
    freedom = degrees_of_freedom(values, covariance, columns)
    return Ensemble(
        covariance=covariance,
        columns=columns,
        slopes=(log_ratio * powers)[:, unsure],
        corrections=np.hypot(beta, np.sqrt(scatter))[1 + unsure],
        correction=1 + unsure,
        known=np.nan_to_num(12.0 / ranges.width[unsure] ** 2),  # of a uniform distribution
        level=level,
        kappa=float(beta[0]),
        # levels' shares are chosen by it, too
        doubt=float((freedom + len(level) - 1) / chi2.ppf(1 - _CONFIDENCE, freedom)),
        freedom=freedom,
    )


def _counts(choice: _Choice, shares: Reals, budget: float) -> Reals:
    """Return the realisations of each level in the proportion of `shares`, none fewer than the fewest, for a budget."""
    used = shares > 0
    price = choice.price[used]
    counts = np.zeros(len(shares))

    def cost(logarithm: float) -> float:
        counts[used] = np.maximum(_FEWEST, np.exp(logarithm) * shares[used])
        return float(counts[used] @ price)

    low, high = np.log(_FEWEST / shares[used].max()), np.log(budget / (price @ shares[used]))
    while high - low > 1e-3:
        middle = (low + high) / 2
        low, high = (middle, high) if cost(middle) <= budget else (low, middle)
    cost(low)
    return counts


def relative_errors(ensemble: Ensemble, counts: Reals) -> tuple[float, float]:
    """Return the relative error of kappa_tfc of nested realisations, and what it were at exponents well known."""
    asked = counts[ensemble.level]
    information = np.zeros_like(ensemble.covariance)
    before = 0.0
    for count in np.unique(asked[asked > 0]):
        there = np.flatnonzero(asked >= count)
        information[np.ix_(there, there)] += (count - before) * np.linalg.inv(ensemble.covariance[np.ix_(there, there)])
        before = count
    fewest = asked[asked > 0].min()
    # how dear levels go with the cheap ones is told by few surfaces (Lavenberg and Welch 1981)
    dear = asked[(asked > 0) & (asked < before)]
    controlled = (fewest / dear).sum()
    information /= ensemble.doubt * (fewest - 2) / max(1.0, fewest - controlled - 2)
    columns = ensemble.columns
    sampling = np.linalg.pinv(columns.T @ information @ columns, hermitian=True)
    # and by one that the campaign itself may take for too large
    excess = _LARGE**2 * np.diag(sampling)[ensemble.correction]
    both = np.hstack([columns, ensemble.slopes * np.sqrt(ensemble.corrections**2 + excess)])
    known = np.diag(np.concatenate([np.zeros(columns.shape[1]), ensemble.known]))
    total = np.linalg.pinv(both.T @ information @ both + known, hermitian=True)
    error, of_surfaces = np.sqrt([total[0, 0], sampling[0, 0]]) / abs(ensemble.kappa)
    return float(error), float(of_surfaces)


def _enough(choice: _Choice, shares: Reals, target: float) -> float:
    """Return the least budget by which shares meet a target."""
    high = _FEWEST * float(choice.price[shares > 0].sum())
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
                if _FEWEST * choice.price[trial > 0].sum() > budget:
                    continue
                error = choice.error(_counts(choice, trial, budget))
                if error < _GAIN * least:
                    shares, least, better = trial, error, True
    return shares


def _may_go(choice: _Choice, shares: Reals, level: int) -> bool:
    """Whether a limit keeps two levels beside the reference, which an exponent needs, without this one."""
    limit = choice.levels[level][0]
    left = [other for other, (name, _) in enumerate(choice.levels) if name == limit and shares[other] > 0]
    return limit != "reference" and (shares[level] == 0 or len(left) > 2)


def _described(choice: _Choice, counts: Reals) -> Design:
    counts = counts.clip(max=_MOST)
    worst = max(choice.ensembles, key=lambda ensemble: relative_errors(ensemble, counts)[0])
    total, sampling = relative_errors(worst, counts)
    names = np.array([name for name, _ in choice.levels])
    relief = {
        name: total**2 - relative_errors(worst, np.where(names == name, 1000 * counts, counts))[0] ** 2
        for name in dict.fromkeys(names.tolist())
    }
    relief["exponents"] = max(0.0, total**2 - sampling**2)
    levels: dict[str, dict[float, int]] = {}
    for (name, eps), count in zip(choice.levels[1:], counts[1:], strict=True):
        levels.setdefault(name, {})[eps] = int(count)
    used = counts > 0
    return Design(
        reference=int(counts[0]),
        levels=levels,
        error=total,
        sampling=sampling,
        exponents=float(np.sqrt(relief["exponents"])),
        seconds=float(counts[used] @ choice.price[used]),
        limiting=max(relief, key=lambda name: relief[name]),
    )
