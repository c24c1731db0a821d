"""What a target of accuracy asks of a campaign: a pilot of every case of some groups, and the design it leads to."""

import json
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import xarray as xr
import yaml

from gfmd_numba.analysis import Design, best_design, cheapest_design
from gfmd_numba.analysis.steps_of_paths import steps_of
from gfmd_numba.arrays import Reals
from gfmd_numba.campaign.axes import DISCRETISATIONS
from gfmd_numba.campaign.cases import Case, distinct, expand, groups
from gfmd_numba.campaign.collection import Measures, in_file_units, recorded_of
from gfmd_numba.campaign.coordinates import described_coordinates, steps_of_paths
from gfmd_numba.campaign.cost import Told
from gfmd_numba.campaign.cross_levels import added
from gfmd_numba.campaign.ensemble import measured
from gfmd_numba.campaign.execution import compile_kernels
from gfmd_numba.campaign.file import Campaign, load_campaign
from gfmd_numba.campaign.fit_record import Fit
from gfmd_numba.campaign.limits import CROSS, Realisations
from gfmd_numba.campaign.plan import Plan
from gfmd_numba.campaign.regression import features, kinds_of, regression
from gfmd_numba.campaign.rewriting import with_values
from gfmd_numba.campaign.run_times import remember, remembered
from gfmd_numba.contact.dataset import campaign_dataset, units
from gfmd_numba.contact.problem import Problem
from gfmd_numba.scene import Discretisation, InputError

REALISATIONS = 40  # of the pilot
_SCOUTED = 20  # of the cheapest case of every group before it: those that scatter most are the dearest
_GROUPS = 3  # that it has at least, as far as there are so many,
_SECONDS = 20.0  # and more as long as they take no longer in all
_RESIDUALS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-8)
_LONGEST_NAME = 100
_RESIDUAL_SHARE = 0.1  # of the target that the solver's residual may use up


@dataclass(frozen=True)
class Pilot:
    """Results of some realisations of some groups' cases, and the seconds that one of each takes in all groups.

    It stands for `n_groups` groups, of which `n_solved` are solved in it; problems shared with others count once.
    """

    results: xr.Dataset
    seconds: list[float]
    n_groups: int
    n_solved: int


def pilot(planned: Plan, told: Told | None = None) -> Pilot:
    """Solve 40 realisations of every case of some groups, those that scatter most first, in this process.

    All groups if they take 20 s or less, three at least. The share that is done is told.
    """
    members = groups(planned.cases)
    alike: dict[tuple[str, ...], list[Case]] = {}  # another Poisson's ratio of a half-space is no other problem
    for group in members:
        alike.setdefault(_identities(group), group)
    compile_kernels(planned.problems)
    found: dict[str, Measures] = {}
    seconds: dict[str, float] = {}
    solved: set[tuple[str, ...]] = set()
    for group in _most_scattered_first(list(alike.values()), planned.campaign.fit):
        spent = REALISATIONS * sum(seconds.values())
        if len(solved) >= _GROUPS and spent * (1 + 1 / len(solved)) > _SECONDS:
            break
        for problem in (case.problem for case in group):
            if problem.identity not in seconds:
                begun = time.thread_time()
                found[problem.identity] = measured(problem, REALISATIONS)
                seconds[problem.identity] = (time.thread_time() - begun) / REALISATIONS
        solved.add(_identities(group))
        if told is not None:
            told(max(len(solved) / len(alike), min(1.0, spent / _SECONDS)))
    remember(remembered() | seconds)  # the run need not measure again
    cases = [case for identities, group in alike.items() if identities in solved for case in group]
    rows = recorded_of(cases)
    values = [in_file_units(case, rows, found[case.problem.identity]) for case in cases]
    scene = planned.campaign.scene
    coordinates = described_coordinates(scene, cases) | steps_of_paths(cases, planned.campaign.path)
    results = campaign_dataset(coordinates, rows, values, units(scene))
    if (step := planned.campaign.fit.step) is not None:
        (results,) = steps_of(results, planned.campaign.fit.variable, step)
    n_solved = sum(_identities(group) in solved for group in members)
    return Pilot(results.drop_vars("realisations"), _in_all_groups(planned, cases, seconds), len(members), n_solved)


