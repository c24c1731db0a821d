"""Extrapolation to the thermodynamic, fractal and continuum (TFC) limit, thesis (4.3).

Errors come from a bootstrap that draws whole realisations, because realisation r is the same random surface
in every case. Each replicate estimates the weights anew: kept fixed, they would make the errors a fifth too
small.
"""

from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any, Literal

import numpy as np
import xarray as xr
from scipy.stats import norm
from scipy.stats import t as student
from threadpoolctl import threadpool_limits

from gfmd_numba.analysis.error_budget import SOURCES, error_budget, limits
from gfmd_numba.analysis.fit_dataset import fit_dataset
from gfmd_numba.analysis.fit_warnings import (
    advice,
    doubtful,
    evidence,
    inseparable,
    logarithmic,
    pressed,
    realisations,
    shortage,
)
from gfmd_numba.analysis.least_squares import Block, best_fit, project, search, whitened
from gfmd_numba.analysis.selection import LIMITS, Array, Group, collect, processor_time

MODEL = "kappa = kappa_tfc + sum_i C_i eps_i^alpha_i, i in (c, f, t)  [thesis (4.3)]"

_Row = dict[str, Any]
_Ranges = Mapping[str, tuple[float, float]]


def fit_tfc(
    dataset: xr.Dataset,
    variable: str = "kappa",
    exponents: Literal["shared", "free"] = "shared",
    fixed: Mapping[str, float | Sequence[float]] | None = None,
    omit_nyquist: bool = True,
    bootstrap: int = 400,
    seed: int = 0,
) -> xr.Dataset:
    """Fit thesis (4.3) to each group's case means, with errors from a paired bootstrap over realisations.

    Of an exponent fixed to a range (low, high) every value in it counts by how well it fits, and the errors include
    not knowing it.
    Only realisations that are good in all of a group's cases enter it, and cases at eps_c = 1 are omitted unless
    the group's reference is one. Corrections count from the group's reference case; of several, as eps in a
    campaign's `grid` leaves them, from the finest, and without any from the finest levels. Output: kappa_tfc,
    reference (mean of the reference case) and message (one line for each thing to know) over (group), C, alpha and
    correction over (group, limit), their errors, error_budget over (group, source), all dimensionless, and seconds
    of processor time over (group), where groups that share a problem each count it; the attribute cpu_seconds counts
    it once. nan and fit_status "refused" where an exponent is not identified; ValueError for an unknown variable, mode
    or limit, or a wrong fixed exponent.
    """
    if exponents not in ("shared", "free"):
        raise ValueError(f"exponents is 'shared' or 'free', not {exponents!r}")
    if not isinstance(fixed, Mapping | None):
        raise ValueError(f"fixed is a mapping like {{'eps_c': 1.0, 'eps_f': (0.5, 1.0)}}, not {fixed!r}")
    if type(bootstrap) is not int or bootstrap < 0 or type(seed) is not int or seed < 0:
        raise ValueError(f"bootstrap and seed are whole numbers of at least 0, not {bootstrap!r} and {seed!r}")
    ranges = {limit: exponent_range(limit, value) for limit, value in (fixed or {}).items()}
    members = collect(dataset, variable, omit_nyquist)
    families = [members] if exponents == "shared" else [[member] for member in members]
    with threadpool_limits(limits=1):  # the matrices are tiny: threads would only wait for one another
        rows = [row for family in families for row in _fit_family(family, ranges, bootstrap, seed)]
    shown = [f"{name}: {low:g}" + f"..{high:g}" * (low < high) for name, (low, high) in ranges.items()]
    return fit_dataset(dataset, variable, members, rows).assign_attrs(
        variable=variable,
        exponents=exponents,
        model=MODEL,
        fixed=", ".join(shown) or "none",
        omit_nyquist=str(omit_nyquist),
        bootstrap=bootstrap,
        seed=seed,
        **processor_time(dataset),
    )


