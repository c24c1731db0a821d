"""From the results of one round to the next: whether the target is reached, and what to do if not.

A run that was killed and resumes must decide as it would have done, so nothing that is measured in seconds enters.
Instead work has a price, which follows from transforms and grids.

If the extrapolation of a group leaves more than 0.7 of the target open, finer levels come first. If it leaves less,
the next round has more surfaces where these alone are expected to reach the target and finer levels would add more
than half of their price; otherwise finer levels (`_decided`).

Decisions follow from the predicted error, hence from
the covariance of all results. The rounds are few and each is much larger than the one before, so that stopping hardly
biases a mean (Collier, Haji-Ali, Nobile, von Schwerin & Tempone 2015 lower their tolerance in the same way).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, pairwise
from math import hypot, inf, nan, sqrt
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gfmd_numba.analysis import UnusableDataError
from gfmd_numba.analysis.allocation import Pilot, Prediction
from gfmd_numba.analysis.fit_dataset import UNKNOWN, in_the_limit
from gfmd_numba.analysis.limit_errors import expected_extrapolation_errors
from gfmd_numba.analysis.selection import FEWEST_STRETCHES, LIMITS, groups
from gfmd_numba.arrays import Reals
from gfmd_numba.campaign.cost import price_of_transform
from gfmd_numba.campaign.limits import MOST, STEP, Level, finer_levels, first_realisations, nodes_of
from gfmd_numba.campaign.rounds import Round, Rounds, TargetError
from gfmd_numba.theory.exponent_ranges import exponent_ranges

_GROWTH = 4.0  # of the price at most, from one round to the next: few looks, and none far off for a poor pilot
_LEAST_GROWTH = 1.25  # of the price: less is not worth a look
_HALVINGS = 4  # of a bracket of the error that is 1.3 wide: its factor is then known to 2 %
_LOOSER = 2.0  # than the target: an error that a round has to come near, for a target that cannot be predicted yet

Counts = NDArray[np.intp]


@dataclass(frozen=True)
class _Group:
    """A group of equal physics: where its cases stand, its parameters, its problems, and what its results say."""

    where: Counts
    parameters: Mapping[str, float]
    problems: tuple[str, ...]
    pilot: Pilot


@dataclass(frozen=True)
class Known:
    """What is known of a variable after a round: results, their fit, and the exponents that were known before."""

    results: xr.Dataset
    fitted: xr.Dataset
    variable: str
    fixed: Mapping[str, Any]

    @cached_property
    def held(self) -> Counts:
        """Realisations (case) so far."""
        return self.results["realisations"].values.astype(np.intp)

    @cached_property
    def price(self) -> Reals:
        """Price of a realisation of each case (case): its mean number of transforms times the price of one."""
        nodes = self.results["nx"].values.astype(float) ** self.results["dimension"].values
        transforms = self.results["n_transforms"].where(self.results["status"] == 0).mean("realisation").values
        known = np.isfinite(transforms)
        if not known.any():
            raise UnusableDataError("you gave no good realisation; gfmd allows some of every case")
        return np.asarray(np.where(known, transforms, np.mean(transforms[known])).clip(1) * price_of_transform(nodes))

    @cached_property
    def groups(self) -> list[_Group]:
        """The groups; those of the same problems share their results. Raises UnusableDataError if these do not tell."""
        found: dict[tuple[str, ...], Pilot] = {}
        listed = []
        for parameters, cases in groups(self.results.assign_coords(case=np.arange(self.results.sizes["case"]))):
            problems = tuple(cases["case_id"].values.tolist())
            if problems not in found:
                found[problems] = Pilot.of(cases, self.variable, self.fixed)
            listed.append(_Group(cases["case"].values, parameters, problems, found[problems]))
        return listed

    def whole_price(self, counts: Counts) -> float:
        """Return the price of some realisations (case); equal problems count once."""
        of_problem: dict[str, float] = {}
        for identity, each in zip(self.results["case_id"].values, (self.price * counts).tolist(), strict=True):
            of_problem[identity] = max(each, of_problem.get(identity, 0.0))
        return sum(of_problem.values())

    def predictions(self, counts: Counts) -> list[Prediction]:
        """Errors to expect of some realisations (case), of all groups at one step of a path after the other."""
        steps = zip(*(group.pilot.predictions(counts[group.where]) for group in self.groups), strict=True)
        return list(chain.from_iterable(steps))


@dataclass(frozen=True)
class Judgement:
    """Errors of the worst group after a round, relative to the limit.

    `error` is that of the fit (inf if it was refused), `sampling` the part of it that comes from the surfaces, `factor`
    allows for the uncertainty of that part, and `predicted` was to be expected.
    """

    error: float
    sampling: float
    factor: float
    predicted: float

    @property
    def sure_error(self) -> float:
        """Error that is not exceeded with 90 % probability."""
        return float(np.sqrt(self.error**2 + (self.factor**2 - 1.0) * self.sampling**2))

    @property
    def sure_factor(self) -> float:
        """What the sure error is over that of the fit."""
        return self.sure_error / self.error if 0.0 < self.error < inf else self.factor


def judge(known: Known) -> Judgement:
    """Return the errors of the worst group; raises UnusableDataError for results that do not tell."""
    expected = known.predictions(known.held)
    limit, error = in_the_limit(known.fitted)
    errors = (error / abs(limit)).fillna(inf).values
    sampling = (known.fitted["error_budget"].sel(source="sampling") / abs(limit)).fillna(0.0).values
    found = [
        Judgement(float(whole), float(part), each.factor, max(one.error for one in expected))
        for whole, part, each in zip(errors, sampling, expected, strict=True)
    ]
    return max(found, key=lambda each: each.sure_error)


def decide(known: Known, found: Judgement, target: float, most: float = inf, after_pilot: bool = True) -> Round | None:
    """Return the next round at the same levels, for a price of at most `most` in all; None if that allows no more.

    The error of a pilot is larger than predicted while several laws still fit; more surfaces cure that. A later round
    aims below the target by the factor by which the sure error is above the one predicted for the same realisations.
    Raises UnusableDataError if no number of realisations reaches the target.
    """
    spent = known.whole_price(known.held)
    limit = min(most, _GROWTH * spent)
    if most < _LEAST_GROWTH * spent:
        return None
    goal = target
    if not after_pilot and target < found.sure_error < inf:
        goal = target * min(1.0, found.predicted / found.sure_error)
    try:
        wanted, asked = _wanted(known, goal), goal
    except UnusableDataError:
        # it seems out of reach, but a few results tell only roughly how large the corrections are
        wanted, asked = _wanted(known, _LOOSER * goal), _LOOSER * goal
        if known.whole_price(wanted) < _LEAST_GROWTH * spent:
            _wanted(known, goal)  # which says why
    while known.whole_price(wanted) < _LEAST_GROWTH * spent:
        goal = asked = 0.9 * asked
        wanted = _wanted(known, asked)
    total = known.whole_price(wanted)
    target_price = total if asked == goal else None
    if total > limit:
        asked, wanted, total = _within(limit, known, asked)
    expected = max(each.error for each in known.predictions(wanted))
    return Round(
        realisations=tuple(wanted.tolist()),
        is_last=min(asked / goal, expected / target) <= 1.0 or limit == most,
        variable=known.variable,
        predicted_error=expected,
        price=total,
        target_price=target_price,
    )


def _wanted(known: Known, target: float) -> Counts:
    """Return the realisations (case) with which every group meets a target, none fewer than it has."""
    counts = known.held.copy()
    designs: dict[tuple[str, ...], Counts] = {}
    for group in known.groups:
        if group.problems not in designs:
            expected = group.pilot.predictions(known.held[group.where])
            promise = target * min(each.caution for each in expected)
            try:
                designs[group.problems] = group.pilot.cheapest_design(known.price[group.where], promise)
            except UnusableDataError:
                raise _out_of_reach(known, group, target) from None
        counts[group.where] = np.maximum(counts[group.where], designs[group.problems])
    return counts


def _within(limit: float, known: Known, target: float) -> tuple[float, Counts, float]:
    """Return the least error above a target that a limit on the price allows, its realisations (case), their price."""
    tight, loose, found = target, target, known.held
    total = inf
    while total > limit:
        tight, loose = loose, 1.3 * loose
        found = _wanted(known, loose)
        total = known.whole_price(found)
    for _ in range(_HALVINGS):
        middle = sqrt(tight * loose)
        trial = _wanted(known, middle)
        trial_price = known.whole_price(trial)
        if trial_price <= limit:
            loose, found, total = middle, trial, trial_price
        else:
            tight = middle
    return loose, found, total


def _out_of_reach(known: Known, group: _Group, target: float) -> UnusableDataError:
    """Return the error that says why the most realisations do not reach a target, and what helps."""
    varied = [name for name in group.parameters if len(set(known.results[name].values.tolist())) > 1]
    whom = ", ".join(f"{name} = {group.parameters[name]:g}" for name in varied) + ": " * bool(varied)
    least, further = (
        max(group.pilot.predictions(np.full(group.where.size, number)), key=lambda each: each.error)
        for number in (MOST, 100 * MOST)
    )
    if least.error <= target:
        return UnusableDataError(
            f"{whom}it would take more than {MOST} realisations of a level; gfmd allows a larger target, or levels "
            "further from the reference"
        )
    left = f"{whom}{MOST} realisations of every case would leave an error of {100 * least.error:.2g}%"
    if 2.0 * further.interactions**2 > least.error**2:
        return UnusableDataError(
            f"{left}, as no cross level tells whether corrections add up; gfmd allows a larger target, or a cross "
            "level for every pair of limits under `limits: {cross: ...}`"
        )
    if 3.0 * least.exponents**2 > least.error**2:
        cases = known.results.isel(case=group.where)
        hurst = float(cases["hurst"].values[0]) if "hurst" in cases.coords else nan
        usual = exponent_ranges(known.variable, int(cases["dimension"].values[0]), hurst)
        free = [name for name in LIMITS if name in cases["limit"].values and name not in known.fixed]
        ranges = "narrower ranges under `fit: {fixed: ...}`"
        if free:
            unknown = ", ".join(f"{name}: [{usual[name][0]:g}, {usual[name][1]:g}]" for name in free)
            lie = f"exponents of {known.variable} lie in our campaigns"
            ranges = f"the ranges in which {lie}, `fit: {{fixed: {{{unknown}}}}}`"
        shares = known.fitted["error_budget"].max("group")
        exponents = {name: float(shares.sel(source=name)) for name in LIMITS if shares.sel(source=name) > 0}
        widest = f" (above all that of {max(exponents, key=exponents.__getitem__)})" if exponents else ""
        return UnusableDataError(
            f"{left}, as the exponents are not known better than that; gfmd allows a larger target, finer levels, or "
            f"{ranges}{widest}"
        )
    return UnusableDataError(f"{left}; gfmd allows a larger target, or levels further from the reference")


REACHED = "reached"
_SHARE_OF_DOUBTS = 0.7  # of the target, beyond which laws leave so much open that surfaces alone do not mend it
_SHARE_OF_PRICE = 0.5  # of more surfaces, below which finer levels come first
_MISFIT = 1.5  # factor on the errors of the means, beyond which their laws may not be those of the levels
_FUTILE = 2  # rounds with finer levels, after which a law should describe the means
_CLOSER = 0.8  # times the relative error of _SOME rounds before: such a limit comes out of the errors
_GROWING = 1.5  # stretches of contact in a period, that finer eps_t make enough
_SOME = 2  # rounds after the pilot that do not tell a limit from 0, after which others hardly would
_MOST = 10  # rounds after the pilot: each may have four times the price of all before


def after(state: Rounds, fits: Sequence[Known], may_refine: bool = False) -> Rounds:
    """Return the rounds with what the last one has found for each target, and either one more round or `ended`.

    The target that is furthest from being reached decides. `may_refine` says whether the next round may have finer
    levels than the last.
    """
    now = state.now
    state = state.with_now(cpu_seconds=float(fits[0].results.attrs["cpu_seconds"]))
    standing, price = [], 0.0
    for known in fits:
        try:
            price = known.whole_price(known.held)
            standing.append(_standing(state, known, may_refine))
        except UnusableDataError as error:
            return _named(state.ending(f"not {REACHED}: {error}"), known.variable)
    errors = {each.known.variable: each.error for each in standing}
    state = state.with_now(errors=errors, price=price if now.price is None else now.price)
    missed = [each for each in standing if not each.error.reached]
    if not missed:
        return state.ending(REACHED)
    if len(state.rounds) > _MOST:
        return state.ending(f"not {REACHED}: {_MOST} rounds did not suffice")
    furthest = max(missed, key=lambda each: each.found.sure_error / each.target)
    return _named(_decided(state, furthest, price, may_refine), furthest.known.variable)


@dataclass(frozen=True)
class _Standing:
    """Where a variable stands after a round: its target, its errors, and what its laws leave open."""

    known: Known
    target: float
    found: Judgement
    law_errors: "list[_LawError]"
    error: TargetError


def _standing(state: Rounds, known: Known, may_refine: bool) -> _Standing:
    """Return where a variable stands after the last round; raises UnusableDataError for results that do not tell."""
    now, target = state.now, state.goal.targets[known.variable]
    found = judge(known)
    law_errors = _law_errors(known, max(1, len(now.levels)), target / found.sure_factor)
    described = all(each.size < inf for each in law_errors)
    expected = _was_to_reach(now, known.variable) or found.predicted <= target or may_refine
    reached = described and found.sure_error <= target and expected
    error = TargetError(error=found.error if found.error < inf else None, factor=found.sure_factor, reached=reached)
    return _Standing(known, target, found, law_errors, error)


def _was_to_reach(now: Round, variable: str) -> bool:
    """Return whether a round was planned to reach the target of a variable."""
    return now.is_last and now.variable == variable


def _named(state: Rounds, variable: str) -> Rounds:
    """Return the rounds with the name of the variable in `ended`, if there are several variables."""
    missed = f"not {REACHED}: "
    if len(state.goal.targets) == 1 or not state.ended.startswith(missed):
        return state
    return state.ending(state.ended.replace(missed, f"{missed}{variable}: ", 1))


def _decided(state: Rounds, furthest: _Standing, price: float, may_refine: bool) -> Rounds:
    """Return the rounds with one more, which brings a target nearer, or `ended`; `price` is that of all so far."""
    known, fitted, target = furthest.known, furthest.known.fitted, furthest.target
    law_errors, is_last = furthest.law_errors, _was_to_reach(state.now, known.variable)
    large = _SHARE_OF_DOUBTS * target
    contradiction = abs(fitted["contradiction"] / in_the_limit(fitted)[0]).max("group")
    if which := [f"{name}: {known.fixed[name]:g}" for name in LIMITS if contradiction.sel(limit=name) > large]:
        said = f"the levels contradict the fixed {' and '.join(which)}; gfmd allows the range that it lies in"
        return state.ending(f"not {REACHED}: {said}")
    if may_refine and (why := _indescribable(state.rounds, fitted, law_errors)):
        return state.ending(f"not {REACHED}: {why}")
    finer = _refined(state, furthest, large) if may_refine else None
    earlier = None if len(state.rounds) <= _SOME else state.rounds[-1 - _SOME].errors.get(known.variable)
    before = inf if earlier is None or earlier.error is None else earlier.error
    comes_closer = finer is not None and furthest.found.error <= _CLOSER * before
    if len(state.rounds) > _SOME and UNKNOWN < furthest.found.error < inf and not comes_closer:
        said = f"the limit of {known.variable} is 0 within two standard errors, so that no relative error makes sense"
        if UNKNOWN < (worst := max(law_errors, key=lambda each: each.size)).size < inf:
            said = f"the limit of {known.variable} is too far from the finest levels, above all that of {worst.limit}"
        return state.ending(f"not {REACHED}: {said}")
    if finer is not None:
        return finer
    if not may_refine and (why := _hopeless(fitted, law_errors, is_last, target)):
        return state.ending(f"not {REACHED}: {why}")
    of_laws = max(each.size for each in law_errors)
    worth = of_laws if of_laws < inf else large  # surfaces are worth no more than the laws
    aim = sqrt(target**2 - of_laws**2) if of_laws <= large else worth
    another = _with_another(state, furthest, aim, min(of_laws, target))
    unmet = [each if each.error > target else replace(each, size=0.0) for each in law_errors]
    finer = _refined(state, replace(furthest, law_errors=unmet), 0.0) if may_refine else None
    return another if finer is None or _is_cheaper(another, finer, price) else finer


def _refusal(fitted: xr.Dataset) -> str:
    """Return why a fit is refused; nothing if it is not."""
    refused = fitted["message"].values[fitted["fit_status"].values == "refused"]
    return "; ".join(str(refused[0]).splitlines()) if len(refused) else ""


def _indescribable(rounds: Sequence[Round], fitted: xr.Dataset, law_errors: "Sequence[_LawError]") -> str:
    """Return why even finer levels are not worth their price when no law describes the means; empty if they are."""
    latest = rounds[-1 - _FUTILE :]
    refined = (
        all(one.levels[group] != following.levels[group] for one, following in pairwise(latest))
        for group, each in enumerate(law_errors)
        if each.size == inf
    )
    stretches = fitted["n_stretches"].values
    if len(latest) <= _FUTILE or not any(refined) or ((stretches >= _GROWING) & (stretches < FEWEST_STRETCHES)).any():
        return ""
    if (stretches < FEWEST_STRETCHES).any():
        return _refusal(fitted)
    misfit = float(fitted["misfit"].max())
    missed = f" (misfit {misfit:.2g})" if misfit > _MISFIT else ""
    return (
        f"no law of the limits describes the means{missed}, although the levels became finer {_FUTILE} times; gfmd "
        "allows levels and ranges of exponents of your own"
    )


def _is_cheaper(surfaces: Rounds, levels: Rounds, spent: float) -> bool:
    """Return whether more surfaces are a better next round than finer levels, which tell more about the laws.

    Surfaces reach the target for the expected price, but finer levels may not reach it in one round.
    """
    if surfaces.ended or surfaces.now.target_price is None:  # more surfaces alone do not reach the target
        return False
    dear = (levels.now.price or 0.0) - spent > _SHARE_OF_PRICE * (surfaces.now.target_price - spent)
    return bool(levels.ended) or dear


@dataclass(frozen=True)
class _LawError:
    """What the laws of one group leave open: the relative error, inf if unknown, and the limit that adds most to it.

    `halved` is the error to expect with half the finest eps_f, and `error` the whole relative error of the group.
    """

    size: float
    limit: str
    halved: float
    error: float


def _law_errors(known: Known, n_groups: int, most: float) -> list[_LawError]:
    """Return what the laws of each group leave open however many surfaces there are; of a path, at its worst step.

    Of means that no law describes it is unknown, unless their distance from the laws and the error, which the fit has
    enlarged as far as they ask, are below `most` together. Many surfaces tell of misfits that do not matter.
    """
    fitted, dimension = known.fitted, int(known.results["dimension"].values[0])
    limit, error = in_the_limit(fitted)
    value = abs(limit)
    whole = (error / value).fillna(inf).values
    rivals = (fitted["error_budget"].sel(source="rivals") / value).fillna(0.0)
    by_limit = (fitted["extrapolation_error"] / value).fillna(0.0)
    halved = by_limit.copy()
    finer = expected_extrapolation_errors(fitted, "eps_f", 2.0, dimension)
    halved.loc[{"limit": "eps_f"}] = np.nan_to_num(finer / value.values)
    for each in (by_limit, halved):
        each.loc[{"limit": "eps_f"}] = np.hypot(each.sel(limit="eps_f"), rivals)
    missed = fitted["rms_residual"] * np.sqrt(fitted["n_cases"]) / value  # at least that of the worst level
    is_described = (fitted["misfit"] <= _MISFIT) | (np.hypot(whole, missed.fillna(inf)) <= most)
    is_described &= fitted["fit_status"] == "ok"
    size, of_half = (xr.where(is_described, np.sqrt((each**2).sum("limit")), inf) for each in (by_limit, halved))
    found = []
    for group in range(n_groups):
        worst = group + n_groups * int(size.values[group::n_groups].argmax())
        widest = str(by_limit["limit"].values[by_limit.values[worst].argmax()])
        if fitted["fit_status"].values[worst] == "refused" and fitted["n_stretches"].values[worst] < FEWEST_STRETCHES:
            widest = "eps_t"
        elif size[worst] == inf:
            widest = "eps_f"
        of_all = float(whole[group::n_groups].max())
        found.append(_LawError(float(size[worst]), widest, float(of_half[worst]), of_all))
    return found


def _hopeless(fitted: xr.Dataset, law_errors: Sequence[_LawError], is_last: bool, target: float) -> str:
    """Return why more surfaces do not reach a target at the present levels; empty if they may."""
    if (refusal := _refusal(fitted)) and (fitted["n_stretches"] < FEWEST_STRETCHES).any():
        return refusal
    if is_last and refusal:
        return f"the fit is refused, {refusal}"
    if is_last and any(each.size == inf for each in law_errors):
        return "no law of the limits describes the means; gfmd needs finer levels"
    worst = max((each for each in law_errors if each.size < inf), key=lambda each: each.size, default=None)
    if worst is not None and worst.size >= target:
        return (
            f"the distance from the finest levels to the limit leaves {worst.size:.2%} open, mostly that of "
            f"{worst.limit}, however many surfaces there are; gfmd needs finer levels"
        )
    return ""


def _refined(state: Rounds, of_target: _Standing, most: float) -> Rounds | None:
    """Return the rounds with one more, of finer levels for groups whose laws leave more than `most` open; else None.

    Of the other groups, those that miss the target get more surfaces in the same round.
    """
    now, known = state.now, of_target.known
    results = known.results
    dimension = int(results["dimension"].values[0])
    levels: list[tuple[Level, ...]] = []
    for of_group, each in zip(now.levels, of_target.law_errors, strict=True):
        step = 2.0 if each.halved <= most else STEP[dimension]
        levels.append(tuple(finer_levels(of_group, each.limit, step)) if each.size > most else of_group)
    if tuple(levels) == now.levels:
        return None
    held = dict(zip(now.cases, now.realisations, strict=True))
    prices = dict(zip(now.cases, known.price.tolist(), strict=True))
    first = [number for of_group in levels for number in first_realisations(of_group, dimension)]
    another = Round(realisations=tuple(first), levels=tuple(levels), is_last=False, variable=known.variable)
    counts = [max(held.get(case, 0), number) for case, number in zip(another.cases, first, strict=True)]
    of_case = dict(zip(now.cases, results["case_id"].values.tolist(), strict=True))
    first_of: dict[tuple[str, ...], int] = {}  # the group whose problems are solved once for it and others
    problems = (tuple(of_case[group, each] for each in of_group) for group, of_group in enumerate(now.levels))
    alike = [first_of.setdefault(each, group) for group, each in enumerate(problems)]
    priced: dict[tuple[int, Level], float] = {}
    for (group, level), count in zip(another.cases, counts, strict=True):
        like = now.levels[group][0]  # whose contacts take as many transforms
        finer = price_of_transform(nodes_of(level, dimension)) / price_of_transform(nodes_of(like, dimension))
        each = prices.get((group, level), prices[group, like] * float(finer))
        problem = (alike[group], level)
        priced[problem] = max(priced.get(problem, 0.0), count * each)
    price, most_of_all = sum(priced.values()), _most(state)
    if price > most_of_all:
        refusal = _refusal(known.fitted)
        said = f"{refusal and f'{refusal}: '}the budget is too small for the finer levels that the laws need"
        return state.ending(f"not {REACHED}: {said}")
    more, added = _for_the_others(state, of_target, levels, most_of_all - price)
    counts = [max(count, more.get(case, 0)) for case, count in zip(another.cases, counts, strict=True)]
    another = another.model_copy(update={"realisations": tuple(counts), "price": price + added})
    return state.followed_by(another)


def _most(state: Rounds) -> float:
    """Return the price that the budget allows in all, inf without one."""
    budget, seconds = state.goal.budget, state.seconds_per_price
    return inf if budget is None or seconds is None else budget / seconds


def _for_the_others(
    state: Rounds, of_target: _Standing, levels: Sequence[tuple[Level, ...]], most: float
) -> tuple[dict[tuple[int, Level], int], float]:
    """Return realisations by case for the groups that keep their levels and miss the target, and what these add."""
    now, fitted, law_errors = state.now, of_target.known.fitted, of_target.law_errors
    n_groups = len(now.levels)
    others = [
        group
        for group in range(n_groups)
        if levels[group] == now.levels[group]
        and law_errors[group].size < of_target.target < law_errors[group].error < inf
    ]
    here = [index for index, (group, _) in enumerate(now.cases) if group in others]
    if not here:
        return {}, 0.0
    theirs = fitted.isel(group=[index for index in range(fitted.sizes["group"]) if index % n_groups in others])
    known = replace(of_target.known, results=of_target.known.results.isel(case=here), fitted=theirs)
    aim = sqrt(of_target.target**2 - max(law_errors[group].size for group in others) ** 2)
    try:
        spent = known.whole_price(known.held)
        decision = _decision(state, replace(of_target, known=known, found=judge(known)), aim, most + spent)
    except UnusableDataError:
        decision = None
    if decision is None:
        return {}, 0.0
    cases = [now.cases[index] for index in here]
    return dict(zip(cases, decision.realisations, strict=True)), (decision.price or 0.0) - spent


def _with_another(state: Rounds, of_target: _Standing, aim: float, of_laws: float) -> Rounds:
    """Return the rounds with one more of more realisations, which bring all error but that `of_laws` to an `aim`."""
    try:
        decision = _decision(state, of_target, aim, _most(state))
    except UnusableDataError as error:
        return state.ending(f"not {REACHED}: {error}")
    if decision is None:
        return state.ending(f"not {REACHED}: the budget is too small for another round")
    whole_error = hypot(decision.predicted_error or 0.0, of_laws)
    return state.followed_by(decision.model_copy(update={"levels": state.now.levels, "predicted_error": whole_error}))


def _decision(state: Rounds, of_target: _Standing, aim: float, most: float) -> Round | None:
    """Return the realisations that bring what surfaces can mend to an `aim`, for a price of at most `most` in all."""
    found = of_target.found
    mendable = replace(found, error=min(found.error, found.predicted)) if found.error < inf else found
    return decide(of_target.known, mendable, aim, most, after_pilot=len(state.rounds) == 1)
