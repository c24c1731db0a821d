"""The error of a TFC limit: why a fit of (4.3) is refused, its extrapolation error, its rivals, and the error budget.

A fit is refused if the data do not identify one of its parameters, and warned of if they press an exponent against an
end of its range. Rivals are fits of fewer levels, or without the exponents that the user asserts. If a rival disagrees
with a fit, the laws of the fit do not hold, and its error includes the disagreement.

A law that fits the levels need not hold beyond them. So the error of a limit includes an extrapolation error, a part of
the distance D from the finest level to the limit. For a power it is 0.3 D: exponents drift, because a correction is a
sum of several powers. The law of the unseen slope has no exponent that could drift. Its extrapolation error falls with
D^2 where D is short, and never exceeds 0.02 of the limit v, if the finest level has enough waves and the load is not
too light. If D > |v| for a variable of one sign, the extrapolation error is D. The formula of the whole error is at the
head of `extrapolation.py`.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gfmd_numba.analysis.exponent_posterior import (
    ChoiceOfLaws,
    Laws,
    Means,
    law_value,
    linear,
    prior_deviations,
)
from gfmd_numba.analysis.fit_dataset import PAIRS, SOURCES, in_the_limit, named
from gfmd_numba.analysis.laws import BOUNDS, STEEPEST, UNSEEN_SLOPE, Given, choices
from gfmd_numba.analysis.selection import FEWEST_STRETCHES, LIMITS, Group, fractions, is_light
from gfmd_numba.arrays import Reals
from gfmd_numba.text.numbers import with_error
from gfmd_numba.theory.exponent_ranges import exponent_ranges

_PRESSED = 0.15  # of a range: the mean of an exponent that the data do not know lies in its middle
_AT_THE_END = 0.02  # of a range: the 90 % interval of an exponent that the data press begins closer to its end
_WORTH_A_CROSS_LEVEL = 0.2  # of the error: less hardly adds to it
_COUNTS = 0.05  # weight below which a choice of laws is not spoken of
# ends of the 90 % interval of a free exponent before there are data: beyond them, the data press it against a bound
_LOWEST, _HIGHEST = (float(BOUNDS[0] ** (1 - quantile) * BOUNDS[1] ** quantile) for quantile in (0.05, 0.95))
WIDEST = 8.0  # ratio of the ends of an exponent's 90 % interval beyond which it is not identified


def inseparable(group: Group) -> str:
    """Return why the group's cases cannot determine its coefficients at any exponent, or nothing."""
    if np.isnan(list(group.reference.values())).all():
        return "surfaces have grids and lengths of their own: no discretisation is varied, so there is no limit to fit"
    if not group.levels:
        return "no discretisation is varied over two or more good levels: add levels to the campaign"
    if not group.complete.any():
        return f"no realisation is good in all {group.n_cases} cases: run more, or repeat the failed ones"
    if (np.nan_to_num(group.values[group.complete]) == 0.0).all(axis=0).any():
        return "it is 0 in all realisations of a case: there is nothing to extrapolate"
    columns = [np.exp(0.7 * group.log_ratio(name)) for name in group.levels]
    if np.linalg.matrix_rank(np.column_stack([np.ones(group.n_cases), *columns])) <= len(columns):
        varied = ", ".join(group.levels)
        return f"{group.n_cases} cases cannot tell {varied} apart: add cases in which only one of them differs"
    return ""


def single_hills(group: Group) -> str:
    """Return why the contacts of a group tell nothing of many hills, as there are where eps_t is 0; or nothing."""
    if "eps_t" not in group.levels or not group.n_stretches < FEWEST_STRETCHES:
        return ""
    finest = fractions(group.levels["eps_t"].min(keepdims=True))
    return (
        f"the load is so light that only the highest hill of a period touches at eps_t = {finest}: contacts have "
        f"{group.n_stretches:.2g} stretches on average where they have most, fewer than {FEWEST_STRETCHES}, and follow "
        "no law of eps_t; take a finer eps_t, or a higher pressure"
    )