def exponent_range(limit: str, value: float | Sequence[float]) -> tuple[float, float]:
    """Return the ends of the range of a fixed exponent; ValueError for another limit or no positive numbers."""
    ends = tuple(value) if isinstance(value, Sequence) else (value, value)
    numbers = len(ends) == 2 and all(isinstance(end, Real) for end in ends)
    if limit not in LIMITS or not numbers or not 0 < ends[0] <= ends[1] < np.inf:
        raise ValueError(
            f"fixed takes a positive exponent, or a range of them as (low, high), for {', '.join(LIMITS)}, "
            f"not {limit!r}: {value!r}"
        )
    return float(ends[0]), float(ends[1])


def _fit_family(groups: Sequence[Group], ranges: _Ranges, bootstrap: int, seed: int) -> list[_Row]:
    """Return one row of results for each of the groups that share their exponents."""
    lacking = [inseparable(group) for group in groups]
    if any(lacking):
        able = [group for group, reason in zip(groups, lacking, strict=True) if not reason]
        rest = iter(_fit_family(able, ranges, bootstrap, seed))
        return [_refused(group, why) if why else next(rest) for group, why in zip(groups, lacking, strict=True)]
    if not groups:
        return []
    lack = shortage(groups, ranges)
    if lack:
        return [_refused(group, lack) for group in groups]
    names = [name for name in LIMITS if any(name in group.levels for group in groups)]
    ends = np.array([ranges.get(name, (np.nan, np.nan)) for name in names])
    free = np.flatnonzero(np.isnan(ends[:, 0]))
    blocks = [_block(group, group.values[group.complete], names) for group in groups]
    alpha = best_fit(blocks, ends)
    estimate = _estimates(groups, blocks, alpha)
    sample, of_surfaces = _bootstrap(groups, names, ends, alpha, bootstrap, seed)
    error = sample.std(axis=0, ddof=1)
    sampling = of_surfaces.std(axis=0, ddof=1)
    budget = error_budget(blocks, names, ends, alpha, sampling, [group.residual_error for group in groups])
    # percentiles widened to Student's distribution, which small samples need (Hesterberg 2015)
    tails = [norm.cdf(student.ppf(0.05, max(group.n_realisations - 1, 1))) for group in groups]
    intervals = [np.quantile(sample[:, i], [tail, 1 - tail], axis=0) for i, tail in enumerate(tails)]
    low, high = np.stack(intervals, axis=1)
    doubt = doubtful(groups, blocks, names, free, alpha, low[:, 7:], high[:, 7:])
    rows = []
    for index, (group, block) in enumerate(zip(groups, blocks, strict=True)):
        if doubt:
            reasons = [f"exponent of {name} {why} ({evidence(group, name)})" for name, why in doubt.items()]
            rows.append(_refused(group, "\n".join([*reasons, advice(doubt)])))
            continue
        row = _accepted(group, block, alpha)
        told = [*pressed(names, ends, sample[:, index, 7:]), *logarithmic(group)]
        row["message"] = "\n".join([*group.notes, *told])
        if np.isnan(error[index, 0]):
            unknown = f"the sampling error is unknown ({realisations(group)}, bootstrap {bootstrap})"
            row["message"] = "\n".join([row["message"], unknown]).lstrip()
        loose = budget[index, SOURCES.index("residual")]
        if loose > 0.1 * error[index, 0]:
            ask = f"the residual may have put kappa_tfc off by another {loose:.2g}: ask the solver for a smaller one"
            row["message"] = "\n".join([row["message"], ask]).lstrip()
        row |= {"estimate": estimate[index], "error": error[index], "budget": budget[index]}
        rows.append(row | {"kappa_tfc_low": low[index, 0], "kappa_tfc_high": high[index, 0]})
    return rows


def _block(group: Group, values: Array, names: Sequence[str]) -> Block:
    log_ratio = np.stack([group.log_ratio(name) for name in group.levels], axis=-1)
    return whitened(values, log_ratio, np.array([names.index(name) for name in group.levels]))


