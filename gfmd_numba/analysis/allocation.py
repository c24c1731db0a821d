"""How many realisations of each level reach an accuracy at the least cost, from a few realisations of every case."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import xarray as xr

from gfmd_numba.analysis.arguments import Fixed, Seconds, Target, Variable, checked
from gfmd_numba.analysis.ensembles import FEWEST, Ensemble, Level, ensembles, level_of_case, levels_of, relative_errors
from gfmd_numba.analysis.forms import CAMPAIGN, UnusableDataError
from gfmd_numba.analysis.selection import CROSS, LIMITS
from gfmd_numba.arrays import Reals
from gfmd_numba.text.input_error import InputError

_MOST = 10**6  # realisations: more are no plan
_GAIN = 0.998  # of the error, for which another share of a level is worth taking


@dataclass(frozen=True)
class Design:
    """Realisations of the reference and of each level, the relative error of the limit they give, and their cost in s.

    Levels of 0 are not worth their cost; `cross` holds the cross levels in the order of the pilot. `sampling` and
    `exponents` are the parts of the error, `limiting` says what it mostly comes from.
    """

    reference: int
    levels: dict[str, dict[float, int]]  # limit -> eps -> realisations
    error: float
    sampling: float
    exponents: float
    seconds: float
    limiting: str
    cross: tuple[int, ...] = ()


@dataclass(frozen=True)
class _Choice:
    """Of what a design is chosen: the groups, the levels, and the seconds of one realisation of each level."""

    ensembles: list[Ensemble]
    levels: list[Level]
    price: Reals

    def error(self, counts: Reals) -> float:
        """Relative error of the group that has the largest."""
        return max(relative_errors(ensemble, counts)[0] for ensemble in self.ensembles)


@checked
def cheapest_design(
    pilot: Annotated[xr.Dataset, CAMPAIGN],
    seconds: Seconds,
    target: Target,
    variable: Variable = "kappa",
    fixed: Fixed | None = None,
) -> Design:
    """Return the cheapest realisations by which every group's relative error of the TFC limit is below a target.

    `seconds` is the processor time of one realisation of each case. The target is met with 90 % confidence.
    UnusableDataError where a million realisations do not reach it.
    """
    choice = _choice(pilot, seconds, variable, fixed)
    least = choice.error(np.full(len(choice.levels), float(_MOST)))
    if least >= target:
        raise UnusableDataError(
            f"you gave a target of {100 * target:.3g}%, where {_MOST} realisations of all cases leave "
            f"{100 * least:.3g}%; "
            "gfmd allows a larger one, finer levels, cross levels for every pair of limits (`cross`), or narrower "
            "ranges "
            "under `fit: {fixed: ...}`"
        )
    shares = choice.price**-0.5
    for _ in range(2):  # the best shares depend on the budget, hardly
        budget = _enough(choice, shares, target)
        shares = _best_shares(choice, shares, budget)
    shares = _without_dear_levels(choice, shares, target)
    counts = np.ceil(_counts(choice, shares, _enough(choice, shares, target)))
    if counts.max() > _MOST:
        raise UnusableDataError(
            f"you gave a target of {100 * target:.3g}%, for which {counts.max():.0f} realisations of a level would be "
            f"the cheapest; gfmd allows a larger one, as {_MOST} are the most"
        )
    return _described(choice, counts)


def _choice(
    pilot: xr.Dataset, seconds: Sequence[float], variable: str, fixed: Mapping[str, float | Sequence[float]] | None
) -> _Choice:
    found = ensembles(pilot, variable, fixed or {})
    number = level_of_case(pilot)
    if len(seconds) != len(number):
        raise InputError(f"seconds: you gave {len(seconds)} numbers; gfmd allows one for each of {len(number)} cases")
    price = np.bincount(number, np.asarray(seconds, dtype=float)).astype(np.float64)
    fitted = np.unique(np.concatenate([ensemble.level for ensemble in found]))
    price[np.setdiff1d(number, fitted)] = np.inf  # at eps_c = 1
    return _Choice(found, levels_of(pilot), price)


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
    least = _price_of(choice, shares, target)
    for level in np.argsort(-choice.price):
        if shares[level] == 0.0 or not _may_go(choice, shares, level):
            continue
        trial = shares.copy()
        trial[level] = 0.0
        if choice.error(np.where(trial > 0.0, float(_MOST), 0.0)) < target:
            price = _price_of(choice, trial, target)
            if price < least:
                shares, least = trial, price
    return shares


def _price_of(choice: _Choice, shares: Reals, target: float) -> float:
    """Return the seconds that realisations in the proportion of shares take to meet a target."""
    counts = np.ceil(_counts(choice, shares, _enough(choice, shares, target)))
    used = counts > 0
    return float(counts[used] @ choice.price[used])


def _may_go(choice: _Choice, shares: Reals, level: int) -> bool:
    """Whether this is a cross level, or its limit keeps the two that, with the reference, an exponent needs."""
    limit = choice.levels[level][0]
    left = [other for other, (name, _) in enumerate(choice.levels) if name == limit and shares[other] > 0]
    return limit == CROSS or (limit in LIMITS and (shares[level] == 0 or len(left) > 2))


def _described(choice: _Choice, counts: Reals) -> Design:
    worst = max(choice.ensembles, key=lambda ensemble: relative_errors(ensemble, counts)[0])
    total, sampling = relative_errors(worst, counts)
    names = np.array([name for name, _ in choice.levels])
    relief = {
        name: total**2 - relative_errors(worst, np.where(names == name, 1000 * counts, counts))[0] ** 2
        for name in dict.fromkeys(names.tolist())
    }
    relief["exponents"] = max(0.0, total**2 - sampling**2)
    levels: dict[str, dict[float, int]] = {}
    for (name, eps), count in zip(choice.levels, counts, strict=True):
        if name in LIMITS:
            levels.setdefault(name, {})[eps[0]] = int(count)
    used = counts > 0
    return Design(
        reference=int(counts[0]),
        levels=levels,
        error=total,
        sampling=sampling,
        exponents=float(np.sqrt(relief["exponents"])),
        seconds=float(counts[used] @ choice.price[used]),
        limiting=max(relief, key=lambda name: relief[name]),
        cross=tuple(counts[names == CROSS].astype(int).tolist()),
    )