def impossible(group: Group, value: float, error: float, distance: Reals) -> str:
    """Return why a limit that the variable cannot have is refused; `distance` is that of each limit's finest level."""
    low, high = group.possible
    least = f"below {group.shown(low)}" if value < low else f"above {group.shown(high)}"
    widest = LIMITS[int(np.nanargmax(abs(distance)))]
    return (
        f"{group.variable}_tfc would be {with_error(value, error)}, and {group.variable} is never {least}: the laws of "
        f"the limits do not hold so far from these levels; take finer levels, above all of {widest}"
    )


def too_far(group: Group, value: float, distance: Reals) -> list[str]:
    """Return a note for each limit whose finest level is further from the limit than that is from 0."""
    if not np.isfinite(group.possible).any():
        return []
    return [
        f"the finest {name} is {abs(distance[column] / value):.0%} of {group.variable}_tfc away from the limit, where "
        f"its law need not hold: the error has the whole distance; take a finer {name}"
        for column, name in enumerate(LIMITS)
        if abs(distance[column]) > abs(value)
    ]


def shortage(groups: Sequence[Group], choices: Sequence[Laws]) -> str:
    """Return which free exponent has fewer than three levels in every group, or nothing."""
    free = {each.limit for laws in choices for law in laws.values() for each in law.parameters if each.is_free}
    for name in LIMITS:
        levels = max((np.unique(group.levels[name]) for group in groups if name in group.levels), key=len, default=None)
        if levels is not None and len(levels) < 3 and name in free:
            uncounted = "; 1 does not count, as two nodes do not resolve its shortest wave" if name == "eps_c" else ""
            lack = f"exponent of {name} needs three levels, has two ({fractions(levels)}{uncounted})"
            return f"{lack}\n{advice([name], groups[0].variable, groups[0].dimension)}"
    return ""


def unidentified_exponents(choices: Sequence[ChoiceOfLaws], weights: Sequence[Reals]) -> dict[str, str]:
    """Return the free exponents that the data do not identify, and why."""
    unidentified = {}
    for limit in LIMITS:
        for choice, weight in zip(choices, weights, strict=True):
            for index, parameter in enumerate(choice.parameters):
                if parameter.limit != limit or not parameter.is_free or weight.sum() < _COUNTS:
                    continue
                low, high = _ends(choice.nodes[:, index], weight)
                found = f"with 90 % interval {low:.3g} to {high:.3g}"
                if low < 1.1 * _LOWEST and high > 0.9 * _HIGHEST:
                    unidentified[limit] = "has no influence on the fit"
                elif low < _LOWEST or high > _HIGHEST:
                    unidentified[limit] = f"{found} touches the bounds {BOUNDS[0]:g} and {BOUNDS[1]:g}"
                elif high > WIDEST * low:
                    unidentified[limit] = f"{found} is uncertain by more than a factor {WIDEST:g}"
    return unidentified


def _ends(values: Reals, weight: Reals) -> tuple[float, float]:
    """Return the ends of the 90 % interval of weighed values."""
    order = np.argsort(values)
    below = np.cumsum(weight[order]) / weight.sum()
    # in the middle of each value's weight, so that few values do not end at the outermost
    low, high = np.interp([0.05, 0.95], below - weight[order] / weight.sum() / 2.0, values[order])
    return float(low), float(high)


def pressed(choices: Sequence[ChoiceOfLaws], weights: Sequence[Reals]) -> dict[str, str]:
    """Return the limits whose exponent the data press against the low end of its range, and a line for each.

    If another law is at least as likely, the error includes the scatter between the two laws.
    """
    lines = {}
    for choice, weight in zip(choices, weights, strict=True):
        for index, parameter in enumerate(choice.parameters):
            if parameter.logarithmic or parameter.low == parameter.high or weight.sum() <= 0.5:
                continue
            low, high = parameter.low, parameter.high
            values = choice.nodes[:, index]
            mean, least = weight @ values / weight.sum(), _ends(values, weight)[0]
            # a small exponent that the data know well is not pressed
            if mean < low + _PRESSED * (high - low) and least < low + _AT_THE_END * (high - low):
                lines[parameter.limit] = (
                    f"exponent of {parameter.limit} lies at the low end of its range, {low:g}, and the true limit may "
                    "be further away: the error has the whole distance from the finest level; allow smaller exponents"
                )
    return lines


