"""Extrapolation to the thermodynamic, fractal and continuum (TFC) limit, thesis (4.3).

Errors come from a bootstrap that draws whole realisations, because realisation r is the same random surface
in every case. Each replicate estimates the weights anew: kept fixed, they would make the errors a fifth too
small.
"""

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
import xarray as xr
from scipy.stats import norm
from scipy.stats import t as student
from threadpoolctl import threadpool_limits

from gfmd_numba.analysis.error_budget import SOURCES, error_budget, limits
from gfmd_numba.analysis.estimates import Estimates, GroupFit
from gfmd_numba.analysis.exponents import Given, Ranges, exponent_range
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
from gfmd_numba.analysis.least_squares import WhitenedGroup, best_fit, project, search, whitened
from gfmd_numba.analysis.selection import LIMITS, Group, groups_to_fit, processor_time
from gfmd_numba.arrays import Reals

MODEL = "kappa = kappa_tfc + sum_i C_i eps_i^alpha_i, i in (c, f, t)  [thesis (4.3)]"


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
    given = {limit: exponent_range(limit, value) for limit, value in (fixed or {}).items()}
    members = groups_to_fit(dataset, variable, omit_nyquist)
    families = [members] if exponents == "shared" else [[member] for member in members]
    with threadpool_limits(limits=1):  # the matrices are tiny: threads would only wait for one another
        fits = [fit for family in families for fit in _fit_family(family, given, bootstrap, seed)]
    shown = [f"{name}: {low:g}" + f"..{high:g}" * (low < high) for name, (low, high) in given.items()]
    return fit_dataset(dataset, variable, members, fits).assign_attrs(
        variable=variable,
        exponents=exponents,
        model=MODEL,
        fixed=", ".join(shown) or "none",
        omit_nyquist=str(omit_nyquist),
        bootstrap=bootstrap,
        seed=seed,
        **processor_time(dataset),
    )


def _fit_family(groups: Sequence[Group], given: Given, bootstrap: int, seed: int) -> list[GroupFit]:
    """Return the fit of each of the groups that share their exponents."""
    lacking = [inseparable(group) for group in groups]
    if any(lacking):
        able = [group for group, reason in zip(groups, lacking, strict=True) if not reason]
        rest = iter(_fit_family(able, given, bootstrap, seed))
        return [_refused(group, why) if why else next(rest) for group, why in zip(groups, lacking, strict=True)]
    if not groups:
        return []
    lack = shortage(groups, given)
    if lack:
        return [_refused(group, lack) for group in groups]
    ranges = Ranges.of([name for name in LIMITS if any(name in group.levels for group in groups)], given)
    blocks = [_block(group, group.values[group.complete], ranges.names) for group in groups]
    alpha = best_fit(blocks, ranges)
    sample, of_surfaces = _bootstrap(groups, ranges, alpha, bootstrap, seed)
    low, high = _interval(groups, sample)
    doubt = doubtful(groups, blocks, ranges, alpha, low, high)
    if doubt:
        return [_refused(group, _doubts(group, doubt)) for group in groups]
    estimate = _estimates(groups, blocks, alpha)
    error = Estimates(sample.table.std(axis=0, ddof=1))
    sampling = of_surfaces.std(axis=0, ddof=1)
    budget = error_budget(blocks, ranges, alpha, sampling, [group.residual_error for group in groups])
    fits = []
    for index, (group, block) in enumerate(zip(groups, blocks, strict=True)):
        rms_residual, chi2 = _misfit(group, block, alpha)
        notes = [*group.notes, *pressed(ranges, sample.exponent[:, index]), *logarithmic(group)]
        if np.isnan(error.kappa_tfc[index]):
            notes.append(f"the sampling error is unknown ({realisations(group)}, bootstrap {bootstrap})")
        loose = budget[index, SOURCES.index("residual")]
        if loose > 0.1 * error.kappa_tfc[index]:
            notes.append(
                f"the residual may have put kappa_tfc off by another {loose:.2g}: ask the solver for a smaller one"
            )
        fit = GroupFit(
            status="ok",
            message="\n".join(notes),
            estimate=Estimates(estimate.table[index]),
            error=Estimates(error.table[index]),
            kappa_tfc_low=low.kappa_tfc[index],
            kappa_tfc_high=high.kappa_tfc[index],
            budget=budget[index],
            rms_residual=rms_residual,
            chi2=chi2,
        )
        fits.append(fit)
    return fits


