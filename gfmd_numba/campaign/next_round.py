"""From the results of one round to the next: whether the target is reached, and what to do if not."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import hypot, inf, sqrt

import numpy as np
import xarray as xr

from gfmd_numba.analysis import UnusableDataError
from gfmd_numba.analysis.fit_dataset import in_the_limit
from gfmd_numba.analysis.limit_errors import expected_doubts
from gfmd_numba.analysis.selection import LIMITS
from gfmd_numba.campaign.cost import price_of_transform
from gfmd_numba.campaign.decision import (
    Decision,
    Fit,
    Judgement,
    UnknownExponentsError,
    decide,
    judge,
    price_of_realisations,
    whole_price,
)
from gfmd_numba.campaign.levels import STEP, Level, finer_levels, first_realisations, nodes_of
from gfmd_numba.campaign.rounds import Round, Rounds, TargetError

REACHED = "reached"
_SHARE_OF_DOUBTS = 0.7  # of the target, beyond which laws leave so much open that surfaces alone do not mend it
_SHARE_OF_PRICE = 0.5  # of more surfaces, below which finer levels come first
_MISFIT = 1.5  # factor on the errors of the means, beyond which their laws are not those of the levels
_FUTILE = 2  # rounds with finer levels, after which a law should describe the means
_UNKNOWN = 0.5  # relative error, beyond which a limit is 0 within two standard errors
_SOME = 2  # rounds after the pilot that do not tell a limit from 0, after which others hardly would
_MOST = 10  # rounds after the pilot: each may have four times the price of all before


@dataclass(frozen=True)
class Fitted:
    """What is known of a variable after a round: the results, their fit to its limit, and what was known before."""

    results: xr.Dataset
    fitted: xr.Dataset
    fit: Fit


def after(state: Rounds, fits: Sequence[Fitted], may_refine: bool = False) -> Rounds:
    """Return the rounds with what the last one has found for each target, and either one more round or `ended`.

    The target that is furthest from being reached decides. `may_refine` says whether the next round may have finer
    levels than the last.
    """
    now = state.now
    state = state.with_now(cpu_seconds=float(fits[0].results.attrs["cpu_seconds"]))
    standing, price = [], 0.0
    for of_target in fits:
        results = of_target.results
        try:
            price = whole_price(results, price_of_realisations(results), results["realisations"].values)
            standing.append(_standing(state, of_target, may_refine))
        except UnusableDataError as error:
            return _named(state.ending(f"not {REACHED}: {error}"), of_target.fit)
    errors = {each.fit.variable: each.error for each in standing}
    state = state.with_now(errors=errors, price=price if now.price is None else now.price)
    missed = [each for each in standing if not each.error.reached]
    if not missed:
        return state.ending(REACHED)
    if len(state.rounds) > _MOST:
        return state.ending(f"not {REACHED}: {_MOST} rounds did not suffice")
    furthest = max(missed, key=lambda each: each.found.sure_error / each.target)
    return _named(_decided(state, furthest, price, may_refine), furthest.fit)


@dataclass(frozen=True)
class _Standing(Fitted):
    """Where a variable stands after a round: its target, its errors, and what its laws leave open."""

    target: float
    found: Judgement
    doubts: "list[_Doubt]"
    error: TargetError


def _standing(state: Rounds, of_target: Fitted, may_refine: bool) -> _Standing:
    """Return where a variable stands after the last round; raises UnusableDataError for results that do not tell."""
    results, fitted, fit = of_target.results, of_target.fitted, of_target.fit
    now, target = state.now, state.goal.targets[fit.variable]
    found, doubts = judge(results, fitted, fit), _doubts(fitted, max(1, len(now.levels)))
    described = all(doubt.size < inf for doubt in doubts)
    expected = _was_to_reach(now, fit) or found.predicted <= target or may_refine
    reached = described and found.sure_error <= target and expected
    error = TargetError(error=found.error if found.error < inf else None, factor=found.sure_factor, reached=reached)
    return _Standing(results, fitted, fit, target, found, doubts, error)


def _was_to_reach(now: Round, fit: Fit) -> bool:
    """Return whether a round was planned to reach the target of a variable."""
    return now.is_last and now.variable == fit.variable


def _named(state: Rounds, fit: Fit) -> Rounds:
    """Return the rounds with the name of the variable in `ended`, if there are several variables."""
    missed = f"not {REACHED}: "
    if len(state.goal.targets) == 1 or not state.ended.startswith(missed):
        return state
    return state.ending(state.ended.replace(missed, f"{missed}{fit.variable}: ", 1))


def _decided(state: Rounds, furthest: _Standing, price: float, may_refine: bool) -> Rounds:
    """Return the rounds with one more, which brings a target nearer, or `ended`; `price` is that of all so far."""
    fitted, fit, target = furthest.fitted, furthest.fit, furthest.target
    doubts, is_last = furthest.doubts, _was_to_reach(state.now, fit)
    large = _SHARE_OF_DOUBTS * target
    contradiction = abs(fitted["contradiction"] / in_the_limit(fitted)[0]).max("group")
    if which := [f"{name}: {fit.fixed[name]:g}" for name in LIMITS if contradiction.sel(limit=name) > large]:
        said = f"the levels contradict the fixed {' and '.join(which)}; gfmd allows the range that it lies in"
        return state.ending(f"not {REACHED}: {said}")
    described = all(doubt.size < inf for doubt in doubts)
    if may_refine and not described and (why := _indescribable(state.rounds, fitted, doubts)):
        return state.ending(f"not {REACHED}: {why}")
    if len(state.rounds) > _SOME and _UNKNOWN < furthest.found.error < inf:
        said = f"the limit of {fit.variable} is 0 within two standard errors, so that no relative error makes sense"
        return state.ending(f"not {REACHED}: {said}")
    finer = _refined(state, furthest, large) if may_refine else None
    if finer is not None:
        return finer
    if not may_refine and (why := _hopeless(fitted, doubts, is_last, target)):
        return state.ending(f"not {REACHED}: {why}")
    of_laws = max(doubt.size for doubt in doubts)
    worth = of_laws if large < of_laws < inf else large  # surfaces are worth no more than the laws
    aim = sqrt(target**2 - of_laws**2) if of_laws <= large else worth
    another = _with_another(state, furthest, aim, min(of_laws, target))
    unmet = [doubt if doubt.error > target else replace(doubt, size=0.0) for doubt in doubts]
    finer = _refined(state, replace(furthest, doubts=unmet), 0.0) if may_refine else None
    return another if finer is None or _is_cheaper(another, finer, price) else finer


def _indescribable(rounds: Sequence[Round], fitted: xr.Dataset, doubts: "Sequence[_Doubt]") -> str:
    """Return why even finer levels are not worth their price when no law describes the means; empty if they are."""
    latest = rounds[-1 - _FUTILE :]
    refined = (
        all(one.levels[group] != following.levels[group] for one, following in pairwise(latest))
        for group, doubt in enumerate(doubts)
        if doubt.size == inf
    )
    if len(latest) <= _FUTILE or not any(refined):
        return ""
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
    if surfaces.ended or surfaces.now.target_price is None:  # they do not do alone
        return False
    dear = (levels.now.price or 0.0) - spent > _SHARE_OF_PRICE * (surfaces.now.target_price - spent)
    return bool(levels.ended) or dear


@dataclass(frozen=True)
class _Doubt:
    """What the laws of one group leave open: the relative error, inf if unknown, and the limit that adds most to it.

    `halved` is the error to expect with half the finest eps_f, and `error` the whole relative error of the group.
    """

    size: float
    limit: str
    halved: float
    error: float


def _doubts(fitted: xr.Dataset, n_groups: int) -> list[_Doubt]:
    """Return what the laws of each group leave open however many surfaces there are; of a path, at its worst step."""
    limit, error = in_the_limit(fitted)
    value = abs(limit)
    whole = (error / value).fillna(inf).values
    rivals = (fitted["error_budget"].sel(source="rivals") / value).fillna(0.0)
    by_limit = (fitted["extrapolation_error"] / value).fillna(0.0)
    halved = by_limit.copy()
    halved.loc[{"limit": "eps_f"}] = np.nan_to_num(expected_doubts(fitted, "eps_f", 2.0) / value.values)
    for each in (by_limit, halved):
        each.loc[{"limit": "eps_f"}] = np.hypot(each.sel(limit="eps_f"), rivals)
    is_described = (fitted["fit_status"] == "ok") & (fitted["misfit"] <= _MISFIT)
    size, of_half = (xr.where(is_described, np.sqrt((each**2).sum("limit")), inf) for each in (by_limit, halved))
    found = []
    for group in range(n_groups):
        worst = group + n_groups * int(size.values[group::n_groups].argmax())
        widest = "eps_f" if size[worst] == inf else str(by_limit["limit"].values[by_limit.values[worst].argmax()])
        of_all = float(whole[group::n_groups].max())
        found.append(_Doubt(float(size[worst]), widest, float(of_half[worst]), of_all))
    return found


def _hopeless(fitted: xr.Dataset, doubts: Sequence[_Doubt], is_last: bool, target: float) -> str:
    """Return why more surfaces do not reach a target at the present levels; empty if they may."""
    refused = fitted["message"].values[fitted["fit_status"].values == "refused"]
    if is_last and len(refused):
        return f"the fit is refused, {'; '.join(str(refused[0]).splitlines())}"
    if is_last and any(doubt.size == inf for doubt in doubts):
        return "no law of the limits describes the means; gfmd needs finer levels"
    worst = max((doubt for doubt in doubts if doubt.size < inf), key=lambda doubt: doubt.size, default=None)
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
    now, results = state.now, of_target.results
    dimension = int(results["dimension"].values[0])
    levels: list[tuple[Level, ...]] = []
    for of_group, doubt in zip(now.levels, of_target.doubts, strict=True):
        step = 2.0 if doubt.halved <= most else STEP[dimension]
        levels.append(tuple(finer_levels(of_group, doubt.limit, step)) if doubt.size > most else of_group)
    if tuple(levels) == now.levels:
        return None
    held = dict(zip(now.cases, now.realisations, strict=True))
    prices = dict(zip(now.cases, price_of_realisations(results).tolist(), strict=True))
    first = [number for of_group in levels for number in first_realisations(of_group, dimension)]
    another = Round(realisations=tuple(first), levels=tuple(levels), is_last=False, variable=of_target.fit.variable)
    counts = [max(held.get(case, 0), number) for case, number in zip(another.cases, first, strict=True)]
    alike = _alike(now, results["case_id"].values.tolist())
    priced: dict[tuple[int, Level], float] = {}
    for (group, level), count in zip(another.cases, counts, strict=True):
        like = now.levels[group][0]  # whose contacts take as many transforms
        finer = price_of_transform(nodes_of(level, dimension)) / price_of_transform(nodes_of(like, dimension))
        each = prices.get((group, level), prices[group, like] * float(finer))
        problem = (alike[group], level)
        priced[problem] = max(priced.get(problem, 0.0), count * each)
    price, most_of_all = sum(priced.values()), _most(state)
    if price > most_of_all:
        return state.ending(f"not {REACHED}: the budget is too small for the finer levels that the laws need")
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
    now, results, fitted, fit = state.now, of_target.results, of_target.fitted, of_target.fit
    doubts, n_groups = of_target.doubts, len(now.levels)
    others = [
        group
        for group in range(n_groups)
        if levels[group] == now.levels[group] and doubts[group].size < of_target.target < doubts[group].error < inf
    ]
    here = [index for index, (group, _) in enumerate(now.cases) if group in others]
    if not here:
        return {}, 0.0
    results = results.isel(case=here)
    fitted = fitted.isel(group=[index for index in range(fitted.sizes["group"]) if index % n_groups in others])
    aim = sqrt(of_target.target**2 - max(doubts[group].size for group in others) ** 2)
    try:
        spent = whole_price(results, price_of_realisations(results), results["realisations"].values)
        found = judge(results, fitted, fit)
        decision = _decision(state, replace(of_target, results=results, found=found), aim, most + spent)
    except UnusableDataError:
        return {}, 0.0
    if decision is None:
        return {}, 0.0
    cases = [now.cases[index] for index in here]
    return dict(zip(cases, decision.realisations.tolist(), strict=True)), decision.price - spent


def _alike(now: Round, identities: Sequence[str]) -> list[int]:
    """Return for each group the first one with the same problems, which are solved once for both."""
    of_case = dict(zip(now.cases, identities, strict=True))
    first: dict[tuple[str, ...], int] = {}
    return [
        first.setdefault(tuple(of_case[group, level] for level in levels), group)
        for group, levels in enumerate(now.levels)
    ]


def _with_another(state: Rounds, of_target: _Standing, aim: float, of_laws: float) -> Rounds:
    """Return the rounds with one more of more realisations, which bring all error but that `of_laws` to an `aim`."""
    try:
        decision = _decision(state, of_target, aim, _most(state))
    except UnknownExponentsError as error:
        return state.ending(f"not {REACHED}: {error}{_widest(of_target.fitted)}")
    except UnusableDataError as error:
        return state.ending(f"not {REACHED}: {error}")
    if decision is None:
        return state.ending(f"not {REACHED}: the budget is too small for another round")
    another = Round(
        realisations=tuple(decision.realisations.tolist()),
        is_last=decision.is_last,
        levels=state.now.levels,
        variable=of_target.fit.variable,
        predicted_error=hypot(decision.predicted_error, of_laws),
        price=decision.price,
        target_price=decision.target_price,
    )
    return state.followed_by(another)


def _decision(state: Rounds, of_target: _Standing, aim: float, most: float) -> Decision | None:
    """Return the realisations that bring what surfaces can mend to an `aim`, for a price of at most `most` in all."""
    found = of_target.found
    mendable = replace(found, error=min(found.error, found.predicted)) if found.error < inf else found
    return decide(of_target.results, mendable, aim, of_target.fit, most, after_pilot=len(state.rounds) == 1)


def _widest(fitted: xr.Dataset) -> str:
    """Say which exponent's range the error of the limit comes from mostly, where the fit tells."""
    shares = fitted["error_budget"].max("group")
    exponents = {name: float(shares.sel(source=name)) for name in LIMITS if shares.sel(source=name) > 0}
    return f" (above all that of {max(exponents, key=lambda name: exponents[name])})" if exponents else ""