def _bootstrap(
    groups: Sequence[Group], names: Sequence[str], ends: Array, alpha: Array, number: int, seed: int
) -> tuple[Array, Array]:
    """Return the estimates (replicate, group, ...) from realisations drawn for all groups alike, or nan.

    And those of kappa_tfc (replicate, group) where the guess of an exponent is always the middle of its range.
    """
    sample, of_surfaces = [], []
    pool = np.flatnonzero(np.any([group.complete for group in groups], axis=0))
    if pool.size > 1:
        rng = np.random.default_rng(seed)
        _, kind = np.unique(np.hstack([group.asked for group in groups])[pool], axis=0, return_inverse=True)
        strata = [pool[kind.ravel() == index] for index in range(kind.max() + 1)]  # each design its own realisations
        # n - 1 draws from n: then the bootstrap variance of a mean is s^2/n without bias (Rao and Wu 1988)
        draws = np.hstack([rng.choice(alike, (number, max(1, alike.size - 1))) for alike in strata])
        # what is guessed of an exponent fixed to a range differs between replicates: errors include not knowing it
        guesses = ends[:, 0] + (ends[:, 1] - ends[:, 0]) * rng.random((number, len(ends)))
        middle, ranged = ends.mean(axis=1), (ends[:, 0] < ends[:, 1]).any()
        for draw, guess in zip(draws, guesses, strict=True):
            values = [group.values[draw[group.complete[draw]]] for group in groups]
            if all(len(each) for each in values):
                blocks = [_block(*pair, names) for pair in zip(groups, values, strict=True)]
                found = _estimates(groups, blocks, search(blocks, alpha, ends, guess)[0])
                sample.append(found)
                of_surfaces.append(limits(blocks, search(blocks, alpha, ends, middle)[0]) if ranged else found[:, 0])
    if len(sample) < 2:
        return np.full((2, len(groups), 1 + 3 * len(LIMITS)), np.nan), np.full((2, len(groups)), np.nan)
    estimates, kappa = np.array(sample), np.array(of_surfaces)
    # one realisation drawn again and again has no scatter, which is not to be taken for precision
    alone = [group.n_realisations < 2 for group in groups]
    estimates[:, alone, :7] = np.nan
    kappa[:, alone] = np.nan
    return estimates, kappa


def _estimates(groups: Sequence[Group], blocks: Sequence[Block], alpha: Array) -> Array:
    """Return (group, [kappa_tfc, corrections, C, alpha]) with nan for limits that do not enter."""
    table = np.full((len(groups), 1 + 3 * len(LIMITS)), np.nan)
    for row, group, block, beta in zip(table, groups, blocks, project(blocks, alpha)[2], strict=True):
        row[0] = beta[0]
        for name, exponent, correction in zip(group.levels, alpha[block.limits], beta[1:], strict=True):
            column = 1 + LIMITS.index(name)
            row[column] = correction
            row[column + 3] = correction * group.reference[name] ** -exponent
            row[column + 6] = exponent
    return table


def _accepted(group: Group, block: Block, alpha: Array) -> _Row:
    residual, _, (beta,) = project([block], alpha)
    misfit = block.means - beta[0] - np.exp(block.log_ratio * alpha[block.limits]) @ beta[1:]
    return {
        "rms_residual": float(np.sqrt(np.mean(misfit**2))),
        "chi2": float(residual @ residual) if group.n_realisations > 1 else np.nan,
        "fit_status": "ok",
        "message": "\n".join(group.notes),
    }


def _refused(group: Group, reason: str) -> _Row:
    missing = np.full(1 + 3 * len(LIMITS), np.nan)
    return {
        "estimate": missing,
        "error": missing,
        "budget": np.full(len(SOURCES), np.nan),
        **dict.fromkeys(("kappa_tfc_low", "kappa_tfc_high", "rms_residual", "chi2"), np.nan),
        "fit_status": "refused",
        "message": "\n".join([reason, *group.notes]),
    }
