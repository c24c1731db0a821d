"""Extrapolation to the thermodynamic, fractal and continuum (TFC) limit, thesis (4.3).

Realisation r is the same random surface in every case, so the case means are strongly correlated, and a
finer eps_f or eps_t averages over more asperities, so their variances differ several-fold. The fit is
therefore a generalised least-squares one. The covariance of ten cases from thirty realisations is too noisy
to be used raw: it is shrunk towards "common offset plus independent residuals" with the weight of twice as
many pseudo-realisations as there are cases. Each bootstrap replicate estimates it anew: kept fixed, it would
make the errors a fifth too small.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any, Literal

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.optimize import least_squares
from scipy.special import expit
from scipy.stats import norm
from scipy.stats import t as student

from .selection import GROUP, LIMITS, good, groups, reference_levels

BOUNDS = (0.1, 5.0)
WIDEST = 8.0  # ratio of the ends of an exponent's 90 % interval beyond which it is not identified
MODEL = "kappa = kappa_tfc + sum_i C_i eps_i^alpha_i, i in (c, f, t)  [thesis (4.3)]"

_Array = NDArray[np.float64]
_SPAN = np.log(BOUNDS[1] / BOUNDS[0])
_STARTS = (0.5, 2.0)


@dataclass(frozen=True)
class _Group:
    """The usable results of one group: values (realisation, case), nan where there is none."""

    parameters: dict[str, float]
    values: _Array
    levels: dict[str, _Array]  # of the limits that are varied
    reference: dict[str, float]
    n_excluded: int
    notes: list[str]

    def log_ratio(self, limit: str) -> _Array:
        return np.log(self.levels[limit] / self.reference[limit])


@dataclass(frozen=True)
class _Block:
    """One group's whitened problem: minimise |whitener (means - [1, exp(log_ratio alpha)] beta)|."""

    means: _Array
    whitener: _Array
    log_ratio: _Array  # (case, varied limit)
    limits: NDArray[np.intp]  # index of each varied limit in the vector of exponents


def fit_tfc(
    dataset: xr.Dataset,
    variable: str = "kappa",
    exponents: Literal["shared", "free"] = "shared",
    fixed: Mapping[str, float] | None = None,
    omit_nyquist: bool = True,
    bootstrap: int = 400,
    seed: int = 0,
) -> xr.Dataset:
    """Fit thesis (4.3) to each group's case means, with errors from a paired bootstrap over realisations.

    Output: kappa_tfc over (group), C and alpha over (group, limit), their errors, all dimensionless; nan and
    fit_status "refused" where an exponent is not identified; ValueError for an unknown variable, mode or
    limit, or a fixed exponent that is not positive.
    """
    fixed = dict(fixed or {})
    if exponents not in ("shared", "free"):
        raise ValueError(f"exponents is 'shared' or 'free', not {exponents!r}")
    for limit, value in fixed.items():
        if limit not in LIMITS or not 0 < value < np.inf:
            raise ValueError(
                f"fixed takes a positive exponent for {', '.join(LIMITS)}, not {limit!r}: {value!r}"
            )
    usable = good(dataset, variable)
    dataset = dataset.assign({variable: dataset[variable].where(usable)})
    members = [_group(parameters, cases, variable, omit_nyquist) for parameters, cases in groups(dataset)]
    draws = _draws(usable.any("case").values, bootstrap, seed)
    families = [members] if exponents == "shared" else [[member] for member in members]
    rows = [row for family in families for row in _fit_family(family, fixed, draws)]
    return _as_dataset(members, rows).assign_attrs(
        variable=variable,
        exponents=exponents,
        model=MODEL,
        fixed=", ".join(f"{name}: {value:g}" for name, value in fixed.items()) or "none",
        omit_nyquist=str(omit_nyquist),
        bootstrap=bootstrap,
        seed=seed,
    )


