"""Measured punches of a campaign: each file is read once, and tells the dimension and the period of its cases."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from gfmd_numba.campaign.axes import Place, with_values
from gfmd_numba.campaign.file import Campaign, check_scene, ranges
from gfmd_numba.campaign.grid import surfaces_of_grid
from gfmd_numba.contact.contact_input import as_told
from gfmd_numba.contact.problem import GivenSurface
from gfmd_numba.contact.rough_surfaces import given_punch, read_surface
from gfmd_numba.roughness.measured import MeasuredSurface, Reader
from gfmd_numba.roughness.surface_files import read_content
from gfmd_numba.scene import Document, InputError, Measured, Scene, Surface
from gfmd_numba.scene.checks import check_range
from gfmd_numba.scene.document import Location
from gfmd_numba.scene.source import existing_file
from gfmd_numba.text.input_error import brief

_FILE = ("roughness", "file")


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
        measured, location = _read(record, scene, document, locations, read)
        first = first or (record, measured)
        if measured.unit != first[1].unit:
            kinds = {"m": "m", "1": "L_x"}
            given = f"{record.shown} (lengths in {kinds[measured.unit]})"
            allowed = f"a surface with lengths in {kinds[first[1].unit]}, as {first[0].shown} has them"
            raise InputError(document.line(location, given, allowed))
        surface, rms_gradient = given_punch(measured, record, document, location)
        told = as_told(scene, {("roughness",): measured}, document)
        check_scene(document, campaign, told)
        for each, place in ranges(campaign, told):
            check_range(document, each, surface.nx, place)
        found[record] = MeasuredPunch(
            name=", ".join(value if place == _FILE else f"{place[-1]} {value:.10g}" for place, value in values.items()),
            surface=surface,
            rms_gradient=rms_gradient,
            dimension=told.dimension,
            period=told.length,
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


def _read(
    record: Measured, scene: Scene, document: Document, locations: Mapping[Place, Location], read: Reader
) -> tuple[MeasuredSurface, Location]:
    """Surface of a record, and where in the document it is told; an InputError names the value that is to blame.

    `locations` are those of the grid's values, by their places in the scene.
    """
    location = locations.get(_FILE, ("scene", *_FILE))
    assert record.file is not None  # the campaign's promise
    located = record.model_copy(update={"file": existing_file(document, location, record.file, ())})
    try:
        return read_surface(located, scene, document, location, read), location
    except InputError:
        for place, at in locations.items():
            if place != _FILE and _is_usable(located.model_copy(update={place[-1]: None}), scene, document, read):
                given = f"{brief(document.value(at))} for {record.shown}"
                read_surface(located, scene, document, at, read, given)
        raise


def _is_usable(record: Measured, scene: Scene, document: Document, read: Reader) -> bool:
    try:
        read_surface(record, scene, document, (), read)
    except InputError:
        return False
    return True
