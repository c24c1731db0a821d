"""The netCDF file of a campaign, collected at any time from the shards that are finished."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from gfmd_numba.campaign import failures, rounds
from gfmd_numba.campaign.cases import Block, Case, said_of
from gfmd_numba.campaign.coordinates import described_coordinates, steps_of_paths
from gfmd_numba.campaign.execution import SECONDS
from gfmd_numba.campaign.failures import SENTENCES, Ending, Failure
from gfmd_numba.campaign.plan import Plan
from gfmd_numba.campaign.provenance import content_digest, doubt, git_commit, joined, machine, versions
from gfmd_numba.campaign.results import read_results
from gfmd_numba.campaign.shards import Finished
from gfmd_numba.campaign.validity import result_warnings
from gfmd_numba.contact import contact_dataset, observables, relative_softening
from gfmd_numba.contact.contact_dataset import Units, cf_attributes
from gfmd_numba.contact.load_path import recorded_of as recorded_of_problem
from gfmd_numba.contact.observables import Observable
from gfmd_numba.contact.problem import Problem
from gfmd_numba.solvers.status import flag_attributes
from gfmd_numba.storage import json_file
from gfmd_numba.storage.atomic_file import write_dataset
from gfmd_numba.text.input_error import InputError

NOTED = ("predicted_cpu_seconds_p50", "predicted_cpu_seconds_p90", "last_run_blocks", "last_run_seconds")
NOTES = "run.json"

Measures = dict[str, npt.NDArray[Any]]


def collect(planned: Plan, directory: Path) -> Path:
    """Write what the finished shards hold to the campaign's netCDF file; the rest is marked in `status`."""
    path = results_path(planned, directory)
    write_dataset(path, _assemble(planned, directory))
    return path


def results_path(planned: Plan, directory: Path) -> Path:
    """File of the results of a campaign in its output directory."""
    return directory / f"{planned.campaign.name}.nc"


def note(directory: Path, **values: float) -> None:
    """Store facts of a run, named in `NOTED`; the results file will have them as attributes."""
    json_file.write(directory / NOTES, noted(directory) | values)


def noted(directory: Path) -> dict[str, float]:
    """Return what was noted about the runs in a directory, as far as it is in `NOTED`."""
    facts = json_file.read(directory / NOTES)
    return {name: facts[name] for name in NOTED if name in facts}


def _assemble(planned: Plan, directory: Path) -> xr.Dataset:
    wanted = planned.demand
    longest = max(wanted.values())
    blocks, of_problem = planned.blocks_in(directory), dict[str, list[Block]]()
    for block in blocks:
        of_problem.setdefault(block.problem.identity, []).append(block)
    stored, failed = Finished(directory), failures.of_all(directory, [block.name for block in blocks])
    measured = {name: _measured(of_it, wanted[name], longest, stored, failed) for name, of_it in of_problem.items()}
    made_with = joined(filter(None, (stored.made_with(block.name) for block in blocks)))
    attributes = {
        **described(planned),
        "dropped_effects": contact_dataset.dropped_effects(planned.effects),
        "validity": "\n".join(filter(None, (planned.validity, doubt(made_with)))),
        **({"processing": "\n".join(said_of(planned.measured, "done"))} if planned.measured else {}),
        "n_distinct_problems": len(planned.problems),
        "versions": json.dumps(versions() | made_with),
        "git_commit": git_commit(),
        "machine": machine(),
        "threads": "1 for transforms and kernels in every worker",
        "fft_plans": "FFTW_ESTIMATE",
        "failures": "\n".join(f"{name} {failure.status}: {failure.reason}" for name, failure in failed.items()),
        "cpu_seconds": sum(float(values[SECONDS].sum()) for values in measured.values()),
        **noted(directory),
    }
    rows = recorded_of(planned.cases)
    values = []
    for case in planned.cases:
        worth, found = Units.of(case.scene, case.rms_gradient).worth, measured[case.problem.identity]
        values.append({name: contact_dataset.scaled(found[name], worth[row.unit]) for name, row in rows.items()})
    scene = planned.cases[0].scene  # measured ones tell their period
    coordinates = described_coordinates(scene, planned.cases) | steps_of_paths(planned.cases, planned.campaign.path)
    dataset = contact_dataset.campaign_dataset(coordinates, rows, values, Units.of(scene).names)
    dataset = dataset.assign_attrs(attributes | contact_dataset.modulus_attributes(planned.campaign.scene))
    dataset["status"].attrs |= flag_attributes(SENTENCES)
    dataset["case_seconds"] = (
        "case",
        [float(measured[case.problem.identity][SECONDS].sum()) for case in planned.cases],
        cf_attributes("processor time of the case, shared by all cases of one problem", "s"),
    )
    if scene.interface.reaches_across:
        softenings = [relative_softening.softening(case.problem) for case in planned.cases]
        dataset[relative_softening.NAME] = ("case", softenings, cf_attributes(relative_softening.LONG_NAME))
    made_in = rounds.read(directory)
    if made_in is not None and len(made_in.now.realisations) == len(planned.cases):
        dataset = dataset.assign(made_in.variables()).assign_attrs(made_in.attributes())
    warnings = result_warnings(planned.cases, planned.campaign.numerics, dataset)
    dataset.attrs["validity"] = "\n".join(filter(None, (dataset.attrs["validity"], *warnings)))
    dataset.attrs["content_sha256"] = content_digest(dataset)
    return dataset


