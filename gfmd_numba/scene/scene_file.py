"""Scene files, nested or flat, and the checks that need more than their records."""

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from gfmd_numba.scene.body_record import Body
from gfmd_numba.scene.boundary_records import Boundary
from gfmd_numba.scene.document import Document, InputError, Location, brief, read_document
from gfmd_numba.scene.records import Discretisation, Scene, SceneFile
from gfmd_numba.scene.surfaces import Measured, Surface
from gfmd_numba.scene.validation import nearest, validate

ARRAYS_PER_REALISATION = {1: 16, 2: 24}  # of its size, for a profile and a map
PROFILE_SUFFIXES = (".npy", ".csv", ".nc")
BOUNDARY_SUFFIXES = (".npy", ".csv")
_TOP_LEVEL = {*SceneFile.model_fields, "points"}  # of scenes with a punch and without one


def check_discretisation(
    document: Document,
    discretisation: Discretisation,
    locations: Mapping[str, Location],
    varied: str | None = None,
    dimension: int = 1,
) -> None:
    """Raise InputError, at the varied value if any, unless waves are whole and the grid fits in memory."""
    import psutil

    eps = discretisation.model_dump()
    nx = discretisation.waves["eps_c"]
    nodes = nx * nx if dimension == 2 else nx  # a power of floats raises where their product is infinite
    needed, available = 8 * nodes * ARRAYS_PER_REALISATION[dimension] / 1e9, psutil.virtual_memory().total / 1e9
    if needed > available:
        axis = varied or min(eps, key=eps.__getitem__)
        raise document.error(
            locations[axis],
            document.value(locations[axis]),
            f"a grid that fits in {available:.3g} GB of memory, where nx = {nx:.6g} needs {needed:.3g} GB",
        )
    misfit = discretisation.misfit
    if misfit is not None:
        axis = varied or misfit
        others = " and ".join(f"{name} = {value:.6g}" for name, value in eps.items() if name != axis)
        fit = discretisation.nearest_fit(axis)
        raise document.error(
            locations[axis],
            document.value(locations[axis]),
            "a value that makes 1/eps_t, 1/(eps_t eps_f) and nx = 2/(eps_t eps_f eps_c) whole numbers, "
            f"nx at least 4, with {others}",
            "" if fit is None else f"did you mean {fit}?",
        )


def check_surfaces(document: Document, scene: Scene) -> None:
    """Raise InputError for surfaces whose own points do not fit in memory."""
    for place, surface in scene.surfaces.items():
        if surface.points is not None:
            _check_memory(document, ("scene", *place, "points"), surface.points, scene.dimension)


def _check_memory(document: Document, location: Location, points: int, dimension: int) -> None:
    import psutil

    needed = 8 * float(points) ** dimension * ARRAYS_PER_REALISATION[dimension] / 1e9
    available = psutil.virtual_memory().total / 1e9
    if needed > available:
        allowed = f"a grid that fits in {available:.3g} GB of memory, where this needs {needed:.3g} GB"
        raise document.error(location, points, allowed)


def check_anisotropy_fits(
    document: Document, anisotropy: float, location: Location, discretisation: Discretisation
) -> None:
    """Raise InputError unless the longest wavelength along y, L_x eps_t anisotropy, fits the period."""
    most = 1 / discretisation.eps_t
    if anisotropy > most * (1 + 1e-9):
        raise document.error(
            location,
            anisotropy,
            f"at most 1/eps_t = {most:.6g}, so that the longest wavelength along y fits the period; "
            "a smaller eps_t allows more",
        )


def check_range(document: Document, scene: Scene, nx: int, location: Location | None = None) -> None:
    """Raise InputError if an interaction length is below the grid spacing, which would not resolve its effect.

    `location` is where the length stands in the file, if not in the scene.
    """
    spacing = (scene.length or 1.0) / nx
    reaching = {name: law for name, law in scene.interface.laws.items() if law.across_open_gap}
    for law, record in reaching.items():
        for name, value in record:
            if name != "work_of_adhesion" and value < spacing:
                raise document.error(
                    location or ("scene", "interface", law, name),
                    value,
                    f"at least the grid spacing {spacing:.3g}: a longer range or a finer grid",
                )


