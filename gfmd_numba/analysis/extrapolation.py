"""Extrapolation to the thermodynamic, fractal and continuum (TFC) limit, thesis (4.3).

The discretisations are eps_c = 2 dx / lambda_s, eps_f = lambda_s / lambda_l and eps_t = lambda_l / L_x, where lambda_s
and lambda_l are the shortest and the longest wavelength. The model of the means y of the cases is

    y = v + sum_i C_i x_i + sum_ij C_ij x_i x_j,    x_i = eps_i^alpha_i,

or for kappa against eps_f the law of the unseen slope (`laws.py`). Before there are data, an exponent is uniform in its
range, and without a range uniform in its logarithm. A campaign gives the ranges of `theory/exponent_ranges.py`;
`fit_tfc` without `fixed` takes the widest ones, `laws.BOUNDS`.

At node n of a quadrature over the parameters of the laws, the model has the design matrix A_n (case, coefficient) and
is linear in its coefficients c = (v, corrections, interactions). With the covariance V of the means (`gauss_markov.py`)
and the prior precision P of c (`exponent_posterior.py`),

    chi_n^2 = min over c of (y - A_n c)^T V^-1 (y - A_n c) + c^T P c,    S_n = (A_n^T V^-1 A_n + P)^-1.

Node n has the weight w_n ~ volume times prior times exp(-chi_n^2 / 2), sum_n w_n = 1. With the limit v_n at each node,

    v_tfc = sum_n w_n v_n,
    error^2 = sum_n w_n (v_n - v_tfc)^2     the laws and their parameters     (sources eps_c, eps_f and eps_t)
            + sum_n w_n (S_n)_vv            scatter of surfaces, and priors   (sources sampling and interaction)
            + sum_n w_n sum_i d_ni^2        laws beyond their finest levels   (source extrapolation)
            + r^2                           fits that disagree with this one  (source rivals).

Where groups share exponents, the chi_n^2 of all groups add up in w_n. The error d_ni is 0.3 of the distance from the
finest level of limit i to its limit. It is less under the law of the unseen slope, and the whole distance if the data
press an exponent against the end of its range; thin layers add an error to that of eps_t. The largest disagreement with
another fit is r. Both are found in `limit_errors.py`, whose `error_budget` divides error^2 among the sources. The
residuals of the solvers are not part of error^2: a note tells of them where they count.

If chi^2 exceeds its limit of 95 %, the coarsest levels are left out. If that does not help, V is multiplied by the
`misfit_factor` that makes chi^2 fit. If v_tfc lies beyond what the variable can be, the distribution of v is cut there.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
import scipy  # its modules load with their first use
import xarray as xr

from gfmd_numba.analysis import limit_errors
from gfmd_numba.analysis.arguments import Exponents, Fixed, Flag, Variable, checked
from gfmd_numba.analysis.exponent_posterior import ChoiceOfLaws, Laws, Linear, Means, along, posterior_weights, weighed
from gfmd_numba.analysis.fit_dataset import N_PARAMETERS, PAIRS, SOURCES, STEPS, GroupFit, fit_dataset, named
from gfmd_numba.analysis.forms import CAMPAIGN
from gfmd_numba.analysis.gauss_markov import means_of, misfit_factor
from gfmd_numba.analysis.laws import POWER, UNSEEN_SLOPE, Given, choices, given_ranges
from gfmd_numba.analysis.limit_errors import Rival
from gfmd_numba.analysis.selection import LIMITS, Group, fractions, groups_to_fit, joined, processor_time, steps_of
from gfmd_numba.arrays import Reals
from gfmd_numba.arrays.threads import one_thread_of_algebra
from gfmd_numba.text.input_error import InputError
from gfmd_numba.text.numbers import counted, with_error
from gfmd_numba.text.recorded_scene import asked

MODEL = (
    "{variable} = {variable}_tfc + sum_i C_i x_i + sum_ij C_ij x_i x_j, i and j in (c, f, t), where x_i = "
    "eps_i^alpha_i [thesis (4.3)] or, of a kappa against eps_f, 1 / sqrt(1 - S) - 1 with the share S of g^2 that "
    "contacts do not see"
)
_TAIL = 0.05  # beyond each end of an interval
_BY_CHANCE = 0.1  # error of a limit over the results, up to which it may be at an end of what is possible
_WORTH_A_NOTE = 1.01  # factor on errors


@checked
def fit_tfc(
    dataset: Annotated[xr.Dataset, CAMPAIGN],
    variable: Variable = "kappa",
    exponents: Exponents = "shared",
    fixed: Fixed | None = None,
    omit_nyquist: Flag = True,
    step: int | None = None,
) -> xr.Dataset:
    """Fit thesis (4.3), with interactions of the limits, to each group's case means.

    An exponent may be `fixed` to a number or to a range (low, high): then every value in the range counts by how well
    it fits, and the errors include the scatter between these values. The errors also allow for corrections that do not
    add up, which only cross levels measure. Only realisations that are good in all of a group's cases enter it, and
    cases at eps_c = 1 are omitted unless the group's reference is one. Corrections count from the group's reference
    case; of several, as eps in a campaign's `grid` leaves them, from the finest, and without any from the finest
    levels. Output: the limit, under the name of the variable with `_tfc` behind it like kappa_tfc or mean_gap_tfc,
    reference (mean of the reference case) and message (one line for each thing to know) over (group), C, alpha and
    correction over (group, limit), interaction over (group, pair), their errors, error_budget over (group, source). All
    but alpha have the unit of the variable. Also seconds of processor time over (group), where groups that share a
    problem each count it; the attribute cpu_seconds counts it once. nan and fit_status "refused" where an exponent is
    not identified; ValueError for an unknown variable, mode or limit, or a wrong fixed exponent.

    Each step of a loading path, or the one that is given as `step`, is fitted for itself, so that groups also differ
    in `path_step`; what is known of the path as a whole, like `pull_off_pressure`, is fitted once.
    """
    given = given_ranges(fixed or {})
    if step is not None or {"case", "step"} <= set(dataset.dims):
        steps = steps_of(dataset, variable, step)
        return joined([fit_tfc(one, variable, exponents, fixed, omit_nyquist) for one in steps])
    ends = np.array([given.get(name, (np.nan, np.nan)) for name in LIMITS])
    ranges: GroupFit = {"alpha_low": ends[:, 0], "alpha_high": ends[:, 1]}
    members = groups_to_fit(dataset, variable, omit_nyquist)
    with one_thread_of_algebra():
        fits = [fit | ranges for family in _families(members, exponents) for fit in _fit_family(family, given)]
    shown = [f"{name}: {low:g}" + f"..{high:g}" * (low < high) for name, (low, high) in given.items()]
    return fit_dataset(dataset, variable, members, fits).assign_attrs(
        variable=variable,
        exponents=exponents,
        model=MODEL.format(variable=variable),
        fixed=", ".join(shown) or "none",
        omit_nyquist=str(omit_nyquist),
        **processor_time(dataset),
        **asked(dataset.attrs),
    )


@checked
def check_effect(
    dataset: Annotated[xr.Dataset, CAMPAIGN],
    fixed: Fixed,
    variable: Variable = "kappa",
    exponents: Exponents = "shared",
    step: int | None = None,
) -> None:
    """Raise InputError for a fixed exponent that no law of any levels has, with those that a fit omits."""
    given = given_ranges(fixed)
    steps = steps_of(dataset, variable, step)
    members = [each for one in steps for each in groups_to_fit(one, variable, omit_nyquist=False)]

    def parameters(given: Given) -> list[object]:
        laws = [each for family in _families(members, exponents) for each in _choices(family, given)]
        return [{limit: law.parameters for limit, law in each.items()} for each in laws]

    for name in given:
        if parameters(given) == parameters({limit: each for limit, each in given.items() if limit != name}):
            why = "the unseen slope is the law of such steep spectra; a number replaces it by a power"
            if not any(name in group.levels for group in members):
                why = "these results have no levels of it"
            raise InputError.of("fixed", f"an exponent of {name}", f"none for {name}: {why}")


def refusals(dataset: xr.Dataset, variable: str, exponents: Exponents, fixed: Fixed) -> dict[str, int]:
    """Return why a fit of these cases is refused whatever their values are, and of how many groups that is true."""
    families = _families(groups_to_fit(dataset, variable, omit_nyquist=True), exponents)
    return dict(Counter(lack for family in families for lack in _lacks(family, given_ranges(fixed)) if lack))


def _families(members: list[Group], exponents: Exponents) -> list[list[Group]]:
    """Return the groups that share the parameters of their laws."""
    return [members] if exponents == "shared" else [[member] for member in members]


def _choices(groups: Sequence[Group], given: Given) -> list[Laws]:
    varied = [limit for limit in LIMITS if any(limit in group.levels for group in groups)]
    return choices(varied, groups, given)


def _lacks(groups: Sequence[Group], given: Given) -> list[str]:
    """Return what the cases of each of the groups that share their laws lack for a fit; nothing of those with all."""
    lacks = [limit_errors.inseparable(group) or limit_errors.single_hills(group) for group in groups]
    able = [group for group, lack in zip(groups, lacks, strict=True) if not lack]
    short = limit_errors.shortage(able, _choices(able, given)) if able else ""
    return [lack or short for lack in lacks]


def _fit_family(groups: Sequence[Group], given: Given) -> list[GroupFit]:
    """Return the fit of each of the groups that share the parameters of their laws."""
    lacks = _lacks(groups, given)
    if any(lacks):
        able = [group for group, lack in zip(groups, lacks, strict=True) if not lack]
        rest = iter(_fit_family(able, given))
        return [_refused(group, lack) if lack else next(rest) for group, lack in zip(groups, lacks, strict=True)]
    if not groups:
        return []
    laws = _choices(groups, given)
    loads = list(dict.fromkeys(group.load for group in groups))
    if len(loads) > 1 and np.min(loads) > 0.0 and any(law.scales_limit for each in laws for law in each.values()):
        # the parameters of the unseen slope depend on the load, so that groups of several do not share them
        of_load = {load: iter(_fit_family([g for g in groups if g.load == load], given)) for load in loads}
        return [next(of_load[group.load]) for group in groups]
    whole = found = _weighed(groups, laws)
    left_out: list[str] = []
    while found.misfit_factor > 1.0 and (fewer := limit_errors.without_coarsest(found.groups)) is not None:
        left_out.append(fewer[0])
        found = _weighed(fewer[1], laws)
    if found.misfit_factor > 1.0:  # no law describes any of the levels, so that there is no reason to leave some out
        left_out, found = [], whole
    why = limit_errors.unidentified_exponents(found.choices, found.weights)
    if why:
        advice = limit_errors.advice(why, groups[0].variable, groups[0].dimension)
        return [_refused(group, "\n".join([*_reasons(group, why), advice])) for group in groups]
    others = [
        (rival, _weighed(rival.groups, _choices(rival.groups, rival.given)))
        for rival in limit_errors.rivals(found.groups, given)
    ]
    return [_fit(index, found, others, left_out) for index in range(len(groups))]


@dataclass(frozen=True)
class _Weighed:
    """The fits of some groups by every choice of laws.

    `weights` are those of the nodes of each choice. The covariance of the means has been multiplied by the
    `misfit_factor`, 1 where a law describes them.
    """

    groups: Sequence[Group]
    means: list[Means]
    choices: list[ChoiceOfLaws]
    weights: list[Reals]
    misfit_factor: float

    def limit_of(self, index: int) -> tuple[float, float]:
        """Return the limit of one group and its variance."""
        return _moments(np.concatenate(self.weights), [choice.fits[index] for choice in self.choices])


def _moments(weight: Reals, fits: Sequence[Linear]) -> tuple[float, float]:
    """Return the mean of the limits of fits, whose nodes have these weights, and its variance."""
    value = np.concatenate([fit.coefficients[:, 0] for fit in fits])
    variance = np.concatenate([fit.covariance[:, 0, 0] for fit in fits])
    mean = float(weight @ value)
    return mean, float(weight @ (variance + (value - mean) ** 2))


def _weighed(groups: Sequence[Group], laws: Sequence[Laws]) -> _Weighed:
    means = [means_of(group, group.values[group.complete]) for group in groups]
    found = [weighed(means, choice) for choice in laws]
    factor = misfit_factor(groups, means, found)
    if factor > 1.0:  # no law describes the means within their errors, which are enlarged until one does
        means = [replace(each, whitener=each.whitener / np.sqrt(factor)) for each in means]
        found = [weighed(means, choice) for choice in laws]
    return _Weighed(groups, means, found, posterior_weights(found), factor)


def _fit(index: int, whole: _Weighed, others: Sequence[tuple[Rival, _Weighed]], left_out: Sequence[str]) -> GroupFit:
    group, means, found, weights = whole.groups[index], whole.means[index], whole.choices, whole.weights
    fits = [choice.fits[index] for choice in found]
    weight = np.concatenate(weights)
    value = np.concatenate([_parameters(group, fit) for fit in fits])
    variance = np.concatenate([_parameters(group, fit, variances=True) for fit in fits])
    at_an_end = limit_errors.pressed(found, weights)
    of_each = [limit_errors.extrapolation_errors(index, group, means, choice, at_an_end) for choice in found]
    by_limit = np.concatenate(of_each) ** 2
    mine = whole.limit_of(index)
    by_rival = max((rival.error(*mine, *other.limit_of(index)) ** 2 for rival, other in others), default=0.0)
    variance[:, 0] += by_limit.sum(axis=1) + by_rival
    likeliest = value[weight.argmax()]
    estimate = likeliest + weight @ (value - likeliest)  # what is the same at all nodes stays exactly that
    error = np.sqrt(weight @ (variance + (value - estimate) ** 2))
    extrapolation_error = np.sqrt(weight @ by_limit)
    beyond_the_fit = extrapolation_error, float(np.sqrt(by_rival))
    budget = limit_errors.error_budget(index, means, found, weights, beyond_the_fit, group.residual_error)
    deviation = np.sqrt(variance[:, 0])
    distance = np.sum([s @ limit_errors.distances(index, means, c) for c, s in zip(found, weights, strict=True)], 0)
    moments = _possible(group, (estimate[0], error[0]), weight, value[:, 0], deviation)
    if moments is None:
        reason = limit_errors.impossible(group, estimate[0], error[0], distance)
        return _refused(group, reason) | {"extrapolation_error": extrapolation_error}
    estimate[0], error[0] = moments
    notes = [*_notes(index, whole, others, left_out, error), *limit_errors.too_far(group, estimate[0], distance)]
    if group.n_realisations < 2:
        error = np.full_like(error, np.nan)
        budget[: SOURCES.index("residual")] = np.nan
        notes.append(f"the sampling error is unknown ({counted(group.n_realisations, 'realisation')})")
    asserted = {each.asserted: limit_errors.disagreement(*mine, *other.limit_of(index)) for each, other in others}
    loose = budget[SOURCES.index("residual")]
    if loose > 0.1 * error[0]:
        notes.append(
            f"residuals, or divisions of time, may have put {group.variable}_tfc off by another {group.shown(loose)}: "
            "ask for a smaller numerics.residual, or time_tolerance"
        )
    low, high = _interval(group, weight, value[:, 0], deviation)
    rms_residual, chi2 = _misfit(group, means, found, weights, index)
    laws = {name: " or ".join(dict.fromkeys(choice.laws[name].name for choice in found)) for name in group.levels}
    return {
        "fit_status": "ok",
        "message": "\n".join(notes),
        **named(estimate),
        **named(error, "_error"),
        "{variable}_tfc_low": low,
        "{variable}_tfc_high": high,
        "error_budget": budget,
        "rms_residual": rms_residual,
        "chi2": whole.misfit_factor * chi2,
        "misfit": float(np.sqrt(whole.misfit_factor)),
        "freedom": group.n_cases - fits[0].coefficients.shape[1],
        "law": [laws.get(name, "") for name in LIMITS],
        **_curve(index, group, means, found, weights),
        "extrapolated": distance,
        "extrapolation_error": extrapolation_error,
        # what the value differs by where an asserted exponent may have its range
        "contradiction": [asserted.get(name, 0.0) if name in group.levels else np.nan for name in LIMITS],
    }


def _notes(
    index: int, whole: _Weighed, others: Sequence[tuple[Rival, _Weighed]], left_out: Sequence[str], error: Reals
) -> list[str]:
    """Return a line for each thing to be known of the fit of a group: of its laws, its levels and its exponents."""
    group, found, mine = whole.groups[index], whole.choices, whole.limit_of(index)
    differing = [(rival, limit_errors.disagreement(*mine, *other.limit_of(index))) for rival, other in others]
    of_theory = [(rival.what, other.limit_of(index)) for rival, other in others if rival.from_theory]
    far = float(np.sqrt(whole.misfit_factor))
    too_far = (
        f"the means lie {far:.3g} times as far from the laws as their errors allow, so all errors are multiplied by "
        f"{far:.3g}; add finer levels, or allow other exponents"
    )
    return [
        *group.notes,
        *_by_law(index, group, found, whole.weights),
        *(
            f"{what}, without what is given of the exponent, {group.variable}_tfc is "
            f"{with_error(value, float(np.sqrt(variance)))}: the error includes this"
            for what, (value, variance) in of_theory
        ),
        *limit_errors.pressed(found, whole.weights).values(),
        *limit_errors.logarithmic(group, found),
        *limit_errors.additivity(group, error),
        *limit_errors.note_of_thin_layers(group, whole.means[index]),
        *limit_errors.notes_of_one_period(group, found),
        *(f"{what} is left out, as no law describes it together with the finer levels" for what in left_out),
        *(
            f"{rival.what} the limit differs by {difference:+.2g}, more than by chance: the error includes this"
            for rival, difference in differing
            if difference and not rival.from_theory
        ),
        *([too_far] if far > _WORTH_A_NOTE and group.n_realisations > 1 else []),
    ]


def _by_law(index: int, group: Group, found: Sequence[ChoiceOfLaws], weights: Sequence[Reals]) -> list[str]:
    """Return a line with the limit by each law of eps_f, where there are several."""
    if len(found) == 1:
        return []
    limits = []
    for choice, weight in zip(found, weights, strict=True):
        mean, variance = _moments(weight / max(weight.sum(), 1e-300), [choice.fits[index]])
        limits.append(
            f"{with_error(mean, float(np.sqrt(variance)))} by {_NAMED[choice.laws['eps_f'].name]} ({weight.sum():.0%})"
        )
    return [f"{group.variable}_tfc is {' and '.join(limits)}"]


_NAMED = {POWER: "a power of eps_f", UNSEEN_SLOPE: "the law of the unseen slope"}


def _curve(index: int, group: Group, means: Means, found: Sequence[ChoiceOfLaws], weights: Sequence[Reals]) -> GroupFit:
    """Return levels (limit, step) and the fit there, other limits at the reference; nan where a limit is not varied."""
    eps, value = np.full((2, len(LIMITS), STEPS), np.nan)
    for name, levels in group.levels.items():
        row = LIMITS.index(name)
        eps[row] = np.geomspace(1.1 * levels.max(), levels.min() / 1.25, STEPS)
        value[row] = sum(
            each @ along(choice, index, means, name, eps[row]) for choice, each in zip(found, weights, strict=True)
        )
    return {"curve_eps": eps, "curve": value}


def _parameters(group: Group, fit: Linear, variances: bool = False) -> Reals:
    """Return the parameters of fits as a table, or their variances at known parameters of the laws.

    Parameters of limits that are not varied are nan.
    """
    coefficients = np.diagonal(fit.covariance, axis1=1, axis2=2) if variances else fit.coefficients
    power = 2 if variances else 1
    table = np.full((len(fit.misfit), N_PARAMETERS), np.nan)
    found = named(table)
    found["{variable}_tfc"][:] = coefficients[:, 0]
    for row, name in enumerate(group.levels):
        limit = LIMITS.index(name)
        found["correction"][:, limit] = coefficients[:, 1 + row]
        found["alpha"][:, limit] = 0.0 if variances else fit.exponents[:, row]
        scale = group.reference[name] ** -fit.exponents[:, row]
        found["C"][:, limit] = coefficients[:, 1 + row] * scale**power
    pairs = [number for number, pair in enumerate(PAIRS) if set(pair) <= set(group.levels)]
    for row, number in enumerate(pairs, start=1 + len(group.levels)):
        found["interaction"][:, number] = coefficients[:, row]
    return table


def _possible(
    group: Group, moments: tuple[float, float], weight: Reals, value: Reals, deviation: Reals
) -> tuple[float, float] | None:
    """Return mean and standard deviation, the `moments` of a limit unless the variable cannot be this mean.

    The scatter of surfaces may move a limit beyond an end of the possible values. If it does so by a small part of the
    results only, the normal distributions of the values (node) are cut at this end. None if the possible values are
    unlikely.
    """
    if group.possible[0] <= moments[0] <= group.possible[1]:
        return moments
    ends = np.array(group.possible)[:, np.newaxis]
    low, high = (ends - value) / np.maximum(deviation, np.spacing(abs(value)))
    inside = weight * (scipy.special.ndtr(high) - scipy.special.ndtr(low))
    likely = float(inside.sum())
    if likely < _TAIL or moments[1] > _BY_CHANCE * np.nanmean(abs(group.values)):
        return None
    of_low, of_high = (np.exp(-(each**2) / 2.0) / np.sqrt(2.0 * np.pi) * weight for each in (low, high))
    mean = (inside @ value + deviation @ (of_low - of_high)) / likely
    slopes = [np.where(np.isfinite(end), end, 0.0) * of_end for end, of_end in ((low, of_low), (high, of_high))]
    squares = inside * (value - mean) ** 2 + 2.0 * (value - mean) * deviation * (of_low - of_high)
    squares += deviation**2 * (inside + slopes[0] - slopes[1])
    return float(mean), float(np.sqrt(squares.sum() / likely))


def _interval(group: Group, weight: Reals, value: Reals, deviation: Reals) -> tuple[float, float]:
    """Return the ends of the 90 % interval of a mixture of values (node) with Student's distribution around each.

    The interval is cut to the possible values of the variable, and includes an end of these that it would pass.
    """
    if group.n_realisations < 2:
        return np.nan, np.nan
    freedom = group.n_realisations - 1
    counts = weight > 1e-12
    weight, value, deviation = weight[counts] / weight[counts].sum(), value[counts], deviation[counts]

    def beyond(end: float, part: float) -> float:
        return float(weight @ scipy.special.stdtr(freedom, (end - value) / deviation)) - part

    reach = abs(scipy.special.stdtrit(freedom, _TAIL / 100)) * deviation + 4.0 * np.spacing(abs(value))
    furthest = float((value - reach).min()), float((value + reach).max())
    width = furthest[1] - furthest[0]
    least, most = group.possible
    below, up_to = (beyond(end, 0.0) if np.isfinite(end) else float(end > 0.0) for end in (least, most))
    tails = min(_TAIL, below + _TAIL * (up_to - below)), max(1.0 - _TAIL, up_to - _TAIL * (up_to - below))
    low, high = (scipy.optimize.brentq(beyond, *furthest, args=(tail,), xtol=1e-12 * width) for tail in tails)
    return max(low, least), min(high, most)


def _misfit(
    group: Group, means: Means, found: Sequence[ChoiceOfLaws], weights: Sequence[Reals], index: int
) -> tuple[float, float]:
    """Return the rms residual of a group's means, and chi^2 of the likeliest fit, nan of a single realisation."""
    best, node = max(
        ((choice, int(each.argmax())) for choice, each in zip(found, weights, strict=True)),
        key=lambda pair: pair[0].log_weight[pair[1]],
    )
    fit = best.fits[index]
    covariance = np.linalg.inv(means.whitener.T @ means.whitener)
    residual = covariance @ fit.misfit_gradient[node] / 2.0
    chi2 = float(fit.misfit[node]) if group.n_realisations > 1 else np.nan
    return float(np.sqrt(np.mean(residual**2))), chi2


def _reasons(group: Group, unidentified: Mapping[str, str]) -> Iterator[str]:
    """Yield why the data of a group do not identify exponents: its levels and realisations."""
    for name, why in unidentified.items():
        has = f"shared with other groups; {name} is not varied in this one"
        if name in group.levels:
            has = f"levels {fractions(group.levels[name])}, {counted(group.n_realisations, 'realisation')}"
        yield f"exponent of {name} {why} ({has})"


def _refused(group: Group, reason: str) -> GroupFit:
    message = "\n".join([reason, *group.notes])
    return {"fit_status": "refused", "message": message, "freedom": 0, "law": [""] * len(LIMITS)}