def design(planned: Plan, found: Pilot, target: float | None, budget: float | None) -> Design:
    """Cheapest design that meets a relative target, or the best for a budget of processor time in s.

    Raises UnusableDataError where there is none.
    """
    fit = planned.campaign.fit
    fixed = {name: value for name, value in fit.fixed if value is not None}
    if target is not None:
        chosen = cheapest_design(found.results, found.seconds, target, fit.variable, fixed)
    else:
        chosen = best_design(found.results, found.seconds, budget or 0.0, fit.variable, fixed)
    return chosen


def promise(found: Pilot) -> str:
    """Sentence that says which groups reach the error of a design, and how surely."""
    if found.n_solved == found.n_groups:
        whom = "the group" if found.n_groups == 1 else f"each of the {found.n_groups} groups"
        return f"{whom} reaches this error with 90 % probability"
    return (
        f"each of the {found.n_solved} groups of the pilot, out of {found.n_groups}, reaches this error with 90 % "
        "probability; nothing is promised for the others, which scatter less"
    )


def designed(planned: Plan, chosen: Design) -> Plan:
    """Plan of the campaign with the realisations of a design."""
    asked_for = Realisations(reference=chosen.reference, **_counts(planned.campaign, chosen))
    campaign = planned.campaign.model_copy(update={"realisations": asked_for})
    cases = expand(campaign, planned.punches, planned.measured, planned.document)
    return replace(planned, campaign=campaign, cases=cases, problems=distinct(cases))


def loosest_residual(planned: Plan, target: float) -> float:
    """Largest residual of the solver that changes no mean of the fitted quantity by a tenth of the target.

    Measured on the reference case of the first group.
    """
    problem = next(case.problem for case in planned.cases if case.limit == "reference")
    fit = planned.campaign.fit
    tight = _means(problem, _RESIDUALS[-1], fit)
    for residual in _RESIDUALS:
        if (abs(_means(problem, residual, fit) - tight) <= _RESIDUAL_SHARE * target * abs(tight)).all():
            return residual
    return _RESIDUALS[-1]


def rewritten(planned: Plan, chosen: Design, target: float | None) -> tuple[str, str]:
    """Text of the campaign with the realisations and the target of a design, and its new name; raises InputError.

    Under the old name its results would take the place of those of the first campaign.
    """
    goal = f"{chosen.error if target is None else target:.4g}"
    name = f"{planned.campaign.name[: _LONGEST_NAME - len(goal) - 1]}-{goal}"
    target_of = f"{{{planned.campaign.fit.variable}: {goal}}}"
    values = {"name": name, "realisations": f"{{{asked(planned, chosen)}}}", "target": target_of}
    if crossed := added(planned):
        values[f"limits.{CROSS}"] = crossed
    text = with_values(planned.document.text, values)
    if not _is_meant(planned.campaign, text, values):
        raise InputError(
            "--write: you gave a campaign file whose text cannot be changed with certainty; gfmd allows one of plain "
            "YAML "
            f"(or write it yourself: {', '.join(f'`{key}: {value}`' for key, value in values.items())})"
        )
    return text, name


def _is_meant(campaign: Campaign, text: str, values: Mapping[str, str]) -> bool:
    """Whether a text reads as the campaign with other values, and with no other name by chance."""
    with TemporaryDirectory() as folder:
        file = Path(folder, "campaign.yaml")
        file.write_bytes(text.encode())
        try:
            found = load_campaign(file)[0]
        except InputError:
            return False
    counts = yaml.safe_load(values["realisations"])
    given = json.loads(found.realisations.model_dump_json(exclude_none=True))
    expected = {"name": values["name"], "target": yaml.safe_load(values["target"]), "realisations": found.realisations}
    return bool(given == counts and found == campaign.model_copy(update=expected) and found.name != campaign.name)


