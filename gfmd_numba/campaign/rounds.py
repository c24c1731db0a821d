"""The rounds of a run until an error is reached: what was decided for each, kept in its output directory."""

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations, islice, product
from math import prod
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, Field, ValidationError

from gfmd_numba.analysis.selection import at_nyquist
from gfmd_numba.campaign import limits
from gfmd_numba.campaign.axes import DISCRETISATIONS
from gfmd_numba.campaign.cases import Case, expand, groups
from gfmd_numba.campaign.cost import UNITS
from gfmd_numba.campaign.file import Campaign, load_campaign
from gfmd_numba.campaign.goal import Goal
from gfmd_numba.campaign.plan import Plan
from gfmd_numba.contact import relative_softening
from gfmd_numba.contact.contact_dataset import cf_attributes
from gfmd_numba.scene import InputError
from gfmd_numba.storage import json_file
from gfmd_numba.text.input_error import ABSENT

_SPARE = 8  # realisations beyond the cases of a group, by which a pilot knows its errors to a factor of 1.5,
_MOST_OF_A_PILOT = 40  # as far as there are so many
FILE = "rounds.json"

_OF_A_TARGET = {
    "predicted_error": "relative standard error of the limit, times its factor, that was expected before the round",
    "error": "relative standard error of the limit that the fit reported after the round, of the worst group",
    "error_factor": "factor on the error of the fit that allows for the uncertainty of the error itself",
}
_OF_A_ROUND = {
    "price": f"price of all realisations, in {UNITS}",
    "target_price": "price at which the target was expected to be reached, nan if unknown",
    "cpu_seconds": "processor time of the contacts up to the end of the round",
}


class TargetError(BaseModel):
    """Relative error of a target after a round (None if the fit is refused), its factor, and whether that is enough."""

    model_config = Goal.model_config
    error: float | None
    factor: float
    reached: bool


class Round(BaseModel):
    """What was decided for a round before it ran, and what was found after it.

    `variable` is the target for which the round was decided: `predicted_error` and `target_price` are about it, and
    `is_last` says that the round was planned to reach it, or to use up the budget. Prices are those of the whole run.
    None stands for what is not known; for a pilot nothing is predicted.
    """

    model_config = Goal.model_config
    realisations: tuple[Annotated[int, Field(ge=1, le=limits.MOST)], ...] = Field(min_length=1)  # (case)
    is_last: bool
    levels: tuple[tuple[tuple[float, ...], ...], ...] = ()  # of each group, its reference first; (): the pilot's
    variable: str | None = None
    predicted_error: float | None = None
    errors: dict[str, TargetError] = {}  # of each target
    price: float | None = None
    target_price: float | None = None
    cpu_seconds: float | None = None

    @property
    def cases(self) -> list[Any]:
        """What distinguishes each of its cases from the others."""
        if not self.levels:
            return list(range(len(self.realisations)))
        return [(group, level) for group, of_group in enumerate(self.levels) for level in of_group]

    def told_of(self, target: str) -> dict[str, float | None]:
        """Return what is known of a target, by its name in the results."""
        found = self.errors.get(target)
        return {
            "predicted_error": self.predicted_error if self.variable == target else None,
            "error": None if found is None else found.error,
            "error_factor": None if found is None else found.factor,
        }