def logarithmic(group: Group, choices: Sequence[ChoiceOfLaws]) -> list[str]:
    """Return a line for a power of eps_f where octaves add nearly as much slope each: exponents go as 2 - 2 H."""
    steep = "eps_f" in group.levels and group.parameters.get("hurst", 0.0) > STEEPEST
    if not steep or choices[0].laws["eps_f"].scales_limit:  # there is one law alone near H = 1
        return []
    return [
        f"near H = 1 {group.variable} may go as 1 / log(1 / eps_f): a power of eps_f may fit, but its limit is then "
        f"not that of {group.variable}"
    ]


def additivity(group: Group, error: Reals) -> list[str]:
    """Return a line where no cross level tells by how much corrections together differ from their sum, if it counts."""
    found = named(error)
    unknown = found["interaction"]
    off = {name: abs(group.log_ratio(name)) > 1e-9 for name in group.levels}
    pairs = [(number, pair) for number, pair in enumerate(PAIRS) if set(pair) <= set(off)]
    open_ones = [number for number, (first, second) in pairs if not (off[first] & off[second]).any()]
    open_part = float(np.hypot.reduce(unknown[open_ones])) if open_ones else 0.0
    if open_part <= _WORTH_A_CROSS_LEVEL * found["{variable}_tfc"]:
        return []
    which = "; ".join(" and ".join(PAIRS[number]) for number in open_ones)
    difference = group.shown(open_part)
    return [
        f"no cross level tells whether the corrections of {which} add up, so the error allows for a difference of "
        f"{difference}: add `cross` to the limits, cases in which two eps differ from the reference"
    ]


def advice(names: Collection[str], variable: str, dimension: int) -> str:
    """Return how to fix exponents where the user stands: at the command line, in the campaign file, in Python."""
    ranges = {name: exponent_ranges(variable, dimension)[name] for name in names}
    options = " ".join(f"--fixed {name}={low:g}:{high:g}" for name, (low, high) in ranges.items())
    block = ", ".join(f"{name}: [{low:g}, {high:g}]" for name, (low, high) in ranges.items())
    return (
        f"give the ranges that exponents of {variable} lie in: `gfmd fit {options}`; `fit: {{fixed: {{{block}}}}}` in "
        f"the campaign file; fixed={ranges} in Python; or add levels or realisations"
    )


_FEWEST = 4  # levels of a limit, of which one may be left out
_SIGNIFICANT = 2.0  # standard deviations by which a rival may differ by chance


@dataclass(frozen=True)
class Rival:
    """Another fit of the same groups, and what it does differently, in words.

    `asserted` is the limit whose exponent the fit asserts and the rival does not, "" where the rival has fewer levels.
    A rival `from_theory` is better founded than the fit: then the error of the fit is at least that of the rival.
    """

    what: str
    groups: list[Group]
    given: Given
    asserted: str = ""
    from_theory: bool = False

    def error(self, value: float, variance: float, rival: float, rival_variance: float) -> float:
        """Return the error of a fitted value that is due to this rival."""
        if not self.from_theory:
            return abs(disagreement(value, variance, rival, rival_variance))
        return float(np.sqrt((rival - value) ** 2 + max(0.0, rival_variance - variance)))


def rivals(groups: Sequence[Group], given: Given) -> Iterator[Rival]:
    """Yield the fits without the coarsest or finest level of a limit, by theory, and without asserted exponents."""
    hursts = [group.parameters.get("hurst", np.nan) for group in groups]
    expected = exponent_ranges(groups[0].variable, groups[0].dimension, max(hursts))
    for limit in LIMITS:
        levels = _levels(groups, limit)
        if len(levels) >= _FEWEST:
            for name, level in (("coarsest", levels[-1]), ("finest", levels[0])):
                if (fewer := _without(groups, limit, level)) is not None:
                    yield Rival(f"without the {name} level of {limit}, {fractions(np.array([level]))}", fewer, given)
        low, high = given.get(limit, (0.0, 1.0))
        asserted = limit if low == high else ""
        others = {name: each for name, each in given.items() if name != limit}
        by_theory = {law.name for laws in choices([limit], groups, others) for law in laws.values()}
        by_fit = {law.name for laws in choices([limit], groups, given) for law in laws.values()}
        if by_theory != by_fit:
            yield Rival("by the law of the unseen slope alone", list(groups), others, asserted, from_theory=True)
        elif asserted and len(levels) > 2:
            what = "with an exponent of {} between {:g} and {:g}, as the levels tell it,".format(
                limit, *expected[limit]
            )
            yield Rival(what, list(groups), {**given, limit: expected[limit]}, asserted)


