"""Measured surfaces of a campaign. Each file is read once, and gives the dimension and the period of its cases."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

from gfmd_numba.campaign.axes import with_values
from gfmd_numba.campaign.file import Campaign, check_scene
from gfmd_numba.campaign.grid import surfaces_of_grid
from gfmd_numba.contact.contact_input import with_measured
from gfmd_numba.contact.problem import given_surface
from gfmd_numba.contact.rough_surfaces import MeasuredSurfaces
from gfmd_numba.contact.surfaces import GivenSurface
from gfmd_numba.roughness.measured import MeasuredSurface, Reader
from gfmd_numba.roughness.surface_files import read_content
from gfmd_numba.scene import Document, InputError, Measured, Scene, Surface
from gfmd_numba.scene.document import Location, existing_file
from gfmd_numba.scene.scene_file import located_files

PUNCH = ("roughness",)
FILE, POINTS = (*PUNCH, "file"), (*PUNCH, "points")
_UNITS = {"m": "m", "1": "L_x"}


@dataclass(frozen=True)
class MeasuredScene:
    """What the files of a scene give: its dimension, its period L_x in m (None: lengths are in L_x), and its surfaces.

    A rigid `punch` is in g L_x and stands with its rms gradient g. For rough bodies, `surfaces` has all that were
    measured, by their places, and errors about them name places of the `document`. Sentences say what was `done` to the
    heights, and which `doubts` there are about them.
    """

    dimension: int
    period: float | None
    document: Document
    done: tuple[str, ...]
    doubts: tuple[str, ...]
    punch: tuple[GivenSurface, float] | None
    surfaces: MeasuredSurfaces

    def under(self, scene: Scene) -> Scene:
        """Scene of this dimension and period."""
        return scene.model_copy(update={"dimension": self.dimension, "length": self.period})


Measurements = Mapping[Surface | None, MeasuredScene]


def measured_scenes(campaign: Campaign, document: Document) -> dict[Surface | None, MeasuredScene]:
    """Return measured surfaces by the record of the measured punch; by None if only bodies were measured.

    Raises InputError for files that cannot be used or do not fit each other.
    """
    if not any(isinstance(surface, Measured) for surface in campaign.scene.surfaces.values()):
        return {}
    if not isinstance(campaign.scene.roughness, Measured):
        scene, surfaces = with_measured(_located(document, campaign.scene), document)
        check_scene(document, campaign, scene)
        return {None: _measured(scene, surfaces, document, "")}
    read = lru_cache(maxsize=len(campaign.scene.surfaces))(read_content)  # files are the outermost of the grid's loops
    found: dict[Surface | None, MeasuredScene] = {}
    first: tuple[Measured, MeasuredSurface] | None = None
    for values, locations in surfaces_of_grid(campaign.grid):
        scene = with_values(campaign.scene, values)
        record = scene.roughness
        assert isinstance(record, Measured)  # as the campaign's own
        elsewhere: dict[Location, Location] = {("scene", *place): at for place, at in locations.items()}
        whole = next((place for place in (POINTS, FILE) if place in values), None)
        if whole is not None:  # what is said of the punch as a whole
            elsewhere["scene", *PUNCH] = locations[whole]
        placed = replace(document, elsewhere=elsewhere)
        scene, surfaces = _read(record, _located(placed, scene), placed, read)
        first = first or (record, surfaces[PUNCH])
        _check_unit(placed, record, surfaces[PUNCH], *first)
        name = ", ".join(value if place == FILE else f"{place[-1]} {value:.10g}" for place, value in values.items())
        found[record] = _measured(scene, surfaces, placed, name)
        check_scene(document, campaign, scene)
    return found


def said_of(measured: Measurements, what: str) -> list[str]:
    """Return what was `done` to measured surfaces, or the `doubts` about them, each sentence once."""
    return list(dict.fromkeys(sentence for each in measured.values() for sentence in getattr(each, what)))


def _measured(scene: Scene, surfaces: MeasuredSurfaces, document: Document, name: str) -> MeasuredScene:
    """Return what the files of a scene give; its punch has a `name` if a grid varies it."""
    punch = None if scene.follows_topography else _punch(surfaces[PUNCH], scene, document)
    of_punch = f" ({name})" if name else ""

    def said(what: str) -> tuple[str, ...]:
        return tuple(
            f"{'.'.join(place)}{of_punch if place == PUNCH else ''}: {sentence}"
            if punch is None
            else ": ".join(filter(None, (name, sentence)))
            for place, surface in surfaces.items()
            for sentence in getattr(surface, what)
        )

    kept = surfaces if punch is None else {}
    return MeasuredScene(scene.dimension, scene.length, document, said("done"), said("doubts"), punch, kept)


def _punch(surface: MeasuredSurface, scene: Scene, document: Document) -> tuple[GivenSurface, float]:
    record = scene.roughness
    assert isinstance(record, Measured)  # a rigid punch is the only surface there is
    try:
        return given_surface(surface.in_periods, periodic=scene.periodic)
    except ValueError as error:
        raise _refused(document, f"{record.shown} ({error})", "heights that are not all equal") from None


def _located(document: Document, scene: Scene) -> Scene:
    return scene.model_copy(update=located_files(document, scene))


def _check_unit(
    document: Document, record: Measured, surface: MeasuredSurface, first: Measured, like: MeasuredSurface
) -> None:
    """Raise InputError for a surface whose lengths are not in the unit of the first one."""
    if surface.unit != like.unit:
        allowed = f"a surface with lengths in {_UNITS[like.unit]}, as {first.shown} has them"
        raise _refused(document, f"{record.shown} (lengths in {_UNITS[surface.unit]})", allowed)


def _read(record: Measured, scene: Scene, document: Document, read: Reader) -> tuple[Scene, MeasuredSurfaces]:
    """Return the scene with the dimension and period of the file of its punch, and its measured surfaces.

    An InputError names a value of the grid rather than the file, if the file can be used without that value.
    """
    file = ("scene", *FILE)
    assert record.file is not None  # the campaign's promise
    located = record.model_copy(update={"file": existing_file(document, file, record.file, ())})

    def told(placed: Document, without: str = "") -> tuple[Scene, MeasuredSurfaces]:
        roughness = located.model_copy(update={without: None} if without else {})
        return with_measured(scene.model_copy(update={"roughness": roughness}), placed, read)

    try:
        return told(document)
    except InputError:
        for place, at in document.elsewhere.items():
            if place in (file, file[:-1]):
                continue
            try:
                told(document, without=str(place[-1]))
            except InputError:
                continue
            told(replace(document, elsewhere={**document.elsewhere, file: at}))
        raise


def _refused(document: Document, given: str, allowed: str) -> InputError:
    return InputError(document.line(("scene", *FILE), given, allowed))