def _group(parameters: dict[str, float], cases: xr.Dataset, variable: str, omit_nyquist: bool) -> _Group:
    reference = reference_levels(cases)
    if omit_nyquist:
        cases = cases.isel(case=cases["eps_c"].values < 1 - 1e-9)
    values = cases[variable].transpose("realisation", "case").values.astype(float)
    used = np.isfinite(values).any(axis=0)
    notes = []
    if not used.all():
        notes.append(f"left out, no good realisation: {', '.join(map(str, cases['case_id'].values[~used]))}")
    levels = {}
    for name in LIMITS:
        level = cases[name].values.astype(float)[used]
        if np.unique(level).size > 1:
            levels[name] = level
        else:
            notes.append(f"{name} is not varied: kappa_tfc is not extrapolated in it")
    return _Group(parameters, values[:, used], levels, reference, int(np.isnan(values).sum()), notes)


def _draws(usable: NDArray[np.bool_], bootstrap: int, seed: int) -> NDArray[np.intp]:
    """Return the realisations (replicate, draw) of the bootstrap, the same in all cases and groups."""
    pool = np.flatnonzero(usable)
    if pool.size < 2:
        return np.empty((0, 0), dtype=np.intp)
    # n - 1 draws from n: then the bootstrap variance of a mean is s^2/n without bias (Rao and Wu 1988)
    return np.random.default_rng(seed).choice(pool, (bootstrap, pool.size - 1))


def _covariance(values: _Array) -> _Array:
    """Return the shrunk covariance (case, case) of one realisation's values, from all pairs present."""
    present = np.isfinite(values)
    n = present.sum(axis=0)
    n_cases = n.size
    centred = np.where(present, values - np.nanmean(values, axis=0), 0)
    shared = (present.T.astype(float) @ present).clip(1)
    sample = centred.T @ centred / (shared - 1).clip(1)
    offset = centred.sum(axis=1) / present.sum(axis=1).clip(1)
    residual = (np.where(present, centred - offset[:, None], 0) ** 2).sum(axis=0) / (n - 1).clip(1)
    if not (n > 1).any() or residual.mean() <= (1e-12 * np.nanmax(abs(values))) ** 2:
        return np.eye(n_cases)  # one realisation or perfect data: nothing to weight by
    typical = residual[n > 1].mean()
    # no case, the reference least of all, may look exact by chance
    residual = np.where(n > 1, residual, typical).clip(0.05 * typical)
    between = sample[~np.eye(n_cases, dtype=bool)].mean().clip(0) if n_cases > 1 else 0.0
    target = np.diag(residual) + between
    weight = np.where(shared > 1, shared / (shared + 2 * n_cases), 0)
    eigenvalues, vectors = np.linalg.eigh(weight * sample + (1 - weight) * target)
    # complete data exceed this floor, but for rounding; a covariance from differing pairs may need it
    floor = max(residual.min() * (1 - weight.max()), 1e-12 * eigenvalues[-1])
    return np.asarray((vectors * eigenvalues.clip(floor)) @ vectors.T)


def _block(group: _Group, draw: NDArray[np.intp] | slice, names: Sequence[str]) -> _Block | None:
    """Return the best linear unbiased case means of the realisations drawn, or None if a case has none."""
    values = group.values[draw]
    present = np.isfinite(values)
    if not present.any(axis=0).all():
        return None
    covariance = _covariance(values)
    plain = np.nanmean(values, axis=0)
    rows, surplus = [], []
    patterns, member = np.unique(present, axis=0, return_inverse=True)
    for index, pattern in enumerate(patterns):
        alike = values[member.ravel() == index][:, pattern]
        lower = np.linalg.cholesky(covariance[np.ix_(pattern, pattern)] / len(alike))
        rows.append(solve_triangular(lower, np.eye(len(plain))[pattern], lower=True))
        surplus.append(solve_triangular(lower, alike.mean(axis=0) - plain[pattern], lower=True))
    q, whitener = np.linalg.qr(np.concatenate(rows))
    means = plain + solve_triangular(whitener, q.T @ np.concatenate(surplus))
    log_ratio = np.stack([group.log_ratio(name) for name in group.levels], axis=-1)
    return _Block(means, whitener, log_ratio, np.array([names.index(name) for name in group.levels]))