def described(planned: Plan) -> dict[str, Any]:
    """Attributes of the results that follow from the campaign file alone."""
    campaign, text = planned.campaign, planned.document.text
    others = {fit.variable: fit.options for fit, _ in campaign.fits() if fit.variable != campaign.fit.variable}
    return {
        "title": campaign.name,
        "campaign": text,
        "campaign_sha256": hashlib.sha256(text.encode()).hexdigest(),
        **({} if campaign.seed is None else {"seed": campaign.seed}),
        "fit": campaign.fit.model_dump_json(exclude_none=True),
        **({} if campaign.target is None else {"target": json.dumps(campaign.target)}),
        **({"fits_of_targets": json.dumps(others)} if others else {}),
    }


def is_altered(file: Path, planned: Plan) -> bool:
    """Return whether the numbers in a file differ from their digest, or its attributes from the campaign file."""
    try:
        results = read_results(file)
    except InputError:
        return True
    said = results.attrs
    return content_digest(results) != said.get("content_sha256") or not all(
        name in said and np.array_equal(said[name], value) for name, value in described(planned).items()
    )


def recorded_of(cases: list[Case]) -> dict[str, Observable]:
    """Return the observables of all cases, and those that any case has along its path."""
    rows = recorded_of_problem(cases[0].problem)
    for case in cases if cases[0].problem.path else ():
        rough = case.problem.rough
        rows |= observables.recorded_along(case.scene, 0 if rough is None else rough.order)
    return rows


def _measured(
    blocks: list[Block], realisations: int, longest: int, stored: Finished, failed: Mapping[str, Failure]
) -> Measures:
    """Return the dimensionless measures `[longest]` of a problem from its blocks, and their seconds."""
    parts = []
    problem = blocks[0].problem
    names = (*recorded_of_problem(problem), *(observables.PATH_OBSERVABLES if problem.path else ()), SECONDS)
    for block in blocks:
        part = stored.read(block.name)
        if part is None:
            status = Ending[failed[block.name].status] if block.name in failed else Ending.unfinished
            part = _nothing(problem, block.size, status)
        asked, solved = realisations - block.first, block.size  # the shard may hold more
        parts.append({name: values[:asked] for name, values in part.items()})
        parts[-1][SECONDS] = part[SECONDS] * min(1.0, asked / solved)
    if longest > realisations:
        parts.append(_nothing(problem, longest - realisations, Ending.not_asked))
    return {name: np.concatenate([part[name] for part in parts]) for name in names}


def _nothing(problem: Problem, count: int, status: Ending) -> Measures:
    nothing: Measures = {
        name: np.full((count, problem.n_loads) if problem.path and row.of == "contact" else count, np.nan)
        for name, row in (
            observables.OBSERVABLES | observables.ROUGH_BODY_OBSERVABLES | observables.PATH_OBSERVABLES
        ).items()
    }
    nothing["status"] = np.full(count, status, dtype=np.int8)
    nothing[SECONDS] = np.zeros(1)
    for counted in ("n_iterations", "n_transforms"):
        nothing[counted] = np.zeros(count, dtype=np.int64)
    return nothing
