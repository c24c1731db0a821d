"""Measured surfaces of a campaign between rough or two elastic bodies: one file, or several, of the punch."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

from gfmd_numba.campaign.axes import with_values
from gfmd_numba.campaign.file import Campaign, check_scene
from gfmd_numba.campaign.grid import surfaces_of_grid
from gfmd_numba.campaign.measured_punches import FILE, check_unit, name_of, read_surfaces
from gfmd_numba.contact.contact_input import with_measured
from gfmd_numba.contact.rough_surfaces import MeasuredSurfaces
from gfmd_numba.roughness.measured import MeasuredSurface
from gfmd_numba.roughness.surface_files import read_content
from gfmd_numba.scene import Document, Measured, Scene, Surface
from gfmd_numba.scene.document import Location
from gfmd_numba.scene.scene_file import located_files

PUNCH = ("roughness",)
POINTS = (*PUNCH, "points")


@dataclass(frozen=True)
class MeasuredBodies:
    """Measured surfaces by their places, with one record of the punch, and what their files tell of a scene.

    `name` is what a grid calls the punch, if anything, and `period` L_x in m, None where lengths are in L_x. Faults of
    the surfaces stand at places of the `document`.
    """

    name: str
    surfaces: MeasuredSurfaces
    dimension: int
    period: float | None
    document: Document

    def under(self, scene: Scene) -> Scene:
        """Scene of this dimension and period."""
        return scene.model_copy(update={"dimension": self.dimension, "length": self.period})


Bodies = Mapping[Surface | None, MeasuredBodies]


def measured_bodies(campaign: Campaign, document: Document) -> dict[Surface | None, MeasuredBodies]:
    """Measured surfaces of a campaign by its measured punches, by None where no punch is measured; none without any.

    Raises InputError for files that cannot be used or do not fit each other.
    """
    if not any(isinstance(surface, Measured) for surface in campaign.scene.surfaces.values()):
        return {}
    if not isinstance(campaign.scene.roughness, Measured):
        scene, surfaces = with_measured(_located(document, campaign.scene), document)
        check_scene(document, campaign, scene)
        return {None: MeasuredBodies("", surfaces, scene.dimension, scene.length, document)}
    read = lru_cache(maxsize=len(campaign.scene.surfaces))(read_content)  # those of bodies are read once
    found: dict[Surface | None, MeasuredBodies] = {}
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
        scene, surfaces = read_surfaces(record, _located(placed, scene), placed, read)
        first = first or (record, surfaces[PUNCH])
        check_unit(placed, record, surfaces[PUNCH], *first)
        check_scene(document, campaign, scene)
        found[record] = MeasuredBodies(name_of(values), surfaces, scene.dimension, scene.length, placed)
    return found


def _located(document: Document, scene: Scene) -> Scene:
    return scene.model_copy(update=located_files(document, scene))


def said_of_bodies(bodies: Bodies, what: Literal["done", "doubts"]) -> list[str]:
    """What was done to measured surfaces, or makes them implausible, each once, after its place and its punch."""
    said = (
        f"{'.'.join(place)}{f' ({each.name})' if each.name and place == PUNCH else ''}: {sentence}"
        for each in bodies.values()
        for place, surface in each.surfaces.items()
        for sentence in getattr(surface, what)
    )
    return list(dict.fromkeys(said))