def _project(blocks: Sequence[_Block], alpha: _Array) -> tuple[_Array, _Array, list[_Array]]:
    """Return residuals, their derivative to alpha (Kaufman 1975) and each block's coefficients."""
    residuals, jacobians, coefficients = [], [], []
    for block in blocks:
        powers = np.exp(block.log_ratio * alpha[block.limits])
        q, r = np.linalg.qr(block.whitener @ np.column_stack([np.ones(len(powers)), powers]))
        data = block.whitener @ block.means
        beta = solve_triangular(r, q.T @ data)
        slope = block.whitener @ (block.log_ratio * powers * beta[1:])
        jacobian = np.zeros((len(powers), alpha.size))
        jacobian[:, block.limits] = q @ (q.T @ slope) - slope
        residuals.append(data - q @ (q.T @ data))
        jacobians.append(jacobian)
        coefficients.append(beta)
    return np.concatenate(residuals), np.concatenate(jacobians), coefficients


def _search(blocks: Sequence[_Block], alpha: _Array, free: NDArray[np.intp]) -> tuple[_Array, float]:
    """Return the exponents (free ones start from alpha, stay inside BOUNDS) and the sum of squares."""

    def exponents(position: _Array) -> _Array:
        trial = alpha.copy()
        trial[free] = BOUNDS[0] * np.exp(_SPAN * expit(position.clip(-20, 20)))
        return trial

    def residuals(position: _Array) -> _Array:
        return _project(blocks, exponents(position))[0]

    def jacobian(position: _Array) -> _Array:
        trial = exponents(position)
        inside = expit(position.clip(-20, 20))
        slope: _Array = trial[free] * _SPAN * inside * (1 - inside)
        return _project(blocks, trial)[1][:, free] * slope

    fraction = (np.log(alpha[free] / BOUNDS[0]) / _SPAN).clip(1e-3, 1 - 1e-3)
    start = np.log(fraction / (1 - fraction))
    # the logistic map keeps alpha in bounds, so that MINPACK can be used: five times faster than "trf" here
    found = least_squares(
        residuals, start, jacobian, method="lm", ftol=1e-14, xtol=1e-14, gtol=1e-14, max_nfev=100
    )
    return exponents(found.x), 2 * float(found.cost)


def _estimates(groups: Sequence[_Group], blocks: Sequence[_Block], alpha: _Array) -> _Array:
    """Return (group, [kappa_tfc, corrections, C, alpha]) with nan for limits that do not enter."""
    table = np.full((len(groups), 1 + 3 * len(LIMITS)), np.nan)
    for row, group, block, beta in zip(table, groups, blocks, _project(blocks, alpha)[2], strict=True):
        row[0] = beta[0]
        for name, exponent, correction in zip(group.levels, alpha[block.limits], beta[1:], strict=True):
            column = 1 + LIMITS.index(name)
            row[column] = correction
            row[column + 3] = correction * group.reference[name] ** -exponent
            row[column + 6] = exponent
    return table


