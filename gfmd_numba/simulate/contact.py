"""One contact from a scene file to a dataset."""

import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from gfmd_numba.contact import law_resolution, problem, solution, two_step
from gfmd_numba.contact.dataset import contact_dataset, dropped_effects, indexed, load_attributes
from gfmd_numba.contact.refusal import check_combination
from gfmd_numba.contact.tractions import Tractions, balanced, read_boundary, tractions
from gfmd_numba.roughness.generators import RandomSurface
from gfmd_numba.roughness.measured import measured_profile
from gfmd_numba.scene import InputError, Measured, Scene, SceneFile, check_range, load_scene, scene_document
from gfmd_numba.simulate import rough_bodies as rough_scene


def solve_scene(source: str | Path | Mapping[str, Any] | SceneFile) -> xr.Dataset:
    """Fields `height, pressure, displacement, gap` over `x` and the scalars of one contact, in SI units.

    Raises InputError for a scene that makes no sense; a run that fails says so in `status`.
    """
    file = load_scene(source)
    scene = file.scene
    check_combination(scene_document(source), scene, file.numerics, file.path)
    rough, surface, rms_gradient = _surfaces(source, file)
    prescribed = _tractions(source, scene, surface.nx, rms_gradient)
    steps, before = [], None
    for i, (scene, sliding) in enumerate(_path(file)):
        reduced, effects = problem.reduce(scene, surface, rms_gradient, file.numerics, prescribed)
        if rough is not None:
            pressed = two_step.solve(reduced, rough.bodies, rms_gradient, file.numerics.slope_order, before)
            before = pressed.contact.equilibrium
            steps.append(rough_scene.dataset(scene, reduced, rough, pressed))
            continue
        sliding /= (scene.length or 1.0) * rms_gradient
        solved = solution.solve(reduced, range(file.realisation, file.realisation + 1), before, sliding)
        if reduced.displacement is not None and reduced.body.has_rigid_mean and solved.punch.mean() < 0.0:
            place = ("path", i - 1, "displacement") if i else ("scene", "loading", "displacement")
            most = reduced.displacement + float(solved.punch.mean())
            raise scene_document(source).error(
                place,
                scene.loading.displacement,
                f"at most {most * rms_gradient * (scene.length or 1.0):.6g}, where this punch has no more room "
                "for an incompressible body",
            )
        before = solved.equilibrium
        steps.append(contact_dataset(scene, reduced, rms_gradient, solved))
    dataset = steps[0] if not file.path else _joined(steps, list(_path(file)))
    dataset.attrs["scene"] = file.model_dump_json()
    dataset.attrs["solver"] = reduced.numerics.solver
    dataset.attrs["dropped_effects"] = dropped_effects(effects)
    steep = "" if rough is None else rough_scene.doubt(rough, dataset)
    doubts = [sentence for sentence in (steep, law_resolution.doubt(reduced, file.discretisation)) if sentence]
    for sentence in doubts:
        warnings.warn(sentence, stacklevel=3)
    dataset.attrs["validity"] = "\n".join(doubts)
    return dataset


def doubt(source: str | Path | Mapping[str, Any] | SceneFile) -> str:
    """What is to be said of the interaction law of a scene before it is solved; nothing without doubt.

    Raises InputError as `solve_scene` does for surfaces that cannot be used.
    """
    file = load_scene(source)
    if not file.scene.interface.reaches_across:
        return ""
    _, surface, rms_gradient = _surfaces(source, file)
    reduced, _ = problem.reduce(file.scene, surface, rms_gradient, file.numerics)
    return law_resolution.doubt(reduced, file.discretisation)


def _surfaces(
    source: str | Path | Mapping[str, Any] | SceneFile, file: SceneFile
) -> tuple[rough_scene.Surfaces | None, RandomSurface | problem.Profile, float]:
    """The rough deformable bodies, if any, the surface of the problem, and the rms gradient g it is in units of."""
    rough = rough_scene.surfaces(file, scene_document(source)) if file.scene.follows_topography else None
    try:
        surface, rms_gradient = _surface(file) if rough is None else (rough.profile, rough.rms_gradient)
    except ValueError as error:
        raise _unusable_profile(source, file.scene, error) from None
    check_range(scene_document(source), file.scene, surface.nx)
    return rough, surface, rms_gradient


def _joined(steps: list[xr.Dataset], path: list[tuple[Scene, float]]) -> xr.Dataset:
    """The steps of a path, with what was prescribed in each as coordinates."""
    joined = xr.concat(
        steps, "step", data_vars="all", coords="minimal", compat="override", join="exact", combine_attrs="override"
    )
    prescribed = [scene.loading.model_dump(exclude_none=True) | {"sliding": sliding} for scene, sliding in path]
    names = {"displacement": "punch_displacement"}  # the body's own has the short name
    attributes = load_attributes(path[0][0])
    return indexed(joined).assign_coords(
        {
            names.get(name, name): ("step", [each[name] for each in prescribed], attributes[names.get(name, name)])
            for name in prescribed[0]
        }
    )


def _path(file: SceneFile) -> Iterator[tuple[Scene, float]]:
    """The scene and the sliding displacement at its own loading, then after each change of the path."""
    scene, sliding = file.scene, 0.0
    yield scene, sliding
    for step in file.path:
        changes = step.model_dump(exclude_none=True)
        sliding = changes.pop("sliding", sliding)
        scene = scene.model_copy(update={"loading": scene.loading.model_copy(update=changes)})
        yield scene, sliding


def _surface(file: SceneFile) -> tuple[RandomSurface | problem.Profile, float]:
    scene = file.scene
    if isinstance(scene.roughness, Measured):
        return problem.profile(measured_profile(scene.roughness, scene.length))
    return problem.random_surface(scene, file.discretisation, file.seed)


def _tractions(
    source: str | Path | Mapping[str, Any] | SceneFile, scene: Scene, nx: int, rms_gradient: float
) -> Tractions | None:
    """Tractions the scene prescribes; raises InputError for a mean that nothing, or the loading already, decides."""
    if scene.boundary is None:
        return None
    document = scene_document(source)
    arrays = read_boundary(document, scene.boundary, nx)
    if scene.loading.reduced_pressure is not None:
        arrays = balanced(document, arrays, "normal", "as loading.reduced_pressure prescribes the mean pressure")
    if scene.body.is_half_space:
        arrays = balanced(document, arrays, "tangential", f"or {scene.body.holder}, as nothing holds a half-space")
    scale = rms_gradient * problem.effective_modulus(scene.body)
    tangential, normal = (
        np.nan_to_num(arrays.get(f"{component}_traction", np.zeros(nx)), nan=0.0) / scale
        for component in ("tangential", "normal")
    )
    return tractions(tangential, normal)


def _unusable_profile(
    source: str | Path | Mapping[str, Any] | SceneFile, scene: Scene, error: ValueError
) -> InputError:
    if not isinstance(scene.roughness, Measured):
        document, place = scene_document(source), ("scene", "roughness")
        return document.error(place, document.value(place), f"a usable surface, not {error}")
    given = f"{Path(scene.roughness.file).name} ({error})"
    unit = "L_x" if scene.length is None else "m"
    allowed = f"at least 4 equidistant finite heights in {unit} over one period, not all equal"
    return InputError(scene_document(source).line(("scene", "roughness", "file"), given, allowed))
