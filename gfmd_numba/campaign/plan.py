"""The plan of a campaign: its cases, the distinct problems behind them, their cost, and the tasks of a run.

It also refuses coarse grids, and names limits that no fit will find.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import psutil

from gfmd_numba.campaign.axes import OF_THE_SCENE, doubt_of_numbers, in_fields, values_of
from gfmd_numba.campaign.cases import (
    Block,
    Case,
    Measurements,
    block_bytes,
    blocks,
    demand,
    distinct,
    expand,
    measured_scenes,
    said_of,
    split,
)
from gfmd_numba.campaign.cluster import Cluster
from gfmd_numba.campaign.coordinates import coordinates, described_coordinates
from gfmd_numba.campaign.cost import Cost, predict
from gfmd_numba.campaign.execution import Task, compile_kernels
from gfmd_numba.campaign.file import Campaign, load_campaign
from gfmd_numba.campaign.shards import Finished
from gfmd_numba.campaign.validity import least_resolved, rough_body_warnings, unresolved_law_warning
from gfmd_numba.contact import relative_softening
from gfmd_numba.contact.observables import OBSERVABLES, PATH_OBSERVABLES
from gfmd_numba.contact.problem import Effect, Problem
from gfmd_numba.scene import Document, InputError
from gfmd_numba.scene.document import Location, Source

PROGRAM_BYTES = 200_000_000  # of each process, without any work
_TASK_SECONDS = 10.0  # dask needs milliseconds a task; a worker that dies costs a task
_TASKS_PER_WORKER = 16  # so that all end at about the same time


def check_resolved(document: Document, campaign: Campaign, cases: Sequence[Case]) -> None:
    """Raise InputError, at the value of the grid that causes it, for a case that does not resolve its law at all."""
    if not campaign.scene.interface.reaches_across:
        return
    worst = least_resolved(cases)

    def locate(location: Location) -> Location:
        for axis in OF_THE_SCENE:
            values = values_of(campaign.grid, axis.name)
            if values and ("scene", *in_fields(campaign.scene, axis.place)) == location:
                return ("grid", axis.name, values.index(axis.value(worst.scene, worst.discretisation)))
        return location

    relative_softening.check_resolved(document, worst.scene.interface, worst.problem, worst.discretisation, locate)


def refused_limits(campaign: Campaign, cases: Sequence[Case]) -> list[str]:
    """Return a sentence for each reason why the fit will refuse the limit; none for a campaign without limits."""
    import xarray as xr

    from gfmd_numba.analysis.extrapolation import refusals

    if all(case.limit == "reference" for case in cases):
        return []
    coordinates, ones = described_coordinates(cases[0].scene, list(cases)), np.ones((len(cases), 1))
    found = []
    for fit, _ in campaign.fits():
        described = xr.Dataset({fit.variable: (("case", "realisation"), ones)}, coordinates)
        for reason, count in refusals(described, fit.variable, fit.exponents, fit.options["fixed"]).items():
            groups = f"{count} group{'s' * (count > 1)} of cases"
            found.append(f"a run will print no limit of {fit.variable} ({groups}): {'; '.join(reason.splitlines())}")
    return found


@dataclass(frozen=True)
class Plan:
    """A campaign, its cases, and what was measured of their surfaces."""

    campaign: Campaign
    document: Document
    cases: list[Case]
    measured: Measurements = field(default_factory=dict)

    def changed(self, **update: Any) -> "Plan":
        """Return the plan of the campaign with other values of its keys."""
        campaign = self.campaign.model_copy(update=update)
        return replace(self, campaign=campaign, cases=expand(campaign, self.measured, self.document))

    @cached_property
    def problems(self) -> list[Problem]:
        """Distinct problems among the cases, the largest grids first."""
        return distinct(self.cases)

    @property
    def blocks(self) -> Iterator[Block]:
        """All blocks of work of a run that begins anew."""
        return (block for problem in self.problems for block in blocks(problem, self.demand[problem.identity]))

    def blocks_in(self, directory: Path) -> list[Block]:
        """Return all blocks of work in an output directory; those of finished shards stay as they are."""
        return list(split(self.cases, Finished(directory).ranges()))

    @cached_property
    def demand(self) -> dict[str, int]:
        """Realisations wanted of each problem, by its identity."""
        return demand(self.cases)

    @property
    def effects(self) -> tuple[Effect, ...]:
        """What became of the effects of all scenes, each once."""
        return tuple(dict.fromkeys(effect for case in self.cases for effect in case.effects))

    @property
    def validity(self) -> str:
        """Warnings about the results: implausible numbers or surfaces, or laws that a grid does not resolve."""
        implausible = said_of(self.measured, "doubts")
        scene = self.campaign.scene.model_copy(update={"length": self.cases[0].scene.length})  # that a file tells
        numbers = doubt_of_numbers(scene, self.campaign.grid, self.campaign.path)
        return "\n".join(
            filter(None, (numbers, *implausible, rough_body_warnings(self.cases), unresolved_law_warning(self.cases)))
        )

    @property
    def file_bytes(self) -> int:
        """Size of the results in bytes, before compression."""
        n_loads = self.problems[0].n_loads
        rows = len(OBSERVABLES) + (len(PATH_OBSERVABLES) if n_loads > 1 else 0)
        return 8 * rows * n_loads * len(self.cases) * max(self.demand.values())

    @property
    def worker_bytes(self) -> int:
        """Largest memory in bytes that a block takes of its worker."""
        return _largest(self.blocks)

    @property
    def shared(self) -> dict[tuple[str, ...], int]:
        """How many cases share the problem of another case, by the parameters in which the two differ."""
        if len(self.problems) == len(self.cases):
            return {}
        columns = coordinates(self.cases)
        del columns["case_id"], columns["is_reference"]
        members: dict[str, list[int]] = {}
        for i, case in enumerate(self.cases):
            members.setdefault(case.problem.identity, []).append(i)
        reasons: Counter[tuple[str, ...]] = Counter()
        for group in members.values():
            if len(group) > 1:
                differing = [name for name, column in columns.items() if len({column[i] for i in group}) > 1]
                reasons[tuple(differing)] += len(group) - 1
        return dict(reasons)

    def predicted_cost(self, budget: float) -> Cost:
        """Return the cost of the contacts on this machine, from a pilot of at most `budget` seconds."""
        wanted = [self.demand[problem.identity] for problem in self.problems]
        return predict(self.problems, wanted, budget, compile_kernels, self.campaign.case_timeout)

    def wall_time(self, cost: Cost, cpu_seconds: float, workers: int) -> float:
        """Return the time in s that workers need for some processor time, at least that of the longest block."""
        longest = max(cost.seconds[block.problem.identity] * block.size for block in self.blocks)
        return max(cpu_seconds / max(1, workers), longest)


def plan(source: Source | Campaign, target: Mapping[str, float] | None = None) -> Plan:
    """Return the plan of a campaign file or mapping, with another target if one is given; raises InputError."""
    campaign, document = load_campaign(source, target)
    measured = measured_scenes(campaign, document)
    scenes = {(each.dimension, each.period): each.under(campaign.scene) for each in measured.values()}
    if len(scenes) == 1:
        campaign = campaign.model_copy(update={"scene": next(iter(scenes.values()))})
    cases = expand(campaign, measured, document)
    check_resolved(document, campaign, cases)
    return Plan(campaign, document, cases, measured)


def check_memory(todo: Iterable[Block], workers: int) -> None:
    """Raise InputError unless that many local workers (0: this process) can solve blocks in the memory that is free."""
    available = psutil.virtual_memory().available
    block = _largest(todo)
    processes = 1 + workers  # the program itself, too
    if max(1, workers) * block + processes * PROGRAM_BYTES <= available:
        return
    most = (available - PROGRAM_BYTES) // (block + PROGRAM_BYTES)
    smaller = "a coarser grid: a larger eps_c, eps_f or eps_t"
    if most >= 1:
        remedy = f"at most {most}"
    elif block + PROGRAM_BYTES <= available:
        remedy = "0, this process alone"
    else:
        remedy = f"a machine with {(block + PROGRAM_BYTES) / 1e9:.1f} GB free"
    raise InputError.of(
        "--workers",
        f"{workers}, each with up to {block / 1e9:.1f} GB, {max(1, workers) * block / 1e9:.1f} GB in all, where "
        f"{available / 1e9:.1f} GB of memory are free",
        f"{remedy}, or {smaller}",
    )


def check_memory_of_jobs(todo: Iterable[Block], cluster: Cluster) -> None:
    """Raise InputError unless the workers of a job can solve blocks in its memory."""
    needed = cluster.cores * (_largest(todo) + PROGRAM_BYTES)
    if needed > cluster.memory:
        raise InputError.of(
            "--cluster",
            f"jobs of {cluster.memory / 1e9:.3g} GB for {cluster.cores} workers",
            f"a memory of at least {needed / 1e9:.2g} GB, fewer cores, or a coarser grid: a larger eps_c, eps_f or "
            "eps_t",
        )


def _largest(todo: Iterable[Block]) -> int:
    return max((block_bytes(block.problem, block.size) for block in todo), default=0)


def tasks(todo: list[Block], cost: Cost, workers: int) -> list[Task]:
    """Group blocks into tasks of about equal predicted time, the longest blocks first."""
    seconds = {block.name: cost.seconds[block.problem.identity] * block.size for block in todo}
    target = min(_TASK_SECONDS, sum(seconds.values()) / (_TASKS_PER_WORKER * max(1, workers)))
    grouped: list[list[Block]] = []
    filled = target
    for block in sorted(todo, key=lambda block: -seconds[block.name]):
        if filled + seconds[block.name] > target:
            grouped.append([])
            filled = 0.0
        grouped[-1].append(block)
        filled += seconds[block.name]
    return [tuple(group) for group in grouped]