def without_coarsest(groups: Sequence[Group]) -> tuple[str, list[Group]] | None:
    """Return the groups without the coarsest level of a limit, and what it was; None where none can be spared."""
    for limit in ("eps_f", "eps_t", "eps_c"):
        levels = _levels(groups, limit)
        if len(levels) >= _FEWEST and (fewer := _without(groups, limit, levels[-1])) is not None:
            return f"{limit} = {fractions(levels[-1:])}", fewer
    return None


def disagreement(value: float, variance: float, rival: float, rival_variance: float) -> float:
    """Return by how much more a rival differs than its own scatter explains."""
    by_chance = _SIGNIFICANT**2 * max(rival_variance - variance, 1e-3 * variance)
    return float(np.copysign(np.sqrt(max(0.0, (rival - value) ** 2 - by_chance)), rival - value))


def _levels(groups: Sequence[Group], limit: str) -> Reals:
    """Return the levels of a limit that all groups have, from fine to coarse."""
    levels = [set(group.levels[limit].tolist()) for group in groups if limit in group.levels]
    return np.sort(list(set.intersection(*levels))) if levels else np.empty(0)


def _without(groups: Sequence[Group], limit: str, level: float) -> list[Group] | None:
    """Return the groups without a level of a limit; None if the rest cannot tell the correction of each limit."""
    fewer = [group.without(limit, level) if limit in group.levels else group for group in groups]
    same = all(each.levels.keys() == group.levels.keys() for each, group in zip(fewer, groups, strict=True))
    return fewer if same and not any(inseparable(each) for each in fewer) else None


# Standard error over the distance that a law bridges, and for the law of the unseen slope the most over the limit.
# Measured on lines (H = 0.5, 0.8, 1; p* = 0.007, 0.05, 0.3; half-space and a = 0.1) by fits whose levels end at 1/eps_f
# = 128 to 4096, against their limits: fits that bridge less than 4 % are off by a tenth of the distance
_OF_THE_DISTANCE = 0.3
_OF_THE_LIMIT = 0.02
_OF_MEASURED = 0.2  # of this where k_c and m were measured on contacts of the same kind
# Coarsest finest eps_f for which that is true, by the dimension of the surfaces. From 1/eps_f = 16 and 32 of lines and
# 16 of maps (H = 0.3 to 0.9) the unseen slope is off by a tenth to a third of the distance, as powers are. So are fits
# from 1/eps_f = 16 to 256 of lines (H = 0.8, p* = 0.003 and 0.007: limits 4 to 9 % too small, 25 % away)
_COARSEST = {1: 1 / 512, 2: 1 / 32}
# Standard error over the limit, for a layer as high as the longest wave of the power law: a thin layer is stiffer for
# long waves than the half-space that it becomes where eps_t goes to 0, by no law of eps_t. Measured on the same lines
# as the difference of slabs from half-spaces (a = 0.02 to 0.3, 1/eps_t = 2 to 8, 1/eps_f = 1024)
_OF_A_LAYER, _MOST_OF_A_LAYER = 0.01, 0.3
# Correction in eps_t over kappa where eps_t is not varied, times n^2 (eps_f / e)^0.5, where a period has n stretches or
# patches of contact on average, and e is by the dimension of the surfaces. Measured on half-spaces as kappa at 1/eps_t
# = 1, 2 and 4 over that at 16 (maps: 8). On profiles (H = 0.3 to 0.9, p* = 0.002 to 0.2) at 1/eps_f = 64 it is 0.57
# with 1.6 stretches, 0.21 with 2.6, 0.09 with 4.0, 0.03 with 6.9 and 0.01 with 12; at 16, 0.42 with 1.4, 0.19 with 2.0,
# 0.10 with 2.5 and 0.02 with 4.4. On maps (H = 0.8, p* = 0.005 and 0.02) at 8 it is 0.21 with 2.6 patches, 0.07 with
# 4.1 and 0.03 with 6.8. It wanes with a power of the correction in eps_f, by the dimension: the least that we measured
_OF_STRETCHES, _POWER_OF_EPS_F, _AT_EPS_F = 1.4, 0.5, {1: 1 / 64, 2: 1 / 8}
_LEAST_WANING = {1: 1.3, 2: 3.0}
_WORTH_FINER_PERIODS = 0.02  # of the limit: corrections that are smaller hardly add to an error