def _fit_family(
    groups: Sequence[_Group], fixed: Mapping[str, float], draws: NDArray[np.intp]
) -> list[dict[str, Any]]:
    """Return one row of results for each of the groups that share their exponents."""
    lacking = [_inseparable(group) for group in groups]
    if any(lacking):
        able = [group for group, reason in zip(groups, lacking, strict=True) if not reason]
        rest = iter(_fit_family(able, fixed, draws))
        return [
            _refused(group, why) if why else next(rest) for group, why in zip(groups, lacking, strict=True)
        ]
    if not groups:
        return []
    shortage = _shortage(groups, fixed)
    if shortage:
        return [_refused(group, shortage) for group in groups]
    names = [name for name in LIMITS if any(name in group.levels for group in groups)]
    alpha = np.array([fixed.get(name, np.nan) for name in names])
    free = np.flatnonzero(np.isnan(alpha))

    def blocks_for(draw: NDArray[np.intp] | slice) -> list[_Block] | None:
        built = [_block(group, draw, names) for group in groups]
        whole = [block for block in built if block is not None]
        return whole if len(whole) == len(groups) else None

    blocks = blocks_for(slice(None))
    assert blocks is not None  # every case kept has a good realisation
    starts = []
    for start in product(_STARTS, repeat=free.size):
        alpha[free] = start
        starts.append(_search(blocks, alpha, free) if free.size else (alpha, 0.0))
    alpha = min(starts, key=lambda found: found[1])[0]
    estimate = _estimates(groups, blocks, alpha)
    replicates = []
    for draw in draws:
        drawn = blocks_for(draw)
        if drawn is not None:
            found = _search(drawn, alpha, free)[0] if free.size else alpha
            replicates.append(_estimates(groups, drawn, found))
    sample = np.array(replicates) if len(replicates) > 1 else np.full((2, *estimate.shape), np.nan)
    error = sample.std(axis=0, ddof=1)
    # percentiles widened to Student's distribution, which small samples need (Hesterberg 2015)
    tail = norm.cdf(student.ppf(0.05, max(draws.shape[1], 1)))
    low, high = np.quantile(sample, [tail, 1 - tail], axis=0)

    doubt = _doubt(groups, blocks, names, free, alpha, low[:, 7:], high[:, 7:])
    rows = []
    for index, (group, block) in enumerate(zip(groups, blocks, strict=True)):
        if doubt:
            reasons = []
            for name, why in doubt.items():
                column = 4 + LIMITS.index(name)
                evidence = _evidence(group, name, estimate[index, column], error[index, column])
                reasons.append(f"exponent of {name} {why} ({evidence}): {_advice(name)}")
            rows.append(_refused(group, "; ".join(reasons)))
            continue
        row = _accepted(group, block, alpha, len(replicates))
        row |= {"estimate": estimate[index], "error": error[index]}
        rows.append(row | {"kappa_tfc_low": low[index, 0], "kappa_tfc_high": high[index, 0]})
    return rows


def _accepted(group: _Group, block: _Block, alpha: _Array, n_replicates: int) -> dict[str, Any]:
    residual, _, (beta,) = _project([block], alpha)
    misfit = block.means - beta[0] - np.exp(block.log_ratio * alpha[block.limits]) @ beta[1:]
    notes = list(group.notes)
    if n_replicates < 2:
        notes.append(f"the sampling error is unknown ({_realisations(group)}, {n_replicates} replicates)")
    return {
        "rms_residual": float(np.sqrt(np.mean(misfit**2))),
        "chi2": float(residual @ residual) if n_replicates > 1 else np.nan,
        "fit_status": "ok",
        "message": "; ".join(notes),
    }


def _inseparable(group: _Group) -> str:
    """Return why the group's cases cannot determine its coefficients at any exponent, or nothing."""
    if not group.levels:
        return "no discretisation is varied over two or more good levels: add levels to the campaign"
    columns = [np.exp(0.7 * group.log_ratio(name)) for name in group.levels]
    n_cases = group.values.shape[1]
    if np.linalg.matrix_rank(np.column_stack([np.ones(n_cases), *columns])) <= len(columns):
        varied = ", ".join(group.levels)
        return f"{n_cases} cases cannot tell {varied} apart: add cases in which only one of them differs"
    return ""


def _shortage(groups: Sequence[_Group], fixed: Mapping[str, float]) -> str:
    """Return which free exponent has fewer than three levels in every group, or nothing."""
    for name in LIMITS:
        levels = max(
            (np.unique(group.levels[name]) for group in groups if name in group.levels), key=len, default=None
        )
        if levels is not None and len(levels) < 3 and name not in fixed:
            return f"exponent of {name} needs three levels, has two ({_fractions(levels)}): {_advice(name)}"
    return ""


def _doubt(
    groups: Sequence[_Group],
    blocks: Sequence[_Block],
    names: Sequence[str],
    free: NDArray[np.intp],
    alpha: _Array,
    low: _Array,
    high: _Array,
) -> dict[str, str]:
    """Return the free exponents that the data do not identify, and why."""
    if not free.size:
        return {}
    jacobian = _project(blocks, alpha)[1][:, free]
    scale = np.sqrt(sum(float(np.sum((block.whitener @ block.means) ** 2)) for block in blocks))
    _, singular, vectors = np.linalg.svd(jacobian)
    if singular[-1] <= 1e-9 * scale:
        return {names[free[abs(vectors[-1]).argmax()]]: "has no influence on the fit"}
    doubt = {}
    for index in free:
        column = LIMITS.index(names[index])
        owner = next(i for i, group in enumerate(groups) if names[index] in group.levels)
        ends = np.array([low[owner, column], high[owner, column]])
        if np.isnan(ends).any():
            ends[:] = alpha[index]
            found = f"of {alpha[index]:.3g}"
        else:
            found = f"with 90 % interval {ends[0]:.3g} to {ends[1]:.3g}"
        if ends[0] < 1.02 * BOUNDS[0] or ends[1] > 0.98 * BOUNDS[1]:
            doubt[names[index]] = f"{found} touches the bounds {BOUNDS[0]:g} and {BOUNDS[1]:g}"
        elif ends[1] > WIDEST * ends[0]:
            doubt[names[index]] = f"{found} is uncertain by more than a factor {WIDEST:g}"
    return doubt


