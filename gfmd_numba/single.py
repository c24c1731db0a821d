"""One contact from a scene file to a dataset."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from gfmd_numba import contact, problem
from gfmd_numba.dataset import contact_dataset
from gfmd_numba.roughness.measured import read_profile
from gfmd_numba.scene import InputError, Measured, SceneFile, load_scene


def solve_scene(source: str | Path | Mapping[str, Any] | SceneFile) -> xr.Dataset:
    """Fields `height, pressure, displacement, gap` over `x` and the scalars of one contact, in SI units.

    Raises InputError for a scene that makes no sense; a run that fails says so in `status`.
    """
    file = load_scene(source)
    scene = file.scene
    surface, rms_gradient = _surface(file)
    reduced, dropped = problem.reduce(scene, surface, rms_gradient, file.numerics)
    solved = contact.solve(reduced, range(file.realisation, file.realisation + 1))
    dataset = contact_dataset(scene, reduced, rms_gradient, solved)
    dataset.attrs["scene"] = file.model_dump_json()
    dataset.attrs["solver"] = reduced.numerics.solver
    dataset.attrs["dropped_effects"] = "\n".join(dropped)
    return dataset


def _surface(file: SceneFile) -> tuple[problem.RandomSurface | problem.Profile, float]:
    scene = file.scene
    if isinstance(scene.roughness, Measured):
        return _profile(scene.roughness, scene.length)
    assert file.discretisation is not None  # load_scene's promise
    return problem.random_surface(scene, file.discretisation, file.seed), scene.roughness.rms_gradient


def _profile(roughness: Measured, length: float | None) -> tuple[problem.Profile, float]:
    try:
        return problem.profile(read_profile(Path(roughness.file)) / (length or 1.0))
    except ValueError as error:
        raise InputError(
            f"{roughness.file}: scene.roughness.file: given {error}; "
            "allowed: equidistant finite heights over one period, not all equal"
        ) from None
