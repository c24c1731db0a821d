"""Scene files, nested or flat: a contact, or a loaded body without a punch."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel

from gfmd_numba.scene.checks import arrays_of, check_anisotropy_fits, check_discretisation, check_nodes, check_surfaces
from gfmd_numba.scene.document import Document, Location, Source, document_of, existing_file, validate
from gfmd_numba.scene.quantities import FILES
from gfmd_numba.scene.records import Boundary, Discretisation, Scene, SceneFile
from gfmd_numba.text.input_error import ABSENT, InputError

Record = TypeVar("Record", bound=BaseModel)

_TOP_LEVEL = set(SceneFile.model_fields)
_OF_CAMPAIGNS = ("realisations", "reference", "limits", "grid", "fit", "target")
_TAKERS = {"surface": "gfmd surface takes", "scene": "gfmd solve and gfmd curve take"}


def load_scene(source: Source | SceneFile, heights: Any = None) -> tuple[SceneFile, Document]:
    """Checked contact or loaded body of a YAML file, nested or flat, a mapping or a record, and the document itself.

    Its punch may have the `heights` of an array, treated as its `roughness` says if it has one. Raises InputError.
    """
    if heights is not None:
        source = _with_heights(source, heights)
    if isinstance(source, SceneFile):
        document = Document(None, "", source.model_dump())
        return _checked(source, document), document
    document = _nested(document_of(source, "scene"))
    if document.value(("scene",)) is ABSENT:
        _refuse_kind(document, ("surface",), "surface", "scene")
    campaign = [key for key in _OF_CAMPAIGNS if isinstance(document.data, dict) and key in document.data]
    if len(campaign) > 1:  # one alone may be a slip
        allowed = "the keys of a scene; gfmd run and gfmd plan take a campaign"
        raise InputError(document.line((campaign[0],), "a key of campaigns", allowed, of_key=True))
    return _checked(validate(document, SceneFile), document), document


def refuse_other_kinds(document: Document) -> None:
    """Raise InputError for the file of a scene or of a surface where a campaign is asked for."""
    if all(document.value((key,)) is ABSENT for key in ("name", *_OF_CAMPAIGNS)):
        _refuse_kind(document, ("surface",), "surface", "campaign")
        _refuse_kind(document, ("scene", "body"), "scene", "campaign")


def _refuse_kind(document: Document, keys: tuple[str, ...], kind: str, asked: str) -> None:
    """Raise InputError if the document has one of these keys, which tell its kind."""
    for key in keys:
        if document.value((key,)) is not ABSENT:
            allowed = f"the keys of a {asked}; {_TAKERS[kind]} a {kind}"
            raise InputError(document.line((key,), f"a {kind}", allowed, of_key=True))


def _with_heights(source: Source | SceneFile, heights: Any) -> Document:
    """Document of a scene whose punch has heights of an array; raises InputError if it has heights already."""
    given = source.model_dump(exclude_unset=True) if isinstance(source, SceneFile) else source
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


def input_files(file: SceneFile) -> list[Path]:
    """Files that a loaded scene reads."""
    return [Path(name) for name in _named_files(file.scene)]


def _named_files(record: BaseModel) -> Iterator[str]:
    for name, value in record:
        if isinstance(value, BaseModel):
            yield from _named_files(value)
        elif isinstance(value, str) and _kinds_of_file(record, name) is not None:
            yield value


def _kinds_of_file(record: BaseModel, name: str) -> tuple[str, ...] | None:
    """What the file may end in that a text of a record names, () for anything; None for a text that names none."""
    return FILES if isinstance(record, Boundary) else {"file": (), "pattern": FILES}.get(name)


def _checked(file: SceneFile, document: Document) -> SceneFile:
    """The same, whose files exist and have absolute paths."""
    _check_grid(file, document)
    return file.model_copy(update={"scene": located(document, file.scene, ("scene",))})


def _check_grid(file: SceneFile, document: Document) -> None:
    scene, arrays = file.scene, arrays_of(file.scene, file.slope_order, len(file.path))
    if file.discretisation is not None:
        locations = {axis: ("discretisation", axis) for axis in Discretisation.model_fields}
        check_discretisation(document, file.discretisation, locations, (), scene.dimension, arrays)
        for place, surface in scene.surfaces.items():
            anisotropy = getattr(surface, "anisotropy", None)
            checked = place == ("roughness",) or not scene.has_punch
            if anisotropy is not None and checked:
                check_anisotropy_fits(document, anisotropy, ("scene", *place, "anisotropy"), file.discretisation)
    check_surfaces(document, scene, arrays)
    if file.points is not None:
        check_nodes(document, ("points",), float(file.points) ** scene.dimension, arrays)


def located(document: Document, record: Record, at: Location) -> Record:
    """Record at a place of the document whose files have absolute paths; raises InputError for one that is missing."""
    update: dict[str, object] = {}
    for name, value in record:
        if isinstance(value, BaseModel):
            update[name] = located(document, value, (*at, name))
        elif isinstance(value, str) and (kinds := _kinds_of_file(record, name)) is not None:
            update[name] = existing_file(document, (*at, name), value, kinds)
    return record.model_copy(update=update)


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
