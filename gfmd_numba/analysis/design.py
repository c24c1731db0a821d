"""How many realisations of each limit reach an accuracy at the least cost, from a few realisations of every case."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.stats import chi2

from gfmd_numba.analysis.least_squares import Block, best_fit, covariance_of_levels, project, whitened
from gfmd_numba.analysis.selection import LIMITS, Array, Group, UnusableDataError, collect
from gfmd_numba.analysis.tfc import exponent_range

_SHARES = (1.0, 1 / 2, 1 / 4, 1 / 8, 1 / 16, 1 / 32)  # realisations of a limit over those of the reference
_FEWEST = 20  # realisations: fewer do not tell how they go with the cheaper levels
_CONFIDENCE = 0.9  # that the target is met, as the pilot knows the scatter only roughly
_DRAWS = 100


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
    kappa: float
    exponents: float  # relative error from not knowing the exponents
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
    UnusableDataError where no number of realisations reaches it: what the exponents leave open is then too much.
    """
    ensembles = _ensembles(pilot, variable, fixed or {})
    worst = max(ensemble.exponents for ensemble in ensembles)
    if worst >= target:
        raise UnusableDataError(
            f"given a target of {target:.2%}, where not knowing the exponents alone makes {worst:.2%}; "
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
    free = np.flatnonzero(np.isnan(ends[:, 0]))
    alpha = best_fit([block], ends.mean(axis=1), free)
    beta = project([block], alpha)[2][0]
    powers = np.exp(log_ratio * alpha)
    slopes = (log_ratio * powers * beta[1:])[:, free]  # an exponent that is searched for costs certainty as well
    rng = np.random.default_rng(0)
    drawn = []
    for _ in range(_DRAWS):
        trial = alpha.copy()
        known = np.flatnonzero(~np.isnan(ends[:, 0]))
        trial[known] = ends[known, 0] + (ends[known, 1] - ends[known, 0]) * rng.random(known.size)
        drawn.append(_extrapolated(block, trial))
    n = len(values)
    return _Ensemble(
        covariance_of_levels(values),
        np.column_stack([np.ones(len(powers)), powers, slopes]),
        limit,
        float(beta[0]),
        float(np.std(drawn) / abs(beta[0])),
        float((n - 1) / chi2.ppf(1 - _CONFIDENCE, n - 1)),
    )


def _extrapolated(block: Block, alpha: Array) -> float:
    return float(project([block], alpha)[2][0][0])


def _counts(share: Mapping[str, float], reference: int) -> dict[str, int]:
    return {"reference": reference} | {limit: max(_FEWEST, round(share[limit] * reference)) for limit in LIMITS}


def _price(pilot: xr.Dataset, seconds: Sequence[float]) -> dict[str, float]:
    """Return the seconds of one realisation of all cases of each limit."""
    limits, each = pilot["limit"].values.astype(str), np.asarray(seconds, dtype=float)
    return {name: float(each[limits == name].sum()) for name in ("reference", *LIMITS)}


def _cost(price: Mapping[str, float], counts: Mapping[str, int]) -> float:
    return sum(price[name] * count for name, count in counts.items())


def _sampling(ensemble: _Ensemble, counts: Mapping[str, int]) -> float:
    """Return the relative sampling error of kappa_tfc of nested realisations."""
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
    x = ensemble.columns
    variance = np.linalg.pinv(x.T @ information @ x)[0, 0]
    return float(np.sqrt(ensemble.doubt * loss * variance) / abs(ensemble.kappa))


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
    return all(_sampling(e, counts) ** 2 + e.exponents**2 <= target**2 for e in ensembles)


def _described(ensembles: Sequence[_Ensemble], price: Mapping[str, float], counts: dict[str, int]) -> Design:
    worst = max(ensembles, key=lambda e: _sampling(e, counts) ** 2 + e.exponents**2)
    sampling = _sampling(worst, counts)
    relief = {
        name: sampling**2 - _sampling(worst, {**counts, name: 1000 * count}) ** 2
        for name, count in counts.items()
        if name in worst.limit
    }
    relief["exponents"] = worst.exponents**2
    total = float(np.hypot(sampling, worst.exponents))
    limiting = max(relief, key=lambda name: relief[name])
    return Design(counts, total, sampling, worst.exponents, _cost(price, counts), limiting)