def asked(planned: Plan, chosen: Design) -> str:
    """Realisations of a design, for the reference and each level of the campaign's limits in its order."""
    counts = {limit: list(numbers) for limit, numbers in _counts(planned.campaign, chosen).items()}
    return ", ".join(f"{key}: {count}" for key, count in ({"reference": chosen.reference} | counts).items())


def _counts(campaign: Campaign, chosen: Design) -> dict[str, tuple[int, ...]]:
    """Realisations of each level in the order of the campaign, 0 of those that the pilot has not solved."""
    counts = {}
    for limit in DISCRETISATIONS:
        found = chosen.levels.get(limit, {})
        counts[limit] = tuple(found.get(eps, 0) for eps in getattr(campaign.limits, limit) or ())
    crossed = iter(chosen.cross)
    solved = [campaign.realisations.of(CROSS, i) > 0 for i in range(len(campaign.limits.crossed))]
    counts[CROSS] = tuple(next(crossed) if each else 0 for each in solved)
    return {limit: numbers for limit, numbers in counts.items() if numbers}


def _means(problem: Problem, residual: float, fit: Fit) -> Reals:
    """Mean of what is fitted, `[step]` of those steps of a path that are fitted."""
    looser = replace(problem, numerics=replace(problem.numerics, residual=residual, precision="double"))
    return np.asarray(np.mean(_fitted(measured(looser, REALISATIONS), fit), axis=0))


def _fitted(values: Measures, fit: Fit) -> Reals:
    """What is fitted `[realisation, step]`, without steps `[realisation, 1]`."""
    found = values[fit.variable].reshape(len(values["status"]), -1)
    return found if fit.step is None else found[:, [fit.step]]


def _most_scattered_first(members: list[list[Case]], fit: Fit) -> list[list[Case]]:
    """Groups by the relative scatter of their cheapest case, the largest first."""
    if len(members) <= _GROUPS:
        return members
    scatter = []
    for group in members:
        cheapest = min((case.problem for case in group), key=lambda problem: problem.surface.nodes)
        values = _fitted(measured(cheapest, _SCOUTED), fit)
        scatter.append(np.max(np.nanstd(values, axis=0) / abs(np.nanmean(values, axis=0))))
    return [members[i] for i in np.argsort(-np.array(scatter), kind="stable")]


def _in_all_groups(planned: Plan, cases: list[Case], seconds: dict[str, float]) -> list[float]:
    """Seconds of a realisation of each case, with its share in those of the groups that the pilot has not solved."""
    problems = planned.problems
    kinds = kinds_of(problems)
    known = [problem for problem in problems if problem.identity in seconds]
    times = np.array([seconds[problem.identity] for problem in known])
    likely = np.exp(features(problems, kinds) @ regression(features(known, kinds), times).coefficients)
    each = {problem.identity: time for problem, time in zip(problems, likely.tolist(), strict=True)} | seconds
    total, pilot_alone = _seconds_of_levels(planned.cases, each), _seconds_of_levels(cases, each)
    sharing = Counter(case.problem.identity for case in cases)
    found = []
    for case in cases:
        scale = total[case.discretisation] / pilot_alone[case.discretisation]
        found.append(scale * each[case.problem.identity] / sharing[case.problem.identity])
    return found


def _seconds_of_levels(cases: list[Case], each: dict[str, float]) -> dict[Discretisation | None, float]:
    """Seconds of a realisation of all distinct problems at each discretisation."""
    levels: dict[Discretisation | None, set[str]] = {}
    for case in cases:
        levels.setdefault(case.discretisation, set()).add(case.problem.identity)
    return {level: sum(each[identity] for identity in identities) for level, identities in levels.items()}


def _identities(group: list[Case]) -> tuple[str, ...]:
    return tuple(case.problem.identity for case in group)