def distances(index: int, means: Means, choice: ChoiceOfLaws) -> Reals:
    """Return how far the fit at each limit's finest level is from its limit (node, limit), nan for limits not varied.

    The other discretisations are at the reference or in their limits, whichever is further.
    """
    found = np.full((len(choice.nodes), len(LIMITS)), np.nan)
    coefficients = choice.fits[index].coefficients
    for row, limit in enumerate(means.levels, start=1):
        at = law_value(choice.laws, limit, np.array([means.finest(limit), means.reference[limit]]), choice.nodes)
        ratio = at[:, :1] / at[:, 1:]
        alone = coefficients[:, row] * ratio[:, 0]
        together = alone + means.of_pairs(limit, ratio, coefficients)[:, 0]
        found[:, LIMITS.index(limit)] = np.where(abs(together) > abs(alone), together, alone)
    return found


def extrapolation_error(distance: Reals, limit: Reals, scales_limit: bool) -> Reals:
    """Return the standard error (...) of limits by the distances (...) that laws of either kind bridge."""
    found: Reals = _OF_THE_DISTANCE * abs(distance)
    if not scales_limit:
        return found
    most = _OF_THE_LIMIT * abs(limit)
    found = found * abs(distance) / (abs(distance) + most)
    return found * most / (most + found)


def _was_measured(finest: Reals | float, dimension: int, load: Reals | float) -> Any:
    """Whether eps_f and the reduced pressure are ones for which the error of the law of the unseen slope is known."""
    return (np.asarray(finest) <= _COARSEST[dimension]) & ~is_light(load)


def extrapolation_errors(
    index: int, group: Group, means: Means, choice: ChoiceOfLaws, at_an_end: Collection[str]
) -> Reals:
    """Return the standard error of each limit by the distance that its law bridges (node, limit), 0 if not varied.

    The error is the whole distance if the data press an exponent against an end of its range, or if a limit of a
    variable of one sign is nearer to 0 than the distance. Layers add an error to that of eps_t (`layer_error`), and
    short periods one to that of eps_f (`error_of_few_stretches`).
    """
    far = abs(np.nan_to_num(distances(index, means, choice)))
    limit, found = choice.fits[index].coefficients[:, 0], far.copy()
    for column, name in enumerate(LIMITS):
        if name in choice.laws and name not in at_an_end:
            scales_limit = choice.laws[name].scales_limit and not group.has_thin_layers
            scales_limit = scales_limit and bool(_was_measured(means.finest(name), group.dimension, group.load))
            factor = _OF_MEASURED if scales_limit and group.has_measured_slope_law else 1.0
            found[:, column] = factor * extrapolation_error(found[:, column], limit, scales_limit)
    if np.isfinite(group.possible).any():
        size = limit if group.possible[0] == 0.0 else -limit
        found = np.where(far > size[:, np.newaxis], far, found)
    column = LIMITS.index("eps_t")
    found[:, column] = np.hypot(found[:, column], layer_error(group, means) * limit)
    column = LIMITS.index("eps_f")
    found[:, column] = np.hypot(found[:, column], error_of_few_stretches(index, group, choice))
    return found


