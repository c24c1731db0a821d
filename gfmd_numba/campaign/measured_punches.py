"""Measured punches of a campaign: each file is read once, and tells the dimension and the period of its cases."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Literal

from gfmd_numba.campaign.axes import with_values
from gfmd_numba.campaign.axis import Place
from gfmd_numba.campaign.file import Campaign, check_scene
from gfmd_numba.campaign.grid import surfaces_of_grid
from gfmd_numba.contact.contact_input import with_measured
from gfmd_numba.contact.problem import given_surface
from gfmd_numba.contact.surfaces import GivenSurface
from gfmd_numba.roughness.measured import MeasuredSurface, Reader
from gfmd_numba.roughness.surface_files import read_content
from gfmd_numba.scene import Document, InputError, Measured, Scene, Surface
from gfmd_numba.scene.source import existing_file

FILE = ("roughness", "file")
_UNITS = {"m": "m", "1": "L_x"}


@dataclass(frozen=True)
class MeasuredPunch:
    """Surface in g L_x of a measured record, its rms gradient g, and what its file tells of a scene.

    `name` is what a grid calls it, if anything, and `period` L_x in m, None where lengths are in L_x. `done` says what
    was done to the heights, and `doubts` what makes them implausible.
    """

    name: str
    surface: GivenSurface
    rms_gradient: float
    dimension: int
    period: float | None
    done: tuple[str, ...]
    doubts: tuple[str, ...]

    def under(self, scene: Scene) -> Scene:
        """Scene of this dimension and period."""
        return scene.model_copy(update={"dimension": self.dimension, "length": self.period})


Punches = Mapping[Surface | None, MeasuredPunch]


def measured_punches(campaign: Campaign, document: Document) -> dict[Surface | None, MeasuredPunch]:
    """Punches of a campaign by their records, none if they are random; raises InputError for unusable files."""
    if not isinstance(campaign.scene.roughness, Measured):
        return {}
    read = lru_cache(maxsize=1)(read_content)  # the files are the outermost of the grid's loops
    found: dict[Surface | None, MeasuredPunch] = {}
    first: tuple[Measured, MeasuredSurface] | None = None
    for values, locations in surfaces_of_grid(campaign.grid):
        scene = with_values(campaign.scene, values)
        record = scene.roughness
        assert isinstance(record, Measured)  # as the campaign's own
        placed = replace(document, elsewhere={("scene", *place): at for place, at in locations.items()})
        scene, surfaces = read_surfaces(record, scene, placed, read)
        measured = surfaces["roughness",]
        first = first or (record, measured)
        check_unit(placed, record, measured, *first)
        try:
            surface, rms_gradient = given_surface(measured.in_periods)
        except ValueError as error:
            raise _refused(placed, f"{record.shown} ({error})", "heights that are not all equal") from None
        check_scene(document, campaign, scene)
        found[record] = MeasuredPunch(
            name=name_of(values),
            surface=surface,
            rms_gradient=rms_gradient,
            dimension=scene.dimension,
            period=scene.length,
            done=measured.done,
            doubts=measured.doubts,
        )
    return found


def said_of(punches: Punches, of: Literal["done", "doubts"]) -> list[str]:
    """What was done to punches, or makes them implausible, each after the name of its punch if it has one."""
    return [
        f"{punch.name}: {sentence}" if punch.name else sentence
        for punch in punches.values()
        for sentence in getattr(punch, of)
    ]


def name_of(values: Mapping[Place, Any]) -> str:
    """What a grid calls a measured surface, by its values."""
    return ", ".join(value if place == FILE else f"{place[-1]} {value:.10g}" for place, value in values.items())


def check_unit(
    document: Document, record: Measured, surface: MeasuredSurface, first: Measured, like: MeasuredSurface
) -> None:
    """Raise InputError for a surface whose lengths are not in the unit of the first one."""
    if surface.unit != like.unit:
        allowed = f"a surface with lengths in {_UNITS[like.unit]}, as {first.shown} has them"
        raise _refused(document, f"{record.shown} (lengths in {_UNITS[surface.unit]})", allowed)


def read_surfaces(
    record: Measured, scene: Scene, document: Document, read: Reader
) -> tuple[Scene, dict[Place, MeasuredSurface]]:
    """Scene of the dimension and period that a record of the punch tells, and its measured surfaces.

    An InputError names the value that is to blame: one of the grid rather than the file, if all is well without it.
    """
    file = ("scene", *FILE)
    assert record.file is not None  # the campaign's promise
    located = record.model_copy(update={"file": existing_file(document, file, record.file, ())})
    try:
        return _told(located, scene, document, read)
    except InputError:
        for place, at in document.elsewhere.items():
            of_grid = place not in (file, file[:-1])
            if of_grid and _is_usable(located.model_copy(update={str(place[-1]): None}), scene, document, read):
                _told(located, scene, replace(document, elsewhere={**document.elsewhere, file: at}), read)
        raise


def _told(
    record: Measured, scene: Scene, document: Document, read: Reader
) -> tuple[Scene, dict[Place, MeasuredSurface]]:
    told, measured = with_measured(scene.model_copy(update={"roughness": record}), document, read)
    return told, dict(measured)


def _is_usable(record: Measured, scene: Scene, document: Document, read: Reader) -> bool:
    try:
        _told(record, scene, document, read)
    except InputError:
        return False
    return True


def _refused(document: Document, given: str, allowed: str) -> InputError:
    return InputError(document.line(("scene", *FILE), given, allowed))