def _interval(groups: Sequence[Group], sample: Estimates) -> tuple[Estimates, Estimates]:
    """Return the ends (group) of the 90 % intervals of estimates (replicate, group)."""
    # percentiles widened to Student's distribution, which small samples need (Hesterberg 2015)
    tails = [norm.cdf(student.ppf(0.05, max(group.n_realisations - 1, 1))) for group in groups]
    ends = [np.quantile(sample.table[:, i], [tail, 1 - tail], axis=0) for i, tail in enumerate(tails)]
    low, high = np.stack(ends, axis=1)
    return Estimates(low), Estimates(high)


def _doubts(group: Group, doubt: Mapping[str, str]) -> str:
    reasons = [f"exponent of {name} {why} ({evidence(group, name)})" for name, why in doubt.items()]
    return "\n".join([*reasons, advice(doubt)])


def _block(group: Group, values: Reals, names: Sequence[str]) -> WhitenedGroup:
    log_ratio = np.stack([group.log_ratio(name) for name in group.levels], axis=-1)
    return whitened(values, log_ratio, np.array([names.index(name) for name in group.levels]))


def _bootstrap(
    groups: Sequence[Group], ranges: Ranges, alpha: Reals, number: int, seed: int
) -> tuple[Estimates, Reals]:
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
        guesses = ranges.drawn(rng.random((number, len(ranges.names))))
        for draw, guess in zip(draws, guesses, strict=True):
            values = [group.values[draw[group.complete[draw]]] for group in groups]
            if all(len(each) for each in values):
                blocks = [_block(*pair, ranges.names) for pair in zip(groups, values, strict=True)]
                found = _estimates(groups, blocks, search(blocks, alpha, ranges, guess)[0])
                sample.append(found.table)
                in_the_middle = search(blocks, alpha, ranges, ranges.middle)[0] if ranges.any_wide else None
                of_surfaces.append(found.kappa_tfc if in_the_middle is None else limits(blocks, in_the_middle))
    if len(sample) < 2:
        return Estimates.unknown(2, len(groups)), np.full((2, len(groups)), np.nan)
    estimates, kappa = Estimates(np.array(sample)), np.array(of_surfaces)
    # one realisation drawn again and again has no scatter, which is not to be taken for precision
    alone = [group.n_realisations < 2 for group in groups]
    for parameter in (estimates.kappa_tfc, estimates.correction, estimates.coefficient, kappa):
        parameter[:, alone] = np.nan
    return estimates, kappa


def _estimates(groups: Sequence[Group], blocks: Sequence[WhitenedGroup], alpha: Reals) -> Estimates:
    """Return the parameters (group) at given exponents."""
    found = Estimates.unknown(len(groups))
    coefficients = project(blocks, alpha)[2]
    for index, (group, block, beta) in enumerate(zip(groups, blocks, coefficients, strict=True)):
        found.kappa_tfc[index] = beta[0]
        for name, exponent, correction in zip(group.levels, alpha[block.limits], beta[1:], strict=True):
            limit = LIMITS.index(name)
            found.correction[index, limit] = correction
            found.coefficient[index, limit] = correction * group.reference[name] ** -exponent
            found.exponent[index, limit] = exponent
    return found


def _misfit(group: Group, block: WhitenedGroup, alpha: Reals) -> tuple[float, float]:
    """Return the rms residual of a group's means, and their chi^2, nan of a single realisation."""
    residual, _, (beta,) = project([block], alpha)
    misfit = block.means - beta[0] - np.exp(block.log_ratio * alpha[block.limits]) @ beta[1:]
    chi2 = float(residual @ residual) if group.n_realisations > 1 else np.nan
    return float(np.sqrt(np.mean(misfit**2))), chi2


def _refused(group: Group, reason: str) -> GroupFit:
    return GroupFit(
        status="refused",
        message="\n".join([reason, *group.notes]),
        estimate=Estimates.unknown(),
        error=Estimates.unknown(),
        kappa_tfc_low=np.nan,
        kappa_tfc_high=np.nan,
        budget=np.full(len(SOURCES), np.nan),
        rms_residual=np.nan,
        chi2=np.nan,
    )