def error_of_few_stretches(index: int, group: Group, choice: ChoiceOfLaws) -> Reals:
    """Return the standard error of each limit (node) by a correction in eps_t that no levels of eps_t tell.

    The correction wanes with eps_f as an interaction of both does, and the fit takes it for one of eps_f. The error is
    0 where a power stands for the law of the unseen slope, whose constants were measured at long periods.
    """
    law, fit = choice.laws.get("eps_f"), choice.fits[index]  # each case counts by its influence on the limit
    if "eps_t" in group.levels or law is None or not law.scales_limit or not (group.stretches > 0.0).any():
        return np.zeros(len(choice.nodes))
    fewest = np.nanargmin(group.stretches)
    at = law_value(choice.laws, "eps_f", group.levels["eps_f"], choice.nodes)
    correction = _of_short_periods(group) * (at / at[:, [fewest]]) ** _LEAST_WANING[group.dimension]
    return np.asarray(abs((fit.influence * correction * (1.0 + at)).sum(axis=1) * fit.coefficients[:, 0]))


def _of_short_periods(group: Group) -> float:
    """Return the correction in eps_t over the value where a period has fewest stretches; 0 if levels of eps_t tell."""
    if "eps_t" in group.levels:
        return 0.0
    fewest = np.nanargmin(group.stretches)
    fine = (group.levels["eps_f"][fewest] / _AT_EPS_F[group.dimension]) ** _POWER_OF_EPS_F
    return _OF_STRETCHES / max(float(group.stretches[fewest] ** 2 * fine), _OF_STRETCHES)


def notes_of_one_period(group: Group, choices: Sequence[ChoiceOfLaws]) -> list[str]:
    """Return notes where the law of the unseen slope is less sure, because eps_t is not varied."""
    law = choices[-1].laws.get("eps_f")
    if law is None or not law.scales_limit:
        return []
    notes = []
    if group.has_thin_layers:
        notes.append(
            "the thinnest layer is lower than the longest waves, so that the law of the unseen slope is only known "
            "from these levels: take finer eps_f, or a finer eps_t"
        )
    stretches = {1: "stretches", 2: "patches"}[group.dimension]
    if (group.stretches > 0.0).any() and (correction := _of_short_periods(group)) > _WORTH_FINER_PERIODS:
        notes.append(
            f"a period has {np.nanmin(group.stretches):.2g} {stretches} of contact on average where it has fewest, and "
            f"eps_t is not varied: {group.variable} may be {correction:.0%} too large there, which the error counts; "
            "take a finer eps_t, or add eps_t to the limits"
        )
    return notes


def layer_error(group: Group, means: Means) -> float:
    """Return the relative standard error of the limit in eps_t by layers that become thick in it; 0 without any."""
    if "eps_t" not in means.levels:
        return 0.0
    return min(_OF_A_LAYER * means.finest("eps_t") / group.thinnest_layer, _MOST_OF_A_LAYER)


def note_of_thin_layers(group: Group, means: Means) -> list[str]:
    """Return a note if the thinnest layer is lower than the longest waves at the finest eps_t."""
    error = layer_error(group, means)
    if error <= _OF_A_LAYER:
        return []
    return [
        f"the thinnest layer is lower than the longest waves at the finest eps_t, but thick in the limit: the error "
        f"counts {error:.2g} of {group.variable}_tfc for that; take a finer eps_t, or leave eps_t out of the limits "
        "if the layer is to stay thin"
    ]


def expected_extrapolation_errors(fitted: xr.Dataset, limit: str, finer: float, dimension: int) -> Reals:
    """Return the standard errors (group) of a fit by one distance where the finest level is a factor finer."""
    at, value = fitted.sel(limit=limit), in_the_limit(fitted)[0].values
    distance, finest = at["extrapolated"].values, at["finest_eps"].values
    load = fitted["reduced_pressure"].values if "reduced_pressure" in fitted.coords else np.nan

    def at_factor(factor: float) -> Reals:
        scales_limit = (at["law"] == UNSEEN_SLOPE).values & _was_measured(finest / factor, dimension, load)
        bridged = distance * factor ** -at["alpha"].values
        return np.where(
            scales_limit, extrapolation_error(bridged, value, True), extrapolation_error(bridged, value, False)
        )

    now, then = at_factor(1.0), at_factor(finer)
    less: Reals = np.divide(then, now, where=now > 0, out=np.zeros(len(now)))
    return np.asarray(less * np.nan_to_num(at["extrapolation_error"].values))


