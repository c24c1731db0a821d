"""How many realisations of each limit reach an accuracy at the least cost, from a few realisations of every case."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import chi2

from gfmd_numba.analysis.least_squares import best_fit, covariance_of_levels, project, whitened
from gfmd_numba.analysis.selection import LIMITS, Array, Group, UnusableDataError, collect
from gfmd_numba.analysis.tfc import exponent_range

_SHARES = (1.0, 1 / 2, 1 / 4, 1 / 8, 1 / 16, 1 / 32)  # realisations of a limit over those of the reference
_FEWEST = 20  # realisations: fewer do not tell how they go with the cheaper levels
_CONFIDENCE = 0.9  # that the target is met, as the pilot knows the scatter only roughly
_MOST = 10**6  # realisations: more are no plan


@dataclass(frozen=True)
class Design:
    """Realisations of the reference and of each limit, the relative error of kappa_tfc they give, and their cost in s.

    `sampling` and `exponents` are the parts of the error, `limiting` says what it mostly comes from.
    """

    realisations: dict[str, int]
    error: float
    sampling: float
    exponents: float
    seconds: float
    limiting: str


@dataclass(frozen=True)
class _Ensemble:
    """What a pilot says of one group."""

    covariance: Array  # (case, case) of one realisation
    columns: Array  # (case, parameter) of the linearised fit
    limit: NDArray[np.str_]  # (case)
    known: Array  # (parameter) what is known of each before the campaign: 1 / variance
    kappa: float
    doubt: float  # factor on variances


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
    ensembles = _ensembles(pilot, variable, fixed or {})
    most = _described(ensembles, _price(pilot, seconds), _counts(dict.fromkeys(LIMITS, 1.0), _MOST))
    if most.error >= target:
        raise UnusableDataError(
            f"given a target of {target:.2%}, where {_MOST} realisations of all cases leave {most.error:.2%}; "
            "allowed: a larger one, finer levels, or narrower ranges under `fit: {fixed: ...}`"
        )
    price = _price(pilot, seconds)
    designs = [_enough(ensembles, price, share, target) for share in _shares(pilot)]
    return min(designs, key=lambda design: design.seconds)


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
    ensembles = _ensembles(pilot, variable, fixed or {})
    price = _price(pilot, seconds)
    found = []
    for share in _shares(pilot):
        reference = int(1000 * budget / _cost(price, _counts(share, 1000)))
        while reference >= _FEWEST and _cost(price, _counts(share, reference)) > budget:
            reference -= max(1, reference // 100)
        if reference >= _FEWEST:
            found.append(_described(ensembles, price, _counts(share, reference)))
    if not found:
        least = _cost(price, dict.fromkeys(("reference", *LIMITS), _FEWEST))
        raise UnusableDataError(f"given a budget of {budget:.3g} s; allowed: at least {least:.3g} s of processor time")
    return min(found, key=lambda design: design.error)


def _shares(pilot: xr.Dataset) -> list[dict[str, float]]:
    """Return shares of the realisations; a limit that is not varied has no say."""
    varied = [limit in pilot["limit"].values for limit in LIMITS]
    shares = product(*(_SHARES if there else (1.0,) for there in varied))
    return [dict(zip(LIMITS, share, strict=True)) for share in shares]


def _ensembles(pilot: xr.Dataset, variable: str, fixed: Mapping[str, float | Sequence[float]]) -> list[_Ensemble]:
    ranges = {limit: exponent_range(limit, value) for limit, value in fixed.items()}
    found = []
    for group in collect(pilot, variable, omit_nyquist=True):
        values = group.values[group.complete]
        if len(values) < _FEWEST or not group.levels:
            raise UnusableDataError(f"given a pilot of {len(values)} good realisations; allowed: at least {_FEWEST}")
        found.append(_ensemble(group, values, pilot["limit"].values.astype(str)[group.cases], ranges))
    return found


def _ensemble(
    group: Group, values: Array, limit: NDArray[np.str_], ranges: Mapping[str, tuple[float, float]]
) -> _Ensemble:
    names = list(group.levels)
    log_ratio = np.stack([group.log_ratio(name) for name in names], axis=-1)
    block = whitened(values, log_ratio, np.arange(len(names)))
    ends = np.array([ranges.get(name, (np.nan, np.nan)) for name in names])
    alpha = best_fit([block], ends)
    beta = project([block], alpha)[2][0]
    powers = np.exp(log_ratio * alpha)
    unsure = np.flatnonzero(~(ends[:, 0] == ends[:, 1]))
    slopes = (log_ratio * powers * beta[1:])[:, unsure]  # an exponent that is not known costs certainty as well
    width = ends[unsure, 1] - ends[unsure, 0]
    n = len(values)
    return _Ensemble(
        covariance_of_levels(values),
        np.column_stack([np.ones(len(powers)), powers, slopes]),
        limit,
        np.concatenate([np.zeros(1 + len(names)), np.nan_to_num(12.0 / width**2)]),  # of a uniform distribution
        float(beta[0]),
        float((n - 1) / chi2.ppf(1 - _CONFIDENCE, n - 1)),
    )


def _counts(share: Mapping[str, float], reference: int) -> dict[str, int]:
    return {"reference": reference} | {limit: max(_FEWEST, round(share[limit] * reference)) for limit in LIMITS}


def _price(pilot: xr.Dataset, seconds: Sequence[float]) -> dict[str, float]:
    """Return the seconds of one realisation of all cases of each limit."""
    limits, each = pilot["limit"].values.astype(str), np.asarray(seconds, dtype=float)
    return {name: float(each[limits == name].sum()) for name in ("reference", *LIMITS)}


def _cost(price: Mapping[str, float], counts: Mapping[str, int]) -> float:
    return sum(price[name] * count for name, count in counts.items())


def _errors(ensemble: _Ensemble, counts: Mapping[str, int]) -> tuple[float, float]:
    """Return the relative error of kappa_tfc of nested realisations, and what it were at exponents well known."""
    asked = np.array([counts[limit] for limit in ensemble.limit])
    information = np.zeros_like(ensemble.covariance)
    before = 0
    for count in np.unique(asked):
        there = np.flatnonzero(asked >= count)
        information[np.ix_(there, there)] += (count - before) * np.linalg.inv(ensemble.covariance[np.ix_(there, there)])
        before = count
    fewest, controlled = asked.min(), (asked == asked.min()).sum() if asked.min() < asked.max() else 0
    # how a dear level goes with the cheap ones is told by the fewest surfaces (Lavenberg and Welch 1981)
    loss = (fewest - 2) / max(1, fewest - controlled - 2)
    information /= ensemble.doubt * loss
    sure = ensemble.known == 0
    variances = []
    for x, known in ((ensemble.columns, ensemble.known), (ensemble.columns[:, sure], ensemble.known[sure])):
        variances.append(np.linalg.pinv(x.T @ information @ x + np.diag(known), hermitian=True)[0, 0])
    total, sampling = np.sqrt(variances) / abs(ensemble.kappa)
    return float(total), float(sampling)


def _enough(
    ensembles: Sequence[_Ensemble], price: Mapping[str, float], share: Mapping[str, float], target: float
) -> Design:
    """Return the least multiple of a design that meets a target in every group."""
    low, high = _FEWEST - 1, _FEWEST
    while not _meets(ensembles, _counts(share, high), target):
        low, high = high, 2 * high
    while high - low > max(1, high // 100):
        middle = (low + high) // 2
        low, high = (low, middle) if _meets(ensembles, _counts(share, middle), target) else (middle, high)
    return _described(ensembles, price, _counts(share, high))


def _meets(ensembles: Sequence[_Ensemble], counts: Mapping[str, int], target: float) -> bool:
    return all(_errors(ensemble, counts)[0] <= target for ensemble in ensembles)


def _described(ensembles: Sequence[_Ensemble], price: Mapping[str, float], counts: dict[str, int]) -> Design:
    worst = max(ensembles, key=lambda ensemble: _errors(ensemble, counts)[0])
    total, sampling = _errors(worst, counts)
    relief = {
        name: total**2 - _errors(worst, {**counts, name: 1000 * count})[0] ** 2
        for name, count in counts.items()
        if name in worst.limit
    }
    relief["exponents"] = max(0.0, total**2 - sampling**2)
    limiting = max(relief, key=lambda name: relief[name])
    exponents = float(np.sqrt(relief["exponents"]))
    return Design(counts, total, sampling, exponents, _cost(price, counts), limiting)
