"""A campaign from its file to one netCDF file, resumable at any point."""

import hashlib
import json
import os
import platform
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from gfmd_numba.campaign import execution, shards
from gfmd_numba.campaign.cases import Case, Task, blocks, expand, tasks
from gfmd_numba.campaign.claim import claimed
from gfmd_numba.campaign.specification import Campaign, load_campaign
from gfmd_numba.dataset import campaign_dataset, dropped_effects, scaled, scales, units
from gfmd_numba.dynamics import Status
from gfmd_numba.observables import MEASURES
from gfmd_numba.problem import Effect, self_affine
from gfmd_numba.scene import Document

_PACKAGES = ("gfmd-numba", "numpy", "numba", "pyfftw", "scipy", "xarray", "netCDF4", "dask", "distributed")


@dataclass(frozen=True)
class Plan:
    """What a campaign comes to: its cases, and the tasks of the distinct problems behind them."""

    campaign: Campaign
    document: Document
    cases: list[Case]
    tasks: list[Task]

    @property
    def n_problems(self) -> int:
        """Number of distinct problems."""
        return len({case.problem.identity for case in self.cases})

    @property
    def effects(self) -> tuple[Effect, ...]:
        """What became of the effects of all scenes, each sentence once."""
        return tuple(dict.fromkeys(effect for case in self.cases for effect in case.effects))

    @property
    def file_bytes(self) -> int:
        """Size of the results, before compression."""
        return 8 * len(MEASURES) * len(self.cases) * self.campaign.realisations

    @property
    def worker_bytes(self) -> int:
        """Largest memory a task asks of its worker."""
        return max(16 * 8 * (task.stop - task.first) * task.problem.surface.nx for task in self.tasks)


def plan(path: str | Path) -> Plan:
    """Plan of a campaign file; raises InputError."""
    campaign, document = load_campaign(path)
    cases = expand(campaign)
    return Plan(campaign, document, cases, tasks(cases, campaign.realisations))


def run(
    path: str | Path,
    output: str | Path | None = None,
    workers: int = 2,
    scheduler: str | None = None,
    watch: Callable[[int, int], execution.Progress] | None = None,
) -> tuple[Path, execution.Failures]:
    """Run what is unfinished of a campaign and write its netCDF file into the output directory.

    `watch(total, done)` returns what to call after each task. Returns the file and the failed tasks; raises
    InputError for a bad campaign file or a directory that holds something else or another run.
    """
    planned = plan(path)
    directory = Path(output if output is not None else planned.campaign.name)
    with claimed(directory, planned.campaign.name, planned.document.text):
        todo = execution.unfinished(planned.tasks, directory)
        progress = watch(len(planned.tasks), len(planned.tasks) - len(todo)) if watch else lambda: None
        failures = execution.execute(todo, directory, workers, scheduler, progress)
        return collect(planned, directory), failures


def collect(planned: Plan, directory: Path) -> Path:
    """Write what the finished shards hold to the campaign's netCDF file; the rest is marked as crashed."""
    path = directory / f"{planned.campaign.name}.nc"
    temporary = path.with_suffix(".nc.tmp")
    _assemble(planned, directory).to_netcdf(temporary, engine="netcdf4")
    with open(temporary, "rb+") as file:
        os.fsync(file.fileno())
    os.replace(temporary, path)
    return path


def _assemble(planned: Plan, directory: Path) -> xr.Dataset:
    campaign = planned.campaign
    values = []
    for case in planned.cases:
        scale = scales(case.scene, self_affine(case.scene).rms_gradient)
        measured = _measured(case, campaign.realisations, directory)
        values.append({m.name: scaled(measured[m.name], scale[m.unit]) for m in MEASURES})
    text = planned.document.text
    attributes = {
        "title": campaign.name,
        "campaign": text,
        "campaign_sha256": hashlib.sha256(text.encode()).hexdigest(),
        "seed": campaign.seed,
        "fit": campaign.fit.model_dump_json(exclude_none=True),
        "dropped_effects": dropped_effects(planned.effects),
        "n_distinct_problems": planned.n_problems,
        "versions": json.dumps({name: version(name) for name in _PACKAGES}),
        "machine": f"{platform.machine()}, {os.cpu_count()} CPUs, Python {platform.python_version()}",
    }
    return campaign_dataset(_coordinates(planned.cases), values, units(campaign.scene), attributes)


def _measured(case: Case, realisations: int, directory: Path) -> dict[str, npt.NDArray[Any]]:
    """Measures of a case `[realisation]` from its shards, dimensionless."""
    parts = []
    for task in blocks(case.problem, realisations):
        part = shards.read(execution.shard_path(directory, task))
        parts.append(part if part is not None else _nothing(task.stop - task.first))
    return {m.name: np.concatenate([part[m.name] for part in parts]) for m in MEASURES}


def _nothing(count: int) -> dict[str, npt.NDArray[Any]]:
    nothing: dict[str, npt.NDArray[Any]] = {m.name: np.full(count, np.nan) for m in MEASURES}
    nothing["status"] = np.full(count, Status.crashed, dtype=np.int8)
    for counted in ("n_iterations", "n_transforms"):
        nothing[counted] = np.zeros(count, dtype=np.int64)
    return nothing


def _coordinates(cases: list[Case]) -> dict[str, list[Any]]:
    return {
        "case_id": [case.problem.identity for case in cases],
        "limit": [case.limit for case in cases],
        "is_reference": [case.limit == "reference" for case in cases],
        "eps_c": [case.discretisation.eps_c for case in cases],
        "eps_f": [case.discretisation.eps_f for case in cases],
        "eps_t": [case.discretisation.eps_t for case in cases],
        "hurst": [self_affine(case.scene).hurst for case in cases],
        "poissons_ratio": [case.scene.body.poissons_ratio for case in cases],
        "aspect_ratio": [case.scene.body.aspect_ratio for case in cases],
        "reduced_pressure": [
            np.nan if case.problem.mean_pressure is None else case.problem.mean_pressure for case in cases
        ],
        "rms_gradient_target": [self_affine(case.scene).rms_gradient for case in cases],
        "nx": [case.discretisation.nx for case in cases],
    }