def error_budget(
    index: int,
    means: Means,
    choices: Sequence[ChoiceOfLaws],
    weights: Sequence[Reals],
    beyond_the_fit: tuple[Reals, float],
    residuals: Reals,
) -> Reals:
    """Return what each of `SOURCES` adds to the error of a group's TFC limit (source), nan for limits not varied.

    All sources but the residual add up in quadrature to the whole error, the formula at the head of `extrapolation.py`:

    - eps_c, eps_f, eps_t: the law of the limit and its parameters are not known;
    - interaction: the prior of corrections is not exact;
    - sampling: the scatter of the surfaces;
    - extrapolation and rivals, both given `beyond_the_fit`: the standard errors of the limits (limit) by the distances
      that their laws bridge, and the error by fits that disagree;
    - residual: the most that the errors of the cases' means, `residuals` (case), also by divisions of time, add up to.
    """
    all_weights = np.concatenate(weights)
    kappa = [choice.fits[index].coefficients[:, 0] for choice in choices]
    spread = _variance(all_weights, np.concatenate(kappa))
    sampling = variance = 0.0
    effects = dict.fromkeys(means.levels, 0.0)
    for choice, weight, value in zip(choices, weights, kappa, strict=True):
        prior_std = prior_deviations(means, choice.laws)  # as if exact: coefficients with a prior are 0
        exact = linear(means, choice.laws, choice.nodes, np.where(np.isfinite(prior_std), 0.0, np.inf))
        variance += float(weight @ choice.fits[index].covariance[:, 0, 0])
        sampling += float(weight @ exact.covariance[:, 0, 0])
        for limit in effects:
            effects[limit] += _main_effect(limit, choice, weight, value)
    if len(choices) > 1:  # which differ in the law of eps_f
        each = np.array([weight.sum() for weight in weights])
        inside = [weight @ value for weight, value in zip(weights, kappa, strict=True)]
        effects["eps_f"] += _variance(each, np.divide(inside, each, out=np.zeros(len(each)), where=each > 0))
    whole = sum(effects.values())
    scale = spread / whole if whole > 0 else 0.0
    budget = np.full(len(SOURCES), np.nan)
    for limit, effect in effects.items():
        budget[SOURCES.index(limit)] = np.sqrt(scale * effect)
    sampling = min(sampling, variance)
    budget[SOURCES.index("interaction")] = np.sqrt(variance - sampling)
    budget[SOURCES.index("sampling")] = np.sqrt(sampling)
    extrapolation, budget[SOURCES.index("rivals")] = beyond_the_fit
    budget[SOURCES.index("extrapolation")] = np.sqrt((extrapolation**2).sum())
    if not np.isnan(residuals).any():
        budget[SOURCES.index("residual")] = abs(_influence(index, choices, weights)) @ abs(residuals)
    return budget


def _variance(weight: Reals, value: Reals) -> float:
    return float(weight @ (value - weight @ value) ** 2)


def _main_effect(limit: str, choice: ChoiceOfLaws, weight: Reals, value: Reals) -> float:
    """Return the variance of the mean of the TFC limit at given parameters of a limit's law."""
    mine = [index for index, parameter in enumerate(choice.parameters) if parameter.limit == limit]
    _, same = np.unique(choice.nodes[:, mine], axis=0, return_inverse=True)
    each = np.bincount(same.ravel(), weight)
    mean = np.divide(np.bincount(same.ravel(), weight * value), each, out=np.zeros(len(each)), where=each > 0)
    total = each.sum()
    return float(each @ (mean - (each @ mean) / total) ** 2) if total > 0 else 0.0


def _influence(index: int, choices: Sequence[ChoiceOfLaws], weights: Sequence[Reals]) -> Reals:
    """Return the derivative of the TFC limit to each mean (case): of the fits, and of the weights of the nodes."""
    weight = np.concatenate(weights)
    value, influence, misfit_gradient = (
        np.concatenate([getattr(choice.fits[index], name) for choice in choices])
        for name in ("coefficients", "influence", "misfit_gradient")
    )
    kappa = value[:, 0]
    return np.asarray(weight @ influence - 0.5 * (weight * (kappa - weight @ kappa)) @ misfit_gradient)