class Rounds(BaseModel):
    """The rounds of a run with a goal; `campaign_sha256` is of the campaign's text, `ended` says how it ended, if so.

    The seconds per price are measured once, in the pilot, so that a run that resumes decides as before.
    """

    model_config = Goal.model_config
    goal: Goal
    campaign_sha256: str
    seconds_per_price: float | None = Field(None, gt=0)
    rounds: tuple[Round, ...] = Field(min_length=1)
    ended: str = ""

    @property
    def now(self) -> Round:
        """The round that runs, or has run last."""
        return self.rounds[-1]

    def of(self, members: Sequence[Sequence[Case]]) -> bool:
        """Return whether these rounds began with a pilot of these groups of cases."""
        begun = len(self.rounds[0].realisations) == sum(map(len, members))
        return begun and all(
            len(each.cases) == len(each.realisations) and len(each.levels) in (0, len(members)) for each in self.rounds
        )

    def followed_by(self, another: Round) -> "Rounds":
        """Return the same with another round."""
        return self.model_copy(update={"rounds": (*self.rounds, another)})

    def without_last(self) -> "Rounds":
        """Return the same without the last round."""
        return self.model_copy(update={"rounds": self.rounds[:-1]})

    def with_now(self, **found: Any) -> "Rounds":
        """Return the same with what is known of the last round."""
        return self.without_last().followed_by(self.now.model_copy(update=found))

    def ending(self, how: str) -> "Rounds":
        """Return the same, ended."""
        return self.model_copy(update={"ended": how})

    def variables(self) -> dict[str, tuple[Any, ...]]:
        """Return what the results say of the rounds: dims, values and CF attributes by name."""
        now, counts = self.now.cases, [dict(zip(each.cases, each.realisations, strict=True)) for each in self.rounds]
        numbered = cf_attributes("round of the run, 0 is the pilot")
        asked = cf_attributes("realisations asked of the case in the round")  # of the last round's, 0 if it had not
        found: dict[str, tuple[Any, ...]] = {
            "round": ("round", np.arange(len(self.rounds)), numbered),
            "round_realisations": (("round", "case"), [[each.get(case, 0) for case in now] for each in counts], asked),
        }
        for name, long_name in _OF_A_ROUND.items():
            values = np.array([getattr(each, name) for each in self.rounds], dtype=float)
            attributes = cf_attributes(long_name, "s" if name == "cpu_seconds" else "1")
            found[f"round_{name}"] = ("round", values, attributes)
        targets = list(self.goal.targets)
        for name, long_name in _OF_A_TARGET.items():
            told = np.array([[each.told_of(target)[name] for target in targets] for each in self.rounds], dtype=float)
            dims, values = (("round", "target"), told) if len(targets) > 1 else ("round", told[:, 0])
            found[f"round_{name}"] = (dims, values, cf_attributes(long_name))
        if len(targets) > 1:
            found["target"] = ("target", targets, cf_attributes("variable whose limit is to have an error"))
        return found

    def attributes(self) -> dict[str, str | float]:
        """Return what the results say of the goal and of how the run ended."""
        until = ", ".join(f"{name}={share:g}" for name, share in self.goal.targets.items())
        reached = ", ".join(name for name, error in self.now.errors.items() if error.reached)
        found: dict[str, str | float] = {"until": until, "ended": self.ended, "reached": reached}
        if self.goal.budget is not None:
            found["budget"] = self.goal.budget
        if self.seconds_per_price is not None:
            found["seconds_per_price"] = self.seconds_per_price
        return found


def read(directory: Path) -> Rounds | None:
    """Return the rounds of a run in a directory; None if there are none, or something else in their file."""
    try:
        return Rounds.model_validate(json_file.read(directory / FILE))
    except ValidationError:
        return None


def write(directory: Path, rounds: Rounds) -> None:
    """Keep the rounds in a directory, whole or not at all."""
    json_file.write(directory / FILE, rounds.model_dump(mode="json"))


def forget(directory: Path) -> None:
    """Forget the rounds in a directory, for a run with the realisations of its campaign file."""
    json_file.remove(directory / FILE)


def pilot_plan(planned: Plan, goal: Goal) -> Plan:
    """Return the plan of a campaign's pilot: every level of its limits, whatever realisations its file asks for.

    Cross levels are added if the campaign has none.
    """
    piloted = with_cross_levels(
        planned.changed(realisations=limits.Realisations(reference=limits.FEWEST), target=goal.targets)
    )
    members = groups(piloted.cases)
    number = max(limits.FEWEST, min(max(map(len, members)) + _SPARE, _MOST_OF_A_PILOT))
    counts: list[int] = []
    for of_group in members:
        levels = [level_of(case) for case in of_group]
        counts += limits.first_realisations(levels, piloted.campaign.scene.dimension or 1, number)
    return with_realisations(piloted, counts)


