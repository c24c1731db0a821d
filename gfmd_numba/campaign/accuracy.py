"""What a target of accuracy asks of a campaign: a pilot of every case of some groups, and the design it leads to."""

import json
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import xarray as xr
import yaml

from gfmd_numba.analysis import Design, best_design, cheapest_design
from gfmd_numba.campaign.cases import groups
from gfmd_numba.campaign.collection import in_file_units
from gfmd_numba.campaign.execution import compile_kernels
from gfmd_numba.campaign.plan import Plan, coordinates
from gfmd_numba.campaign.rewriting import with_values
from gfmd_numba.campaign.specification import Campaign, load_campaign
from gfmd_numba.contact import solve
from gfmd_numba.dataset import campaign_dataset, units
from gfmd_numba.observables import measure
from gfmd_numba.problem import Problem
from gfmd_numba.scene import InputError

REALISATIONS = 40  # of the pilot
_GROUPS = 3  # of equal physics, the first, the last and the one in the middle
_RESIDUALS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-8)
_LONGEST_NAME = 100
_RESIDUAL_SHARE = 0.1  # of the target that the solver's residual may use up


@dataclass(frozen=True)
class Pilot:
    """Results of some realisations of some groups' cases, and the seconds that one of each takes, shared ones once.

    `scale` is the cost of all groups over those of the pilot.
    """

    results: xr.Dataset
    seconds: list[float]
    scale: float


def pilot(planned: Plan) -> Pilot:
    """Solve 40 realisations of every case of up to three groups, in this process."""
    members = groups(planned.cases)
    chosen = sorted({0, len(members) // 2, len(members) - 1})
    cases = [case for index in chosen for case in members[index]]
    problems = {case.problem.identity: case.problem for case in cases}
    compile_kernels(problems.values())
    measured, seconds = {}, {}
    for identity, problem in problems.items():
        begun = time.thread_time()
        measured[identity] = measure(solve(problem, range(REALISATIONS)))
        seconds[identity] = (time.thread_time() - begun) / REALISATIONS
    values = [in_file_units(case, measured[case.problem.identity]) for case in cases]
    results = campaign_dataset(coordinates(cases), values, units(planned.campaign.scene), {})
    results = results.drop_vars("realisations")
    sharing = {identity: sum(case.problem.identity == identity for case in cases) for identity in problems}
    each = [seconds[case.problem.identity] / sharing[case.problem.identity] for case in cases]
    return Pilot(results, each, len(planned.problems) / len(problems))


def design(planned: Plan, found: Pilot, target: float | None, budget: float | None) -> Design:
    """Cheapest design that meets a relative target, or the best for a budget of processor time in s.

    Raises UnusableDataError where there is none.
    """
    fit = planned.campaign.fit
    fixed = {name: value for name, value in fit.fixed if value is not None}
    if target is not None:
        chosen = cheapest_design(found.results, found.seconds, target, fit.variable, fixed)
    else:
        chosen = best_design(found.results, found.seconds, (budget or 0.0) / found.scale, fit.variable, fixed)
    return replace(chosen, seconds=chosen.seconds * found.scale)


def loosest_residual(planned: Plan, target: float) -> float:
    """Largest residual of the solver that changes no mean of the fitted quantity by a tenth of the target.

    Measured on the reference case of the first group.
    """
    problem = next(case.problem for case in planned.cases if case.limit == "reference")
    variable = planned.campaign.fit.variable
    tight = _mean(problem, _RESIDUALS[-1], variable)
    for residual in _RESIDUALS:
        if abs(_mean(problem, residual, variable) / tight - 1.0) <= _RESIDUAL_SHARE * target:
            return residual
    return _RESIDUALS[-1]


def rewritten(planned: Plan, chosen: Design, target: float | None) -> tuple[str, str]:
    """Text of the campaign with the realisations and the target of a design, and its new name; raises InputError.

    Under the old name its results would take the place of those of the first campaign.
    """
    goal = f"{chosen.error if target is None else target:.4g}"
    name = f"{planned.campaign.name[: _LONGEST_NAME - len(goal) - 1]}-{goal}"
    values = {"name": name, "realisations": f"{{{asked(planned, chosen)}}}", "target": goal}
    text = with_values(planned.document.text, values)
    if not _is_meant(planned.campaign, text, values):
        raise InputError(
            "--write: given a campaign file whose text cannot be changed with certainty; allowed: one of plain YAML "
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
    expected = {"name": values["name"], "target": float(values["target"]), "realisations": found.realisations}
    return bool(given == counts and found == campaign.model_copy(update=expected) and found.name != campaign.name)


def asked(planned: Plan, chosen: Design) -> str:
    """Realisations of a design, for the reference and each level of the campaign's limits in its order."""
    counts = [f"reference: {chosen.reference}"]
    for limit, levels in planned.campaign.limits:
        found = chosen.levels.get(limit, {})
        if found:
            counts.append(f"{limit}: [{', '.join(str(found.get(eps, 0)) for eps in levels)}]")
    return ", ".join(counts)


def _mean(problem: Problem, residual: float, variable: str) -> float:
    settings = {"residual": residual, "precision": "double"}
    looser = replace(problem, numerics=problem.numerics.model_copy(update=settings))
    return float(np.mean(measure(solve(looser, range(REALISATIONS)))[variable]))
