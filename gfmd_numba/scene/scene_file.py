"""Scene files, nested or flat: a contact, or a loaded body without a punch."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from gfmd_numba.scene.body_record import Body
from gfmd_numba.scene.checks import (
    arrays_of_a_loaded_body,
    arrays_of_memory,
    arrays_of_path,
    arrays_per_realisation,
    check_anisotropy_fits,
    check_discretisation,
    check_surfaces,
)
from gfmd_numba.scene.document import Document, Location, Source, document_of, existing_file, validate
from gfmd_numba.scene.interface_records import Interface, LawOfTheGap
from gfmd_numba.scene.measured_record import Measured
from gfmd_numba.scene.quantities import FILES
from gfmd_numba.scene.records import Boundary, BoundaryFile, Discretisation, LoadedBody, Scene, SceneFile
from gfmd_numba.scene.surfaces import Surface
from gfmd_numba.text.input_error import InputError

_OF_A_PUNCH = {"roughness", "form", "interface", "loading"}
_TOP_LEVEL = {*SceneFile.model_fields, "points"}  # of scenes with a punch and without one
_OF_CAMPAIGNS = ("realisations", "reference", "limits", "grid", "fit", "target")


def load_scene(source: Source | SceneFile | BoundaryFile) -> tuple[SceneFile | BoundaryFile, Document]:
    """Checked contact or loaded body of a YAML file, nested or flat, a mapping or a record, and the document itself.

    Raises InputError.
    """
    if isinstance(source, SceneFile | BoundaryFile):
        document = Document(None, "", source.model_dump())
        return _checked(source, document), document
    document = _nested(document_of(source, "scene"))
    campaign = [key for key in _OF_CAMPAIGNS if isinstance(document.data, dict) and key in document.data]
    if len(campaign) > 1:  # one alone may be a slip
        allowed = "the keys of a scene; gfmd run and gfmd plan take a campaign"
        raise InputError(document.key_line((campaign[0],), "a key of campaigns", allowed))
    kind: type[SceneFile | BoundaryFile] = BoundaryFile if _has_no_punch(document) else SceneFile
    return _checked(validate(document, kind), document), document


def with_heights(source: Source | SceneFile | BoundaryFile, heights: Any) -> Document:
    """Document of a scene whose punch has heights of an array, treated as its `roughness` says if it has one.

    Raises InputError, as `load_scene` does for what it makes of the document.
    """
    given = source.model_dump(exclude_unset=True) if isinstance(source, SceneFile | BoundaryFile) else source
    document = _nested(document_of(given, "scene"))
    data = document.data
    if not isinstance(data, dict) or not isinstance(data.get("scene"), dict):
        return document
    treatment = data["scene"].get("roughness") or {}
    if not isinstance(treatment, Mapping) or "file" in treatment or treatment.get("method", "measured") != "measured":
        place = ("scene", "roughness")
        raise document.refused(place, "nothing with heights but keys that say how to treat them")
    surface = {**treatment, "method": "measured", "heights": heights}
    return replace(document, data={**data, "scene": {**data["scene"], "roughness": surface}})


def input_files(file: SceneFile | BoundaryFile) -> list[Path]:
    """Files that a loaded scene reads."""
    named = [value for _, value in file.scene.boundary or () if isinstance(value, str)]
    measured = [surface for surface in file.scene.surfaces.values() if isinstance(surface, Measured)]
    if isinstance(file.scene, Scene) and (law := file.scene.interface.law_of_the_gap) is not None:
        named += [law.pattern] if law.pattern is not None else []
    named += [surface.file for surface in measured if surface.file is not None]
    return [Path(name) for name in named]


def _has_no_punch(document: Document) -> bool:
    data = document.value(("scene",))
    return isinstance(data, dict) and "boundary" in data and not _OF_A_PUNCH & data.keys()


def _checked(file: SceneFile | BoundaryFile, document: Document) -> SceneFile | BoundaryFile:
    """The same, whose files exist and have absolute paths."""
    _check_grid(file, document)
    scene = file.scene.model_copy(update=located_files(document, file.scene))
    return file.model_copy(update={"scene": scene})


def _check_grid(file: SceneFile | BoundaryFile, document: Document) -> None:
    scene = file.scene
    if isinstance(file, SceneFile):
        laws = [*file.scene.interface.laws, *(() if scene.boundary is None else ("boundary",))]
        arrays = arrays_per_realisation(scene.dimension, laws, file.scene.ends)
        arrays += arrays_of_path(scene.dimension, laws, len(file.path)) + arrays_of_memory(file.scene)
    else:
        arrays = arrays_of_a_loaded_body(scene.dimension, file.slope_order)
    if file.discretisation is not None:
        locations = {axis: ("discretisation", axis) for axis in Discretisation.model_fields}
        check_discretisation(document, file.discretisation, locations, (), scene.dimension, arrays)
        for place, surface in scene.surfaces.items():
            anisotropy = getattr(surface, "anisotropy", None)
            checked = place == ("roughness",) or isinstance(file, BoundaryFile)
            if anisotropy is not None and scene.dimension == 2 and checked:
                check_anisotropy_fits(document, anisotropy, ("scene", *place, "anisotropy"), file.discretisation)
    check_surfaces(document, scene, arrays)


def located_files(document: Document, scene: Scene | LoadedBody) -> dict[str, object]:
    """Parts of a scene by name, whose files have absolute paths; raises InputError for one that does not exist."""
    located: dict[str, object] = {}
    if isinstance(scene, Scene):
        located["interface"] = located_interface(document, scene.interface)
        located["roughness"] = located_surface(document, ("scene", "roughness"), scene.roughness)
    for name in ("body", "counter_body"):
        body: Body | None = getattr(scene, name, None)
        if body is not None:
            surface = located_surface(document, ("scene", name, "roughness"), body.roughness)
            located[name] = body.model_copy(update={"roughness": surface})
    if scene.boundary is not None:
        located["boundary"] = located_boundary(document, scene.boundary)
    return located


def located_surface(document: Document, location: Location, surface: Surface | None) -> Surface | None:
    """The same, whose file has an absolute path; raises InputError for one that does not exist."""
    if not isinstance(surface, Measured) or surface.file is None:
        return surface
    file = existing_file(document, (*location, "file"), surface.file, ())
    return surface.model_copy(update={"file": file})


def located_interface(document: Document, interface: Interface) -> Interface:
    """Interface whose files have absolute paths; raises InputError for one that does not exist."""
    patterns = {
        name: law.model_copy(
            update={"pattern": existing_file(document, ("scene", "interface", name, "pattern"), law.pattern, FILES)}
        )
        for name, law in interface.laws.items()
        if isinstance(law, LawOfTheGap) and law.pattern is not None
    }
    return interface.model_copy(update=patterns) if patterns else interface


def located_boundary(document: Document, boundary: Boundary) -> Boundary:
    """Boundary whose files have absolute paths; raises InputError for one that does not exist."""
    return boundary.model_copy(
        update={
            name: existing_file(document, ("scene", "boundary", name), value, FILES)
            for name, value in boundary
            if isinstance(value, str)
        }
    )


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