def with_realisations(planned: Plan, realisations: Sequence[int]) -> Plan:
    """Return the plan with other numbers of realisations (case)."""
    cases = [replace(case, realisations=number) for case, number in zip(planned.cases, realisations, strict=True)]
    return replace(planned, cases=cases)


def in_round(piloted: Plan, now: Round) -> Plan:
    """Return the plan of a round from that of the pilot: its levels and its numbers of realisations."""
    if not now.levels:
        return with_realisations(piloted, now.realisations)
    everywhere = list(dict.fromkeys(level for of_group in now.levels for level in of_group))
    found = piloted.changed(
        reference=limits.discretisation_of(everywhere[0]),
        limits=limits.limits_around(everywhere[0], everywhere[1:]),
        realisations=limits.Realisations(reference=limits.FEWEST),
    )
    cases: list[Case] = []
    for members, wanted in zip(groups(found.cases), now.levels, strict=True):
        of_level = {level_of(case): case for case in members}
        cases += [replace(of_level[level], limit=limits.limit_of(wanted[0], level)) for level in wanted]
    return with_realisations(replace(found, cases=cases), now.realisations)


def levels_of(planned: Plan) -> tuple[tuple[limits.Level, ...], ...]:
    """Return the levels of each group of a plan, its reference first; () if a group has several references."""
    members = groups(planned.cases)
    if any(sum(case.limit == "reference" for case in of_group) != 1 for of_group in members):
        return ()
    return tuple(tuple(level_of(case) for case in of_group) for of_group in members)


def level_of(case: Case) -> limits.Level:
    """Return the level of a case that has a discretisation."""
    return tuple(getattr(case.discretisation, name) for name in DISCRETISATIONS)


def with_cross_levels(planned: Plan) -> Plan:
    """Return the plan with the coarsest cross level of each pair of limits, if its campaign has none."""
    campaign = planned.campaign
    if campaign.limits.crossed:
        return planned
    fitted: dict[str, list[float]] = {}  # levels of each limit that have surfaces and enter a fit
    for placed in campaign.discretisations():
        if placed.limit in DISCRETISATIONS:
            eps = getattr(placed.discretisation, placed.limit)
            if placed.limit != "eps_c" or not at_nyquist(eps):
                fitted.setdefault(placed.limit, []).append(eps)
    levels: list[dict[str, float]] = []
    for pair in combinations(fitted, 2):
        coarsest_first = sorted(product(*(fitted[limit] for limit in pair)), key=prod, reverse=True)
        crossed = (dict(zip(pair, each, strict=True)) for each in coarsest_first)
        levels += islice((level for level in crossed if _is_usable(campaign, level)), 1)
    return planned.changed(limits=_with(campaign, levels).limits) if levels else planned


def added(planned: Plan) -> str:
    """Return the cross levels that were added to a plan, as one would write them in the campaign file."""
    crossed = planned.campaign.limits.crossed
    if not crossed or planned.document.value(("limits", limits.CROSS)) not in (ABSENT, None):
        return ""
    levels = [", ".join(f"{axis}: {_fraction(eps)}" for axis, eps in level.items()) for level in crossed]
    return f"[{', '.join(f'{{{level}}}' for level in levels)}]"


def _is_usable(campaign: Campaign, level: dict[str, float]) -> bool:
    crossed = _with(campaign, [level])
    try:
        load_campaign(crossed)
    except InputError:  # waves that are not whole, or too coarse a grid
        return False
    return all(relative_softening.softening(case.problem) <= relative_softening.REFUSED for case in expand(crossed))


def _with(campaign: Campaign, levels: list[dict[str, float]]) -> Campaign:
    given = campaign.limits.model_dump(exclude_unset=True)
    return campaign.model_copy(update={"limits": limits.Limits.model_validate(given | {limits.CROSS: levels})})


def _fraction(eps: float) -> str:
    """Return a fraction that is read as the same number, or else the number itself."""
    near = Fraction(eps).limit_denominator(10**9)
    return str(near) if near.numerator / near.denominator == eps else repr(eps)