def _fractions(levels: _Array) -> str:
    return ", ".join(
        str(Fraction(float(level)).limit_denominator(10**6)) for level in np.unique(levels)[::-1]
    )


def _realisations(group: _Group) -> str:
    number = int(np.isfinite(group.values).any(axis=1).sum())
    return f"{number} realisation{'s' if number != 1 else ''}"


def _evidence(group: _Group, name: str, value: float, error: float) -> str:
    if name not in group.levels:
        return f"shared with other groups; {name} is not varied in this one"
    accuracy = f"{error:.2g}" if np.isfinite(error) else "unknown"
    return f"C = {value:.3g} +- {accuracy}, levels {_fractions(group.levels[name])}, {_realisations(group)}"


def _advice(name: str) -> str:
    return f"fix it, fixed={{'{name}': 1.0}}, or add levels, or run more realisations"


def _refused(group: _Group, reason: str) -> dict[str, Any]:
    missing = np.full(1 + 3 * len(LIMITS), np.nan)
    return {
        "estimate": missing,
        "error": missing,
        **dict.fromkeys(("kappa_tfc_low", "kappa_tfc_high", "rms_residual", "chi2"), np.nan),
        "fit_status": "refused",
        "message": "; ".join([reason, *group.notes]),
    }


_NOTES = {
    "kappa_tfc": "extrapolated value in the thermodynamic, fractal and continuum limit",
    "kappa_tfc_error": "bootstrap standard deviation",
    "kappa_tfc_low": "lower end of the 90 % bootstrap interval",
    "kappa_tfc_high": "upper end of the 90 % bootstrap interval",
    "C": "coefficient of eps^alpha",
    "alpha": "exponent",
    "correction": "C eps^alpha at the reference discretisation",
    "rms_residual": "rms difference of case means and fit",
    "chi2": "sum of squared residuals weighted by the shrunk covariance",
    "n_excluded": "results left out: not finite or status not ok",
}


def _as_dataset(groups: Sequence[_Group], rows: Sequence[dict[str, Any]]) -> xr.Dataset:
    estimate = np.array([row["estimate"] for row in rows]).reshape(len(rows), -1)
    error = np.array([row["error"] for row in rows]).reshape(len(rows), -1)
    variables: dict[str, Any] = {
        "kappa_tfc": ("group", estimate[:, 0]),
        "kappa_tfc_error": ("group", error[:, 0]),
    }
    for name in ("kappa_tfc_low", "kappa_tfc_high"):
        variables[name] = ("group", [row[name] for row in rows])
    for first, name in ((4, "C"), (7, "alpha"), (1, "correction")):
        variables[name] = (("group", "limit"), estimate[:, first : first + 3])
        variables[f"{name}_error"] = (("group", "limit"), error[:, first : first + 3])
    for name in ("rms_residual", "chi2", "fit_status", "message"):
        variables[name] = ("group", [row[name] for row in rows])
    variables["n_cases"] = ("group", [group.values.shape[1] for group in groups])
    variables["n_realisations"] = ("group", [int(np.isfinite(g.values).any(axis=1).sum()) for g in groups])
    variables["n_excluded"] = ("group", [group.n_excluded for group in groups])
    coords = {name: ("group", [group.parameters[name] for group in groups]) for name in GROUP}
    result = xr.Dataset(variables, {**coords, "limit": list(LIMITS)})
    for name, note in _NOTES.items():
        result[name].attrs["long_name"] = note
    return result