def load_scene(source: str | Path | Mapping[str, Any] | SceneFile) -> SceneFile:
    """Checked scene of a YAML file, nested or flat, a mapping or a record; raises InputError."""
    document = scene_document(source)
    scene_file = source if isinstance(source, SceneFile) else validate(document, SceneFile)
    if scene_file.discretisation is not None:
        axes = Discretisation.model_fields
        locations = {axis: ("discretisation", axis) for axis in axes}
        check_discretisation(document, scene_file.discretisation, locations, dimension=scene_file.scene.dimension)
        check_range(document, scene_file.scene, scene_file.discretisation.nx)
        anisotropy = getattr(scene_file.scene.roughness, "anisotropy", None)
        if anisotropy is not None and scene_file.scene.dimension == 2:
            location = ("scene", "roughness", "anisotropy")
            check_anisotropy_fits(document, anisotropy, location, scene_file.discretisation)
    scene = scene_file.scene
    check_surfaces(document, scene)
    for surface in scene.surfaces.values():
        if surface.points is not None:
            check_range(document, scene, surface.points)
    located: dict[str, object] = {"roughness": _located(document, ("scene", "roughness"), scene.roughness)}
    for name in ("body", "counter_body"):
        body: Body | None = getattr(scene, name)
        if body is not None:
            profile = _located(document, ("scene", name, "roughness"), body.roughness)
            located[name] = body.model_copy(update={"roughness": profile})
    if scene.boundary is not None:
        located["boundary"] = located_boundary(document, scene.boundary)
    return scene_file.model_copy(update={"scene": scene.model_copy(update=located)})


def _located(document: Document, location: Location, roughness: Surface | None) -> Surface | None:
    """Roughness whose file, if any, exists and has an absolute path; raises InputError."""
    if not isinstance(roughness, Measured):
        return roughness
    file = existing_file(document, (*location, "file"), roughness.file, PROFILE_SUFFIXES)
    return roughness.model_copy(update={"file": file})


def located_boundary(document: Document, boundary: Boundary) -> Boundary:
    """Boundary whose files exist and have absolute paths; raises InputError."""
    names = {name: value for name, value in boundary if isinstance(value, str)}
    return boundary.model_copy(
        update={
            name: existing_file(document, ("scene", "boundary", name), value, BOUNDARY_SUFFIXES)
            for name, value in names.items()
        }
    )


def scene_document(source: str | Path | Mapping[str, Any] | SceneFile) -> Document:
    """Document behind a scene, for messages that say where its values stand; raises InputError."""
    if isinstance(source, SceneFile):
        return Document(None, "", source.model_dump())
    return _nested(document_of(source, "scene"))


def document_of(source: object, name: str) -> Document:
    """Document of a YAML file or a mapping; raises InputError, by the argument's name, for anything else."""
    if isinstance(source, Mapping):
        return Document(None, "", dict(source))
    if isinstance(source, str | os.PathLike):
        return read_document(Path(source))
    raise InputError(f"{name}: given {brief(source)}; allowed: the path of a YAML file, or a mapping of its content")


def _nested(document: Document) -> Document:
    """Document with a flat file's scene gathered under `scene`, its positions with it."""
    data = document.data
    if not isinstance(data, dict) or "scene" in data or not any(key in Scene.model_fields for key in data):
        return document

    def home(location: Location) -> Location:
        return location if not location or location[0] in _TOP_LEVEL else ("scene", *location)

    nested: dict[str, Any] = {"scene": {}}
    for key, value in data.items():
        (nested if key in _TOP_LEVEL else nested["scene"])[key] = value
    return replace(
        document,
        data=nested,
        positions={home(location): at for location, at in document.positions.items()},
        key_positions={home(location): at for location, at in document.key_positions.items()},
        flat=True,
    )


def existing_file(document: Document, location: Location, name: str, suffixes: tuple[str, ...]) -> str:
    """Absolute path of an existing file of a known kind (any, if none is named), relative to the document's folder."""
    folder = Path() if document.path is None else document.path.parent
    file = folder / name
    if suffixes and file.suffix not in suffixes:
        raise document.error(location, name, "a file ending in " + ", ".join(suffixes))
    if not os.path.isfile(file):
        kind = "the folder " if os.path.isdir(file) else "no regular file " if os.path.exists(file) else ""
        hint = nearest(name, _files(folder, suffixes))
        raise document.error(location, name, f"an existing file, unlike {kind}{file}", hint)
    return os.path.abspath(file)  # a link keeps its name, which tells the kind


def _files(folder: Path, suffixes: tuple[str, ...]) -> list[str]:
    """Names of the files of a kind in a folder, none if it may not be looked into."""
    try:
        return [each.name for each in folder.iterdir() if (not suffixes or each.suffix in suffixes) and each.is_file()]
    except OSError:
        return []
