"""What a few realisations of every case say of the error of more: scatter, columns of the fit, and levels."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.special import chdtri

from gfmd_numba.analysis.fit_warnings import inseparable
from gfmd_numba.analysis.forms import UnusableDataError
from gfmd_numba.analysis.group_means import means_of
from gfmd_numba.analysis.laws import Given, choices, exponent_range
from gfmd_numba.analysis.pooled_covariance import degrees_of_freedom, pooled_covariance
from gfmd_numba.analysis.posterior import linearised, weighed
from gfmd_numba.analysis.selection import CROSS, LIMITS, Group, groups_to_fit
from gfmd_numba.analysis.steps_of_paths import steps_of
from gfmd_numba.arrays import Reals

FEWEST = 20  # realisations: fewer do not tell how they go with the cheaper levels
_CONFIDENCE = 0.98  # of the scatter, which a pilot knows roughly, for 0.9 in all: errors of fits have noise, too

Level = tuple[str, tuple[float, ...]]  # a limit and its eps, "cross" and all eps, or "reference" and none
_REFERENCE: Level = ("reference", ())


@dataclass(frozen=True)
class Ensemble:
    """What a pilot, or results with fewer realisations of some levels, says of one group."""

    covariance: Reals  # (case, case) of one realisation
    columns: Reals  # (case, coefficient) of the fit at the likeliest laws
    slopes: Reals  # (case, parameter) derivatives to the parameters of the laws
    known: Reals  # (coefficient and parameter) what is known of each before the campaign: 1 / variance
    level: NDArray[np.intp]  # (case)
    kappa: float
    doubt: float  # factor on variances
    freedom: float  # degrees of freedom of the variance of kappa


def levels_of(pilot: xr.Dataset) -> list[Level]:
    """Return the reference, the levels of each limit and the cross levels, each in the order of the campaign."""
    order = [_REFERENCE[0], *LIMITS, CROSS]
    return sorted(dict.fromkeys([_REFERENCE, *_level_of_each(pilot)]), key=lambda level: order.index(level[0]))


def level_of_case(pilot: xr.Dataset) -> NDArray[np.intp]:
    """Return the number of each case's level (case), 0 for the reference."""
    numbers = {level: number for number, level in enumerate(levels_of(pilot))}
    return np.array([numbers[level] for level in _level_of_each(pilot)], dtype=np.intp)


def _level_of_each(pilot: xr.Dataset) -> list[Level]:
    """Return the level of each case, whatever the grid varies: an eps of the grid tells no levels apart."""
    references = pilot.isel(case=pilot["limit"].values == _REFERENCE[0])
    alike = tuple(name for name in LIMITS if np.unique(references[name]).size == 1)
    told_by = {limit: (limit,) for limit in LIMITS} | {CROSS: alike, _REFERENCE[0]: ()}
    eps = {name: pilot[name].values.astype(float).tolist() for name in LIMITS}
    names = pilot["limit"].values.astype(str).tolist()
    return [(name, tuple(eps[axis][i] for axis in told_by[name])) for i, name in enumerate(names)]


def ensembles(pilot: xr.Dataset, variable: str, fixed: Mapping[str, float | Sequence[float]]) -> list[Ensemble]:
    """Return what results say of each group, along a path at every step; UnusableDataError where they do not tell."""
    steps = steps_of(pilot, variable)
    if len(steps) > 1:
        return [each for step, one in enumerate(steps) for each in _at_step(step, one, variable, fixed)]
    (pilot,) = steps
    given = {limit: exponent_range(value) for limit, value in fixed.items()}
    found = []
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
        found.append(_ensemble(group, values, level_of_case(pilot)[group.cases], variable, given))
    return found


def _at_step(
    step: int, pilot: xr.Dataset, variable: str, fixed: Mapping[str, float | Sequence[float]]
) -> list[Ensemble]:
    """Return what one step of a path says, which an error names."""
    try:
        return ensembles(pilot, variable, fixed)
    except UnusableDataError as error:
        advice = "`fit: {step: ...}` names a step that is fitted alone, and `fit: {variable: ...}` something else"
        raise UnusableDataError(f"{variable} at step {step} of the path: {error}; {advice}") from None


def _ensemble(group: Group, values: Reals, level: NDArray[np.intp], variable: str, given: Given) -> Ensemble:
    means = means_of(group, values)
    found = [weighed([means], laws) for laws in choices(list(group.levels), [group], given)]
    likeliest = max(found, key=lambda choice: choice.log_weight.max())
    columns, slopes, known, kappa = linearised(means, likeliest)
    covariance = pooled_covariance(values)
    freedom = degrees_of_freedom(values, covariance, columns)
    return Ensemble(
        covariance=covariance,
        columns=columns,
        slopes=slopes,
        known=known,
        level=level,
        kappa=kappa,
        # levels' shares are chosen by it, too
        doubt=float((freedom + len(level) - 1) / chdtri(freedom, _CONFIDENCE)),
        freedom=freedom,
    )


def relative_errors(ensemble: Ensemble, counts: Reals) -> tuple[float, float]:
    """Return the relative error of the TFC limit of nested realisations, and what it were at exponents well known."""
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
    variances = []
    for columns in (ensemble.columns, np.hstack([ensemble.columns, ensemble.slopes])):
        known = np.diag(ensemble.known[: columns.shape[1]])
        variances.append(np.linalg.pinv(columns.T @ information @ columns + known, hermitian=True)[0, 0])
    of_surfaces, error = np.sqrt(variances) / abs(ensemble.kappa)
    return float(error), float(of_surfaces)
